"""What the rollouts of one plan meet, as arrays for the kernels."""

from __future__ import annotations

from typing import Any

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.air import Air as Air
from ompl_risk._kernels.gusts import FILTER
from ompl_risk.clearance import TerrainClearance

SLOW = 1.0
"""Speed over ground [m/s] below which the direction of flight is that of the moment before."""


def air_for(
    plan: Any,
    clearance: Any,
    disturbances: Any,
    draws: Any,
    *,
    traces: FloatArray | None = None,
    trace_every: int = 1,
) -> Air:
    """Everything that is the same for all rollouts of a plan, made once.

    Args:
        plan: what is flown, a ``Plan``.
        clearance: over the ground; one that is not of a terrain is not checked on the way.
        disturbances: what disturbs, ``Disturbances``.
        draws: random numbers, ``Draws``.
        traces: where to write positions, shape (N, k, 3).
        trace_every: how many steps from one to the next.
    """
    gusts, navigation, terrain = disturbances.gusts, disturbances.navigation, disturbances.terrain
    compiled = isinstance(clearance, TerrainClearance)
    given = np.empty(0) if navigation is None else navigation.given(update_time(plan, navigation))
    waves = np.empty((0, 2)) if terrain is None else terrain.wave_numbers
    drag = plan.drag if gusts is None or gusts.drag is None else gusts.drag
    count = len(draws.seeds)
    amplitudes = np.empty((count, 0)) if terrain is None else draws.amplitudes
    slopes = np.zeros(count) if terrain is None else terrain.slope_bound(amplitudes)
    return Air(
        filters=_closed(
            np.empty((0, FILTER)) if gusts is None else _filters(plan, clearance, gusts)
        ),
        drag=_closed(drag),
        navigation=_closed(given),
        update=1 if navigation is None else update_steps(plan, navigation),
        waves=_closed(waves),
        scale=0.0 if terrain is None else float(terrain.deviation),
        amplitudes=_closed(amplitudes),
        slopes=_closed(slopes),
        seeds=_closed(draws.seeds, np.uint64),
        handle=_closed(clearance.handle if compiled else np.zeros(8), np.int64),
        radius=float(clearance.radius) if compiled else 0.0,
        traces=np.empty((count, 0, 3)) if traces is None else traces,
        trace_every=int(trace_every),
    )


def update_steps(plan: Any, navigation: Any) -> int:
    """Steps from one update of the navigation to the next."""
    return max(1, round(1.0 / (navigation.rate * plan.dt)))


def update_time(plan: Any, navigation: Any) -> float:
    """Time from one update of the navigation to the next [s]."""
    return update_steps(plan, navigation) * plan.dt


def directions(velocities: FloatArray) -> FloatArray:
    """Directions of flight [rad] from the east, shape (n,); those of slow moments are held."""
    fast = np.hypot(velocities[:, 0], velocities[:, 1]) >= SLOW
    held = np.maximum.accumulate(np.where(fast, np.arange(len(fast)), -1))
    first = int(np.argmax(fast))  # before the vehicle moves: where it will go
    angles = np.arctan2(velocities[:, 1], velocities[:, 0]) if fast.any() else np.zeros(len(fast))
    return angles[np.where(held < 0, first, held)]


def _filters(plan: Any, clearance: Any, gusts: Any) -> FloatArray:
    """Rows of the gusts' filters at the beginnings of the steps."""
    positions, velocities = plan.positions[:-1], plan.velocities[:-1]
    if isinstance(clearance, TerrainClearance):
        heights = positions[:, 2] - clearance.terrain.height(positions[:, 0], positions[:, 1])
    else:
        heights = clearance(positions)  # the nearest obstacle counts as the ground
    speeds = np.linalg.norm(velocities, axis=1)
    return gusts.filters(np.maximum(heights, 0.0), speeds, directions(velocities), plan.dt)


def _closed(values: Any, kind: Any = np.float64) -> Any:
    """A contiguous read-only array: kernels are compiled once, whatever the caller's array is."""
    view = np.ascontiguousarray(values, dtype=kind).view()
    view.setflags(write=False)
    return view
