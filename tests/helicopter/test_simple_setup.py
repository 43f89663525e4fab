"""Problems of the helicopter: solved, replayed, or refused."""

import gc
import math
import subprocess
import sys
import weakref

import numpy as np
import pytest
from control_scene import (
    CALM,
    HIGH,
    LOW,
    PLANNERS,
    XCELL,
    after,
    hill,
    hop,
    numbers,
)
from ompl import base as ob
from ompl import control as oc
from ompl import util as ou

from ompl_risk import RiskObjective, TerrainClearance, Trajectory
from ompl_risk._kernels import propagation
from ompl_risk.errors import ArgumentError, FileError, TrapWarning
from ompl_risk.helicopter import model
from ompl_risk.helicopter.goals import HelicopterGoal
from ompl_risk.helicopter.setup import HEADROOM, simple_setup
from ompl_risk.helicopter.spaces import propagator
from ompl_risk.terrains import Terrain


@pytest.fixture
def si():
    found = hop().getSpaceInformation()
    found.setup()
    return found


@pytest.mark.parametrize("planner", PLANNERS)
def test_planners_find_flights_that_replay_exactly(planner):
    ou.RNG.setSeed(1)
    setup = hop(radius=10.0, tolerance=5.0)
    si = setup.getSpaceInformation()
    setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(si))
    setup.setPlanner(planner(si))
    setup.solve(after(60_000))
    problem = setup.getProblemDefinition()
    assert problem.hasExactSolution()
    path = problem.getSolutionPath()
    assert path.check()
    state, states = numbers(si, path.getState(0)), path.getStates()
    assert (state == model.make_state((30, 50, 20), velocity=(6, 0, 0))).all()
    bounds = si.getControlSpace().getBounds()
    for k, (held, seconds) in enumerate(
        zip(path.getControls(), path.getControlDurations(), strict=True)
    ):
        u = [held[i] for i in range(4)]
        assert all(a <= x <= b for a, x, b in zip(bounds.low, u, bounds.high, strict=True))
        state = model.simulate(XCELL, state, [u] * round(seconds / 0.1), dt=0.1)[-1]
        assert (state == numbers(si, states[k + 1])).all()
    assert np.linalg.norm(state[:3] - [60, 50, 20]) <= 10.0
    assert np.linalg.norm(model.world_velocity(state) - [6, 0, 0]) <= 5.0
    assert Trajectory.from_path(path).duration == pytest.approx(path.length())


def test_by_default_the_box_is_the_terrain_with_headroom():
    setup = simple_setup(hill(), start=(20, 20, 40), goal=(180, 180, 10))
    envelope = setup.getStateValidityChecker().envelope
    assert envelope.low.tolist() == [0.0, 0.0, pytest.approx(0.0, abs=1e-6)]
    assert envelope.high.tolist() == [200.0, 200.0, 40.0 + HEADROOM]
    si = setup.getSpaceInformation()
    assert si.getPropagationStepSize() == 0.02
    assert (si.getMinControlDuration(), si.getMaxControlDuration()) == (15, 60)


def test_terrains_may_be_names_and_clearances():
    named = simple_setup("hills", start=(6000, 4500, 900), goal=(6500, 4500, 900), body=2.0)
    checker = named.getStateValidityChecker()
    assert (checker.obstacles.terrain.name, checker.obstacles.radius) == ("hills", 2.0)
    clearance = TerrainClearance(hill(), 4.0)
    given = simple_setup(clearance, start=(20, 20, 40), goal=(180, 180, 40))
    assert given.getStateValidityChecker().obstacles is clearance
    free = simple_setup(
        lambda points: points[:, 2], start=(20, 20, 40), goal=(180, 180, 40), low=LOW, high=HIGH
    )
    assert free.getStateValidityChecker().envelope.high.tolist() == HIGH.tolist()


def test_the_objective_is_risk_and_planners_that_ignore_it_say_so():
    setup = hop()
    si = setup.getSpaceInformation()
    objective = setup.getProblemDefinition().getOptimizationObjective()
    assert isinstance(objective, RiskObjective)
    assert objective.risk.norm.label == "H1"
    assert objective.risk.speed == CALM.speed
    from ompl_risk.bridge.guarded import forget_warnings

    forget_warnings()
    for planner in PLANNERS:
        setup.setPlanner(planner(si))
        with pytest.warns(TrapWarning, match="does not look at the objective"):
            setup.solve(after(1))


@pytest.mark.filterwarnings("ignore::ompl_risk.errors.TrapWarning")
def test_an_exception_in_the_clearance_surfaces_after_solve():
    calls = iter(range(10**6))

    def breaks(points):
        if next(calls) > 500:
            raise ZeroDivisionError("from the clearance")
        return points[:, 2]

    setup = simple_setup(breaks, start=(40, 50, 20), goal=(60, 50, 20), low=LOW, high=HIGH)
    setup.setPlanner(oc.EST(setup.getSpaceInformation()))
    with pytest.raises(ZeroDivisionError, match="from the clearance"):
        setup.solve(10.0)


@pytest.mark.filterwarnings("ignore::ompl_risk.errors.TrapWarning")
def test_an_exception_in_the_propagator_surfaces_after_solve(monkeypatch):
    calls, advance = iter(range(10**6)), propagation.advance

    def breaks(address, dt):
        if next(calls) > 500:
            raise ZeroDivisionError("from the propagator")
        advance(address, dt)

    monkeypatch.setattr(propagation, "advance", breaks)
    setup = hop(radius=1e-6)
    setup.setPlanner(oc.RRT(setup.getSpaceInformation()))
    with pytest.raises(ZeroDivisionError, match="from the propagator"):
        setup.solve(10.0)


