"""The planners that a task may name: what each of them heeds, and how long it usually runs."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from types import MappingProxyType
from typing import Any

from ompl_risk.errors import ArgumentError
from ompl_risk.planners.criteria import Criterion, Length


class Heeds(str, Enum):
    """What a planner minimises."""

    CRITERION = "the criterion"
    LENGTH = "the length of the path, whatever the criterion"
    NOTHING = "nothing: its path is feasible, and the simplifier alone minimises the criterion"


@dataclass(frozen=True)
class Method:
    """A planner by name.

    Args:
        name: a class of `ompl.geometric`, or the dotted path of a planner written in Python, such
            as "package.module.Planner" (see `method_of`).
        iterations: usual budget, in questions of the planner whether to stop.
        heeds: what it minimises.
        roadmap: whether it is grown as a roadmap and searched outside OMPL, see `Grow`.
        refused: why it may not minimise a kind of criterion, "length" or "risk".
    """

    name: str
    iterations: int
    heeds: Heeds = Heeds.CRITERION
    roadmap: bool = False
    refused: Mapping[str, str] = field(default_factory=dict)

    def check(self, criterion: Criterion, argument: str = "planner") -> None:
        """Refuse what would hang or crash, and a planner that is not there.

        Raises:
            ArgumentError: with the reason.
        """
        self.planner_class(argument)
        kind = "length" if isinstance(criterion, Length) else "risk"
        if reason := self.refused.get(kind):
            raise ArgumentError(argument, f"{self.name}:{criterion.name}", f"another: {reason}")

    def planner_class(self, argument: str = "planner") -> Any:
        """The class of the planner.

        Raises:
            ArgumentError: it cannot be imported, or is no planner.
        """
        from ompl import base as ob
        from ompl import geometric as og

        module_name, _, class_name = self.name.rpartition(".")
        try:
            module = importlib.import_module(module_name) if module_name else og
            found = getattr(module, class_name)
        except (ImportError, AttributeError) as error:
            raise ArgumentError(argument, self.name, f"an installed planner; {error}") from None
        if not (isinstance(found, type) and issubclass(found, ob.Planner)):
            raise ArgumentError(argument, self.name, "a class derived from ob.Planner")
        return found

    @property
    def counts_itself(self) -> bool:
        """Whether the planner takes its budget as `iterations`, rather than be told to stop."""
        return "iterations" in self._options()

    def planner(self, si: Any, seed: int, iterations: int) -> Any:
        """A new planner over OMPL's space information."""
        given = {"seed": seed, "iterations": iterations}
        options = {name: given[name] for name in self._options()}
        return self.planner_class()(si, **options)

    def _options(self) -> list[str]:
        """Keyword arguments of ours that the planner's class takes; OMPL's own take none."""
        if "." not in self.name:
            return []
        taken = inspect.signature(self.planner_class()).parameters
        return [name for name in ("seed", "iterations") if name in taken]


_NO_METRIC = "it looks up neighbours by cost, and risk is no metric: it finds nothing or crashes"
_STRAIGHT = "it hangs for ever if the straight way is free; InformedRRTstar:length does not"
_CRASHES = "OMPL's AORRTC crashes (SIGSEGV) as soon as it improves on its first path"

_METHODS = (
    Method("BITstar", 15_000),
    Method("RRTstar", 2_000),
    Method("InformedRRTstar", 2_000),
    Method("SORRTstar", 2_000, refused={"length": _STRAIGHT}),
    Method("PRM", 2_000, roadmap=True),
    Method("PRMstar", 2_000, roadmap=True),
    Method("FMT", 10_000, Heeds.LENGTH, refused={"risk": _NO_METRIC}),
    Method("BFMT", 10_000, Heeds.LENGTH, refused={"risk": _NO_METRIC}),
    Method("RRT", 20_000, Heeds.NOTHING),
    Method("RRTConnect", 20_000, Heeds.NOTHING),
    Method("KPIECE1", 50_000, Heeds.NOTHING),
    Method("BKPIECE1", 50_000, Heeds.NOTHING),
    Method("LBKPIECE1", 50_000, Heeds.NOTHING),
    Method("AORRTC", 1, Heeds.LENGTH, refused={"length": _CRASHES, "risk": _CRASHES}),
)

METHODS: Mapping[str, Method] = MappingProxyType({method.name: method for method in _METHODS})
"""The planners of OMPL, by name.

An iteration is one edge for BITstar, two make a milestone of a roadmap, and for the others it is
one sample. FMT and BFMT end by themselves, after OMPL's 1,000 samples; those that heed nothing end
with their first path.
"""

PYTHON_ITERATIONS = 1_000
"""Usual budget of a planner written in Python that has no short name."""

ALIASES: Mapping[str, Method] = MappingProxyType(
    {"RiskRoadmap": Method("ompl_risk.planners.roadmap.planner.RiskRoadmap", 10_000)}
)
"""Planners written in Python, by their short names. An iteration of RiskRoadmap is one state."""


def method_of(planner: str | type, *, argument: str = "planner") -> Method:
    """The planner of that name.

    A planner written in Python is a class derived from `ob.Planner` that takes the space
    information, and as keyword arguments, if it wants them, `seed` and `iterations`. One that
    takes `iterations` counts them itself; any other is told to stop after so many questions. That
    the same seed and iterations give the same path is its own duty.

    Args:
        planner: a name in `METHODS` or `ALIASES`, the dotted path of a class, or a class that can
            be imported by its path.
        argument: what the caller calls it in errors.

    Raises:
        ArgumentError: an unknown name.
    """
    name = _path(planner, argument) if isinstance(planner, type) else planner
    for table in (METHODS, ALIASES):
        if name in table:
            return table[name]
    parts = name.split(".") if isinstance(name, str) else []
    if len(parts) > 1 and all(part.isidentifier() for part in parts):
        return Method(name, PYTHON_ITERATIONS)
    names = ", ".join([*METHODS, *ALIASES])
    raise ArgumentError(argument, name, f"one of {names}; or the dotted path of a planner's class")


def _path(kind: type, argument: str) -> str:
    """The name by which a worker process can import a class."""
    from ompl import geometric as og

    if getattr(og, kind.__name__, None) is kind:
        return kind.__name__
    path = f"{kind.__module__}.{kind.__qualname__}"
    if kind.__module__ == "__main__" or "." in kind.__qualname__:
        raise ArgumentError(argument, path, "a class that other processes can import from a module")
    return path
