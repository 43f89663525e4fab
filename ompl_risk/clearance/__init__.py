"""Distance from the vehicle's body to the obstacles, d(q)."""

from ompl_risk.clearance.base import Clearance as Clearance
from ompl_risk.clearance.base import ClearanceFunction as ClearanceFunction
from ompl_risk.clearance.mesh import MeshClearance as MeshClearance
from ompl_risk.clearance.moving.clearance import MovingClearance as MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox as MovingBox
from ompl_risk.clearance.moving.obstacles import MovingMesh as MovingMesh
from ompl_risk.clearance.moving.obstacles import MovingObstacle as MovingObstacle
from ompl_risk.clearance.moving.obstacles import MovingSphere as MovingSphere
from ompl_risk.clearance.terrain import TerrainClearance as TerrainClearance
from ompl_risk.clearance.union import UnionClearance as UnionClearance
