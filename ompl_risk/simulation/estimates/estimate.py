"""What rollouts say of a plan: how often it ends in collision, how surely, when and where."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, as_floats, positive, readonly, real_number
from ompl_risk._kernels.air import LEFT_MAP, LOST_CONTROL, TOUCHED
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.estimates.export import LEVELS, as_dict, sentence
from ompl_risk.simulation.estimates.intervals import counted, weighed


@dataclass(frozen=True, eq=False)
class CollisionEstimate(ReadOnlyArrays):
    """Probability that a plan ends in collision, from N independent rollouts; arrays are read-only.

    ::

        probability = 1/N sum of w_k [rollout k collides]        w_k = 1 unless weighted

    Without weights the bounds are exact (Clopper and Pearson). With them ``low`` and ``high`` are
    the gamma bounds of Fay and Feuer for the hits that were met: they take it that no kind of
    collision was missed that weighs more than those. ``upper_bound`` takes nothing: it allows for
    one more hit of the greatest weight possible, and so can be far greater than ``high``.

    If the number of rollouts was not fixed beforehand, every bound is widened for the looks that
    were planned (its error is shared out among them), so it holds whenever one stopped.

    Args:
        name: of the plan.
        least: least clearance of each rollout [m], shape (N,).
        when: when that was [s], shape (N,).
        where: position then [m], shape (N, 3).
        collided: time of collision [s], inf where there was none, shape (N,).
        seed: of the disturbances; rollout k of every plan with this seed meets the same ones.
        confidence: of ``low`` and ``high`` together.
        looks: how many times the sample could have been looked at, to stop.
        weights: likelihood of each rollout's disturbances over that with which they were drawn,
            shape (N,); ``None`` where all are 1.
        heaviest: greatest weight that is possible.
        endings: how each rollout ended, as in ``Outcomes``; shape (N,).

    Raises:
        ArgumentError: no rollouts, a wrong shape or NaN, a confidence that is not between 0 and 1.

    Example:
        >>> import numpy as np
        >>> none = np.full(10_000, np.inf)
        >>> safe = CollisionEstimate("A", none, np.zeros(10_000), np.zeros((10_000, 3)), none)
        >>> print(safe)
        A: 0 of 10,000, at most 3.69e-4 (95 %)
    """

    name: str
    least: FloatArray
    when: FloatArray
    where: FloatArray
    collided: FloatArray
    seed: int | None = None
    confidence: float = 0.95
    looks: int = 1
    weights: FloatArray | None = None
    heaviest: float = 1.0
    endings: NDArray[np.int8] | None = None

    def __post_init__(self) -> None:
        n = len(np.atleast_1d(self.least))
        if n == 0:
            raise ArgumentError("least.shape", (0,), "(N,), N >= 1")
        arrays: dict[str, NDArray[Any]] = {
            "least": _without_nan("least", self.least, (n,)),
            "when": readonly("when", self.when, (n,), f"({n},)"),
            "where": readonly("where", self.where, (n, 3), f"({n}, 3)"),
            "collided": _without_nan("collided", self.collided, (n,)),
        }
        if self.weights is not None:
            arrays["weights"] = readonly("weights", self.weights, (n,), f"({n},)")
            if (arrays["weights"] < 0.0).any():
                raise ArgumentError("weights", float(arrays["weights"].min()), "0 or more")
        if self.endings is not None:
            arrays["endings"] = _endings(self.endings, n)
        for field, array in arrays.items():
            object.__setattr__(self, field, array)
        check_confidence("confidence", self.confidence)
        positive("heaviest", self.heaviest)
        if isinstance(self.looks, bool) or not isinstance(self.looks, int) or self.looks < 1:
            raise ArgumentError("looks", self.looks, "a whole number from 1")

    @property
    def rollouts(self) -> int:
        """N."""
        return len(self.least)

    @cached_property
    def collides(self) -> NDArray[np.bool_]:
        """Which rollouts collide, shape (N,)."""
        found = np.isfinite(self.collided)
        found.setflags(write=False)
        return found

    @property
    def hits(self) -> int:
        """Rollouts that collide."""
        return int(self.collides.sum())

    @property
    def times(self) -> FloatArray:
        """When the rollouts that collide do so [s], shape (hits,)."""
        return self.collided[self.collides]

    @property
    def places(self) -> FloatArray:
        """Where the rollouts that collide do so [m], shape (hits, 3)."""
        return self.where[self.collides]

    @property
    def ended(self) -> dict[str, int]:
        """How many of the hits touched something, left the map and lost control."""
        kinds = {"touched": TOUCHED, "left the map": LEFT_MAP, "lost control": LOST_CONTROL}
        if self.endings is None:
            return {name: self.hits if name == "touched" else 0 for name in kinds}
        return {name: int((self.endings == kind).sum()) for name, kind in kinds.items()}

    @property
    def probability(self) -> float:
        """Estimated probability of collision; see ``upper_bound`` before trusting a 0."""
        if self.weights is None:
            return self.hits / self.rollouts
        return float(self.weights[self.collides].sum()) / self.rollouts

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self._bounds(0.5 * (1.0 - self.confidence), self._met)[0]

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self._bounds(0.5 * (1.0 - self.confidence), self._met)[1]

    def upper_bound(self, confidence: float | None = None) -> float:
        """The probability is not greater than this, whatever the rollouts have not met.

        Args:
            confidence: one-sided; that of the interval if left out.
        """
        chosen = self.confidence if confidence is None else confidence
        return self._bounds(1.0 - check_confidence("confidence", chosen), self.heaviest)[1]

    def lower_bound(self, confidence: float | None = None) -> float:
        """The probability is not less than this.

        Args:
            confidence: one-sided; that of the interval if left out.
        """
        chosen = self.confidence if confidence is None else confidence
        return self._bounds(1.0 - check_confidence("confidence", chosen), self.heaviest)[0]

    def decided(self, threshold: float) -> Literal["below", "above", "open"]:
        """Which side of a threshold the probability is on, as surely as ``confidence`` says.

        Args:
            threshold: probability that is still allowed.

        Returns:
            "below" (or on it), "above", or "open" if these rollouts do not tell.
        """
        if self.upper_bound() <= threshold:
            return "below"
        return "above" if self.lower_bound() > threshold else "open"

    def quantiles(self, levels: ArrayLike = LEVELS) -> FloatArray:
        """Least clearances [m] that a share of rollouts (by weight) do not exceed.

        Args:
            levels: the shares, from 0 to 1.
        """
        wanted = as_floats("levels", levels)
        if not ((wanted >= 0.0) & (wanted <= 1.0)).all():
            raise ArgumentError("levels", levels, "shares from 0 to 1")
        order = np.argsort(self.least, kind="stable")
        weights = np.ones(self.rollouts) if self.weights is None else self.weights[order]
        share = np.cumsum(weights) / weights.sum()
        rank = np.searchsorted(share, wanted * (1.0 - 1e-12))
        return self.least[order][np.minimum(rank, self.rollouts - 1)]

    @property
    def effective_rollouts(self) -> float:
        """``(sum of w)^2 / sum of w^2``, which is N where rollouts count alike (Kish)."""
        if self.weights is None:
            return float(self.rollouts)
        return float(self.weights.sum() ** 2 / (self.weights**2).sum())

    @property
    def equivalent_rollouts(self) -> float:
        """How many rollouts without weights would estimate as accurately; NaN with no hits.

        ``p (1 - p) / v`` with v the estimated variance of the estimate: for rare collisions the
        figure to compare with N, since a design spends its rollouts on them on purpose.
        """
        p = self.probability
        if self.weights is None or p == 0.0:
            return float(self.rollouts) if self.weights is None else float("nan")
        terms = self.weights * self.collides
        return float(p * (1.0 - p) / (terms.var() / self.rollouts))

    def __repr__(self) -> str:
        return f"CollisionEstimate({self})"

    def __str__(self) -> str:
        return sentence(self)

    def to_dict(self) -> dict[str, Any]:
        """Plain data that strict JSON can hold: numbers that are not finite are strings."""
        return as_dict(self)

    @property
    def _met(self) -> float:
        """Greatest weight of a hit that was met; the greatest possible one if there was none."""
        if self.weights is None or self.hits == 0:
            return self.heaviest
        return float(self.weights[self.collides].max())

    def _bounds(self, tail: float, heaviest: float) -> tuple[float, float]:
        tail /= self.looks
        if self.weights is None:
            return counted(self.hits, self.rollouts, tail)
        return weighed(self.weights[self.collides], self.rollouts, tail, heaviest)


def check_confidence(argument: str, value: float) -> float:
    """A share between 0 and 1.

    Raises:
        ArgumentError: anything else.
    """
    number = real_number(argument, value, "between 0 and 1")
    if not 0.0 < number < 1.0:
        raise ArgumentError(argument, value, "between 0 and 1")
    return number


def _without_nan(argument: str, value: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """A read-only copy that may hold infinities."""
    array = np.array(as_floats(argument, value), order="C", copy=True)
    if array.shape != shape:
        raise ArgumentError(f"{argument}.shape", array.shape, str(shape))
    if np.isnan(array).any():
        raise ArgumentError(f"{argument}[{int(np.argmax(np.isnan(array)))}]", float("nan"), "real")
    array.setflags(write=False)
    return array


def _endings(value: ArrayLike, n: int) -> NDArray[np.int8]:
    array = np.array(value, dtype=np.int8)
    if array.shape != (n,):
        raise ArgumentError("endings.shape", array.shape, f"({n},)")
    array.setflags(write=False)
    return array
