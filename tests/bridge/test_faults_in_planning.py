"""What goes wrong inside callbacks comes out of solve as the Python exception that it is."""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og

from ompl_risk import InverseDistance, RiskObjective


class Broken(RuntimeError):
    pass


def failing_after(calls):
    count = iter(range(calls))

    def clearance(points):
        if next(count, None) is None:
            raise Broken("sensor lost")
        return np.full(len(points), 50.0)

    return clearance


@pytest.mark.parametrize("planner", [og.RRTstar, og.RRTConnect, og.BITstar, og.PRMstar, og.PRM])
def test_exceptions_of_a_clearance_surface_after_solve(planner, make_setup):
    setup = make_setup(clearance=failing_after(3), planner=planner)
    with pytest.raises(Broken, match="sensor lost"):
        setup.solve(3.0)


def test_exceptions_inside_the_objective_surface_too(make_setup, pass_clearance):
    def objective(si):
        return RiskObjective(si, failing_after(10), InverseDistance(60.0), speed=20.0)

    with pytest.raises(Broken):
        make_setup(objective).solve(30.0)  # the exception ends it at once


def test_outside_of_solve_exceptions_are_raised_at_once(make_setup):
    setup = make_setup(clearance=failing_after(0))
    si = setup.getSpaceInformation()
    with pytest.raises(Broken):
        si.isValid(si.allocState())


SCRIPT = """
import numpy as np
from ompl import base as ob, geometric as og, util as ou
from ompl_risk import *
from ompl_risk.terrains import Terrain
ou.setLogLevel(ou.LOG_NONE)
def main():
    ground = TerrainClearance(Terrain(np.zeros((5, 5)), spacing=(250.0, 250.0)))
    space = ob.RealVectorStateSpace(3); space.setBounds(1.0, 900.0)
    setup = og.SimpleSetup(space); si = setup.getSpaceInformation()
    setup.setStateValidityChecker(ClearanceValidityChecker(si, ground))
    setup.setOptimizationObjective(RiskObjective(si, ground, speed=20.0))
    a, b = si.allocState(), si.allocState(); a[0:3] = [10.0]*3; b[0:3] = [800.0]*3
    setup.setStartAndGoalStates(a, b); setup.setPlanner(og.RRTstar(si))
    print("solving", flush=True)
    setup.solve(60.0)
try:
    main()
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_ctrl_c_ends_a_solve():
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline().strip() == "solving"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert out.strip() == "interrupted", err
    assert process.returncode == 0


def test_checker_reports_clearance_and_exact_bools(make_setup, pass_clearance):
    setup = make_setup()
    si = setup.getSpaceInformation()
    state = si.allocState()
    state[0:3] = [100.0, 500.0, 30.0]
    assert si.getStateValidityChecker().clearance(state) == pytest.approx(
        pass_clearance([[100.0, 500.0, 30.0]])[0]
    )
    assert type(si.isValid(state)) is bool
    path = og.PathGeometric(si)
    path.append(state)
    assert path.clearance() == pytest.approx(pass_clearance([[100.0, 500.0, 30.0]])[0])
    assert isinstance(si.getStateValidityChecker(), ob.StateValidityChecker)
