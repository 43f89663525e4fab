"""States and controls of a control space as numbers, and flights as OMPL's paths."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import control as oc

from ompl_risk.bridge.buffers import Buffer
from ompl_risk.errors import ArgumentError

WHOLE = 1e-9
"""How far the number of propagation steps may be from a whole number."""


class HeldFlight(Protocol):
    """Inputs at a fixed rate, and the states that they lead through."""

    @property
    def dt(self) -> float:
        """Time for which each input is held [s]."""
        ...

    @property
    def states(self) -> NDArray[np.float64]:
        """Shape (n + 1, width)."""
        ...

    @property
    def controls(self) -> NDArray[np.float64]:
        """Shape (n, m)."""
        ...


class ControlBuffers:
    """One state and one control that are read and written as numbers, some 90 ns each.

    OMPL's paths and its ``propagate`` copy what they are given, so one of each serves for many.
    (A control that Python allocates is never freed, which is another reason.) Its state keeps the
    space information alive: a callback of that one should not hold it.

    Args:
        si: over a control space.

    Attributes:
        width: numbers in a state.
        control_width: numbers in a control.
        state: OMPL's state.
        control: OMPL's control.
    """

    def __init__(self, si: oc.SpaceInformation) -> None:
        self._space: Any = si.getStateSpace()
        self._controls: Any = si.getControlSpace()
        self.width = self._space.getSerializationLength() // 8
        self.control_width = self._controls.getSerializationLength() // 8
        self.state: Any = si.allocState()
        self.control: Any = si.allocControl()
        self._numbers, self._inputs = Buffer(self.width), Buffer(self.control_width)

    def write_state(self, numbers: NDArray[np.float64]) -> Any:
        """``state``, with these numbers, shape (width,)."""
        self._numbers.numbers[:] = numbers
        self._space.deserialize(self.state, self._numbers.capsule)
        return self.state

    def write_control(self, numbers: NDArray[np.float64]) -> Any:
        """``control``, with these numbers, shape (control_width,)."""
        self._inputs.numbers[:] = numbers
        self._controls.deserialize(self.control, self._inputs.capsule)
        return self.control

    def read_state(self, state: ob.State) -> NDArray[np.float64]:
        """The numbers of any state of the space, shape (width,)."""
        self._space.serialize(self._numbers.capsule, state)
        return self._numbers.numbers.copy()

    def read_control(self, control: oc.Control) -> NDArray[np.float64]:
        """The numbers of any control of the space, shape (control_width,)."""
        self._controls.serialize(self._inputs.capsule, control)
        return self._inputs.numbers.copy()


def to_path_control(si: oc.SpaceInformation, flight: HeldFlight) -> oc.PathControl:
    """A flight as an OMPL path: an input that is held for several steps is one control.

    ``path.check()`` propagates again: it is true if the propagator is the one that the flight was
    made with, at the flight's time step, and all states are valid. OMPL compares to 1e-7, which a
    propagator of finer steps may miss: it leads to slightly other states.

    Args:
        si: over a control space whose states and controls have the numbers of the flight's, in
            their order.
        flight: at least one input.

    Raises:
        ArgumentError: other numbers in a state or a control, no input, or a time step that is no
            multiple of the propagation step size.
    """
    buffers = ControlBuffers(si)
    states = _rows("flight.states", flight.states, buffers.width)
    controls = _rows("flight.controls", flight.controls, buffers.control_width)
    if not len(controls) == len(states) - 1 > 0:
        allowed = f"{len(states) - 1}, one less than states, and 1 or more"
        raise ArgumentError("len(flight.controls)", len(controls), allowed)
    _check_step(flight.dt, si.getPropagationStepSize())
    changes = np.flatnonzero((controls[1:] != controls[:-1]).any(axis=1)) + 1
    joints = [0, *changes.tolist(), len(controls)]
    path = oc.PathControl(si)
    for first, last in pairwise(joints):
        held = buffers.write_control(controls[first])
        path.append(buffers.write_state(states[first]), held, (last - first) * flight.dt)
    path.append(buffers.write_state(states[-1]))
    return path


def _rows(name: str, rows: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    rows = np.asarray(rows, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != width:
        raise ArgumentError(f"{name}.shape", rows.shape, f"(n, {width}), as in the space")
    return rows


def _check_step(dt: float, size: float) -> None:
    steps = dt / size
    if round(steps) < 1 or abs(steps - round(steps)) > WHOLE * steps:
        allowed = f"{dt:g} s, for which the flight holds each input, or a whole part of that"
        raise ArgumentError("si.getPropagationStepSize()", size, allowed)
