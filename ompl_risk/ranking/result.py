"""The ranking and its questions: which is safest, do norms agree, what does time cost."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import RenderableType

from ompl_risk.avoidance import Avoidance
from ompl_risk.errors import ArgumentError, CollisionError
from ompl_risk.norms import Norm
from ompl_risk.ranking import export, tables
from ompl_risk.ranking.agreement import Agreement, agreement
from ompl_risk.ranking.assessment import Assessment
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Ranking:
    """Trajectories ranked by each of several norms; made by `rank`.

    Colliding trajectories (infinite norms) come last. Ties go to the shorter duration, then to
    the order of input.

    Args:
        assessments: one for each trajectory, in the order of input.
        norms: the norms.
        duration_tolerance: relative spread of the durations up to which the norms compare.
        avoidance: the avoidance function that the norms are of.
    """

    assessments: tuple[Assessment, ...]
    norms: tuple[Norm, ...]
    duration_tolerance: float
    avoidance: Avoidance

    def __repr__(self) -> str:
        orders = "; ".join(f"{label}: {' '.join(names)}" for label, names in self.orders.items())
        return f"Ranking({len(self.assessments)} trajectories, safest first by {orders})"

    def __str__(self) -> str:
        """The tables, as plain text."""
        from rich.console import Console

        console = Console(width=100, color_system=None, record=True, file=StringIO())
        console.print(self)
        return console.export_text().rstrip()

    def __getitem__(self, name: str) -> Assessment:
        """The assessment of the trajectory of that name."""
        for assessment in self.assessments:
            if assessment.name == name:
                return assessment
        raise KeyError(name)

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the norms."""
        return tuple(norm.label for norm in self.norms)

    @cached_property
    def orders(self) -> Mapping[str, tuple[str, ...]]:
        """Names from safest to riskiest, by label of the norm."""
        return {
            label: self._order([a.norms[label] for a in self.assessments]) for label in self.labels
        }

    @cached_property
    def pc_orders(self) -> Mapping[str, tuple[str, ...]]:
        """The same by norms of the probability of collision; empty if none was given."""
        if not self.has_probability:
            return {}
        return {
            label: self._order([a.pc_norms[label] for a in self.assessments])
            for label in self.labels
        }

    def safest(self, label: str) -> str:
        """Name of the safest trajectory by a norm.

        Raises:
            CollisionError: all of them collide.
        """
        name = self.orders[self._known(label)][0]
        if self[name].collides:
            raise CollisionError(tuple(a.name for a in self.assessments))
        return name

    def riskiest(self, label: str) -> str:
        """Name of the riskiest trajectory by a norm."""
        return self.orders[self._known(label)][-1]

    def best(self, label: str) -> Trajectory:
        """The safest trajectory by a norm, with the samples at which it was evaluated.

        Raises:
            CollisionError: all of them collide.
        """
        return self[self.safest(label)].trajectory

    def pareto(self, label: str) -> tuple[str, ...]:
        """Names of the trajectories that no other beats in both duration and norm, fastest first.

        One beats another if it is no worse in both and better in one. Colliding ones are left out.
        """
        self._known(label)
        points = sorted((a.duration, a.norms[label], i) for i, a in enumerate(self.assessments))
        front: list[tuple[float, float, int]] = []
        for duration, norm, i in points:
            least = min((n for _, n, _ in front), default=math.inf)
            if norm < least or (front and (duration, norm) == front[-1][:2]):
                front.append((duration, norm, i))
        return tuple(self.assessments[i].name for _, _, i in front)

    @cached_property
    def agreement(self) -> Agreement:
        """Kendall's tau-b between the norms."""
        values = {label: [a.norms[label] for a in self.assessments] for label in self.labels}
        return agreement(values, values)

    @cached_property
    def pc_agreement(self) -> Agreement | None:
        """Kendall's tau-b between the norms (rows) and those of the probability (columns)."""
        if not self.has_probability:
            return None
        return agreement(
            {label: [a.norms[label] for a in self.assessments] for label in self.labels},
            {label: [a.pc_norms[label] for a in self.assessments] for label in self.labels},
        )

    @property
    def has_probability(self) -> bool:
        """Whether a probability of collision along the trajectories was given."""
        return bool(self.assessments[0].pc_norms)

    @property
    def has_estimates(self) -> bool:
        """Whether a probability of collision of the whole trajectories was given."""
        return self.assessments[0].estimate is not None

    @cached_property
    def probability_order(self) -> tuple[str, ...]:
        """Names by the probability that the whole trajectory ends in collision, least first.

        Empty if none was given. Its estimates may be too close to tell apart: see their intervals.
        """
        if not self.has_estimates:
            return ()
        return self._order(self._probabilities)

    @cached_property
    def probability_agreement(self) -> Agreement | None:
        """Kendall's tau-b between the norms (rows) and that probability (one column)."""
        if not self.has_estimates:
            return None
        return agreement(
            {label: [a.norms[label] for a in self.assessments] for label in self.labels},
            {"probability": self._probabilities},
        )

    @property
    def fastest(self) -> Assessment:
        """The trajectory of least duration."""
        return min(self.assessments, key=lambda a: a.duration)

    @property
    def slowest(self) -> Assessment:
        """The trajectory of greatest duration."""
        return max(self.assessments, key=lambda a: a.duration)

    @property
    def duration_spread(self) -> float:
        """(greatest - least duration) / least duration."""
        return (self.slowest.duration - self.fastest.duration) / self.fastest.duration

    @property
    def durations_comparable(self) -> bool:
        """Whether the spread of the durations is within the tolerance."""
        return self.duration_spread <= self.duration_tolerance

    def to_dict(self, segments: int = 20) -> dict[str, Any]:
        """The ranking as plain data that strict JSON can hold: infinity is the string "inf".

        Args:
            segments: how many parts of equal duration the shares are given for.
        """
        return export.as_dict(self, segments)

    def to_json(
        self, path: str | Path | None = None, *, indent: int | None = 2, segments: int = 20
    ) -> str:
        """The dictionary as strict JSON, also written to `path` if given.

        Raises:
            FileError: the file cannot be written.
        """
        return export.as_json(self, path, indent, segments)

    def to_pandas(self) -> pd.DataFrame:
        """A table with a row for each trajectory; norms of the probability are "PC L1" and so on.

        Raises:
            ExtraError: pandas is not installed.
        """
        return export.as_frame(self)

    def __rich__(self) -> RenderableType:
        return tables.render(self)

    @property
    def _probabilities(self) -> list[float]:
        return [
            math.nan if a.estimate is None else a.estimate.probability for a in self.assessments
        ]

    def _known(self, label: str) -> str:
        if label not in self.labels:
            raise ArgumentError("label", label, f"one of {', '.join(self.labels)}")
        return label

    def _order(self, values: list[float]) -> tuple[str, ...]:
        ranked = sorted(
            range(len(values)), key=lambda i: (values[i], self.assessments[i].duration, i)
        )
        return tuple(self.assessments[i].name for i in ranked)
