"""Closed-loop simulation: how often a vehicle that follows a plan in wind and error collides."""

from ompl_risk.simulation.budget import Budgeted as Budgeted
from ompl_risk.simulation.budget import fastest_within as fastest_within
from ompl_risk.simulation.closed_loop import closed_loop_probability as closed_loop_probability
from ompl_risk.simulation.disturbances import Disturbances as Disturbances
from ompl_risk.simulation.estimate import CollisionEstimate as CollisionEstimate
from ompl_risk.simulation.gusts import DrydenGusts as DrydenGusts
from ompl_risk.simulation.helicopter_plan import HelicopterPlan as HelicopterPlan
from ompl_risk.simulation.importance import RaisedGround as RaisedGround
from ompl_risk.simulation.navigation import Drift as Drift
from ompl_risk.simulation.navigation import NavigationError as NavigationError
from ompl_risk.simulation.paired import PairedDifference as PairedDifference
from ompl_risk.simulation.paired import compare as compare
from ompl_risk.simulation.plans import Plan as Plan
from ompl_risk.simulation.point_plan import PointPlan as PointPlan
from ompl_risk.simulation.terrain_error import TerrainError as TerrainError
from ompl_risk.simulation.until import Count as Count
from ompl_risk.simulation.until import Decided as Decided
from ompl_risk.simulation.until import Narrow as Narrow
