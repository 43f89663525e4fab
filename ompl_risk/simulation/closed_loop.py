"""Probability that plans end in collision when a vehicle flies them in wind and error."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.estimates.estimate import CollisionEstimate, check_confidence
from ompl_risk.simulation.estimates.until import Count, Until
from ompl_risk.simulation.loop.checking import fly_checked
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.plans import Plan
from ompl_risk.simulation.loop.point_plan import PointPlan
from ompl_risk.simulation.loop.rollouts import fly
from ompl_risk.simulation.rare.importance import Design, RaisedGround
from ompl_risk.trajectory import Trajectory

ROLLOUTS = 1000
"""Unless said otherwise."""

PORTION = 512
"""Rollouts flown in one go, between which an interrupt is served and progress is told."""


def closed_loop_probability(
    plans: Any,
    clearance: Any,
    disturbances: Disturbances,
    *,
    rollouts: int | None = None,
    seed: int = 0,
    confidence: float = 0.95,
    threads: int | None = None,
    importance: RaisedGround | None = None,
    until: Until | None = None,
    on_plan: Callable[[CollisionEstimate], None] | None = None,
    on_rollouts: Callable[[int], object] = lambda _flown: None,
) -> tuple[CollisionEstimate, ...]:
    """How often each of some plans ends in collision, by flying it again and again.

    Rollout k of every plan meets the same wind, the same navigation errors and the same error of
    the map (common random numbers), so that ``compare`` can tell plans apart that differ less than
    either is known.

    Args:
        plans: one or many: a ``Plan``, a ``Flight`` (flown by its helicopter), as
            ``HelicopterSteering.flight`` makes them of a route, or a ``Trajectory`` (flown by a
            point mass, also if it is a helicopter's), with names that differ; those without are
            numbered.
        clearance: distance to what can be hit. Over a ``TerrainClearance`` everything is compiled;
            any other clearance is checked from traces, see ``checking``. A ``MovingClearance`` is
            asked at the times of the trajectory; those of a flight begin at 0.
        disturbances: what the plans do not know.
        rollouts: of each plan, 1,000 if left out; not together with ``until``.
        seed: of all random numbers; the rest of the arguments and it fix the result.
        confidence: of the intervals.
        threads: at a time; ``None`` uses all processors. The result does not depend on it.
        importance: ``RaisedGround()`` for rare collisions.
        until: a rule when to stop, such as ``Decided(1e-3)``: plans then have as many rollouts as
            each needs, and bounds that hold in spite of it.
        on_plan: called with each estimate as soon as it is there.
        on_rollouts: called every few hundred rollouts with how many of the plan have been flown.

    Returns:
        An estimate for each plan, in order.

    Raises:
        ArgumentError: something else than plans, names that repeat, or a value out of range.
    """
    chosen = as_plans(plans)
    _check(clearance, disturbances, importance)
    looks = (stop := _stop(rollouts, until)).looks(check_confidence("confidence", confidence))
    sample = _Sample(seed, disturbances)
    if importance is not None:
        sample.design = importance.design([plan for _, plan in chosen], clearance, disturbances)
    flown = fly if isinstance(clearance, TerrainClearance) else fly_checked

    def block(plan: Plan, first: int, last: int) -> list[Outcomes]:
        sample.upto(last)
        parts = []
        for begin in range(first, last, PORTION):
            end = min(begin + PORTION, last)
            draws = sample.part(begin, end)
            parts.append(flown(plan, clearance, disturbances, draws, threads=threads))
            on_rollouts(end)
        return parts

    found = []
    for name, plan in chosen:
        parts = block(plan, 0, looks[0])
        estimate = sample.estimate(name, parts, confidence, len(looks))
        for first, last in itertools.pairwise(looks):
            if stop.done(estimate):
                break
            parts += block(plan, first, last)
            estimate = sample.estimate(name, parts, confidence, len(looks))
        found.append(estimate)
        if on_plan is not None:
            on_plan(estimate)
    return tuple(found)


def _check(clearance: Any, disturbances: Any, importance: Any) -> None:
    if not callable(clearance):
        allowed = "a clearance, as TerrainClearance(terrain, radius=5.0)"
        raise ArgumentError("clearance", clearance, allowed)
    if not isinstance(disturbances, Disturbances):
        allowed = 'Disturbances(...) or Disturbances.level("moderate")'
        raise ArgumentError("disturbances", disturbances, allowed)
    if importance is not None and not isinstance(importance, RaisedGround):
        raise ArgumentError("importance", importance, "None or RaisedGround()")


def as_plans(plans: Any) -> list[tuple[str, Plan]]:
    """Names and plans of what a caller may pass for plans.

    Raises:
        ArgumentError: none, something that is no plan, or names that repeat.
    """
    single = isinstance(plans, Plan | Flight | Trajectory)
    if not single and not isinstance(plans, Iterable):
        raise ArgumentError("plans", plans, "a Plan, Flight or Trajectory, or a list of them")
    chosen = [plans] if single else list(plans)
    if not chosen:
        raise ArgumentError("plans", chosen, "at least one")
    found: list[tuple[str, Plan]] = []
    for k, each in enumerate(chosen):
        name = getattr(each, "name", "") or f"plan {k + 1}"
        if name in [other for other, _ in found]:
            raise ArgumentError(f"plans[{k}]", name, "named differently from those before it")
        found.append((name, _as_plan(f"plans[{k}]", each, name)))
    return found


def _as_plan(argument: str, each: Any, name: str) -> Plan:
    if isinstance(each, Plan):
        return each
    if isinstance(each, Flight):
        return HelicopterPlan(each, name=name)
    if isinstance(each, Trajectory):
        return PointPlan(each)
    raise ArgumentError(argument, type(each).__name__, "a Plan, a Flight or a Trajectory")


def _stop(rollouts: int | None, until: Until | None) -> Until:
    if until is None:
        return Count(ROLLOUTS if rollouts is None else rollouts)
    if rollouts is not None:
        raise ArgumentError("rollouts", rollouts, "left out where until= says how many")
    if not isinstance(until, Until):
        raise ArgumentError("until", until, "None, Count(n), Narrow(width) or Decided(threshold)")
    return until


class _Sample:
    """The draws of all plans, made as far as they are asked for."""

    def __init__(self, seed: int, disturbances: Disturbances) -> None:
        self.seed, self.disturbances = seed, disturbances
        self.design: Design | None = None
        self._draws: Draws | None = None

    def upto(self, count: int) -> Draws:
        """At least ``count`` draws: which ones there are does not depend on how many."""
        if self._draws is None or len(self._draws) < count:
            self._draws = (
                Draws.make(count, self.seed, self.disturbances)
                if self.design is None
                else self.design.draws(count, self.seed)
            )
        return self._draws

    def part(self, first: int, last: int) -> Draws:
        """Draws ``first`` to ``last - 1``."""
        draws = self.upto(last)
        rows = slice(first, last)
        return Draws(draws.seeds[rows], draws.amplitudes[rows], draws.log_weights[rows])

    def estimate(
        self, name: str, parts: list[Outcomes], confidence: float, looks: int
    ) -> CollisionEstimate:
        """What the outcomes of one plan say."""

        def joined(field: str) -> Any:
            return np.concatenate([getattr(part, field) for part in parts])

        weights = None
        if self.design is not None:
            count = sum(len(part) for part in parts)
            weights = np.exp(self.upto(count).log_weights[:count])
        return CollisionEstimate(
            name,
            *(joined(field) for field in ("least", "when", "where", "collided")),
            seed=int(self.seed),
            confidence=confidence,
            looks=looks,
            weights=weights,
            heaviest=1.0 if self.design is None else self.design.heaviest,
            endings=joined("endings"),
        )
