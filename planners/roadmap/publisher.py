"""A planner's routes as OMPL's solutions, each written once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ompl_risk.planners.roadmap.publishing import add_solutions
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route
from ompl_risk.planners.roadmap.translation import Translation


class Publisher:
    """Puts routes into a problem definition, and remembers which paths there are its own.

    Args:
        translation: writes routes as paths.
        roadmap: of the routes.
        name: of the planner.
    """

    def __init__(self, translation: Translation, roadmap: Roadmap, name: str) -> None:
        self._translation, self._roadmap, self._name = translation, roadmap, name
        self._routes: list[Route] = []
        self._paths: list[Any] = []

    def announce(self, problem: Any) -> None:
        """Publish a better path as soon as there is one: a condition may wait for it.

        Where paths take long to write, only the first.
        """
        best = self._roadmap.best
        if best is None or (self._routes and not self._translation.quick):
            return
        if not self._routes or best is not self._routes[0]:
            self.publish(problem, [best])

    def publish(self, problem: Any, routes: Sequence[Route]) -> None:
        """Make routes OMPL's solutions: the first exact, the others approximate, in their order.

        A better exact solution of another planner that is there already stays first.
        """
        paths = [self._path(route) for route in routes]
        objective = problem.getOptimizationObjective()
        add_solutions(problem, paths, objective, self._name, self._paths)
        self._routes, self._paths = list(routes), paths

    def _path(self, route: Route) -> Any:
        for known, path in zip(self._routes, self._paths, strict=True):
            if known is route:
                return path
        return self._translation.path(route, self._roadmap)
