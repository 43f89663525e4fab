"""The exact word on a path: its norm, its duration, and whether it may be flown."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray, readonly
from ompl_risk._kernels.motion import CONTACT
from ompl_risk.avoidance import InverseDistance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.norms import Lp
from ompl_risk.planners.improve.measure import Measure

FINE = 1e-4
"""Tolerance of the norms that decide; `Risk.tolerance` where that is finer."""

FARTHEST = 1e4
"""Least clearances along a path are told up to here [m]."""


class Judge:
    """Measures paths, corners (n, 3) [m], and the motions that they are made of.

    Args:
        clearance: d(q), which f depends on.
        risk: how risk is counted; its `duration_weight` is left out here.
        obstacles: a clearance that has to stay positive; `clearance` if left out.
        threads: of compiled code, at most.

    Raises:
        ArgumentError: a clearance that cannot be called, or one that needs an orientation.
    """

    def __init__(
        self, clearance: Any, risk: Risk, obstacles: Any = None, *, threads: int | None = None
    ) -> None:
        if not isinstance(risk, Risk):
            raise ArgumentError("risk", risk, "a motion.Risk")
        fine = replace(risk, duration_weight=0.0, tolerance=min(risk.tolerance, FINE))
        self.risk = fine
        self._exact = motion_batch(clearance, fine, threads=threads)
        nearest = replace(fine, avoidance=InverseDistance(FARTHEST), norm=Lp(np.inf))
        self._nearest = motion_batch(clearance, nearest, threads=threads)
        gate = clearance if obstacles is None else obstacles
        self._gate = motion_batch(gate, Risk(speed=risk.speed), threads=threads)
        self.compiled = self._exact.compiled and self._gate.compiled

    def powers(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """What the motions from a[k] to b[k] add to the p-th power of the norm.

        For p = inf: their maximum of f. Infinite for those that may not be flown.
        """
        powers, free = np.full(len(a), np.inf), self._are_free(a, b)
        powers[free] = self._exact.costs(a[free], b[free])
        return powers

    def _are_free(self, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
        free, still = self._gate.are_free(a, b), (a == b).all(axis=1)
        free[still] = self._gate.clearances(a[still]) > CONTACT  # no motion to march along
        return free

    def durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Durations [s] of motions, shape (n,)."""
        return np.linalg.norm(b - a, axis=1) / self.risk.speed

    def duration(self, corners: FloatArray) -> float:
        """Duration of a path [s]."""
        return float(self.durations(corners[:-1], corners[1:]).sum())

    def power(self, corners: FloatArray) -> float:
        """The p-th power of the norm of a path, inf if it may not be flown."""
        return self.risk.combine(self.powers(corners[:-1], corners[1:]))

    def norm(self, corners: FloatArray) -> float:
        """The norm of a path, inf if it may not be flown."""
        return self.risk.root(self.power(corners))

    def measure(self, corners: FloatArray) -> Measure:
        """All figures of a path."""
        a, b = corners[:-1], corners[1:]
        duration = self.duration(corners)
        worst = float(self._nearest.costs(a, b).max())
        return Measure(
            label=self.risk.norm.label,
            norm=self.risk.root(self.risk.combine(self._exact.costs(a, b))),
            duration=duration,
            length=duration * self.risk.speed,
            clearance=1.0 / (worst + 1.0 / FARTHEST),
            vertices=len(corners),
        )

    def first_fault(self, corners: FloatArray) -> int | None:
        """The first motion of a path that may not be flown."""
        free = np.isfinite(self.powers(corners[:-1], corners[1:]))
        return None if free.all() else int(np.argmin(free))


class Recollection(Judge):
    """A judge that does not measure the same motion twice.

    Args:
        judge: who measures.
    """

    def __init__(self, judge: Judge) -> None:
        vars(self).update(vars(judge))
        self._judge, self._known = judge, dict[bytes, float]()

    def powers(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """See `Judge`."""
        keys = [row.tobytes() for row in np.hstack([a, b])]
        new = [k for k, key in enumerate(keys) if key not in self._known]
        found = self._judge.powers(a[new], b[new])
        self._known.update(zip((keys[k] for k in new), found.tolist(), strict=True))
        return np.array([self._known[key] for key in keys])


def as_path(positions: ArrayLike) -> FloatArray:
    """Corners of a path [m], shape (n, 3), read-only.

    Raises:
        ArgumentError: another shape, fewer than two corners, or a number that is not finite.
    """
    path = readonly("positions", positions, (None, 3), "(n, 3), n >= 2")
    if len(path) < 2:
        raise ArgumentError("positions.shape", path.shape, "(n, 3), n >= 2")
    return path
