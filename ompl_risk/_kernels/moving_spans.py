"""When a place is blocked by moving obstacles."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.moving import CORNER, ROUND, row_at, row_end
from ompl_risk._kernels.moving_motions import DEPTH, LEAST_SHARE, beyond_sweep, origin_distance
from ompl_risk._kernels.moving_pieces import END, end_at, highest, lowest


@kernel
def _row_spans(tracks, j, k, p, t0, t1, radius, resolution, stack, spans, count):
    """Append the spans of a row during which the place p is not certainly free; the new count.

    A span that begins where the last one ends prolongs it. Returns -1 where ``spans`` is full.
    """
    x, y, z = p[0], p[1], p[2]
    finite = t1 < math.inf
    near, speed = origin_distance(tracks, k, t0, t1 if finite else t0, x, y, z, 0.0, 0.0, 0.0)
    if near - tracks.sizes[j, CORNER] - tracks.sizes[j, ROUND] > radius:
        return count
    e0 = end_at(tracks, j, k, t0, x, y, z)
    if speed == 0.0 and tracks.rates[k] == 0.0:
        return count if e0[1] > radius else _append(spans, count, t0, t1)
    stack[0] = end_at(tracks, j, k, t1, x, y, z)
    top = 1
    while top > 0:
        e1 = stack[top - 1]
        bound, split = lowest(tracks, j, k, speed, e0, e1)
        settled = bound > radius
        if not settled:
            if e0[1] <= radius or e1[1] <= radius:
                split = 0.5
            h = e1[0] - e0[0]
            t = e0[0] + min(max(split, LEAST_SHARE), 1.0 - LEAST_SHARE) * h
            blocked = highest(tracks, j, k, speed, e0, e1) <= radius
            settled = blocked or h <= resolution or not e0[0] < t < e1[0] or top == len(stack)
            if settled:
                count = _append(spans, count, e0[0], e1[0])
                if count < 0:
                    return count
            else:
                stack[top] = end_at(tracks, j, k, t, x, y, z)
                top += 1
        if settled:
            e0 = (e1[0], e1[1], e1[2], e1[3], e1[4], e1[5], e1[6], e1[7])
            top -= 1
    return count


@kernel
def _append(spans, count, begin, end):
    if count > 0 and spans[count - 1, 1] >= begin:
        spans[count - 1, 1] = max(spans[count - 1, 1], end)
        return count
    if count == len(spans):
        return -1
    spans[count, 0], spans[count, 1] = begin, end
    return count + 1


@kernel
def _obstacle_spans(tracks, j, p, t0, t1, radius, resolution, stack, spans):
    """Fill ``spans`` with those of obstacle j; how many, or -1 where there is no room for them."""
    if beyond_sweep(tracks, j, p, p) > radius:
        return 0
    count, k, begin = 0, row_at(tracks, j, t0), t0
    while True:
        end = min(row_end(tracks, j, k), t1)
        count = _row_spans(tracks, j, k, p, begin, end, radius, resolution, stack, spans, count)
        if count < 0 or end >= t1:
            return count
        k, begin = k + 1, end


@entry
def blocked_spans(tracks, first, last, points, t0, t1, radius, resolution):
    """Spans from t0 to t1 in which places may be within ``radius`` of obstacles first to last - 1.

    Returns:
        The place and the begin and end of each span, sorted by place, then by obstacle and time.
    """
    stack, spans = np.empty((DEPTH, END)), np.empty((64, 2))
    owners, found, total = np.empty(64, np.int64), np.empty((64, 2)), 0
    for i in range(len(points)):
        for j in range(first, last):
            count = -1
            while True:
                count = _obstacle_spans(
                    tracks, j, points[i], t0, t1, radius, resolution, stack, spans
                )
                if count >= 0:
                    break
                spans = np.empty((2 * len(spans), 2))
            while total + count > len(found):
                owners = np.concatenate((owners, np.empty(len(owners), np.int64)))
                found = np.concatenate((found, np.empty((len(found), 2))))
            owners[total : total + count] = i
            found[total : total + count] = spans[:count]
            total += count
    return owners[:total], found[:total]


@entry
def free_spans(owners, spans, count, t0, t1, first, out):
    """The rest of [t0, t1]: ``out[first[i]:first[i + 1]]`` are begin and end of place i's spans.

    Args:
        owners: place of each blocked span, in ascending order, shape (m,).
        spans: begin and end of each, in ascending order of begin within a place, shape (m, 2).
        count: number of places.
        t0, t1: what the rest is taken of.
        first: filled, shape (count + 1,).
        out: filled, shape (m + count, 2).
    """
    k, total = 0, 0
    for i in range(count):
        first[i] = total
        begin = t0
        while k < len(owners) and owners[k] == i:
            if spans[k, 0] > begin:
                out[total, 0], out[total, 1] = begin, spans[k, 0]
                total += 1
            begin = max(begin, spans[k, 1])
            k += 1
        if begin < t1:
            out[total, 0], out[total, 1] = begin, t1
            total += 1
    first[count] = total
