"""Paths of small control spaces, and what judges them."""

import math

import numpy as np
from ompl import base as ob
from ompl import control as oc

from ompl_risk import (
    InverseDistance,
    Lp,
    RiskObjective,
    Sobolev,
    TerrainClearance,
)
from ompl_risk.terrains import Terrain

D0 = 60.0
AVOIDANCE = InverseDistance(D0)
FLAT = TerrainClearance(Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0)))
NORMS = [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]


def hills():
    y, x = np.mgrid[0:41, 0:41] * 5.0
    return TerrainClearance(
        Terrain(25.0 * np.sin(x / 17.0) ** 2 + 8.0 * np.cos(y / 11.0), spacing=(5.0, 5.0)), 1.5
    )


def setup(space, step, propagate):
    """A space information over a space with three inputs; all states are valid."""
    controls = oc.RealVectorControlSpace(space, 3)
    bounds = ob.RealVectorBounds(3)
    bounds.setLow(-50.0)
    bounds.setHigh(50.0)
    controls.setBounds(bounds)
    si = oc.SpaceInformation(space, controls)
    si.setStatePropagator(propagate)
    si.setPropagationStepSize(step)
    si.setMinMaxControlDuration(1, 1000)
    si.setStateValidityChecker(lambda state: True)
    si.setup()
    return si


def real(dimension):
    space = ob.RealVectorStateSpace(dimension)
    space.setBounds(-1000.0, 1000.0)
    return space


def drifting(step=0.5, dimension=3):
    """The input is the velocity."""

    def propagate(state, control, duration, result):
        for k in range(dimension):
            result[k] = state[k] + (control[k] if k < 3 else 0.0) * duration

    return setup(real(dimension), step, propagate)


def pushed(step):
    """R^3 x R^3, place and velocity; the input is the acceleration."""
    space = ob.CompoundStateSpace()
    space.addSubspace(real(3), 1.0)
    space.addSubspace(real(3), 1.0)
    space.lock()

    def propagate(state, control, duration, result):
        for k in range(3):
            p, v, a = state[0][k], state[1][k], control[k]
            result[0][k] = p + duration * (v + 0.5 * a * duration)
            result[1][k] = v + a * duration

    return setup(space, step, propagate)


def path_of(si, rows, inputs, durations, write):
    path = oc.PathControl(si)
    for k, row in enumerate(rows):
        state = si.allocState()
        write(state, row)
        if k == len(inputs):
            path.append(state)
            continue
        control = si.allocControl()
        for axis in range(3):
            control[axis] = float(inputs[k][axis])
        path.append(state, control, float(durations[k]))
    return path


def write_place(state, row):
    state[0:3] = [float(x) for x in row]


def drifted(start, inputs, durations, step=0.5):
    """A path of constant velocities."""
    ways = np.array(inputs, float).reshape(-1, 3) * np.array(durations, float)[:, None]
    rows = np.vstack([start, start + np.cumsum(ways, axis=0)])
    return path_of(drifting(step), rows, inputs, durations, write_place)


def objective(clearance=FLAT, norm=None, si=None, **options):
    si = drifting() if si is None else si
    options = {"speed": 7.0, **options}
    return RiskObjective(si, clearance, AVOIDANCE, norm, **options)
