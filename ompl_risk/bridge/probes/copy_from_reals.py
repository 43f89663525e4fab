"""StateSpace.copyFromReals before the space is set up."""

from scene import reached, report, space


def main():
    """The table of value locations does not exist yet."""
    cube = space()
    state = cube.allocState()
    reached()
    cube.copyFromReals(state, [0.1, 0.2, 0.3])
    report(good=state[1] == 0.2, saw=f"reads back {state[0]}, {state[1]}, {state[2]}")


if __name__ == "__main__":
    main()
