"""Where along a trajectory a norm comes from."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ompl_risk._arrays import FloatArray, ReadOnlyArrays
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Norm
from ompl_risk.ranking.sampling import Samples


@dataclass(frozen=True, eq=False)
class Attribution(ReadOnlyArrays):
    """The part of a trajectory that a norm's p-th power comes from.

    Args:
        label: the norm's label.
        share: part of the power that the window holds, 0 to 1 (1 for a maximum norm).
        start: beginning of the window [s].
        end: end of the window [s]; equal to `start` for a maximum norm.
        time: when f is greatest within the window [s].
        position: where that is [m], shape (3,).
        clearance: distance to obstacles there [m].
        t: times of the samples [s], shape (n,).
        shares: part of the power that each interval contributes, shape (n - 1,), sum 1.
    """

    label: str
    share: float
    start: float
    end: float
    time: float
    position: FloatArray
    clearance: float
    t: FloatArray
    shares: FloatArray

    @property
    def sentence(self) -> str:
        """The attribution in words."""
        x, y, _ = self.position
        where = f"near ({x:.0f}, {y:.0f}) m with {self.clearance:.3g} m to spare"
        if self.start == self.end:
            return f"{self.label} is reached at t = {self.time:.1f} s, {where}"
        return (
            f"{self.share:.0%} of {self.label} between t = {self.start:.1f} s and "
            f"{self.end:.1f} s, closest {where}"
        )

    def segments(self, count: int) -> FloatArray:
        """Shares of `count` parts of equal duration, shape (count,), sum 1.

        The contribution of an interval that spans a border is divided in proportion to time.

        Raises:
            ArgumentError: count is less than 1.
        """
        if count < 1:
            raise ArgumentError("count", count, "a whole number >= 1")
        borders = np.linspace(self.t[0], self.t[-1], count + 1)
        cumulative = np.concatenate([[0.0], np.cumsum(self.shares)])
        return np.diff(np.interp(borders, self.t, cumulative))


class Attributions(Mapping[str, "Attribution | None"]):
    """Where each of several norms comes from, by label; found when first asked for.

    A ranking of many trajectories hardly ever needs all of them, and they take longer than the
    norms themselves.

    Args:
        parts: by label, the norm and the samples that suit it; None for an infinite norm.
        share: see `attribute`.
    """

    def __init__(self, parts: Mapping[str, tuple[Norm, Samples] | None], share: float) -> None:
        self._parts, self._share = dict(parts), share
        self._found: dict[str, Attribution | None] = {}

    def __getitem__(self, label: str) -> Attribution | None:
        part = self._parts[label]
        if label not in self._found:
            self._found[label] = None if part is None else attribute(*part, self._share)
        return self._found[label]

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    def __repr__(self) -> str:
        return f"Attributions({', '.join(self._parts)})"


def attribute(norm: Norm, samples: Samples, share: float) -> Attribution | None:
    """Find the shortest time window that holds at least `share` of the norm's power.

    Args:
        norm: the norm.
        samples: where f is known.
        share: part of the power that the window has to hold, above 0, at most 1.

    Returns:
        None if the power is 0 (no risk to attribute) or infinite (all of it is the collision).
    """
    t, f = samples.trajectory.t, samples.f
    powers = norm.shares(t, f)
    total = powers.sum()
    if total == 0.0 or math.isinf(total):
        return None
    shares = powers / total
    shares.setflags(write=False)
    i, j = _peak(f) if math.isinf(norm.exponent) else shortest_window(t, shares, share)
    peak = i + int(np.argmax(f[i : j + 1]))
    return Attribution(
        label=norm.label,
        share=1.0 if i == j else min(1.0, float(shares[i:j].sum())),
        start=float(t[i]),
        end=float(t[j]),
        time=float(t[peak]),
        position=samples.trajectory.positions[peak],
        clearance=float(samples.d[peak]),
        t=t,
        shares=shares,
    )


def shortest_window(t: FloatArray, shares: FloatArray, share: float) -> tuple[int, int]:
    """First and last sample of the shortest window with at least `share` of the shares.

    Args:
        t: times [s], shape (n,).
        shares: parts of the intervals, shape (n - 1,), sum 1.
        share: what the window has to hold, above 0, at most 1.

    Returns:
        Indices (i, j), i < j; the earliest of equally short ones.
    """
    cumulative = np.concatenate([[0.0], np.cumsum(shares)])
    target = cumulative[:-1] + min(share, cumulative[-1]) * (1 - 1e-12)
    end = np.searchsorted(cumulative, target)
    start = np.flatnonzero(end < len(t))
    widths = t[end[start]] - t[start]
    i = int(start[np.argmin(widths)])
    return i, int(end[i])


def _peak(f: FloatArray) -> tuple[int, int]:
    peak = int(np.argmax(f))
    return peak, peak
