"""The norm along a motion that has times of its own, whatever the speed."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.motion import halving
from ompl_risk.motion.base import Risk
from ompl_risk.motion.lines import Distances, Lines
from ompl_risk.motion.sampled import MOTIONS


def timed_norm(states: FloatArray, seconds: FloatArray, clearance: Any, risk: Risk) -> float:
    """The norm of f along states that follow each other after given times.

    ::

        ||f||^p = integral of f^p + tau^2 f'^2 dt

    Between two states the vehicle moves straight and at constant speed; where they are the same, it
    stays. What takes no time adds nothing, but must be free. Neither the speed nor the weight of a
    second counts.

    Args:
        states: positions [m], shape (n, 3), or poses x, y, z, qx, qy, qz, qw, shape (n, 7), n >= 1.
        seconds: times from each to the next [s], 0 or more, shape (n - 1,).
        clearance: callable with points (n, 3) [m], or poses (n, 7) if it ``uses_orientation``.
        risk: how risk is counted.

    Returns:
        ||f||, inf in collision. A single state takes no time.

    Raises:
        ArgumentError: positions, and a clearance that needs poses; numbers that are not finite; a
            clearance that answers with NaN or in another shape.
    """
    if len(states) == 1:
        states, seconds = np.repeat(states, 2, axis=0), np.zeros(1)
    distances, pure = Distances(clearance, states.shape[1]), replace(risk, duration_weight=0.0)
    powers = []
    for i in range(0, len(seconds), MOTIONS):
        rows = slice(i, i + MOTIONS)
        lines = Lines(distances, states[:-1][rows], states[1:][rows])
        powers.append(
            halving.maxima(lines, pure)
            if math.isinf(pure.exponent)
            else halving.powers(lines, pure, seconds[rows])
        )
    return pure.root(pure.combine(np.concatenate(powers)))
