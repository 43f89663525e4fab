"""Ways to estimate the share of a ball that lies in obstacles."""

from __future__ import annotations

import functools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels import ball, nearest
from ompl_risk.clearance import TerrainClearance, UnionClearance
from ompl_risk.clearance.base import as_queries
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.threads import in_chunks
from ompl_risk.errors import ArgumentError
from ompl_risk.probability.proportion import Proportion, clopper_pearson

Floats = NDArray[np.float64]


class Estimate(NamedTuple):
    """What an estimator found for n states; see ``CollisionProfile`` for the fields."""

    p: Floats
    low: Floats
    high: Floats
    samples: int
    confidence: float | None
    method: str
    ever: Proportion | None = None


class Estimator(ABC):
    """Estimates the share of the ball around each point that lies in obstacles."""

    @abstractmethod
    def estimate(
        self, clearance: Any, points: Floats, radius: float, *, times: Floats | None = None
    ) -> Estimate:
        """Shares for all points.

        Args:
            clearance: d <= 0 marks what counts as obstacle; callable with points (n, 3).
            points: centres [m], shape (n, 3).
            radius: of the ball [m].
            times: when each centre is reached [s], shape (n,); given where obstacles move, as those
                of a ``MovingClearance``.
        """


@dataclass(frozen=True)
class ColumnQuadrature(Estimator):
    """For terrain: integrates the filled length of vertical columns over the ball's disk.

    ::

        P = 3 / (4 pi r^3) * integral over the disk of clip(h - (z - s), 0, 2 s)
        s^2 = r^2 - rho^2

    with Gauss-Legendre nodes in rho^2 and equally spaced angles. The stated error is half the
    difference between the two halves of the angles, plus what one column more or less would
    change at the ball's depth in the obstacles, r - d: a peak can hide between the columns. So
    the upper bound is 0 only where the obstacles are out of the ball's reach, for certain.

    Args:
        rings: number of radii.
        spokes: number of angles, even.

    Raises:
        ArgumentError: fewer than 1 ring, or spokes that are not even and at least 4.
    """

    rings: int = 8
    spokes: int = 16

    def __post_init__(self) -> None:
        if not isinstance(self.rings, int) or self.rings < 1:
            raise ArgumentError("rings", self.rings, "a whole number of at least 1")
        if not isinstance(self.spokes, int) or self.spokes < 4 or self.spokes % 2:
            raise ArgumentError("spokes", self.spokes, "an even number of at least 4")

    def columns(self) -> Floats:
        """x, y, half height, weight and half (0 or 1) of the columns of a unit ball, (m, 5)."""
        return _columns(self.rings, self.spokes)

    def estimate(
        self, clearance: Any, points: Floats, radius: float, *, times: Floats | None = None
    ) -> Estimate:
        """Shares for all points; terrain stands still at all times.

        Raises:
            ArgumentError: the clearance is not a ``TerrainClearance``.
        """
        del times
        if not isinstance(clearance, TerrainClearance):
            mixed = "ColumnsAndSampling() or " if isinstance(clearance, MovingClearance) else ""
            allowed = f"{mixed}BallSampling() for {type(clearance).__name__}"
            raise ArgumentError("estimator", self, allowed)
        points = as_queries(points, 3)
        columns, halves, depth = self.columns(), np.empty((len(points), 2)), np.empty(len(points))
        rows, grown = _weighted(columns), clearance.radius

        def work(first: int, last: int) -> None:
            part, filled = points[first:last], halves[first:last]
            d = depth[first:last]  # for now the distance, cut at the radius: no matter beyond
            nearest.signed_distances(clearance.handle, part, grown, radius, d)
            if grown > 0.0:
                ball.grown_quadrature(clearance.handle, part, radius, rows, d, grown, filled)
            else:
                ball.quadrature(clearance.handle, part, radius, rows, d, filled)

        in_chunks(work, len(points), clearance.threads, least=64)
        np.clip((radius - depth) / radius, 0.0, 2.0, out=depth)
        one, other = halves.T
        p = np.clip(0.5 * (one + other), 0.0, 1.0)
        error = 0.5 * np.abs(one - other) + 0.5 * columns[:, 3].max() * depth
        return Estimate(
            p,
            np.clip(p - error, 0.0, 1.0),
            np.clip(p + error, 0.0, 1.0),
            len(columns),
            None,
            "column quadrature",
        )


@functools.lru_cache(maxsize=8)
def _columns(rings: int, spokes: int) -> Floats:
    """``ColumnQuadrature.columns``, made once."""
    nodes, weights = np.polynomial.legendre.leggauss(rings)
    square, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    rows = []
    for ring, (q, w) in enumerate(zip(square, weights, strict=True)):
        for spoke in range(spokes):
            # turned by the golden angle from ring to ring, so that spokes do not line up
            angle = 2.0 * math.pi * spoke / spokes + ring * math.pi * (3.0 - math.sqrt(5.0))
            rho, weight = math.sqrt(q), 0.75 * w / (0.5 * spokes)
            x, y, half = rho * math.cos(angle), rho * math.sin(angle), math.sqrt(1.0 - q)
            rows.append((x, y, half, weight, spoke % 2))
    columns = np.array(rows, dtype=np.float64)
    columns.setflags(write=False)
    return columns