def test_a_set_up_leaves_nothing_behind():
    setup = hop()
    setup.setPlanner(oc.EST(setup.getSpaceInformation()))
    setup.setup()
    left = [weakref.ref(x) for x in (setup.getStateValidityChecker(), setup.getGoal())]
    del setup
    gc.collect()
    assert [ref() for ref in left] == [None, None]


FLAT = Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0))
FAST = model.make_state((50, 50, 20), velocity=(30, 20, 0))
SPUN = model.make_state((50, 50, 20), rates=(0, 0, 2.5))
TILTED = model.make_state((50, 50, 20), orientation=(math.sin(0.6), 0, 0, math.cos(0.6)))
ENDS = {"start": (20, 20, 20), "goal": (80, 80, 20)}


@pytest.mark.parametrize("end", ["start", "goal"])
@pytest.mark.parametrize(
    ("value", "message"),
    [
        (FAST, r"speed of {} = 36.05\d*: must be at most 35 m/s"),
        (SPUN, r"rate of {} = 2.5: must be at most 2 rad/s"),
        (TILTED, r"attitude of {} = 1.2\d*: must be at most 1.1 rad"),
        ((50, 120, 20), r"position of {} = \[50.0, 120.0, 20.0\]: must be within"),
        ((50, 50, -5), r"position of {} = "),
        ((50, 50, 0.5), r"clearance of {} = -0.5: must be above 0"),
        ((50, 50), r"{}.shape = \(2,\)"),
        ((50, 50, math.nan), r"{}\[2\] = nan"),
        (np.zeros(13), r"{}\[3:7\] = .*norm is 0"),
    ],
)
def test_impossible_starts_and_goals_are_refused(end, value, message):
    with pytest.raises(ArgumentError, match=message.format(end)):
        simple_setup(FLAT, **(ENDS | {end: value}))


def test_ends_below_ground_are_refused_wherever_the_box_reaches():
    for end in ENDS:
        with pytest.raises(ArgumentError, match=f"clearance of {end} = -6"):
            simple_setup(FLAT, low=(0, 0, -50), **(ENDS | {end: (50, 50, -5)}))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"radius": 0.0}, "radius = 0.0"),
        ({"tolerance": -1.0}, "tolerance = -1.0: must be a speed above 0"),
        ({"tolerance": math.nan}, "tolerance = nan"),
        ({"body": -1.0}, "radius = -1.0"),
        ({"low": (0, 0)}, r"low.shape = \(2,\)"),
        ({"high": (100, 100, -1)}, "high = .*must be above low"),
        ({"authority": 0.0}, "authority = 0.0: must be above 0 and up to 1"),
        ({"authority": 1.5}, "authority = 1.5"),
        ({"authority": (0.1, 0.2)}, "one number or four"),
        ({"step": 0.0}, "step = 0.0"),
        ({"holds": (0, 5)}, r"holds = \(0, 5\)"),
        ({"holds": (6, 5)}, "1 <= least <= most"),
        ({"holds": 5}, "holds = 5"),
        ({"holds": (1.5, 5)}, "whole numbers"),
        ({"avoidance": 3}, "avoidance = 3"),
        ({"norm": "H1"}, "norm = 'H1'"),
    ],
)
def test_impossible_problems_are_refused(options, message):
    with pytest.raises(ArgumentError, match=message):
        simple_setup(FLAT, **(ENDS | options))


def test_unknown_terrains_are_refused():
    with pytest.raises(FileError, match="the catalogue has"):
        simple_setup("jacksborough", **ENDS)
    with pytest.raises(ArgumentError, match="terrain = 7: must be a Terrain, the name of one"):
        simple_setup(7, **ENDS)  # pyright: ignore[reportArgumentType]
    with pytest.raises(ArgumentError, match=r"body = 2.0: must be left out"):
        simple_setup(TerrainClearance(FLAT), body=2.0, **ENDS)
    with pytest.raises(ArgumentError, match="high = None: must be given"):
        simple_setup(lambda points: points[:, 2], low=LOW, **ENDS)


def test_goals_know_the_checker_of_their_space(si):
    with pytest.raises(ArgumentError, match="clearance of goal"):
        HelicopterGoal(si, (50, 50, 0.2))
    with pytest.raises(ArgumentError, match=r"speed of goal = 16.0: must be at most 15 m/s"):
        HelicopterGoal(si, model.make_state((50, 50, 20), velocity=(16, 0, 0)))


def test_spaces_of_other_sizes_are_refused(si):
    with pytest.raises(ArgumentError, match="space = 'of 7 numbers': must be of 13 numbers"):
        propagator(ob.SE3StateSpace(), si.getControlSpace())
    with pytest.raises(ArgumentError, match="controls = 'of 2 numbers'"):
        propagator(si.getStateSpace(), oc.RealVectorControlSpace(si.getStateSpace(), 2))


def test_spaces_can_be_printed_before_setup():
    """OMPL 2.0.1 crashes on a projection that is not set up; a crash would end the tests."""
    code = (
        "from ompl_risk import helicopter\n"
        "print(helicopter.state_space((0, 0, 0), (100, 100, 50)))\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False
    )
    assert run.returncode == 0
    assert "Helicopter" in run.stdout
