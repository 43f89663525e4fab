"""The meshes among moving obstacles."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import moving, moving_motions
from ompl_risk._kernels.motion import CONTACT
from ompl_risk._kernels.moving import Tracks
from ompl_risk.clearance.mesh import MeshClearance
from ompl_risk.clearance.moving.intervals import Spans, Wait
from ompl_risk.clearance.moving.search import TimedMotions, lower_least, still_blocked
from ompl_risk.clearance.moving.travel import Travel


class Meshes:
    """Obstacles ``first`` to ``first + len(bodies) - 1`` of the tracks, which are meshes.

    A mesh lies in its box, so where the box is far the mesh is not asked.

    Args:
        tracks: all obstacles.
        first: index of the first mesh.
        bodies: the meshes in their own frames.
    """

    def __init__(self, tracks: Tracks, first: int, bodies: Sequence[MeshClearance]) -> None:
        self._tracks, self._first, self._bodies = tracks, first, tuple(bodies)

    def lower_points(
        self, points: FloatArray, times: FloatArray, d: FloatArray, which: NDArray[np.intp]
    ) -> None:
        """Lower distances ``d`` [m] of points at times to those of the meshes."""
        near = np.empty(len(points), np.bool_)
        for j, body in self._numbered():
            moving.are_near(self._tracks, j, points, times, d, near)
            k = np.flatnonzero(near)
            found = self._distance(j, body)(points[k], times[k])
            lower = found < d[k]
            d[k[lower]], which[k[lower]] = found[lower], j

    def lower(
        self, motions: TimedMotions, least: FloatArray, when: FloatArray, tolerance: float
    ) -> None:
        """Lower the least distances of motions; see ``lower_least``."""
        for j, body in self._numbered():
            k = self._near(j, motions, least - tolerance, 0.5 * tolerance)
            distance, travels = self._distance(j, body), self._travels(j)
            lower_least(motions, k, distance, travels, least, when, tolerance=tolerance)

    def keep_free(self, motions: TimedMotions, free: NDArray[np.bool_], radius: float) -> None:
        """Make ``free`` false for motions that are not certainly free."""
        enough, when = radius + CONTACT, motions.ta.copy()
        least = np.full(len(free), np.nextafter(enough, np.inf))
        for j, body in self._numbered():
            k = self._near(j, motions, np.where(free, radius, -np.inf), CONTACT)
            k = k[free[k]]
            lower_least(
                motions, k, self._distance(j, body), self._travels(j), least, when,
                tolerance=0.5 * CONTACT, floor=enough,
            )  # fmt: skip
            free[k] = least[k] > enough

    def blocked(self, points: FloatArray, wait: Wait) -> list[Spans]:
        """Spans in which places are not certainly free of the meshes, a pair for each mesh."""
        return [self._blocked(j, body, points, wait) for j, body in self._numbered()]

    def _blocked(self, j: int, body: MeshClearance, points: FloatArray, wait: Wait) -> Spans:
        tracks, enough = self._tracks, wait.enough
        owners, spans = wait.blocked(tracks, j, j + 1, points)
        # After its last time the mesh stands still: any finite wait says what holds for ever.
        last = tracks.times[tracks.first[j + 1] - 1]
        endless = np.isinf(spans[:, 1])
        ends = np.where(endless, np.maximum(spans[:, 0], last), spans[:, 1])
        p = points[owners]
        waits = TimedMotions(p, spans[:, 0].copy(), p, ends)
        k, found = still_blocked(
            waits,
            self._distance(j, body),
            self._travels(j),
            enough=enough,
            resolution=wait.resolution,
        )
        for_ever = endless[k] & (found[:, 1] >= ends[k])
        for_ever[for_ever] = self._distance(j, body)(p[k[for_ever]], ends[k[for_ever]]) <= enough
        found[for_ever, 1] = np.inf
        return owners[k], found

    def _numbered(self) -> enumerate[MeshClearance]:
        return enumerate(self._bodies, self._first)

    def _near(
        self, j: int, motions: TimedMotions, limits: FloatArray, slack: float
    ) -> NDArray[np.intp]:
        """Motions that may come nearer to the box of mesh j than the limits [m]."""
        beyond = np.ones(len(limits), np.bool_)
        moving_motions.are_beyond(self._tracks, j, j + 1, *motions, limits, slack, beyond)
        return np.flatnonzero(~beyond)

    def _distance(
        self, j: int, body: MeshClearance
    ) -> Callable[[FloatArray, FloatArray], FloatArray]:
        def distance(points: FloatArray, times: FloatArray) -> FloatArray:
            local = np.empty((len(points), 3))
            moving.to_obstacle(self._tracks, j, points, times, local)
            return body(local)

        return distance

    def _travels(self, j: int) -> Callable[[TimedMotions], Travel]:
        def travels(motions: TimedMotions) -> Travel:
            out = np.empty((3, len(motions.a)))
            moving_motions.relative_travels(self._tracks, j, *motions, out)
            return Travel(*out)

        return travels
