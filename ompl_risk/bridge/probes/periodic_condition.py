"""A termination condition that evaluates a Python function in its own thread."""

import time

from ompl import base as ob
from ompl import geometric as og
from scene import reached, report, setup


def main():
    """The thread cannot run Python as long as OMPL runs C++ code, so solve never ends."""
    simple = setup(checker=ob.AllValidStateValidityChecker)
    simple.setPlanner(og.RRTstar(simple.getSpaceInformation()))
    end = time.monotonic() + 0.3
    condition = ob.PlannerTerminationCondition(lambda: time.monotonic() > end, 0.01)
    reached()
    report(good=True, saw=f"returns: {simple.solve(condition)}")


if __name__ == "__main__":
    main()
