"""An estimate in a sentence, and as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ompl_risk.ranking.export import number

if TYPE_CHECKING:
    from ompl_risk.simulation.estimates.estimate import CollisionEstimate

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Of the quantiles of least clearance that are written."""


def sentence(estimate: CollisionEstimate) -> str:
    """The probability with its bounds and counts, never a bare 0; see ``str(estimate)``."""
    sure = f"({100 * estimate.confidence:.4g} %)"
    says = f"{estimate.hits:,} of {estimate.rollouts:,}"
    if estimate.hits == 0:
        says += f", at most {short(estimate.high)} {sure}"
    else:
        ends = f"{short(estimate.low)} to {short(estimate.high)}"
        says = f"{short(estimate.probability)}, {ends} {sure}, {says}"
        if estimate.weights is not None:
            sure_bound = short(estimate.upper_bound())
            says += f" weighted, whatever was missed at most {sure_bound}"
        others = (f"{n:,} {how}" for how, n in estimate.ended.items() if n and how != "touched")
        says += "".join(f", {each}" for each in others)
    return f"{estimate.name}: {says}" if estimate.name else says


def as_dict(estimate: CollisionEstimate) -> dict[str, Any]:
    """Plain data; see ``CollisionEstimate.to_dict``."""
    quantiles = zip(LEVELS, estimate.quantiles(LEVELS), strict=True)
    return {
        "units": {"time": "s", "position": "m", "clearance": "m"},
        "name": estimate.name,
        "says": str(estimate),
        "probability": estimate.probability,
        "low": estimate.low,
        "high": estimate.high,
        "confidence": estimate.confidence,
        "upper_bound": estimate.upper_bound(),
        "hits": estimate.hits,
        "ended": estimate.ended,
        "rollouts": estimate.rollouts,
        "seed": estimate.seed,
        "looks": estimate.looks,
        "weighted": estimate.weights is not None,
        "effective_rollouts": estimate.effective_rollouts,
        "equivalent_rollouts": number(estimate.equivalent_rollouts),
        "least_clearance": {f"{level:g}": number(d) for level, d in quantiles},
        "collisions": {"times": estimate.times.tolist(), "positions": estimate.places.tolist()},
    }


def short(p: float) -> str:
    """A probability to three digits, with a short exponent."""
    text = f"{p:.3g}" if p >= 1e-3 or p == 0.0 else f"{p:.2e}"
    mantissa, mark, exponent = text.partition("e")
    return f"{mantissa}e{int(exponent)}" if mark else mantissa
