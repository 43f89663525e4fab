"""SimpleSetup.simplifySolution after planning with a risk."""

from ompl import geometric as og
from scene import Risk, path_cost, reached, report, setup


def main():
    """Removing vertices pays no attention to the objective."""
    simple = setup(Risk)
    simple.setPlanner(og.RRTstar(simple.getSpaceInformation()))
    simple.solve(0.5)
    before = path_cost(simple)
    reached()
    simple.simplifySolution()
    after = path_cost(simple)
    report(good=after <= before, saw=f"cost {before:.3g} before, {after:.3g} after")


if __name__ == "__main__":
    main()
