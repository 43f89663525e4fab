"""What SST does until it is stopped: iterations, and radii that follow the tree."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import sst_tree
from ompl_risk._kernels.sst import Draw
from ompl_risk.planners.sst.problem import Problem
from ompl_risk.planners.sst.tree import Flight, SparseTree

CHUNK = 50
"""Iterations between two looks at the clock, some milliseconds."""

SHRINK = 0.85
"""What is left of the radii after each round."""

ROUND = 5000
"""Iterations of a round at least."""

TURNS = 2
"""Iterations of a round for each active node at least: the larger the tree, the longer."""

FULL = 0.9
"""Part of the nodes from which the radii grow, so that there is always room for better ones."""

HALF_FULL = 0.6
"""Part of the nodes from which the radii shrink no more."""


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


@dataclass(frozen=True)
class Habits:
    """How branches are drawn.

    Attributes:
        to_goal: part of the acts that reach for something which reach for the goal.
        held: part of the acts that are inputs held.
        pushed: part of the acts that are accelerations held; the rest reach for what was sampled.
        shortest, longest: of an act [s]; inputs are held for at most half as long.
        near_path: part of the samples that are near the best path.
        near: how near, in radii of the pruning.
        shoot: part of the branches after which the goal is reached for.
    """

    to_goal: float = 0.3
    held: float = 0.1
    pushed: float = 0.6
    shortest: float = 0.1
    longest: float = 2.0
    near_path: float = 0.6
    near: float = 2.0
    shoot: float = 0.3

    def numbers(self, problem: Problem, radius: float) -> FloatArray:
        """The same as kernels take them, see ``_kernels.sst``."""
        hold = problem.hold * problem.step
        least, most = (max(round(t / hold), 1) for t in (self.shortest, self.longest))
        held = min(max(most // 2, 1), problem.longest_hold // problem.hold)
        parts = (self.to_goal, self.held, self.pushed)
        return np.array(
            [*parts, least, most, held, self.near_path, self.near * radius, self.shoot]
        )


class Searching:
    """What a planner does until it is stopped.

    Args:
        problem: the problem.
        tree: with its starts.
        draw: how branches are drawn.
        habits: what ``draw`` is made from.
        enough: whether a cost satisfies.
        shrink: whether the radii shrink.
        seconds: spent before, for the history.
        iterations: at most; no limit if None.
        history: where a row for each better path is added.

    Attributes:
        found: the last better flight and its cost; None if there is no new one.
    """

    def __init__(
        self,
        problem: Problem,
        tree: SparseTree,
        draw: Draw,
        *,
        habits: Habits,
        enough: Callable[[float], bool],
        shrink: bool,
        seconds: float,
        iterations: int | None,
        history: list[Progress],
    ) -> None:
        self._problem, self._tree, self._draw, self._habits = problem, tree, draw, habits
        self._enough, self._shrink, self._history = enough, shrink, history
        self._begin = time.monotonic() - seconds
        first = tree.count(sst_tree.ITERATIONS)
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
        flight = self._tree.flight()
        cost = self._problem.cost(flight.states)
        self._history.append(Progress(self.seconds, cost, self._tree.count(sst_tree.NODES)))
        self.found = cost, flight

    def _follow(self) -> None:
        """Smaller radii after a round, larger ones when the tree is full."""
        tree = self._tree
        done = tree.count(sst_tree.ITERATIONS)
        if done % CHUNK:
            return
        share = max(tree.count(sst_tree.NODES), tree.count(sst_tree.WITNESSES)) / tree.most
        factor = 1.0
        if share > FULL:
            factor = 1.0 / SHRINK
        elif self._shrink and share < HALF_FULL:
            if done - tree.round >= max(ROUND, TURNS * tree.count(sst_tree.ACTIVE)):
                factor = SHRINK
        if factor != 1.0:
            tree.scale(factor)
            self._draw.habits[:] = self._habits.numbers(self._problem, tree.pruning)
