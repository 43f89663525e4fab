"""Where settings win and lose: test units by what their flights are like, by ground and by level.

Three measures of a unit, each the mean over its five flights:

- *narrow passes*: share of time [%] closer than 50 m to ground that lies aside rather than below
  (the upward component of the gradient of d is below 0.8: more than 37 degrees off the vertical);
- *long exposure*: time [s] closer than 30 m to the ground;
- *fast approach*: greatest rate at which d falls [m/s] while below 50 m.

The test units are cut into thirds by each, so that the strata hold as many units each whatever the
campaign's terrain is like.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.evidence.analysis.findings import Findings
from benchmarks.evidence.analysis.profiles import Profiles
from benchmarks.evidence.analysis.statistics import Interval
from benchmarks.evidence.analysis.table import FLIGHTS
from ompl_risk._arrays import FloatArray

NEAR, CLOSE, ASIDE = 50.0, 30.0, 0.8
MEASURES = {"narrow passes": "%", "long exposure": "s", "fast approach": "m/s"}
THIRDS = ("least", "middle", "most")


class Stratum(NamedTuple):
    """Some of the test sets.

    Attributes:
        group: what they are sorted by.
        name: which of them.
        counted: the decided sets among them, shape (L, U).
        scores: mean of safest found and of tau in them for each row, with intervals.
    """

    group: str
    name: str
    counted: NDArray[np.bool_]
    scores: dict[str, list[Interval]]


@lru_cache(maxsize=2)
def strata(findings: Findings) -> tuple[Stratum, ...]:
    """All strata that hold a decided set."""
    return tuple(
        Stratum(group, name, counted, {metric: _means(findings, metric, counted)
                                       for metric in ("safest", "tau")})
        for group, name, counted in _parts(findings) if counted.any()
    )  # fmt: skip


def _means(findings: Findings, metric: str, counted: NDArray[np.bool_]) -> list[Interval]:
    return findings.draws.intervals(getattr(findings.by_judge, metric), counted)


def _parts(findings: Findings) -> Iterator[tuple[str, str, NDArray[np.bool_]]]:
    """What the test sets are sorted by, which of them, and the decided ones among them."""
    decided = findings.judge.decided
    for group, measured in measures(findings.test.profiles).items():
        edges = np.quantile(measured, [1 / 3, 2 / 3])
        third = np.searchsorted(edges, measured, side="right")
        for k, name in enumerate(THIRDS):
            inside = measured[third == k]
            if len(inside):
                extent = f"{inside.min():.3g} to {inside.max():.3g} {MEASURES[group]}"
                yield group, f"{name} ({extent})", decided & (third == k)
    for kind in np.unique(findings.test.terrain):
        yield "ground", str(kind), decided & (findings.test.terrain == kind)
    for name in findings.judge.names:
        yield "level", name, findings.masks[name]


def measures(profiles: Profiles) -> dict[str, FloatArray]:
    """The three measures of each unit, shape (U,) each."""
    d, near = profiles.d, profiles.d < NEAR
    aside = (near & (profiles.up < ASIDE)).astype(np.float64)
    close = (d < CLOSE).astype(np.float64)
    falling = np.append(-np.diff(d) / np.diff(profiles.clock), 0.0)
    falling[profiles.starts[1:] - 1] = 0.0  # from one flight to the next
    closing = np.maximum(falling, 0.0) * near
    each = (
        100.0 * profiles.integral(aside) / profiles.durations,
        profiles.integral(close),
        profiles.greatest(closing),
    )
    return {
        name: of_flights.reshape(-1, FLIGHTS).mean(axis=1)
        for name, of_flights in zip(MEASURES, each, strict=True)
    }
