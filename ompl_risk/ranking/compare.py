"""Rank trajectories: the entry point."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

from ompl_risk._arrays import positive, real_number
from ompl_risk.avoidance import Avoidance
from ompl_risk.errors import ArgumentError, DurationWarning
from ompl_risk.norms import Lp, Norm, Sobolev
from ompl_risk.ranking.assessment import Assessment, Estimate, Profile, assess
from ompl_risk.ranking.probabilities import given_probabilities
from ompl_risk.ranking.result import Ranking
from ompl_risk.ranking.sampling import Clearance
from ompl_risk.ranking.sharing import each, shared_out
from ompl_risk.trajectory import Trajectory

DEFAULT_NORMS: tuple[Norm, ...] = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))
"""The four norms of the paper."""

Probability: TypeAlias = Profile | Estimate | tuple[Profile | Estimate, ...]
"""What is known of a trajectory's probability of collision."""


def rank(
    trajectories: Iterable[Trajectory],
    clearance: Clearance,
    avoidance: Avoidance,
    norms: Iterable[Norm] = DEFAULT_NORMS,
    *,
    duration_tolerance: float = 0.05,
    max_step: float | str | None = "auto",
    window_share: float = 0.5,
    probability: Mapping[str, Probability] | Sequence[Probability] | None = None,
) -> Ranking:
    """Rank trajectories from safest to riskiest by the norms of f(t) = avoidance(clearance(x(t))).

    The samples given may be corners far apart. Each trajectory is straight between them, and
    samples are inserted until no step is longer than `max_step`, nor, where an obstacle is
    within d0, than a tenth of the distance to it, because f changes on that scale (down to steps
    of d0 / 10,000). Where f is bounded and so changes less, up to a quarter of the distance will
    do, see `Avoidance.steady`. On f = 1/d - 1/d0, and on `FlatCap` and `GaussianTail` with their
    own d0, that leaves errors below 0.1 % in the norms, but more in the tiny ones of a trajectory
    that hardly comes nearer than d0: 0.5 % where it comes to 0.99 d0, some 5 % at 0.999 d0.
    Norms that need equal time steps get as many samples in equal steps. Steps are measured
    in position: for a body whose orientation matters, give samples that are dense in rotation.

    Args:
        trajectories: at least one, with names that differ.
        clearance: points [m], shape (n, 3), to signed distances [m], shape (n,); poses, shape
            (n, 7), if its attribute `uses_orientation` is true; a `MovingClearance` is asked at the
            samples' times.
        avoidance: the avoidance function, such as InverseDistance(d0=100.0), FlatCap(r=100.0) or
            GaussianTail(sigma=25.0).
        norms: at least one, with labels that differ.
        duration_tolerance: relative spread of the durations, (max - min) / min, up to which the
            norms compare.
        max_step: longest step between evaluations of the distance [m]; "auto" is d0 / 50; None
            evaluates it at the given samples alone, which may miss a collision between them.
        window_share: part of a norm's power that the window of its attribution has to hold.
        probability: probability of collision, by name or in the order of `trajectories`. Along each
            trajectory (anything with arrays `t` and `p`, as from `collision_probability`): its
            norms are ranked too. Or of the whole trajectory (anything with `probability`, `low`
            and `high`, as from `simulation.closed_loop_probability`): it is ranked as such, and
            compared with the norms. Or a tuple of both.

    Returns:
        The ranking.

    Raises:
        ArgumentError: no trajectory or norm, names or labels that repeat, a clearance that returns
            another shape or NaN, or another argument out of its range.

    Warns:
        DurationWarning: the durations differ by more than the tolerance.

    Reference:
        Nair & Kobilarov, sections II-B and III.
    """
    trajectories, norms = _distinct_trajectories(trajectories), _distinct_norms(norms)
    if not callable(clearance):
        raise ArgumentError("clearance", clearance, "callable with points, as TerrainClearance")
    if not isinstance(avoidance, Avoidance):
        raise ArgumentError("avoidance", avoidance, "an Avoidance, as InverseDistance(d0=100.0)")
    tolerance = real_number("duration_tolerance", duration_tolerance, "a number >= 0")
    if tolerance < 0:
        raise ArgumentError("duration_tolerance", duration_tolerance, "a number >= 0")
    share = real_number("window_share", window_share, "a number above 0, at most 1")
    if not 0 < share <= 1:
        raise ArgumentError("window_share", window_share, "a number above 0, at most 1")
    step = _step(max_step, avoidance)
    known = given_probabilities(probability, [trajectory.name for trajectory in trajectories])
    used, threads = shared_out(clearance, (avoidance, *norms), len(trajectories))

    def work(trajectory: Trajectory) -> Assessment:
        given = known[trajectory.name]
        return assess(
            trajectory, used, avoidance, norms,
            max_step=step, window_share=share, profile=given.profile, estimate=given.estimate,
        )  # fmt: skip

    ranking = Ranking(each(work, trajectories, threads), norms, tolerance, avoidance)
    if not ranking.durations_comparable:
        fastest, slowest = ((a.name, a.duration) for a in (ranking.fastest, ranking.slowest))
        warnings.warn(DurationWarning(fastest, slowest, tolerance), stacklevel=2)
    return ranking


def _distinct_trajectories(trajectories: Iterable[Trajectory]) -> tuple[Trajectory, ...]:
    if isinstance(trajectories, Trajectory):
        raise ArgumentError("trajectories", trajectories, "a list of trajectories")
    trajectories = tuple(trajectories)
    if not trajectories:
        raise ArgumentError("trajectories", trajectories, "at least one trajectory")
    for trajectory in trajectories:
        if not isinstance(trajectory, Trajectory):
            raise ArgumentError("trajectories", trajectory, "objects of class Trajectory")
    _refuse_repeated(
        "trajectories",
        [t.name for t in trajectories],
        "names that differ: Trajectory(..., name=...)",
    )
    return trajectories


def _distinct_norms(norms: Iterable[Norm]) -> tuple[Norm, ...]:
    if isinstance(norms, Norm | str):
        raise ArgumentError("norms", norms, "a list of norms, such as [Sobolev(1)]")
    norms = tuple(norms)
    if not norms:
        raise ArgumentError("norms", norms, "at least one norm")
    for norm in norms:
        if not isinstance(norm, Norm):
            raise ArgumentError("norms", norm, "objects of class Norm, such as Lp(2)")
    _refuse_repeated("norms", [norm.label for norm in norms], "norms with labels that differ")
    return norms


def _refuse_repeated(argument: str, names: Sequence[str], allowed: str) -> None:
    for i, name in enumerate(names):
        if name in names[:i]:
            raise ArgumentError(f"{argument}[{i}]", name, f"{allowed}; [{names.index(name)}] too")


def _step(max_step: float | str | None, avoidance: Avoidance) -> float | None:
    if isinstance(max_step, str):
        if max_step != "auto":
            raise ArgumentError("max_step", max_step, '"auto", a length [m], or None')
        return avoidance.d0 / 50
    return None if max_step is None else positive("max_step", max_step)
