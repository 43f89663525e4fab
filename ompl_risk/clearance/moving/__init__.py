"""Distance to obstacles that move, d(q, t)."""

from ompl_risk.clearance.moving.clearance import MovingClearance as MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox as MovingBox
from ompl_risk.clearance.moving.obstacles import MovingMesh as MovingMesh
from ompl_risk.clearance.moving.obstacles import MovingObstacle as MovingObstacle
from ompl_risk.clearance.moving.obstacles import MovingSphere as MovingSphere
