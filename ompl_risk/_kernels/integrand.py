"""The functions f(d) that compiled code knows, by the numbers that tell one from another.

They are convex on (0, far), and 0 from there on.
"""

from __future__ import annotations

import math

from ompl_risk._kernels.jit import entry, kernel

# places in the parameters, which begin with these numbers
FAR, KIND, SCALE, OFFSET, STEADY = range(5)
NUMBERS = 5
"""Numbers that tell f: where it ends [m] (0 if f is 0), its kind, its length [m], what is taken
off, and the length [m] over which it changes by a good part, 0 where that is d."""

# kinds
INVERSE, CAP, TAIL = 0.0, 1.0, 2.0
"""``1/d``, ``(1 - x)^2 (2 + x) / 4`` with x = d / scale, and ``erfc(d / scale) / 2``, each less
the offset."""

PARTS = 8
"""Parts of a way for a lower bound without a closed form."""

SHORT = 1e-3
"""Ways shorter than this share of the clearance would be lost in the rounding of closed forms."""

ROOT_PI = math.sqrt(math.pi)


@kernel
def avoid(d, given):
    """f(d) for d > 0."""
    if not d < given[FAR]:
        return 0.0
    kind = given[KIND]
    if kind == INVERSE:
        return 1.0 / d - given[OFFSET]
    x = d / given[SCALE]
    if kind == CAP:
        return 0.25 * (1.0 - x) * (1.0 - x) * (2.0 + x)
    return max(0.5 * math.erfc(x) - given[OFFSET], 0.0)


@kernel
def bends(d, given):
    """The first two derivatives of f at d > 0."""
    if not d < given[FAR]:
        return 0.0, 0.0
    kind, scale = given[KIND], given[SCALE]
    if kind == INVERSE:
        x = 1.0 / d
        return -x * x, 2.0 * x * x * x
    x = d / scale
    if kind == CAP:
        return -0.75 * (1.0 - x) * (1.0 + x) / scale, 1.5 * x / (scale * scale)
    slope = -math.exp(-x * x) / (scale * ROOT_PI)
    return slope, -2.0 * x * slope / scale


@kernel
def reach(near, given):
    """Length [m] over which f changes by a good part where clearances are ``near`` or more."""
    return given[STEADY] if given[STEADY] > 0.0 else near


@kernel
def least_integral(d, s, p, given):
    """Lower bound for the integral of f^p over the first s metres of any way from clearance d.

    No way leaves obstacles faster than straight away from them. f^p is convex: over a part of that
    way its mean is at least its value in the middle. Most of the integral lies near obstacles, and
    parts are shorter there.
    """
    far = given[FAR]
    s = min(s, far - d)
    if s <= 0.0:
        return 0.0
    x = d + s
    exact = given[KIND] == INVERSE and s > SHORT * d
    if exact and p == 1.0:
        return max(math.log(x / d) - s / far, 0.0)
    if exact and p == 2.0:
        return max(1.0 / d - 1.0 / x - 2.0 * math.log(x / d) / far + s / (far * far), 0.0)
    total = 0.0
    begin = 0.0
    for k in range(1, PARTS + 1):
        end = (k / PARTS) ** 2
        total += (end - begin) * avoid(d + 0.5 * s * (begin + end), given) ** p
        begin = end
    return total * s


@entry
def values(d, given, out):
    """``out[k]`` = f(d[k]), d > 0."""
    for k in range(len(d)):
        out[k] = avoid(d[k], given)


@entry
def tangents(d, given, low, scale, f, slope, bend):
    """f(d) / scale and its first two derivatives; below d = low > 0 it goes on straight."""
    for k in range(len(d)):
        at = max(d[k], low)
        first, second = bends(at, given)
        slope[k] = first / scale
        f[k] = avoid(at, given) / scale + slope[k] * min(d[k] - low, 0.0)
        bend[k] = second / scale if d[k] > low else 0.0
