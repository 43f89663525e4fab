"""A box between start and goal, objectives in Python, and scripts run in a process of their own."""

import math
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

from ompl import base as ob
from ompl import geometric as og
from ompl import tools as ot
from ompl import util as ou

from ompl_risk.bridge import faults

ou.setLogLevel(ou.LOG_NONE)

OMPL_LENGTH = ob.PathLengthOptimizationObjective


class Length(ob.OptimizationObjective):
    """Somebody's objective in Python: the path's length."""

    def stateCost(self, state):
        return ob.Cost(0.0)

    def motionCost(self, s1, s2):
        return ob.Cost(math.dist(s1[0:2], s2[0:2]))


class RiskyLength(Length):
    """Stands for RiskObjective, which the guards recognise by this attribute."""

    is_risk_objective = True


class Forbidden(RiskyLength):
    """Every motion collides."""

    def motionCost(self, s1, s2):
        return ob.Cost(math.inf)


class PythonGoal(ob.GoalSampleableRegion):
    """A goal state, written in Python."""

    def distanceGoal(self, state):
        return math.dist(state[0:2], (0.9, 0.5))

    def sampleGoal(self, state):
        state[0:2] = [0.9, 0.5]

    def maxSampleCount(self):
        return 1


class FailingChecker(ob.StateValidityChecker):
    """Raises from the given call on, through ``faults.keep`` as the library's checkers do."""

    def __init__(self, information, call=30):
        super().__init__(information)
        self.left, self.calls = call, []

    def isValid(self, state):
        try:
            self.calls.append(None)
            if len(self.calls) >= self.left:
                raise ValueError("boom")
            return is_free(state)
        except BaseException as error:
            if not faults.keep(error):
                raise
            return False


def is_free(state):
    return not (0.4 < state[0] < 0.6 and 0.2 < state[1] < 0.8)


def state_at(information, x, y):
    state = information.allocState()
    state[0:2] = [x, y]
    return state


def setup(objective=None, checker=is_free, planner=None):
    """A SimpleSetup in the unit square; classes are called with the space information."""
    square = ob.RealVectorStateSpace(2)
    bounds = ob.RealVectorBounds(2)
    bounds.setLow(0.0)
    bounds.setHigh(1.0)
    square.setBounds(bounds)
    simple = og.SimpleSetup(square)
    information = simple.getSpaceInformation()
    simple.setStateValidityChecker(checker(information) if isinstance(checker, type) else checker)
    simple.setStartAndGoalStates(state_at(information, 0.1, 0.5), state_at(information, 0.9, 0.5))
    if objective is not None:
        simple.setOptimizationObjective(objective(information))
    if planner is not None:
        simple.setPlanner(planner(information))
    return simple


def three_goals(information):
    goals = ob.GoalStates(information)
    for y in (0.4, 0.5, 0.6):
        goals.addState(state_at(information, 0.9, y))
    return goals


def sum_of(*objectives):
    """An OMPL sum of objectives."""

    def build(information):
        total = ob.MultiOptimizationObjective(information)
        for objective in objectives:
            total.addObjective(objective(information), 1.0)
        total.lock()
        return total

    return build


PRELUDE = f"""
import signal, sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from ompl import base as ob, geometric as og, tools as ot
from guard_scene import *
from ompl_risk.bridge import guards
from ompl_risk.errors import TrapError
{{switch}}
def main():
{{body}}
main()
"""


def start(body, *, guarded=True, limit=3.0):
    """Start a script: with or without guards, stopped by the operating system after ``limit`` [s].

    The limit counts from ``go()``, which the script calls when it is ready.
    """
    alarm = f"def go(): print('go', flush=True); signal.setitimer(signal.ITIMER_REAL, {limit})"
    switch = ("guards.install()" if guarded else "guards.remove()") + "\n" + alarm
    script = PRELUDE.format(switch=switch, body=textwrap.indent(textwrap.dedent(body), "    "))
    return subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def finish(process):
    """How a script ended, its lines after ``go``, and its standard error."""
    output, errors = process.communicate(timeout=60)
    code = process.returncode
    ending = {-signal.SIGALRM: "hangs", 0: "ends"}.get(code, f"code {code}")
    lines = output.splitlines()
    assert "go" in lines, errors
    return ending, lines[lines.index("go") + 1 :], errors


def run(body, **options):
    return finish(start(body, **options))


def at_the_first_solution(simple):
    """The set-up, content with any path: how long planning takes depends on the machine."""
    simple.getOptimizationObjective().setCostThreshold(ob.Cost(1e9))
    return simple


def benchmark(objective, *planners, runs=1, simplify=False):
    simple = setup(objective)
    bench = ot.Benchmark(simple, "test")
    for planner in planners:
        bench.addPlanner(planner(simple.getSpaceInformation()))
    return bench, ot.Request(0.1, 4096.0, runs, 0.05, False, False, simplify)
