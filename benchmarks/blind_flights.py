"""Helicopter flights of equal time, found by time alone: no norm has a say in what is chosen."""

from __future__ import annotations

from functools import cache

from ompl_risk import InverseDistance
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.planners import Problem
from ompl_risk.planners.roadmap.equal_time_flights import equal_time_flights
from ompl_risk.planners.roadmap.flights import flight_roadmap

BLIND = InverseDistance(2e-3)
"""Finds no risk but collisions; what problems must heed, so that the search does not."""


@cache
def steering() -> HelicopterSteering:
    """What the helicopter flies."""
    return HelicopterSteering()


def blind_flights(
    task: Problem,
    most: int,
    *,
    places: int,
    seed: int,
    excess: float,
    separation: float,
    threads: int | None = 1,
) -> tuple[Flight, ...]:
    """Flights that solve a problem, the fastest first, as they are found.

    Args:
        task: the problem.
        most: of the flights; there may be fewer.
        places: of the roadmap.
        seed: of the roadmap.
        excess: of a flight's duration over the least, as a share of it.
        separation: of two flights, as a share of the distance between start and goal.
        threads: of compiled code; None uses all processors.
    """
    roadmap = flight_roadmap(task, steering(), places=places, seed=seed, threads=threads)
    found = equal_time_flights(
        roadmap,
        task,
        steering(),
        most,
        excess=excess,
        min_distance=separation * task.distance,
        tidy=lambda route, _roadmap: route,
    )
    return found.flights
