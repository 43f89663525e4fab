"""What is tried: families of settings with the grid of their parameters."""

from __future__ import annotations

import math
from collections.abc import Iterable

from benchmarks.evidence.analysis.fitting import Family
from benchmarks.evidence.analysis.settings import (
    FAR,
    PAPER,
    CorrectedCap,
    CorrectedTail,
    ExpectedCollisions,
    Integrand,
    NormOf,
    OfDistance,
    OutcrossingOf,
)
from ompl_risk import InverseDistance, Lp, Norm, Sobolev
from ompl_risk.avoidance import Avoidance, FlatCap, GaussianTail
from ompl_risk.probability.crossings import CrossingRate
from ompl_risk.probability.outcrossing import Outcrossing

REACHES = (20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0, 80.0, 100.0, 140.0, 200.0, 400.0)
"""Of d0 and of the ball's radius r [m]."""
DEVIATIONS = (4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0, 17.0, 20.0, 30.0, 50.0)
"""Of sigma [m]."""
CUTS = (4.0, 8.0)
"""Of d0 / sigma: where the tail ends."""
TIME_SCALES = (0.1, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0)
"""Of tau [s]."""
EXPONENTS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 16.0, math.inf)
"""Of p."""
VERTICAL = (4.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0)
ISOTROPIC = (2.0, 4.0, 8.0, 12.0)
"""Of the two deviations of the corrected tail [m]."""
CORRELATION_TIMES = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
"""Of the rate's errors [s]."""

PASSING, LASTING, TURNING = (8.0, 12.0), (6.0, 12.0), (4.0, 8.0, 12.0)
"""Of the two errors of `Outcrossing` [m], and of the time in which the passing one changes [s]."""

LPS = tuple(Lp(p) for p in EXPONENTS)
SOBOLEVS = tuple(Sobolev(1, time_scale=tau) for tau in TIME_SCALES)


def families() -> tuple[Family, ...]:
    """All of them, the paper's four with d0 tuned first."""
    near = tuple(InverseDistance(d0) for d0 in REACHES)
    caps = tuple(FlatCap(r) for r in REACHES)
    tails = tuple(GaussianTail(s, d0=cut * s) for s in DEVIATIONS for cut in CUTS)
    far = (InverseDistance(FAR),)
    corrected = (CorrectedTail(v, i) for v in VERTICAL for i in ISOTROPIC)
    rates = (CrossingRate(s, correlation_time=t) for s in DEVIATIONS for t in CORRELATION_TIMES)
    models = (
        Outcrossing(passing, lasting, correlation_time=time)
        for passing in PASSING for lasting in LASTING for time in TURNING
    )  # fmt: skip
    return (
        *(
            _family(f"{setting.norm.label} of 1/d, d0 tuned", (setting.norm,), near)
            for setting in PAPER
        ),
        _family("L^p of 1/d, p and d0 tuned", LPS, near),
        _family("H1 of 1/d, d0 = 100 m, τ tuned", SOBOLEVS, far),
        _family("H1 of 1/d, d0 and τ tuned", SOBOLEVS, near),
        _family("L^p of FlatCap, p and r tuned", LPS, caps),
        _family("H1 of FlatCap, r and τ tuned", SOBOLEVS, caps),
        _family("L^p of GaussianTail, p and σ tuned", LPS, tails),
        _family("H1 of GaussianTail, σ and τ tuned", SOBOLEVS, tails),
        family("L^p of corrected_cap, p and r tuned", LPS, map(CorrectedCap, REACHES)),
        family("L^p of corrected_tail, p and σ tuned", LPS, corrected),
        Family("expected collisions, σ and τ tuned", tuple(map(ExpectedCollisions, rates))),
        Family("outcrossing, errors tuned", tuple(map(OutcrossingOf, models))),
    )


def _family(name: str, norms: Iterable[Norm], avoidances: Iterable[Avoidance]) -> Family:
    return family(name, norms, (OfDistance(avoidance) for avoidance in avoidances))


def family(name: str, norms: Iterable[Norm], integrands: Iterable[Integrand]) -> Family:
    """Every norm of every integrand; those of an integrand stand together."""
    norms = tuple(norms)
    return Family(name, tuple(NormOf(n, each) for each in integrands for n in norms))
