"""FMT with a cost that is no metric: the number of segments."""

from ompl import geometric as og
from scene import Constant, reached, report, setup


def main():
    """FMT keeps its samples in a structure that takes the cost for a distance."""
    simple = setup(lambda information: Constant(information, 1.0))
    simple.setPlanner(og.FMT(simple.getSpaceInformation()))
    reached()
    status = simple.solve(0.5)
    report(good=simple.haveExactSolutionPath(), saw=f"returns: {status}")


if __name__ == "__main__":
    main()
