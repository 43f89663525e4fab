"""Where a roadmap can still find something better than it has."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray

if TYPE_CHECKING:
    from ompl_risk.planners.roadmap.roadmap import Roadmap


class Prospects:
    """Lower bounds for paths through states, beside the best path of a roadmap.

    Args:
        roadmap: looked at, not changed.
    """

    def __init__(self, roadmap: Roadmap) -> None:
        self._roadmap = roadmap

    def box(self) -> tuple[FloatArray, FloatArray] | None:
        """A box outside which no path is better than the best, for the sake of its length.

        Positions from which both ends are not farther than L in all fill an ellipsoid with the ends
        as foci (Gammell, Srinivasa & Barfoot, Informed RRT*, IROS 2014); this is its box.

        Returns:
            Least and greatest coordinates [m]; None without a path, or with ends at several places.
        """
        roadmap = self._roadmap
        ends = self._ends()
        if roadmap.best is None or ends is None or roadmap.maximum:
            return None
        (a, b), best = ends, roadmap.best
        longest = roadmap.risk.speed * (best.risk / roadmap.time_weight + best.duration)
        between = float(np.linalg.norm(b - a))
        along = (b - a) / between if between > 0.0 else np.zeros(3)
        wide = math.sqrt(max(longest * longest - between * between, 0.0))
        half = 0.5 * np.sqrt((longest * along) ** 2 + wide * wide * (1.0 - along**2))
        middle = 0.5 * (a + b)
        low = np.maximum(roadmap.region.low, middle - half)
        high = np.minimum(roadmap.region.high, middle + half)
        return (low, high) if (low < high).all() else None

    def _ends(self) -> tuple[FloatArray, FloatArray] | None:
        """Where paths begin and end, if each is one place: it may have several headings."""
        states = self._roadmap.states
        places = [np.unique(states[k, :3], axis=0) for k in (self._starts, self._goals)]
        if any(len(place) != 1 for place in places):
            return None
        return places[0][0], places[1][0]

    @property
    def _starts(self) -> NDArray[np.intp]:
        return np.array(self._roadmap.starts, np.intp)

    @property
    def _goals(self) -> NDArray[np.intp]:
        return np.array(self._roadmap.goals, np.intp)

    def promising(self, states: FloatArray, d: FloatArray) -> NDArray[np.bool_]:
        """Whether a path through states with clearances d [m] may be better than the best."""
        roadmap, best = self._roadmap, self._roadmap.best
        if best is None:
            return np.ones(len(states), np.bool_)
        risk, duration = self._least(states, d)
        if not roadmap.maximum:
            least = best.risk + roadmap.time_weight * best.duration
            return risk + roadmap.time_weight * duration < least
        return (risk < best.cost) | ((risk <= best.cost) & (duration < best.duration))

    def is_exhausted(self) -> bool:
        """Whether no path can be better than the best, however much the roadmap grows."""
        roadmap = self._roadmap
        if roadmap.best is None:
            return False
        starts = self._starts
        return not self.promising(roadmap.states[starts], roadmap.clearance[starts]).any()

    def _least(self, states: FloatArray, d: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lower bounds for risk and duration of any path through states with clearances d."""
        risks, durations = [], []
        for ends in (self._starts, self._goals):
            both = [self._bounds(states, d, int(end)) for end in self._distinct(ends)]
            risks.append(np.min([risk for risk, _ in both], axis=0))
            durations.append(np.min([duration for _, duration in both], axis=0))
        risk = np.maximum(*risks) if self._roadmap.maximum else risks[0] + risks[1]
        return risk, durations[0] + durations[1]

    def _distinct(self, ends: NDArray[np.intp]) -> NDArray[np.intp]:
        """One for each place: bounds heed nothing else of a vehicle's vertex."""
        if self._roadmap.region.copies == 1:
            return ends
        _, first = np.unique(self._roadmap.states[ends, :3], axis=0, return_index=True)
        return ends[first]

    def _bounds(
        self, states: FloatArray, d: FloatArray, vertex: int
    ) -> tuple[FloatArray, FloatArray]:
        roadmap = self._roadmap
        ends = np.ascontiguousarray(np.broadcast_to(roadmap.states[vertex], states.shape))
        d_end = np.full(len(d), roadmap.clearance[vertex])
        risk = roadmap.motions.heuristics(states, ends, d, d_end)
        return risk, roadmap.motions.least_durations(states, ends)
