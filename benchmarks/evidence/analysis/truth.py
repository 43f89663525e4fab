"""Judges: what says how dangerous the flights of a set really are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

from benchmarks.evidence.analysis.table import FLIGHTS, LEVELS, MEMBERS, Table
from ompl_risk import Lp, Sobolev
from ompl_risk._arrays import FloatArray

PC_NORMS = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))
"""The paper's judges: these norms of P_c(t)."""
LEAST_HITS = 10
"""A set is decided only if one of its flights collided in so many rollouts, and ..."""
SIGNIFICANCE = 0.05
"""... its riskiest and safest flight differ at this level, corrected for the choice of two of five
(ten pairs, Bonferroni)."""
PAIRS = math.comb(FLIGHTS, 2)


@dataclass(frozen=True, eq=False)
class Judgement:
    """What J judges say of U units.

    Args:
        names: of the judges, (J,).
        values: of each flight, the greater the riskier, shape (J, U, 5).
        decided: whether the judge can tell the unit's flights apart, shape (J, U).
    """

    names: tuple[str, ...]
    values: FloatArray
    decided: NDArray[np.bool_]


def closed_loop(table: Table) -> Judgement:
    """Collision probabilities of the closed-loop simulation, a judge for each level."""
    probabilities = table.hits / table.rollouts[..., None]
    return Judgement(LEVELS, probabilities, decided(table))


def paper(table: Table) -> Judgement:
    """Norms of the paper's P_c(t); it is computed without noise, so all that differ are decided."""
    values = np.stack([table.profiles.norm(n, table.profiles.pc) for n in PC_NORMS])
    values = values.reshape(len(PC_NORMS), -1, FLIGHTS)
    names = tuple(f"{norm.label} of P_c" for norm in PC_NORMS)
    return Judgement(names, values, values.max(axis=-1) > values.min(axis=-1))


def decided(table: Table) -> NDArray[np.bool_]:
    """Sets in which the riskiest and the safest flight certainly differ, shape (3, U).

    At least one flight collided in `LEAST_HITS` rollouts, and McNemar's exact test between the
    flights of most and of fewest collisions, on rollouts paired by common random numbers, is
    significant after correction for the ten pairs that could have been chosen.
    """
    hits = table.hits
    enough = hits.max(axis=-1) >= LEAST_HITS
    return enough & (PAIRS * mcnemar(table) <= SIGNIFICANCE)


def certain(table: Table) -> NDArray[np.bool_]:
    """Decided sets in which the safest flight certainly differs from each other one, shape (3, U).

    McNemar's exact test between it and each of the four, corrected as in `decided`.
    """
    order = table.hits.argsort(axis=-1, kind="stable")
    tests = [_mcnemar(table, order[..., k], order[..., 0]) for k in range(1, FLIGHTS)]
    return decided(table) & (PAIRS * np.max(tests, axis=0) <= SIGNIFICANCE)


def mcnemar(table: Table) -> FloatArray:
    """Two-sided exact p value of the riskiest against the safest flight, shape (3, U).

    With b rollouts in which the one alone collides and c in which the other does,

        p = min(1, 2 P(X <= min(b, c))),    X binomial of b + c trials and 1/2.

    Reference: McNemar, Psychometrika 12 (1947).
    """
    return _mcnemar(table, table.hits.argmax(axis=-1), table.hits.argmin(axis=-1))


def _mcnemar(table: Table, one: NDArray[np.intp], other: NDArray[np.intp]) -> FloatArray:
    """The same of two flights of each set, by their numbers, shapes (3, U)."""
    most, fewest = MEMBERS.T[one], MEMBERS.T[other]
    b = (table.patterns * most * (1 - fewest)).sum(axis=-1)
    c = (table.patterns * fewest * (1 - most)).sum(axis=-1)
    return np.minimum(1.0, 2.0 * binom.cdf(np.minimum(b, c), b + c, 0.5))
