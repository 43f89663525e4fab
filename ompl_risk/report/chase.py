"""A camera that follows a vehicle, smoothly and never below the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ompl_risk._arrays import FloatArray
from ompl_risk.report.attitudes import attitudes, headings, velocities
from ompl_risk.report.camera import Camera, ground_below
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

NEAREST = 45.0
"""Least distance of the camera from the vehicle [m]."""
FRAMES_BEHIND = 4.5
"""The camera is as far behind as the vehicle comes in so many frames."""
ELEVATIONS = tuple(math.radians(degrees) for degrees in (17, 23, 30, 38, 47, 57, 68))
"""Heights of the camera above the vehicle, as angles, the lowest that is free is taken."""
ASIDE = math.radians(28.0)
"""The camera is so far to the right of straight behind."""
ABOVE_GROUND = 0.15
"""Least height of the camera above the ground, as a part of its distance from the vehicle."""


@dataclass(frozen=True, eq=False)
class Chase:
    """A flight at the times of frames, and the camera behind it.

    Args:
        flight: the vehicle at the frames' times, with orientations and velocities.
        terrain: the ground.
    """

    flight: Trajectory
    terrain: Terrain

    @classmethod
    def along(cls, trajectory: Trajectory, terrain: Terrain, times: FloatArray) -> Chase:
        """Follow a trajectory at the times of frames [s]."""
        whole = Trajectory(
            trajectory.t,
            trajectory.positions,
            trajectory.name,
            orientations=attitudes(trajectory),
            velocities=velocities(trajectory),
        )
        return cls(whole.resample(times), terrain)

    @cached_property
    def distance(self) -> float:
        """Of the camera from the vehicle [m], the same all the time."""
        return max(NEAREST, FRAMES_BEHIND * float(np.median(self.flight.steps)))

    @cached_property
    def directions(self) -> FloatArray:
        """Directions in which the camera looks over ground [rad], shape (n,)."""
        positions, n = self.flight.positions, len(self.flight)
        near = np.arange(n)
        ways = positions[np.minimum(near + 4, n - 1)] - positions[np.maximum(near - 4, 0)]
        found = headings(ways, start=_nose(self.flight.poses[0, 3:]))
        return gaussian_filter1d(found, 3.0, mode="nearest")

    @cached_property
    def elevations(self) -> FloatArray:
        """Heights of the camera above the vehicle [rad], shape (n,)."""
        least = np.full(len(self.flight), ELEVATIONS[-1])
        for angle in ELEVATIONS[::-1]:
            cameras = self._positions(np.full(len(self.flight), angle))
            high = cameras[:, 2] - ground_below(self.terrain, cameras)
            free = high >= ABOVE_GROUND * self.distance
            for i in np.flatnonzero(free):
                vehicle = self.flight.positions[i : i + 1]
                free[i] = Camera(cameras[i], vehicle[0]).sees(vehicle, self.terrain)[0]
            least[free] = angle
        wide = maximum_filter1d(least, 7, mode="nearest")
        return gaussian_filter1d(wide, 2.5, mode="nearest")

    @cached_property
    def cameras(self) -> tuple[Camera, ...]:
        """One for each frame; it looks a little ahead of the vehicle."""
        positions = self._positions(self.elevations)
        floor = ground_below(self.terrain, positions) + 0.5 * ABOVE_GROUND * self.distance
        positions[:, 2] = np.maximum(positions[:, 2], floor)
        targets = self.flight.positions + 0.5 * self.distance * self._ahead
        return tuple(Camera(a, b) for a, b in zip(positions, targets, strict=True))

    def _positions(self, elevations: FloatArray) -> FloatArray:
        a = self.directions - ASIDE
        away = np.stack([-np.cos(a), -np.sin(a), np.tan(elevations)], axis=1)
        away *= np.cos(elevations)[:, None]
        return self.flight.positions + self.distance * away

    @cached_property
    def _ahead(self) -> FloatArray:
        a = self.directions
        return np.stack([np.cos(a), np.sin(a), np.zeros_like(a)], axis=1)


def _nose(orientation: FloatArray) -> float:
    """Direction over ground of the forward axis [rad]."""
    x, y, z, w = orientation
    return math.atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))
