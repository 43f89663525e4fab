"""What stands still among obstacles that move."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import motions as terrain_motions
from ompl_risk._kernels.motion import CONTACT
from ompl_risk._kernels.shares import PARAMETERS, RADIUS
from ompl_risk.clearance.moving.search import TimedMotions, lower_least
from ompl_risk.clearance.moving.travel import Travel
from ompl_risk.clearance.terrain import TerrainClearance
from ompl_risk.clearance.threads import in_chunks
from ompl_risk.clearance.union import UnionClearance
from ompl_risk.errors import ArgumentError


class StaticPart:
    """A clearance of points, for the motions of a sphere that it was made for.

    Args:
        clearance: callable with points (n, 3); it stands still and needs no orientation.

    Raises:
        ArgumentError: anything else.
    """

    def __init__(self, clearance: Any) -> None:
        if not callable(clearance):
            raise ArgumentError("static", clearance, "a clearance, callable with points (n, 3)")
        if getattr(clearance, "uses_orientation", False):
            raise ArgumentError("static", clearance, "one that does not use the orientation")
        if moves(clearance):
            raise ArgumentError("static", clearance, "one of obstacles that stand still")
        self.clearance: Any = clearance
        self._compiled = type(clearance) is TerrainClearance

    def distances(self, points: FloatArray) -> FloatArray:
        """Distances [m] of points (n, 3), shape (n,).

        Raises:
            ArgumentError: the clearance returns another shape or NaN.
        """
        d = np.asarray(self.clearance(points), dtype=np.float64)
        if d.shape != (len(points),) or np.isnan(d).any():
            allowed = f"distances without NaN of shape ({len(points)},)"
            raise ArgumentError("static(points)", d, allowed)
        return d

    def keep_free(self, motions: TimedMotions, free: NDArray[np.bool_], threads: int) -> None:
        """Make ``free`` false for motions that are not certainly free."""
        chosen = np.flatnonzero(free)
        if not self._compiled:
            start = np.nextafter(CONTACT, np.inf)
            least, when = np.full(len(free), start), motions.ta.copy()
            self._lower(motions, chosen, least, when, tolerance=0.5 * CONTACT, floor=CONTACT)
            free[chosen] = least[chosen] > CONTACT
            return
        given, found = np.zeros(PARAMETERS), np.empty(len(chosen), np.bool_)
        given[RADIUS] = self.clearance.radius
        a, b, handle = motions.a[chosen], motions.b[chosen], self.clearance.handle

        def work(i: int, j: int) -> None:
            terrain_motions.are_motions_free(handle, a[i:j], b[i:j], given, found[i:j])

        in_chunks(work, len(chosen), threads, least=256)
        free[chosen] = found

    def lower(
        self, motions: TimedMotions, least: FloatArray, when: FloatArray, tolerance: float
    ) -> None:
        """Lower ``least`` to the least distances on motions; see ``lower_least``."""
        self._lower(motions, np.arange(len(least)), least, when, tolerance=tolerance)

    def _lower(
        self,
        motions: TimedMotions,
        chosen: NDArray[np.intp],
        least: FloatArray,
        when: FloatArray,
        **how: float,
    ) -> None:
        def distance(points: FloatArray, _: FloatArray) -> FloatArray:
            return self.distances(points)

        lower_least(motions, chosen, distance, straight, least, when, **how)


def straight(motions: TimedMotions) -> Travel:
    """Motions as something sees them that stands still."""
    lengths = np.linalg.norm(motions.b - motions.a, axis=1)
    return Travel(lengths, lengths, np.zeros(len(lengths)))


def moves(clearance: Any) -> bool:
    """Whether a clearance needs the time; unions take none that does."""
    return bool(getattr(clearance, "moves", False))


def radii(clearance: Any) -> set[float]:
    """Radii of the spheres that a clearance is known to be made for [m]."""
    if isinstance(clearance, UnionClearance):
        return set().union(*(radii(member) for member in clearance.members))
    radius = getattr(clearance, "radius", None)
    return set() if radius is None else {float(radius)}


def resized(clearance: Any, old: float, new: float) -> Any:
    """The same obstacles for a sphere of another radius [m]."""
    if clearance is None or old == new:
        return clearance
    if isinstance(clearance, TerrainClearance):
        return clearance.with_radius(new)
    if isinstance(clearance, UnionClearance):
        return UnionClearance([resized(member, old, new) for member in clearance.members])
    return Resized(clearance, old, new)


class Resized:
    """``clearance`` of a sphere of radius ``old`` [m], for one of radius ``radius`` [m]."""

    def __init__(self, clearance: Any, old: float, new: float) -> None:
        self._clearance, self._old, self.radius = clearance, old, new

    def __call__(self, points: FloatArray) -> FloatArray:
        """Distances [m], shape (n,)."""
        return np.asarray(self._clearance(points), dtype=np.float64) + (self._old - self.radius)
