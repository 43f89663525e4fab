"""Sobolev H^k norms, in the derivative and the Fourier form."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from typing import Literal

import numpy as np
import scipy.fft

from ompl_risk._arrays import FloatArray, positive, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.norms.base import Norm


@dataclass(frozen=True)
class Sobolev(Norm):
    """The Sobolev H^k norm with a time scale tau [s] that makes its terms commensurable.

    Derivative form, (5):

        ||f||^2 = sum over i = 0..k of tau^(2i) integral |d^i f / dt^i|^2 dt

    Exact for the piecewise-linear interpolant on any times for k = 0 (which is L^2) and k = 1:
    an interval of length dt from f0 to f1 contributes

        dt (f0^2 + f0 f1 + f1^2) / 3 + tau^2 (f1 - f0)^2 / dt.

    For k >= 2 it uses finite differences and needs equal time steps. The distance to obstacles
    has kinks (where the closest obstacle changes, and at d0), so f is not in H^2: the result
    grows without limit as the steps shrink, and compares trajectories only on equal steps.
    `grid_sensitivity` shows it.

    Fourier form, (6), for any real k >= 0 and equal time steps:

        ||f||^2 = integral (1 + (w tau xi)^2)^k |fhat(xi)|^2 dxi,    xi in Hz

    where f on [0, T] is continued as an even function of period 2 T (a cosine series; cut off by
    zero instead, f would jump at the ends and its H^1 norm would diverge), and Parseval's
    identity holds over [0, T]. weight="angular", w = 2 pi: equal to the derivative form in the
    limit of small steps at k = 0 and k = 1 (at k >= 2 it is equivalent: binomial coefficients
    weigh the derivatives). weight="hertz", w = 1: the weight as the paper prints it, an
    equivalent norm but not the same number. For k >= 3/2 the kinks make it grid-dependent
    too. `shares` come from the density |(1 + (w tau xi)^2)^(k/2) f|^2, whose integral is the power.

    With f in 1/m and tau in s the norm is in s^(1/2)/m. tau = 1 s is the paper.

    Args:
        k: order, a whole number >= 0 (derivative form) or any real >= 0 (Fourier form).
        time_scale: tau [s], positive.
        form: "derivative" or "fourier".
        weight: "angular" or "hertz", for the Fourier form.

    Raises:
        ArgumentError: one of these is something else; or, when called with k >= 2 or in the Fourier
            form, the time steps are unequal, or there are fewer than k + 1 samples.

    Reference:
        Nair & Kobilarov, equations (5) and (6).

    Example:
        >>> Sobolev(1)([0.0, 1.0], [1.0, 1.0])
        1.0
    """

    k: float = 1
    _: KW_ONLY
    time_scale: float = 1.0
    form: Literal["derivative", "fourier"] = "derivative"
    weight: Literal["angular", "hertz"] = "angular"

    def __post_init__(self) -> None:
        if self.form not in ("derivative", "fourier"):
            raise ArgumentError("form", self.form, '"derivative" or "fourier"')
        if self.weight not in ("angular", "hertz"):
            raise ArgumentError("weight", self.weight, '"angular" or "hertz"')
        if self.weight == "hertz" and self.form == "derivative":
            raise ArgumentError("weight", self.weight, '"angular" unless form="fourier"')
        allowed = "a real number >= 0" if self.form == "fourier" else "a whole number >= 0"
        k = real_number("k", self.k, allowed)
        if k < 0 or math.isinf(k) or (self.form == "derivative" and not k.is_integer()):
            raise ArgumentError("k", self.k, f"{allowed} in the {self.form} form")
        object.__setattr__(self, "k", k)
        object.__setattr__(self, "time_scale", positive("time_scale", self.time_scale))

    @property
    def exponent(self) -> float:
        """2."""
        return 2.0

    @property
    def label(self) -> str:
        """Such as "H1", "H1(τ=0.5 s)", "H1.5(Fourier)", "H1(Fourier, Hz)"."""
        notes = ["Fourier"] if self.form == "fourier" else []
        notes += ["Hz"] if self.weight == "hertz" else []
        notes += [f"τ={self.time_scale:g} s"] if self.time_scale != 1.0 else []
        return f"H{self.k:g}" + (f"({', '.join(notes)})" if notes else "")

    @property
    def needs_uniform_times(self) -> bool:
        """True in the Fourier form and for k >= 2."""
        return self.form == "fourier" or self.k >= 2

    def _interval_powers(self, t: FloatArray, f: FloatArray) -> FloatArray:
        if self.form == "fourier":
            rate = self.time_scale * (2 * math.pi if self.weight == "angular" else 1.0)
            return _cosine_powers(_uniform_step(t, self.label), f, self.k, rate)
        f0, f1 = f[:-1], f[1:]
        powers = np.diff(t) * (f0**2 + f0 * f1 + f1**2) / 3
        if self.k >= 1:
            powers += self.time_scale**2 * (f1 - f0) ** 2 / np.diff(t)
        if self.k >= 2:
            dt = _uniform_step(t, self.label)
            for i in range(2, int(self.k) + 1):
                powers += _difference_powers(dt, f, i, self.time_scale**i)
        return powers


def _uniform_step(t: FloatArray, label: str) -> float:
    """The common time step [s]."""
    steps = np.diff(t)
    dt = (t[-1] - t[0]) / len(steps)
    if np.abs(steps - dt).max() > 1e-6 * dt + 4 * np.spacing(np.abs(t).max()):
        raise ArgumentError(
            "t",
            f"steps from {steps.min():g} to {steps.max():g} s",
            f"in equal steps for {label}: resample, as in trajectory.resample(step=...)",
        )
    return float(dt)


def _difference_powers(dt: float, f: FloatArray, i: int, scale: float) -> FloatArray:
    """The integral of |scale d^i f / dt^i|^2 by differences, spread over the n - 1 intervals.

    The midpoint rule over the differences covers all but (i - 1) / 2 steps at each end; the
    outermost differences stand for those as well, which keeps the rule of second order.
    """
    if len(f) < i + 1:
        raise ArgumentError("len(f)", len(f), f"at least {i + 1} for a derivative of order {i}")
    weights = np.full(len(f) - i, dt)
    weights[0] += (i - 1) / 2 * dt
    weights[-1] += (i - 1) / 2 * dt
    powers = weights * (scale * np.diff(f, i) / dt**i) ** 2
    return np.convolve(powers, np.full(i, 1.0 / i))  # a difference spans i intervals


def _cosine_powers(dt: float, f: FloatArray, k: float, rate: float) -> FloatArray:
    """The integral of g^2 over each interval, g = (1 + (rate xi)^2)^(k/2) f as a cosine series.

    g is a cosine polynomial of degree n - 1, so g^2 has degree 2 (n - 1), and the trapezoidal
    rule on half steps integrates it exactly over [0, T]: the powers add up as Parseval says.
    """
    n = len(f)
    coefficients = np.asarray(scipy.fft.dct(f, type=1)) / (n - 1)
    coefficients[[0, -1]] /= 2
    xi = np.arange(n) / (2 * dt * (n - 1))
    spectrum = np.zeros(2 * n - 1)
    spectrum[:n] = coefficients * (1 + (rate * xi) ** 2) ** (k / 2)
    spectrum[1:] /= 2
    density = np.asarray(scipy.fft.dct(spectrum, type=1)) ** 2
    return dt / 4 * (density[:-2:2] + 2 * density[1:-1:2] + density[2::2])
