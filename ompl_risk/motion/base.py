"""What a planner asks about straight motions, whoever computes it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import KW_ONLY, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import positive, real_number
from ompl_risk.avoidance import Avoidance, InverseDistance
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Norm, Sobolev

LARGEST = 600.0
"""Logarithm of the largest power that is told from infinity."""


@dataclass(frozen=True)
class Risk:
    """How the risk of a motion is counted.

    The cost of a path is the sum over its motions (for ``Lp(inf)`` the maximum) of ::

        integral of f^p dt  or  integral of f^2 + tau^2 f'^2 dt,  plus  duration_weight * duration

    the p-th power of the norm, since only that adds up along a path; take the root once, at the
    end. The weight has the unit of f^p: with ``weight = f(d1)**p`` a second of flight costs as
    much as a second at clearance d1. The default, ``1e-9 f(d0/2)**p`` (``1e-9 / d0**p`` for
    ``InverseDistance``), only breaks ties among free ways.

    Args:
        avoidance: f as a function of d.
        norm: ``Lp(p)`` or ``Sobolev(1)``.
        speed: constant speed along motions [m/s], of the fastest point of a body that turns.
        duration_weight: cost of a second, in the unit of f^p; ``None`` for the tie-break, 0 for
            none.
        tolerance: pieces of a motion are halved until a share of the cost changes by less than
            this fraction. The cost as a whole is then about as accurate; a piece with an edge of
            the terrain close to one of its ends may be off by the square root of it, and where f
            bends, at d0, pieces end at half of it times d0: dips below d0 by less count roughly.

    Raises:
        ArgumentError: a norm whose powers do not add up along a path, a weight together with
            ``Lp(inf)``, or a value out of range.

    Reference: Nair and Kobilarov, eqs. (3) to (5).
    """

    avoidance: Avoidance = field(default_factory=InverseDistance)
    norm: Norm = field(default_factory=lambda: Sobolev(1))
    _: KW_ONLY
    speed: float
    duration_weight: float | None = None
    tolerance: float = 1e-2

    def __post_init__(self) -> None:
        if not isinstance(self.avoidance, Avoidance):
            raise ArgumentError("avoidance", self.avoidance, "an Avoidance, as InverseDistance()")
        additive = isinstance(self.norm, Lp) or (
            isinstance(self.norm, Sobolev) and self.norm.k == 1 and self.norm.form == "derivative"
        )
        if not additive:
            raise ArgumentError(
                "norm", self.norm, "Lp(p) or Sobolev(1): only these add up along a path"
            )
        positive("speed", self.speed)
        tolerance = real_number("tolerance", self.tolerance, "a number above 0 and up to 0.5")
        if not 0.0 < tolerance <= 0.5:
            raise ArgumentError("tolerance", self.tolerance, "above 0 and up to 0.5")
        self._check_weight()

    def _check_weight(self) -> None:
        if self.duration_weight is None:
            return
        weight = real_number("duration_weight", self.duration_weight, "None or 0 or more")
        if weight < 0.0 or not math.isfinite(weight):
            raise ArgumentError("duration_weight", self.duration_weight, "None or 0 or more")
        if weight > 0.0 and math.isinf(self.exponent):
            raise ArgumentError(
                "duration_weight", weight, "0 or None with Lp(inf): a maximum and a sum do not mix"
            )

    @property
    def exponent(self) -> float:
        """p of the norm."""
        return self.norm.exponent

    @property
    def time_scale(self) -> float:
        """tau [s] of the Sobolev norm; 0 for L^p."""
        return self.norm.time_scale if isinstance(self.norm, Sobolev) else 0.0

    @property
    def weight(self) -> float:
        """Cost of a second of duration, in the unit of f^p."""
        if math.isinf(self.exponent):
            return 0.0
        if self.duration_weight is not None:
            return float(self.duration_weight)
        return 1e-9 * self.avoidance.typical**self.exponent

    @property
    def negligible(self) -> float:
        """A value of f^p so small that it need not be known more exactly."""
        if math.isinf(self.exponent):
            return 0.0
        logarithm = self.exponent * math.log(self.avoidance.typical)
        return 1e-3 * math.exp(min(logarithm, LARGEST))  # a power might overflow

    def combine(self, costs: Any) -> float:
        """Cost of a path from the costs of its motions."""
        values = np.asarray(costs, dtype=np.float64)
        if math.isinf(self.exponent):
            return float(values.max(initial=0.0))
        return float(values.sum())

    def root(self, power: float) -> float:
        """The norm from its p-th power."""
        return power if math.isinf(self.exponent) else power ** (1.0 / self.exponent)


class MotionModel(ABC):
    """Answers about the states in two buffers, ``a`` and ``b``, and the straight motion between.

    A caller writes states into the buffers and asks; positions are the first three numbers [m],
    a quaternion (x, y, z, w) the next four if the clearance uses the orientation. One model serves
    one thread.

    Duties of an implementer:

    1. ``is_motion_free`` may say yes only if d > 0 at every state of the motion: no obstacle is
       jumped over, however thin. It may say no where d falls below 1 mm.
    2. ``cost`` is inf if a state of the motion is in collision, never NaN, and agrees with the norm
       of densely sampled f to ``Risk.tolerance``.
    3. ``heuristic`` never exceeds the cost of any way from a to b at ``Risk.speed`` or less.

    Attributes:
        a, b: state buffers, shape (width,).
    """

    a: NDArray[np.float64]
    b: NDArray[np.float64]

    @abstractmethod
    def clearance(self) -> float:
        """Clearance d [m] at a."""

    @abstractmethod
    def is_free(self) -> bool:
        """Whether a is free, d > 0."""

    @abstractmethod
    def is_motion_free(self) -> bool:
        """Whether every state from a to b is free."""

    @abstractmethod
    def cost(self) -> float:
        """Cost of the motion from a to b, see ``Risk``."""

    @abstractmethod
    def heuristic(self) -> float:
        """Lower bound for the cost of any way from a to b."""
