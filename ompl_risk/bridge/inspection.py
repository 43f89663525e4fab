"""What Python can see of a problem before OMPL's C++ takes over: who implements which part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ompl import base as ob


@dataclass(frozen=True)
class Attempt:
    """A planner and what it is about to solve.

    Attributes:
        planner: the ``ob.Planner``.
        problem: its ``ob.ProblemDefinition``.
        python_condition: whether its termination condition calls Python.
    """

    planner: Any
    problem: Any
    python_condition: bool = False

    @property
    def objective(self) -> Any:
        """The ``ob.OptimizationObjective``, or None."""
        return self.problem.getOptimizationObjective()

    @property
    def goal(self) -> Any:
        """The ``ob.Goal``, or None."""
        return self.problem.getGoal()


def is_python(thing: object) -> bool:
    """Whether C++ must call Python to use ``thing``: OMPL itself does not define its class.

    A subclass that overrides nothing counts: OMPL asks Python whether there is an override.
    """
    return thing is not None and not _is_ompls(type(thing))


def objective_parts(objective: Any) -> Iterator[Any]:
    """The objective and, inside an ``ob.MultiOptimizationObjective``, its components."""
    if objective is None:
        return
    yield objective
    if isinstance(objective, ob.MultiOptimizationObjective):
        for index in range(objective.getObjectiveCount()):
            yield from objective_parts(objective.getObjective(index))


def is_risk(objective: Any) -> bool:
    """Whether a risk objective takes part, by the class attribute ``is_risk_objective``.

    An attribute rather than a class: the guards must not import the objective they protect.
    """
    return any(
        getattr(type(part), "is_risk_objective", False) for part in objective_parts(objective)
    )


def has_python_objective(attempt: Attempt) -> bool:
    """Whether any part of the objective is written in Python."""
    return any(is_python(part) for part in objective_parts(attempt.objective))


def has_python_goal(attempt: Attempt) -> bool:
    """Whether the goal is written in Python."""
    return is_python(attempt.goal)


def has_risk_objective(attempt: Attempt) -> bool:
    """Whether a risk objective takes part."""
    return is_risk(attempt.objective)


def has_other_python_objective(attempt: Attempt) -> bool:
    """Whether the objective is written in Python, by someone else."""
    return has_python_objective(attempt) and not has_risk_objective(attempt)


def has_python_condition(attempt: Attempt) -> bool:
    """Whether the termination condition is written in Python."""
    return attempt.python_condition


def has_vain_override(attempt: Attempt) -> bool:
    """Whether a part overrides an ``ob.StateCostIntegralObjective``, which OMPL never notices."""
    return any(
        isinstance(part, ob.StateCostIntegralObjective) and _overrides_objective(type(part))
        for part in objective_parts(attempt.objective)
    )


def checks_goals_in_python(attempt: Attempt) -> bool:
    """Whether there are several goal states, and Python says which of them can be reached."""
    goal, space = attempt.goal, attempt.problem.getSpaceInformation()
    if not isinstance(goal, ob.GoalSampleableRegion) or goal.maxSampleCount() < 2:
        return False
    checker = space.getStateValidityChecker()
    is_function = type(checker) is ob.StateValidityChecker  # abstract: only functions look so
    return is_function or is_python(checker) or is_python(space.getMotionValidator())


def minimises_length(attempt: Attempt) -> bool:
    """Whether the objective is OMPL's own path length, which is also what it takes for none."""
    return (
        attempt.objective is None or type(attempt.objective) is ob.PathLengthOptimizationObjective
    )


def waits_for_lazy_samples(attempt: Attempt) -> bool:
    """Whether goal states are still to come from a sampler in another thread."""
    return isinstance(attempt.goal, ob.GoalLazySamples) and not attempt.goal.hasStates()


def _is_ompls(kind: type) -> bool:
    return kind.__module__.startswith("ompl.")


def _overrides_objective(kind: type) -> bool:
    virtual = {name for name in vars(ob.OptimizationObjective) if not name.startswith("_")}
    return any(virtual & vars(c).keys() for c in kind.__mro__[:-1] if not _is_ompls(c))
