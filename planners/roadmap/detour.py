"""Whether a path makes a detour where its two halves meet."""

from __future__ import annotations

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import via as kernels
from ompl_risk.planners.roadmap.corridor import Corridor
from ompl_risk.planners.roadmap.via import Pool


class DetourTest:
    """Finds paths that go aside and come back for nothing.

    Both halves of a path by way of a vertex are the best there are, but where they meet it can have
    a spike. The stretch of it from ``span`` before the vertex to ``span`` behind, or the nearest
    vertices farther off, is a detour if the graph has a path between its ends that is better by
    more than the tolerance, ``along > (1 + stretch) best``, by the mix that the path was found by.

    Args:
        corridor: where the paths are.
        pool: the paths.
        mixes: the mixes they were found by.
        arc: length travelled at each of the pool's vertices, running on from path to path [m].
        span: [m].
        stretch: relative.

    Reference:
        Abraham et al. (see ``via_paths``), uniformly bounded stretch, tested where it matters.
    """

    def __init__(
        self,
        corridor: Corridor,
        pool: Pool,
        mixes: FloatArray,
        arc: FloatArray,
        *,
        span: float,
        stretch: float,
    ) -> None:
        self._corridor, self._pool, self._mixes, self._arc = corridor, pool, mixes, arc
        self._span, self._stretch = span, stretch
        self._space = kernels.search_space(corridor.graph.n)

    def __call__(self, k: int) -> bool:
        """Whether path k makes a detour."""
        graph, (i, j) = self._corridor.graph, self._stretch_of(k)
        path = np.stack([self._pool.vertices[i : j + 1], self._pool.edges[i : j + 1]])
        mix = float(self._mixes[self._pool.mix[k]])
        mixture = kernels.Mixture(self._corridor.duration, graph.risk, mix, graph.maximum)
        return kernels.can_be_cut(self._corridor.rows, mixture, path, self._stretch, self._space)

    def _stretch_of(self, k: int) -> tuple[int, int]:
        """Places of its first and last vertex among all vertices of the pool."""
        begin, end = int(self._pool.first[k]), int(self._pool.first[k + 1]) - 1
        arc = self._arc[begin : end + 1]
        here = arc[self._pool.via[k]]
        i = int(np.searchsorted(arc, here - self._span, side="right")) - 1
        j = int(np.searchsorted(arc, here + self._span))
        return begin + max(i, 0), min(begin + j, end)
