"""Does the expected number of collisions give the probability itself, not only the order?

For each level the deviation sigma and the correlation time of a `CrossingRate` are those of
greatest likelihood on the training flights, hits being binomial with the probability
1 - (1 - P0) exp(-N): P0 that of a collision at the start, N the expected entries thereafter. On
test flights the predictions are compared with what happened. P0 + N bounds the probability if the
errors are what the formula takes them for; flights whose probability is certainly greater (lower
limit of its 95 % interval) are counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks.evidence.analysis.settings import ExpectedCollisions
from benchmarks.evidence.analysis.table import LEVELS, Table
from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.probability.proportion import clopper_pearson

LEAST = 1e-9
"""No prediction is more certain than this."""
GROUPS = 10


class Calibration(NamedTuple):
    """Predictions and what happened on the test flights of a level.

    Attributes:
        level: its name.
        setting: the rate, fitted on training.
        expected: P0 + N of each flight, shape (F,).
        predicted: the probability that it stands for, shape (F,).
        observed: share of rollouts that collided, shape (F,).
        exceeding: share of flights whose probability is certainly above the expected number.
    """

    level: str
    setting: ExpectedCollisions
    expected: FloatArray
    predicted: FloatArray
    observed: FloatArray
    exceeding: float

    def groups(self) -> tuple[FloatArray, FloatArray]:
        """Means of predictions and of what happened, in tenths of the flights by prediction."""
        order = np.argsort(self.predicted, kind="stable")
        parts = [part for part in np.array_split(order, GROUPS) if len(part)]
        means = [(self.predicted[part].mean(), self.observed[part].mean()) for part in parts]
        predicted, observed = np.array(means).T
        return predicted, observed


def calibrate(
    training: Table, test: Table, rates: Sequence[ExpectedCollisions]
) -> tuple[Calibration, ...]:
    """Fit a rate for each level on training units, and predict the test flights with it.

    Raises:
        ArgumentError: `training` has units of another split.
    """
    if strange := {*training.split.tolist()} - {"train"}:
        raise ArgumentError("training.split", sorted(strange), '"train" only')
    predictions = np.stack([_probability(*rate.parts(training.profiles)) for rate in rates])
    found = []
    for level, name in enumerate(LEVELS):
        best = rates[int(np.argmax(_likelihoods(predictions, training, level)))]
        initial, entries = best.parts(test.profiles)
        hits = test.hits[level].ravel()
        rollouts = np.repeat(test.rollouts[level], test.hits.shape[-1])
        low = np.array(
            [clopper_pearson(h, int(n), 0.95)[0] for h, n in zip(hits, rollouts, strict=True)]
        )
        found.append(
            Calibration(
                name, best, initial + entries, _probability(initial, entries), hits / rollouts,
                float(np.mean(low > initial + entries)),
            )
        )  # fmt: skip
    return tuple(found)


def _probability(initial: FloatArray, entries: FloatArray) -> FloatArray:
    return np.clip(1.0 - (1.0 - initial) * np.exp(-entries), LEAST, 1.0 - LEAST)


def _likelihoods(predictions: FloatArray, table: Table, level: int) -> FloatArray:
    """Logarithm of each rate's binomial likelihood, but for a constant."""
    hits = table.hits[level].ravel()
    misses = np.repeat(table.rollouts[level], table.hits.shape[-1]) - hits
    return np.log(predictions) @ hits + np.log1p(-predictions) @ misses
