"""What a flight meets that its plan does not know: gusts, navigation error, terrain error."""

from ompl_risk.simulation.disturbances.together import LEVELS as LEVELS
from ompl_risk.simulation.disturbances.together import Disturbances as Disturbances
