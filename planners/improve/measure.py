"""What is said of a path before and after it was improved."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ompl_risk._arrays import FloatArray, ReadOnlyArrays


@dataclass(frozen=True)
class Measure:
    """Figures of a path flown at constant speed, computed from the path itself.

    Args:
        label: name of the norm.
        norm: the norm of f along the path; inf in collision.
        duration: [s].
        length: [m].
        clearance: least distance to obstacles d [m], to a ten-thousandth or a centimetre, at most
            10 km; 0 in collision.
        vertices: corners of the path, start and goal included.
    """

    label: str
    norm: float
    duration: float
    length: float
    clearance: float
    vertices: int


class Outcome(str, Enum):
    """Whether a path was improved."""

    IMPROVED = "improved"
    UNCHANGED = "unchanged"  # the positions are the given ones


@dataclass(frozen=True, eq=False)
class Improvement(ReadOnlyArrays):
    """A path, improved or as it was.

    Args:
        outcome: whether anything changed.
        positions: corners of the path [m], shape (n, 3), read-only.
        before: figures of the given path.
        after: figures of `positions`.
        reason: in words, why it is unchanged or what limited it; empty if there is nothing to say.
        seconds: computing time [s].
        compiled: False if Python ran for every batch of distances, which is slower.
    """

    outcome: Outcome
    positions: FloatArray
    before: Measure
    after: Measure
    reason: str = ""
    seconds: float = 0.0
    compiled: bool = True

    @property
    def improved(self) -> bool:
        """Whether the path is another, better one."""
        return self.outcome is Outcome.IMPROVED

    @property
    def gain(self) -> float:
        """Share of the norm that was saved, 0 to 1."""
        change = self.before.norm - self.after.norm
        return change / self.before.norm if change > 0.0 else 0.0

    def __str__(self) -> str:
        """Such as "H1 0.0123 -> 0.0098 (-20.3 %), 512.3 s -> 511.9 s, 48 -> 31 vertices"."""
        old, new = self.before, self.after
        notes = "; ".join(filter(None, [self.reason, "" if self.compiled else "not compiled"]))
        if not self.improved:
            same = f"{old.label} {old.norm:.3g}, {old.duration:.1f} s"
            return f"{same}: unchanged, {notes}" if notes else f"{same}: unchanged"
        text = (
            f"{old.label} {old.norm:.3g} -> {new.norm:.3g} ({0.0 - 100.0 * self.gain:.1f} %), "
            f"{old.duration:.1f} s -> {new.duration:.1f} s, "
            f"{old.vertices} -> {new.vertices} vertices"
        )
        return f"{text} ({notes})" if notes else text
