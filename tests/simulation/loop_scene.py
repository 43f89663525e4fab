"""Flights in one trim, grounds, and disturbances that are known in closed form."""

import math
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from ompl_risk import TerrainClearance
from ompl_risk._kernels import gusts, rigid_body
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.primitives import DT
from ompl_risk.helicopter.trims import solve_trim
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan
from ompl_risk.simulation.loop.rollouts import fly
from ompl_risk.terrains import Terrain

X_CELL = Helicopter()
HOVER, CRUISE, TURN, CLIMB = (0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (20.0, 0.0, 0.5), (15.0, 2.0, -0.3)


def flight(key=CRUISE, seconds=10.0, position=(100.0, 500.0, 60.0), heading=0.0):
    """A trim, held: states that its constant input leads through."""
    trim = solve_trim(X_CELL, *key)
    steps = round(seconds / DT)
    ways = [trim.displacement(k * DT) for k in range(steps + 1)]
    c, s = math.cos(heading), math.sin(heading)
    states = [
        trim.state(
            (position[0] + c * x - s * y, position[1] + s * x + c * y, position[2] + z),
            heading + turn,
        )
        for x, y, z, turn in ways
    ]
    controls = np.tile(trim.control, (steps, 1))
    planned = np.array(states)
    one = Flight(DT, planned, controls, planned)
    return Flight(DT, one.replay(), controls, planned)


def plan(*arguments, **options):
    return HelicopterPlan(flight(*arguments, **options))


def ground(heights=None, spacing=10.0, radius=5.0):
    """1 km square by default, flat at 0."""
    heights = np.zeros((101, 101)) if heights is None else heights
    return TerrainClearance(Terrain(heights, spacing=(spacing, spacing)), radius, threads=1)


def hills(radius=5.0, height=25.0):
    x = 10.0 * np.arange(101)
    heights = height * np.sin(x / 37.0) * np.cos(x[:, None] / 23.0)
    return ground(heights, radius=radius)


def flown(plan, clearance=None, disturbances=None, count=8, seed=0, **options):
    """Outcomes of a few rollouts, in one thread unless asked for more."""
    disturbances = Disturbances() if disturbances is None else disturbances
    draws = Draws.make(count, seed, disturbances)
    clearance = ground() if clearance is None else clearance
    return fly(plan, clearance, disturbances, draws, **{"threads": 1, **options})


class Steady:
    """Gusts that blow eastward, at a speed [m/s] times the rollout's first normal number."""

    def __init__(self, speed, drag=(2.0, 3.0, 6.0), until=math.inf):
        self.speed, self.drag, self.until = speed, drag, until

    def filters(self, heights, speeds, headings, dt):
        rows = np.zeros((len(heights), gusts.FILTER))
        rows[:, gusts.ALONG] = rows[:, gusts.COSINE] = 1.0
        rows[:, gusts.LEVEL_SIGMA] = self.speed * (np.arange(len(rows)) * dt < self.until)
        return rows


def steady(*arguments, **options):
    return SimpleNamespace(gusts=Steady(*arguments, **options), navigation=None, terrain=None)


def seen(state, reference):
    """The deviation that the law sees, by scipy's rotations."""
    r, q = (Rotation.from_quat(s[3:7]) for s in (reference, state))
    return np.concatenate(
        [
            r.inv().apply(state[:3] - reference[:3]),
            (r.inv() * q).as_rotvec(),
            r.inv().apply(q.apply(state[7:10])) - reference[7:10],
            state[10:] - reference[10:],
        ]
    )


def unseen(e, reference):
    """The state that deviates so."""
    r = Rotation.from_quat(reference[3:7])
    q = r * Rotation.from_rotvec(e[3:6])
    velocity = q.inv().apply(r.apply(reference[7:10] + e[6:9]))
    place = reference[:3] + r.apply(e[:3])
    return np.concatenate([place, q.as_quat(), velocity, reference[10:] + e[9:]])


def linear_step(flight, k=0, h=1e-5):
    """A and B of step k in the coordinates of ``seen``, controls in their own units."""
    state, control, after = flight.states[k], flight.controls[k], flight.states[k + 1]

    def answer(e, du):
        next_state, given = np.empty(13), flight.helicopter.given
        rigid_body.propagate(unseen(e, state), control + du, flight.dt, given, next_state)
        return seen(next_state, after)

    def slopes(n, of):
        steps = h * np.eye(n)
        return np.column_stack([(of(d) - of(-d)) / (2.0 * h) for d in steps])

    a = slopes(12, lambda e: answer(e, np.zeros(4)))
    return a, slopes(4, lambda du: answer(np.zeros(12), du))
