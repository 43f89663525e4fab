"""The last digits of a manoeuvre: inputs corrected until the compiled model ends in the trim."""

from __future__ import annotations

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import rigid_body
from ompl_risk.helicopter.optimal_control.course import Course
from ompl_risk.helicopter.optimal_control.dynamics import product
from ompl_risk.helicopter.optimal_control.task import SPEEDS, Task, Z
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle

NUDGE = 1e-5
"""Change of an input for a difference quotient, in ranges."""

ENOUGH = 1e-13
"""Error of the end that is rounding."""

ROUNDS = 8


def replayed(task: Task, controls: FloatArray, vehicle: Vehicle) -> Course:
    """The flight under these inputs, from position 0 and heading 0, by the compiled model."""
    states = _flown(task.first.state(), controls, vehicle)
    return Course(vehicle.dt, controls, states)


def end_error(task: Task, end: FloatArray) -> FloatArray:
    """What separates the end of a flight from the last trim at the same place.

    Of the attitude q, the vector part of q q_trim^-1, without its vertical component if the
    heading is free; then velocity and angular velocity and, between level trims, height.
    """
    wanted = task.last.state()
    x, y, z, w = product(end[3:SPEEDS], wanted[3:SPEEDS] * np.array([-1.0, -1.0, -1.0, 1.0]))
    attitude = [x, y] if task.turning else np.sign(w) * np.array([x, y, z])
    height = end[Z : Z + 1] if task.level else end[:0]
    return np.concatenate([attitude, end[SPEEDS:] - wanted[SPEEDS:], height])


def refined(task: Task, controls: FloatArray, vehicle: Vehicle) -> Course:
    """The flight with the least change of its inputs that ends in the last trim, to rounding.

    Gauss-Newton with steps of minimum norm, ``du = -J^+ e``, J by differences of flights.

    Args:
        task: the two trims.
        controls: the inputs of a flight that nearly ends in the last one, shape (n, 4).
        vehicle: what flies.
    """
    places, ranges = list(task.motion.controls), vehicle.ranges
    best = replayed(task, controls, vehicle)
    error = end_error(task, best.states[-1])
    for _ in range(ROUNDS):
        if np.abs(error).max() < ENOUGH:
            break
        change = np.linalg.lstsq(_jacobian(task, best, vehicle), -error, rcond=1e-12)[0]
        corrected = best.controls.copy()
        corrected[:, places] += change.reshape(-1, len(places)) * ranges[places]
        trial = replayed(task, corrected, vehicle)
        trial_error = end_error(task, trial.states[-1])
        if np.abs(trial_error).max() >= np.abs(error).max():
            break
        best, error = trial, trial_error
    return best


def _jacobian(task: Task, course: Course, vehicle: Vehicle) -> FloatArray:
    """Derivatives of the error at the end by the inputs of every step, in ranges."""
    columns = [
        (_nudged(task, course, k, i, NUDGE, vehicle) - _nudged(task, course, k, i, -NUDGE, vehicle))
        / (2.0 * NUDGE)
        for k in range(len(course.controls))
        for i in task.motion.controls
    ]
    return np.transpose(columns)


def _nudged(
    task: Task, course: Course, k: int, i: int, nudge: float, vehicle: Vehicle
) -> FloatArray:
    """The error at the end if input i of step k is another."""
    rest = course.controls[k:].copy()
    rest[0, i] += nudge * vehicle.ranges[i]
    return end_error(task, _flown(course.states[k], rest, vehicle)[-1])


def _flown(start: FloatArray, controls: FloatArray, vehicle: Vehicle) -> FloatArray:
    states = np.empty((len(controls) + 1, rigid_body.STATE))
    rigid_body.rollout(start, controls, vehicle.dt, vehicle.helicopter.given, states)
    return states
