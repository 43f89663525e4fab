"""The connections of many pairs of states, taken apart into straight pieces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.steering import Connection, Steering

APART = 1e-6
"""By how much a connection may miss the states that it connects, in every number."""


@dataclass(frozen=True, eq=False)
class Ways:
    """Connections from a[k] to b[k], and all of their pieces one after the other.

    Attributes:
        samples: states along each way, shape (m, width) with m = 0 where there is none.
        durations: of the ways [s], inf where there is none, shape (n,).
        owner: number of the way that each piece belongs to, shape (pieces,).
        tails: states where pieces begin, shape (pieces, width).
        heads: states where they end.
        seconds: durations of the pieces, shape (pieces,).
    """

    samples: list[FloatArray]
    durations: FloatArray
    owner: NDArray[np.intp]
    tails: FloatArray
    heads: FloatArray
    seconds: FloatArray

    @classmethod
    def joining(cls, steering: Steering, a: FloatArray, b: FloatArray) -> Ways:
        """Connect a[k] with b[k] for every k.

        Raises:
            ArgumentError: an answer that is no connection, or one between other states.
        """
        a, b = _frozen(a), _frozen(b)
        connections = [steering.connect(x, y) for x, y in zip(a, b, strict=True)]
        for k, connection in enumerate(connections):
            _check(connection, a[k], b[k])
        nowhere = np.empty((0, a.shape[1]))
        samples = [c.samples if c.exists else nowhere for c in connections]
        durations = np.array([c.duration for c in connections], dtype=np.float64)
        pieces = np.array([max(len(states) - 1, 0) for states in samples], dtype=np.intp)
        owner = np.repeat(np.arange(len(a)), pieces)
        tails = np.concatenate([nowhere, *(states[:-1] for states in samples)])
        heads = np.concatenate([nowhere, *(states[1:] for states in samples)])
        return cls(samples, durations, owner, tails, heads, durations[owner] / pieces[owner])

    def __len__(self) -> int:
        return len(self.durations)

    @property
    def exist(self) -> NDArray[np.bool_]:
        """Where there is a way, shape (n,)."""
        return np.isfinite(self.durations)


def _frozen(states: FloatArray) -> FloatArray:
    states = np.array(states, dtype=np.float64)
    states.setflags(write=False)
    return states


def _check(connection: Connection, a: FloatArray, b: FloatArray) -> None:
    """The implementer's first duty: a way between other states would break the path."""
    if not isinstance(connection, Connection):
        raise ArgumentError(
            "steering.connect(a, b)", connection, "a Connection, or Connection.none()"
        )
    if not connection.exists:
        return
    for name, state, sample in (("a", a, connection.samples[0]), ("b", b, connection.samples[-1])):
        if sample.shape != state.shape or not np.abs(sample - state).max() <= APART:
            where = f"samples[{0 if name == 'a' else -1}] of steering.connect(a, b)"
            raise ArgumentError(where, sample.tolist(), f"{name} = {state.tolist()}")
