"""A manoeuvre from nothing: least time, then whole steps, then the last digits."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight_limits import (
    broken_in_changes,
    broken_in_controls,
    broken_in_states,
)
from ompl_risk.helicopter.optimal_control.course import Course, guess, resampled
from ompl_risk.helicopter.optimal_control.refining import end_error, refined
from ompl_risk.helicopter.optimal_control.shooting import MOST_STEP, Shooting
from ompl_risk.helicopter.optimal_control.task import Task
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle

COARSE = 50
"""Steps of the first search."""

LONGEST = COARSE * MOST_STEP
"""What no manoeuvre takes longer than [s]."""

EXTRA = 10
"""Steps that a manoeuvre may take more than the least time needs, before it is given up."""

TOLERANCE = 1e-10
"""Greatest error of an end."""


@dataclass(frozen=True, eq=False)
class Made:
    """The inputs of a manoeuvre.

    Args:
        controls: u_c [N], u_psi [N], gamma_p and gamma_r [rad] of each step, shape (n, 4).
        least: the least duration of a flight in n steps of free length [s].
        error: greatest error of the end against the last trim.
    """

    controls: FloatArray
    least: float
    error: float


def make(task: Task, vehicle: Vehicle) -> Made:
    """The manoeuvre of least time between two trims, in whole steps of ``vehicle.dt``.

    Of all flights of that duration it is the one whose inputs change least.

    Args:
        task: the two trims.
        vehicle: what flies.

    Raises:
        ArgumentError: the solver finds none within the limits less the reserve.
        ExtraError: CasADi is not installed.
    """
    fastest = _fastest(task, vehicle)
    fewest, problem = len(fastest.controls), ""
    for n in range(fewest, fewest + EXTRA + 1):
        attempt = Shooting(task, vehicle, n, vehicle.dt).solve(resampled(fastest, n))
        problem = attempt.status
        if attempt.solved:
            course = refined(task, attempt.course.controls, vehicle)
            problem = _fault(task, vehicle, course)
            if not problem:
                return Made(course.controls, fastest.duration, _worst(task, course))
    raise _failure(task, problem)


def _fastest(task: Task, vehicle: Vehicle) -> Course:
    """The flight of least time in the least number of steps that are not longer than dt."""
    first = guess(task, COARSE, vehicle.helicopter.gravity)
    course = _shortest(task, vehicle, first)
    tried: dict[int, Course] = {}
    n = _whole(course.duration, vehicle.dt)
    while n not in tried:
        tried[n] = course = _shortest(task, vehicle, resampled(course, n))
        n = _whole(course.duration, vehicle.dt)
    return min(tried.values(), key=lambda c: (c.step > vehicle.dt, len(c.controls)))


def _shortest(task: Task, vehicle: Vehicle, start: Course) -> Course:
    """The flight of least time in as many steps as a first guess has."""
    attempt = Shooting(task, vehicle, len(start.controls)).solve(start)
    if not attempt.solved:
        raise _failure(task, attempt.status)
    return attempt.course


def _whole(duration: float, step: float) -> int:
    return math.ceil(duration / step - 1e-9)


def _worst(task: Task, course: Course) -> float:
    return float(np.abs(end_error(task, course.states[-1])).max())


def _fault(task: Task, vehicle: Vehicle, course: Course) -> str:
    """What is wrong with a flight; nothing if all is well."""
    worst = _worst(task, course)
    if not worst <= TOLERANCE:
        return f"an end that is off by {worst:.3g}"
    limits, helicopter = vehicle.kept, vehicle.helicopter
    controls = np.vstack([task.first.control, course.controls, task.last.control])
    broken = (
        broken_in_states(limits, course.states)
        or broken_in_controls(limits, helicopter, controls)
        or broken_in_changes(limits, helicopter, controls, vehicle.dt)
    )
    return "" if broken is None else str(broken)


def _failure(task: Task, problem: str) -> ArgumentError:
    allowed = (
        f"a pair of trims that can be joined within the limits less the reserve and {LONGEST:g} s"
    )
    return ArgumentError("manoeuvre", task.name, f"{allowed}; the solver left: {problem}")
