"""Closed-loop simulation: how often a vehicle that follows a plan in wind and error collides."""

from ompl_risk.simulation.budget import Budgeted as Budgeted
from ompl_risk.simulation.budget import fastest_within as fastest_within
from ompl_risk.simulation.closed_loop import closed_loop_probability as closed_loop_probability
from ompl_risk.simulation.disturbances.gusts import DrydenGusts as DrydenGusts
from ompl_risk.simulation.disturbances.navigation import Drift as Drift
from ompl_risk.simulation.disturbances.navigation import NavigationError as NavigationError
from ompl_risk.simulation.disturbances.terrain_error import TerrainError as TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances as Disturbances
from ompl_risk.simulation.estimates.estimate import CollisionEstimate as CollisionEstimate
from ompl_risk.simulation.estimates.paired import PairedDifference as PairedDifference
from ompl_risk.simulation.estimates.paired import compare as compare
from ompl_risk.simulation.estimates.until import Count as Count
from ompl_risk.simulation.estimates.until import Decided as Decided
from ompl_risk.simulation.estimates.until import Narrow as Narrow
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan as HelicopterPlan
from ompl_risk.simulation.loop.plans import Plan as Plan
from ompl_risk.simulation.loop.point_plan import PointPlan as PointPlan
from ompl_risk.simulation.prediction import predicted_probability as predicted_probability
from ompl_risk.simulation.rare.importance import RaisedGround as RaisedGround
