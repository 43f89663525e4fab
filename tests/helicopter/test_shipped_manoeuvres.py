"""How good the shipped manoeuvres are; that they are valid is in `test_primitive_library`."""

import numpy as np
import pytest

from ompl_risk.helicopter.library import SHIPPED, default_library
from ompl_risk.helicopter.library_file import read_library
from ompl_risk.helicopter.optimal_control.grid import Grid
from ompl_risk.helicopter.optimal_control.task import PLANE, SPACE, Task
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle

G, DT = 9.81, 0.02


@pytest.fixture(scope="module")
def shipped():
    return default_library()


def fewest_steps(change):
    """Least number of steps in which the collective alone changes the climb rate.

    Each step's acceleration is at most the limit, and at most k (or n + 1 - k) changes of the
    input away from the trim before (or behind) it.
    """
    most, a_step = (1.0, 4.0 * DT) if change > 0.0 else (0.8, 4.0 * DT)
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


def test_climbs_do_not_overshoot(shipped):
    for m in shipped.manoeuvres:
        if m.first.climb or m.last.climb:
            low, high = sorted([0.0, m.displacement[2]])
            assert m.track[:, 2].min() >= low - 1e-9
            assert m.track[:, 2].max() <= high + 1e-9


def test_level_manoeuvres_hardly_leave_their_height(shipped):
    level = [m for m in shipped.manoeuvres if m.first.climb == m.last.climb == 0.0]
    assert len(level) == 44
    assert max(np.abs(m.track[:, 2]).max() for m in level) < 0.2


def test_without_drag_only_the_difference_of_speeds_counts(shipped):
    """In the frame that moves along, all level flights are a hover."""
    changes = {}
    for m in shipped.manoeuvres:
        if m.first.speed != m.last.speed:
            mean = m.displacement[0] / m.duration
            assert mean == pytest.approx(0.5 * (m.first.speed + m.last.speed), abs=0.02)
            changes.setdefault(abs(m.last.speed - m.first.speed), set()).add(len(m.controls))
    assert changes == {10.0: {73}, 20.0: {100}, 30.0: {128}}


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
            assert 0.4 < share < 0.6
            assert abs(m.displacement[3]) < np.radians(11.0)


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
