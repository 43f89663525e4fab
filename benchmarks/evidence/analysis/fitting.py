"""What is fitted, on training units only: each family's parameters, and which family to recommend.

The objective is the mean over the decided training sets, of all levels alike, of

    (safest found + Kendall's tau) / 2.

Those two are what the result is judged by. Safest found alone asks one yes or no of each set, which
leaves many parameters within its noise of each other; tau adds the other pairs of a set. Regret
would hang on the few sets of large probability.

A family's parameters are those of greatest objective. Families are compared by cross-validation:
each is fitted anew without a tenth of the terrains and scored on these. Of the simple ones, norms
of an avoidance function of the distance alone, which every part of the library takes, the best is
recommended; unless one that needs more than the distance, a rate, or a product of two settings is
certainly better (95 % interval of the paired difference above zero), there and once more on the
test units: what is more complicated has to win twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.evidence.analysis.metrics import scores
from benchmarks.evidence.analysis.settings import (
    NormOf,
    OfDistance,
    Product,
    Setting,
    evaluated,
    mixed,
)
from benchmarks.evidence.analysis.statistics import Bootstrap, Interval
from benchmarks.evidence.analysis.table import Table
from benchmarks.evidence.analysis.truth import Judgement, closed_loop
from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError

FOLDS = 10
WEIGHTS = (0.25, 0.5, 0.75)
PRODUCT = "product of two settings"


@dataclass(frozen=True)
class Family:
    """Settings that differ in parameters only, on a grid."""

    name: str
    settings: tuple[Setting, ...]

    @property
    def simple(self) -> bool:
        """Whether all are norms of a function of the distance alone."""
        return all(isinstance(s, NormOf) and isinstance(s.integrand, OfDistance)
                   for s in self.settings)  # fmt: skip


class Challenger(NamedTuple):
    """What would have to be certainly better than the best simple family.

    Attributes:
        name: of its family.
        setting: its choice.
        gain: its held-out objective less that of the best simple family.
    """

    name: str
    setting: Setting
    gain: Interval


@dataclass(frozen=True, eq=False)
class Fit:
    """What training says.

    Attributes:
        families: that were compared.
        choices: each family's setting of greatest objective, in their order.
        objectives: of each family's grid, in its order.
        held_out: each family's objective on terrains that it was not fitted on.
        challengers: families that are not simple, and the best product.
        simple: the setting of the best simple family.
        preferred: that, or the challenger of greatest gain among those certainly better.
        source: name of the preferred one's family.
        leader: name of the best simple family.
        sets: number of decided sets, and of all.
    """

    families: tuple[Family, ...]
    choices: tuple[Setting, ...]
    objectives: tuple[FloatArray, ...]
    held_out: tuple[Interval, ...]
    challengers: tuple[Challenger, ...]
    simple: Setting
    preferred: Setting
    source: str
    leader: str
    sets: tuple[int, int]


def fit(training: Table, families: Sequence[Family]) -> Fit:
    """Fit every family and recommend a setting.

    Args:
        training: units of the training split, and no others.
        families: to choose from, at least one of them simple.

    Raises:
        ArgumentError: a unit of another split, no simple family, or no decided set to fit on.
    """
    judge = _checked(training, families)
    values = [evaluated(family.settings, training.profiles) for family in families]
    gains = [_per_unit(each, judge) for each in values]
    best = [int(np.argmax(gain.sum(axis=1))) for gain in gains]
    choices = tuple(f.settings[k] for f, k in zip(families, best, strict=True))
    folds, number = folds_of(training), judge.decided.sum(axis=0)
    held = np.stack([_held_out(gain, folds) for gain in gains])
    leader = _best_simple(families, held.sum(axis=1))
    names = [family.name for family in families if not family.simple]
    rows = [row for row, family in zip(held, families, strict=True) if not family.simple]
    settings = [c for c, family in zip(choices, families, strict=True) if not family.simple]
    if len(families) > 1:
        names.append(PRODUCT)
        rows.append(_products_held_out(families, values, gains, judge, folds))
        chosen = [v[k] for v, k in zip(values, best, strict=True)]
        settings.append(_best_product(choices, chosen, leader, judge))
    draws = Bootstrap.of(training.units)
    over = [_intervals(draws, (row - held[leader])[None], number)[0] for row in rows]
    challengers = tuple(map(Challenger._make, zip(names, settings, over, strict=True)))
    winner = _winner(challengers, Challenger(families[leader].name, choices[leader], _NOTHING))
    return Fit(
        tuple(families),
        choices,
        tuple(gain.sum(axis=1) / number.sum() for gain in gains),
        tuple(_intervals(draws, held, number)),
        challengers,
        choices[leader],
        winner.setting,
        winner.name,
        families[leader].name,
        (int(number.sum()), judge.decided.size),
    )


_NOTHING = Interval(0.0, 0.0, 0.0)


def objective(values: FloatArray, judge: Judgement) -> FloatArray:
    """(safest found + tau) / 2 of each set; values (S, U, 5) to (S, L, U)."""
    found = scores(values[:, None], judge.values)
    return 0.5 * (found.safest + found.tau)


def folds_of(training: Table) -> NDArray[np.intp]:
    """The fold of each unit: whole terrains if there are enough of them, else units."""
    _, place = np.unique(training.places, return_inverse=True)
    if place.max() + 1 < FOLDS:
        place = np.arange(len(training))
    return place % FOLDS


def _checked(training: Table, families: Sequence[Family]) -> Judgement:
    if strange := {*training.split.tolist()} - {"train"}:
        raise ArgumentError("training.split", sorted(strange), '"train" only')
    if not any(family.simple for family in families):
        raise ArgumentError("families", [f.name for f in families], "one of them simple")
    judge = closed_loop(training)
    if not judge.decided.any():
        raise ArgumentError("training", str(training.path), "units with a decided set")
    return judge


def _best_simple(families: Sequence[Family], totals: Sequence[float] | FloatArray) -> int:
    simple = [family.simple for family in families]
    return int(np.argmax(np.where(simple, totals, -np.inf)))


def _winner(challengers: Sequence[Challenger], best: Challenger) -> Challenger:
    """The challenger of greatest gain among those that are certainly better, or the best."""
    better = [each for each in challengers if each.gain.low > 0.0]
    return max(better, key=lambda each: each.gain.mean, default=best)


def _per_unit(values: FloatArray, judge: Judgement) -> FloatArray:
    """The objective summed over a unit's decided sets, (S, U, 5) to (S, U)."""
    return np.where(judge.decided, objective(values, judge), 0.0).sum(axis=1)


