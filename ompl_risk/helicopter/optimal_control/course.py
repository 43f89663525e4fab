"""A flight as states and controls at equal steps, and what to try first."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.helicopter.optimal_control.task import Task

USUAL_RATE = 0.5
"""Rate of turn at which to bring the attitude from one trim to another, for a guess [rad/s]."""


class Course(NamedTuple):
    """A flight in equal steps.

    Args:
        step: duration of a step [s].
        controls: the control of each step, shape (n, 4).
        states: the states between them, shape (n + 1, 13).
    """

    step: float
    controls: FloatArray
    states: FloatArray

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.step * len(self.controls)


def guess(task: Task, steps: int, gravity: float) -> Course:
    """The straight line between the two trims in all numbers, at a leisurely pace."""
    start, end = task.first.state(), task.last.state()
    change = math.dist(task.first.velocity, task.last.velocity) / gravity
    duration = 1.0 + change + math.dist(start[3:7], end[3:7]) / USUAL_RATE
    share = np.linspace(0.0, 1.0, steps + 1)[:, None]
    states = start * (1.0 - share) + end * share
    states[:, 3:7] /= np.linalg.norm(states[:, 3:7], axis=1)[:, None]
    states[1:, 0] = np.cumsum(states[:-1, 7]) * duration / steps
    controls = task.first.control * (1.0 - share[1:]) + task.last.control * share[1:]
    return Course(duration / steps, controls, states)


def resampled(course: Course, steps: int) -> Course:
    """The same flight in another number of steps, by linear interpolation."""
    old, new = _edges(len(course.controls)), _edges(steps)
    old_middles, new_middles = 0.5 * (old[1:] + old[:-1]), 0.5 * (new[1:] + new[:-1])
    states = [np.interp(new, old, column) for column in course.states.T]
    controls = [np.interp(new_middles, old_middles, column) for column in course.controls.T]
    return Course(course.duration / steps, np.transpose(controls), np.transpose(states))


def _edges(steps: int) -> FloatArray:
    return np.linspace(0.0, 1.0, steps + 1)
