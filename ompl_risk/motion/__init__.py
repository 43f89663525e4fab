"""Collision and risk of the motions that planners are made of."""

from ompl_risk.motion.base import MotionModel as MotionModel
from ompl_risk.motion.base import Risk as Risk
from ompl_risk.motion.batch import MotionBatch as MotionBatch
from ompl_risk.motion.choice import motion_batch as motion_batch
from ompl_risk.motion.choice import motion_model as motion_model
from ompl_risk.motion.sampled import SampledBatch as SampledBatch
from ompl_risk.motion.sampled_motion import SampledMotion as SampledMotion
from ompl_risk.motion.steered import SteeredBatch as SteeredBatch
from ompl_risk.motion.steered import steered_batch as steered_batch
from ompl_risk.motion.steering import Connection as Connection
from ompl_risk.motion.steering import Steering as Steering
from ompl_risk.motion.steering import StraightSteering as StraightSteering
from ompl_risk.motion.terrain import TerrainBatch as TerrainBatch
from ompl_risk.motion.terrain import TerrainMotion as TerrainMotion
