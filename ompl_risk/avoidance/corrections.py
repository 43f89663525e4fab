"""Integrands that know more of the ground than its distance: its slope and its curvature.

Functions of arrays of one shape, or that broadcast to one:

- d: distance [m] to the nearest ground;
- up: upward component of the gradient of d, the cosine of the slope there, 1 over level ground;
- curvature: half the Laplacian of the map's height there [1/m], positive in a bowl.

As an ``Avoidance``, each is +inf for d <= 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats, positive, real_number
from ompl_risk.avoidance.base import checked_distance
from ompl_risk.avoidance.flat_cap import FlatCap
from ompl_risk.avoidance.gaussian_tail import REACH, upper_tail
from ompl_risk.errors import ArgumentError


def surface_curvature(up: ArrayLike, curvature: ArrayLike) -> FloatArray:
    """Mean curvature of the ground [1/m], positive in a bowl.

        H = curvature up (1 + up^2) / 2

    That of ``z = h(x, y)`` is ``((1 + h_y^2) h_xx - 2 h_x h_y h_xy + (1 + h_x^2) h_yy) /
    (2 (1 + h_x^2 + h_y^2)^(3/2))`` with ``up = (1 + h_x^2 + h_y^2)^(-1/2)``. The second
    derivatives count as the same in all directions, ``h_xx = h_yy = curvature`` and ``h_xy = 0``.
    """
    up, curvature = _finite("up", up), _finite("curvature", curvature)
    return 0.5 * curvature * up * (1.0 + up * up)


def corrected_cap(
    d: ArrayLike, up: ArrayLike, curvature: ArrayLike, *, r: float = 100.0
) -> FloatArray:
    """The share of a ball that lies below curved ground, to the first order in r H.

        f = FlatCap(r)(d) + 3/16 r H (1 - (d/r)^2)^2,   between 0 and 1, and 0 for d >= r

    Seen along the normal of the nearest point, the ground is ``w = (k1 u^2 + k2 v^2) / 2`` above
    its tangent plane, with ``k1 + k2 = 2 H``. The ball cuts a disk of radius ``a``,
    ``a^2 = r^2 - d^2``, out of that plane, and what lies between plane and ground has the volume
    ``integral of w over the disk = pi H a^4 / 4``, up to second order. Divided by the volume of
    the ball, ``4 pi r^3 / 3``, that is the second term. The slope enters by H alone: a ball has no
    top and no bottom.

    Args:
        d: distance [m].
        up: see above.
        curvature: see above.
        r: radius of the ball [m].

    Raises:
        ArgumentError: r is not a positive number, or a NaN.
    """
    flat, mean = FlatCap(r), surface_curvature(up, curvature)
    d = checked_distance(d)
    x = np.clip(d / flat.r, 0.0, 1.0)
    more = 0.1875 * flat.r * mean * (1.0 - x * x) ** 2
    share = np.clip(flat(np.maximum(d, np.finfo(float).tiny)) + more, 0.0, 1.0)
    return np.where(d <= 0, np.inf, share)[()]


def corrected_tail(
    d: ArrayLike,
    up: ArrayLike,
    curvature: ArrayLike,
    *,
    vertical: float,
    isotropic: float = 0.0,
) -> FloatArray:
    """The probability of collision for errors of the map's height and of the position.

        f = Q((d - isotropic^2 H) / sigma) - Q(4),   sigma^2 = isotropic^2 + (vertical up)^2,

    where that is positive, else 0. Ground that is higher by e is nearer by ``e up``, but for its
    curvature. An error of the position moves the distance by its component along the normal; the
    other two, u and v along the ground, bring ground of curvatures k1 and k2 nearer by
    ``(k1 u^2 + k2 v^2) / 2``, whose mean is ``isotropic^2 H``. The shift by that mean is all that
    there is of the first order in H: ``Q(x) + isotropic^2 H phi(x) / sigma``, x = d / sigma.

    Args:
        d: distance [m].
        up: see above.
        curvature: see above.
        vertical: standard deviation of the map's height [m], 0 or more.
        isotropic: standard deviation of the position in each direction [m], 0 or more.

    Raises:
        ArgumentError: a negative deviation, both are 0, or a NaN.

    Reference:
        Breitung, Asymptotic Approximations for Multinormal Integrals, 1984, where d is large:
        ``Q(x) / sqrt((1 - k1 d) (1 - k2 d))``, the same to the first order in H since
        ``phi(x) = x Q(x)`` then.
    """
    up, mean, d = _finite("up", up), surface_curvature(up, curvature), checked_distance(d)
    vertical, isotropic = _deviation("vertical", vertical), _deviation("isotropic", isotropic)
    positive("vertical + isotropic", vertical + isotropic)
    sigma = np.hypot(isotropic, vertical * up)
    with np.errstate(divide="ignore", invalid="ignore"):
        tail = upper_tail((d - isotropic**2 * mean) / sigma) - upper_tail(REACH)
    return np.where(d <= 0, np.inf, np.where(sigma > 0, np.maximum(tail, 0.0), 0.0))[()]


def _finite(name: str, value: ArrayLike) -> FloatArray:
    array = as_floats(name, value)
    if not np.isfinite(array).all():
        raise ArgumentError(name, float(array[~np.isfinite(array)].flat[0]), "finite numbers")
    return array


def _deviation(name: str, value: float) -> float:
    number = real_number(name, value, "a finite number of 0 or more")
    if not 0.0 <= number < np.inf:
        raise ArgumentError(name, value, "a finite number of 0 or more")
    return number
