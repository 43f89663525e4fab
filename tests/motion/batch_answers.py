"""What batches of motions are asked, and the risk they are asked for."""

from ompl_risk.avoidance import InverseDistance
from ompl_risk.motion import Risk
from ompl_risk.norms import Sobolev

D0, SPEED = 30.0, 20.0


def risk_of(norm=None, **options):
    return Risk(InverseDistance(D0), norm or Sobolev(1), **{"speed": SPEED, **options})


def every_answer(batch, a, b):
    d_a, d_b = batch.clearances(a), batch.clearances(b)
    return {
        "clearances": d_a,
        "are_free": batch.are_free(a, b),
        "costs": batch.costs(a, b),
        "durations": batch.durations(a, b),
        "least_durations": batch.least_durations(a, b),
        "heuristics": batch.heuristics(a, b, d_a, d_b),
    }
