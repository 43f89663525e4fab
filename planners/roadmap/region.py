"""Where states are sampled, and how far apart they are."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from ompl_risk._arrays import FloatArray, readonly
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.kinodynamic import KinodynamicSteering

CHUNK = 4096
"""Sobol points are drawn so many at a time: a power of two keeps them balanced."""


class Region:
    """A box of positions, and all orientations if states have one.

    Points come from a scrambled Sobol sequence: with the same seed always the same ones, and more
    evenly spread than random ones.

    Args:
        low: least coordinates [m], shape (3,).
        high: greatest coordinates [m], shape (3,).
        posed: whether states are poses, position and quaternion (x, y, z, w).
        reach: what turning by a radian counts in distances [m]; for poses.
        seed: of the sequence.

    Raises:
        ArgumentError: an empty box or a number out of range.
    """

    def __init__(
        self,
        low: ArrayLike,
        high: ArrayLike,
        *,
        posed: bool = False,
        reach: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.low = readonly("low", low, (3,), "(3,)")
        self.high = readonly("high", high, (3,), "(3,)")
        if not (self.low < self.high).all():
            raise ArgumentError("high", self.high.tolist(), f"above low = {self.low.tolist()}")
        self.posed, self.reach = posed, reach
        from scipy.stats import qmc  # a third of a second, and not everybody plans

        self._sequence = qmc.Sobol(self.dimensions, rng=np.random.default_rng(seed))
        self._left = np.empty((0, self.dimensions))

    @property
    def width(self) -> int:
        """Numbers in a state."""
        return 7 if self.posed else 3

    @property
    def dimensions(self) -> int:
        """Degrees of freedom of a state."""
        return 6 if self.posed else 3

    @property
    def copies(self) -> int:
        """States that are made from a point of the sequence."""
        return 1

    @property
    def thins(self) -> bool:
        """Whether roadmaps are thinned out as they grow: where it costs little to connect anew."""
        return True

    def sample(self, n: int, *, within: tuple[FloatArray, FloatArray] | None = None) -> FloatArray:
        """The states of the next n points of the sequence, shape (n * copies, width).

        Args:
            n: how many.
            within: least and greatest coordinates of a smaller box, in place of the region's.
        """
        low, high = (self.low, self.high) if within is None else within
        unit = self._next(n)
        positions = low + unit[:, :3] * (high - low)
        return np.hstack([positions, _rotations(unit[:, 3:])]) if self.posed else positions

    def places(self, states: FloatArray) -> FloatArray:
        """Points whose Euclidean distances are about those of the states, shape (n, 3 or 7)."""
        if not self.posed:
            return states
        # Half of the angle between two orientations is the angle between their quaternions.
        return np.hstack([states[:, :3], 2.0 * self.reach * states[:, 3:]])

    def _next(self, n: int) -> FloatArray:
        while len(self._left) < n:
            self._left = np.vstack([self._left, self._sequence.random(CHUNK)])
        given, self._left = self._left[:n], self._left[n:]
        return given


class VertexRegion(Region):
    """A box of positions with the vertices that a steering makes there, several at each.

    Args:
        low: least coordinates [m], shape (3,).
        high: greatest coordinates [m], shape (3,).
        steering: says what a vertex is.
        seed: of the sequence.

    Raises:
        ArgumentError: an empty box.
    """

    def __init__(
        self, low: ArrayLike, high: ArrayLike, steering: KinodynamicSteering, *, seed: int = 0
    ) -> None:
        self._steering = steering
        super().__init__(low, high, seed=seed)
        self._copies = len(steering.vertices(np.zeros((1, self.dimensions)), self.low, self.high))

    @property
    def width(self) -> int:
        """Numbers in a vertex."""
        return self._steering.width

    @property
    def dimensions(self) -> int:
        """Uniform numbers that vertices are made from."""
        return self._steering.dimensions

    @property
    def copies(self) -> int:
        """Vertices that are made from a point of the sequence: one for each trim."""
        return self._copies

    @property
    def thins(self) -> bool:
        """No: to bound a connection again costs more than to keep it."""
        return False

    def sample(self, n: int, *, within: tuple[FloatArray, FloatArray] | None = None) -> FloatArray:
        """The vertices of the next n points of the sequence, shape (n * copies, width)."""
        low, high = (self.low, self.high) if within is None else within
        return self._steering.vertices(self._next(n), low, high)

    def places(self, states: FloatArray) -> FloatArray:
        """Points whose Euclidean distances say how near vertices are, see the steering."""
        return self._steering.places(states)


def _rotations(unit: FloatArray) -> FloatArray:
    """Uniform quaternions (x, y, z, w) from three uniform numbers (Shoemake, 1992)."""
    u, a, b = unit[:, 0], 2.0 * math.pi * unit[:, 1], 2.0 * math.pi * unit[:, 2]
    s, c = np.sqrt(1.0 - u), np.sqrt(u)
    return Rotation.from_quat(
        np.column_stack([s * np.sin(a), s * np.cos(a), c * np.sin(b), c * np.cos(b)])
    ).as_quat()
