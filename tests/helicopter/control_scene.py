"""A short flight as an OMPL problem, and states around the limits."""

import numpy as np
from ompl import base as ob
from ompl import control as oc
from ompl import util as ou
from scipy.spatial.transform import Rotation

from ompl_risk.bridge.buffers import Buffer
from ompl_risk.helicopter import model
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.setup import simple_setup
from ompl_risk.terrains import Terrain

ou.setLogLevel(ou.LOG_NONE)

XCELL = Helicopter()
LOW, HIGH = np.array([0.0, 0.0, 0.0]), np.array([200.0, 200.0, 100.0])
CALM = Limits(speed=15.0, rate=0.5, attitude=0.4)
PLANNERS = [oc.RRT, oc.EST, oc.KPIECE1]


def hill():
    y, x = np.mgrid[0:21, 0:21] * 10.0
    return Terrain(
        30.0 * np.exp(-((x - 100) ** 2 + (y - 100) ** 2) / 800), spacing=(10.0, 10.0), name="hill"
    )


def hop(**options):
    """Thirty metres straight on over flat ground: solved in a blink."""
    flat = Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0))
    ends = [model.make_state((x, 50, 20), velocity=(6, 0, 0)) for x in (30, 60)]
    usual = {"radius": 6.0, "tolerance": 3.0, "limits": CALM, "step": 0.1, "holds": (3, 12)}
    return simple_setup(flat, start=ends[0], goal=ends[1], high=(100, 100, 40), **(usual | options))


def numbers(si, state):
    buffer = Buffer(13)
    si.getStateSpace().serialize(buffer.capsule, state)
    return buffer.numbers


def control(si, values):
    held = si.allocControl()
    for k, value in enumerate(values):
        held[k] = float(value)
    return held


def some_states(n, seed=0):
    """Around the limits: about half of each kind breaks it."""
    rng = np.random.default_rng(seed)
    tilt = Rotation.from_rotvec(rng.standard_normal((n, 3)) * 0.6)
    turn = (Rotation.from_euler("z", rng.uniform(-3, 3, (n, 1))) * tilt).as_quat()
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return np.column_stack(
        [
            rng.uniform(LOW - 20, HIGH + 20, (n, 3)),
            turn,
            rng.standard_normal((n, 3)) * 15.0,
            rng.uniform(-2.5, 2.5, (n, 3)),
        ]
    )


def after(calls):
    """Ends a search after so many questions: unlike a time limit, it reproduces."""
    left = iter(range(calls))
    return ob.PlannerTerminationCondition(lambda: next(left, None) is None)
