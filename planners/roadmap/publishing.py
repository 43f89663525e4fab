"""Routes as OMPL's paths and solutions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from scipy.spatial.transform import Rotation, Slerp

from ompl_risk._arrays import FloatArray
from ompl_risk.bridge.states import StateWriter


def to_path(
    si: ob.SpaceInformation, states: FloatArray, turns: tuple[FloatArray, FloatArray] | None = None
) -> og.PathGeometric:
    """States as OMPL's path.

    Args:
        si: over R^3 or SE(3).
        states: positions (k, 3) [m], or poses (k, 7).
        turns: quaternions (x, y, z, w) at both ends, where OMPL's states have an orientation and
            the planner's have none: the path then turns from one to the other as it goes.
    """
    if turns is not None and states.shape[1] == 3:
        states = np.hstack([states, _turning(states, *turns)])
    writer, path = StateWriter(si), og.PathGeometric(si)
    for row in states:
        path.append(writer.state(row))
    return path


def _turning(positions: FloatArray, first: FloatArray, last: FloatArray) -> FloatArray:
    """Quaternions in proportion to the way gone, the ends exactly as given."""
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    gone = np.concatenate([[0.0], np.cumsum(steps)])
    share = gone / gone[-1] if gone[-1] > 0.0 else np.linspace(0.0, 1.0, len(gone))
    between = Slerp([0.0, 1.0], Rotation.from_quat([first, last]))(np.minimum(share, 1.0))
    quaternions = between.as_quat()
    quaternions[0], quaternions[-1] = first, last
    return quaternions


def add_solutions(
    problem: Any,
    paths: Sequence[Any],
    objective: Any,
    name: str,
    own: Sequence[Any] = (),
) -> None:
    """Make the first path the solution, unless a better one of another planner is there.

    OMPL 2.0.1 orders exact solutions by length whatever the objective, so only one goes in as
    exact; the others follow in order, as approximate ones with their rank as the distance.

    Args:
        problem: the ``ob.ProblemDefinition``.
        paths: the best first.
        objective: by which a solution that is there already is compared; None for the length.
        name: of the planner.
        own: paths that the planner put in before.
    """
    ordered = list(paths)
    if problem.hasExactSolution():
        there: Any = problem.getSolutionPath()
        foreign = not any(there is path for path in own)
        if foreign and (not ordered or _cost(there, objective) < _cost(ordered[0], objective)):
            ordered.insert(0, there)
    problem.clearSolutionPaths()
    for rank, path in enumerate(ordered):
        problem.addSolutionPath(path, rank > 0, float(rank) if rank else -1.0, name)


def _cost(path: Any, objective: Any) -> float:
    if not isinstance(path, og.PathGeometric):
        return math.inf
    return path.length() if objective is None else path.cost(objective).value()
