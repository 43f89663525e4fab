"""Probability of collision over time."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive
from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.probability.estimators import BallSampling, ColumnQuadrature, Estimator
from ompl_risk.probability.mixed import ColumnsAndSampling
from ompl_risk.probability.proportion import Proportion
from ompl_risk.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class CollisionProfile(ReadOnlyArrays):
    """P_c(t) along a trajectory, with how sure it is.

    Attributes:
        t: times [s], shape (n,).
        p: probabilities, shape (n,).
        low, high: bounds, shape (n,). For sampling, the Clopper-Pearson interval of each single
            state; for quadrature, the estimate plus and minus its estimated error (an upper bound
            of 0 says that obstacles are out of reach).
        samples: points or columns for each state.
        confidence: of the intervals; ``None`` for quadrature, whose bounds are no such thing.
        radius: of the ball [m].
        method: what was done, in words.
        ever: share of offsets that collide at any state, for sampling with shared offsets.
    """

    t: FloatArray
    p: FloatArray
    low: FloatArray
    high: FloatArray
    samples: int
    confidence: float | None
    radius: float
    method: str
    ever: Proportion | None = None

    def __post_init__(self) -> None:
        for array in (self.t, self.p, self.low, self.high):
            array.setflags(write=False)

    def __repr__(self) -> str:
        k = int(np.argmax(self.p))
        return (
            f"CollisionProfile(max {self.p[k]:.3g} in [{self.low[k]:.3g}, {self.high[k]:.3g}] "
            f"at t = {self.t[k]:g} s; {self.method}, {self.samples} a state)"
        )


def collision_probability(
    trajectory: Trajectory,
    obstacles: Any,
    radius: float = 100.0,
    *,
    estimator: Estimator | None = None,
    grow: bool = False,
    max_step: float | Literal["auto"] | None = "auto",
) -> CollisionProfile:
    """Share of the ball of possible positions around each state that lies in obstacles.

    ::

        P_c(t) = vol(B(x(t), r) within O) / vol(B(x(t), r))

    that is, the vehicle is somewhere in the ball, anywhere with equal probability. Equation (2) of
    the paper prints the free share instead; its text and (9) mean this one. Beyond a terrain's
    edge the ground is taken to go on level.

    Args:
        trajectory: where the vehicle should be.
        obstacles: a ``Terrain``, a clearance, or any callable from points (n, 3) to distances.
            Those of a ``MovingClearance`` are taken as they stand when each state is reached.
        radius: r, bound of the position error [m].
        estimator: if left out ``ColumnQuadrature()`` for terrain, ``ColumnsAndSampling()`` for
            terrain with obstacles that move, and ``BallSampling()`` for the rest.
        grow: count positions where the vehicle's sphere touches an obstacle, rather than, as (9)
            does, only those where its centre is inside. A plain callable is taken as it is.
        max_step: longest step between states [m], also against obstacles that move and may come
            into the ball; "auto" is radius / 50, ``None`` takes the trajectory's own samples.

    Returns:
        P_c at the samples of the (refined) trajectory, with bounds.

    Raises:
        ArgumentError: a radius or step out of range, quadrature for something that is no terrain,
            ``grow`` for obstacles without a body.

    Reference: Nair and Kobilarov, eqs. (2) and (9).
    """
    radius = positive("radius", radius)
    if not isinstance(trajectory, Trajectory):
        raise ArgumentError("trajectory", type(trajectory).__name__, "a Trajectory")
    if estimator is not None and not isinstance(estimator, Estimator):
        raise ArgumentError("estimator", estimator, "ColumnQuadrature() or BallSampling()")
    terrain = _as_clearance(obstacles, grow)
    if estimator is None:
        estimator = _suited(terrain)
    if max_step is not None:
        step = radius / 50.0 if max_step == "auto" else positive("max_step", max_step)
        trajectory = _refined(trajectory, terrain, step, radius)
    points = np.ascontiguousarray(trajectory.positions)
    when = {"times": trajectory.t} if isinstance(terrain, MovingClearance) else {}
    estimate = estimator.estimate(terrain, points, radius, **when)
    body = " grown by the body" if grow else ""
    return CollisionProfile(
        np.array(trajectory.t),
        estimate.p,
        estimate.low,
        estimate.high,
        estimate.samples,
        estimate.confidence,
        radius,
        f"{estimate.method}, obstacles{body}",
        estimate.ever,
    )


def collision_probabilities(
    trajectories: Trajectory | Iterable[Trajectory],
    obstacles: Any,
    radius: float = 100.0,
    *,
    estimator: Estimator | None = None,
    grow: bool = False,
    max_step: float | Literal["auto"] | None = "auto",
) -> dict[str, CollisionProfile]:
    """``collision_probability`` of many trajectories by name, as `rank` takes them.

    Over terrain, by quadrature, threads take a trajectory each, which is quicker than one after the
    other; the profiles are the same.

    Args:
        trajectories: one or many, with names that differ.
        obstacles: see ``collision_probability``, as for all that follow.
        radius: of the ball [m].
        estimator: how.
        grow: whether by the body.
        max_step: longest step between states [m].

    Raises:
        ArgumentError: names that repeat, or as for one trajectory.
    """
    chosen = [trajectories] if isinstance(trajectories, Trajectory) else list(trajectories)
    for each in chosen:
        if not isinstance(each, Trajectory):
            raise ArgumentError("trajectories", type(each).__name__, "objects of class Trajectory")
    names = [each.name for each in chosen]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ArgumentError("trajectories", twice, "names that differ: Trajectory(..., name=...)")
    clearance, threads = _shared_out(_as_clearance(obstacles, grow), estimator, len(chosen))

    def work(each: Trajectory) -> CollisionProfile:
        return collision_probability(
            each, clearance, radius, estimator=estimator, grow=grow, max_step=max_step
        )

    if threads == 1:
        return dict(zip(names, map(work, chosen), strict=True))
    with ThreadPoolExecutor(threads) as pool:
        return dict(zip(names, pool.map(work, chosen), strict=True))


def _shared_out(clearance: Any, estimator: Estimator | None, count: int) -> tuple[Any, int]:
    """The clearance for each of some trajectories, and how many of them at a time.

    Nobody else's code runs in threads, and a generator of random numbers has its order.
    """
    quadrature = estimator is None or type(estimator) is ColumnQuadrature
    if type(clearance) is not TerrainClearance or not quadrature:
        return clearance, 1
    if count < 2 * clearance.threads:
        return clearance, 1
    single = clearance.with_radius(clearance.radius)
    single.threads = 1
    return single, clearance.threads


def _suited(clearance: Any) -> Estimator:
    """The best estimator for obstacles."""
    if isinstance(clearance, MovingClearance):
        over_terrain = isinstance(clearance.static, TerrainClearance)
        return ColumnsAndSampling() if over_terrain else BallSampling()
    return ColumnQuadrature() if isinstance(clearance, TerrainClearance) else BallSampling()


def _refined(trajectory: Trajectory, clearance: Any, step: float, radius: float) -> Trajectory:
    """With states no more than ``step`` [m] apart, also against what moves within ``radius``."""
    trajectory = trajectory.densify(step)
    if not isinstance(clearance, MovingClearance):
        return trajectory
    while True:
        t, x = trajectory.t, trajectory.positions
        travels = clearance.travels(x[:-1], t[:-1], x[1:], t[1:], far=radius)
        # Few parts at a time: of a long wait only a moment may be near an obstacle.
        parts = np.clip(np.ceil(travels / step * (1.0 - 1e-9)), 1.0, 8.0).astype(np.int64)
        if (parts == 1).all():
            return trajectory
        trajectory = trajectory.subdivide(parts)


def _as_clearance(obstacles: Any, grow: bool) -> Any:
    """A clearance whose d <= 0 says that a point counts as collision."""
    if hasattr(obstacles, "heights"):
        if grow:
            raise ArgumentError("grow", True, "False for a bare Terrain: pass a TerrainClearance")
        return TerrainClearance(obstacles)
    if not callable(obstacles):
        raise ArgumentError("obstacles", obstacles, "a Terrain or a clearance")
    if getattr(obstacles, "uses_orientation", False) and grow:
        raise ArgumentError("grow", True, "False for a mesh body: the ball holds points only")
    if grow or not hasattr(obstacles, "of_point"):
        return obstacles
    clearance: Any = obstacles
    return clearance.of_point()
