"""Norms by the names that people type: "L1", "L2", "L2.5", "Linf", "H1", "H1(0.5)"."""

from __future__ import annotations

import math
import re

from ompl_risk.errors import ArgumentError
from ompl_risk.norms.base import Norm
from ompl_risk.norms.lp import Lp
from ompl_risk.norms.sobolev import Sobolev

ALLOWED = '"L1", "L2" or any "Lp" with p >= 1, "Linf", "H1", or "H1(0.5)" with a time scale [s]'
_LP = re.compile(r"L(\d+(?:\.\d+)?)", re.IGNORECASE)
_SOBOLEV = re.compile(r"H([0-9]+)(?:\((\d+(?:\.\d+)?)\))?", re.IGNORECASE)


def parse_norm(text: str, *, argument: str = "norm") -> Norm:
    """The norm of that name.

    Args:
        text: name of the norm; upper or lower case.
        argument: what the caller calls it in errors.

    Raises:
        ArgumentError: no such norm.

    Example:
        >>> parse_norm("H1(0.5)").label
        'H1(τ=0.5 s)'
    """
    name = text.strip()
    if name.lower() in ("linf", "l∞"):
        return Lp(math.inf)
    try:
        if match := _LP.fullmatch(name):
            return Lp(float(match[1]))
        if match := _SOBOLEV.fullmatch(name):
            return Sobolev(int(match[1]), time_scale=float(match[2] or 1.0))
    except ArgumentError:
        pass  # p < 1 or a time scale of 0: the message below says what is allowed
    raise ArgumentError(argument, text, ALLOWED) from None


def norm_name(norm: Norm) -> str:
    """The name that `parse_norm` reads back as this norm.

    Raises:
        ArgumentError: a norm without such a name (the Fourier form).
    """
    if isinstance(norm, Lp):
        return "Linf" if math.isinf(norm.p) else f"L{norm.p:.15g}"
    if isinstance(norm, Sobolev) and norm.form == "derivative":
        scale = "" if norm.time_scale == 1.0 else f"({norm.time_scale:.15g})"
        return f"H{norm.k:g}{scale}"
    raise ArgumentError("norm", norm, "Lp(p) or Sobolev(k) in the derivative form")
