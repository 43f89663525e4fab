"""The share of a ball that lies below flat ground."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive
from ompl_risk.avoidance.base import Avoidance, checked_distance


@dataclass(frozen=True)
class FlatCap(Avoidance):
    """The share of a ball of radius r that lies below flat ground at the distance d.

        f(d) = (1 - d/r)^2 (2 + d/r) / 4   for 0 < d < r
             = 0                           for d >= r
             = +inf                        for d <= 0

    A plane at the distance d from the centre cuts off a cap of height ``h = r - d``, whose volume
    is ``pi h^2 (3 r - h) / 3 = pi (r - d)^2 (2 r + d) / 3``. Divided by that of the ball,
    ``4 pi r^3 / 3``, it is f: what eq. (9) gives for the probability of collision over flat ground,
    level or not, and nearly so where the slope changes little within r. A number between 0 and
    1/2, convex in d.

    Args:
        r: radius of the ball [m], positive and finite; also d0.

    Raises:
        ArgumentError: r is not a positive finite number.

    Reference:
        Nair & Kobilarov, equations (2) and (9), for a half-space; the volume of a spherical cap:
        Harris & Stocker, Handbook of Mathematics and Computational Science, 1998, section 4.8.4.

    Example:
        >>> float(FlatCap(100.0)(50.0))
        0.15625
    """

    r: float = 100.0
    d0: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "r", positive("r", self.r))
        object.__setattr__(self, "d0", self.r)

    @property
    def steady(self) -> float:
        """r / 2 [m]: near the ground f falls to less than a third over it."""
        return 0.5 * self.r

    def __call__(self, d: ArrayLike) -> FloatArray:
        """Values of f at the distances `d` [m], any shape."""
        d = checked_distance(d)
        x = np.clip(d / self.r, 0.0, 1.0)
        return np.where(d <= 0, np.inf, 0.25 * (1.0 - x) ** 2 * (2.0 + x))[()]

    def derivative(self, d: ArrayLike) -> FloatArray:
        """df/dd = -3 (1 - (d/r)^2) / (4 r) [1/m] on (0, r), 0 from r on, -inf for d <= 0."""
        d = checked_distance(d)
        x = np.clip(d / self.r, 0.0, 1.0)
        return np.where(d <= 0, -np.inf, -0.75 * (1.0 - x) * (1.0 + x) / self.r)[()]
