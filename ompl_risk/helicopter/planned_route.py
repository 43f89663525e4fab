"""A route as it was planned: trims and manoeuvres in their order, and the state at any time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive
from ompl_risk._kernels import deviations, planned, rigid_body
from ompl_risk._kernels.pieces import (
    CLIMB,
    COLUMNS,
    DURATION,
    HEADING,
    KIND,
    MANOEUVRE,
    NUMBER,
    SPEED,
    TRIM,
    TURN,
    Tracks,
    X,
    joined_tracks,
)
from ompl_risk.helicopter.legs import Leg, legs_of
from ompl_risk.helicopter.library import PrimitiveLibrary
from ompl_risk.helicopter.trims import Trim
from ompl_risk.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class PlannedRoute:
    """Legs that follow each other. After the last one the vehicle stays in its last trim.

    Args:
        library: what the legs are made of.
        legs: at least one.
    """

    library: PrimitiveLibrary
    legs: tuple[Leg, ...]

    @property
    def duration(self) -> float:
        """Time to the end [s]."""
        return self.legs[-1].begin + self.legs[-1].duration

    @property
    def goal(self) -> FloatArray:
        """The state at the end, shape (13,)."""
        end = self.legs[-1].end
        return self.legs[-1].last.state(end[:3], end[3])

    @property
    def start(self) -> FloatArray:
        """The state at the beginning, shape (13,)."""
        first = self.legs[0].motion
        pose = self.legs[0].pose
        return (first if isinstance(first, Trim) else first.first).state(pose[:3], pose[3])

    def at(self, times: FloatArray) -> FloatArray:
        """States at increasing times [s], shape (n, 13)."""
        rows, begins, trims = self._table
        out = np.empty((len(times), rigid_body.STATE))
        given = self.library.helicopter.given
        planned.planned(times, rows, begins, trims, *_flights(self.library), given, out)
        return out

    def trajectory(self, name: str = "", *, step: float) -> Trajectory:
        """The planned states with attitudes and velocities in the world.

        Args:
            name: what tables and figures call it.
            step: time between samples [s]; the last interval may be shorter.

        Raises:
            ArgumentError: a step that is not positive, or a route of no duration.
        """
        count = math.ceil(self.duration / positive("step", step) - 1e-9)
        times = np.append(step * np.arange(count), self.duration)
        states = self.at(times)
        return Trajectory(
            times,
            states[:, :3],
            name,
            orientations=states[:, 3:7],
            velocities=deviations.velocities_in_world(states),
        )

    @cached_property
    def _table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Rows and times of the legs and of the trim after them, and states of the trims."""
        legs = (*self.legs, Leg(self.legs[-1].last, self.duration, 0.0, self.legs[-1].end))
        trims = list(dict.fromkeys(leg.motion for leg in legs if isinstance(leg.motion, Trim)))
        place = {trim: k for k, trim in enumerate(trims)}
        rows = np.zeros((len(legs), COLUMNS))
        for row, leg in zip(rows, legs, strict=True):
            row[DURATION], row[X : HEADING + 1] = leg.duration, leg.pose
            if isinstance(leg.motion, Trim):
                row[KIND], row[NUMBER] = TRIM, place[leg.motion]
                row[SPEED], row[CLIMB], row[TURN] = leg.motion.key
            else:
                row[KIND], row[NUMBER] = MANOEUVRE, leg.motion.number
        return rows, np.array([leg.begin for leg in legs]), np.stack([t.state() for t in trims])


@lru_cache(maxsize=4)
def _flights(library: PrimitiveLibrary) -> tuple[Tracks, FloatArray, FloatArray]:
    """Tracks, states and controls of all manoeuvres; controls with a row more, as states have."""
    all_of = library.manoeuvres
    states = np.concatenate([np.empty((0, 13)), *(m.states for m in all_of)])
    padded = (np.vstack([m.controls, m.controls[-1:]]) for m in all_of)
    controls = np.concatenate([np.empty((0, 4)), *padded])
    return joined_tracks([m.track for m in all_of], library.dt), states, controls


def planned_route(library: PrimitiveLibrary, start: ArrayLike, pieces: ArrayLike) -> PlannedRoute:
    """The route of pieces from a vertex on.

    A trim that goes on in the next piece is one leg; trims of no duration are left out; trims of
    more than 60 s become several legs.

    Args:
        library: what the pieces refer to.
        start: x, y, z [m], heading [rad] and the index of the speed, shape (5,).
        pieces: see ``ompl_risk._kernels.pieces``, shape (m, 10), m >= 1.

    Raises:
        ArgumentError: a wrong shape, a number out of range, a speed or trim or manoeuvre that the
            library lacks, or pieces that do not join: names the first.
    """
    return PlannedRoute(library, legs_of(library, start, pieces))
