"""Terrains from formulas: seeded, of any size, the same on every run."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ompl_risk.terrains.checks import Pair, grid_shape, number, pair, whole
from ompl_risk.terrains.terrain import Terrain

_WAVES = 5
"""Sine waves in a meander; more make no visible difference."""


def hills(
    *,
    shape: tuple[int, int] = (301, 401),
    spacing: Pair = (30.0, 30.0),
    seed: int = 0,
    count: int = 40,
    height: float = 300.0,
    radius: float = 900.0,
) -> Terrain:
    """Round hills at random places, h = sum_k A_k exp(-|p - c_k|^2 / (2 r_k^2)).

    Args:
        shape: number of posts (ny, nx).
        spacing: distance of neighbouring posts (dx, dy) [m].
        seed: of the random places c_k, heights A_k and radii r_k.
        count: number of hills.
        height: greatest height of a single hill [m]; A_k is at least a quarter of it.
        radius: greatest radius of a hill [m]; r_k is at least half of it.

    Raises:
        ArgumentError: a parameter has a value that is not allowed.
    """
    x, y, rng = _setting(shape, spacing, seed)
    count = whole("count", count, least=1)
    number("height", height, above=0.0)
    number("radius", radius, above=0.0)
    centre_x, centre_y = rng.uniform(0.0, x[-1], count), rng.uniform(0.0, y[-1], count)
    amplitude = height * rng.uniform(0.25, 1.0, count)
    width = radius * rng.uniform(0.5, 1.0, count)
    along_x = np.exp(-0.5 * ((x - centre_x[:, None]) / width[:, None]) ** 2)
    along_y = np.exp(-0.5 * ((y - centre_y[:, None]) / width[:, None]) ** 2)
    heights = (amplitude[:, None] * along_y).T @ along_x  # a Gaussian is a product
    return _terrain(heights, spacing, "hills", seed)


def ridge_valley(
    *,
    shape: tuple[int, int] = (301, 401),
    spacing: Pair = (30.0, 30.0),
    seed: int = 0,
    wavelength: float = 3000.0,
    relief: float = 400.0,
    azimuth: float = 45.0,
    meander: float = 300.0,
    passes: float = 0.5,
) -> Terrain:
    """Parallel ridges with passes, h = relief c(s) (1 + cos(2 pi (u + m(s)) / wavelength)) / 2.

    s and u are the positions along and across the ridges, m a random meander, and c between
    1 - passes and 1 a random height of the crest.

    Args:
        shape: number of posts (ny, nx).
        spacing: distance of neighbouring posts (dx, dy) [m].
        seed: of meander, crest height and the place of the first ridge.
        wavelength: distance of neighbouring ridges [m].
        relief: greatest height of a crest above the valleys [m].
        azimuth: direction of the ridges [degree], clockwise from north.
        meander: greatest sideways shift of a ridge [m].
        passes: depth of the deepest pass as a part of the relief, 0 to 1.

    Raises:
        ArgumentError: a parameter has a value that is not allowed.
    """
    x, y, rng = _setting(shape, spacing, seed)
    number("wavelength", wavelength, above=0.0)
    number("relief", relief, above=0.0)
    number("meander", meander, least=0.0)
    number("passes", passes, least=0.0, most=1.0)
    angle = math.radians(number("azimuth", azimuth))
    s = math.sin(angle) * x + math.cos(angle) * y[:, None]
    u = math.cos(angle) * x - math.sin(angle) * y[:, None]
    start = rng.uniform(0.0, wavelength)
    shift = start + meander * _meander(s, 2.0 * wavelength, rng)
    crest = 1.0 - passes * 0.5 * (1.0 + _meander(s, wavelength, rng))
    heights = 0.5 * relief * crest * (1.0 + np.cos(2.0 * math.pi * (u + shift) / wavelength))
    return _terrain(heights, spacing, "ridge_valley", seed)


def canyon(
    *,
    shape: tuple[int, int] = (301, 401),
    spacing: Pair = (30.0, 30.0),
    seed: int = 0,
    depth: float = 600.0,
    floor: float = 300.0,
    wall: float = 600.0,
    meander: float = 1200.0,
) -> Terrain:
    """A plateau with a winding canyon from west to east.

    h = depth (3 w^2 - 2 w^3), w = clip((|y - c(x)| - floor / 2) / wall, 0, 1), with a random
    centre line c about the middle of the terrain.

    Args:
        shape: number of posts (ny, nx).
        spacing: distance of neighbouring posts (dx, dy) [m].
        seed: of the centre line.
        depth: height of the plateau above the floor [m].
        floor: width of the flat floor [m].
        wall: horizontal extent of each wall [m]; depth / wall is its mean slope.
        meander: greatest distance of the centre line from the middle [m].

    Raises:
        ArgumentError: a parameter has a value that is not allowed.
    """
    x, y, rng = _setting(shape, spacing, seed)
    number("depth", depth, above=0.0)
    number("floor", floor, least=0.0)
    number("wall", wall, above=0.0)
    number("meander", meander, least=0.0)
    period = max(4.0 * meander, 2.0 * (floor + 2.0 * wall))  # bends wider than the canyon
    centre = 0.5 * y[-1] + meander * _meander(x, period, rng)
    w = np.clip((np.abs(y[:, None] - centre) - 0.5 * floor) / wall, 0.0, 1.0)
    return _terrain(depth * w * w * (3.0 - 2.0 * w), spacing, "canyon", seed)


def fractal(
    *,
    shape: tuple[int, int] = (512, 512),
    spacing: Pair = (30.0, 30.0),
    seed: int = 0,
    hurst: float = 0.9,
    rms_slope: float = 0.3,
) -> Terrain:
    """A self-affine random terrain by spectral synthesis.

    White noise is filtered with |k|^-(H + 1), so that the mean square of h(p + r) - h(p) grows
    as r^(2 H) while r is small against the terrain, and scaled to the slope wanted. The lowest
    post is at 0. Opposite edges fit together: the terrain is one period of a periodic one.

    Args:
        shape: number of posts (ny, nx).
        spacing: distance of neighbouring posts (dx, dy) [m].
        seed: of the noise.
        hurst: Hurst exponent H, above 0 and at most 1; small is rough, 1 is smooth.
        rms_slope: root of the sum of the mean squares of the slopes between neighbouring posts,
            eastwards and northwards.

    Raises:
        ArgumentError: a parameter has a value that is not allowed.
    """
    x, y, rng = _setting(shape, spacing, seed)
    exponent = number("hurst", hurst, above=0.0, most=1.0) + 1.0
    number("rms_slope", rms_slope, above=0.0)
    ny, nx = len(y), len(x)
    spectrum = np.fft.rfft2(rng.standard_normal((ny, nx)))
    kx, ky = np.fft.rfftfreq(nx, spacing[0]), np.fft.fftfreq(ny, spacing[1])
    square = kx * kx + (ky * ky)[:, None]
    square[0, 0] = math.inf  # the mean height has no meaning
    spectrum *= square ** (-0.5 * exponent)
    heights = np.fft.irfft2(spectrum, s=(ny, nx))
    heights -= heights.min()
    heights *= rms_slope / _rms_slope(heights, spacing)
    return _terrain(heights, spacing, "fractal", seed)


def _rms_slope(heights: NDArray[np.float64], spacing: Pair) -> float:
    east = np.diff(heights, axis=1).ravel()
    north = np.diff(heights, axis=0).ravel()
    mean_squares = (east @ east) / east.size / spacing[0] ** 2 + (
        north @ north
    ) / north.size / spacing[1] ** 2
    return math.sqrt(mean_squares)


def _setting(
    shape: tuple[int, int], spacing: Pair, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], np.random.Generator]:
    """Return the positions of columns and rows [m] and the generator."""
    ny, nx = grid_shape("shape", shape)
    dx, dy = pair("spacing", spacing, above=0.0)
    rng = np.random.default_rng(whole("seed", seed, least=0))
    return dx * np.arange(nx, dtype=np.float64), dy * np.arange(ny, dtype=np.float64), rng


def _meander(
    s: NDArray[np.float64], period: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """A random smooth function with values in [-1, 1]: a few sine waves of `period` and longer."""
    frequency = rng.uniform(0.3, 1.0, _WAVES) / period if period > 0.0 else np.zeros(_WAVES)
    phase = rng.uniform(0.0, 2.0 * math.pi, _WAVES)
    weight = rng.uniform(0.2, 1.0, _WAVES)
    weight /= weight.sum()
    total = np.zeros_like(s)
    for w, f, p in zip(weight, frequency, phase, strict=True):
        total += w * np.sin(2.0 * math.pi * f * s + p)
    return total


def _terrain(heights: NDArray[np.float64], spacing: Pair, name: str, seed: int) -> Terrain:
    source = f"ompl_risk.terrains.parametric.{name}, seed {seed}"
    return Terrain(heights, spacing=spacing, name=name, source=source)
