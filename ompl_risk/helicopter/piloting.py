"""The pilot: flies the legs of a route in whole steps, beside the plan and back onto it."""

from __future__ import annotations

import math
from itertools import groupby

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import rigid_body
from ompl_risk.helicopter.legs import Leg
from ompl_risk.helicopter.planned_route import PlannedRoute
from ompl_risk.helicopter.poses import moved
from ompl_risk.helicopter.primitives import Manoeuvre
from ompl_risk.helicopter.settling import Settler
from ompl_risk.helicopter.tracking import Tracker
from ompl_risk.helicopter.trims import Trim

SHORTEST, LONGEST, GRID = 3.0, 10.0, 0.5
"""How long settling may take [s]: a multiple of ``GRID``, as long as the trim lasts."""

LEAD_IN = 5
"""Steps of a trim before settling, in which the input comes back to the trim's."""

LARGEST_DISTANCE, LARGEST_ANGLE = 0.4, math.radians(0.6)
"""Greatest deviations that settling may cause [m, rad]: else the vehicle is led back slowly."""

PLACE, ANGLE = 0.5, 0.015
"""Deviations that are equally bad [m, rad], in the choice of whole steps."""


class Pilot:
    """Flies legs one after the other, from the state in which the one before has left the vehicle.

    Trims are held for whole steps, and stretched or shortened for that by half a step or so. What
    this does to place and heading is made up for while the flight goes on (``Tracker``), and ended
    exactly in trims that last (``Settler``).

    Args:
        route: the plan.

    Attributes:
        steps: flown so far.
    """

    def __init__(self, route: PlannedRoute) -> None:
        library = route.library
        model = (library.helicopter, library.limits, library.dt)
        self._route, self._dt = route, library.dt
        self._tracker, self._settler = Tracker(*model), Settler(*model)
        self._states: list[FloatArray] = [route.start[None]]
        self._controls: list[FloatArray] = []
        self._times: list[FloatArray] = [np.zeros(1)]
        self._inputs = self._planned_inputs()
        self.steps = 0

    @property
    def state(self) -> FloatArray:
        """Where the vehicle is now, shape (13,)."""
        return self._states[-1][-1]

    def flown(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """States (n + 1, 13), controls (n, 4), and planned times of the states [s], (n + 1,)."""
        controls = np.concatenate([np.empty((0, 4)), *self._controls])
        return np.concatenate(self._states), controls, np.concatenate(self._times)

    def fly(self, leg: Leg) -> None:
        """Fly a trim or a manoeuvre of the route."""
        steps = round(leg.duration / self._dt)
        if isinstance(leg.motion, Trim):
            steps = max(round((leg.duration - self._lead(leg, leg.motion)) / self._dt), 0)
            on_time = round((leg.begin + leg.duration) / self._dt) - self.steps
            on_time = min(max(on_time, steps - 1), steps + 1)
            if any(self._settle(leg, leg.motion, n) for n in dict.fromkeys((on_time, steps))):
                return
        if steps:
            self._track(leg, np.linspace(leg.begin, leg.begin + leg.duration, steps + 1))

    def _lead(self, leg: Leg, trim: Trim) -> float:
        """By how much to shorten a trim because the vehicle is ahead of where it begins [s].

        What minimises the deviations afterwards: of the place if nothing is done about it, and of
        the heading if a turn is cut short, each as a part of what is tolerable.
        """
        if trim.speed == 0.0:
            return 0.0
        ahead, heading = self.state[:2] - leg.pose[:2], leg.pose[3]
        lead = (ahead[0] * math.cos(heading) + ahead[1] * math.sin(heading)) / trim.speed
        place, turned = (trim.speed / PLACE) ** 2, (trim.turn / ANGLE) ** 2
        return float(lead * place / (place + turned))

    def _settle(self, leg: Leg, trim: Trim, steps: int) -> bool:
        """Fly a trim so that it ends exactly as planned, if there is time to do it gently."""
        seconds = math.floor((steps - LEAD_IN) * self._dt / GRID + 1e-9) * GRID
        if seconds < SHORTEST:
            return False
        window = round(min(seconds, LONGEST) / self._dt)
        rest = steps - LEAD_IN - window
        settled = leg.begin + leg.duration - rest * self._dt
        times = np.linspace(leg.begin, settled, LEAD_IN + window + 1)
        before = len(self._controls)
        self._track(leg, times[: LEAD_IN + 1])
        pose = moved(leg.end, trim.displacement(-rest * self._dt))
        found = self._settler.settle(trim, self.state, pose, window, self._controls[-1][-1])
        gentle = found.distance <= LARGEST_DISTANCE and found.angle <= LARGEST_ANGLE
        if not (found.succeeded and gentle):
            self._take_back(before)
            return False
        self._append(times[LEAD_IN:], found.controls, found.states)
        if rest:
            self._hold(trim, settled + np.arange(rest + 1, dtype=np.float64) * self._dt)
        return True

    def _hold(self, trim: Trim, times: FloatArray) -> None:
        """Fly on in a trim that the vehicle is in: one and the same input."""
        controls = np.tile(trim.control, (len(times) - 1, 1))
        states = np.empty((len(times), rigid_body.STATE))
        given = self._route.library.helicopter.given
        rigid_body.rollout(self.state, controls, self._dt, given, states)
        self._append(times, controls, states)

    def _track(self, leg: Leg, times: FloatArray) -> None:
        """Fly beside the plan, which has the vehicle in place after each step at these times."""
        inputs = self._inputs.get(leg.begin) if isinstance(leg.motion, Manoeuvre) else None
        inputs = leg.last.control[None] if inputs is None else inputs
        before = self._controls[-1][-1] if self._controls else inputs[0]
        references = self._route.at(times)
        controls, states = self._tracker.track(leg.motion, inputs, references, self.state, before)
        self._append(times, controls, states)

    def _planned_inputs(self) -> dict[float, FloatArray]:
        """Inputs of the manoeuvres, by the times at which they begin."""
        found: dict[float, FloatArray] = {}
        flown = [leg for leg in self._route.legs if round(leg.duration / self._dt)]
        for _, run in groupby(flown, key=lambda leg: isinstance(leg.motion, Trim)):
            inputs = {
                leg.begin: m.controls for leg in run if isinstance(m := leg.motion, Manoeuvre)
            }
            found.update(zip(inputs, self._tracker.eased(list(inputs.values())), strict=True))
        return found

    def _append(self, times: FloatArray, controls: FloatArray, states: FloatArray) -> None:
        self._times.append(times[1:])
        self._controls.append(controls)
        self._states.append(states[1:])
        self.steps += len(controls)

    def _take_back(self, parts: int) -> None:
        """Forget all but so many parts of the flight."""
        self.steps -= sum(map(len, self._controls[parts:]))
        del self._controls[parts:], self._states[parts + 1 :], self._times[parts + 1 :]
