"""A ridge across the way, over which a helicopter gets from hover to hover."""

import numpy as np
from ompl import base as ob

from ompl_risk.bridge.buffers import Buffer
from ompl_risk.clearance import TerrainClearance
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.setup import simple_setup
from ompl_risk.planners.sst.habits import Habits
from ompl_risk.planners.sst.planner import SST, WEIGHTS
from ompl_risk.planners.sst.problem import read_problem
from ompl_risk.planners.sst.searching import Growth
from ompl_risk.planners.sst.tree import SparseTree
from ompl_risk.terrains import Terrain

START, GOAL = (30.0, 60.0, 15.0), (170.0, 60.0, 15.0)
TOP = 80.0


def ridge(height=35.0):
    x, y = np.arange(0.0, 201.0, 10.0), np.arange(0.0, 121.0, 10.0)
    return Terrain(
        np.tile(height * np.exp(-(((x - 100.0) / 20.0) ** 2)), (len(y), 1)), spacing=(10.0, 10.0)
    )


def setup_of(terrain=None, *, risk=False, start=START, goal=GOAL, **options):
    terrain = ridge() if terrain is None else terrain
    high = (*np.array(terrain.extent)[[1, 3]], TOP)
    settings = {"authority": 1.0, "holds": (1, 25), "high": high, **options}
    setup = simple_setup(terrain, start=start, goal=goal, **settings)
    if not risk:
        duration = ob.PathLengthOptimizationObjective(setup.getSpaceInformation())
        setup.setOptimizationObjective(duration)
    return setup


def planned(setup=None, seconds=60.0, **options):
    """A setup whose planner has run for so many iterations."""
    setup = setup_of() if setup is None else setup
    planner = SST(setup.getSpaceInformation(), **{"iterations": 1000, **options})
    setup.setPlanner(planner)
    setup.solve(seconds)
    return setup, planner


def growth(setup=None, *, radii=(30.0, 3.0), most=20_000, seed=1, habits=None, starts=1):
    """A tree without a planner."""
    setup = setup_of() if setup is None else setup
    si, definition = setup.getSpaceInformation(), setup.getProblemDefinition()
    setup.setup()
    problem = read_problem(
        si, definition.getGoal(), definition.getOptimizationObjective(), Helicopter()
    )
    low, high = problem.box
    tree = SparseTree(
        problem.vehicle, problem.handle, low=low, high=high, weights=WEIGHTS, radii=radii, most=most
    )
    states = [np.array([*START, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6]) for _ in range(starts)]
    for k, state in enumerate(states):
        state[1] += 20.0 * k
        tree.plant(state)
    drawn = (habits or Habits()).draw(problem, states, seed=seed, authority=0.1, radius=radii[1])
    tree.owner = setup  # keeps what kernels read alive
    return Growth(problem, tree, drawn)


def numbers(setup, states):
    """OMPL's states as rows."""
    space, buffer = setup.getSpaceInformation().getStateSpace(), Buffer(13)
    rows = []
    for state in states:
        space.serialize(buffer.capsule, state)
        rows.append(buffer.numbers.copy())
    return np.array(rows)


def rotations(states):
    """Rotation matrices of states (n, 13), from their quaternions."""
    x, y, z, w = np.asarray(states)[:, 3:7].T
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)  # fmt: skip


def allowed(states, terrain, limits=None, radius=1.0):
    """Which states (n, 13) keep the limits and are free, written out anew."""
    limits = Limits() if limits is None else limits
    xmin, xmax, ymin, ymax = terrain.extent
    x, y, z = states[:, :3].T
    tilt = np.arccos(np.clip(rotations(states)[:, 2, 2], -1.0, 1.0))
    return (
        (TerrainClearance(terrain, radius)(states[:, :3]) > 0.0)
        & (np.linalg.norm(states[:, 7:10], axis=1) <= limits.speed)
        & (np.abs(states[:, 10:]).max(axis=1) <= limits.rate)
        & (tilt <= limits.attitude)
        & (x >= xmin) & (x <= xmax) & (y >= ymin) & (y <= ymax) & (z <= TOP)
    )  # fmt: skip


def write(setup, state, values):
    """Make an OMPL state of the helicopter's 13 numbers."""
    buffer = Buffer(13)
    buffer.numbers[:] = values
    setup.getSpaceInformation().getStateSpace().deserialize(state, buffer.capsule)


def solution(setup):
    return setup.getProblemDefinition().getSolutionPath()


def walled():
    heights = np.zeros((13, 21))
    heights[:, 10] = TOP + 20.0
    return Terrain(heights, spacing=(10.0, 10.0))
