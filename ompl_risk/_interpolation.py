"""Values between samples: straight lines, great arcs and held controls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from ompl_risk._arrays import FloatArray


def linear(times: FloatArray, t: FloatArray, values: FloatArray) -> FloatArray:
    """Straight between the samples (t, values), values of shape (n, m); shape (len(times), m)."""
    return np.stack([np.interp(times, t, column) for column in values.T], axis=1)


def great_arc(times: FloatArray, t: FloatArray, q: FloatArray) -> FloatArray:
    """Turning at constant rate between the quaternions q (x, y, z, w), shape (n, 4)."""
    return Slerp(t, Rotation.from_quat(q))(times).as_quat()


def held_or_linear(times: FloatArray, t: FloatArray, controls: FloatArray) -> FloatArray:
    """Controls at new times: n of them are samples, n - 1 are held, one over each interval.

    A held control becomes, for each new interval, the one in force when that begins.
    """
    if len(controls) == len(t):
        return linear(times, t, controls)
    return controls[np.searchsorted(t, times[:-1], side="right") - 1]


def subdivided(t: FloatArray, parts: NDArray[np.int64]) -> FloatArray:
    """Times t with interval i divided into parts[i] equal ones; all of t are kept."""
    first = np.repeat(np.cumsum(parts) - parts, parts)
    within = np.arange(parts.sum()) - first
    times = np.repeat(t[:-1], parts) + within * np.repeat(np.diff(t) / parts, parts)
    return np.append(times, t[-1])
