"""Probability of collision predicted from stated errors, without a single rollout."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ompl_risk._arrays import positive
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.probability.outcrossing import Outcrossing
from ompl_risk.simulation.closed_loop import as_plans
from ompl_risk.simulation.disturbances import Disturbances

RECOVERY = 1.0
"""Time for which the vehicle rises and sinks with a gust before its law brings it back [s]."""

STEP = 0.2
"""Time between the samples of a plan [s]."""

SLOWEST = 1e-9
"""Least rate of the passing error, in its sizes a second: an error that hardly changes."""

LEAST = 0.1
"""Least passing error [m], where no disturbance says more."""


def errors_of(disturbances: Disturbances, speed: float) -> Outcrossing:
    """Errors of height that disturbances make, for ``Outcrossing``.

    Lasting: the upward bias of the navigation. Passing: the map's error, which a flight at that
    speed crosses in correlation length / speed, and the vehicle's own, which rises and sinks with
    the upward gusts: their standard deviation sigma_w is that of its vertical speed, and for
    ``RECOVERY`` seconds of that of its height. With sigma the map's deviation, l its length ::

        passing^2 = sigma^2 + (sigma_w 1 s)^2        rate^2 = (sigma speed / l)^2 + sigma_w^2
        correlation time = passing / rate

    Nothing in it is fitted.

    Args:
        disturbances: gusts, navigation and terrain error; any may be missing.
        speed: mean speed over the ground [m/s].

    Raises:
        ArgumentError: something else than disturbances, or a speed that is not positive.
    """
    if not isinstance(disturbances, Disturbances):
        allowed = 'Disturbances(...) or Disturbances.level("moderate")'
        raise ArgumentError("disturbances", disturbances, allowed)
    positive("speed", speed)
    gusts, navigation, terrain = disturbances.gusts, disturbances.navigation, disturbances.terrain
    heave = 0.0 if gusts is None else float(gusts.deviations(np.array([50.0]))[1][0])
    of_map = 0.0 if terrain is None else terrain.deviation
    change = 0.0 if terrain is None else terrain.deviation * speed / terrain.correlation_length
    passing = max(math.hypot(of_map, heave * RECOVERY), LEAST)
    rate = max(math.hypot(change, heave), SLOWEST * passing)
    lasting = 0.0 if navigation is None else float(navigation.position.bias[2])
    return Outcrossing(passing, lasting, correlation_time=passing / rate)


def predicted_probability(
    plans: Any, clearance: TerrainClearance, disturbances: Disturbances
) -> Mapping[str, float]:
    """Probability that each of some plans ends in collision, in closed form.

    A prediction for ordering plans and for a first look, in milliseconds; it has no interval.
    ``closed_loop_probability`` flies them and says how sure it is.

    Args:
        plans: as of ``closed_loop_probability``.
        clearance: over terrain.
        disturbances: what the plans do not know.

    Returns:
        Probabilities by name, in the order given.

    Raises:
        ArgumentError: something else than these, or names that repeat.
    """
    chosen = as_plans(plans)
    if not isinstance(clearance, TerrainClearance):
        raise ArgumentError("clearance", clearance, "a TerrainClearance: others have no slope")
    found: dict[str, float] = {}
    for name, plan in chosen:
        every = max(1, round(STEP / plan.dt))
        kept = np.append(np.arange(0, len(plan.times) - 1, every), len(plan.times) - 1)
        t, x = plan.times[kept], np.ascontiguousarray(plan.positions[kept])
        d = clearance(x)
        if not np.isfinite(d).all() or (d <= 0.0).any():  # off the map, or a plan that collides
            found[name] = 1.0
            continue
        speed = max(float(np.linalg.norm(plan.velocities[kept], axis=1).mean()), 1e-3)
        model = errors_of(disturbances, speed)
        found[name] = model.probability(t, d, clearance.gradient(x)[:, 2])
    return found
