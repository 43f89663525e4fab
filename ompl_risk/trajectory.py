"""A timed trajectory: where the vehicle is, and when."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, increasing_times, positive, readonly
from ompl_risk._interpolation import great_arc, held_or_linear, linear, subdivided
from ompl_risk.errors import ArgumentError

UNIT_TOLERANCE = 1e-6
"""Largest deviation of a quaternion's norm from 1."""

PathReader = Callable[[Any, "float | None", str], "Trajectory"]
_path_reader: PathReader | None = None


def register_path_reader(reader: PathReader) -> None:
    """Set what turns a planner's path into a trajectory; the OMPL bridge calls this on import.

    Args:
        reader: reader(path, speed, name) -> Trajectory.
    """
    global _path_reader  # noqa: PLW0603 - the one registration point: this layer knows no planner
    _path_reader = reader


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Trajectory(ReadOnlyArrays):
    """Positions of a vehicle at times, straight and at constant velocity between the samples.

    The arrays are read-only copies in the world frame: metres, east-north-up.

    Args:
        t: times [s], shape (n,), n >= 2, strictly increasing.
        positions: positions [m], shape (n, 3).
        name: what tables and figures call it.
        orientations: unit quaternions (x, y, z, w) of the body in the world, shape (n, 4); between
            samples the body turns at constant rate.
        velocities: velocities [m/s], shape (n, 3).
        controls: control inputs, shape (n, m) (samples) or (n - 1, m) (held over each interval).

    Raises:
        ArgumentError: a wrong shape, a number that is not finite, times that do not increase, or a
            quaternion whose norm is off 1 by more than 1e-6.

    Example:
        >>> Trajectory([0, 10], [[0, 0, 50], [300, 0, 50]], name="A").length
        300.0
    """

    t: FloatArray
    positions: FloatArray
    name: str
    orientations: FloatArray | None
    velocities: FloatArray | None
    controls: FloatArray | None

    def __init__(
        self,
        t: ArrayLike,
        positions: ArrayLike,
        name: str = "",
        *,
        orientations: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        controls: ArrayLike | None = None,
    ) -> None:
        t = increasing_times("t", t)
        n = len(t)
        positions = readonly("positions", positions, (n, 3), f"({n}, 3): x, y, z at the {n} times")
        if velocities is not None:
            velocities = readonly("velocities", velocities, (n, 3), f"({n}, 3)")
        fields = {
            "t": t,
            "positions": positions,
            "name": str(name),
            "orientations": None if orientations is None else _unit_quaternions(orientations, n),
            "velocities": velocities,
            "controls": None if controls is None else _controls(controls, n),
        }
        for field, value in fields.items():
            object.__setattr__(self, field, value)

    def __repr__(self) -> str:
        return (
            f"Trajectory({self.name!r}, {len(self)} samples, "
            f"{self.duration:.6g} s, {self.length:.6g} m)"
        )

    def __len__(self) -> int:
        return len(self.t)

    @cached_property
    def duration(self) -> float:
        """Time from the first sample to the last [s]."""
        return float(self.t[-1] - self.t[0])

    @cached_property
    def steps(self) -> FloatArray:
        """Lengths of the straight pieces [m], shape (n - 1,)."""
        steps = np.linalg.norm(np.diff(self.positions, axis=0), axis=1)
        steps.setflags(write=False)
        return steps

    @cached_property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.steps.sum())

    @cached_property
    def poses(self) -> FloatArray:
        """x, y, z [m], qx, qy, qz, qw, shape (n, 7); upright where no orientations are known."""
        poses = np.zeros((len(self), 7))
        poses[:, :3] = self.positions
        poses[:, 3:] = (0, 0, 0, 1) if self.orientations is None else self.orientations
        poses.setflags(write=False)
        return poses

    def resample(self, times: ArrayLike | None = None, *, step: float | None = None) -> Trajectory:
        """The same motion at other times; give exactly one of the two arguments.

        Positions, velocities and sampled controls are interpolated linearly, orientations along
        the great arc; a control held over intervals is the one in force at the new time.

        Args:
            times: new times [s], strictly increasing, within the trajectory's.
            step: largest time step [s]; the ends stay, the steps are equal.

        Raises:
            ArgumentError: none or both given, or times outside the trajectory.
        """
        if times is not None and step is None:
            new = increasing_times("times", times)
        elif times is None and step is not None:
            count = int(np.ceil(self.duration / positive("step", step) * (1 - 1e-12)))
            new = np.linspace(self.t[0], self.t[-1], max(count, 1) + 1)
        else:
            raise ArgumentError("(times, step)", (times, step), "exactly one of the two")
        if new[0] < self.t[0] or new[-1] > self.t[-1]:
            raise ArgumentError(
                "times",
                f"{new[0]!s} to {new[-1]!s} s",
                f"within the trajectory's {self.t[0]!s} to {self.t[-1]!s} s",
            )
        return self._at(new)

    def densify(self, max_step: float) -> Trajectory:
        """The same motion with samples inserted, so that no step is longer than `max_step` [m].

        All samples of this trajectory are kept; each piece is divided into equal parts. Steps may
        be longer by what rounding makes of equal parts, so that doing it again changes nothing.

        Raises:
            ArgumentError: max_step is not a positive finite number.
        """
        fastest = (self.steps / np.diff(self.t)).max()
        rounding = 8.0 * np.spacing(np.abs(self.positions).max())
        rounding += np.spacing(np.abs(self.t).max()) * fastest
        parts = np.ceil((self.steps - rounding) / positive("max_step", max_step) * (1 - 1e-12))
        return self.subdivide(np.maximum(parts, 1).astype(np.int64))

    def subdivide(self, parts: ArrayLike) -> Trajectory:
        """The same motion with interval i divided into parts[i] >= 1 equal ones.

        Sample i becomes sample sum(parts[:i]).
        """
        parts = np.asarray(parts, dtype=np.int64)
        if parts.shape != (len(self) - 1,) or (parts < 1).any():
            raise ArgumentError("parts", parts, f"{len(self) - 1} whole numbers >= 1")
        if (parts == 1).all():
            return self
        return self._at(increasing_times("times", subdivided(self.t, parts)))

    def _at(self, times: FloatArray) -> Trajectory:
        q, v, u = self.orientations, self.velocities, self.controls
        return Trajectory(
            times,
            linear(times, self.t, self.positions),
            self.name,
            orientations=None if q is None else great_arc(times, self.t, q),
            velocities=None if v is None else linear(times, self.t, v),
            controls=None if u is None else held_or_linear(times, self.t, u),
        )

    @classmethod
    def at_constant_speed(cls, positions: ArrayLike, speed: float, name: str = "") -> Trajectory:
        """A path flown at constant speed from t = 0; repeated positions are dropped.

        Args:
            positions: corners of the path [m], shape (n, 3), at least two of them different.
            speed: speed [m/s], positive.
            name: what tables and figures call it.

        Raises:
            ArgumentError: a wrong shape, a path without length, or a speed that is not positive.
        """
        positions = readonly("positions", positions, (None, 3), "(n, 3)")
        steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
        t = np.concatenate([[0.0], np.cumsum(steps)]) / positive("speed", speed)
        moved = np.concatenate([[True], np.diff(t) > 0])
        if moved.sum() < 2:
            raise ArgumentError(
                "length of positions", 0.0, "positive: at least two different points"
            )
        return cls(t[moved], positions[moved], name)

    @classmethod
    def from_path(cls, path: Any, *, speed: float | None = None, name: str = "") -> Trajectory:
        """The trajectory of an OMPL path.

        Args:
            path: PathGeometric, flown at constant `speed`, or PathControl, which has its own time.
            speed: speed [m/s] for a PathGeometric.
            name: what tables and figures call it.

        Raises:
            ArgumentError: no reader for such paths is loaded, or the reader refuses the path.
        """
        if _path_reader is None:
            raise ArgumentError(
                "path",
                type(path).__name__,
                "read by the OMPL bridge, which is not loaded: import ompl_risk.bridge first",
            )
        return _path_reader(path, speed, name)


def _unit_quaternions(value: ArrayLike, n: int) -> FloatArray:
    q = readonly("orientations", value, (n, 4), f"({n}, 4): unit quaternions x, y, z, w")
    norms = np.linalg.norm(q, axis=1)
    i = int(np.argmax(np.abs(norms - 1)))
    if abs(norms[i] - 1) > UNIT_TOLERANCE:
        raise ArgumentError(
            f"orientations[{i}]", q[i].tolist(), f"a unit quaternion; its norm is {norms[i]:.9g}"
        )
    return q


def _controls(value: ArrayLike, n: int) -> FloatArray:
    controls = readonly("controls", value, (None, None), f"({n}, m) or ({n - 1}, m)")
    if len(controls) not in (n, n - 1) or controls.shape[1] == 0:
        raise ArgumentError("controls.shape", controls.shape, f"({n}, m) or ({n - 1}, m), m >= 1")
    return controls
