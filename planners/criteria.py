"""What a planner is asked to minimise."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ompl_risk._arrays import positive
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk
from ompl_risk.norms import Norm
from ompl_risk.norms.naming import norm_name, parse_norm

if TYPE_CHECKING:
    from ompl_risk.planners.problem import Problem

ALLOWED = '"length", or norm@clearance [m] such as "H1@25", with norm L1, L2, any Lp, or H1'


class Criterion(ABC):
    """What a planner minimises; small, immutable and picklable, so that tasks can carry it.

    The implementer's duties:

    1. `objective(si, problem)` makes OMPL's objective, newly for each planner.
    2. `risk(problem)` says how the cost of a motion counts outside OMPL, the same as the objective
       up to a constant factor; None if it is the length.
    3. `name` is what `parse_criterion` reads back.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name, such as "length" or "H1@25"."""

    @abstractmethod
    def objective(self, si: Any, problem: Problem) -> Any:
        """The objective over OMPL's space information `si`."""

    @abstractmethod
    def risk(self, problem: Problem) -> Risk | None:
        """How motions are counted; None for their length."""


@dataclass(frozen=True)
class Length(Criterion):
    """The length of the path, so at constant speed the duration."""

    @property
    def name(self) -> str:
        """The word "length"."""
        return "length"

    def objective(self, si: Any, problem: Problem) -> Any:  # noqa: ARG002
        """OMPL's own objective of path length."""
        from ompl import base as ob

        return ob.PathLengthOptimizationObjective(si)

    def risk(self, problem: Problem) -> None:  # noqa: ARG002
        """None: the length counts."""
        return


@dataclass(frozen=True)
class WeightedRisk(Criterion):
    """A norm of f to its p-th power, and the duration with a weight.

        cost = ||f||^p + f(d1)^p duration

    So a second of flight costs as much as a second at clearance d1: a small d1 makes for short
    paths, d1 near d0 for safe ones.

    Args:
        norm: `Lp(p)` with finite p, or `Sobolev(1)`.
        time_clearance: d1 [m], positive.

    Raises:
        ArgumentError: another norm, or d1 out of range.
    """

    norm: Norm
    time_clearance: float

    def __post_init__(self) -> None:
        Risk(norm=self.norm, speed=1.0, duration_weight=1.0)  # refuses what does not add up
        positive("time_clearance", self.time_clearance)

    @property
    def name(self) -> str:
        """Such as "H1@25": the norm, and d1 [m]."""
        return f"{norm_name(self.norm)}@{self.time_clearance:g}"

    def objective(self, si: Any, problem: Problem) -> Any:
        """A `RiskObjective` with the weight of time."""
        from ompl_risk.bridge import RiskObjective

        risk = self.risk(problem)
        return RiskObjective(
            si,
            problem.clearance,
            risk.avoidance,
            risk.norm,
            speed=risk.speed,
            duration_weight=risk.duration_weight,
        )

    def risk(self, problem: Problem) -> Risk:
        """The same weights for motions outside OMPL.

        Raises:
            ArgumentError: d1 is not below d0, so time would have no weight.
        """
        weight = float(problem.avoidance(self.time_clearance)) ** self.norm.exponent
        if weight == 0.0:
            allowed = f"a criterion with a clearance below d0 = {problem.avoidance.d0:g} m"
            raise ArgumentError("criterion", self.name, allowed)
        return Risk(problem.avoidance, self.norm, speed=problem.speed, duration_weight=weight)


def parse_criterion(text: str, *, argument: str = "criterion") -> Criterion:
    """The criterion of that name: "length", or a norm and the clearance that time counts as.

    Raises:
        ArgumentError: no such criterion.

    Example:
        >>> parse_criterion("H1@25")
        WeightedRisk(norm=Sobolev(k=1.0, time_scale=1.0), time_clearance=25.0)
    """
    if text.strip().lower() == "length":
        return Length()
    norm, _, clearance = text.partition("@")
    try:
        return WeightedRisk(parse_norm(norm), float(clearance))
    except ValueError:  # ArgumentError is one too
        raise ArgumentError(argument, text, ALLOWED) from None
