"""The helicopter in OMPL: spaces, propagator, validity, goals, and problems that planners solve."""

import gc
import math
import weakref

import numpy as np
import pytest
from ompl import base as ob
from ompl import control as oc
from ompl import util as ou
from scipy.spatial.transform import Rotation

from ompl_risk import RiskObjective, TerrainClearance, Trajectory
from ompl_risk._kernels import propagation
from ompl_risk.errors import ArgumentError, FileError, TrapWarning
from ompl_risk.helicopter import model
from ompl_risk.helicopter.buffers import Buffer
from ompl_risk.helicopter.envelope import Envelope
from ompl_risk.helicopter.goals import HelicopterGoal
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.setup import HEADROOM, ompl_state, simple_setup
from ompl_risk.helicopter.spaces import control_space, propagator, state_space
from ompl_risk.helicopter.validity import HelicopterValidityChecker
from ompl_risk.terrains import Terrain

ou.setLogLevel(ou.LOG_NONE)

XCELL = Helicopter()
LOW, HIGH = np.array([0.0, 0.0, 0.0]), np.array([200.0, 200.0, 100.0])
CALM = Limits(speed=15.0, rate=0.5, attitude=0.4)
PLANNERS = [oc.RRT, oc.EST, oc.KPIECE1]


def hill():
    y, x = np.mgrid[0:21, 0:21] * 10.0
    return Terrain(
        30.0 * np.exp(-((x - 100) ** 2 + (y - 100) ** 2) / 800), spacing=(10.0, 10.0), name="hill"
    )


def hop(**options):
    """Thirty metres straight on over flat ground: solved in a blink."""
    flat = Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0))
    ends = [model.make_state((x, 50, 20), velocity=(6, 0, 0)) for x in (30, 60)]
    usual = {"radius": 6.0, "tolerance": 3.0, "limits": CALM, "step": 0.1, "holds": (3, 12)}
    return simple_setup(flat, start=ends[0], goal=ends[1], high=(100, 100, 40), **(usual | options))


def numbers(si, state):
    buffer = Buffer(13)
    si.getStateSpace().serialize(buffer.capsule, state)
    return buffer.numbers


def control(si, values):
    held = si.allocControl()
    for k, value in enumerate(values):
        held[k] = float(value)
    return held


def some_states(n, seed=0):
    """Around the limits: about half of each kind breaks it."""
    rng = np.random.default_rng(seed)
    tilt = Rotation.from_rotvec(rng.standard_normal((n, 3)) * 0.6)
    turn = (Rotation.from_euler("z", rng.uniform(-3, 3, (n, 1))) * tilt).as_quat()
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return np.column_stack(
        [
            rng.uniform(LOW - 20, HIGH + 20, (n, 3)),
            turn,
            rng.standard_normal((n, 3)) * 15.0,
            rng.uniform(-2.5, 2.5, (n, 3)),
        ]
    )


def after(calls):
    """Ends a search after so many questions: unlike a time limit, it reproduces."""
    left = iter(range(calls))
    return ob.PlannerTerminationCondition(lambda: next(left, None) is None)


@pytest.fixture
def si():
    found = hop().getSpaceInformation()
    found.setup()
    return found


# spaces


def test_a_state_in_memory_is_that_of_the_model(si):
    state = some_states(1)[0]
    made = ompl_state(si, state)
    assert (numbers(si, made) == state).all()
    pose, motion = made[0], made[1]
    assert [pose.getX(), pose.getY(), pose.getZ()] == state[:3].tolist()
    turn = pose.rotation()
    assert [turn.x, turn.y, turn.z, turn.w] == state[3:7].tolist()
    assert motion[0:6] == state[7:].tolist()


def test_bounds_of_the_state_space_are_box_and_limits():
    space = state_space(LOW, HIGH, Limits(speed=20.0, rate=1.5))
    pose, motion = space.getSubspace(0).getBounds(), space.getSubspace(1).getBounds()
    assert (list(pose.low), list(pose.high)) == (LOW.tolist(), HIGH.tolist())
    assert list(motion.high) == [20.0] * 3 + [1.5] * 3
    assert list(motion.low) == [-20.0] * 3 + [-1.5] * 3


