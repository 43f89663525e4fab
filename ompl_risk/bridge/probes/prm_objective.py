"""PRMstar.solve with an objective written in Python."""

from ompl import geometric as og
from scene import Length, reached, report, setup


def main():
    """The second thread of PRM wants Python while the first one waits for it."""
    simple = setup(Length)
    simple.setPlanner(og.PRMstar(simple.getSpaceInformation()))
    reached()
    report(good=True, saw=f"returns: {simple.solve(0.5)}")


if __name__ == "__main__":
    main()
