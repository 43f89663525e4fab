"""Flies the rollouts of a plan."""

from __future__ import annotations

from typing import Any

import numpy as np

from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.threads import in_chunks
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.loop.air import air_for
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.plans import Plan

LEAST = 8
"""Rollouts that are worth a thread."""


def fly(
    plan: Plan,
    clearance: Any,
    disturbances: Any,
    draws: Any,
    *,
    threads: int | None = None,
    traced: int | None = None,
) -> Outcomes:
    """Fly a plan once for each of the draws.

    Results do not depend on the number of threads, nor rollout k on how many others there are.

    Args:
        plan: what is flown, and by which vehicle.
        clearance: a ``TerrainClearance`` is checked as the rollouts go on. Any other one is asked
            only how high the plan is above the ground, and ``traced`` must be given.
        disturbances: gusts, navigation and terrain error.
        draws: random numbers; the same for plans that are to be compared.
        threads: None: one for each processor.
        traced: write the positions every so many steps into ``Outcomes.traces``.

    Raises:
        ArgumentError: another clearance without ``traced``, or a number that is not positive.
    """
    count, every = len(draws.seeds), _trace_every(traced, clearance)
    steps = len(plan.times) - 1
    outcomes = Outcomes.room(count, 0 if traced is None else steps // every + 1)
    air = air_for(plan, clearance, disturbances, draws, traces=outcomes.traces, trace_every=every)
    in_chunks(lambda first, last: plan.run(air, first, last, outcomes), count, threads, least=LEAST)
    return outcomes.closed()


def _trace_every(traced: int | None, clearance: Any) -> int:
    if traced is None:
        if not isinstance(clearance, TerrainClearance):
            allowed = "a TerrainClearance, unless positions are traced (traced=)"
            raise ArgumentError("clearance", clearance, allowed)
        return 1
    if isinstance(traced, bool) or not isinstance(traced, int | np.integer) or traced < 1:
        raise ArgumentError("traced", traced, "None or a whole number of steps from 1")
    return int(traced)
