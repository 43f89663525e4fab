"""The tree of SST in Python: memory, radii, and the paths in it."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import branch, sst, sst_tree
from ompl_risk._kernels.branch import Vehicle
from ompl_risk._kernels.buckets import MARK, NONE, Buckets
from ompl_risk._kernels.inner_loop import ACT
from ompl_risk._kernels.rigid_body import STATE
from ompl_risk._kernels.sst_tree import COUNTS, FREE, Tree

MOST_BUCKETS = 48
"""Buckets along the longest side of the box."""


class Flight(NamedTuple):
    """A path in the tree, as it is flown.

    Attributes:
        states: at the start and after every step, shape (n + 1, 13).
        controls: held from each state for a step, shape (n, 4).
    """

    states: FloatArray
    controls: FloatArray


class SparseTree:
    """Nodes, witnesses and what is counted, in arrays that kernels fill.

    Args:
        vehicle: the problem.
        handle: of the height field.
        low, high: box of the positions [m], shapes (3,).
        weights: of the metric, shape (3,).
        radii: for selection and for pruning [m].
        most: nodes.

    Attributes:
        vehicle, handle, most: as given.
        round: iteration in which the radii changed last.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        handle: NDArray[np.int64],
        *,
        low: FloatArray,
        high: FloatArray,
        weights: FloatArray,
        radii: tuple[float, float],
        most: int,
    ) -> None:
        self.vehicle, self.handle, self.most, self.round = vehicle, handle, most, 0
        counts = np.zeros(COUNTS, dtype=np.int64)
        counts[[sst_tree.SPARE, sst_tree.BEST]] = NONE
        edge = max(float((high - low).max()) / MOST_BUCKETS, 0.5 * radii[0])
        self.arrays = Tree(
            states=np.empty((most, STATE)),
            marks=np.empty((most, MARK)),
            acts=np.empty((most, ACT)),
            steps=np.empty(most, dtype=np.int32),
            parent=np.empty(most, dtype=np.int32),
            children=np.empty(most, dtype=np.int32),
            cost=np.empty(most),
            room=np.empty(most),
            witness=np.full(most, FREE, dtype=np.int32),
            nodes=_buckets(low, high, edge, most),
            spots=np.empty((most, MARK)),
            keeper=np.empty(most, dtype=np.int32),
            witnesses=_buckets(low, high, edge, most),
            weights=np.array(weights, dtype=np.float64),
            radii=np.array(radii, dtype=np.float64),
            path=np.empty(4096, dtype=np.int32),
            counts=counts,
        )

    def plant(self, state: FloatArray) -> bool:
        """Add a start; whether it is allowed."""
        room = branch.first_room(self.vehicle, self.handle, state)
        if room <= 0.0:
            return False
        sst_tree.plant(self.arrays, self.vehicle, state, room)
        return True

    def grow(self, draw: sst.Draw, iterations: int) -> bool:
        """Do so many iterations, or fewer if the best path becomes better; whether it did."""
        return bool(sst.grow(self.arrays, self.vehicle, self.handle, draw, iterations))

    @property
    def pruning(self) -> float:
        """Radius for which a witness stands [m]."""
        return float(self.arrays.radii[sst_tree.PRUNE])

    def scale(self, share: float) -> None:
        """Change the radii, and choose the witnesses anew."""
        active = self._active()
        order = active[np.argsort(self.arrays.cost[active], kind="stable")]
        select, prune = share * self.arrays.radii
        sst_tree.witness_anew(self.arrays, order, select, prune)
        if share != 1.0:
            self.round = self.count(sst_tree.ITERATIONS)

    def thin_out(self, share: float) -> None:
        """Give up this part of the active nodes: those that promise least."""
        active = self._active()
        hopes = np.empty(len(active))
        sst_tree.hopes(self.arrays, self.vehicle, active, hopes)
        kept = int((1.0 - share) * len(active))
        sst_tree.retire(self.arrays, active[np.argsort(hopes, kind="stable")[kept:]])
        self.scale(1.0)

    def _active(self) -> NDArray[np.int32]:
        there = self.arrays.witness[: self.count(sst_tree.ROWS)] >= 0
        return np.flatnonzero(there).astype(np.int32)

    def compile(self, draw: sst.Draw) -> None:
        """Compile what a search calls, or load it from numba's cache."""
        self.grow(draw, 1)
        self.scale(1.0)
        nodes = np.empty(len(self.arrays.cost), dtype=np.int32)
        sst_tree.lineage(self.arrays, self.count(sst_tree.BEST), nodes)
        state, act = np.zeros(STATE), np.zeros(ACT)
        state[6] = 1.0
        nothing, nowhere = np.empty((0, 4)), np.empty((0, STATE))
        branch.fly_again(self.vehicle, self.handle, state, 0.0, act, 0, nothing, nowhere)

    def count(self, which: int) -> int:
        """One of ``sst_tree.COUNTS``."""
        return int(self.arrays.counts[which])

    @property
    def cost(self) -> float:
        """Of the best path; inf without one."""
        best = self.count(sst_tree.BEST)
        return float(self.arrays.cost[best]) if best != NONE else float("inf")

    def flight(self) -> Flight:
        """The best path, flown again."""
        tree = self.arrays
        nodes = np.empty(self.count(sst_tree.NODES), dtype=np.int32)
        nodes = nodes[: sst_tree.lineage(tree, self.count(sst_tree.BEST), nodes)]
        states, controls = [tree.states[nodes[0]][None].copy()], []
        for before, node in pairwise(nodes):
            n = int(tree.steps[node])
            new_controls, new_states = np.empty((n, 4)), np.empty((n, STATE))
            branch.fly_again(
                self.vehicle, self.handle, tree.states[before], tree.room[before],
                tree.acts[node], n, new_controls, new_states,
            )  # fmt: skip
            states.append(new_states)
            controls.append(new_controls)
        return Flight(np.concatenate(states), np.concatenate([np.empty((0, 4)), *controls]))


def _buckets(low: FloatArray, high: FloatArray, edge: float, most: int) -> Buckets:
    shape = np.maximum(np.ceil((high - low) / edge).astype(int), 1)
    return Buckets(
        low=np.append(low, edge),
        first=np.full(tuple(shape), NONE, dtype=np.int32),
        after=np.empty(most, dtype=np.int32),
        before=np.empty(most, dtype=np.int32),
    )
