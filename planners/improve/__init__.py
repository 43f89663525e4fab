"""Improving a given path: fewer corners, less risk in the same time."""

from ompl_risk.planners.improve.measure import Improvement as Improvement
from ompl_risk.planners.improve.measure import Measure as Measure
from ompl_risk.planners.improve.measure import Outcome as Outcome
from ompl_risk.planners.improve.path import improve_path as improve_path
from ompl_risk.planners.improve.refine import refine as refine
from ompl_risk.planners.improve.simplify import simplify as simplify
