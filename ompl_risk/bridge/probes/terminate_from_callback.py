"""A callback terminates the planner that called it."""

import time

from ompl import base as ob
from ompl import geometric as og
from scene import is_free, reached, report, setup


def main():
    """What the deferral of exceptions stands on; PRM, because its second thread must end too."""
    condition = ob.timedPlannerTerminationCondition(3.0)

    def checker(state):
        if time.monotonic() > start + 0.1:
            condition.terminate()
        return is_free(state)

    start = time.monotonic()
    simple = setup(checker=checker)
    simple.setPlanner(og.PRM(simple.getSpaceInformation()))
    reached()
    simple.solve(condition)
    seconds = time.monotonic() - start
    report(good=seconds < 2.0, saw="ok" if seconds < 2.0 else f"goes on for {seconds:.1f} s")


if __name__ == "__main__":
    main()
