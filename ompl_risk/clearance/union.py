"""The nearest of several obstacles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk.clearance.base import Clearance, as_queries
from ompl_risk.errors import ArgumentError


class UnionClearance(Clearance):
    """Minimum over several clearances.

    ::

        d(q) = min_k d_k(q)

    Members that use the orientation and members that do not may be mixed: if any does, queries
    are poses (n, 7) and the others get their positions.

    Args:
        members: clearances, or any callables from points (n, 3) to distances (n,).

    Raises:
        ArgumentError: no member, or one that cannot be called.
    """

    def __init__(self, members: Sequence[Any]) -> None:
        if not isinstance(members, Sequence):
            raise ArgumentError("members", members, "a list of clearances")
        self.members = tuple(members)
        if not self.members:
            raise ArgumentError("members", list(self.members), "at least one clearance")
        for k, member in enumerate(self.members):
            if not callable(member):
                raise ArgumentError(f"members[{k}]", member, "callable with points (n, 3)")
            if getattr(member, "moves", False):
                allowed = "one that stands still: MovingClearance(..., static=...) takes the others"
                raise ArgumentError(f"members[{k}]", member, allowed)
        self.uses_orientation = any(_is_posed(member) for member in self.members)
        self.reach = max(float(getattr(member, "reach", 0.0)) for member in self.members)

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """Distances d [m], shape (n,); see ``which`` for the members that they belong to."""
        return self._all(points).min(axis=0)

    def which(self, points: ArrayLike) -> NDArray[np.intp]:
        """Index of the member that is nearest, shape (n,); the first of equals."""
        return self._all(points).argmin(axis=0)

    def of_point(self) -> UnionClearance:
        """The same obstacles for a body that is a single point; plain callables stay."""
        return UnionClearance([m.of_point() if hasattr(m, "of_point") else m for m in self.members])

    def _all(self, points: ArrayLike) -> NDArray[np.float64]:
        """Distances of every member, shape (members, n)."""
        queries = as_queries(points, 7 if self.uses_orientation else 3)
        positions = np.ascontiguousarray(queries[:, :3])
        rows = [
            np.asarray(m(queries if _is_posed(m) else positions), dtype=np.float64)
            for m in self.members
        ]
        for k, row in enumerate(rows):
            if row.shape != (len(queries),):
                raise ArgumentError(f"members[{k}](points).shape", row.shape, f"({len(queries)},)")
        return np.array(rows)


def _is_posed(member: Any) -> bool:
    return bool(getattr(member, "uses_orientation", False))
