"""The helicopter in OMPL: spaces, propagator, validity and goals."""

import math

import numpy as np
import pytest
from control_scene import HIGH, LOW, XCELL, control, hill, hop, numbers, some_states
from scipy.spatial.transform import Rotation

from ompl_risk import TerrainClearance
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.helicopter import model
from ompl_risk.helicopter.envelope import Envelope
from ompl_risk.helicopter.goals import HelicopterGoal
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.setup import ompl_state
from ompl_risk.helicopter.spaces import control_space, propagator, state_space
from ompl_risk.helicopter.validity import HelicopterValidityChecker


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


def test_planners_that_sample_hovers_get_every_heading(si):
    middle = model.make_state((50, 50, 30), heading=1.0)
    goal, state = HelicopterGoal(si, middle), si.allocState()
    assert goal.maxSampleCount() == 16
    headings = []
    for k in range(17):
        goal.sampleGoal(state)
        found = numbers(si, state)
        assert goal.distanceGoal(state) == 0.0
        assert (found[[0, 1, 2, 7, 8, 9, 10, 11, 12]] == middle[[0, 1, 2, *range(7, 13)]]).all()
        headings.append(2.0 * math.atan2(found[5], found[6]))
        assert k > 0 or (found == middle).all()
    turned = (np.array(headings) - 1.0) % (2.0 * math.pi)
    np.testing.assert_allclose(turned[:16], np.arange(16) * math.pi / 8.0, atol=1e-12)
    assert headings[16] == headings[0]


def test_planners_that_sample_goals_get_the_middle(si):
    middle = model.make_state((50, 50, 30), heading=1.0, velocity=(8, 0, 0))
    goal, state = HelicopterGoal(si, middle), si.allocState()
    goal.sampleGoal(state)
    assert (numbers(si, state) == middle).all()
    assert goal.maxSampleCount() == 1
    assert goal.distanceGoal(state) == 0.0
