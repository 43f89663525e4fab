"""What OMPL's planners do with a problem partly written in Python: hang, crash, or ignore it.

Each :class:`Trap` was observed on the OMPL 2.0.1 wheel; ``ompl-risk doctor`` observes the kinds
of traps again on the OMPL that is installed. This table is knowledge only: it looks at a planner
and its problem and answers. Acting on the answer is the guards' business.

Why PRM's second thread matters: ``PRM.solve`` looks for a solution in a C++ thread while the
calling thread, which holds Python's interpreter lock, grows the roadmap and then waits for the
other. Whatever makes the second thread call Python makes it wait for the lock, and both wait for
ever; in some problems always, in others in one run out of three.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og

from ompl_risk.bridge import inspection
from ompl_risk.bridge.inspection import Attempt


@dataclass(frozen=True, kw_only=True)
class Trap:
    """One thing that goes wrong, and the way round.

    Attributes:
        planners: the planner classes that it concerns.
        when: whether it happens to a given attempt of one of these planners.
        what: the unsafe thing; may name {planner}, {objective} and {goal}.
        symptom: what OMPL would do.
        instead: what to use.
    """

    planners: tuple[type, ...]
    when: Callable[[Attempt], bool]
    what: str
    symptom: str
    instead: str

    def hits(self, attempt: Attempt) -> bool:
        """Whether ``attempt`` would run into this trap."""
        return isinstance(attempt.planner, self.planners) and self.when(attempt)

    def name(self, attempt: Attempt) -> str:
        """The unsafe thing, with the names of the classes concerned."""
        return self.what.format(
            planner=type(attempt.planner).__name__,
            objective=type(attempt.objective).__name__,
            goal=type(attempt.goal).__name__,
        )


def _named(module: Any, *names: str) -> tuple[type, ...]:
    """The classes of these names that the installed OMPL has."""
    return tuple(getattr(module, name) for name in names if hasattr(module, name))


ANY = (ob.Planner,)
ROADMAP = _named(og, "PRM")  # PRMstar derives from it
MARCHING = _named(og, "FMT", "BFMT")
LENGTH_ONLY = _named(og, "AORRTC")
FEASIBLE_ONLY = _named(og, "RRT", "RRTConnect", "KPIECE1", "BKPIECE1", "LBKPIECE1")
CONTROL = _named(oc, "RRT", "EST", "KPIECE1", "SyclopRRT", "SyclopEST")

_OTHERS = "og.RRTstar, og.InformedRRTstar, og.SORRTstar or og.BITstar"
_FOR_RISK = f"ompl_risk.planners.RiskRoadmap, {_OTHERS}"
_DEADLOCK = "its second thread waits for Python, and Python waits for that thread"
_LENGTH = "minimises the path's length: it never asks for the cost of a motion"

REFUSED: tuple[Trap, ...] = (
    Trap(
        planners=ANY,
        when=inspection.has_vain_override,
        what="{objective}, derived from ob.StateCostIntegralObjective,",
        symptom="is ignored: OMPL never calls its overrides, and the cost is the path's length",
        instead="derive from ob.OptimizationObjective and define motionCost, or use RiskObjective",
    ),
    Trap(
        planners=ROADMAP,
        when=inspection.has_python_objective,
        what="{planner} with {objective}, an objective written in Python,",
        symptom=f"hangs for ever: {_DEADLOCK}",
        instead=f"use {_FOR_RISK}, or planner.growRoadmap(seconds), which has no second thread, "
        "and search the graph of planner.getPlannerData(data) yourself",
    ),
    Trap(
        planners=ROADMAP,
        when=inspection.has_python_goal,
        what="{planner} with {goal}, a goal written in Python,",
        symptom=f"hangs in one run out of a few: {_DEADLOCK}",
        instead=f"use ob.GoalState, or {_OTHERS}",
    ),
    Trap(
        planners=ROADMAP,
        when=inspection.checks_goals_in_python,
        what="{planner} with several goal states and validity checks written in Python",
        symptom=f"hangs for ever: {_DEADLOCK}",
        instead=f"give it one goal state, or use {_OTHERS}",
    ),
    Trap(
        planners=ROADMAP,
        when=inspection.has_python_condition,
        what="{planner} with a termination condition written in Python",
        symptom=f"hangs for ever: {_DEADLOCK}",
        instead="pass a number of seconds, or ob.timedPlannerTerminationCondition(seconds)",
    ),
    Trap(
        planners=MARCHING,
        when=inspection.has_risk_objective,
        what="{planner} with {objective}",
        symptom="finds nothing or crashes: it looks up neighbours by cost, and risk is no metric",
        instead=f"use {_FOR_RISK}",
    ),
    Trap(
        planners=LENGTH_ONLY,
        when=inspection.has_risk_objective,
        what="{planner} with {objective}",
        symptom=_LENGTH,
        instead=f"use {_FOR_RISK}",
    ),
)
"""Traps that end in a hang, a crash or a wrong optimum: the call is refused."""

WARNED: tuple[Trap, ...] = (
    Trap(
        planners=_named(og, "SORRTstar"),
        when=inspection.minimises_length,
        what="{planner} minimising the path's length",
        symptom="hangs for ever if the straight way turns out to be free: no sample is better",
        instead="use og.InformedRRTstar or og.RRTstar",
    ),
    Trap(
        planners=FEASIBLE_ONLY,
        when=inspection.has_risk_objective,
        what="{planner} with {objective}",
        symptom="does not look at the objective: the path is feasible, not optimised for risk",
        instead=f"solve several times and rank the paths (ompl_risk.rank), or use {_FOR_RISK}",
    ),
    Trap(
        planners=CONTROL,
        when=inspection.has_risk_objective,
        what="{planner} with {objective}",
        symptom="does not look at the objective: the path is feasible, not optimised for risk",
        instead="solve several times and rank the paths (ompl_risk.rank), or for a helicopter use "
        "ompl_risk.planners.SST, or RiskRoadmap with a HelicopterSteering",
    ),
    Trap(
        planners=MARCHING,
        when=inspection.has_other_python_objective,
        what="{planner} with {objective}",
        symptom="looks up neighbours by cost: it crashes or finds nothing if that is no metric",
        instead=f"prefer {_OTHERS}",
    ),
    Trap(
        planners=LENGTH_ONLY,
        when=inspection.has_other_python_objective,
        what="{planner} with {objective}",
        symptom=_LENGTH,
        instead=f"prefer {_OTHERS}",
    ),
    Trap(
        planners=ANY,
        when=inspection.waits_for_lazy_samples,
        what="{planner} with {goal}",
        symptom="may find no goal or hang: its thread cannot run Python while OMPL solves",
        instead="sample first and put the states into an ob.GoalStates",
    ),
)
"""Traps after which OMPL goes on, not as one would expect: a warning, once a planner class."""
