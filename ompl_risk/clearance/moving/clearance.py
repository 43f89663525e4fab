"""Distance to obstacles that move, d(q, t)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray, positive
from ompl_risk._kernels import moving, moving_motions
from ompl_risk._kernels.motion import CONTACT
from ompl_risk.clearance.base import as_length, as_queries
from ompl_risk.clearance.moving import arguments as given
from ompl_risk.clearance.moving.intervals import SafeIntervals, Wait, the_rest
from ompl_risk.clearance.moving.meshes import Meshes
from ompl_risk.clearance.moving.moment import Moment
from ompl_risk.clearance.moving.obstacles import MovingMesh, MovingObstacle
from ompl_risk.clearance.moving.search import Approach
from ompl_risk.clearance.moving.static_part import StaticPart, resized
from ompl_risk.clearance.moving.tracks import as_times, greatest_speed, packed
from ompl_risk.clearance.threads import in_chunks, thread_count
from ompl_risk.errors import ArgumentError

LEAST = 1024
"""Fewest rows that are worth a thread."""


class MovingClearance:
    """Signed distance from a sphere to obstacles on known trajectories and to what stands still.

    ::

        d(q, t) = min( min_j dist(q, O_j(t)), d_static(q) + radius ) - radius

    It is 1-Lipschitz in q; in t it changes by at most ``speed_bound``. Between two instants of a
    straight motion d is bounded, for balls and boxes, by its tangents, since the distance to a
    convex body is convex; for meshes and what stands still by the relative travel. Motions are
    therefore checked for certain, however fast and small an obstacle is.

    Balls and boxes are compiled; a mesh takes some 10 us a query and more, but is asked only where
    the box about it is nearest. Times are those of the obstacles' clock, also of trajectories.

    Args:
        obstacles: one ``MovingSphere``, ``MovingBox`` or ``MovingMesh``, or several.
        static: clearance of what stands still, for a sphere of the same radius. Of a function that
            is 1-Lipschitz but no distance to anything, ``are_free`` holds, ``least_between`` not.
        radius: of the vehicle's sphere [m]; None: that of ``static``, or 0.
        threads: for large batches; ``None`` uses all processors.

    Raises:
        ArgumentError: no obstacle or something else, a ``static`` that moves, needs an orientation
            or is for a sphere of another radius, or a bad radius or thread count.

    Example:
        >>> from ompl_risk.clearance.moving.obstacles import MovingSphere
        >>> ball = MovingSphere(2.0, [0.0, 10.0], [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])
        >>> MovingClearance(ball, radius=1.0)([[50.0, 8.0, 0.0]], [5.0])
        array([5.])

    Reference: Nair and Kobilarov, eq. (1), with obstacles O(t).
    """

    moves = True
    uses_orientation = False
    reach = 0.0

    def __init__(
        self,
        obstacles: MovingObstacle | Sequence[MovingObstacle],
        *,
        static: Any = None,
        radius: float | None = None,
        threads: int | None = None,
    ) -> None:
        self.obstacles = given.as_obstacles(obstacles)
        self.static = static
        self._static = None if static is None else StaticPart(static)
        self.radius = given.common_radius(static, radius)
        self.threads = thread_count(threads)
        meshes = np.array([isinstance(each, MovingMesh) for each in self.obstacles])
        self._index = np.argsort(meshes, kind="stable")
        ordered = [self.obstacles[k] for k in self._index]
        self._tracks = packed(ordered)
        bodies = [each.body for each in ordered if isinstance(each, MovingMesh)]
        self._compiled = len(ordered) - len(bodies)
        self._meshes = Meshes(self._tracks, self._compiled, bodies)

    def __reduce__(self) -> tuple[Any, ...]:
        # Unpickled arrays are writable: what kernels read is made anew.
        rest = {"static": self.static, "radius": self.radius, "threads": self.threads}
        return partial(type(self), **rest), (self.obstacles,)

    def __repr__(self) -> str:
        static = "" if self.static is None else f", static={self.static!r}"
        return f"MovingClearance({len(self.obstacles)} obstacles{static}, radius={self.radius:g})"

    def __call__(self, points: ArrayLike, times: ArrayLike | None = None) -> FloatArray:
        """Distances d(q, t) [m], shape (n,).

        Args:
            points: centres of the sphere [m], shape (n, 3).
            times: when [s], shape (n,), or one for all.

        Raises:
            ArgumentError: no times, a wrong shape, or a number that is not finite.
        """
        return self._nearest(points, times)[0]

    def which(self, points: ArrayLike, times: ArrayLike) -> NDArray[np.intp]:
        """Index of the obstacle that is nearest, shape (n,); -1 for what stands still."""
        return self._nearest(points, times)[1]

    def at(self, time: float) -> Moment:
        """The obstacles as they stand at one time [s], an ordinary clearance.

        Raises:
            ArgumentError: a time that is not finite.
        """
        return Moment(self, float(as_times("time", time, 1)[0]))

    def with_radius(self, radius: float) -> MovingClearance:
        """The same obstacles for a sphere of another radius [m]."""
        length = as_length(radius, "radius")
        return self._with(resized(self.static, self.radius, length), length)

    def with_static(self, static: Any) -> MovingClearance:
        """The same moving obstacles among others that stand still; see the class.

        Raises:
            ArgumentError: ``static`` moves, needs an orientation or is for another radius.
        """
        return self._with(static, given.common_radius(static, self.radius))

    def of_point(self) -> MovingClearance:
        """The same obstacles for a body that is a single point."""
        return self.with_radius(0.0)

    def speed_bound(self, t0: ArrayLike, t1: ArrayLike) -> Any:
        """Greatest speed [m/s] of any point of any obstacle from t0 to t1, shape as theirs."""
        return greatest_speed(self._tracks, t0, t1)

    def travels(
        self, a: ArrayLike, ta: ArrayLike, b: ArrayLike, tb: ArrayLike, *, far: float = np.inf
    ) -> FloatArray:
        """Bounds [m] for the change of min(d, far) on motions, shape (n,).

        ::

            max_j integral of |q' - p_j'| + |omega_j| reach_j dt, while j may be within ``far``

        Args:
            a: where they begin, as for ``least_between``.
            ta: when.
            b: where they end.
            tb: when.
            far: distance [m] beyond which obstacles do not matter.
        """
        motions = given.as_motions(a, ta, b, tb)
        out = np.zeros(len(motions.a))
        if self.static is not None:
            out += np.linalg.norm(motions.b - motions.a, axis=1)
        moving_motions.travels(
            self._tracks, 0, len(self.obstacles), *motions, far + self.radius, out
        )
        return out

    def least_between(
        self, a: ArrayLike, ta: ArrayLike, b: ArrayLike, tb: ArrayLike, *, tolerance: float = 0.01
    ) -> FloatArray:
        """Least distances [m] on straight motions at constant velocity, shape (n,).

        Args:
            a: where they begin [m], shape (n, 3).
            ta: when [s], shape (n,) or one for all.
            b: where they end [m], shape (n, 3).
            tb: when [s], not before ta, and later wherever b is not a.
            tolerance: by how much the result may be too great [m]; it is never too small.

        Raises:
            ArgumentError: a wrong shape, a number that is not finite, a motion that takes no time,
                or a tolerance that is not positive.
        """
        return self.approach(a, ta, b, tb, tolerance=tolerance).d

    def approach(
        self, a: ArrayLike, ta: ArrayLike, b: ArrayLike, tb: ArrayLike, *, tolerance: float = 0.01
    ) -> Approach:
        """The same, and when the distance is least."""
        motions, tolerance = given.as_motions(a, ta, b, tb), positive("tolerance", tolerance)
        n = len(motions.a)
        d, t = np.full(n, np.inf), motions.ta.copy()

        def work(i: int, j: int) -> None:
            a, ta, b, tb = motions.chosen(slice(i, j))
            moving_motions.least_between(
                self._tracks, self._compiled, a, ta, b, tb, tolerance, d[i:j], t[i:j]
            )

        in_chunks(work, n, self.threads, least=LEAST)
        self._meshes.lower(motions, d, t, tolerance)
        d -= self.radius
        if self._static is not None:
            self._static.lower(motions, d, t, tolerance)
        return Approach(d, t)

    def are_free(
        self, a: ArrayLike, ta: ArrayLike, b: ArrayLike, tb: ArrayLike
    ) -> NDArray[np.bool_]:
        """Whether d > 0 at every instant of straight motions, for certain, shape (n,).

        May be false where d falls to 1 mm or less. See ``least_between`` for the arguments.
        """
        motions = given.as_motions(a, ta, b, tb)
        n = len(motions.a)
        free, limits = np.ones(n, np.bool_), np.full(n, self.radius)

        def work(i: int, j: int) -> None:
            a, ta, b, tb = motions.chosen(slice(i, j))
            moving_motions.are_beyond(
                self._tracks, 0, self._compiled, a, ta, b, tb, limits[i:j], CONTACT, free[i:j]
            )

        in_chunks(work, n, self.threads, least=LEAST)
        if self._static is not None:
            self._static.keep_free(motions, free, self.threads)
        self._meshes.keep_free(motions, free, self.radius)
        return free

    def safe_intervals(
        self, points: ArrayLike, t0: float, t1: float, *, resolution: float = 1e-3
    ) -> SafeIntervals:
        """When places are free, for certain.

        Waiting at the place within an interval is free by ``are_free``. What is left out is within
        ``resolution`` of an instant at which d is 1 mm or less, or at most what an obstacle
        covers in that time.

        Args:
            points: places [m], shape (n, 3).
            t0: from [s].
            t1: to [s], after t0; may be infinite.
            resolution: of the ends of the intervals [s].

        Raises:
            ArgumentError: a wrong shape, times out of order, or a resolution that is not positive.
        """
        wait = Wait(
            *given.as_wait(t0, t1), self.radius + CONTACT, positive("resolution", resolution)
        )
        queries = as_queries(points, 3)
        spans = [
            wait.blocked(self._tracks, 0, self._compiled, queries),
            *self._meshes.blocked(queries, wait),
        ]
        if self._static is not None:
            spans.append(wait.all_of(self._static.distances(queries) <= CONTACT))
        return the_rest(spans, len(queries), wait)

    def free_intervals(
        self, points: ArrayLike, t0: float, t1: float, *, resolution: float = 1e-3
    ) -> list[list[tuple[float, float]]]:
        """``safe_intervals`` as a list of (begin, end) [s] for each place."""
        return self.safe_intervals(points, t0, t1, resolution=resolution).as_lists()

    def _with(self, static: Any, radius: float) -> MovingClearance:
        """The same moving obstacles; what kernels read is shared."""
        other = object.__new__(type(self))
        vars(other).update(vars(self))
        other.static, other.radius = static, radius
        other._static = None if static is None else StaticPart(static)
        return other

    def _nearest(
        self, points: ArrayLike, times: ArrayLike | None
    ) -> tuple[FloatArray, NDArray[np.intp]]:
        """Least distances and the indices of the obstacles that have them."""
        if times is None:
            raise ArgumentError("times", None, given.TIMELESS)
        queries = as_queries(points, 3)
        n = len(queries)
        t, d, which = as_times("times", times, n), np.full(n, np.inf), np.zeros(n, np.intp)

        def work(i: int, j: int) -> None:
            moving.least_distances(
                self._tracks, 0, self._compiled, queries[i:j], t[i:j], d[i:j], which[i:j]
            )

        in_chunks(work, n, self.threads, least=LEAST)
        self._meshes.lower_points(queries, t, d, which)
        which = self._index[which]
        d -= self.radius
        if self._static is not None:
            other = self._static.distances(queries)
            which[other < d] = -1
            np.minimum(d, other, out=d)
        return d, which
