"""Which rays a path crosses, in what order and which way."""

from __future__ import annotations

import numpy as np

from ompl_risk._kernels.jit import entry


@entry
def crossings(points, first, peaks):
    """Reduced words of the rays that paths cross.

    All rays point along the first axis. A path that crosses ray k counts k + 1 where the second
    coordinate grows and -(k + 1) where it falls; what is followed by its opposite cancels. A
    point level with a ray counts as below it, and of rays at one level the first is the lowest:
    so no touch counts and no crossing counts twice.

    Args:
        points: of all paths, one after the other, shape (n, 2).
        first: path p has the points first[p] to first[p + 1], shape (p + 1,).
        peaks: where the rays begin, sorted by their second coordinate, shape (k, 2).

    Returns:
        letters, and where each path's begin among them, as ``first``.
    """
    level = np.ascontiguousarray(peaks[:, 1])
    letters = np.empty(1024, np.int32)
    begin = np.zeros(len(first), np.int64)
    size = 0
    for p in range(len(first) - 1):
        start = size
        for i in range(first[p] + 1, first[p + 1]):
            s0, t0, s1, t1 = points[i - 1, 0], points[i - 1, 1], points[i, 0], points[i, 1]
            if t0 == t1:
                continue
            up = t1 > t0
            lowest = np.searchsorted(level, min(t0, t1), side="left")
            beyond = np.searchsorted(level, max(t0, t1), side="left")
            for n in range(beyond - lowest):
                k = lowest + n if up else beyond - 1 - n
                if s0 + (level[k] - t0) / (t1 - t0) * (s1 - s0) <= peaks[k, 0]:
                    continue
                letter = k + 1 if up else -(k + 1)
                if size > start and letters[size - 1] == -letter:
                    size -= 1
                    continue
                if size == len(letters):
                    letters = np.append(letters, np.empty(size, np.int32))
                letters[size] = letter
                size += 1
        begin[p + 1] = size
    return letters[:size], begin