def _weighted(columns: Floats) -> Floats:
    """x, y, half height and weight in either half of the columns, shape (5, m)."""
    x, y, half, weight, second = columns.T
    return np.array([x, y, half, weight * (1.0 - second), weight * second])


@dataclass(frozen=True)
class BallSampling(Estimator):
    """For any obstacle: counts uniformly distributed points of the ball.

    Two models of the error differ in what they say of a whole trajectory. "independent": a new
    error at every state. "shared": one error that displaces the whole trajectory, drawn
    ``samples`` times; only then is there a probability that it ever collides.

    Args:
        samples: points for each state.
        offsets: "independent" or "shared".
        seed: of the random numbers, or a generator.
        confidence: of the intervals.

    Raises:
        ArgumentError: a value out of range.

    Reference: Nair and Kobilarov, eq. (9).
    """

    samples: int = 1000
    _: KW_ONLY
    offsets: Literal["independent", "shared"] = "independent"
    seed: int | np.random.Generator = 0
    confidence: float = 0.95

    def __post_init__(self) -> None:
        if not isinstance(self.samples, int) or self.samples < 1:
            raise ArgumentError("samples", self.samples, "a whole number of at least 1")
        if self.offsets not in ("independent", "shared"):
            raise ArgumentError("offsets", self.offsets, '"independent" or "shared"')
        if not 0.0 < self.confidence < 1.0:
            raise ArgumentError("confidence", self.confidence, "between 0 and 1")

    def estimate(
        self, clearance: Any, points: Floats, radius: float, *, times: Floats | None = None
    ) -> Estimate:
        """Shares for all points, with Clopper-Pearson intervals."""

        def inside(k: int, sampled: Floats) -> NDArray[np.bool_]:
            return in_obstacles(standing(clearance, times, k), sampled)

        return self.counted(inside, points, radius)

    def counted(
        self, inside: Callable[[int, Floats], NDArray[np.bool_]], points: Floats, radius: float
    ) -> Estimate:
        """The same for anything that tells which points count.

        Args:
            inside: inside(k, sampled), which of the points sampled about centre k count, (m,).
            points: centres [m], shape (n, 3).
            radius: of the ball [m].
        """
        rng = np.random.default_rng(self.seed)
        shared = self.offsets == "shared"
        offsets = radius * ball_points(self.samples, rng)
        hits, ever = np.empty(len(points), dtype=np.int64), np.zeros(self.samples, dtype=bool)
        for k, point in enumerate(points):
            if not shared and k > 0:
                offsets = radius * ball_points(self.samples, rng)
            hit = inside(k, point + offsets)
            hits[k] = hit.sum()
            ever |= hit
        low, high = clopper_pearson(hits, self.samples, self.confidence)
        whole = None
        if shared:
            ends = clopper_pearson(ever.sum(), self.samples, self.confidence)
            whole = Proportion(
                float(ever.mean()), float(ends[0]), float(ends[1]), self.samples, self.confidence
            )
        return Estimate(
            hits / self.samples,
            low,
            high,
            self.samples,
            self.confidence,
            f"ball sampling with {self.offsets} offsets",
            whole,
        )


def ball_points(n: int, rng: np.random.Generator) -> Floats:
    """Points distributed uniformly in the unit ball, shape (n, 3)."""
    directions = rng.standard_normal((n, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * np.cbrt(rng.uniform(size=(n, 1)))


def levelled(clearance: Any) -> Any:
    """The clearance with the ground going on level beyond the map, where it else is -inf."""
    if isinstance(clearance, MovingClearance):
        return clearance.with_static(levelled(clearance.static))
    if isinstance(clearance, UnionClearance) and not clearance.uses_orientation:
        return UnionClearance([levelled(member) for member in clearance.members])
    if not isinstance(clearance, TerrainClearance):
        return clearance
    xmin, xmax, ymin, ymax = clearance.terrain.extent

    def level(points: Floats) -> Floats:
        on_map = points.copy()
        on_map[:, 0] = points[:, 0].clip(xmin, xmax)
        on_map[:, 1] = points[:, 1].clip(ymin, ymax)
        return clearance(on_map)

    return level


def standing(clearance: Any, times: Floats | None, k: int) -> Any:
    """The obstacles as they stand when the k-th state is reached."""
    if not isinstance(clearance, MovingClearance):
        return clearance
    if times is None:
        raise ArgumentError("times", None, "given where obstacles move")
    return levelled(clearance).at(times[k])


def in_obstacles(clearance: Any, points: Floats) -> NDArray[np.bool_]:
    """Which points count as obstacle."""
    if isinstance(clearance, TerrainClearance) and clearance.radius == 0.0:
        found = np.empty(len(points), dtype=np.bool_)
        ball.in_ground(clearance.handle, points, found)
        return found
    d = np.asarray(levelled(clearance)(points), dtype=np.float64)
    if d.shape != (len(points),) or np.isnan(d).any():
        raise ArgumentError(
            "obstacles(points)", d, f"distances without NaN of shape ({len(points)},)"
        )
    return d <= 0.0
