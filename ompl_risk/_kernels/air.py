"""What rollouts meet, and where they write what became of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

COMPLETED, TOUCHED, LEFT_MAP, LOST_CONTROL = range(4)
"""How a rollout ends."""


class Air(NamedTuple):
    """What the rollouts of a plan meet; an array without rows: there is nothing of the kind.

    Attributes:
        filters: of the gusts, a row for each step, shape (n, FILTER).
        drag: along the axes of the body [kg/s], shape (3,).
        navigation: ``given`` of the navigation errors.
        update: steps between two updates of the navigation.
        waves: wave numbers of the terrain's error [rad/m], shape (m, 2).
        scale: standard deviation of the terrain's error [m].
        amplitudes: of its waves in each rollout, shape (N, 2 m).
        slopes: greatest slope of it in each rollout, shape (N,).
        seeds: of each rollout's random numbers, shape (N,).
        handle: of the height field; zeros: no ground.
        radius: of the vehicle's sphere [m].
        traces: written, positions every ``trace_every`` steps, shape (N, k, 3).
        trace_every: [steps].
    """

    filters: NDArray[np.float64]
    drag: NDArray[np.float64]
    navigation: NDArray[np.float64]
    update: int
    waves: NDArray[np.float64]
    scale: float
    amplitudes: NDArray[np.float64]
    slopes: NDArray[np.float64]
    seeds: NDArray[np.uint64]
    handle: NDArray[np.int64]
    radius: float
    traces: NDArray[np.float64]
    trace_every: int


class Record(NamedTuple):
    """What became of the rollouts; see ``simulation.outcomes.Outcomes``.

    Attributes:
        least: least clearance [m], shape (N,).
        when: time of it [s], shape (N,).
        where: place of it [m], shape (N, 3).
        collided: time of the collision [s] or inf, shape (N,).
        endings: COMPLETED, TOUCHED, LEFT_MAP or LOST_CONTROL, shape (N,).
    """

    least: NDArray[np.float64]
    when: NDArray[np.float64]
    where: NDArray[np.float64]
    collided: NDArray[np.float64]
    endings: NDArray[np.int8]
