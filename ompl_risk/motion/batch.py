"""What a roadmap asks about thousands of motions at a time, whoever computes it."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray


class MotionBatch(ABC):
    """Answers about many states, and about the motions between them: from a[k] to b[k] for each k.

    States are rows of length ``width``: positions (n, 3) [m], or poses (n, 7) whose last four
    numbers are a quaternion (x, y, z, w) if the clearance uses the orientation. Motions are
    straight unless a ``Steering`` says otherwise.

    Duties of an implementer, for every row:

    1. ``are_free`` may say yes only if d > 0 at every state of the motion: no obstacle is jumped
       over, however thin. It may say no where d falls below 1 mm.
    2. ``costs`` are inf if a state of the motion is in collision, never NaN, and agree with the
       norm of densely sampled f to ``Risk.tolerance``.
    3. ``heuristics`` and ``least_durations`` never exceed the cost and the duration of any way,
       over other states too, at ``Risk.speed`` or less; ``edge_bounds`` never those of the motion.
    4. An answer depends on its own row alone, not on the others nor on their number. No rows are
       answered by none. Rows may be views of any layout; they are not changed, and not kept.
    5. ``symmetric`` is true only if costs and durations from b to a are those from a to b.

    Attributes:
        width: numbers in a state.
        compiled: whether no Python runs for each motion or each distance.
        symmetric: whether every motion can be flown backwards at the same cost.
    """

    width: int
    compiled: bool
    symmetric: bool = True

    @abstractmethod
    def clearances(self, states: FloatArray) -> FloatArray:
        """Clearances d [m] at the states (n, width), shape (n,)."""

    @abstractmethod
    def are_free(self, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
        """Whether every state from a[k] to b[k] is free, shape (n,)."""

    @abstractmethod
    def costs(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Costs of the motions from a[k] to b[k], see ``Risk``; inf in collision, shape (n,)."""

    @abstractmethod
    def durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Durations [s] of the motions from a[k] to b[k], inf where there is none, shape (n,)."""

    @abstractmethod
    def heuristics(
        self, a: FloatArray, b: FloatArray, d_a: FloatArray, d_b: FloatArray
    ) -> FloatArray:
        """Lower bounds for the cost of any way from a[k] to b[k], shape (n,).

        Args:
            a: states, shape (n, width).
            b: likewise.
            d_a: clearances [m] at a, shape (n,).
            d_b: likewise at b.
        """

    def least_durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Lower bounds for the duration [s] of any way from a[k] to b[k], shape (n,)."""
        return self.durations(a, b)

    def edge_bounds(
        self, a: FloatArray, b: FloatArray, d_a: FloatArray, d_b: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Lower bounds for the cost and the duration of the motions from a[k] to b[k].

        Unlike ``heuristics`` and ``least_durations`` they are about these motions, not about any
        way: a batch that can tell at little cost that there is no motion says inf.

        Args:
            a: states, shape (n, width).
            b: likewise.
            d_a: clearances [m] at a, shape (n,).
            d_b: likewise at b.

        Returns:
            Costs, and durations [s], shapes (n,).
        """
        return self.heuristics(a, b, d_a, d_b), self.least_durations(a, b)

    def extents(self, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Corners of boxes [m] that hold the motions from a[k] to b[k], shapes (n, 3)."""
        return np.minimum(a[:, :3], b[:, :3]), np.maximum(a[:, :3], b[:, :3])

    def samples(self, a: FloatArray, b: FloatArray) -> list[FloatArray]:
        """States that the motions pass at equal time steps, moving straight in between.

        Returns:
            For each motion an array (m, width) from a[k] to b[k] inclusive; m = 0 where there is
            none.
        """
        return list(np.stack([a, b], axis=1))
