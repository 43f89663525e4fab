"""Discrete Frechet distance."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry, kernel


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
    return math.sqrt(squared_frechet(a, b, math.inf, np.empty(len(b))))


@kernel
def squared_frechet(a, b, bound, row):
    """The distance squared, inf if that exceeds ``bound``.

    Pairs that are farther apart than the bound cannot be passed, so only the columns that can
    still be reached are visited, and none once there are none.

    Args:
        a: points, shape (n, k).
        b: points, shape (m, k).
        bound: the distance squared up to which it matters.
        row: work space, shape (m,) or more.
    """
    n, m = a.shape[0], b.shape[0]
    low, high = 0, 0  # row[low:high] is c(i-1, .), squared; inf to either side
    for i in range(n):
        diagonal = math.inf if i > 0 else -math.inf  # -inf: nothing stands before the first pair
        left = math.inf
        first, last = m, 0
        for j in range(low, m):
            above = row[j] if j < high else math.inf
            before = min(above, diagonal, left)
            left = math.inf
            if before < math.inf:
                apart = max(before, squared(a, i, b, j))
                if apart <= bound:
                    left = apart
                    first, last = min(first, j), j + 1
            elif j >= high:
                break
            row[j] = left
            diagonal = above
        if last == 0:
            return math.inf
        low, high = first, last
    return row[m - 1] if high == m else math.inf


@kernel
def squared_greedy(a, b, bound):
    """Upper bound for the same, in linear time: of the next three pairs, always take the nearest.

    Ends early, with an incomplete value, once that exceeds ``bound``.
    """
    n, m = a.shape[0] - 1, b.shape[0] - 1
    i, j = 0, 0
    most = squared(a, 0, b, 0)
    while (i < n or j < m) and most <= bound:
        both = squared(a, min(i + 1, n), b, min(j + 1, m))
        one = squared(a, i + 1, b, j) if i < n else math.inf
        other = squared(a, i, b, j + 1) if j < m else math.inf
        least = min(both, one, other)
        if both == least:
            i, j = min(i + 1, n), min(j + 1, m)
        elif one == least:
            i += 1
        else:
            j += 1
        most = max(most, least)
    return most


@kernel
def are_near(a, b, every, bound):
    """Whether every so many points of a have one of b within ``bound``, a distance squared.

    If not, the Frechet distance exceeds it. The search begins at the partner of the point before.
    """
    m, j = b.shape[0], 0
    for i in range(0, a.shape[0], every):
        up, down = j, j - 1
        while up < m or down >= 0:
            if up < m:
                if squared(a, i, b, up) <= bound:
                    j = up
                    break
                up += 1
            if down >= 0:
                if squared(a, i, b, down) <= bound:
                    j = down
                    break
                down -= 1
        else:
            return False
    return True


@kernel
def squared(a, i, b, j):
    """Distance of a_i and b_j, squared."""
    total = 0.0
    for axis in range(a.shape[1]):
        difference = a[i, axis] - b[j, axis]
        total += difference * difference
    return total
