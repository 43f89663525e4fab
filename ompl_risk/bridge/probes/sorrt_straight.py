"""SORRTstar minimising the path's length where the straight way is free."""

from ompl import base as ob
from ompl import geometric as og
from scene import reached, report, setup


def main():
    """Its sampler looks for states that could shorten a path that nothing can shorten."""
    simple = setup(checker=ob.AllValidStateValidityChecker)
    simple.setPlanner(og.SORRTstar(simple.getSpaceInformation()))
    reached()
    report(good=True, saw=f"returns: {simple.solve(0.5)}")


if __name__ == "__main__":
    main()
