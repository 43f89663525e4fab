"""The plan of a point mass: any trajectory, and the feedback that keeps the vehicle beside it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_discrete_are, solveh_banded

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly, real_number
from ompl_risk._interpolation import linear
from ompl_risk._kernels.point_loop import PointLoop, roll_out_point
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.gusts import X_CELL_DRAG
from ompl_risk.simulation.loop.air import Air, directions
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.plans import Plan
from ompl_risk.trajectory import Trajectory

SHARE = 0.6
"""Part of the acceleration that the planned motion may take; the rest is left to feedback."""


class PointPlan(ReadOnlyArrays, Plan):
    """A point mass that tracks a trajectory by a linear quadratic regulator.

    ::

        x' = v,   v' = a + drag / mass (gust - (v - planned v))
        a = planned a - k_p (x - planned x + error) - k_v (v - planned v + error),  |a| <= limit

    Drag acts along the axes of the planned flight (forward, left, up) on what the vehicle is faster
    than planned: the planned motion's own drag is in the plan. The gains minimise the sum of
    ``|x - planned x|^2 + |a|^2 / bandwidth^4``; for small steps they are ``bandwidth^2`` and
    ``sqrt(2) bandwidth``. A step is ``v += dt v'``, then ``x += dt v``, which the samples of any
    motion satisfy with velocities that are differences of the positions.

    A trajectory may have corners that no vehicle flies at speed. The planned motion is therefore
    the one nearest to the trajectory that takes no more than ``SHARE`` of the limit: it minimises
    the sum of ``|x - trajectory|^2 + weight |x''|^2`` with the least weight for which that is so.
    Straight pieces flown at constant speed stay as they are, corners are cut. The way and the
    times of the trajectory are not changed otherwise: it should be flown at a speed that suits it.

    Args:
        trajectory: where the vehicle is to be, and when; its first time counts as 0.
        dt: the longest step [s]; the duration is divided into equal ones.
        acceleration: the limit [m/s^2]; infinite for none, and corners are then kept. The default
            is the level part of a lift of 1.3 weights that holds the height.
        bandwidth: of the feedback [rad/s].
        mass: [kg]; the X-Cell 60's by default.
        drag: along the axes of the flight [kg/s], shape (3,); see ``gusts.X_CELL_DRAG``.
        name: what tables call it; None: the trajectory's name.

    Raises:
        ArgumentError: a number out of range.

    Reference: Anderson & Moore, Optimal Control: Linear Quadratic Methods, 1990; Whittaker, On a
    new method of graduation, Proceedings of the Edinburgh Mathematical Society 41, 1923 (rounding).
    """

    def __init__(
        self,
        trajectory: Trajectory,
        *,
        dt: float = 0.02,
        acceleration: float = 8.0,
        bandwidth: float = 1.0,
        mass: float = 8.2,
        drag: ArrayLike = X_CELL_DRAG,
        name: str | None = None,
    ) -> None:
        steps = max(1, math.ceil(trajectory.duration / positive("dt", dt) * (1.0 - 1e-12)))
        allowed = "a positive acceleration [m/s^2], or infinite"
        limit = real_number("acceleration", acceleration, allowed)
        if not limit > 0.0:
            raise ArgumentError("acceleration", acceleration, allowed)
        self.trajectory = trajectory
        self.name = trajectory.name if name is None else str(name)
        self.dt = trajectory.duration / steps
        self.acceleration, self.bandwidth = limit, positive("bandwidth", bandwidth)
        self.mass, self.drag = positive("mass", mass), _drag(drag)
        self.times = _closed(self.dt * np.arange(steps + 1))
        samples = linear(
            np.minimum(trajectory.t[0] + self.times, trajectory.t[-1]),
            trajectory.t, trajectory.positions,
        )  # fmt: skip
        self.positions = _closed(rounded(samples, self.dt, SHARE * limit))
        v = np.diff(self.positions, axis=0) / self.dt
        self.velocities = _closed(np.concatenate([v[:1], v]))
        self.gains = feedback_gains(self.dt, self.bandwidth)
        angles = directions(self.velocities)[:-1]
        self._loop = PointLoop(
            self.positions, self.velocities,
            _closed(np.column_stack([np.cos(angles), np.sin(angles)])),
            *self.gains, limit, self.mass, self.dt,
        )  # fmt: skip

    def __repr__(self) -> str:
        return f"PointPlan({self.trajectory!r}, dt={self.dt:.4g})"

    def run(self, air: Air, first: int, last: int, outcomes: Outcomes) -> None:
        """Fly rollouts ``first`` to ``last - 1`` and write their rows; see ``Plan.run``."""
        roll_out_point(self._loop, air, first, last, outcomes.record)


def feedback_gains(dt: float, bandwidth: float) -> tuple[float, float]:
    """k_p [1/s^2] and k_v [1/s] of the regulator of the sampled double integrator.

    Args:
        dt: the step [s].
        bandwidth: [rad/s].
    """
    a, b = np.array([[1.0, dt], [0.0, 1.0]]), np.array([[dt * dt], [dt]])
    effort = np.array([[bandwidth**-4.0]])
    p = solve_discrete_are(a, b, np.diag([1.0, 0.0]), effort)
    k_p, k_v = np.linalg.solve(effort + b.T @ p @ b, b.T @ p @ a)[0]
    return float(k_p), float(k_v)


def rounded(samples: FloatArray, dt: float, limit: float) -> FloatArray:
    """The motion nearest to the samples whose acceleration is within a limit.

    Args:
        samples: positions [m], shape (n, 3).
        dt: time from one to the next [s].
        limit: [m/s^2].

    Raises:
        ArgumentError: a limit so low that little would be left of the motion.
    """
    if not len(samples) > 2 or _sharpest(samples, dt) <= limit:
        return samples
    low, high = 0.0, 1.0  # weights of the second differences
    while _sharpest(_smoothed(samples, high), dt) > limit:
        low, high = high, 16.0 * high
        if high > len(samples) ** 4.0:
            allowed = "enough to stay near the trajectory within its duration"
            raise ArgumentError("acceleration", limit / SHARE, allowed)
    for _ in range(20):
        middle = math.sqrt(low * high) if low else 0.5 * high
        within = _sharpest(_smoothed(samples, middle), dt) <= limit
        low, high = (low, middle) if within else (middle, high)
    return _smoothed(samples, high)


def _sharpest(positions: FloatArray, dt: float) -> float:
    return float(np.linalg.norm(np.diff(positions, n=2, axis=0), axis=1).max()) / dt**2


def _smoothed(samples: FloatArray, weight: float) -> FloatArray:
    """Minimise the sum of |x - samples|^2 + weight |second differences of x|^2, the ends fixed.

    With x = samples - y the normal equations, five bands, have a right-hand side that is 0 where
    the samples are straight, so that nothing is lost there to rounding.
    """
    n, second = len(samples), np.array([1.0, -2.0, 1.0])
    bands, bends = np.zeros((3, n)), np.diff(samples, n=2, axis=0)
    right = np.zeros_like(samples)
    for i in range(3):
        right[i : n - 2 + i] += weight * second[i] * bends
        for j in range(i, 3):
            bands[2 - (j - i), j : n - 2 + j] += weight * second[i] * second[j]
    bands[2] += 1.0
    inner = samples[1:-1] - solveh_banded(bands[:, 1:-1], right[1:-1])
    return np.concatenate([samples[:1], inner, samples[-1:]])


def _drag(value: ArrayLike) -> FloatArray:
    drag = readonly("drag", value, (3,), "(3,): forward, left, up [kg/s]")
    if drag.min() < 0.0:
        raise ArgumentError("drag", drag.tolist(), "0 or more in every direction")
    return drag


def _closed(values: ArrayLike) -> FloatArray:
    array = np.array(values, dtype=np.float64, order="C")
    array.setflags(write=False)
    return array
