"""Rollouts over any clearance: flown first, then checked from where they went.

What ``_kernels.watch`` does on the way over a terrain is done here afterwards, for many rollouts at
a time, with a clearance that only Python can ask. Ways are straight between two steps, so an
acceleration a bends them by a dt^2 / 8, at 40 m/s^2 and 50 Hz by 2 mm. On them d changes by at
most the distance travelled, and that which obstacles travel in the meantime: a piece whose ends
have clearances d0 and d1 and lie s apart stays above (d0 + d1 - s) / 2. Only pieces of which this
does not tell are halved, so that a clearance which takes long is asked as seldom as possible.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.air import LEFT_MAP, LOST_CONTROL, TOUCHED
from ompl_risk._kernels.watch import CONTACT, SEGMENT, TOLERANCE
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.plans import Plan
from ompl_risk.simulation.loop.point_plan import PointPlan
from ompl_risk.simulation.loop.rollouts import fly
from ompl_risk.simulation.loop.true_clearance import TrueClearance

MEMORY = 2**26
"""Bytes that the traces of a batch may take."""


def fly_checked(
    plan: Plan,
    clearance: Any,
    disturbances: Any,
    draws: Draws,
    *,
    threads: int | None = None,
) -> Outcomes:
    """Fly a plan once for each of the draws, over any clearance; as ``rollouts.fly``.

    Args:
        plan: what is flown, and by which vehicle.
        clearance: any clearance of points. An error of the map raises its terrains only; its
            distances are trusted to change by no more than one moves.
        disturbances: gusts, navigation and terrain error.
        draws: random numbers.
        threads: that fly; the clearance is asked in the caller's.

    Raises:
        ArgumentError: the clearance needs orientations, or moves without a bound of its speed.
    """
    count, steps = len(draws), len(plan.times) - 1
    size = max(1, min(count, MEMORY // (24 * (steps + 1))))
    outcomes = Outcomes.room(count)
    for first in range(0, count, size):
        rows = slice(first, min(first + size, count))
        part = Draws(draws.seeds[rows], draws.amplitudes[rows], draws.log_weights[rows])
        true = TrueClearance(clearance, disturbances, part.amplitudes)
        flown = fly(plan, _Heights(plan, true), disturbances, part, threads=threads, traced=1)
        checked = _Check(plan, true, flown).outcomes()
        for field in ("least", "when", "where", "collided", "endings"):
            getattr(outcomes, field)[rows] = getattr(checked, field)
    return outcomes.closed()


def begins(plan: Plan) -> float:
    """When the clock of moving obstacles says that a plan begins [s].

    The times of a plan begin at 0, and so do those of its outcomes; the trajectory that it follows
    may have begun at another one.
    """
    return float(plan.trajectory.t[0]) if isinstance(plan, PointPlan) else 0.0


class _Heights:
    """What gusts ask: how high the planned positions are, which may depend on the time."""

    def __init__(self, plan: Plan, true: TrueClearance) -> None:
        self.plan, self.true = plan, true

    def __call__(self, points: FloatArray) -> NDArray[np.float64]:
        return self.true.heights(points, begins(self.plan) + self.plan.times[: len(points)])


class _Pieces(NamedTuple):
    """Pieces of ways: whose, and times [steps] and clearances [m] at their ends."""

    rollout: NDArray[np.int64]
    t0: NDArray[np.float64]
    t1: NDArray[np.float64]
    d0: NDArray[np.float64]
    d1: NDArray[np.float64]

    def only(self, rows: NDArray[Any]) -> _Pieces:
        """Some of them."""
        return _Pieces(
            self.rollout[rows], self.t0[rows], self.t1[rows], self.d0[rows], self.d1[rows]
        )


class _Check:
    """The checks of a batch of rollouts, all together: breadth first.

    Times are in steps. ``end`` is the earliest contact that is known of a rollout, ``least`` its
    least clearance so far and ``at`` when that was.
    """

    def __init__(self, plan: Plan, true: TrueClearance, flown: Outcomes) -> None:
        self.plan, self.true, self.flown, self.traces = plan, true, flown, flown.traces
        self.begin, n, steps = begins(plan), len(flown), self.traces.shape[1] - 1
        ways = np.linalg.norm(np.diff(self.traces, axis=1), axis=2) * true.stretches()[:, None]
        self.way = np.zeros((n, steps + 1))
        np.cumsum(ways, axis=1, out=self.way[:, 1:])
        lost = flown.collided < np.inf
        self.last = np.full(n, float(steps))
        self.last[lost] = np.minimum(flown.collided[lost] / plan.dt, steps)
        self.end, self.least, self.at = np.full(n, np.inf), np.full(n, np.inf), np.zeros(n)

    def outcomes(self) -> Outcomes:
        """Least clearance and end of every rollout."""
        pieces = self._begin()
        while len(pieces.rollout):
            pieces = self._halved(self._open(pieces))
        return self._record()

    def _begin(self) -> _Pieces:
        """Pieces of SEGMENT steps."""
        knots = np.append(np.arange(0.0, self.traces.shape[1] - 1, SEGMENT), np.inf)
        rollout = np.repeat(np.arange(len(self.last)), len(knots))
        t = np.minimum(np.tile(knots, len(self.last)), self.last[rollout])
        d = self._asked(rollout, t)
        whole = (rollout[:-1] == rollout[1:]) & (t[:-1] < t[1:])
        return _Pieces(rollout[:-1], t[:-1], t[1:], d[:-1], d[1:]).only(whole)

    def _open(self, pieces: _Pieces) -> _Pieces:
        """The pieces that may hold a contact, or a clearance well below the least so far."""
        rollout, t0, t1, d0, d1 = pieces
        begin, dt = self.begin, self.plan.dt
        s = self._length(rollout, t1) - self._length(rollout, t0)
        s += self.true.travels(begin + dt * t0, begin + dt * t1)
        low = 0.5 * (d0 + d1 - s)
        hit = self.end[rollout] < np.inf
        safe = np.where(hit, CONTACT, np.maximum(self.least[rollout] - TOLERANCE, CONTACT))
        keep = (t0 < self.end[rollout]) & (low < safe)
        touching = keep & (s <= CONTACT)
        np.minimum.at(self.end, rollout[touching], t1[touching])
        return pieces.only(keep & ~touching)

    def _halved(self, pieces: _Pieces) -> _Pieces:
        """Both halves of each piece."""
        rollout, t0, t1, d0, d1 = pieces
        t = 0.5 * (t0 + t1)
        d = self._asked(rollout, t)
        both = _Pieces(
            np.concatenate([rollout, rollout]),
            *(np.concatenate(pair) for pair in ((t0, t), (t, t1), (d0, d), (d, d1))),
        )
        return both.only(np.argsort(both.rollout, kind="stable"))

    def _asked(self, rollout: NDArray[np.int64], t: FloatArray) -> NDArray[np.float64]:
        """Clearances [m] at times, which may be the least ones or contacts."""
        times = self.begin + t * self.plan.dt
        d = self.true(rollout, self._places(rollout, t), times)
        touching = d <= CONTACT
        np.minimum.at(self.end, rollout[touching], t[touching])
        order = np.argsort(-d, kind="stable")  # the last of a rollout's rows is its least
        order = order[d[order] < self.least[rollout[order]]]
        self.least[rollout[order]], self.at[rollout[order]] = d[order], t[order]
        return d

    def _places(self, rollout: NDArray[np.int64], t: FloatArray) -> NDArray[np.float64]:
        """Positions at times, shape (n, 3)."""
        i = np.minimum(t.astype(np.int64), self.traces.shape[1] - 2)
        before, after = self.traces[rollout, i], self.traces[rollout, i + 1]
        return before + (t - i)[:, None] * (after - before)

    def _length(self, rollout: NDArray[np.int64], t: FloatArray) -> NDArray[np.float64]:
        """Lengths of the ways up to times [m]."""
        i = np.minimum(t.astype(np.int64), self.way.shape[1] - 2)
        before, after = self.way[rollout, i], self.way[rollout, i + 1]
        return before + (t - i) * (after - before)

    def _record(self) -> Outcomes:
        """Contacts end a rollout, and else what ended it in flight."""
        hit, everything = self.end < np.inf, np.arange(len(self.end))
        lost = (self.flown.collided < np.inf) & ~hit
        at = np.where(hit, self.end, np.where(lost, self.last, self.at))
        where = self._places(everything, at)
        least = np.where(lost, -np.inf, self.least)
        when = at * self.plan.dt
        if hit.any():
            times = self.begin + when[hit]
            least[hit] = np.minimum(self.true(everything[hit], where[hit], times), 0.0)
        endings = np.where(lost, LOST_CONTROL, np.where(hit, TOUCHED, 0)).astype(np.int8)
        endings[hit & (least == -np.inf)] = LEFT_MAP
        collided = np.where(hit | lost, when, np.inf)
        return Outcomes(least, when, where, collided, endings, np.empty((len(at), 0, 3)))
