"""How well anything could do: the judge has a finite number of rollouts, and errs itself.

Two figures, between which a setting would come out that knew the true probabilities:

- *halves*: one half of the rollouts picks the safest flight by the other half. Both are noisier
  than the whole, so knowledge of the truth would do better.
- *repeated*: the rollouts, drawn again with replacement, pick the safest by the rollouts as they
  were. What was counted stands for the truth; its differences are larger than the true ones by
  the noise in them, so knowledge of the truth would hardly do as well.

Both keep the rollouts paired: it is drawn which of the flights collide together.
"""

from __future__ import annotations

import numpy as np

from benchmarks.evidence.analysis.metrics import Scores, scores
from benchmarks.evidence.analysis.table import MEMBERS, Table
from ompl_risk._arrays import FloatArray

DRAWS, SEED = 20, 0


def halves(table: Table, *, draws: int = DRAWS, seed: int = SEED) -> Scores:
    """Scores of one half of the rollouts by the other, averaged over draws, shape (3, U)."""
    random = np.random.default_rng(seed)
    one = np.empty((draws, *table.patterns.shape), dtype=np.int64)
    for where in np.ndindex(table.patterns.shape[:2]):
        counts = table.patterns[where]
        half = int(counts.sum()) // 2
        one[(slice(None), *where)] = random.multivariate_hypergeometric(
            counts, half, draws, method="marginals"
        )
    first, second = one @ MEMBERS, (table.patterns - one) @ MEMBERS
    rollouts = table.rollouts[..., None]
    return _averaged(
        first / np.maximum(rollouts // 2, 1), second / np.maximum(rollouts - rollouts // 2, 1)
    )


def repeated(table: Table, *, draws: int = DRAWS, seed: int = SEED) -> Scores:
    """Scores of rollouts drawn again by those counted, averaged over draws, shape (3, U)."""
    random = np.random.default_rng(seed)
    rollouts = table.rollouts
    shares = table.patterns / rollouts[..., None]
    again = random.multinomial(rollouts, shares, (draws, *rollouts.shape)) @ MEMBERS
    probabilities = table.hits / rollouts[..., None]
    return _averaged(again / rollouts[..., None], probabilities)


def _averaged(guess: FloatArray, truth: FloatArray) -> Scores:
    return Scores(*(each.mean(axis=0) for each in scores(guess, truth)))
