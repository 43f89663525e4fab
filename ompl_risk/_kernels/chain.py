"""Second derivatives of a path's risk by its corners, and Newton steps from them.

Every term couples neighbouring corners only, so the matrix is block-tridiagonal: ``diagonal[e]``
belongs to corner e and ``coupling[e]`` to the rows of corner e + 1 and the columns of corner e,
3 x 3 each; shapes (n, 3, 3) and (n - 1, 3, 3). Samples and weights are those of ``refine``.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry, kernel

FAINT = 1e-3
"""Where f^(p - 2) has a pole (p < 2) it is taken at this f instead; f is scaled to about 1."""


@kernel
def _piece_curvature(f0, f1, dt, p, tau):
    """Second derivatives of the same by f0 f0, f0 f1 and f1 f1."""
    steep = 2.0 * tau * tau / dt
    if p == 1.0:
        return steep, -steep, steep
    if p == 2.0:
        return dt * 2.0 / 3.0 + steep, dt / 3.0 - steep, dt * 2.0 / 3.0 + steep
    least = FAINT if p < 2.0 else 0.0
    both = max(0.5 * (f0 + f1), least) ** (p - 2.0)
    factor = dt * p * (p - 1.0) / 6.0
    return (
        factor * (max(f0, least) ** (p - 2.0) + both) + steep,
        factor * both - steep,
        factor * (max(f1, least) ** (p - 2.0) + both) + steep,
    )


@entry
def stiffen(counts, stiffness, normals, diagonal, coupling):
    """Add the second derivatives of terms with second derivative ``stiffness`` by a sample's d."""
    j = 0
    for e in range(len(counts)):
        for k in range(counts[e]):
            w, s = k / counts[e], stiffness[j]
            if s > 0.0:
                _add(diagonal[e], (1.0 - w) * (1.0 - w) * s, normals[j], normals[j])
                _add(diagonal[e + 1], w * w * s, normals[j], normals[j])
                _add(coupling[e], w * (1.0 - w) * s, normals[j], normals[j])
            j += 1
    _add(diagonal[-1], stiffness[j], normals[j], normals[j])


@entry
def couple(f, slope, counts, durations, p, tau, normals, diagonal, coupling):
    """Add the Gauss-Newton second derivatives of ``path_risk``: those by f, d taken as linear."""
    j = 0
    for e in range(len(counts)):
        m = counts[e]
        for k in range(m):
            if f[j] > 0.0 or f[j + 1] > 0.0:
                c00, c01, c11 = _piece_curvature(f[j], f[j + 1], durations[e] / m, p, tau)
                a, b = normals[j], normals[j + 1]
                c00, c11 = c00 * slope[j] * slope[j], c11 * slope[j + 1] * slope[j + 1]
                c01 *= slope[j] * slope[j + 1]
                v, w = k / m, (k + 1) / m
                _add_pair(diagonal[e], 1.0 - v, 1.0 - w, 1.0 - v, 1.0 - w, c00, c01, c11, a, b)
                _add_pair(diagonal[e + 1], v, w, v, w, c00, c01, c11, a, b)
                _add_pair(coupling[e], v, w, 1.0 - v, 1.0 - w, c00, c01, c11, a, b)
            j += 1


@kernel
def _add(block, factor, a, b):
    """``block += factor a b^T``."""
    for i in range(3):
        for k in range(3):
            block[i, k] += factor * a[i] * b[k]


@kernel
def _add_pair(block, v0, v1, w0, w1, c00, c01, c11, a, b):
    """Add c00, c01, c11 between two samples, whose rows weigh v0, v1 and whose columns w0, w1."""
    aa, bb, ab, ba = c00 * v0 * w0, c11 * v1 * w1, c01 * v0 * w1, c01 * v1 * w0
    for i in range(3):
        for k in range(3):
            block[i, k] += aa * a[i] * a[k] + bb * b[i] * b[k] + ab * a[i] * b[k] + ba * b[i] * a[k]


@entry
def solve_chain(diagonal, coupling, fixed, right, out):
    """Solve the block-tridiagonal system by Cholesky's method; first and last corner stay.

    Args:
        diagonal, coupling: the matrix, see the module; only lower triangles of ``diagonal`` count.
        fixed: coordinates that stay, shape (n, 3).
        right: right-hand sides, shape (k, n, 3).
        out: solutions, 0 where fixed; shape (k, n, 3).

    Returns:
        Whether the matrix is positive definite; if not, ``out`` is worth nothing.
    """
    n = len(diagonal)
    factor, below = np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
    out[:] = 0.0
    for e in range(1, n - 1):
        block, row = diagonal[e].copy(), coupling[e - 1].copy()
        for i in range(3):
            if e == 1 or fixed[e, i]:
                row[i] = 0.0
            if fixed[e, i]:
                block[i] = 0.0
                block[:, i] = 0.0
                block[i, i] = 1.0
            if fixed[e - 1, i]:
                row[:, i] = 0.0
        if e > 1:
            _divide(row, factor[e - 1], below[e])
        for i in range(3):
            for k in range(3):
                for c in range(3):
                    block[i, k] -= below[e, i, c] * below[e, k, c]
        if not _factorise(block, factor[e]):
            return False
        for r in range(len(right)):
            for i in range(3):
                value = 0.0 if fixed[e, i] else right[r, e, i]
                for c in range(3):
                    value -= below[e, i, c] * out[r, e - 1, c]
                for c in range(i):
                    value -= factor[e, i, c] * out[r, e, c]
                out[r, e, i] = value / factor[e, i, i]
    _substitute_back(factor, below, out)
    return True


@kernel
def _substitute_back(factor, below, out):
    """Second half of the solution."""
    n = len(factor)
    for r in range(len(out)):
        for e in range(n - 2, 0, -1):
            for i in range(2, -1, -1):
                value = out[r, e, i]
                for c in range(3):
                    value -= below[e + 1, c, i] * out[r, e + 1, c]
                for c in range(i + 1, 3):
                    value -= factor[e, c, i] * out[r, e, c]
                out[r, e, i] = value / factor[e, i, i]


@kernel
def _divide(row, factor, out):
    """``out = row factor^-T`` for a lower triangular factor."""
    for i in range(3):
        for k in range(3):
            value = row[i, k]
            for c in range(k):
                value -= out[i, c] * factor[k, c]
            out[i, k] = value / factor[k, k]


@kernel
def _factorise(block, out):
    """Cholesky factor of a block; false if it is not positive definite."""
    for i in range(3):
        for k in range(i + 1):
            value = block[i, k]
            for c in range(k):
                value -= out[i, c] * out[k, c]
            if i == k:
                if not value > 0.0:
                    return False
                out[i, i] = math.sqrt(value)
            else:
                out[i, k] = value / out[k, k]
    return True
