"""OMPL can be imported at all."""

from scene import reached, report


def main():
    """Reaching this line says it: the scene imports OMPL."""
    reached()
    report(good=True, saw="ok")


if __name__ == "__main__":
    main()
