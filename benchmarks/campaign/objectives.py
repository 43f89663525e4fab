"""What the campaign lets planners minimise."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from ompl import base as ob

from ompl_risk import InverseDistance, Lp, RiskObjective, Sobolev
from ompl_risk.norms import Norm
from ompl_risk.planners import Problem

NORMS: Mapping[str, Norm] = MappingProxyType(
    {
        "L1": Lp(1),
        "L2": Lp(2),
        "L4": Lp(4),
        "Linf": Lp(math.inf),
        "H1(0.3)": Sobolev(1, time_scale=0.3),
        "H1": Sobolev(1),
        "H1(3)": Sobolev(1, time_scale=3.0),
    }
)
"""The norms that are minimised, and judged by."""


class Objective(ABC):
    """An objective of the campaign.

    The implementer's duties:

    1. `build(si, problem)` makes OMPL's objective, newly for each planner.
    2. `value(cost, recipe)` turns its costs into what figures show, in `unit`; it is increasing.
    3. `recipe(problem)` says in plain numbers what is minimised, and changes when that does.
    """

    @abstractmethod
    def build(self, si: Any, problem: Problem) -> Any:
        """OMPL's objective."""

    @abstractmethod
    def recipe(self, problem: Problem) -> dict[str, Any]:
        """Everything that decides about the objective, fit for JSON."""

    @abstractmethod
    def value(self, cost: float, recipe: Mapping[str, Any]) -> float:
        """A cost as figures show it; the recipe is that of the run."""

    @property
    @abstractmethod
    def unit(self) -> str:
        """Unit of `value`."""


@dataclass(frozen=True)
class PathLength(Objective):
    """OMPL's path length: at constant speed the duration."""

    @property
    def unit(self) -> str:
        """Metres."""
        return "m"

    def build(self, si: Any, problem: Problem) -> Any:  # noqa: ARG002
        """OMPL's own objective, computed in C++."""
        return ob.PathLengthOptimizationObjective(si)

    def recipe(self, problem: Problem) -> dict[str, Any]:  # noqa: ARG002
        """The word."""
        return {"minimise": "length"}

    def value(self, cost: float, recipe: Mapping[str, Any]) -> float:  # noqa: ARG002
        """The length [m]."""
        return cost


@dataclass(frozen=True)
class NormOfRisk(Objective):
    """A norm of f; the time only decides between ways without risk."""

    norm: Norm

    def build(self, si: Any, problem: Problem) -> Any:
        """A `RiskObjective` with the scene's avoidance function."""
        return RiskObjective(
            si, problem.clearance, problem.avoidance, self.norm, speed=problem.speed
        )

    def recipe(self, problem: Problem) -> dict[str, Any]:
        """Norm and d0."""
        return {"minimise": self.norm.label, "d0": problem.avoidance.d0}

    def value(self, cost: float, recipe: Mapping[str, Any]) -> float:  # noqa: ARG002
        """The norm: the root of the cost."""
        return cost if math.isinf(self.norm.exponent) else cost ** (1.0 / self.norm.exponent)

    @property
    def unit(self) -> str:
        """Such as √s/m."""
        p = self.norm.exponent
        time = {1.0: "s", 2.0: "√s", math.inf: "1"}.get(p, f"s^(1/{p:g})")
        return f"{time}/m"


@dataclass(frozen=True)
class LeastClearance(Objective):
    """Maximise the least clearance along the path.

    Minimises max f with f = 1/d - 1/D, which falls with d as long as d < D. Every path contains
    its ends, so its least clearance is at most that of either; with D twice the lesser of these
    two, f is positive and strictly falling wherever a path can have its least clearance. So the
    order of paths is exactly that of their least clearances, however far from obstacles they are.

    For paths that come nearer than d0 this is also the order by the L-infinity norm: these two
    objectives differ only where a path can stay d0 away, and are each other's check elsewhere.
    """

    @property
    def unit(self) -> str:
        """Metres."""
        return "m"

    def build(self, si: Any, problem: Problem) -> Any:
        """A `RiskObjective` with D instead of d0."""
        avoidance = InverseDistance(self._scale(problem))
        return RiskObjective(si, problem.clearance, avoidance, Lp(math.inf), speed=problem.speed)

    def recipe(self, problem: Problem) -> dict[str, Any]:
        """The word and D."""
        return {"minimise": "-least clearance", "D": self._scale(problem)}

    def value(self, cost: float, recipe: Mapping[str, Any]) -> float:
        """Minus the least clearance [m], from max f: 1/d = f + 1/D."""
        return -1.0 / (cost + 1.0 / recipe["D"])

    def _scale(self, problem: Problem) -> float:
        ends = [float(problem.clearance(end[None, :])[0]) for end in (problem.start, problem.goal)]
        return 2.0 * min(ends)


@dataclass(frozen=True)
class TimeAndRisk(Objective):
    """The squared H^1 norm plus the duration with a weight.

    A second of flight costs as much as a second at clearance d1, a fixed part of d0.
    """

    part: float = 0.25

    @property
    def unit(self) -> str:
        """That of the squared norm."""
        return "s/m²"

    def build(self, si: Any, problem: Problem) -> Any:
        """A `RiskObjective` with the weight of time."""
        return RiskObjective(
            si,
            problem.clearance,
            problem.avoidance,
            Sobolev(1),
            speed=problem.speed,
            duration_weight=self._weight(problem),
        )

    def recipe(self, problem: Problem) -> dict[str, Any]:
        """Norm, d0 and the weight."""
        d0 = problem.avoidance.d0
        return {"minimise": "H1^2 + weight * time", "d0": d0, "weight": self._weight(problem)}

    def value(self, cost: float, recipe: Mapping[str, Any]) -> float:  # noqa: ARG002
        """The cost itself."""
        return cost

    def _weight(self, problem: Problem) -> float:
        return float(problem.avoidance(self.part * problem.avoidance.d0)) ** 2


OBJECTIVES: Mapping[str, Objective] = MappingProxyType(
    {
        "length": PathLength(),
        **{name: NormOfRisk(norm) for name, norm in NORMS.items()},
        "clearance": LeastClearance(),
        "time+risk": TimeAndRisk(),
    }
)
