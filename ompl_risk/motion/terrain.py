"""Motions over terrain: every answer is one call of compiled code."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import motion, motions, nearest
from ompl_risk.avoidance.compiled import compiled_form
from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.threads import in_chunks, thread_count
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.base import MotionModel, Risk
from ompl_risk.motion.batch import MotionBatch

LEAST = 512
"""Motions that are worth a thread."""


def kernel_parameters(radius: float, risk: Risk) -> FloatArray:
    """The parameters of the kernels, in their order; ``radius`` [m] is the vehicle's.

    Raises:
        ArgumentError: an avoidance function that compiled code does not know.
    """
    form = compiled_form(risk.avoidance)
    if form is None:
        known = "an avoidance function of this library: compiled code knows no other"
        raise ArgumentError("risk.avoidance", risk.avoidance, known)
    counted = [risk.speed, risk.exponent, risk.time_scale, risk.tolerance, risk.weight]
    return np.array([*form, radius, *counted, risk.negligible])


class TerrainMotion(MotionModel):
    """``MotionModel`` over a ``TerrainClearance``, with an avoidance function of this library.

    Args:
        clearance: the terrain and the vehicle's radius.
        risk: how risk is counted; any for a model that is only asked about collisions.
        width: length of the state buffers.
    """

    def __init__(self, clearance: TerrainClearance, risk: Risk, width: int = 3) -> None:
        self.a, self.b = np.zeros(width), np.zeros(width)
        self._clearance = clearance  # keeps the arrays behind the handle alive
        self._given = kernel_parameters(clearance.radius, risk)
        self._work = (*nearest.workspace(), np.empty((motion.DEPTH, 2)))
        buffers = (*self._work, self.a, self.b, self._given)
        self._handle = np.concatenate(
            [clearance.handle, np.array([x.ctypes.data for x in buffers], dtype=np.int64)]
        )

    def clearance(self) -> float:
        """Clearance d [m] at a."""
        return motion.clearance(self._handle)

    def is_free(self) -> bool:
        """Whether a is free, d > 0."""
        return motion.is_free(self._handle)

    def is_motion_free(self) -> bool:
        """Whether every state from a to b is free."""
        return motion.is_motion_free(self._handle)

    def cost(self) -> float:
        """Cost of the motion from a to b."""
        return motion.motion_cost(self._handle)

    def heuristic(self) -> float:
        """Lower bound for the cost of any way from a to b."""
        return motion.heuristic(self._handle)


def _plain(array: FloatArray) -> FloatArray:
    """As the kernels were compiled for: another layout would be compiled anew."""
    return np.require(array, np.float64, ["C", "W"])


class TerrainBatch(MotionBatch):
    """``MotionBatch`` over a ``TerrainClearance``, in several threads.

    The avoidance function is one of this library.

    Args:
        clearance: the terrain and the vehicle's radius.
        risk: how risk is counted.
        threads: at most so many; ``None`` uses all processors.
    """

    width = 3
    compiled = True

    def __init__(
        self, clearance: TerrainClearance, risk: Risk, *, threads: int | None = None
    ) -> None:
        self._clearance, self._risk = clearance, risk
        self._given = kernel_parameters(clearance.radius, risk)
        self._threads = thread_count(threads)

    def clearances(self, states: FloatArray) -> FloatArray:
        """Clearances d [m], shape (n,)."""
        return self._clearance(states)

    def are_free(self, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
        """Whether every state from a[k] to b[k] is free, shape (n,)."""
        free = np.empty(len(a), dtype=np.bool_)
        self._spread(motions.are_motions_free, a, b, free)
        return free

    def costs(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Costs of the motions from a[k] to b[k], inf in collision, shape (n,)."""
        costs = np.empty(len(a))
        self._spread(motions.motion_costs, a, b, costs)
        return costs

    def durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Durations [s], shape (n,)."""
        return np.linalg.norm(b - a, axis=1) / self._risk.speed

    def heuristics(
        self, a: FloatArray, b: FloatArray, d_a: FloatArray, d_b: FloatArray
    ) -> FloatArray:
        """Lower bounds for the cost of any way from a[k] to b[k]."""
        bounds = np.empty(len(a))
        motions.heuristics(_plain(a), _plain(b), _plain(d_a), _plain(d_b), self._given, bounds)
        return bounds

    def _spread(self, kernel: Any, a: FloatArray, b: FloatArray, out: NDArray[Any]) -> None:
        """Run a kernel over chunks of the motions."""
        a, b = _plain(a), _plain(b)

        def work(i: int, j: int) -> None:
            kernel(self._clearance.handle, a[i:j], b[i:j], self._given, out[i:j])

        in_chunks(work, len(a), self._threads, least=LEAST)