def test_the_projection_is_the_position_and_survives_setup(si):
    si.setup()
    space = si.getStateSpace()
    space.setup()
    projection = space.getDefaultProjection()
    assert projection.getDimension() == 3
    place = np.zeros(3)
    projection.project(ompl_state(si, some_states(1)[0]), place)
    assert place.tolist() == some_states(1)[0][:3].tolist()


def test_authority_narrows_the_inputs_about_hover():
    space = state_space(LOW, HIGH)
    low, high = Limits().controls(XCELL)
    hover = np.array([XCELL.weight, 0, 0, 0])

    def bounds(authority):
        found = control_space(space, XCELL, authority=authority).getBounds()
        return np.array(found.low), np.array(found.high)

    for found, wanted in zip(bounds(1.0), (low, high), strict=True):
        assert found == pytest.approx(wanted)
    parts = np.array([0.5, 0.1, 0.2, 1.0])
    for found, limit in zip(bounds(parts), (low, high), strict=True):
        assert found == pytest.approx(hover + parts * (limit - hover))


# propagator


@pytest.mark.parametrize("machine", [XCELL, Helicopter(9.0, drag=(1, 1, 1), wind=(3, 0, 0))])
def test_the_propagator_flies_as_the_model(machine):
    si = hop(helicopter=machine).getSpaceInformation()
    start, result = some_states(1, seed=4)[0], si.allocState()
    u = np.array([70.0, 1.0, 0.03, -0.05])
    begin = ompl_state(si, start)
    si.propagate(begin, control(si, u), 7, result)  # OMPL: from the second step on in place
    wanted = model.simulate(machine, start, np.tile(u, (7, 1)), dt=0.1)[-1]
    assert (numbers(si, result) == wanted).all()
    assert (numbers(si, begin) == start).all()


def test_the_propagator_may_write_where_it_reads(si):
    step = propagator(si.getStateSpace(), si.getControlSpace())
    start, u = some_states(1, seed=4)[0], [70.0, 1.0, 0.03, -0.05]
    state = ompl_state(si, start)
    step(state, control(si, u), 0.02, state)
    assert (numbers(si, state) == model.simulate(XCELL, start, [u])[1]).all()


def test_steps_backwards_undo_steps_forwards(si):
    step = propagator(si.getStateSpace(), si.getControlSpace())
    start, u = some_states(1, seed=4)[0], control(si, [70.0, 1.0, 0.03, -0.05])
    state = ompl_state(si, start)
    for dt in [0.02] * 10 + [-0.02] * 10:
        step(state, u, dt, state)
    assert numbers(si, state) == pytest.approx(start, abs=1e-5)


def test_propagators_do_not_share_memory():
    first, second = hop().getSpaceInformation(), hop().getSpaceInformation()
    a, b = some_states(2, seed=4)
    u = [70.0, 1.0, 0.03, -0.05]
    results = [si.allocState() for si in (first, second)]
    for si, start, result in zip((first, second), (a, b), results, strict=True):
        si.propagate(ompl_state(si, start), control(si, u), 1, result)
    found = [numbers(si, result) for si, result in zip((first, second), results, strict=True)]
    for x, start in zip(found, (a, b), strict=True):
        assert (x == model.simulate(XCELL, start, [u], dt=0.1)[1]).all()


# validity


def test_validity_is_all_limits_and_a_clearance_above_0():
    si = hop().getSpaceInformation()
    limits = Limits(speed=25.0, rate=2.0, attitude=0.7)
    clearance = TerrainClearance(hill(), 3.0)
    checker = HelicopterValidityChecker(si, clearance, Envelope(LOW, HIGH, limits))
    states = some_states(3000)
    up = Rotation.from_quat(states[:, 3:7]).apply([0, 0, 1])[:, 2]
    each = [
        np.linalg.norm(states[:, 7:10], axis=1) <= 25.0,
        np.abs(states[:, 10:]).max(axis=1) <= 2.0,
        np.arccos(np.clip(up, -1, 1)) <= 0.7,
        ((states[:, :3] >= LOW) & (states[:, :3] <= HIGH)).all(axis=1),
        clearance(states[:, :3]) > 0.0,
    ]
    wanted = np.all(each, axis=0)
    found = np.array([checker.isValid(ompl_state(si, state)) for state in states])
    assert (found == wanted).all()
    assert all(
        (~one & np.all(each[:k] + each[k + 1 :], axis=0)).any() for k, one in enumerate(each)
    )


