"""Avoidance functions as compiled code knows them."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.integrand import CAP, INVERSE, TAIL
from ompl_risk.avoidance.base import Avoidance
from ompl_risk.avoidance.flat_cap import FlatCap
from ompl_risk.avoidance.gaussian_tail import GaussianTail
from ompl_risk.avoidance.inverse_distance import InverseDistance


def compiled_form(avoidance: Avoidance) -> FloatArray | None:
    """The numbers that tell kernels which function it is, read-only; None if they know none such.

    See ``ompl_risk._kernels.integrand``. A class derived from one of the known ones may compute
    something else, so it is not known.
    """
    form = _numbers(avoidance)
    if form is None:
        return None
    array = np.array([avoidance.d0, *form, avoidance.steady or 0.0])
    array.setflags(write=False)
    return array


def is_compiled(avoidance: Avoidance) -> bool:
    """Whether kernels compute this function."""
    return _numbers(avoidance) is not None


def _numbers(avoidance: Avoidance) -> tuple[float, float, float] | None:
    """Kind, scale and offset."""
    kind = type(avoidance)
    if kind is InverseDistance:
        return INVERSE, 1.0, 1.0 / avoidance.d0
    if isinstance(avoidance, FlatCap) and kind is FlatCap:
        return CAP, avoidance.r, 0.0
    if isinstance(avoidance, GaussianTail) and kind is GaussianTail:
        return TAIL, math.sqrt(2.0) * avoidance.sigma, avoidance.offset
    return None
