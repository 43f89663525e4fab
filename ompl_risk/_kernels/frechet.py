"""Discrete Frechet distance."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry


@entry
def discrete_frechet(a, b):
    """Discrete Frechet distance of two polylines by dynamic programming, one row at a time.

        c(i, j) = max(|a_i - b_j|, min(c(i-1, j), c(i-1, j-1), c(i, j-1)))

    Args:
        a: points, shape (n, k).
        b: points, shape (m, k); memory is O(m).

    Returns:
        c(n-1, m-1).
    """
    n, m, k = a.shape[0], b.shape[0], a.shape[1]
    row = np.full(m, math.inf)  # c(i-1, .), squared; overwritten by c(i, .) from the left
    for i in range(n):
        diagonal = math.inf if i > 0 else -math.inf  # -inf: nothing stands before the first pair
        left = math.inf
        for j in range(m):
            squared = 0.0
            for axis in range(k):
                difference = a[i, axis] - b[j, axis]
                squared += difference * difference
            above = row[j]
            left = max(squared, min(above, diagonal, left))
            row[j] = left
            diagonal = above
    return math.sqrt(row[m - 1])
