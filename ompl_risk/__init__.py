"""Rank motion plans by their risk of collision: Sobolev avoidance norms as an OMPL plug-in.

``import ompl_risk as risk`` gives the names below; scenes are in ``ompl_risk.terrains``, planners
in ``ompl_risk.planners``, a vehicle with dynamics in ``ompl_risk.helicopter``, and how often it
collides in wind and error in ``ompl_risk.simulation``.
"""

from importlib import metadata as _metadata

from ompl_risk import errors as errors
from ompl_risk import helicopter as helicopter
from ompl_risk import planners as planners
from ompl_risk import simulation as simulation
from ompl_risk import terrains as terrains
from ompl_risk.avoidance import Avoidance as Avoidance
from ompl_risk.avoidance import FlatCap as FlatCap
from ompl_risk.avoidance import GaussianTail as GaussianTail
from ompl_risk.avoidance import InverseDistance as InverseDistance
from ompl_risk.bridge import ClearanceMotionValidator as ClearanceMotionValidator
from ompl_risk.bridge import ClearanceValidityChecker as ClearanceValidityChecker
from ompl_risk.bridge import RiskObjective as RiskObjective
from ompl_risk.bridge import publish as publish
from ompl_risk.clearance import Clearance as Clearance
from ompl_risk.clearance import MeshClearance as MeshClearance
from ompl_risk.clearance import MovingBox as MovingBox
from ompl_risk.clearance import MovingClearance as MovingClearance
from ompl_risk.clearance import MovingMesh as MovingMesh
from ompl_risk.clearance import MovingSphere as MovingSphere
from ompl_risk.clearance import TerrainClearance as TerrainClearance
from ompl_risk.clearance import UnionClearance as UnionClearance
from ompl_risk.frechet import frechet_distance as frechet_distance
from ompl_risk.norms import Lp as Lp
from ompl_risk.norms import Norm as Norm
from ompl_risk.norms import Sobolev as Sobolev
from ompl_risk.probability import BallSampling as BallSampling
from ompl_risk.probability import CollisionProfile as CollisionProfile
from ompl_risk.probability import ColumnQuadrature as ColumnQuadrature
from ompl_risk.probability import CrossingRate as CrossingRate
from ompl_risk.probability import collision_probabilities as collision_probabilities
from ompl_risk.probability import collision_probability as collision_probability
from ompl_risk.ranking import Ranking as Ranking
from ompl_risk.ranking import rank as rank
from ompl_risk.trajectory import Trajectory as Trajectory
from ompl_risk.trajectory_files import read_trajectory as read_trajectory
from ompl_risk.trajectory_files import write_csv as write_csv

try:
    __version__ = _metadata.version("ompl-risk")
except _metadata.PackageNotFoundError:  # a bare checkout on the path
    __version__ = "0+unknown"