def test_validity_over_any_clearance_is_that_over_terrain():
    si = hop().getSpaceInformation()
    clearance, envelope = TerrainClearance(hill(), 3.0), Envelope(LOW, HIGH)
    compiled = HelicopterValidityChecker(si, clearance, envelope)
    asked = HelicopterValidityChecker(si, lambda points: 1.0 * clearance(points), envelope)
    states = some_states(500, seed=1)
    states[:, 7:] *= 0.3
    states[:, 2] *= 0.3
    answers = [(compiled.isValid(s), asked.isValid(s)) for s in (ompl_state(si, x) for x in states)]
    assert all(a == b for a, b in answers)
    assert 50 < sum(a for a, _ in answers) < 450
    state = ompl_state(si, states[0])
    assert compiled.clearance(state) == pytest.approx(clearance(states[:1, :3])[0])
    assert type(compiled.isValid(state)) is type(asked.isValid(state)) is bool


@pytest.mark.parametrize("k", range(13))
def test_a_state_with_a_number_that_is_none_is_not_valid(si, k):
    checker = si.getStateValidityChecker()
    buffer, state = Buffer(13), si.allocState()
    buffer.numbers[:] = model.make_state((50, 50, 20))
    si.getStateSpace().deserialize(state, buffer.capsule)
    assert checker.isValid(state)
    buffer.numbers[k] = math.nan
    si.getStateSpace().deserialize(state, buffer.capsule)
    if k not in (5, 6):  # z and w of the quaternion: the attitude does not depend on them
        assert not checker.isValid(state)


def test_a_state_on_the_limit_is_valid_and_one_beyond_is_not(si):
    checker = HelicopterValidityChecker(
        si, TerrainClearance(hill(), 0.0), Envelope(LOW, HIGH, Limits(speed=20.0, rate=1.0))
    )
    for beyond, wanted in ((1.0, True), (1.0 + 1e-6, False)):
        for parts in ({"velocity": (0, 0, 20.0 * beyond)}, {"rates": (0, -1.0 * beyond, 0)}):
            state = ompl_state(si, model.make_state((50, 50, 50), **parts))
            assert checker.isValid(state) is wanted


# goals


def test_a_goal_is_reached_near_its_position_at_nearly_its_velocity(si):
    middle = model.make_state((50, 50, 30), heading=1.0, velocity=(8, 0, 0))
    goal = HelicopterGoal(si, middle, radius=4.0, tolerance=2.0)
    u = model.world_velocity(middle)
    states = some_states(300, seed=2)
    states[:, :3] = middle[:3] + np.random.default_rng(3).standard_normal((300, 3)) * 3.0
    wished = u + np.random.default_rng(4).standard_normal((300, 3)) * 1.5
    states[:, 7:10] = Rotation.from_quat(states[:, 3:7]).inv().apply(wished)
    apart = np.linalg.norm(states[:, :3] - middle[:3], axis=1) / 4.0
    wanted = np.maximum(apart, np.linalg.norm(wished - u, axis=1) / 2.0)
    made = [ompl_state(si, state) for state in states]
    assert [goal.distanceGoal(s) for s in made] == pytest.approx(wanted.tolist(), rel=1e-9)
    reached = [goal.isSatisfied(s) for s in made]
    assert reached == (wanted <= 1.0).tolist()
    assert 30 < sum(reached) < 270


def test_without_a_tolerance_any_velocity_will_do(si):
    goal = HelicopterGoal(si, (50, 50, 30), radius=4.0, tolerance=math.inf)
    fast = model.make_state((52, 50, 30), velocity=(14, 0, 0))
    assert goal.distanceGoal(ompl_state(si, fast)) == pytest.approx(0.5)


def test_planners_that_sample_goals_get_the_middle(si):
    middle = model.make_state((50, 50, 30), heading=1.0, velocity=(8, 0, 0))
    goal, state = HelicopterGoal(si, middle), si.allocState()
    goal.sampleGoal(state)
    assert (numbers(si, state) == middle).all()
    assert goal.maxSampleCount() == 1
    assert goal.distanceGoal(state) == 0.0


# problems


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
