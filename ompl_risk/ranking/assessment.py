"""What is known about the risk of one trajectory."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np

from ompl_risk._arrays import FloatArray, ReadOnlyArrays
from ompl_risk.avoidance import Avoidance
from ompl_risk.norms import Norm
from ompl_risk.ranking.attribution import Attribution, Attributions
from ompl_risk.ranking.sampling import Clearance, Samples, sample, sample_uniformly
from ompl_risk.trajectory import Trajectory


class Profile(Protocol):
    """A probability of collision along a trajectory."""

    @property
    def t(self) -> FloatArray:
        """Times [s], shape (n,)."""
        ...

    @property
    def p(self) -> FloatArray:
        """Probabilities, shape (n,)."""
        ...


class Estimate(Protocol):
    """A probability that the whole trajectory ends in collision, as from closed-loop rollouts."""

    @property
    def probability(self) -> float:
        """The estimate."""
        ...

    @property
    def low(self) -> float:
        """Lower end of its interval."""
        ...

    @property
    def high(self) -> float:
        """Upper end of its interval."""
        ...


@dataclass(frozen=True, eq=False)
class Assessment(ReadOnlyArrays):
    """The risk along one trajectory.

    Args:
        trajectory: the trajectory with the samples at which the distance was evaluated, n of them.
        d: signed distances to obstacles [m], shape (n,).
        f: avoidance function, in its unit, shape (n,); inf in a collision.
        norms: norm of f by label.
        attribution: where each norm comes from, by label; None for a norm that is 0 or infinite.
        pc_norms: the same norms of the probability of collision, by label, if one was given.
        estimate: probability that the whole trajectory ends in collision, if one was given.
    """

    trajectory: Trajectory
    d: FloatArray
    f: FloatArray
    norms: Mapping[str, float]
    attribution: Mapping[str, Attribution | None]
    pc_norms: Mapping[str, float] = field(default_factory=dict)
    estimate: Estimate | None = None

    @property
    def name(self) -> str:
        """Name of the trajectory."""
        return self.trajectory.name

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.trajectory.duration

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.trajectory.length

    @property
    def min_clearance(self) -> float:
        """Least signed distance to obstacles [m]."""
        return float(self.d[self._closest])

    @property
    def min_clearance_time(self) -> float:
        """When the distance is least, for the first time [s]."""
        return float(self.trajectory.t[self._closest])

    @property
    def min_clearance_position(self) -> FloatArray:
        """Where the distance is least [m], shape (3,)."""
        return self.trajectory.positions[self._closest]

    @property
    def collides(self) -> bool:
        """Whether the body touches or is inside an obstacle at a sample."""
        return self._first_collision is not None

    @property
    def collision_time(self) -> float | None:
        """Time of the first sample in collision [s], or None."""
        i = self._first_collision
        return None if i is None else float(self.trajectory.t[i])

    @property
    def collision_position(self) -> FloatArray | None:
        """Position of the first sample in collision [m], shape (3,), or None."""
        i = self._first_collision
        return None if i is None else self.trajectory.positions[i]

    @cached_property
    def _closest(self) -> int:
        return int(np.argmin(self.d))

    @cached_property
    def _first_collision(self) -> int | None:
        inside = np.flatnonzero(self.d <= 0)
        return int(inside[0]) if len(inside) else None


def assess(
    trajectory: Trajectory,
    clearance: Clearance,
    avoidance: Avoidance,
    norms: tuple[Norm, ...],
    *,
    max_step: float | None,
    window_share: float,
    profile: Profile | None = None,
    estimate: Estimate | None = None,
) -> Assessment:
    """Sample d and f along a trajectory and take every norm; see `rank` for the arguments."""
    samples = sample(trajectory, clearance, avoidance, max_step)
    uniform = samples
    if max_step is not None and any(norm.needs_uniform_times for norm in norms):
        uniform = sample_uniformly(trajectory, clearance, avoidance, len(samples.d))
    suited = {norm.label: uniform if norm.needs_uniform_times else samples for norm in norms}
    values = {norm.label: _norm(norm, suited[norm.label], samples) for norm in norms}
    parts = {
        norm.label: None if math.isinf(values[norm.label]) else (norm, suited[norm.label])
        for norm in norms
    }
    return Assessment(
        samples.trajectory,
        samples.d,
        samples.f,
        values,
        Attributions(parts, window_share),
        {} if profile is None else {norm.label: _pc_norm(norm, profile) for norm in norms},
        estimate,
    )


def _pc_norm(norm: Norm, profile: Profile) -> float:
    """The norm of P_c(t), at equal steps if the norm needs them."""
    t, p = np.asarray(profile.t), np.asarray(profile.p)
    if norm.needs_uniform_times:
        equal = np.linspace(t[0], t[-1], len(t))
        t, p = equal, np.interp(equal, t, p)
    return norm(t, p)


def _norm(norm: Norm, suited: Samples, samples: Samples) -> float:
    # A collision that the adaptive samples have found counts for every norm.
    if math.isinf(samples.f.max()):
        return math.inf
    return norm(suited.trajectory.t, suited.f)
