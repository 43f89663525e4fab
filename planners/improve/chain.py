"""The risk of a finely sampled path as a smooth function of its corners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import chain as curvatures
from ompl_risk._kernels import integrand
from ompl_risk._kernels import refine as kernels
from ompl_risk.avoidance import Avoidance
from ompl_risk.avoidance.compiled import compiled_form
from ompl_risk.planners.improve.fields import Field

LOWEST = 0.02
"""Below this clearance, in units of d0, f goes on along its tangent: finite even underground."""

BUFFER = 0.02
"""Obstacles repel below this distance, in units of d0: room for what lies between the samples."""

REPULSION = 100.0
"""What a second spent half-way into the buffer costs, about, in mean risks of the given path."""

UNKNOWN = -1e3
"""Clearance where nothing is known of obstacles, in units of d0: finite, and no path goes there."""

SHORTEST = 1e-9
"""Legs count as at least so long [m]."""


@dataclass(frozen=True)
class Surroundings:
    """What the cost of a path depends on.

    Attributes:
        field: the clearance.
        gate: the clearance that has to stay positive; None if it is `field` less `margin`.
        margin: see `gate` [m].
        avoidance: f(d).
        speed: [m/s].
        tau: time scale of the norm [s]; 0 for L^p.
    """

    field: Field
    gate: Field | None
    margin: float
    avoidance: Avoidance
    speed: float
    tau: float


class Point(NamedTuple):
    """A path and its cost.

    Attributes:
        corners: shape (n, 3) [m].
        cost: the cost.
        duration: [s].
        by_corners: gradient of the cost, shape (n, 3).
        longer: gradient of the duration, shape (n, 3).
        legs: lengths of the legs [m], shape (n - 1,).
        along: their directions, shape (n - 1, 3).
        by_leg: derivatives of the cost by the legs' durations, shape (n - 1,).
        f, slope: f at the samples and its derivative by d.
        normals: gradients of d at the samples.
        stiffness: second derivatives by d at the samples.
        repelled: the same of the repulsion, and its normals; None if nothing repels.
    """

    corners: FloatArray
    cost: float
    duration: float
    by_corners: FloatArray
    longer: FloatArray
    legs: FloatArray
    along: FloatArray
    by_leg: FloatArray
    f: FloatArray
    slope: FloatArray
    normals: FloatArray
    stiffness: FloatArray
    repelled: tuple[FloatArray, FloatArray] | None


class Chain:
    """Cost of a path with a given number of corners and of samples on each leg.

        cost = sum over pieces of integral of (f / scale)^p + tau^2 (f' / scale)^2 dt
             + weight duration + repulsion

    with f linear on the pieces. The repulsion grows with the square of the depth into a narrow
    buffer about the obstacles.

    Args:
        surroundings: see there.
        exponent: p.
        scale: of f, in its unit.
        weight: cost of a second.
        counts: pieces of each leg, shape (n - 1,).
        durations: of the legs as they are at first [s], shape (n - 1,).
    """

    def __init__(
        self,
        surroundings: Surroundings,
        *,
        exponent: float,
        scale: float,
        weight: float,
        counts: NDArray[np.int64],
        durations: FloatArray,
    ) -> None:
        self._around, self._p, self._scale, self._weight = surroundings, exponent, scale, weight
        self._counts = counts
        each = durations / counts
        shares = np.repeat(0.5 * each, counts)
        self._shares = np.concatenate([shares, [0.0]]) + np.concatenate([[0.0], shares])
        self._buffer = BUFFER * surroundings.avoidance.d0
        self._form = compiled_form(surroundings.avoidance)

    def at(self, corners: FloatArray) -> Point:
        """The cost of a path and its derivatives."""
        around, counts = self._around, self._counts
        samples = np.empty((len(self._shares), 3))
        kernels.place_samples(corners, counts, samples)
        d, normals = around.field(samples, around.avoidance.d0)
        np.maximum(d, UNKNOWN * around.avoidance.d0, out=d)
        f, slope, bend = self._avoidance(d)
        legs, along = _legs(corners)
        by_f, by_leg = np.empty(len(f)), np.empty(len(legs))
        risk = kernels.path_risk(f, counts, legs / around.speed, self._p, around.tau, by_f, by_leg)
        duration = float(legs.sum()) / around.speed
        by_leg += self._weight
        longer = _spread_ends(along / around.speed)
        by_corners = _spread_ends(along * (by_leg / around.speed)[:, None])
        kernels.spread(counts, by_f * slope, normals, by_corners)
        repulsion, repelled = self._repel(samples, d, normals, by_corners)
        return Point(
            corners=corners,
            cost=risk + self._weight * duration + repulsion,
            duration=duration,
            by_corners=by_corners,
            longer=longer,
            legs=legs,
            along=along,
            by_leg=by_leg,
            f=f,
            slope=slope,
            normals=normals,
            stiffness=np.maximum(by_f, 0.0) * bend,
            repelled=repelled,
        )

    def curvature(self, point: Point) -> tuple[FloatArray, FloatArray]:
        """Positive semidefinite second derivatives of the cost at a point, legs held.

        Returns:
            The diagonal blocks, shape (n, 3, 3), and those below, shape (n - 1, 3, 3).
        """
        n, counts, around = len(point.corners), self._counts, self._around
        diagonal, coupling = np.zeros((n, 3, 3)), np.zeros((n - 1, 3, 3))
        seconds = point.legs / around.speed
        curvatures.couple(
            point.f, point.slope, counts, seconds, self._p, around.tau, point.normals,
            diagonal, coupling,
        )  # fmt: skip
        curvatures.stiffen(counts, point.stiffness, point.normals, diagonal, coupling)
        if point.repelled is not None:
            curvatures.stiffen(counts, *point.repelled, diagonal, coupling)
        return diagonal, coupling

    def _avoidance(self, d: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """f / scale and its first two derivatives by d, on along the tangent where d is small."""
        avoidance, scale = self._around.avoidance, self._scale
        low = LOWEST * avoidance.d0
        f, slope, bend = np.empty(len(d)), np.empty(len(d)), np.empty(len(d))
        if self._form is not None:
            integrand.tangents(d, self._form, low, scale, f, slope, bend)
            return f, slope, bend
        at, h = np.maximum(d, low), 1e-4 * avoidance.d0
        slope = avoidance.derivative(at) / scale
        f = avoidance(at) / scale + slope * np.minimum(d - low, 0.0)
        bend = (avoidance.derivative(at + h) - avoidance.derivative(at - h)) / (2.0 * h * scale)
        return f, slope, np.where(d > low, np.maximum(bend, 0.0), 0.0)

    def _repel(
        self, samples: FloatArray, d: FloatArray, normals: FloatArray, by_corners: FloatArray
    ) -> tuple[float, tuple[FloatArray, FloatArray] | None]:
        """The repulsion, whose gradient is added; its second derivatives, and the normals."""
        around = self._around
        room = d - around.margin
        if around.gate is not None:
            room, normals = around.gate(samples, self._buffer)
        depth = np.maximum(self._buffer - room, 0.0)
        if not depth.any():
            return 0.0, None
        stiffness = self._shares * (REPULSION / self._buffer**2)
        kernels.spread(self._counts, -2.0 * stiffness * depth, normals, by_corners)
        stiff = 2.0 * stiffness * (depth > 0.0)
        return float((stiffness * depth * depth).sum()), (stiff, normals)


def _legs(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lengths of the legs, and their directions."""
    steps = np.diff(corners, axis=0)
    legs = np.maximum(np.sqrt(np.einsum("ij,ij->i", steps, steps)), SHORTEST)
    return legs, steps / legs[:, None]


def _spread_ends(push: FloatArray) -> FloatArray:
    """Gradient by the corners from the gradients by the legs' vectors."""
    gradient = np.zeros((len(push) + 1, 3))
    gradient[1:] = push
    gradient[:-1] -= push
    return gradient
