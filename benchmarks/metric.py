"""One measured figure, with what it is compared with and what it should reach."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Better = Literal["lower", "higher"]


@dataclass(frozen=True)
class Spread:
    """Median and quartiles of repeats.

    Attributes:
        median: middle of the repeats.
        low, high: a quarter of the repeats lies below low, a quarter above high.
    """

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values: ArrayLike) -> Spread:
        """The spread of measured values, infinities included; of one value, three times that."""
        sample = np.sort(np.atleast_1d(np.asarray(values, dtype=np.float64)))
        if np.isnan(sample).any():
            return cls(math.nan, math.nan, math.nan)
        low, high = np.quantile(sample, (0.25, 0.75), method="nearest")  # no inf - inf
        middle = (sample[(len(sample) - 1) // 2], sample[len(sample) // 2])
        return cls(float(0.5 * (middle[0] + middle[1])), float(low), float(high))


@dataclass(frozen=True)
class Target:
    """A limit that a figure should keep.

    Attributes:
        limit: at most this where lower is better, at least this where higher is; an advantage is
            always better when higher.
        of: the value itself, or its advantage over the peer.
        correctness: a limit on correctness rather than on speed: missing it fails the run.
    """

    limit: float
    _: KW_ONLY
    of: Literal["value", "advantage"] = "value"
    correctness: bool = False


@dataclass(frozen=True)
class Tolerance:
    """How much worse than the baseline a figure may be before the gate closes.

    Attributes:
        relative: worse by this part of the baseline; 1.0 lets a time double.
        absolute: worse by this much, in the figure's unit, if that is more.
        of: what is compared. "advantage": how many times better than the peer. "yardstick": the
            time over that of a fixed computation in the same run, which says what machine it is.
    """

    relative: float
    _: KW_ONLY
    absolute: float = 0.0
    of: Literal["value", "advantage", "yardstick"] = "value"


LIMIT_ONLY = Tolerance(math.inf)
"""For figures that differ from run to run: only their target matters."""


@dataclass(frozen=True)
class Peer:
    """What somebody else's code measured in the same run."""

    name: str
    value: Spread


@dataclass(frozen=True)
class Metric:
    """One figure.

    Attributes:
        name: what is measured.
        value: ours.
        unit: of value and peer.
        better: whether lower or higher values are better.
        peer: the figure of other code.
        advantage: how many times better ours is, from the pairs of single repeats.
        target: what should be reached.
        note: amount of work behind the figure, and what is included.
        tolerance: of the gate; by unit and target if left out, see ``readings``.
    """

    name: str
    value: Spread
    unit: str
    _: KW_ONLY
    better: Better = "lower"
    peer: Peer | None = None
    advantage: Spread | None = None
    target: Target | None = None
    note: str = ""
    tolerance: Tolerance | None = None

    @property
    def met(self) -> bool | None:
        """Whether the target is met; ``None`` without one. Not-a-number meets nothing."""
        if self.target is None:
            return None
        if self.target.of == "advantage":
            return self.advantage is not None and self.advantage.median >= self.target.limit
        if self.better == "lower":
            return self.value.median <= self.target.limit
        return self.value.median >= self.target.limit

    @property
    def failed(self) -> bool:
        """Whether a figure of correctness misses its limit."""
        return self.target is not None and self.target.correctness and not self.met


@dataclass(frozen=True)
class Absent:
    """A peer that could not be asked.

    Attributes:
        name: of the peer.
        reason: in two words.
        remedy: how to get it, or what the system says.
    """

    name: str
    reason: str
    remedy: str


def figure(name: str, values: ArrayLike, unit: str, **rest: Any) -> Metric:
    """A figure of ours alone, from its repeats."""
    return Metric(name, Spread.of(values), unit, **rest)


def comparison(
    name: str,
    ours: NDArray[np.float64],
    unit: str,
    peer: str,
    theirs: NDArray[np.float64],
    *,
    better: Better = "lower",
    **rest: Any,
) -> Metric:
    """A figure beside that of a peer; entry k of both was measured in the same repeat.

    The advantage is the median of the ratios, not the ratio of the medians: what disturbs a
    repeat disturbs both sides of its ratio.
    """
    best, worst = (theirs, ours) if better == "lower" else (ours, theirs)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.asarray(best, dtype=np.float64) / np.asarray(worst, dtype=np.float64)
    return Metric(
        name,
        Spread.of(ours),
        unit,
        better=better,
        peer=Peer(peer, Spread.of(theirs)),
        advantage=Spread.of(ratios),
        **rest,
    )


def error(name: str, values: ArrayLike, unit: str, limit: float, note: str = "") -> Metric:
    """The largest of some errors, which must not exceed a limit."""
    largest = float(np.max(np.abs(np.asarray(values, dtype=np.float64))))
    return figure(name, largest, unit, target=Target(limit, correctness=True), note=note)
