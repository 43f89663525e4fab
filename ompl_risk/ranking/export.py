"""The ranking as plain data, JSON and a pandas table."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ExtraError, FileError
from ompl_risk.norms import Norm
from ompl_risk.ranking.agreement import Agreement
from ompl_risk.ranking.assessment import Assessment, Estimate
from ompl_risk.ranking.attribution import Attribution

if TYPE_CHECKING:
    import pandas as pd

    from ompl_risk.ranking.result import Ranking


def as_dict(ranking: Ranking, segments: int) -> dict[str, Any]:
    """Plain data; see `Ranking.to_dict`."""
    pc, probability = ranking.pc_agreement, ranking.probability_agreement
    return {
        "units": {"duration": "s", "length": "m", "clearance": "m", "time": "s", "position": "m"}
        | {"norms": {n.label: norm_unit(n, of=ranking.avoidance.unit) for n in ranking.norms}},
        "avoidance": repr(ranking.avoidance),
        "duration_tolerance": number(ranking.duration_tolerance),
        "duration_spread": number(ranking.duration_spread),
        "durations_comparable": ranking.durations_comparable,
        "trajectories": [_assessment(a, segments) for a in ranking.assessments],
        "orders": {label: list(order) for label, order in ranking.orders.items()},
        "pc_orders": {label: list(order) for label, order in ranking.pc_orders.items()},
        "probability_order": list(ranking.probability_order),
        "pareto": {label: list(ranking.pareto(label)) for label in ranking.labels},
        "agreement": _agreement(ranking.agreement),
        "pc_agreement": None if pc is None else _agreement(pc),
        "probability_agreement": None if probability is None else _agreement(probability),
    }


def as_json(ranking: Ranking, path: str | Path | None, indent: int | None, segments: int) -> str:
    """Strict JSON; see `Ranking.to_json`."""
    text = json.dumps(
        as_dict(ranking, segments), indent=indent, allow_nan=False, ensure_ascii=False
    )
    if path is not None:
        try:
            Path(path).write_text(text + "\n", encoding="utf-8")
        except OSError as error:
            raise FileError(path, error.strerror or str(error)) from None
    return text


def as_frame(ranking: Ranking) -> pd.DataFrame:
    """A pandas table; see `Ranking.to_pandas`."""
    try:
        import pandas as pd
    except ImportError:
        raise ExtraError("pandas", "pandas") from None
    rows = [
        {
            "duration": a.duration,
            "length": a.length,
            "min_clearance": a.min_clearance,
            "collides": a.collides,
            **a.norms,
            **{f"PC {label}": value for label, value in a.pc_norms.items()},
            **(_estimate(a.estimate) or {}),
        }
        for a in ranking.assessments
    ]
    return pd.DataFrame(rows, index=pd.Index([a.name for a in ranking.assessments], name="name"))


def norm_unit(norm: Norm, *, of: str = "1/m") -> str:
    """Unit of the norm of a function in 1/m, or in 1."""
    p = norm.exponent
    if math.isinf(p):
        return of
    time = "s" if p == 1 else f"s^(1/{p:g})"
    return time + of.removeprefix("1")  # s/m of 1/m, s of a bare number


def number(value: float) -> float | str:
    """A number that strict JSON can hold: infinity becomes "inf", which float() reads back."""
    return float(value) if math.isfinite(value) else str(float(value))


def _assessment(a: Assessment, segments: int) -> dict[str, Any]:
    return {
        "name": a.name,
        "duration": a.duration,
        "length": a.length,
        "samples": len(a.trajectory),
        "min_clearance": number(a.min_clearance),
        "min_clearance_time": a.min_clearance_time,
        "min_clearance_position": a.min_clearance_position.tolist(),
        "collides": a.collides,
        "collision_time": a.collision_time,
        "collision_position": _point(a.collision_position),
        "norms": {label: number(value) for label, value in a.norms.items()},
        "pc_norms": {label: number(value) for label, value in a.pc_norms.items()},
        "probability": _estimate(a.estimate),
        "attribution": {
            label: None if part is None else _attribution(part, segments)
            for label, part in a.attribution.items()
        },
    }


def _estimate(estimate: Estimate | None) -> dict[str, Any] | None:
    """The probability with its bounds, and with what they rest on where the estimate tells."""
    if estimate is None:
        return None
    known = {field: getattr(estimate, field, None) for field in ("hits", "rollouts", "confidence")}
    return {
        "probability": float(estimate.probability),
        "probability_low": float(estimate.low),
        "probability_high": float(estimate.high),
        **{field: value for field, value in known.items() if value is not None},
    }


def _attribution(part: Attribution, segments: int) -> dict[str, Any]:
    return {
        "share": part.share,
        "start": part.start,
        "end": part.end,
        "time": part.time,
        "position": part.position.tolist(),
        "clearance": part.clearance,
        "sentence": part.sentence,
        "segments": part.segments(segments).tolist(),
    }


def _agreement(agreement: Agreement) -> dict[str, Any]:
    return {
        "rows": list(agreement.rows),
        "columns": list(agreement.columns),
        "kendall_tau_b": agreement.tau.tolist(),
    }


def _point(position: FloatArray | None) -> list[float] | None:
    return None if position is None else position.tolist()
