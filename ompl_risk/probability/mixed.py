"""Terrain by quadrature, what moves over it by sampling."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.probability.estimators import (
    BallSampling,
    ColumnQuadrature,
    Estimate,
    Estimator,
    Floats,
    in_obstacles,
)


@dataclass(frozen=True)
class ColumnsAndSampling(Estimator):
    """For a ``MovingClearance`` over terrain: the ground by columns, the rest by sampling.

    ::

        P = P(in the ground) + P(in an obstacle that moves, and above the ground)

    The first is found by quadrature, the second by counting points of the ball. Where no obstacle
    reaches the ball the second is 0 for certain. The bounds of the two are added.

    Args:
        columns: how the ground is integrated.
        sampling: how the rest is sampled, with independent offsets.

    Raises:
        ArgumentError: shared offsets, which quadrature knows nothing of.
    """

    columns: ColumnQuadrature = field(default_factory=ColumnQuadrature)
    sampling: BallSampling = field(default_factory=BallSampling)

    def __post_init__(self) -> None:
        if self.sampling.offsets != "independent":
            allowed = "independent; take BallSampling alone for shared offsets"
            raise ArgumentError("sampling.offsets", self.sampling.offsets, allowed)

    def estimate(
        self, clearance: Any, points: Floats, radius: float, *, times: Floats | None = None
    ) -> Estimate:
        """Shares for all points.

        Raises:
            ArgumentError: the clearance is not a ``MovingClearance`` over a ``TerrainClearance``,
                or no times are given.
        """
        if not isinstance(clearance, MovingClearance):
            raise ArgumentError("estimator", self, "for a MovingClearance: it takes both parts")
        if not isinstance(clearance.static, TerrainClearance):
            kind = type(clearance.static).__name__
            raise ArgumentError("estimator", self, f"BallSampling() where static is {kind}")
        if times is None:
            raise ArgumentError("times", None, "given where obstacles move")
        ground = self.columns.estimate(clearance.static, points, radius)
        rest = self._rest(clearance, points, radius, times)
        return Estimate(
            np.minimum(ground.p + rest.p, 1.0),
            np.minimum(ground.low + rest.low, 1.0),
            np.minimum(ground.high + rest.high, 1.0),
            rest.samples,
            rest.confidence,
            f"column quadrature of the ground, {rest.method} of what moves",
        )

    def _rest(
        self, clearance: MovingClearance, points: Floats, radius: float, times: Floats
    ) -> Estimate:
        """Shares in what moves above the ground."""
        moving, ground = clearance.with_static(None), clearance.static
        reached = np.flatnonzero(moving(points, times) < radius)

        def inside(k: int, sampled: Floats) -> NDArray[np.bool_]:
            struck = moving(sampled, times[reached[k]]) <= 0.0
            struck[struck] = ~in_obstacles(ground, sampled[struck])
            return struck

        estimate = self.sampling.counted(inside, points[reached], radius)
        found = np.zeros((3, len(points)))
        found[:, reached] = estimate.p, estimate.low, estimate.high
        p, low, high = found
        return estimate._replace(p=p, low=low, high=high)
