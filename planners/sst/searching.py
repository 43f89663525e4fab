"""What SST does until it is stopped: iterations, and radii that follow the tree."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

from ompl_risk._kernels import sst_tree
from ompl_risk._kernels.sst import Draw
from ompl_risk.planners.sst.habits import Habits
from ompl_risk.planners.sst.problem import Problem
from ompl_risk.planners.sst.tree import Flight, SparseTree

CHUNK = 50
"""Iterations between two looks at the clock, some milliseconds."""

SHRINK = 0.85
"""What is left of the radii after each round."""

ROUND = 5000
"""Iterations of a round at least."""

TURNS = 1
"""Iterations of a round for each active node at least: the larger the tree, the longer."""

FULL = 0.9
"""Part of the nodes that are in use when room has to be made for better ones."""

THIN = 0.3
"""Part of the nodes that are given up then, once there is a path; before, the radii grow."""

HALF_FULL = 0.6
"""Part of the nodes from which the radii shrink no more before there is a path."""


class Progress(NamedTuple):
    """A better path was found.

    Attributes:
        seconds: spent on planning until then [s].
        cost: of the path.
        nodes: of the tree.
    """

    seconds: float
    cost: float
    nodes: int


class Growth(NamedTuple):
    """A tree, what it is for, and how it grows."""

    problem: Problem
    tree: SparseTree
    draw: Draw


class Searching:
    """What a planner does until it is stopped.

    Args:
        growth: the tree with its starts.
        habits: what its branches are drawn by.
        enough: whether a cost satisfies.
        shrink: whether the radii shrink.
        seconds: spent before, for the history.
        iterations: at most; no limit if None.
        history: where a row for each better path is added.

    Attributes:
        found: the last better flight and its cost; None if there is none.
    """

    def __init__(
        self,
        growth: Growth,
        *,
        habits: Habits,
        enough: Callable[[float], bool],
        shrink: bool,
        seconds: float,
        iterations: int | None,
        history: list[Progress],
    ) -> None:
        self._problem, self._tree, self._draw = growth
        self._habits = habits
        self._enough, self._shrink, self._history = enough, shrink, history
        self._begin = time.monotonic() - seconds
        first = self._tree.count(sst_tree.ITERATIONS)
        self._last = None if iterations is None else first + iterations
        self.found: tuple[float, Flight] | None = None

    @property
    def seconds(self) -> float:
        """Spent so far [s]."""
        return time.monotonic() - self._begin

    def __call__(self, stop: Callable[[], bool]) -> None:
        """Work until ``stop()``, until there is no better path, or for as long as is allowed."""
        tree = self._tree
        if tree.count(sst_tree.BEST) >= 0 and not self._history:
            self._take()  # a start in the goal
        while not stop() and not self._finished():
            if tree.grow(self._draw, self._portion()):
                self._take()
            self._follow()

    def _portion(self) -> int:
        done = self._tree.count(sst_tree.ITERATIONS)
        to_round = CHUNK - done % CHUNK  # the same looks at the radii however a run is cut
        return to_round if self._last is None else min(to_round, self._last - done)

    def _finished(self) -> bool:
        tree = self._tree
        done = self._last is not None and tree.count(sst_tree.ITERATIONS) >= self._last
        return done or tree.count(sst_tree.ACTIVE) == 0 or self._enough(tree.cost)

    def _take(self) -> None:
        """Fly the best path again, and let its cost be what the states say."""
        flight = self._tree.flight()
        cost = self._problem.cost(flight.states)
        if self._history and not cost < self._history[-1].cost:
            return  # better by less than rounding
        self._history.append(Progress(self.seconds, cost, self._tree.count(sst_tree.NODES)))
        self.found = cost, flight

    def _follow(self) -> None:
        """Smaller radii after a round, and room in a full tree."""
        tree = self._tree
        done = tree.count(sst_tree.ITERATIONS)
        if done % CHUNK:
            return
        share = max(tree.count(sst_tree.NODES), tree.count(sst_tree.WITNESSES)) / tree.most
        round_over = done - tree.round >= max(ROUND, TURNS * tree.count(sst_tree.ACTIVE))
        factor = 1.0
        found = tree.count(sst_tree.BEST) >= 0
        if share > FULL and found:
            tree.thin_out(THIN)
        elif share > FULL:
            factor = 1.0 / SHRINK
        elif self._shrink and round_over and (found or share < HALF_FULL):
            factor = SHRINK
        if factor != 1.0:
            tree.scale(factor)
            self._draw.habits[:] = self._habits.numbers(self._problem, tree.pruning)
