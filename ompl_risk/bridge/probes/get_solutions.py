"""ProblemDefinition.getSolutions after a solution was found."""

from ompl import geometric as og
from scene import reached, report, setup


def main():
    """The type of its elements is not bound."""
    simple = setup()
    simple.setPlanner(og.RRTConnect(simple.getSpaceInformation()))
    simple.solve(0.3)
    reached()
    try:
        found = simple.getProblemDefinition().getSolutions()
    except TypeError:
        report(good=False, saw="TypeError: the list cannot be converted")
    else:
        report(good=True, saw=f"returns {len(found)} solutions")


if __name__ == "__main__":
    main()
