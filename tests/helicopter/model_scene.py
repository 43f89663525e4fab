"""States and controls of the helicopter at random."""

import numpy as np
from scipy.spatial.transform import Rotation

from ompl_risk.helicopter.parameters import Helicopter

XCELL = Helicopter()
HOVER = np.array([XCELL.weight, 0.0, 0.0, 0.0])
WINDY = Helicopter(drag=(0.7, 1.1, 1.6), wind=(4.0, -3.0, 1.0))


def random_states(n, seed=0):
    rng = np.random.default_rng(seed)
    turns = rng.standard_normal((n, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return np.column_stack(
        [
            rng.uniform(-100, 100, (n, 3)),
            turns,
            rng.uniform(-20, 20, (n, 3)),
            rng.uniform(-2, 2, (n, 3)),
        ]
    )


def random_controls(n, seed=1, tilt=0.2):
    rng = np.random.default_rng(seed)
    return np.column_stack(
        [rng.uniform(20, 150, n), rng.uniform(-6, 6, n), rng.uniform(-tilt, tilt, (n, 2))]
    )


def rotation(state):
    return Rotation.from_quat(np.asarray(state)[..., 3:7])
