"""A planner written in Python that overrides getPlannerData."""

from ompl import base as ob
from scene import reached, report, setup


class Idle(ob.Planner):
    """Gives up at once."""

    def __init__(self, information):
        super().__init__(information, "Idle")

    def solve(self, ptc):  # type: ignore[override]  # noqa: ARG002 (OMPL passes it)
        """Give up."""
        return ob.PlannerStatus(ob.PlannerStatus.TIMEOUT)

    def getPlannerData(self, data):
        """Tell nothing."""


def main():
    """The argument cannot be handed to Python."""
    simple = setup()
    simple.setPlanner(Idle(simple.getSpaceInformation()))
    simple.solve(0.1)
    data = ob.PlannerData(simple.getSpaceInformation())
    reached()
    simple.getPlannerData(data)
    report(good=True, saw="the override is called")


if __name__ == "__main__":
    main()
