"""Risk of a finely sampled path over a height field, and its gradient.

A path is a chain of n corners; its leg e, from corner e to e + 1, is cut into ``counts[e]`` equal
pieces, whose ends are the samples. Sample j lies at a fraction w of its leg, so a push on it moves
the corner before by 1 - w and the corner after by w.
"""

from __future__ import annotations

import math

from ompl_risk._kernels.height_field import opened
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.nearest import inside, nearest, surface_height, workspace


@entry
def place_samples(corners, counts, out):
    """``out[j]`` = position of sample j, shape (sum of counts + 1, 3)."""
    j = 0
    for e in range(len(counts)):
        for k in range(counts[e]):
            w = k / counts[e]
            for c in range(3):
                # in this form samples between corners on the map's edge lie on it
                out[j, c] = corners[e, c] + w * (corners[e + 1, c] - corners[e, c])
            j += 1
    out[j] = corners[-1]


@entry
def distances_and_normals(handle, points, radius, bound, d, normals):
    """Clearances as in ``signed_distances``, and their gradients.

    A gradient is the unit vector away from the nearest surface point (towards it below ground);
    zero where d has reached the bound or nothing is known of the ground.
    """
    field, (stack, keys) = opened(handle), workspace()
    for j in range(len(points)):
        x, y, z = points[j, 0], points[j, 1], points[j, 2]
        normals[j] = 0.0
        if not inside(field, x, y):
            d[j] = -math.inf
            continue
        above = z >= surface_height(field, x, y)
        reach = bound + radius if above else math.inf
        square, qx, qy, qz = nearest(field, x, y, z, reach, stack, keys)
        distance = math.sqrt(square) if above else -math.sqrt(square)
        d[j] = distance - radius
        if distance != 0.0 and not math.isnan(qx):
            normals[j, 0], normals[j, 1] = (x - qx) / distance, (y - qy) / distance
            normals[j, 2] = (z - qz) / distance


@kernel
def _piece(f0, f1, dt, p, tau):
    """Integral of f^p + tau^2 f'^2 over a piece, and its derivatives by f0, f1 and dt."""
    rate = tau * (f1 - f0) / dt
    if p == 2.0:
        mean = (f0 * f0 + f0 * f1 + f1 * f1) / 3.0
        by0, by1 = dt * (2.0 * f0 + f1) / 3.0, dt * (f0 + 2.0 * f1) / 3.0
    elif p == 1.0:
        mean, by0, by1 = 0.5 * (f0 + f1), 0.5 * dt, 0.5 * dt
    else:
        f = 0.5 * (f0 + f1)
        mean = (f0**p + 4.0 * f**p + f1**p) / 6.0
        q = p - 1.0
        by0, by1 = dt * p * (f0**q + 2.0 * f**q) / 6.0, dt * p * (2.0 * f**q + f1**q) / 6.0
    steep = 2.0 * tau * rate
    return dt * (mean + rate * rate), by0 - steep, by1 + steep, mean - rate * rate


@entry
def path_risk(f, counts, durations, p, tau, by_f, by_duration):
    """The p-th power of the norm, and its derivatives.

    Args:
        f: avoidance at the samples.
        counts: pieces of each leg, shape (n - 1,).
        durations: of each leg [s], positive, shape (n - 1,).
        p, tau: of the norm; tau = 0 for L^p.
        by_f: derivatives by f at each sample, written.
        by_duration: derivatives by the legs' durations, f held, written.
    """
    by_f[:] = 0.0
    total, j = 0.0, 0
    for e in range(len(counts)):
        m = counts[e]
        by_duration[e] = 0.0
        for _ in range(m):
            if f[j] > 0.0 or f[j + 1] > 0.0:
                share, by0, by1, by_dt = _piece(f[j], f[j + 1], durations[e] / m, p, tau)
                total += share
                by_f[j] += by0
                by_f[j + 1] += by1
                by_duration[e] += by_dt / m
            j += 1
    return total


@entry
def spread(counts, push, normals, gradient):
    """Add to the gradient by the corners; ``push`` are the derivatives by d at the samples."""
    j = 0
    for e in range(len(counts)):
        for k in range(counts[e]):
            w = k / counts[e]
            for c in range(3):
                gradient[e, c] += (1.0 - w) * push[j] * normals[j, c]
                gradient[e + 1, c] += w * push[j] * normals[j, c]
            j += 1
    for c in range(3):
        gradient[-1, c] += push[j] * normals[j, c]