def _held_out(gain: FloatArray, folds: NDArray[np.intp]) -> FloatArray:
    """A family's objective in each unit when fitted without the unit's fold, shape (U,)."""
    found, total = np.empty(gain.shape[1]), gain.sum(axis=1)
    for fold in np.unique(folds):
        inside = folds == fold
        found[inside] = gain[np.argmax(total - gain[:, inside].sum(axis=1)), inside]
    return found


def _products_held_out(
    families: Sequence[Family],
    values: Sequence[FloatArray],
    gains: Sequence[FloatArray],
    judge: Judgement,
    folds: NDArray[np.intp],
) -> FloatArray:
    """The same for the best product, its two families and its weight chosen anew in each fold."""
    found = np.empty(len(folds))
    for fold in np.unique(folds):
        inside = folds == fold
        kept = [gain[:, ~inside].sum(axis=1) for gain in gains]
        chosen = [v[np.argmax(each)] for v, each in zip(values, kept, strict=True)]
        leader = _best_simple(families, [float(each.max()) for each in kept])
        gain = _per_unit(_mixes(chosen, leader), judge)
        found[inside] = gain[np.argmax(gain[:, ~inside].sum(axis=1)), inside]
    return found


def _mixes(chosen: Sequence[FloatArray], leader: int) -> FloatArray:
    """Products of the best simple family with each other one, at each weight."""
    others = [each for k, each in enumerate(chosen) if k != leader]
    return np.stack([mixed(chosen[leader], other, w) for other in others for w in WEIGHTS])


def _best_product(
    choices: Sequence[Setting], chosen: Sequence[FloatArray], leader: int, judge: Judgement
) -> Setting:
    others = [each for k, each in enumerate(choices) if k != leader]
    products = [Product(choices[leader], other, w) for other in others for w in WEIGHTS]
    gain = _per_unit(_mixes(chosen, leader), judge).sum(axis=1)
    return products[int(np.argmax(gain))]


def _intervals(draws: Bootstrap, per_unit: FloatArray, number: NDArray[np.int64]) -> list[Interval]:
    """Mean per decided set of sums per unit (S, U), with intervals."""
    with np.errstate(invalid="ignore", divide="ignore"):
        resampled = (per_unit @ draws.weights.T) / (draws.weights @ number)
    return draws.summary(per_unit.sum(axis=1) / number.sum(), resampled)
