"""How the command `plan` gets its paths."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from rich.console import Console


class Way(NamedTuple):
    """A path that is only made if it is needed.

    Attributes:
        duration: [s].
        made: makes it, a flight or trajectory.
    """

    duration: float
    made: Callable[[], Any]


@dataclass(frozen=True, eq=False)
class Found:
    """Paths of equal time.

    Args:
        trajectories: the paths, two or more.
        labels: where each comes from.
        summary: how many were chosen of how many, and why the others were not.
        separation: least Frechet distance between two of them [m].
        facts: what else the provenance should tell.
        flights: how a vehicle with dynamics flies them, in the same order; none for a point.
        ways: the roadmap's Pareto set; only if a risk budget has a use for it.
    """

    trajectories: Sequence[Trajectory]
    labels: Sequence[str]
    summary: str
    separation: float
    facts: Mapping[str, Any] = field(default_factory=dict)
    flights: Sequence[Any] = ()
    ways: Sequence[Way] = ()


class Finder(ABC):
    """A way to find paths of equal time that differ; made once all settings have been checked."""

    @abstractmethod
    def find(self, folder: RunFolder, console: Console) -> Found:
        """Find them.

        Args:
            folder: where what has been found may be written.
            console: where progress is shown.

        Raises:
            PlanningError: there are fewer than two.
        """
