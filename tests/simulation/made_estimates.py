"""Estimates made of given hits."""

from __future__ import annotations

import numpy as np

from ompl_risk.simulation.estimates.estimate import CollisionEstimate


def estimate(hits, name: str = "A", **rest) -> CollisionEstimate:
    """With given rollouts that collide, at 1, 2, 3 ... s and metres east."""
    hits = np.asarray(hits, dtype=bool)
    n = len(hits)
    when = np.arange(1.0, n + 1.0)
    where = np.column_stack([when, np.zeros(n), np.zeros(n)])
    rest = {"seed": 3} | rest
    least = np.where(hits, -1.0, when)
    return CollisionEstimate(name, least, when, where, np.where(hits, when, np.inf), **rest)


def some(hits: int, n: int, **rest) -> CollisionEstimate:
    return estimate(np.arange(n) < hits, **rest)
