"""How a vehicle gets from one state to another: the edges of a roadmap."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.lines import travelled


@dataclass(frozen=True, eq=False, init=False)
class Connection(ReadOnlyArrays):
    """A way from one state to another, or that there is none.

    Between neighbouring samples, which are duration / (k - 1) apart in time, the vehicle moves
    straight at constant speed, and turns at a constant rate.

    Args:
        duration: of the whole [s], 0 or more.
        samples: states from the first to the last inclusive, at equal time steps, k >= 2,
            shape (k, width).

    Raises:
        ArgumentError: a duration or samples out of range.

    Example:
        >>> Connection(2.0, [[0.0, 0.0, 50.0], [30.0, 0.0, 50.0], [30.0, 30.0, 50.0]]).exists
        True
        >>> Connection.none().exists
        False
    """

    duration: float
    samples: FloatArray

    def __init__(self, duration: float, samples: ArrayLike) -> None:
        allowed = "a finite number of 0 or more; Connection.none() says that there is no way"
        seconds = real_number("duration", duration, allowed)
        if not 0.0 <= seconds < math.inf:
            raise ArgumentError("duration", duration, allowed)
        states = readonly("samples", samples, (None, None), "(k, width)")
        if len(states) < 2 or states.shape[1] < 3:
            raise ArgumentError("samples.shape", states.shape, "(k, width), k >= 2, width >= 3")
        object.__setattr__(self, "duration", seconds)
        object.__setattr__(self, "samples", states)

    @classmethod
    def none(cls) -> Connection:
        """There is no way: an infinite duration and no samples."""
        connection = object.__new__(cls)
        empty = np.empty((0, 0))
        empty.setflags(write=False)
        object.__setattr__(connection, "duration", math.inf)
        object.__setattr__(connection, "samples", empty)
        return connection

    @property
    def exists(self) -> bool:
        """Whether there is a way."""
        return self.duration < math.inf


class Steering(ABC):
    """Connects two states of a roadmap by a motion that the vehicle can fly.

    Duties of an implementer:

    1. ``connect(a, b)`` begins at a and ends at b, to 1e-6 in every number.
    2. Samples are so dense that the straight pieces between them are the way, as far as it matters:
       collisions and risk are evaluated along the pieces.
    3. No piece is faster than ``Risk.speed``, nor for a body that turns any point of the body:
       lower bounds rely on it, and a faster one is refused.
    4. Where there is no way the answer is ``Connection.none()``; errors are for bad input.
    5. The answer depends on a and b alone, which are not changed: it may be asked for again or
       remembered. Obstacles are not its business.
    6. ``symmetric`` is true only if the way from b to a is that from a to b reversed, in the same
       time.

    Attributes:
        symmetric: whether the way back is the same.
    """

    symmetric: bool = False

    @abstractmethod
    def connect(self, a: FloatArray, b: FloatArray) -> Connection:
        """The way from a to b, or ``Connection.none()``.

        Args:
            a: a state, its position [m] first, shape (width,); read-only.
            b: likewise.
        """


@dataclass(frozen=True)
class StraightSteering(Steering):
    """Straight at constant speed; poses turn at a constant rate meanwhile.

    ::

        duration = (distance + reach * angle) / speed

    Args:
        speed: of the fastest point of the body [m/s].
        reach: farthest point of the body from its origin [m], as the clearance's; 0 for a body
            whose orientation does not count.

    Raises:
        ArgumentError: a speed or reach out of range.

    Example:
        >>> StraightSteering(30.0).connect(np.zeros(3), np.array([60.0, 0.0, 0.0])).duration
        2.0
    """

    speed: float
    reach: float = 0.0

    symmetric = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed", positive("speed", self.speed))
        allowed = "a finite length in metres, 0 or more"
        reach = real_number("reach", self.reach, allowed)
        if not 0.0 <= reach < math.inf:
            raise ArgumentError("reach", self.reach, allowed)
        object.__setattr__(self, "reach", reach)

    def connect(self, a: FloatArray, b: FloatArray) -> Connection:
        """Straight from a to b."""
        travel = float(travelled(a[None], b[None], self.reach)[0])
        return Connection(travel / self.speed, np.stack([a, b]))
