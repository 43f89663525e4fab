"""Classes can be patched, and OMPL gives back the very objects it was given."""

from ompl import geometric as og
from scene import Length, reached, report, setup


def main():
    """What the guards of ompl_risk stand on."""
    simple = setup(Length)
    planner = og.RRTstar(simple.getSpaceInformation())
    simple.setPlanner(planner)
    reached()
    same = simple.getPlanner() is planner
    kept = type(simple.getProblemDefinition().getOptimizationObjective()) is Length
    original, calls = vars(og.SimpleSetup)["solve"], []

    def solve(self, *args):
        calls.append(args)
        return original(self, *args)

    setattr(og.SimpleSetup, "solve", solve)  # noqa: B010 (a type checker rightly objects)
    simple.solve(0.05)
    setattr(og.SimpleSetup, "solve", original)  # noqa: B010
    good = same and kept and calls == [(0.05,)]
    saw = "ok" if good else f"same planner {same}, same objective {kept}, calls seen {len(calls)}"
    report(good=good, saw=saw)


if __name__ == "__main__":
    main()
