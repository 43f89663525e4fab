"""Obstacles on known trajectories: balls, boxes and meshes with their poses over time."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, increasing_times, positive, readonly
from ompl_risk._kernels.moving import Tracks
from ompl_risk.clearance.mesh import MeshClearance
from ompl_risk.clearance.moving.tracks import greatest_speed, packed
from ompl_risk.errors import ArgumentError

if TYPE_CHECKING:
    import trimesh

UNIT_TOLERANCE = 1e-6
"""Largest deviation of a quaternion's norm from 1."""


class MovingObstacle(ABC):
    """A rigid body on a known trajectory.

    ::

        x(t) = p(t) + R(t) y,  p linear and R at constant rate (slerp) between the samples

    Before the first time and after the last it stands still there.

    Args:
        times: when the poses are taken [s], shape (n,), n >= 2, strictly increasing.
        positions: of the body's origin [m], shape (n, 3).
        orientations: unit quaternions (x, y, z, w) from body to world, shape (n, 4); None: level.

    Raises:
        ArgumentError: a wrong shape, a number that is not finite, times that do not increase, or a
            quaternion whose norm is off 1 by more than 1e-6.
    """

    def __init__(
        self, times: ArrayLike, positions: ArrayLike, orientations: ArrayLike | None = None
    ) -> None:
        self.times = increasing_times("times", times)
        n = len(self.times)
        self.positions = readonly("positions", positions, (n, 3), f"({n}, 3): one for each time")
        if orientations is None:
            orientations = np.tile([0.0, 0.0, 0.0, 1.0], (n, 1))
        self.orientations = _unit(readonly("orientations", orientations, (n, 4), f"({n}, 4)"))

    def __reduce__(self) -> tuple[Any, ...]:
        # Unpickled arrays are writable: go through the constructor.
        return type(self), self._arguments

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.times[0]:g} to {self.times[-1]:g} s)"

    @property
    @abstractmethod
    def _arguments(self) -> tuple[Any, ...]:
        """What the constructor takes."""

    @property
    @abstractmethod
    def box(self) -> FloatArray:
        """A box about the body in its own frame, least and greatest corner [m], shape (2, 3)."""

    @property
    @abstractmethod
    def reach(self) -> float:
        """Farthest point of the body from its origin that turning moves [m]."""

    rounding: float = 0.0
    """By how much the box is rounded, beyond its faces [m]."""

    def speed_bound(self, t0: ArrayLike, t1: ArrayLike) -> Any:
        """Greatest speed of any point of the body from t0 to t1 [m/s]; shape as theirs.

        ::

            |p'| + |omega| reach

        Raises:
            ArgumentError: a time that is NaN, or t1 before t0.
        """
        return greatest_speed(self._tracks, t0, t1)

    @cached_property
    def _tracks(self) -> Tracks:
        return packed([self])


class MovingSphere(MovingObstacle):
    """A ball on a known trajectory.

    Args:
        radius: [m], above 0.
        times: see ``MovingObstacle``.
        positions: of its centre [m], shape (n, 3).

    Raises:
        ArgumentError: see ``MovingObstacle``; or a radius out of range.
    """

    def __init__(self, radius: float, times: ArrayLike, positions: ArrayLike) -> None:
        super().__init__(times, positions)
        self.radius = self.rounding = positive("radius", radius)

    @property
    def _arguments(self) -> tuple[Any, ...]:
        return self.radius, self.times, self.positions

    @property
    def box(self) -> FloatArray:
        """Its centre: the rounding makes a ball of it."""
        return np.zeros((2, 3))

    @property
    def reach(self) -> float:
        """0: turning does not move a ball."""
        return 0.0


class MovingBox(MovingObstacle):
    """A box on a known trajectory.

    Args:
        extents: lengths of its edges [m], shape (3,), above 0.
        times: see ``MovingObstacle``.
        positions: of its centre [m], shape (n, 3).
        orientations: see ``MovingObstacle``.

    Raises:
        ArgumentError: see ``MovingObstacle``; or an extent out of range.
    """

    def __init__(
        self,
        extents: ArrayLike,
        times: ArrayLike,
        positions: ArrayLike,
        orientations: ArrayLike | None = None,
    ) -> None:
        super().__init__(times, positions, orientations)
        self.extents = readonly("extents", extents, (3,), "(3,): lengths of the edges [m]")
        if self.extents.min() <= 0.0:
            raise ArgumentError("extents", self.extents.tolist(), "above 0")

    @property
    def _arguments(self) -> tuple[Any, ...]:
        return self.extents, self.times, self.positions, self.orientations

    @property
    def box(self) -> FloatArray:
        """The body itself."""
        return np.array([-0.5, 0.5])[:, None] * self.extents

    @property
    def reach(self) -> float:
        """Half its diagonal [m]."""
        return 0.5 * math.sqrt(float(self.extents @ self.extents))


class MovingMesh(MovingObstacle):
    """A closed mesh on a known trajectory, convex or not; asked through python-fcl.

    Args:
        mesh: about the body's origin [m], closed and wound outwards.
        times: see ``MovingObstacle``.
        positions: of the mesh's origin [m], shape (n, 3).
        orientations: see ``MovingObstacle``.

    Raises:
        ArgumentError: see ``MovingObstacle`` and ``MeshClearance``.
    """

    def __init__(
        self,
        mesh: trimesh.Trimesh,
        times: ArrayLike,
        positions: ArrayLike,
        orientations: ArrayLike | None = None,
    ) -> None:
        super().__init__(times, positions, orientations)
        if isinstance(mesh, list | tuple):
            raise ArgumentError("mesh", type(mesh).__name__, "one trimesh.Trimesh")
        self.mesh = mesh
        try:
            self.body = MeshClearance(mesh)
        except ArgumentError as error:  # there it is one of several
            argument = error.argument.replace("obstacles[0]", "mesh")
            raise ArgumentError(argument, error.value, error.allowed) from None

    @property
    def _arguments(self) -> tuple[Any, ...]:
        return self.mesh, self.times, self.positions, self.orientations

    @property
    def box(self) -> FloatArray:
        """The box along the body's axes about the mesh."""
        return np.asarray(self.mesh.bounds, dtype=np.float64)

    @property
    def reach(self) -> float:
        """Farthest vertex from the origin [m]."""
        return float(np.linalg.norm(self.mesh.vertices, axis=1).max())


def _unit(q: FloatArray) -> FloatArray:
    norms = np.linalg.norm(q, axis=1)
    i = int(np.argmax(np.abs(norms - 1.0)))
    if abs(norms[i] - 1.0) > UNIT_TOLERANCE:
        raise ArgumentError(f"orientations[{i}]", q[i].tolist(), "a unit quaternion (x, y, z, w)")
    return q
