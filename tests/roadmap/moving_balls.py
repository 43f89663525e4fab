"""Balls that move straight, in closed form: an oracle that shares nothing with the library."""

import math

import numpy as np


class Balls:
    """d(q, t) of balls at ``centres + velocities * t``; exact in every answer.

    Args:
        balls: (centre, velocity, radius) of each.
    """

    moves, static = True, None

    def __init__(self, *balls):
        self.centres = np.array([b[0] for b in balls], dtype=float)
        self.velocities = np.array([b[1] for b in balls], dtype=float)
        self.radii = np.array([b[2] for b in balls], dtype=float)

    def __call__(self, points, times):
        points, times = np.asarray(points, dtype=float), np.asarray(times, dtype=float)
        at = self.centres + times[:, None, None] * self.velocities
        return (np.linalg.norm(points[:, None] - at, axis=2) - self.radii).min(axis=1)

    def approach(self, a, ta, b, tb, *, tolerance=None):
        """Least distance along each motion: the distance to a ball is least where its square is."""
        a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        ta, tb = np.asarray(ta, dtype=float), np.asarray(tb, dtype=float)
        first = a[:, None] - self.centres - ta[:, None, None] * self.velocities
        last = b[:, None] - self.centres - tb[:, None, None] * self.velocities
        change = last - first
        square = (change**2).sum(axis=2)
        with np.errstate(invalid="ignore", divide="ignore"):
            s = np.where(square > 0.0, -(first * change).sum(axis=2) / square, 0.0)
        nearest = first + np.clip(s, 0.0, 1.0)[..., None] * change
        d = np.linalg.norm(nearest, axis=2) - self.radii
        which = d.argmin(axis=1), np.arange(len(a))
        share = np.clip(s, 0.0, 1.0)[which[::-1]]
        return d.min(axis=1), ta + share * (tb - ta)

    def are_free(self, a, ta, b, tb):
        return self.approach(a, ta, b, tb)[0] > 0.0

    def free_intervals(self, points, t0, t1, *, resolution=None):
        return [self._free(np.asarray(p, dtype=float), t0, t1) for p in points]

    def _free(self, point, t0, t1):
        taken = []
        for c, v, r in zip(self.centres, self.velocities, self.radii, strict=True):
            away = point - c
            A, B, C = v @ v, -2.0 * away @ v, away @ away - r * r
            if A == 0.0:
                taken += [(t0, t1)] if C <= 0.0 else []
            elif (root := B * B - 4.0 * A * C) >= 0.0:
                half = math.sqrt(root)
                taken.append(((-B - half) / (2 * A), (-B + half) / (2 * A)))
        spans, at = [], t0
        for low, high in sorted(taken):
            if low > at:
                spans.append((at, min(low, t1)))
            at = max(at, high)
            if at >= t1:
                break
        if at < t1:
            spans.append((at, t1))
        inside = [(lo + 1e-9, hi - 1e-9) for lo, hi in spans if hi - lo > 4e-9]
        return np.array(
            [(t0 if lo < t0 + 2e-9 else lo, t1 if hi > t1 - 2e-9 else hi) for lo, hi in inside]
        ).reshape(-1, 2)
