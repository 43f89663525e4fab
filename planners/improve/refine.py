"""Less risk in the same time: second-order refinement of a path, verified at the end."""

from __future__ import annotations

import math
import time
from typing import Any

from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive
from ompl_risk.motion import Risk
from ompl_risk.planners.improve.bounds import path_box
from ompl_risk.planners.improve.chain import Surroundings
from ompl_risk.planners.improve.descent import Limits
from ompl_risk.planners.improve.fields import Gradient, clearance_field, is_plain
from ompl_risk.planners.improve.judge import Judge, as_path
from ompl_risk.planners.improve.measure import Improvement, Measure, Outcome
from ompl_risk.planners.improve.simplify import ROUNDS, simplified, unchanged
from ompl_risk.planners.improve.stages import GAIN, SURROGATES, Found, Refiner, cheaper

SECONDS = 0.2
"""Computing time if nothing else is said [s]."""

DIFFERENCE = 1e-4
"""Step of numerical gradients, in units of d0."""


def refine(
    positions: ArrayLike,
    *,
    clearance: Any,
    risk: Risk,
    obstacles: Any = None,
    low: ArrayLike | None = None,
    high: ArrayLike | None = None,
    longest: float | None = None,
    seconds: float = SECONDS,
    gradient: Gradient | None = None,
    threads: int | None = None,
) -> Improvement:
    """Lower the norm of f along a path within its duration by moving its corners.

    Minimises ``norm^p + duration_weight duration`` over finely sampled paths near the given one by
    Newton steps subject to ``duration <= longest``: f is linear between the samples, its gradient
    points away from the nearest obstacle, and Gauss-Newton second derivatives couple neighbouring
    corners only. The time that straightening saves goes into a wider berth. Corners are then left
    out again, for at most a fiftieth of the gain and of what is left of the cost. The same is done
    from the path as `simplify` leaves it, and the better result counts.

    Whatever comes back has passed the exact motion check against `obstacles`, stays in the box,
    takes no longer than `longest`, and its norm, computed afresh to 1e-4, is no higher than that of
    the given path; else the given path comes back, and `reason` says so. The refinement is local:
    it changes no way around a mountain. Deterministic unless time runs out.

    For ``Lp(inf)`` it minimises the L^8, L^16 and L^32 norms one after the other; the maximum
    itself decides.

    Args:
        positions: corners of a path [m], shape (n, 3).
        clearance: d(q), callable with points (n, 3) [m]. Over terrain all is compiled; anything
            else is asked in batches, with six more distances for each near point unless
            `gradient` is given, and takes far longer.
        risk: the norm, f, the speed, and `duration_weight`.
        obstacles: a clearance that has to stay positive, such as `Problem.obstacles`; `clearance`
            if left out.
        low: least coordinates [m], shape (3,); no limit if left out.
        high: greatest coordinates [m], shape (3,).
        longest: greatest duration [s]; that of the given path if left out.
        seconds: computing time after which the best so far is returned [s], about; it ends early
            when there is nothing more to gain.
        gradient: of `clearance`, points (n, 3) to vectors (n, 3), in place of differences.
        threads: of compiled code, at most.

    Returns:
        The path and its figures before and after.

    Raises:
        ArgumentError: not a path, a corner outside the box, not a clearance or one that answers
            with NaN, or a number out of range.

    Reference: Nair and Kobilarov, eqs. (3) to (5), for what is minimised.
    """
    begin = time.monotonic()
    path = as_path(positions)
    box = path_box(low, high, path, clearance)
    deadline = begin + positive("seconds", seconds)
    judge = Judge(clearance, risk, obstacles, threads=threads)
    before = judge.measure(path)
    limit = before.duration if longest is None else positive("longest", longest)
    if (obstacle := _obstacle(path, before, limit, judge)) is not None:
        return unchanged(path, before, obstacle, begin, judge)
    around = _surroundings(clearance, obstacles, risk, gradient)
    refiner = Refiner(judge, around, Limits(*box, limit, deadline), before, risk.weight)
    found = _search(refiner, path, judge)
    if found is None and risk.duration_weight and not refiner.late:  # time was worth too much
        found = _search(refiner.unweighted(), path, judge)
    if found is None or not (before.duration > limit or refiner.gains(found)):
        reason = "out of time" if refiner.late else "nothing better is near"
        return unchanged(path, before, reason, begin, judge)
    return _improvement(found.corners, before, judge, begin, late=refiner.late)


def _search(refiner: Refiner, path: FloatArray, judge: Judge) -> Found | None:
    """Refine the path, and the path as `simplify` leaves it."""
    best = refiner.search(path)
    if not refiner.late:
        straighter = simplified(path, judge, ROUNDS, deadline=refiner.deadline)
        best = cheaper(best, refiner.judged(straighter))
        best = cheaper(best, refiner.search(straighter))
    return best


def _obstacle(path: FloatArray, before: Measure, limit: float, judge: Judge) -> str | None:
    """Why refinement would be in vain."""
    if (fault := judge.first_fault(path)) is not None:
        return f"motion {fault} of it is not free"
    straight = judge.duration(path[[0, -1]])
    if limit < straight:
        return f"longest = {limit:g} s, and the straight line takes {straight:.6g} s"
    if before.duration <= limit <= straight * (1.0 + 1e-9):
        return "the straight line leaves no time for another way"
    if before.norm == 0.0 and before.duration <= limit:
        return "there is no risk to lower"
    if math.isinf(judge.risk.exponent):
        ends = judge.norm(path[[0, 0]]), judge.norm(path[[-1, -1]])
        if max(ends) >= before.norm * (1.0 - GAIN) and before.duration <= limit:
            return "the greatest risk is that of its start or goal"
    return None


def _surroundings(
    clearance: Any, obstacles: Any, risk: Risk, gradient: Gradient | None
) -> Surroundings:
    step = DIFFERENCE * risk.avoidance.d0
    field = clearance_field(clearance, gradient=gradient, step=step)
    gate, margin = None, 0.0
    if obstacles is None or obstacles is clearance:
        pass
    elif is_plain(clearance) and is_plain(obstacles) and clearance.field is obstacles.field:
        margin = obstacles.radius - clearance.radius
    else:
        gate = clearance_field(obstacles, gradient=None, step=step)
    return Surroundings(field, gate, margin, risk.avoidance, risk.speed, risk.time_scale)


def _improvement(
    corners: FloatArray, before: Measure, judge: Judge, begin: float, *, late: bool
) -> Improvement:
    corners.setflags(write=False)
    notes = ["by way of " + ", ".join(f"L{p:g}" for p in SURROGATES)] * math.isinf(
        judge.risk.exponent
    )
    notes += ["out of time"] * late
    return Improvement(
        Outcome.IMPROVED,
        corners,
        before,
        judge.measure(corners),
        ", ".join(notes),
        time.monotonic() - begin,
        judge.compiled,
    )
