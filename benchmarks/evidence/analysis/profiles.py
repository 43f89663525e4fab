"""Many flights end to end: one array a quantity, so that a setting is evaluated on all at once."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk import Norm
from ompl_risk._arrays import FloatArray

COLUMNS = ("d", "up", "curvature", "speed", "pc")
"""What is known at each sample, see `Profiles`."""
GAP = 1.0
"""Time [s] between two flights on the common clock; what lies in it never counts."""


@dataclass(frozen=True, eq=False)
class Profiles:
    """F flights of any lengths, N samples in all.

    Args:
        starts: index of each flight's first sample, and N at the end, shape (F + 1,).
        t: time since the flight's start [s], shape (N,), as all that follow.
        d: clearance [m].
        up: upward component of the gradient of d; 1 over flat ground.
        curvature: half the Laplacian of the ground below [1/m], positive in a bowl.
        speed: [m/s].
        pc: the paper's probability of collision P_c(t).
    """

    starts: NDArray[np.intp]
    t: FloatArray
    d: FloatArray
    up: FloatArray
    curvature: FloatArray
    speed: FloatArray
    pc: FloatArray
    known: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False)
    """What settings have worked out before, and keep for the next time that they are asked."""

    def __post_init__(self) -> None:
        for name in ("starts", "t", *COLUMNS):
            getattr(self, name).setflags(write=False)

    def __len__(self) -> int:
        return len(self.starts) - 1

    @cached_property
    def lengths(self) -> NDArray[np.intp]:
        """Number of samples of each flight, shape (F,)."""
        return np.diff(self.starts)

    @cached_property
    def durations(self) -> FloatArray:
        """Of each flight [s], shape (F,)."""
        return self.t[self.starts[1:] - 1]

    @cached_property
    def clock(self) -> FloatArray:
        """Times [s] that increase from flight to flight, shape (N,)."""
        begins = np.concatenate([[0.0], np.cumsum(self.durations + GAP)[:-1]])
        return self.t + np.repeat(begins, self.lengths)

    def take(self, flights: NDArray[np.intp]) -> Profiles:
        """Some of the flights, in the order asked for."""
        lengths = self.lengths[flights]
        starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.intp)
        samples = np.arange(starts[-1]) + np.repeat(self.starts[flights] - starts[:-1], lengths)
        return Profiles(starts, *(getattr(self, name)[samples] for name in ("t", *COLUMNS)))

    def flight(self, index: int) -> dict[str, FloatArray]:
        """Time and quantities of one flight by name."""
        part = slice(int(self.starts[index]), int(self.starts[index + 1]))
        return {name: getattr(self, name)[part] for name in ("t", *COLUMNS)}

    def greatest(self, f: FloatArray) -> FloatArray:
        """The greatest value in each flight, shape (F,)."""
        return np.maximum.reduceat(f, self.starts[:-1])

    def total(self, shares: FloatArray) -> FloatArray:
        """The sum over each flight's intervals, shape (F,).

        Args:
            shares: of the N - 1 intervals on the common clock.
        """
        counted = np.append(shares, 0.0)
        counted[self.starts[1:] - 1] = 0.0  # between two flights
        return np.add.reduceat(counted, self.starts[:-1])

    def integral(self, f: FloatArray) -> FloatArray:
        """The integral of f over each flight by the trapezoidal rule, shape (F,)."""
        return self.total(0.5 * (f[:-1] + f[1:]) * np.diff(self.clock))

    def norm(self, norm: Norm, f: FloatArray) -> FloatArray:
        """The norm of each flight's samples, shape (F,).

        As ``norm(t, f)`` of one flight after the other, for norms whose `shares` depend on the
        interval's own ends alone: every L^p and the derivative form of H^1.

        Args:
            norm: which.
            f: finite samples, shape (N,).
        """
        scale = self.greatest(np.abs(f))
        if np.isinf(norm.exponent):
            return scale
        even = np.repeat(np.where(scale > 0.0, scale, 1.0), self.lengths)
        kept = self._telling(f)
        shares = np.zeros(len(f))
        shares[kept[:-1]] = norm.shares(self.clock[kept], f[kept] / even[kept])
        return scale * self.total(shares[:-1]) ** (1.0 / norm.exponent)

    def _telling(self, f: FloatArray) -> NDArray[np.intp]:
        """Samples without those amid zeros, where the norm has nothing to add; ends stay."""
        telling = f != 0.0
        telling[:-1] |= telling[1:].copy()
        telling[1:] |= (f != 0.0)[:-1]
        telling[self.starts[:-1]] = telling[self.starts[1:] - 1] = True
        return np.flatnonzero(telling)
