"""SST as an OMPL planner."""

from __future__ import annotations

from typing import Any

import numpy as np
from ompl import base as ob
from ompl import control as oc

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import sst_tree
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.bridge.conditions import after
from ompl_risk.helicopter.goals import HelicopterGoal
from ompl_risk.helicopter.model import STATE
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.planners.roadmap.worker import Worker
from ompl_risk.planners.sst.habits import Habits
from ompl_risk.planners.sst.options import Options
from ompl_risk.planners.sst.problem import Problem, check_space, read_problem
from ompl_risk.planners.sst.publishing import PathWriter, add_solution
from ompl_risk.planners.sst.searching import Growth, Progress, Searching
from ompl_risk.planners.sst.tree import SparseTree

WEIGHTS = np.array([1.0, 9.0, 1.0])
"""In the distance of two states 1 m counts as much as 1 m/s, a third of a radian, or 1 rad/s."""

NODES = 50_000
"""Of the tree at most: some 25 MB."""


class SST(ob.Planner):
    """Stable sparse RRT for the helicopter: an anytime planner for least duration or least risk.

    Grows a tree of flights by random acts from the best node near a random state. Of all nodes near
    a witness only the cheapest is kept (pruning), so the tree stays sparse; the radii shrink with
    time, as in SST*. An act is one of three, flown for 0.1 to 2 s: inputs held; an acceleration
    held; or to reach for a state, the goal among them, which goes on for as long as its branches
    are kept. The latter two become inputs through an attitude loop, anew for each hold of inputs;
    the path has exactly the inputs that were flown, so it replays to the last digit.

    Beyond the published algorithm, samples are also drawn near the best path, nodes that cannot
    lead to a better one are given up, and the least promising ones too when memory is full. The
    published guarantee of asymptotic optimality needs unbounded memory and rounds far longer than
    those after which the radii shrink here: that paths become better is measured, not guaranteed.

    Inputs keep to the bounds of the control space: a wide one (``simple_setup(authority=1.0,
    holds=(1, 25))``) gives quicker flights. Between two steps the flight is free for certain, not
    only at them. The planner stops within some 50 ms of the condition, and goes on from there when
    ``solve`` is called again.

    The cost is the duration, or with a ``RiskObjective`` its risk along the flight, f at every step
    at the flight's own time, plus its weight times the duration.

    Args:
        si: from ``simple_setup``, or built alike.
        seed: of the samples.
        selection_radius: of the states among which the least cost is selected, as a distance [m];
            see ``WEIGHTS``. Ten times the pruning radius if left out.
        pruning_radius: that a witness stands for [m]; 1.2 % of the distance from start to goal, but
            at most 4 m, if left out.
        iterations: to do in a call of ``solve``; no limit if left out. Runs with the same limit
            and seed, and enough time, give the same path.
        authority: part of each input's range about hover from which held inputs are drawn.
        shrink: whether the radii shrink as the tree fills.
        helicopter: the vehicle of the propagator.

    Raises:
        ArgumentError: a value out of range, or another kind of space.

    Attributes:
        history: a row for each better path: seconds, cost, nodes.
        reason: why there is no path, in words.

    Example:
        >>> from ompl_risk import terrains
        >>> from ompl_risk.helicopter.setup import simple_setup
        >>> flat = terrains.Terrain(np.zeros((10, 10)), spacing=(20.0, 20.0))
        >>> setup = simple_setup(flat, start=(40, 90, 20), goal=(140, 90, 20), authority=1.0)
        >>> setup.setPlanner(SST(setup.getSpaceInformation()))

    Reference:
        Li, Littlefield & Bekris, Asymptotically optimal sampling-based kinodynamic planning, IJRR
        35(5), 2016.
    """

    def __init__(
        self,
        si: oc.SpaceInformation,
        *,
        seed: int = 1,
        selection_radius: float | None = None,
        pruning_radius: float | None = None,
        iterations: int | None = None,
        authority: float = 0.1,
        shrink: bool = True,
        helicopter: Helicopter | None = None,
    ) -> None:
        check_space(si)
        super().__init__(si, "SST")
        self._options = Options(
            seed=seed, selection_radius=selection_radius, pruning_radius=pruning_radius,
            iterations=iterations, authority=authority, shrink=shrink,
        )  # fmt: skip
        self._helicopter = Helicopter() if helicopter is None else helicopter
        self._writer = PathWriter(si)
        self._habits = Habits()
        self._forget()

    def _forget(self) -> None:
        self._worker: Worker | None = None
        self._growth: Growth | None = None
        self._starts: list[FloatArray] = []
        self._seconds = 0.0
        self._published: Any = None
        self._announced: Any = None
        self.history: list[Progress] = []
        self.reason = ""

    @property
    def tree(self) -> SparseTree | None:
        """The tree; None before the problem is known."""
        self._leave()
        return self._growth.tree if self._growth is not None else None

    def setup(self) -> None:
        """Read the problem and compile, so that ``solve`` spends its time on planning."""
        super().setup()
        definition: Any = self.getProblemDefinition()
        if definition is not None and isinstance(definition.getGoal(), HelicopterGoal):
            problem, middle = self._read(), np.array(definition.getGoal().state)
            _, tree, draw = self._new(problem, [middle], nodes=64)
            tree.compile(draw)
            problem.cost(middle[None])

    def clear(self) -> None:
        """Forget the tree and what was found."""
        super().clear()
        self._leave()
        self._forget()

    def clearQuery(self) -> None:
        """The same: a tree belongs to its start and goal."""
        self.clear()

    def solve(self, ptc: Any) -> ob.PlannerStatus:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Plan until the condition holds, or nothing is left to gain.

        Args:
            ptc: the condition, or seconds.

        Returns:
            ``EXACT_SOLUTION`` if there is a path, else ``TIMEOUT``, or what is wrong with start or
            goal; ``reason`` tells more.

        Raises:
            ArgumentError: an objective, checker or propagator that compiled code cannot serve.
        """
        condition: Any = after(float(ptc)) if isinstance(ptc, int | float) else ptc
        if self._worker is not None:
            if not self._worker.ended(condition):
                return self._status()
            self._worker = None
        self.checkValidity()
        wrong, growth = self._open(), self._growth
        if wrong is not None:
            return ob.PlannerStatus(wrong)
        if growth is None:
            return self._status()
        work = self._work(growth)
        self._worker = Worker(work, abandon=True)
        try:
            self._worker.wait(condition, lambda: self._publish(work))
        finally:
            self._seconds = work.seconds
            self._publish(work)
            self._explain()
        return self._status()

    def _work(self, growth: Growth) -> Searching:
        return Searching(
            growth,
            habits=self._habits,
            enough=self._satisfied(),
            shrink=self._options.shrink,
            seconds=self._seconds,
            iterations=self._options.iterations,
            history=self.history,
        )

    def _status(self) -> ob.PlannerStatus:
        return ob.PlannerStatus(self._published is not None, False)

    def _open(self) -> Any:
        """Make the tree the first time; the status to return if there is no problem to solve."""
        goal: Any = self.getProblemDefinition().getGoal()
        if not isinstance(goal, HelicopterGoal):
            self.reason = f"the goal, {type(goal).__name__}, is no HelicopterGoal"
            return ob.PlannerStatus.UNRECOGNIZED_GOAL_TYPE
        self._starts += self._new_starts()
        if self._growth is None and self._starts:
            growth = self._new(self._read(), self._starts, nodes=NODES)
            if growth.tree.count(sst_tree.NODES) > 0:
                self._growth = growth
        if self._growth is None:
            self.reason = "no start state that is within the bounds and limits, and free"
            return ob.PlannerStatus.INVALID_START
        return None

    def _new_starts(self) -> list[FloatArray]:
        """Starts that OMPL has not given before; those that come late take part at once."""
        inputs: Any = self.getPlannerInputStates()
        space: Any = self.getSpaceInformation().getStateSpace()
        state, found = Buffer(STATE), []
        while (start := inputs.nextStart()) is not None:
            space.serialize(state.capsule, start)
            found.append(state.numbers.copy())
        if found and self._growth is not None:
            problem, tree, draw = self._growth
            for start in found:
                tree.plant(start)
            everywhere = np.concatenate([draw.starts, found])
            self._growth = Growth(problem, tree, draw._replace(starts=everywhere))
        return found

    def _read(self) -> Problem:
        definition: Any = self.getProblemDefinition()
        objective = definition.getOptimizationObjective()
        return read_problem(
            self.getSpaceInformation(), definition.getGoal(), objective, self._helicopter
        )

    def _new(self, problem: Problem, starts: list[FloatArray], *, nodes: int) -> Growth:
        """A tree with its starts, and how it grows."""
        vehicle, options = problem.vehicle, self._options
        low, high = problem.box
        way = min(float(np.linalg.norm(start[:3] - vehicle.goal[:3])) for start in starts)
        radii = options.radii(way)
        tree = SparseTree(
            vehicle, problem.handle, low=low, high=high, weights=WEIGHTS, radii=radii, most=nodes
        )
        for start in starts:
            tree.plant(start)
        draw = self._habits.draw(
            problem, starts, seed=options.seed, authority=options.authority, radius=radii[1]
        )
        return Growth(problem, tree, draw)

    def _publish(self, work: Searching) -> None:
        """Make a better path OMPL's solution."""
        found, growth = work.found, self._growth
        if found is None or found is self._announced or growth is None:
            return
        (cost, flight), problem = found, growth.problem
        path = self._writer.path(flight, problem.hold, problem.longest_hold)
        add_solution(
            self.getProblemDefinition(), path, cost, self.getName(), self._published,
            lambda other: problem.cost(self._writer.states(other)),
        )  # fmt: skip
        self._published, self._announced = path, found

    def _explain(self) -> None:
        growth, self.reason = self._growth, ""
        if self._published is None and growth is not None:
            tree = growth.tree
            nodes, done = tree.count(sst_tree.NODES), tree.count(sst_tree.ITERATIONS)
            self.reason = (
                f"no path in a tree of {nodes} nodes after {done} iterations: more time, inputs of "
                "more authority, a wider goal or smaller radii may help"
            )

    def _satisfied(self) -> Any:
        """Whether a cost is below the objective's threshold."""
        objective: Any = self.getProblemDefinition().getOptimizationObjective()
        if objective is None:
            return lambda _cost: False
        threshold = objective.getCostThreshold().value()
        return lambda cost: cost < threshold

    def _leave(self) -> None:
        """Wait for work that a condition left behind: it still writes to the tree."""
        if self._worker is not None:
            self._worker.join()
            self._worker = None
