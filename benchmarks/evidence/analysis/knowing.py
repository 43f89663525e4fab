"""Settings that know how large the errors are, which the level of disturbance says.

The other settings see the distance alone, and are the same at all levels. Who knows how good the
map and the navigation are can do better: by lengths that were tuned to each level, or by predicting
the probability of collision from the sizes of the errors, with nothing fitted. Both are judged
beside the others, but not recommended as settings: a norm that does not know the level is at a
disadvantage against them. The prediction has the sizes that the judge itself draws its errors
with; on a real vehicle they are known less well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.evidence.analysis.metrics import scores
from benchmarks.evidence.analysis.profiles import Profiles
from benchmarks.evidence.analysis.settings import Setting, evaluated
from benchmarks.evidence.analysis.table import FLIGHTS, LEVELS, Table
from benchmarks.evidence.analysis.truth import closed_loop
from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances import Disturbances
from ompl_risk.simulation.prediction import errors_of


class Knowing:
    """A setting whose numbers depend on the level of disturbance."""

    @property
    def label(self) -> str:
        """What tables call it."""
        raise NotImplementedError

    def levels(self, profiles: Profiles) -> FloatArray:
        """The number of each flight at each level, shape (L, F)."""
        raise NotImplementedError


@dataclass(frozen=True)
class ByLevel(Knowing):
    """A setting of its own for each level.

    Args:
        name: of what they have in common.
        settings: one for each level, in their order.
    """

    name: str
    settings: tuple[Setting, ...]

    @property
    def label(self) -> str:
        """Such as "L^p of 1/d, by level"."""
        return f"{self.name}, by level"

    def levels(self, profiles: Profiles) -> FloatArray:
        """Shape (L, F)."""
        return evaluated(self.settings, profiles).reshape(len(self.settings), -1)


@dataclass(frozen=True)
class Predicted(Knowing):
    """The probability of collision predicted from the sizes of the errors; nothing is fitted."""

    @property
    def label(self) -> str:
        """It has no parameters."""
        return "predicted_probability"

    def levels(self, profiles: Profiles) -> FloatArray:
        """Shape (L, F)."""
        if self not in profiles.known:
            profiles.known[self] = np.array([_predicted(profiles, name) for name in LEVELS])
        return profiles.known[self]


def _predicted(profiles: Profiles, level: str) -> FloatArray:
    disturbances = Disturbances.level(level)
    found = np.empty(len(profiles))
    for k in range(len(profiles)):
        flight = profiles.flight(k)
        model = errors_of(disturbances, float(flight["speed"].mean()))
        found[k] = model.probability(flight["t"], flight["d"], flight["up"])
    return found


def tuned_by_level(training: Table, name: str, settings: Sequence[Setting]) -> ByLevel:
    """The setting of greatest objective at each level, on training units.

    Args:
        training: units of the training split, and no others.
        name: of what they have in common.
        settings: to choose from.

    Raises:
        ArgumentError: a unit of another split.
    """
    if strange := {*training.split.tolist()} - {"train"}:
        raise ArgumentError("training.split", sorted(strange), '"train" only')
    judge = closed_loop(training)
    found = scores(evaluated(settings, training.profiles)[:, None], judge.values)
    objective = np.where(judge.decided, 0.5 * (found.safest + found.tau), 0.0).sum(axis=-1)
    return ByLevel(name, tuple(settings[int(k)] for k in objective.argmax(axis=0)))


def evaluated_by_level(settings: Sequence[Setting | Knowing], profiles: Profiles) -> FloatArray:
    """The numbers of all flights at every level, unit by unit, shape (S, L, U, 5)."""
    blind = [setting for setting in settings if not isinstance(setting, Knowing)]
    numbers = iter(evaluated(blind, profiles))
    shape = (len(LEVELS), len(profiles) // FLIGHTS, FLIGHTS)
    return np.stack(
        [
            setting.levels(profiles).reshape(shape)
            if isinstance(setting, Knowing)
            else np.broadcast_to(next(numbers), shape)
            for setting in settings
        ]
    )
