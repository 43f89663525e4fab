"""A risk budget: the fastest plan that is safe enough for certain."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ompl_risk._arrays import real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.closed_loop import closed_loop_probability
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.estimates.estimate import CollisionEstimate
from ompl_risk.simulation.estimates.until import Decided, whole

COARSE = 16
"""Candidates, evenly spaced in the order given, that are tried first."""

PATIENCE = 4
"""After how many times the rollouts that would do if none collided a candidate is given up."""


@dataclass(frozen=True, eq=False)
class Budgeted:
    """What came of a risk budget.

    Attributes:
        budget: greatest probability of collision that is allowed.
        confidence: with which the chosen candidate keeps to it, all trials taken together.
        chosen: its place among the candidates; None if no candidate that was tried keeps to it.
        tried: estimates by place, in the order in which they were tried.
        candidates: how many there were.
    """

    budget: float
    confidence: float
    chosen: int | None
    tried: dict[int, CollisionEstimate]
    candidates: int

    @property
    def estimate(self) -> CollisionEstimate | None:
        """Of the chosen candidate."""
        return None if self.chosen is None else self.tried[self.chosen]

    @property
    def nearest(self) -> int:
        """The place of the candidate with the least upper bound."""
        return min(self.tried, key=lambda k: self.tried[k].upper_bound())

    def __str__(self) -> str:
        said = f"{len(self.tried)} of {self.candidates} candidates tried"
        if self.chosen is None:
            bound = self.tried[self.nearest].upper_bound()
            return f"none keeps to {self.budget:g}: the least upper bound is {bound:.3g}; {said}"
        bound = self.tried[self.chosen].upper_bound()
        return f"candidate {self.chosen + 1}: at most {bound:.3g}; {said}"


def fastest_within(
    plan: Callable[[int], Any],
    candidates: int,
    clearance: Any,
    disturbances: Disturbances,
    budget: float,
    *,
    confidence: float = 0.95,
    seed: int = 0,
    most: int | None = None,
    threads: int | None = None,
    on_trial: Callable[[int, CollisionEstimate], object] = lambda _place, _estimate: None,
    on_rollouts: Callable[[int, int], object] = lambda _place, _flown: None,
) -> Budgeted:
    """The first of some candidates whose probability of collision is within a budget for certain.

    Candidates come in order of duration, the fastest first, as the ways of a Pareto set do; each is
    flown in a closed loop until it is sure on which side of the budget it is, or ``most`` rollouts
    have not told. Some ``COARSE`` of them are tried in order until one keeps to the budget, then
    those between it and the one before by halving. So if the probability falls along the
    candidates, the fastest is found of those that so many rollouts can tell from the budget. If it
    does not, what is found still keeps to it, but a faster one that was not tried may do so too;
    and if nothing is found, so may one that was not tried.

    Since the best of several trials is taken, each has its share of the error (Bonferroni): with
    probability ``confidence`` no candidate that is worse than the budget is accepted, however many
    were tried. What has been seen decides which candidate comes next, so each is flown with random
    numbers of its own: with common ones those that let one pass would choose the next as well, and
    it would be wrong more often than its share.

    Args:
        plan: plan(k) makes the k-th candidate, for ``closed_loop_probability``; only those that
            are tried are made.
        candidates: how many there are.
        clearance: distance to what can be hit.
        disturbances: what the plans do not know.
        budget: greatest probability of collision, between 0 and 1.
        confidence: that the chosen one keeps to it.
        seed: of all random numbers; each candidate's come of it and its place, and are told by its
            estimate.
        most: rollouts of a candidate, at most; ``PATIENCE`` times those that would do if none
            collided, if left out. Fewer than those can never accept any.
        threads: at a time; None uses all processors.
        on_trial: called with place and estimate of each candidate tried.
        on_rollouts: called every few hundred rollouts with place and how many have been flown.

    Raises:
        ArgumentError: no candidates, or a value out of range.
    """
    whole("candidates", candidates)
    allowed = real_number("budget", budget, "between 0 and 1")
    if not 0.0 < allowed < 1.0:
        raise ArgumentError("budget", budget, "between 0 and 1")
    sure = real_number("confidence", confidence, "between 0 and 1")
    if not 0.0 < sure < 1.0:
        raise ArgumentError("confidence", confidence, "between 0 and 1")
    seed = whole("seed", seed, least=0)
    trials = len(_coarse(candidates)) + candidates.bit_length()
    each = 1.0 - (1.0 - sure) / trials
    rule = Decided(allowed, _most(allowed, each) if most is None else whole("most", most))
    tried: dict[int, CollisionEstimate] = {}

    def keeps(place: int) -> bool:
        (tried[place],) = closed_loop_probability(
            plan(place), clearance, disturbances,
            seed=_own(seed, place), confidence=each, threads=threads, until=rule,
            on_rollouts=lambda flown: on_rollouts(place, flown),
        )  # fmt: skip
        on_trial(place, tried[place])
        return tried[place].decided(allowed) == "below"

    chosen = _first(keeps, candidates)
    return Budgeted(allowed, sure, chosen, tried, candidates)


def _own(seed: int, place: int) -> int:
    """The seed of a candidate's rollouts, which no other candidate shares."""
    word = np.random.SeedSequence([seed, place]).generate_state(1, np.uint64)[0]
    return int(word >> np.uint64(1))


def _most(budget: float, confidence: float) -> int:
    return math.ceil(PATIENCE * math.log(1.0 - confidence) / math.log1p(-budget))


def _coarse(candidates: int) -> Sequence[int]:
    """Places that are tried first, the last one among them."""
    count = min(COARSE, candidates)
    return sorted({round(k * (candidates - 1) / max(1, count - 1)) for k in range(count)})


def _first(keeps: Callable[[int], bool], candidates: int) -> int | None:
    before = -1
    for place in _coarse(candidates):
        if keeps(place):
            break
        before = place
    else:
        return None
    while place - before > 1:
        middle = (before + place) // 2
        if keeps(middle):
            place = middle
        else:
            before = middle
    return place
