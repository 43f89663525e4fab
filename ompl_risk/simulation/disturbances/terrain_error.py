"""How far the ground is from the map."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly, real_number
from ompl_risk._kernels import terrain_error as kernels
from ompl_risk.errors import ArgumentError

SRTM = 16.0 / 1.645
"""Standard deviation [m] of heights that are within 16 m with probability 0.90: 9.73 m.

That errors are normal and of mean 0 is an assumption: a canopy, for one, raises the map.
"""

SRTM_NORTH_AMERICA = 9.0 / 1.645
"""The same [m] for 9 m with probability 0.90: 5.47 m."""

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class TerrainError(ReadOnlyArrays):
    """Errors of a map's heights: a stationary Gaussian field over the whole map.

    ::

        ground(x, y) = map(x, y) + e(x, y)
        e(x) = deviation / sqrt(m) sum_j (a_j cos(k_j x) + b_j sin(k_j x))
        E e(x) e(x + s) = deviation^2 exp(-|s|^2 / (2 length^2))

    The amplitudes a and b are independent standard normal numbers, drawn once for each rollout, so
    e is Gaussian and its variance is exactly ``deviation^2``. The wave numbers k come from the
    spectral density of the covariance, a normal one of standard deviation 1 / length: the lengths
    are its quantiles at (j + 1/2) / m, and each direction is a golden section of the half turn on
    from the one before. 64 of them meet the covariance to 0.03 deviation^2 up to 3 lengths apart,
    and to 0.06 anywhere up to 6; many more lengths apart nothing is said.

    The default is the Shuttle Radar Topography Mission's requirement, 16 m at 90 %, which tests
    found to be met with room to spare (5.6 to 9 m on the continents). Its errors are correlated:
    over hundreds of metres in two places of low relief where a lidar could be compared, through
    canopy among others. Others found parts that are random from place to place, and parts with
    wavelengths of continents. ``length`` = 300 m, and that the covariance is a Gaussian one, are
    assumptions about the first, of which the source names no more than the order: a correlation of
    0.61 at 300 m, 0.14 at 600 m and 0.05 at 734 m. Longer lengths make the error more of a
    constant, shorter ones give a flight more independent chances to collide.

    Args:
        deviation: standard deviation [m].
        correlation_length: [m]; infinite for an error that is the same everywhere.
        waves: m.
        seed: turns the directions of the wave numbers as a whole.

    Raises:
        ArgumentError: a number out of range.

    Reference:
        Farr et al., The Shuttle Radar Topography Mission, Reviews of Geophysics 45 (2007), and
        Rodriguez, Morris & Belz, A global assessment of the SRTM performance, Photogrammetric
        Engineering & Remote Sensing 72 (2006) (16 m at 90 %; what was found, by continents);
        Rodriguez et al., An assessment of the SRTM topographic products, JPL D-31639 (2005) (long
        and short wavelengths);
        LaLonde, Shortridge & Messina, The influence of land cover on Shuttle Radar Topography
        Mission (SRTM) elevations in low-relief areas, Transactions in GIS 14 (2010) ("spatial
        autocorrelation of errors persisted hundreds of meters");
        Shinozuka & Deodatis, Simulation of multi-dimensional Gaussian stochastic fields by spectral
        representation, Applied Mechanics Reviews 49 (1996) (sums of waves, whose phases are random
        there and whose amplitudes are given; with random ones the sum is Gaussian for any m).
    """

    deviation: float = SRTM
    correlation_length: float = 300.0
    waves: int = 64
    seed: int = 0

    def __post_init__(self) -> None:
        positive("deviation", self.deviation)
        allowed = "a positive length [m], or infinite"
        if not real_number("correlation_length", self.correlation_length, allowed) > 0.0:
            raise ArgumentError("correlation_length", self.correlation_length, allowed)
        _whole("waves", self.waves, 1)
        _whole("seed", self.seed, 0)

    @cached_property
    def wave_numbers(self) -> FloatArray:
        """k [rad/m], shape (m, 2), by increasing direction over a half turn; read-only."""
        j = np.arange(self.waves)
        shift = np.random.default_rng(self.seed).random()
        angle = np.pi * ((j * GOLDEN + shift) % 1.0)
        length = np.sqrt(-2.0 * np.log1p(-(j + 0.5) / self.waves)) / self.correlation_length
        k = np.column_stack([length * np.cos(angle), length * np.sin(angle)])
        return readonly("wave_numbers", k[np.argsort(angle)], (None, 2), "(m, 2)")

    def covariance(self, distances: ArrayLike) -> FloatArray:
        """The wanted covariance [m^2] at so many metres of distance, same shape."""
        s = np.asarray(distances, dtype=np.float64) / self.correlation_length
        return self.deviation**2 * np.exp(-0.5 * s * s)

    def errors(self, amplitudes: ArrayLike, places: ArrayLike) -> FloatArray:
        """e [m] of one rollout, shape (n,).

        Args:
            amplitudes: of the rollout, shape (2 m,).
            places: x and y [m], shape (n, 2).

        Raises:
            ArgumentError: a wrong shape, or a number that is not finite.
        """
        m = 2 * self.waves
        amplitudes = readonly("amplitudes", amplitudes, (m,), f"({m},): cosines, then sines")
        places = readonly("places", places, (None, 2), "(n, 2)")
        out = np.empty(len(places))
        kernels.errors(self.wave_numbers, float(self.deviation), amplitudes, places, out)
        return out

    def slope_bound(self, amplitudes: ArrayLike) -> FloatArray:
        """Upper bounds for the slope of e anywhere, shape (N,).

        The greatest length of a gradient in which every wave's steepest slope may have either
        sign: about 0.65 of the sum of these slopes.

        Args:
            amplitudes: of the rollouts, shape (N, 2 m).

        Raises:
            ArgumentError: a wrong shape, or a number that is not finite.
        """
        m = 2 * self.waves
        amplitudes = readonly("amplitudes", amplitudes, (None, m), f"(N, {m})")
        out = np.empty(len(amplitudes))
        kernels.slope_bounds(self.wave_numbers, float(self.deviation), amplitudes, out)
        return out


def _whole(name: str, value: Any, least: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise ArgumentError(name, value, f"a whole number from {least}")
