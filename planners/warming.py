"""Compile what planning needs."""

from __future__ import annotations

import numpy as np

from ompl_risk.frechet import frechet_distance
from ompl_risk.motion import Risk, motion_model
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.problem import Problem


def warm_up(problem: Problem) -> None:
    """Compile the kernels that planning and selecting call, and leave them in numba's cache.

    To be called before worker processes start, or each of them would compile the same on its own.
    """
    for norm in (Sobolev(1), Lp(1)):
        model = motion_model(problem.clearance, Risk(problem.avoidance, norm, speed=problem.speed))
        model.a[:], model.b[:] = problem.start, problem.goal
        for question in (model.clearance, model.is_free, model.is_motion_free, model.cost):
            question()
        model.heuristic()
    line = np.array([problem.start, problem.goal])
    frechet_distance(line, line)
    problem.clearance(line)
