"""Approximate probability of collision along a trajectory, P_c(t)."""

from ompl_risk.probability.crossings import CrossingRate as CrossingRate
from ompl_risk.probability.crossings import Crossings as Crossings
from ompl_risk.probability.estimators import BallSampling as BallSampling
from ompl_risk.probability.estimators import ColumnQuadrature as ColumnQuadrature
from ompl_risk.probability.estimators import Estimator as Estimator
from ompl_risk.probability.mixed import ColumnsAndSampling as ColumnsAndSampling
from ompl_risk.probability.outcrossing import Outcrossing as Outcrossing
from ompl_risk.probability.profile import CollisionProfile as CollisionProfile
from ompl_risk.probability.profile import collision_probabilities as collision_probabilities
from ompl_risk.probability.profile import collision_probability as collision_probability
from ompl_risk.probability.proportion import Proportion as Proportion
