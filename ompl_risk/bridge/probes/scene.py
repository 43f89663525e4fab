"""The problem that the probes share, and how a probe reports. Raw OMPL: no ompl_risk in here.

Every probe is a script of its own, which can be run and read by itself::

    python ompl_risk/bridge/probes/prm_objective.py

It prints ``reached`` and its time limit just before it does the dangerous thing and then, if it
still lives, one line of JSON: whether OMPL behaved well, and what was seen. A probe that hangs is
stopped by a timer of the operating system, so a deadlock is an observation too.
"""

import itertools
import json
import math
import resource
import signal
import sys
from typing import Any

from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

PATIENCE = 3.0  # [s] from reached() on; the probes' own time limits are 0.5 s or less

ou.setLogLevel(ou.LOG_NONE)
ou.RNG.setSeed(1)
resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))


def reached():
    """Tell that what comes next is the trap itself, and limit the time for it."""
    sys.stdout.write(f"reached {PATIENCE:g}\n")
    sys.stdout.flush()
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)


def report(good, saw):
    """Tell whether OMPL did what a user would expect, and what was seen."""
    sys.stdout.write(json.dumps({"good": bool(good), "saw": saw}) + "\n")
    sys.stdout.flush()


def space() -> Any:
    """The unit cube."""
    cube = ob.RealVectorStateSpace(3)
    bounds = ob.RealVectorBounds(3)
    bounds.setLow(0.0)
    bounds.setHigh(1.0)
    cube.setBounds(bounds)
    return cube


def is_free(state):
    """Outside a box that stands between start and goal."""
    return not (0.4 < state[0] < 0.6 and 0.2 < state[1] < 0.8)


def state_at(information, x, y, z) -> Any:
    """A state of the unit cube."""
    state = information.allocState()
    state[0:3] = [x, y, z]
    return state


def setup(objective: Any = ob.PathLengthOptimizationObjective, checker: Any = is_free) -> Any:
    """A SimpleSetup from one side of the box to the other.

    Args:
        objective: called with the space information; by default OMPL's own path length.
        checker: a function of a state, or a class of checkers.
    """
    simple = og.SimpleSetup(space())
    information = simple.getSpaceInformation()
    simple.setStateValidityChecker(checker(information) if isinstance(checker, type) else checker)
    start, goal = (state_at(information, x, 0.5, x) for x in (0.1, 0.9))
    simple.setStartAndGoalStates(start, goal)
    simple.setOptimizationObjective(objective(information))
    return simple


class Length(ob.OptimizationObjective):
    """The path's length, written in Python; counts how often OMPL asks for it."""

    def __init__(self, information):
        super().__init__(information)
        self.calls = itertools.count()

    def stateCost(self, state):  # noqa: ARG002 (OMPL passes it)
        """Nothing."""
        return ob.Cost(0.0)

    def motionCost(self, s1: Any, s2: Any):
        """The distance."""
        next(self.calls)
        return ob.Cost(math.dist(s1[0:3], s2[0:3]))


class Constant(ob.OptimizationObjective):
    """The same cost for every motion."""

    def __init__(self, information, cost):
        super().__init__(information)
        self.cost = cost

    def stateCost(self, state):  # noqa: ARG002 (OMPL passes it)
        """Nothing."""
        return ob.Cost(0.0)

    def motionCost(self, s1: Any, s2: Any):  # noqa: ARG002 (OMPL passes them)
        """The cost that was given."""
        return ob.Cost(self.cost)


class Risk(ob.OptimizationObjective):
    """The integral of (1 / distance to the box - 1 / 0.3) squared; infinite inside."""

    def stateCost(self, state):  # noqa: ARG002 (OMPL passes it)
        """Nothing."""
        return ob.Cost(0.0)

    def motionCost(self, s1: Any, s2: Any):
        """The rectangle rule."""
        a, b = s1[0:3], s2[0:3]
        length = math.dist(a, b)
        n = max(1, math.ceil(length / 0.02))
        fractions = (i / n for i in range(n))
        values = (
            _avoidance([p + r * (q - p) for p, q in zip(a, b, strict=True)]) for r in fractions
        )
        return ob.Cost(sum(value**2 for value in values) * length / n)


def _avoidance(position):
    x, y, _ = position
    distance = math.hypot(max(0.4 - x, x - 0.6, 0.0), max(0.2 - y, y - 0.8, 0.0))
    return max(0.0, 1.0 / distance - 1.0 / 0.3) if distance > 0.0 else math.inf


def path_cost(simple):
    """The cost of the solution path, computed from the path."""
    return simple.getSolutionPath().cost(simple.getOptimizationObjective()).value()


def report_motion_costs(planner):
    """Solve with a planner class and report whether it asks for the cost of motions."""
    simple = setup(Length)
    simple.setPlanner(planner(simple.getSpaceInformation()))
    reached()
    simple.solve(0.3)
    asked = next(simple.getOptimizationObjective().calls)
    report(asked, f"asks for {asked} motion costs" if asked else "never asks for a motion's cost")


def report_constant_cost(cost):
    """Solve with RRTstar and report whether it takes motions of that cost for a solution."""
    simple = setup(lambda information: Constant(information, cost))
    simple.setPlanner(og.RRTstar(simple.getSpaceInformation()))
    reached()
    status = simple.solve(0.2)
    if simple.haveExactSolutionPath():
        report(False, f'says "{status}" to a path of cost {path_cost(simple):g}')
    else:
        report(True, f"returns: {status}")
