"""Who plans: the library's roadmap and OMPL's planners that heed an objective."""

from __future__ import annotations

import importlib
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from ompl import geometric as og

from benchmarks.campaign.curve import Rows, Watch

ROADMAP = "ompl_risk.planners.roadmap.planner"


class Planner(ABC):
    """A planner of the campaign.

    The implementer's duties:

    1. `missing()` says why it cannot run here, "" if it can.
    2. `build(si, seed)` makes OMPL's planner; OMPL's own random numbers are seeded by the caller.
    3. `best(planner)` is the cost of the best path so far, inf without one; called during solve.
    4. `curve(planner, watch)` gives improvements as (processor seconds, cost) after solve, as the
       watch has seen them unless the planner knows better.
    """

    @abstractmethod
    def missing(self) -> str:
        """Why it cannot run."""

    @abstractmethod
    def build(self, si: Any, seed: int) -> Any:
        """OMPL's planner."""

    def best(self, planner: Any) -> float:
        """Cost of the best path so far: OMPL's planners that optimise all tell it."""
        return planner.bestCost().value()

    def curve(self, planner: Any, watch: Watch) -> Rows:  # noqa: ARG002
        """Improvements, as they were found by asking."""
        return watch.rows


@dataclass(frozen=True)
class OmplPlanner(Planner):
    """A planner of OMPL with its default settings.

    Args:
        name: of its class in `ompl.geometric`.
    """

    name: str

    def missing(self) -> str:
        """The installed OMPL may lack it."""
        return "" if hasattr(og, self.name) else f"this OMPL has no og.{self.name}"

    def build(self, si: Any, seed: int) -> Any:  # noqa: ARG002
        """The planner."""
        return getattr(og, self.name)(si)


class Roadmap(Planner):
    """The library's roadmap, in one thread as the others are."""

    def missing(self) -> str:
        """The library may be older than its roadmap."""
        try:
            importlib.import_module(ROADMAP)
        except ModuleNotFoundError as error:
            return f"this ompl_risk has no RiskRoadmap ({error})"
        return ""

    def build(self, si: Any, seed: int) -> Any:
        """The planner."""
        return importlib.import_module(ROADMAP).RiskRoadmap(si, seed=seed, threads=1)

    def best(self, planner: Any) -> float:  # noqa: ARG002
        """Not asked for: the planner keeps its own history."""
        return math.inf

    def curve(self, planner: Any, watch: Watch) -> Rows:
        """Improvements: the planner's history, less the rows that tell of a larger roadmap only."""
        rows: Rows = []
        for seconds, cost, *_ in planner.history:
            if not rows or cost < rows[-1][1]:
                rows.append((float(seconds), float(cost)))
        return watch.in_processor_time(rows)


PLANNERS: Mapping[str, Planner] = MappingProxyType(
    {
        "RiskRoadmap": Roadmap(),
        "RRTstar": OmplPlanner("RRTstar"),
        "InformedRRTstar": OmplPlanner("InformedRRTstar"),
        "BITstar": OmplPlanner("BITstar"),
    }
)


def available() -> tuple[dict[str, Planner], list[str]]:
    """The planners that can run here, and for the others a message each."""
    missing = {name: planner.missing() for name, planner in PLANNERS.items()}
    return (
        {name: planner for name, planner in PLANNERS.items() if not missing[name]},
        [f"{name} is left out: {why}" for name, why in missing.items() if why],
    )
