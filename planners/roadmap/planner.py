"""The roadmap as an OMPL planner."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ompl import base as ob

from ompl_risk.bridge.conditions import after
from ompl_risk.bridge.timed import is_timed
from ompl_risk.clearance.threads import thread_count
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.kinodynamic import KinodynamicSteering
from ompl_risk.motion.steering import Steering
from ompl_risk.planners.roadmap.anytime import Growing, Polish, Progress, satisfied_by
from ompl_risk.planners.roadmap.exploring import (
    Front,
    alternative_routes,
    pareto_routes,
)
from ompl_risk.planners.roadmap.goals import Ends, GoalSource
from ompl_risk.planners.roadmap.publisher import Publisher
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route
from ompl_risk.planners.roadmap.setting import CheckerGate, Setting
from ompl_risk.planners.roadmap.translation import Translation
from ompl_risk.planners.roadmap.vehicle_setting import setting_of
from ompl_risk.planners.roadmap.warming import warm_up, warm_up_vehicle
from ompl_risk.planners.roadmap.worker import Worker
from ompl_risk.planners.spacetime.planning import SpaceTimePlanning
from ompl_risk.trajectory import Trajectory


class RiskRoadmap(ob.Planner):
    """Anytime roadmap planner for a ``RiskObjective``, in compiled code throughout.

    Grows a roadmap in batches, finds its least costly path by evaluating hardly more edges than
    lie on it, polishes that, and samples on where the path can still be improved. Starts,
    goals, bounds, objective and termination condition are OMPL's, read when it meets them first;
    call ``clear`` if they change. It stops within some 50 ms of the condition with the best path so
    far, and goes on from there when ``solve`` is called again.

    Works over R^3 and SE(3), with a ``RiskObjective`` of any norm and clearance, or for path
    length; and over the states of a vehicle with a ``KinodynamicSteering``, as
    ``HelicopterSteering()``: solutions are then ``oc.PathControl``. To fly one of 15 km takes some
    300 ms after the condition holds. Connections keep as much farther from obstacles and from the
    sides of the box as a flight may be beside them, half a metre for the helicopter.

    Over ``ob.SpaceTimeStateSpace``, with a ``ClearanceValidityChecker`` of a ``MovingClearance``
    and no objective, it plans the earliest arrival among moving obstacles; see its
    ``SpaceTimePlanning``.

    With other clearances than a ``TerrainClearance``, and with a validity checker or motion
    validator that is not this library's, Python runs for states and motions, batched, and some
    hundred times slower; ``compiled`` says whether it does. It then stops once the portion at hand
    is done.

    Args:
        si: the space information.
        seed: of the samples. The same seed gives the same batches; how many of them depends on the
            time.
        steering: how vertices are connected, and for a vehicle with dynamics what they are;
            straight at the objective's speed if left out.
        iterations: places to sample in a call of ``solve``; no limit if left out. Runs with the
            same limit and seed, and enough time, give the same path.
        threads: of compiled code; ``None`` uses all processors.
        can_wait: among moving obstacles, whether the vehicle can hover.

    Raises:
        ArgumentError: a seed, or a number of iterations or threads, out of range.

    Attributes:
        history: a row for each better path: seconds, cost, vertices, edges, evaluated.
        reason: why there is no path, in words.

    Example:
        >>> import numpy as np
        >>> from ompl import geometric as og
        >>> from ompl_risk import RiskObjective, TerrainClearance, terrains
        >>> space = ob.RealVectorStateSpace(3)
        >>> space.setBounds(0.0, 90.0)
        >>> setup = og.SimpleSetup(space)
        >>> si = setup.getSpaceInformation()
        >>> flat = TerrainClearance(terrains.Terrain(np.zeros((10, 10)), spacing=(10.0, 10.0)))
        >>> setup.setOptimizationObjective(RiskObjective(si, flat, speed=10.0))
        >>> setup.setPlanner(RiskRoadmap(si))
    """

    def __init__(
        self,
        si: ob.SpaceInformation,
        *,
        seed: int = 1,
        steering: Steering | KinodynamicSteering | None = None,
        iterations: int | None = None,
        threads: int | None = None,
        can_wait: bool = True,
    ) -> None:
        super().__init__(si, "RiskRoadmap")
        if not isinstance(seed, int) or isinstance(seed, bool) or seed < 0:
            raise ArgumentError("seed", seed, "a whole number of at least 0")
        if iterations is not None and (isinstance(iterations, bool) or iterations < 1):
            raise ArgumentError("iterations", iterations, "None or a whole number from 1")
        thread_count(threads)
        self._seed, self._steering, self._threads = seed, steering, threads
        self._iterations = iterations
        self._timed: SpaceTimePlanning | None = None
        if is_timed(si.getStateSpace()):
            self._timed = SpaceTimePlanning(
                si, seed=seed, steering=steering, can_wait=can_wait, threads=threads
            )
        self._setting: Setting | None = None
        self._roadmap: Roadmap | None = None
        self._worker: Worker | None = None
        self._seconds = 0.0
        self._publisher: Publisher | None = None
        self._ends = Ends()
        self.history: list[Progress] = []
        self.reason = ""

    @property
    def compiled(self) -> bool:
        """Whether no Python runs for single states and motions; known once the problem is."""
        return self._roadmap is not None and self._roadmap.compiled

    @property
    def roadmap(self) -> Roadmap | None:
        """The roadmap; None before the problem is known."""
        self._leave()
        return self._roadmap

    def setup(self) -> None:
        """Read the problem and compile, so that ``solve`` spends its time on planning."""
        super().setup()
        if self._timed is not None:
            self._timed.warm_up()
        elif self.getProblemDefinition() is not None:
            roadmap = self._opened()
            warm_up(roadmap.risk.norm)
            if isinstance(self._steering, KinodynamicSteering) and not roadmap.n:
                warm_up_vehicle(roadmap, self._steering)

    def clear(self) -> None:
        """Forget the roadmap and what was found."""
        super().clear()
        self._leave()
        self._roadmap, self._setting, self._seconds = None, None, 0.0
        self._publisher, self._ends = None, Ends()
        if self._timed is not None:
            self._timed.clear()
        self.history, self.reason = [], ""

    def clearQuery(self) -> None:
        """Forget start, goal and what was found; the next query grows a roadmap anew."""
        self.clear()

    def solve(self, ptc: Any) -> ob.PlannerStatus:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Plan until the condition holds, or nothing is left to gain.

        Args:
            ptc: the condition, or seconds.

        Returns:
            ``EXACT_SOLUTION`` if there is a path, else ``TIMEOUT``, or what is wrong with start or
            goal; ``reason`` tells more.

        Raises:
            ArgumentError: an objective or a space that a roadmap cannot serve.
            Exception: what a clearance or checker raised; what was found before is kept.
        """
        condition: Any = after(float(ptc)) if isinstance(ptc, int | float) else ptc
        if self._worker is not None:
            if not self._worker.ended(condition):
                return self._status()
            self._worker = None
        self.checkValidity()
        if self._timed is not None:
            return self._solve_timed(self._timed, condition)
        roadmap = self._opened()
        goals = GoalSource(
            self.getProblemDefinition(), self.getPlannerInputStates(), self._translation.row
        )
        wrong = self._ends.add_to(roadmap, goals, self._translation.row, condition)
        if wrong is not None:
            status, self.reason = wrong
            return ob.PlannerStatus(status)
        work = Growing(
            roadmap,
            polish=self._polish(),
            enough=satisfied_by(self.getProblemDefinition().getOptimizationObjective()),
            seconds=self._seconds,
            samples=self._iterations,
            history=self.history,
        )
        # A checker of the user may only be asked by one thread at a time, and no clock may decide
        # which goals there are where the same path is wanted again.
        more = not isinstance(roadmap.gate, CheckerGate) and self._iterations is None

        def meanwhile() -> None:
            self._published().announce(self.getProblemDefinition())
            if more:
                work.more_goals.extend(goals.later())

        self._worker = Worker(work, abandon=roadmap.compiled)
        try:
            self._worker.wait(condition, meanwhile)
        finally:
            self._conclude(roadmap, work)
        return self._status()

    def _solve_timed(self, timed: SpaceTimePlanning, condition: Any) -> ob.PlannerStatus:
        """Plan the earliest arrival in space-time."""
        problem, inputs = self.getProblemDefinition(), self.getPlannerInputStates()
        try:
            return timed.solve(problem, inputs, condition, self._iterations)
        finally:
            self.history, self.reason = timed.history, timed.reason

    def trajectory(self, name: str = "") -> Trajectory:
        """The solution among moving obstacles, with its times.

        Raises:
            ArgumentError: not over space-time, or without a solution.
        """
        route = None if self._timed is None else self._timed.route
        if route is None:
            raise ArgumentError("planner", "RiskRoadmap", "solved with over space-time before")
        return route.trajectory(name)

    def _status(self) -> ob.PlannerStatus:
        found = self._roadmap is not None and self._roadmap.best is not None
        return ob.PlannerStatus(found, False)

    def _conclude(self, roadmap: Roadmap, work: Growing) -> None:
        """Publish the best path, keep the history."""
        self._seconds = work.seconds
        if roadmap.best is None:
            self.reason = (
                f"no path in a roadmap of {roadmap.n} vertices, of which {roadmap.reached} may be "
                "reached from the start: more time, wider bounds or a smaller vehicle may help"
            )
            return
        self.reason = ""
        self.publish([roadmap.best])

    def alternatives(
        self, count: int = 20, *, excess: float = 0.05, min_distance: float | None = None
    ) -> tuple[Route, ...]:
        """Routes of nearly the same duration that really differ, see ``alternative_routes``.

        Over a ``TerrainClearance``, passing a peak that is too high to cross on its other side is a
        difference, however near.

        Raises:
            ArgumentError: before ``solve``, or a number out of range.
        """
        sides = None if self._setting is None else self._setting.sides()
        return alternative_routes(
            self._planned(), count, excess=excess, min_distance=min_distance, sides=sides
        )

    def pareto(self, *, longest: float = math.inf, precision: float = 0.0) -> Front:
        """The routes that no other undercuts in both duration and risk, see ``pareto_routes``.

        Raises:
            ArgumentError: before ``solve``, or a number out of range.
        """
        return pareto_routes(self._planned(), longest=longest, precision=precision)

    def _planned(self) -> Roadmap:
        if self._timed is not None:
            allowed = "not over space-time, where only the earliest arrival is planned"
            raise ArgumentError("planner", "RiskRoadmap", allowed)
        roadmap = self.roadmap
        if roadmap is None or not roadmap.starts:
            raise ArgumentError("planner", "RiskRoadmap without a roadmap", "solved with before")
        return roadmap

    def path(self, route: Route) -> Any:
        """A route, as of ``alternatives`` or ``pareto``, as a path of OMPL.

        ``Trajectory.from_path`` makes it something to rank.

        Returns:
            An ``og.PathGeometric``, or for a vehicle with dynamics an ``oc.PathControl``.

        Raises:
            ArgumentError: before ``solve``.
        """
        return self._translation.path(route, self._planned())

    def publish(self, routes: Sequence[Route]) -> None:
        """Make routes OMPL's solutions: the first exact, the others approximate, in their order.

        A better exact solution of another planner that is there already stays first.
        """
        self._published().publish(self.getProblemDefinition(), routes)

    def _published(self) -> Publisher:
        if self._publisher is None:
            self._publisher = Publisher(self._translation, self._opened(), self.getName())
        return self._publisher

    @property
    def _translation(self) -> Translation:
        if self._setting is None:
            raise ArgumentError("planner", "RiskRoadmap without a roadmap", "solved with before")
        return self._setting.translation

    def _opened(self) -> Roadmap:
        """The roadmap, made from the problem the first time."""
        if self._roadmap is None:
            si: Any = self.getSpaceInformation()
            objective: Any = self.getProblemDefinition().getOptimizationObjective()
            self._setting = setting = setting_of(
                si, objective, seed=self._seed, steering=self._steering, threads=self._threads
            )
            self._roadmap = Roadmap(
                setting.region,
                setting.motions,
                setting.risk,
                gate=setting.gate,
                undirected=setting.undirected,
                threads=self._threads,
            )
        return self._roadmap

    def _polish(self) -> Polish | None:
        if self._setting is None:
            return None
        if self._iterations is not None:  # no clock may have a say in the result
            return self._setting.polish(math.inf)
        return self._setting.polish()

    def _leave(self) -> None:
        """Wait for work that a condition left behind: it still writes to the roadmap."""
        if self._worker is not None:
            self._worker.join()
            self._worker = None
