"""When places and flights between them are free, found as a search asks for them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.motion import CONTACT
from ompl_risk.motion import MotionBatch, Risk, motion_batch
from ompl_risk.motion.moving import MovingObstacles
from ompl_risk.planners.spacetime.network import Integers, Network

NEAR = 1e-4
"""How exactly the place is looked for where a flight comes nearest to the obstacles [m]."""

CREEP = 0.01
"""Where a flight can neither be shown free nor blocked, as when it grazes an obstacle, its
departure is put off by this share of what it has been put off before."""

AHEAD = 1.0
"""How far ahead it is looked when a place becomes free, at least [s]."""

INSTANT = 1e-6
"""Least duration of a flight between different places [s]: clocks tell no shorter ones apart."""

CHUNK = 256
"""Places whose free spans are found in one go."""

Flags = NDArray[np.bool_]


class Departures:
    """Free spans of places, and departures at which flights are free.

    A flight along an edge is free if d(q, t) > 0 throughout, which the clearance certifies. If it
    is not, it passes some place in an obstacle, or within the millimetre of one that certificates
    leave. One that departs later passes there later by as much, so all departures are ruled out
    until that place is free. No free departure is passed over by this, except within
    ``resolution``, and no obstacle is either, however thin or quick: only what is certified is
    flown.

    Args:
        network: places and edges.
        clearance: d(q, t).
        speed: along edges [m/s].
        t0: from when on spans are of interest [s].
        t1: until when [s].
        resolution: least step between two departures that are looked at [s].
    """

    def __init__(
        self,
        network: Network,
        clearance: MovingObstacles,
        *,
        speed: float,
        t0: float,
        t1: float,
        resolution: float,
    ) -> None:
        self._network, self._clearance = network, clearance
        self._speed, self._t0, self._t1, self._resolution = speed, t0, t1, resolution
        takes = np.maximum(network.length / speed, INSTANT)
        self.duration: FloatArray = np.where(network.length > 0.0, takes, 0.0)
        self._spans: list[FloatArray | None] = [None] * network.n
        self._static = static_motions(clearance)
        self._may: NDArray[np.int8] = np.full(len(network.target), -1, np.int8)
        self.evaluated = 0

    def spans(self, place: int) -> FloatArray:
        """Spans of time in which a place is free [s], shape (k, 2), increasing."""
        found = self._spans[place]
        if found is None:
            self.prepare([place])
            found = self._spans[place]
        return np.empty((0, 2)) if found is None else found

    def is_free(self, place: int, time: float) -> bool:
        """Whether a place is free at a time [s]."""
        spans = self.spans(place)
        return bool(((spans[:, 0] <= time) & (time <= spans[:, 1])).any())

    def prepare(self, places: Sequence[int]) -> None:
        """Find the free spans of several places in one go."""
        new = sorted({place for place in places if self._spans[place] is None})
        for k in range(0, len(new), CHUNK):
            part = new[k : k + CHUNK]
            at = self._network.places[part]
            found = self._clearance.free_intervals(
                at, self._t0, self._t1, resolution=self._resolution
            )
            for place, spans in zip(part, found, strict=True):
                self._spans[place] = np.asarray(spans, dtype=np.float64).reshape(-1, 2)

    def may_be_flown(self, edges: Integers) -> Flags:
        """Which edges are free of what does not move, shape (k,)."""
        new = np.unique(edges[self._may[edges] < 0])
        if len(new):
            a, b = self._ends(new)
            free = np.ones(len(new), np.bool_) if self._static is None else self._static(a, b)
            self._may[new] = free
        return self._may[edges] > 0

    def are_free(self, edges: Integers, leave: FloatArray, arrive: FloatArray) -> Flags:
        """Which flights are free throughout, shape (k,)."""
        self.evaluated += len(edges)
        a, b = self._ends(edges)
        return np.asarray(self._clearance.are_free(a, leave, b, arrive), dtype=np.bool_)

    def later(self, edges: Integers, leave: FloatArray, put_off: FloatArray) -> FloatArray:
        """The next departures to look at, of flights that are not free [s], shape (k,).

        Args:
            edges: shape (k,).
            leave: departures that are not free [s], shape (k,).
            put_off: how much they have been put off before [s], shape (k,).
        """
        a, b = self._ends(edges)
        duration = self.duration[edges]
        d, passed = self._clearance.approach(a, leave, b, leave + duration, tolerance=NEAR)
        share = np.clip((passed - leave) / np.maximum(duration, INSTANT), 0.0, 1.0)
        points = a + share[:, None] * (b - a)
        ahead = float(passed.max() + max(AHEAD, put_off.max()))
        free = self._when_free(points, passed, min(ahead, self._t1 + float(duration.max())))
        creep = np.where(d > CONTACT, CREEP * put_off, 0.0)
        return leave + np.maximum(free - passed, np.maximum(self._resolution, creep))

    def _when_free(self, points: FloatArray, times: FloatArray, until: float) -> FloatArray:
        """When each point is free, at its time or later; ``until`` if not before that."""
        t0 = float(times.min())
        spans = self._clearance.free_intervals(
            points, t0, max(until, t0 + self._resolution), resolution=self._resolution
        )
        return np.array(
            [
                next((max(begin, time) for begin, end in mine if end >= time), until)
                for mine, time in zip(spans, times.tolist(), strict=True)
            ]
        )

    def _ends(self, edges: Integers) -> tuple[FloatArray, FloatArray]:
        network = self._network
        return network.places[network.source[edges]], network.places[network.target[edges]]


def static_motions(clearance: Any) -> Any:
    """Tells which straight motions are free of what does not move; None if nothing stands still."""
    static = getattr(clearance, "static", None)
    if static is None:
        return None
    batch: MotionBatch = motion_batch(static, Risk(speed=1.0))
    return batch.are_free
