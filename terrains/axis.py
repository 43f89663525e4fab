"""The positions of posts along one axis, and which of them cover an interval."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ompl_risk.errors import ArgumentError

_SLACK = 1e-6
"""Part of a spacing by which a bound may miss a post and still mean it: decimal degrees round."""


@dataclass(frozen=True)
class Axis:
    """Posts at start + step k, k = 0 .. count - 1, with step > 0: eastwards or northwards.

    Attributes:
        start: position of the first post, in the units of the CRS.
        step: distance of neighbours, > 0.
        count: number of posts.
        flipped: whether the file stores the posts the other way round.
    """

    start: float
    step: float
    count: int
    flipped: bool = False

    @classmethod
    def from_pixels(cls, edge: float, step: float, count: int) -> Axis:
        """Posts at the centres of `count` pixels of signed width `step` that begin at `edge`."""
        first, last = edge + 0.5 * step, edge + (count - 0.5) * step
        return cls(min(first, last), abs(step), count, flipped=step < 0)

    @property
    def stop(self) -> float:
        """Position of the last post."""
        return self.start + (self.count - 1) * self.step

    def part(self, chosen: slice) -> Axis:
        """Return the axis of the posts in `chosen`, in the same direction."""
        start = self.start + chosen.start * self.step
        return Axis(start, self.step, chosen.stop - chosen.start, self.flipped)

    def covering(self, low: float, high: float, margin: float, argument: str) -> slice:
        """Return the fewest posts, at least two where there are, whose span contains [low, high].

        Args:
            low: lower bound, in the units of the axis.
            high: upper bound.
            margin: how far the bounds may lie outside the outermost posts, in steps; the span
                then ends at the outermost post.
            argument: name of the bounds in an error.

        Raises:
            ArgumentError: the interval leaves the axis.
        """
        first, last = (low - self.start) / self.step, (high - self.start) / self.step
        if first < -margin - _SLACK or last > self.count - 1 + margin + _SLACK:
            width = margin * self.step
            lowest, highest = self.start - width, self.stop + width
            raise ArgumentError(argument, (low, high), f"within {lowest:.9g} to {highest:.9g}")
        begin = min(max(math.floor(first + _SLACK), 0), self.count - 1)
        end = max(min(math.ceil(last - _SLACK), self.count - 1), begin)
        if begin == end:  # bounds beyond the outermost post, or nearer to a post than the slack
            begin, end = (begin - 1, end) if begin == self.count - 1 else (begin, end + 1)
        return slice(max(begin, 0), min(end, self.count - 1) + 1)
