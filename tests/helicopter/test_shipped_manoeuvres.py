"""How good the shipped manoeuvres are; that they are valid is in `test_primitive_library`."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ompl_risk.helicopter.library import SHIPPED, default_library
from ompl_risk.helicopter.library_file import read_library
from ompl_risk.helicopter.optimal_control.grid import Grid
from ompl_risk.helicopter.optimal_control.task import PLANE, SPACE, Task
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle
from ompl_risk.helicopter.parameters import Limits
from ompl_risk.helicopter.trims import solve_trim

G, DT = 9.81, 0.02


@pytest.fixture(scope="module")
def shipped():
    return default_library()


def fewest_steps(change):
    """Least number of steps in which the collective alone changes the climb rate.

    Each step's acceleration is at most nine tenths of the limit, and at most k (or n + 1 - k)
    changes of the input away from the trim before (or behind) it.
    """
    most, a_step = (0.9 * (1.0 if change > 0.0 else 0.8)), 0.9 * 4.0 * DT
    n = 1
    while True:
        k = np.arange(1, n + 1)
        gain = G * DT * np.minimum(most, a_step * np.minimum(k, n + 1 - k)).sum()
        if gain >= abs(change):
            return n
        n += 1


def test_no_climb_takes_a_step_more_than_the_collective_needs(shipped):
    climbing = [m for m in shipped.manoeuvres if m.first.climb or m.last.climb]
    assert len(climbing) == 28
    for m in climbing:
        assert len(m.controls) == fewest_steps(m.last.climb - m.first.climb), m.number


def most_used(shipped):
    """Greatest use of each limit by the manoeuvres, as a share of it; trims included."""
    weight = 8.2 * G
    used = {}
    for m in shipped.manoeuvres:
        u = np.vstack([m.first.control, m.controls, m.last.control])
        changes = np.abs(np.diff(u, axis=0)) / DT
        up = Rotation.from_quat(m.states[:, 3:7]).as_matrix()[:, 2, 2]
        shares = {
            "lift above": (u[:, 0].max() / weight - 1.0) / (2.0 - 1.0),
            "lift below": (1.0 - u[:, 0].min() / weight) / (1.0 - 0.2),
            "yaw force": np.abs(u[:, 1]).max() / 6.0,
            "tilt": np.abs(u[:, 2:]).max() / 0.2,
            "lift rate": changes[:, 0].max() / (4.0 * weight),
            "yaw force rate": changes[:, 1].max() / 30.0,
            "tilt rate": changes[:, 2:].max() / 2.0,
            "speed": np.linalg.norm(m.states[:, 7:10], axis=1).max() / 35.0,
            "rate": np.abs(m.states[:, 10:]).max() / 2.0,
            "attitude": np.arccos(np.minimum(up, 1.0)).max() / 1.1,
        }
        used = {name: max(share, used.get(name, 0.0)) for name, share in shares.items()}
    return used


def test_a_tenth_of_every_limit_is_left_for_corrections(shipped):
    used = most_used(shipped)
    assert max(used.values()) <= 0.9
    bind = {name for name, share in used.items() if share > 0.9 * (1.0 - 1e-5)}
    assert bind == {
        "lift above", "lift below", "tilt", "lift rate", "tilt rate", "rate", "attitude"
    }  # fmt: skip
    assert [used[n] for n in ("speed", "yaw force")] == pytest.approx([0.874, 0.232], abs=1e-3)


def test_manoeuvres_keep_to_the_limits_less_the_reserve(shipped):
    kept = Limits().scaled(0.9)
    assert kept == Vehicle().kept
    for m in shipped.manoeuvres:
        assert m.broken_limit(shipped.helicopter, kept) is None
        for key in (m.first.key, m.last.key):
            solve_trim(shipped.helicopter, *key, limits=kept)  # refuses what breaks them


def test_climbs_do_not_overshoot(shipped):
    for m in shipped.manoeuvres:
        if m.first.climb or m.last.climb:
            low, high = sorted([0.0, m.displacement[2]])
            assert m.track[:, 2].min() >= low - 1e-9
            assert m.track[:, 2].max() <= high + 1e-9


def test_level_manoeuvres_hardly_leave_their_height(shipped):
    sinks, level = {0.0: 0.003, 10.0: 0.221, 20.0: 0.310, 30.0: 0.439}, 0
    for m in shipped.manoeuvres:
        if m.first.climb == m.last.climb == 0.0:
            level += 1
            assert m.track[:, 2].max() < (0.036 if m.first.turn or m.last.turn else 0.0061)
            assert m.track[:, 2].min() > -sinks[abs(m.last.speed - m.first.speed)]
    assert level == 44


def test_without_drag_only_the_difference_of_speeds_counts(shipped):
    """In the frame that moves along, all level flights are a hover."""
    changes = {}
    for m in shipped.manoeuvres:
        if m.first.speed != m.last.speed:
            mean = m.displacement[0] / m.duration
            assert mean == pytest.approx(0.5 * (m.first.speed + m.last.speed), abs=1e-5)
            changes.setdefault(abs(m.last.speed - m.first.speed), set()).add(len(m.controls))
    assert changes == {10.0: {77}, 20.0: {110}, 30.0: {143}}


def test_same_climb_takes_as_long_at_any_speed(shipped):
    lengths = {}
    for m in shipped.manoeuvres:
        if m.first.climb or m.last.climb:
            lengths.setdefault((m.first.climb, m.last.climb), set()).add(len(m.controls))
    assert all(len(found) == 1 for found in lengths.values())
    assert len(lengths) == 8


def test_turning_in_and_out_barely_turns(shipped):
    for m in shipped.manoeuvres:
        turn = m.first.turn + m.last.turn
        if turn:
            share = m.displacement[3] / (turn * m.duration)
            assert 0.44 < share < 0.51
            assert abs(m.displacement[3]) < np.radians(11.8)


def test_shipped_file_is_what_the_default_grid_asks_for():
    contents, vehicle = read_library(SHIPPED), Vehicle()
    tasks = Grid().tasks(vehicle)
    assert contents.helicopter == vehicle.helicopter
    assert contents.limits == vehicle.limits
    assert contents.dt == vehicle.dt
    np.testing.assert_array_equal(contents.speeds, Grid().speeds)
    np.testing.assert_array_equal(contents.turns, Grid().turns)
    assert [tuple(c) for c in contents.climbs] == [Grid().climbs_at(v) for v in Grid().speeds]
    keys = [(m.first, m.last) for m in contents.manoeuvres]
    assert keys == [(task.first.key, task.last.key) for task in tasks]
    assert [task.motion is SPACE for task in tasks] == [bool(a.turn or b.turn) for a, b in keys]


def test_tasks_have_readable_names(shipped):
    level, turn, climb = shipped.trim(10.0), shipped.trim(0.0, 0.0, 0.3), shipped.trim(10.0, -2.0)
    assert Task(level, climb).name == "10 m/s to 10 m/s climb -2"
    assert Task(turn, shipped.trim(0.0)).name == "0 m/s turn +0.3 to 0 m/s"
    assert Task(level, climb).motion is PLANE
    assert not Task(level, climb).level
    assert Task(level, turn).level
