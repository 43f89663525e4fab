"""The OMPL side: validity, motions, objective, paths, and guards against OMPL's traps.

Importing this package puts the guards in place, see ``ompl_risk.bridge.guards``.
"""

from ompl_risk.bridge import guards
from ompl_risk.bridge.motion import ClearanceMotionValidator as ClearanceMotionValidator
from ompl_risk.bridge.objective import RiskObjective as RiskObjective
from ompl_risk.bridge.paths import publish as publish
from ompl_risk.bridge.paths import read_path as read_path
from ompl_risk.bridge.validity import ClearanceValidityChecker as ClearanceValidityChecker

guards.install()
