"""Candidate paths from OMPL's planners: problems, tasks, worker processes, selection."""

from ompl_risk.planners.criteria import Criterion as Criterion
from ompl_risk.planners.criteria import Length as Length
from ompl_risk.planners.criteria import WeightedRisk as WeightedRisk
from ompl_risk.planners.criteria import parse_criterion as parse_criterion
from ompl_risk.planners.generation import candidates as candidates
from ompl_risk.planners.low_level import low_level_flight as low_level_flight
from ompl_risk.planners.menu import menu as menu
from ompl_risk.planners.problem import Problem as Problem
from ompl_risk.planners.selection import Selection as Selection
from ompl_risk.planners.selection import select as select
from ompl_risk.planners.shortcut import shortcut as shortcut
from ompl_risk.planners.solving import solve_task as solve_task
from ompl_risk.planners.task import Candidate as Candidate
from ompl_risk.planners.task import Status as Status
from ompl_risk.planners.task import Task as Task
from ompl_risk.planners.warming import warm_up as warm_up
