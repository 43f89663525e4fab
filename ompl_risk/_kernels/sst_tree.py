"""The tree of SST: flights from the starts, of which each witness keeps the best near it.

A node is one end of a branch. It is active while it is what its witness keeps; only active nodes
are flown on from. Nodes that are neither active nor on the way to one are given back.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.branch import is_reached, least_cost
from ompl_risk._kernels.buckets import (
    NONE,
    Buckets,
    nearest_within,
    put,
    set_row,
    take,
    write_mark,
)
from ompl_risk._kernels.jit import entry, kernel

FREE = -2
"""In place of a witness: the row holds no node."""

# places in the counts
ROWS, SPARE, WITNESSES, ACTIVE, NODES, BEST, ITERATIONS, STEPS, BRANCHES, REFUSED, PATH = range(11)
COUNTS = 11
"""Numbers in the counts: rows ever used, first row given back, witnesses, active nodes, nodes, the
node that ends the best path, iterations, steps flown, branches that were allowed, and branches
for which there was no room."""

# places in the radii
SELECT, PRUNE = 0, 1


class Tree(NamedTuple):
    """Nodes and witnesses.

    Attributes:
        states: state at the end of the branch, shape (n, 13).
        marks: of the states, see ``buckets``.
        acts: of the branch, see ``inner_loop``.
        steps: of the branch; 0 for a start.
        parent: node where the branch begins; of a row given back, the next such row.
        children: branches that begin here, and one more for what must stay.
        cost: from the start.
        room: lower bound of the clearance as it was measured [m].
        witness: that keeps the node; NONE if it is not active, FREE if there is no node.
        nodes: active nodes by their position.
        spots: marks of the witnesses, shape (w, 13).
        keeper: the node that a witness keeps, or NONE.
        witnesses: by their position.
        weights: of the metric, see ``buckets.apart``.
        radii: within which the least cost is selected, and which a witness stands for [m].
        path: nodes of the best path, its end first; the last of them if there are too many.
    counts: see ``COUNTS``.
    """

    states: NDArray[np.float64]
    marks: NDArray[np.float64]
    acts: NDArray[np.float64]
    steps: NDArray[np.int32]
    parent: NDArray[np.int32]
    children: NDArray[np.int32]
    cost: NDArray[np.float64]
    room: NDArray[np.float64]
    witness: NDArray[np.int32]
    nodes: Buckets
    spots: NDArray[np.float64]
    keeper: NDArray[np.int32]
    witnesses: Buckets
    weights: NDArray[np.float64]
    radii: NDArray[np.float64]
    path: NDArray[np.int32]
    counts: NDArray[np.int64]


@kernel
def _new_row(tree):
    """A row for a node, NONE if there is none."""
    counts = tree.counts
    if counts[SPARE] != NONE:
        row = counts[SPARE]
        counts[SPARE] = tree.parent[row]
    elif counts[ROWS] < len(tree.cost):
        row = counts[ROWS]
        counts[ROWS] += 1
    else:
        return NONE
    counts[NODES] += 1
    return row


@kernel
def _add(tree, state, mark, act, steps, parent, cost, room):
    """A new node that is not active; NONE if there is no room for it."""
    i = _new_row(tree)
    if i == NONE:
        return NONE
    set_row(tree.states, i, state)
    set_row(tree.marks, i, mark)
    set_row(tree.acts, i, act)
    tree.steps[i], tree.parent[i], tree.children[i] = steps, parent, 0
    tree.cost[i], tree.room[i], tree.witness[i] = cost, room, NONE
    if parent != NONE:
        tree.children[parent] += 1
    return i


@kernel
def _drop(tree, i):
    """Give a node back if nothing needs it, and then those before it."""
    counts = tree.counts
    while i != NONE and tree.witness[i] == NONE and tree.children[i] == 0:
        parent = tree.parent[i]
        tree.witness[i], tree.parent[i] = FREE, counts[SPARE]
        counts[SPARE] = i
        counts[NODES] -= 1
        if parent != NONE:
            tree.children[parent] -= 1
        i = parent


@kernel
def _retire(tree, i):
    """An active node is active no longer."""
    take(tree.nodes, i, tree.marks[i])
    tree.keeper[tree.witness[i]] = NONE
    tree.witness[i] = NONE
    tree.counts[ACTIVE] -= 1
    _drop(tree, i)


@kernel
def _keep(tree, i, w):
    """Let witness w, which keeps none, keep node i."""
    tree.keeper[w], tree.witness[i] = i, w
    put(tree.nodes, i, tree.marks[i])
    tree.counts[ACTIVE] += 1


@kernel
def _new_witness(tree, mark):
    """A witness at a mark; NONE if there is no room for it."""
    w = tree.counts[WITNESSES]
    if w == len(tree.keeper):
        return NONE
    set_row(tree.spots, w, mark)
    tree.keeper[w] = NONE
    put(tree.witnesses, w, mark)
    tree.counts[WITNESSES] += 1
    return w


@kernel
def offer(tree, state, mark, act, steps, parent, cost, room, wanted):
    """Add a node if it is the best near its witness, or wanted anyway.

    Args:
        tree: the tree.
        state, mark: where the branch ends.
        act, steps, parent: the branch.
        cost, room: at its end.
        wanted: whether to add it even where a witness keeps a better one.

    Returns:
        The node, NONE if it was not added.
    """
    w = nearest_within(tree.witnesses, tree.spots, mark, tree.radii[PRUNE], tree.weights)
    better = w == NONE or tree.keeper[w] == NONE or cost < tree.cost[tree.keeper[w]]
    if not (better or wanted):
        return NONE
    i = _add(tree, state, mark, act, steps, parent, cost, room)
    if i == NONE:
        tree.counts[REFUSED] += 1
        return NONE
    if better:
        if w == NONE:
            w = _new_witness(tree, mark)
        elif tree.keeper[w] != NONE:
            _retire(tree, tree.keeper[w])
        if w != NONE:
            _keep(tree, i, w)
        else:
            tree.counts[REFUSED] += 1
            if not wanted:
                _drop(tree, i)
                return NONE
    return i


@kernel
def crown(tree, i, vehicle):
    """Node i ends the best path: it stays, and what cannot lead to a better one goes."""
    before = tree.counts[BEST]
    tree.counts[BEST] = i
    k, tree.counts[PATH] = i, 0
    while k != NONE and tree.counts[PATH] < len(tree.path):
        tree.path[tree.counts[PATH]] = k
        tree.counts[PATH] += 1
        k = tree.parent[k]
    tree.children[i] += 1
    if before != NONE:
        tree.children[before] -= 1
        _drop(tree, before)
    for k in range(tree.counts[ROWS]):
        hopeless = tree.cost[k] + least_cost(vehicle, tree.states[k], tree.room[k]) >= tree.cost[i]
        if tree.witness[k] >= 0 and hopeless:
            _retire(tree, k)


@entry
def plant(tree, vehicle, state, room):
    """Add a start; the node, NONE if another start stands for it."""
    mark, act = np.empty(len(state)), np.zeros(tree.acts.shape[1])
    write_mark(state, mark)
    i = offer(tree, state, mark, act, 0, NONE, 0.0, room, False)
    if i != NONE and is_reached(vehicle, state):
        crown(tree, i, vehicle)
    return i


@entry
def witness_anew(tree, order, select, prune):
    """Other radii, and other witnesses: the nodes in this order, if none before is near.

    Args:
        tree: the tree.
        order: active nodes, the least cost first.
        select, prune: the radii [m].
    """
    tree.radii[SELECT], tree.radii[PRUNE] = select, prune
    tree.counts[WITNESSES] = 0
    tree.witnesses.first[:] = NONE
    for i in order:
        w = nearest_within(tree.witnesses, tree.spots, tree.marks[i], prune, tree.weights)
        if w == NONE:
            w = _new_witness(tree, tree.marks[i])
            tree.keeper[w], tree.witness[i] = i, w
            continue
        take(tree.nodes, i, tree.marks[i])
        tree.witness[i] = NONE
        tree.counts[ACTIVE] -= 1
    for i in order:  # only now: what is given back may be on the way to what is not
        if tree.witness[i] == NONE:
            _drop(tree, i)


@entry
def hopes(tree, vehicle, nodes, out):
    """``out[k]`` = lower bound for the cost of a path through a node."""
    for k in range(len(nodes)):
        i = nodes[k]
        out[k] = tree.cost[i] + least_cost(vehicle, tree.states[i], tree.room[i])


@entry
def retire(tree, nodes):
    """Make so many active nodes active no longer."""
    for i in nodes:
        _retire(tree, i)


@entry
def lineage(tree, i, out):
    """Write the nodes from the start to node i; their number. ``out`` must be long enough."""
    n = 0
    while i != NONE:
        out[n] = i
        i = tree.parent[i]
        n += 1
    for k in range(n // 2):
        out[k], out[n - 1 - k] = out[n - 1 - k], out[k]
    return n
