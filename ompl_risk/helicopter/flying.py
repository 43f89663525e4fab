"""From a planned route to a flight."""

from __future__ import annotations

import math

from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import deviations
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.legs import Leg
from ompl_risk.helicopter.library import PrimitiveLibrary
from ompl_risk.helicopter.piloting import Pilot
from ompl_risk.helicopter.planned_route import PlannedRoute, planned_route

AT_GOAL = 1e-3
"""What may remain at a hover goal [m, rad] before it is worth to hover there for a while."""


def fly(
    library: PrimitiveLibrary, start: ArrayLike, pieces: ArrayLike, *, hover: float = 6.0
) -> Flight:
    """Fly a planned route with inputs that are held for ``library.dt`` each.

    Trims, which were planned for any time, are held for whole steps. What that does to place and
    heading, some 0.3 m and 0.3 degrees a turn, is made up for as the flight goes on, within the
    limits of the inputs, and ended exactly in trims that last three seconds or more. ``Flight``
    has both the states flown and those planned.

    Args:
        library: trims and manoeuvres.
        start: x, y, z [m], heading [rad] and the index of the speed, shape (5,).
        pieces: what follows, see ``ompl_risk._kernels.pieces``, shape (m, 10).
        hover: for how long to stay at a goal that is a hover if the vehicle arrives beside it, in
            order to get there [s]; 0: not at all.

    Returns:
        The flight. ``flight.at_goal`` says what remains at the goal.

    Raises:
        ArgumentError: pieces that do not follow from the start, see ``planned_route``, pieces of
            less than half a step altogether, or a negative time.
    """
    if not 0.0 <= hover < math.inf:
        raise ArgumentError("hover", hover, "0 or more [s]")
    route = planned_route(library, start, pieces)
    pilot = Pilot(route)
    for leg in route.legs:
        pilot.fly(leg)
    if hover > 0.0 and _is_beside_hover(route, pilot.state):
        last = route.legs[-1]
        pilot.fly(Leg(last.last, route.duration, hover, last.end))
    states, controls, times = pilot.flown()
    return Flight(
        library.dt,
        states,
        controls,
        route.at(times),
        planned_times=times,
        goal=route.goal,
        helicopter=library.helicopter,
    )


def _is_beside_hover(route: PlannedRoute, state: FloatArray) -> bool:
    """Whether the route ends in hover, and the vehicle elsewhere."""
    distance, angle = deviations.separation(state[None], route.goal[None])[0]
    return not any(route.legs[-1].last.key) and bool(max(distance, angle) > AT_GOAL)
