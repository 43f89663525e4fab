"""Stable sparse RRT: the iterations.

Reference: Li, Littlefield & Bekris, Asymptotically optimal sampling-based kinodynamic planning,
International Journal of Robotics Research 35(5), 2016, algorithms 5 to 8.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.branch import HOLD, WEIGHT, Ground, fly, least_cost
from ompl_risk._kernels.buckets import MARK, NONE, least_near, write_mark
from ompl_risk._kernels.draws import between, in_ball, uniform, whole
from ompl_risk._kernels.flight_checks import HIGH, LOW, SPEED
from ompl_risk._kernels.height_field import opened
from ompl_risk._kernels.inner_loop import ACT, HELD, PUSH, REACH, STEEPEST, TOP_RATE
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.nearest import workspace
from ompl_risk._kernels.rigid_body import GRAVITY, STATE
from ompl_risk._kernels.sst_tree import (
    BEST,
    BRANCHES,
    ITERATIONS,
    PATH,
    SELECT,
    STEPS,
    crown,
    offer,
)

# places in the habits
TO_GOAL, RAW, PUSHED, SHORTEST, LONGEST, MOST_HELD, NEAR_PATH, NEAR, SHOOT = range(9)
HABITS = 9
"""Numbers in the habits: part of the acts that reach which reach for the goal; parts of the acts
that are held inputs and accelerations; least and most holds of an act, most holds of held inputs;
part of the samples near the best path, and how near; part of the branches after which the goal is
reached for."""

GENTLEST, HARDEST = 0.1, 1.6
"""Decelerations with which something is reached for, in g."""

TRIES = 10
"""Samples drawn at most for one that can lie on a better path."""

MOST_TIMES = 100
"""Branches in a row at most that reach for the same."""


class Draw(NamedTuple):
    """How branches are drawn.

    Attributes:
        seed: state of the random numbers, shape (1,).
        habits: see ``HABITS``.
        low, high: range of the inputs that are held, shapes (4,).
        starts: of the tree, shape (k, 13).
    """

    seed: NDArray[np.uint64]
    habits: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    starts: NDArray[np.float64]


@kernel
def _least_total(vehicle, starts, mark):
    """Lower bound for the cost of a path from a start through a place to the goal."""
    least = math.inf
    for k in range(len(starts)):
        x, y, z = mark[0] - starts[k, 0], mark[1] - starts[k, 1], mark[2] - starts[k, 2]
        least = min(least, math.sqrt(x * x + y * y + z * z))
    return vehicle.settings[WEIGHT] * least / vehicle.allowed[SPEED] + least_cost(
        vehicle, mark, 0.0
    )


@kernel
def _sample(draw, tree, vehicle, best, mark):
    """A state to select near: any from which a better path is not ruled out, or one of the best."""
    seed, allowed, habits = draw.seed, vehicle.allowed, draw.habits
    if best < math.inf and uniform(seed) < habits[NEAR_PATH]:
        i = tree.path[whole(seed, 0, tree.counts[PATH] - 1)]
        for k in range(MARK):
            mark[k] = tree.marks[i, k]
        x, y, z = in_ball(seed, habits[NEAR])
        mark[0], mark[1], mark[2] = mark[0] + x, mark[1] + y, mark[2] + z
        x, y, z = in_ball(seed, habits[NEAR])
        mark[7], mark[8], mark[9] = mark[7] + x, mark[8] + y, mark[9] + z
        return
    for _ in range(TRIES):
        for k in range(3):
            mark[k] = between(seed, allowed[LOW + k], allowed[HIGH + k])
        if _least_total(vehicle, draw.starts, mark) < best:
            break
    mark[7], mark[8], mark[9] = in_ball(seed, allowed[SPEED])
    tilt = uniform(seed) * math.atan(vehicle.loop[STEEPEST])
    heading, aside = between(seed, -math.pi, math.pi), between(seed, -math.pi, math.pi)
    s, c = math.sin(0.5 * tilt), math.cos(0.5 * tilt)
    mark[3], mark[4] = s * math.cos(aside), s * math.sin(aside)
    mark[5], mark[6] = c * math.sin(heading), c * math.cos(heading)
    for k in range(10, 13):
        mark[k] = between(seed, -vehicle.loop[TOP_RATE], vehicle.loop[TOP_RATE])


@kernel
def _act(draw, vehicle, mark, act):
    """Draw what to do; for how many holds."""
    seed, habits = draw.seed, draw.habits
    kind, longest = uniform(seed), int(habits[LONGEST])
    if kind < habits[RAW]:
        act[0] = HELD
        for k in range(4):
            act[1 + k] = between(seed, draw.low[k], draw.high[k])
        longest = min(longest, int(habits[MOST_HELD]))
    elif kind < habits[RAW] + habits[PUSHED]:
        act[0] = PUSH
        act[1], act[2], act[3] = in_ball(seed, vehicle.loop[STEEPEST] * vehicle.given[GRAVITY])
        act[3] *= 0.5
    elif uniform(seed) < habits[TO_GOAL]:
        _reach_for_goal(seed, vehicle, act)
    else:
        act[0] = REACH
        for k in range(3):
            act[1 + k], act[4 + k] = mark[k], mark[7 + k]
        act[7] = between(seed, GENTLEST, HARDEST) * vehicle.given[GRAVITY]
    return whole(seed, min(int(habits[SHORTEST]), longest), longest)


@kernel
def _reach_for_goal(seed, vehicle, act):
    act[0] = REACH
    for k in range(6):
        act[1 + k] = vehicle.goal[k]
    act[7] = between(seed, GENTLEST, HARDEST) * vehicle.given[GRAVITY]


@kernel
def _extend(tree, vehicle, ground, i, act, steps, space):
    """Fly an act from node i, on and on if it reaches for something.

    What ends in the goal for less than all before becomes the best path.

    Returns:
        The node that was added last, NONE if none was.
    """
    state, mark, control, no_controls, no_states = space
    counts, last = tree.counts, NONE
    for _ in range(MOST_TIMES if act[0] == REACH else 1):
        best = tree.cost[counts[BEST]] if counts[BEST] != NONE else math.inf
        for k in range(len(state)):
            state[k] = tree.states[i, k]
        flown, cost, room, reached = fly(
            vehicle, ground, state, tree.room[i], act, steps, best - tree.cost[i],
            control, no_controls, no_states,
        )  # fmt: skip
        if flown == 0:
            break
        counts[STEPS] += flown
        counts[BRANCHES] += 1
        write_mark(state, mark)
        i = offer(tree, state, mark, act, flown, i, tree.cost[i] + cost, room, reached)
        if i == NONE:
            break
        last = i
        if reached:
            crown(tree, i, vehicle)
            break
    return last


@entry
def grow(tree, vehicle, handle, draw, iterations):
    """Do so many iterations; whether the best path became better, upon which it returns at once."""
    stack, keys = workspace()
    ground = Ground(opened(handle), stack, keys)
    mark, act, state, control = np.empty(MARK), np.zeros(ACT), np.empty(STATE), np.empty(4)
    space = state, np.empty(MARK), control, np.empty((0, 4)), np.empty((0, STATE))
    counts, hold = tree.counts, int(vehicle.settings[HOLD])
    for _ in range(iterations):
        counts[ITERATIONS] += 1
        before = counts[BEST]
        best = tree.cost[before] if before != NONE else math.inf
        _sample(draw, tree, vehicle, best, mark)
        i = least_near(tree.nodes, tree.marks, tree.cost, mark, tree.radii[SELECT], tree.weights)
        if i == NONE:
            return False
        holds = _act(draw, vehicle, mark, act)
        while True:  # the act, and perhaps a try for the goal from where it ends
            i = _extend(tree, vehicle, ground, i, act, hold * holds, space)
            if counts[BEST] != before:
                return True
            if i == NONE or act[0] == REACH or uniform(draw.seed) >= draw.habits[SHOOT]:
                break
            _reach_for_goal(draw.seed, vehicle, act)
            holds = int(draw.habits[LONGEST])
    return False
