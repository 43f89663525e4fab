"""The helicopter for OMPL: its state space, its control space, and how it moves."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob
from ompl import control as oc

from ompl_risk._arrays import FloatArray, as_floats
from ompl_risk._kernels import propagation
from ompl_risk.bridge import faults
from ompl_risk.bridge.buffers import Buffer, table
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.envelope import Envelope
from ompl_risk.helicopter.model import CONTROL, STATE
from ompl_risk.helicopter.parameters import Helicopter, Limits

Propagator = Callable[[ob.State, oc.Control, float, ob.State], None]

VELOCITY_WEIGHT = 0.5
"""Of the velocities in the distance of two states: 1 m/s or 1 rad/s counts as much as 0.5 m."""

GENTLE = (0.3, 0.005, 0.02, 0.012)
"""Parts of the inputs' ranges about hover that inputs drawn at random may take: within the second
for which one is held, they change speed and attitude by no more than can be undone."""


def state_space(
    low: ArrayLike, high: ArrayLike, limits: Limits | None = None
) -> ob.CompoundStateSpace:
    """SE(3) x R^6: position and orientation, then velocity and angular velocity in the body.

    In memory, and in ``serialize``, a state is the 13 numbers of ``ompl_risk.helicopter.model``.
    Each component of the velocity is bounded by the greatest speed, that of the angular velocity
    by the greatest rate; the limits that are no box are ``HelicopterValidityChecker``'s. The
    default projection is the position.

    Args:
        low: least position [m], shape (3,).
        high: greatest position [m], shape (3,).
        limits: what the helicopter may do.

    Raises:
        ArgumentError: a wrong shape, or a box without volume.
    """
    envelope = Envelope(low, high, limits)
    pose, motion = ob.SE3StateSpace(), ob.RealVectorStateSpace(6)
    pose.setBounds(_bounds(envelope.low, envelope.high))
    fastest = np.repeat([envelope.limits.speed, envelope.limits.rate], 3)
    motion.setBounds(_bounds(-fastest, fastest))
    space = ob.CompoundStateSpace()
    space.setName("Helicopter")
    space.addSubspace(pose, 1.0)
    space.addSubspace(motion, VELOCITY_WEIGHT)
    space.lock()
    # a compound space has no projection of its own, so setup() does not replace this one
    space.registerDefaultProjection(ob.SubspaceProjectionEvaluator(space, 0))
    space.setup()  # printing a projection that is not set up crashes OMPL 2.0.1
    return space


def control_space(
    space: ob.StateSpace,
    helicopter: Helicopter | None = None,
    limits: Limits | None = None,
    *,
    authority: ArrayLike = 1.0,
) -> oc.RealVectorControlSpace:
    """The four inputs u_c, u_psi [N], gamma_p, gamma_r [rad], with bounds.

    Planners that draw inputs at random want little of them, as ``GENTLE``: a rotor tilted by the
    full 0.2 rad turns the helicopter over within half a second.

    Args:
        space: from ``state_space``.
        helicopter: the vehicle.
        limits: what it may do.
        authority: the part of each input's range about hover that may be drawn, above 0 and up to
            1, for all of them or shape (4,).

    Raises:
        ArgumentError: an authority out of range.
    """
    helicopter = Helicopter() if helicopter is None else helicopter
    low, high = (Limits() if limits is None else limits).controls(helicopter)
    hover = np.array([helicopter.weight, 0.0, 0.0, 0.0])
    part = _authority(authority)
    controls = oc.RealVectorControlSpace(space, CONTROL)
    controls.setBounds(_bounds(hover + part * (low - hover), hover + part * (high - hover)))
    return controls


def propagator(
    space: ob.StateSpace,
    controls: oc.ControlSpace,
    helicopter: Helicopter | None = None,
) -> Propagator:
    """How the helicopter moves: one step of order 4 for each call.

    Pass it to ``setStatePropagator``. It serves one thread. Steps may be negative.

    Args:
        space: from ``state_space``.
        controls: from ``control_space``.
        helicopter: the vehicle.

    Raises:
        ArgumentError: spaces of other sizes.
    """
    state, control = Buffer(_size(space, "space", STATE)), Buffer(_size(controls, "controls", 4))
    given = (Helicopter() if helicopter is None else helicopter).given
    places = table(state.address, control.address, given.ctypes.data)
    buffers = (state, control, given, places)
    return _propagator(space, controls, buffers)


def _propagator(space: Any, controls: Any, buffers: tuple[Any, ...]) -> Propagator:
    """The callback. Everything that it uses is local to it: it is called a million times."""
    state, control, _, places = buffers
    read, read_control, write = space.serialize, controls.serialize, space.deserialize
    at, control_at, address = state.capsule, control.capsule, places.ctypes.data
    advance = propagation.advance
    advance(address, 0.0)  # compiles

    def propagate(start: ob.State, held: oc.Control, duration: float, result: ob.State) -> None:
        try:
            read(at, start)
            read_control(control_at, held)
            advance(address, duration)
            write(result, at)  # only now: OMPL may pass the same state as start and result
        except BaseException as error:
            if not faults.keep(error):
                raise
            buffers[0].numbers[:] = np.nan  # no valid state: ends this branch of the search
            write(result, at)

    return propagate


def _bounds(low: FloatArray, high: FloatArray) -> ob.RealVectorBounds:
    bounds = ob.RealVectorBounds(len(low))
    for k, (least, most) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        bounds.setLow(k, least)
        bounds.setHigh(k, most)
    return bounds


def _authority(value: ArrayLike) -> FloatArray:
    part = as_floats("authority", value)
    if part.shape not in ((), (CONTROL,)) or not ((part > 0.0) & (part <= 1.0)).all():
        raise ArgumentError("authority", value, "above 0 and up to 1, one number or four")
    return np.broadcast_to(part, (CONTROL,))


def _size(space: Any, name: str, wanted: int) -> int:
    found = space.getSerializationLength()
    if found != 8 * wanted:
        raise ArgumentError(name, f"of {found / 8:g} numbers", f"of {wanted} numbers")
    return wanted
