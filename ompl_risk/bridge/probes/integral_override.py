"""A StateCostIntegralObjective with a stateCost written in Python."""

import math

from ompl import base as ob
from ompl import geometric as og
from scene import reached, report, setup, state_at


class Tenfold(ob.StateCostIntegralObjective):
    """Ten times the path's length, if OMPL asks."""

    def __init__(self, information):
        super().__init__(information, True)

    def stateCost(self, state):  # noqa: ARG002 (OMPL passes it)
        """Ten a metre."""
        return ob.Cost(10.0)


def main():
    """OMPL does not find the override."""
    simple = setup(Tenfold)
    information = simple.getSpaceInformation()
    path = og.PathGeometric(information)
    for x in (0.0, 0.5, 1.0):
        path.append(state_at(information, x, 0.1, 0.1))
    reached()
    cost = path.cost(simple.getOptimizationObjective()).value()
    if math.isclose(cost, 10.0 * path.length(), rel_tol=1e-6):
        report(good=True, saw="the override is used")
    else:
        report(
            good=False, saw=f"ignored: cost {cost:.2f}, 10.00 expected, length {path.length():.2f}"
        )


if __name__ == "__main__":
    main()
