"""Planning in space and time: the earliest arrival among obstacles that move."""

from ompl_risk.planners.spacetime.earliest import earliest_arrival as earliest_arrival
from ompl_risk.planners.spacetime.network import Network as Network
from ompl_risk.planners.spacetime.route import Arrival as Arrival
from ompl_risk.planners.spacetime.route import TimedRoute as TimedRoute
from ompl_risk.planners.spacetime.route import Wait as Wait
