"""Short problems for planners that draw the helicopter's inputs at random."""

from __future__ import annotations

from typing import Any

import numpy as np
from ompl import base as ob
from ompl import control as oc

from ompl_risk.helicopter.model import make_state
from ompl_risk.helicopter.parameters import Limits
from ompl_risk.helicopter.setup import simple_setup
from ompl_risk.terrains import Terrain

CALM = Limits(speed=15.0, rate=0.5, attitude=0.4)
"""Narrower than what the helicopter can do: a search that draws inputs at random otherwise spends
its time on states from which no input drawn at random recovers."""

STEP = 0.1
"""Of the propagation [s]: at 0.5 rad/s an error of 1e-7, and 1.5 m at most between two checks."""

USUAL: dict[str, Any] = {"limits": CALM, "step": STEP, "holds": (3, 12)}
"""Options of ``simple_setup`` with which the planners succeed most often."""

GRID = 2.5
"""Distance of the terrains' posts [m]."""


def hover_over_ridge(**options: Any) -> oc.SimpleSetup:
    """From hover to hover, 60 m, over a ridge of 15 m; both ends are 7 m below its crest.

    Args:
        **options: of ``simple_setup``, in place of the usual ones.
    """
    x = GRID * np.arange(41)
    heights = np.tile(15.0 * np.exp(-0.5 * ((x - 50.0) / 8.0) ** 2), (33, 1))
    return _setup(heights, (20.0, 40.0, 8.0), (80.0, 40.0, 8.0), options)


def forward_round_pillar(**options: Any) -> oc.SimpleSetup:
    """Forward flight of 100 m at 12 m/s; a pillar of 16 m across stands in the middle.

    Args:
        **options: of ``simple_setup``, in place of the usual ones.
    """
    x, y = GRID * np.arange(49), GRID * np.arange(33)[:, None]
    heights = np.where(np.hypot(x - 60.0, y - 40.0) < 8.0, 60.0, 0.0)
    start, goal = (make_state((east, 40.0, 20.0), velocity=(12.0, 0, 0)) for east in (10.0, 110.0))
    return _setup(heights, start, goal, options)


PROBLEMS = {
    "hover to hover over a ridge": hover_over_ridge,
    "forward flight round a pillar": forward_round_pillar,
}


def _setup(heights: Any, start: Any, goal: Any, options: dict[str, Any]) -> oc.SimpleSetup:
    """A goal of 8 m and 4 m/s; the objective is the duration, which these planners ignore too."""
    terrain = Terrain(heights, spacing=(GRID, GRID))
    xmin, xmax, ymin, ymax = terrain.extent
    setup = simple_setup(
        terrain,
        start=start,
        goal=goal,
        radius=8.0,
        tolerance=4.0,
        low=(xmin, ymin, 0.0),
        high=(xmax, ymax, 40.0),
        **(USUAL | options),
    )
    si = setup.getSpaceInformation()
    setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(si))
    return setup
