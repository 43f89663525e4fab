"""The helicopter's motion: states, their derivatives, and flights under given controls."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive, readonly, real_number
from ompl_risk._kernels import propagation, rigid_body
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter

STATE = rigid_body.STATE
"""Numbers in a state: position [m] in the world, quaternion (x, y, z, w) from body to world,
velocity [m/s] and angular velocity [rad/s], both in the body's frame (forward, left, up)."""

CONTROL = 4
"""Numbers in a control: collective u_c and yaw force u_psi [N], pitch and roll of the rotor
gamma_p and gamma_r [rad]."""

UNIT_TOLERANCE = 1e-9
"""Largest deviation of a quaternion's norm from 1; OMPL allows as much."""


def make_state(
    position: ArrayLike,
    *,
    heading: float | None = None,
    orientation: ArrayLike | None = None,
    velocity: ArrayLike = (0.0, 0.0, 0.0),
    rates: ArrayLike = (0.0, 0.0, 0.0),
) -> FloatArray:
    """A state from its parts; at rest, level and heading east where nothing else is said.

    Args:
        position: x, y, z [m] in the world, east, north and up.
        heading: of a level body, counterclockwise from east [rad]; not with ``orientation``.
        orientation: unit quaternion (x, y, z, w) from body to world.
        velocity: in the body's frame, forward, left and up [m/s].
        rates: angular velocity in the body's frame [rad/s].

    Returns:
        Read-only, shape (13,).

    Raises:
        ArgumentError: a wrong shape, a number that is not finite, a quaternion whose norm is not
            1, or both a heading and an orientation.

    Example:
        >>> make_state((0, 0, 50), heading=math.pi / 2, velocity=(20, 0, 0))[3:8].round(3)
        array([ 0.   ,  0.   ,  0.707,  0.707, 20.   ])
    """
    if heading is not None and orientation is not None:
        raise ArgumentError("heading", heading, "left out where an orientation is given")
    if orientation is None:
        half = 0.5 * _angle("heading", 0.0 if heading is None else heading)
        orientation = (0.0, 0.0, math.sin(half), math.cos(half))
    parts = [
        readonly("position", position, (3,), "(3,): x, y, z [m]"),
        readonly("orientation", orientation, (4,), "(4,): a unit quaternion x, y, z, w"),
        readonly("velocity", velocity, (3,), "(3,): forward, left, up [m/s]"),
        readonly("rates", rates, (3,), "(3,): about the body's axes [rad/s]"),
    ]
    _check_norm("orientation", parts[1])
    return readonly("state", np.concatenate(parts), (STATE,), "(13,)")


def as_state(name: str, value: ArrayLike) -> FloatArray:
    """A read-only state, shape (13,).

    Args:
        name: what errors call it.
        value: a state, or a position [m], shape (3,): at rest there, level and heading east.

    Raises:
        ArgumentError: a wrong shape, a number that is not finite, or a quaternion whose norm is
            not 1.
    """
    shape = np.shape(value)
    if shape == (3,):
        return make_state(readonly(name, value, (3,), "(3,)"))
    state = readonly(name, value, (STATE,), "(3,): a position, or (13,): a state")
    _check_norm(f"{name}[3:7]", state[3:7])
    return state


def control_matrix(helicopter: Helicopter, gamma_p: float, gamma_r: float) -> FloatArray:
    """The paper's F(gamma): (torque [N m], force [N]) = F(gamma) (u_c, u_psi), shape (6, 2).

    Args:
        helicopter: gives the arms of hub and tail.
        gamma_p: pitch of the rotor [rad].
        gamma_r: roll of the rotor [rad].

    Raises:
        ArgumentError: an angle that is not finite.

    Reference: Nair and Kobilarov, below eq. (8).
    """
    angles = _angle("gamma_p", gamma_p), _angle("gamma_r", gamma_r)
    columns = [
        propagation.load_on_body(np.array([*u, *angles]), helicopter.given)
        for u in ((1.0, 0.0), (0.0, 1.0))
    ]
    return np.column_stack(columns)


def derivative(helicopter: Helicopter, state: ArrayLike, control: ArrayLike) -> FloatArray:
    """Time derivative of a state, eqs. (7) and (8).

    Args:
        helicopter: the vehicle.
        state: shape (13,).
        control: shape (4,).

    Returns:
        Shape (13,): velocity in the world, rate of the quaternion, accelerations in the body.

    Raises:
        ArgumentError: a state or control that is none.

    Reference: Nair and Kobilarov, eqs. (7) and (8).
    """
    u = readonly("control", control, (CONTROL,), "(4,): u_c, u_psi, gamma_p, gamma_r")
    return propagation.derivative(as_state("state", state), u, helicopter.given)


def simulate(
    helicopter: Helicopter, start: ArrayLike, controls: ArrayLike, *, dt: float = 0.02
) -> FloatArray:
    """The flight under controls that are held for dt each.

    The classical Runge-Kutta method of order 4, one step for each control, after which the
    quaternion is scaled to norm 1.

    Args:
        helicopter: the vehicle.
        start: a state, shape (13,), or a position to start from at rest, shape (3,) [m].
        controls: u_c, u_psi [N], gamma_p and gamma_r [rad], shape (n, 4).
        dt: [s].

    Returns:
        States at 0, dt, ..., n dt, shape (n + 1, 13).

    Raises:
        ArgumentError: a start, a control or a step that is none.

    Example:
        >>> machine = Helicopter()
        >>> states = simulate(machine, (0, 0, 50), [[machine.weight, 0, 0, 0]] * 100)
        >>> bool(abs(states[-1] - states[0]).max() < 1e-12)
        True
    """
    inputs = readonly("controls", controls, (None, CONTROL), "(n, 4)")
    states = np.empty((len(inputs) + 1, STATE))
    step = positive("dt", dt)
    rigid_body.rollout(as_state("start", start), inputs, step, helicopter.given, states)
    return states


def world_velocity(state: ArrayLike) -> FloatArray:
    """Velocity in the world, R v [m/s], shape (3,)."""
    return propagation.velocity_in_world(as_state("state", state))


def _angle(name: str, value: float) -> float:
    angle = real_number(name, value, "a finite angle [rad]")
    if not math.isfinite(angle):
        raise ArgumentError(name, value, "a finite angle [rad]")
    return angle


def _check_norm(name: str, quaternion: FloatArray) -> None:
    norm = float(np.linalg.norm(quaternion))
    if abs(norm - 1.0) > UNIT_TOLERANCE:
        raise ArgumentError(
            name, quaternion.tolist(), f"a unit quaternion x, y, z, w; its norm is {norm:.9g}"
        )
