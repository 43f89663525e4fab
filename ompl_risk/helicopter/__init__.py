"""A small helicopter: eqs. (7) and (8) of the paper, trajectory primitives, OMPL control space.

`HelicopterSteering` makes `planners.RiskRoadmap` fly trims and manoeuvres; `simple_setup` is a
control planning problem, ready to solve.
"""

from ompl_risk.helicopter.batch import PrimitiveBatch as PrimitiveBatch
from ompl_risk.helicopter.envelope import Envelope as Envelope
from ompl_risk.helicopter.flight import Deviation as Deviation
from ompl_risk.helicopter.flight import Flight as Flight
from ompl_risk.helicopter.flight_file import read_flight as read_flight
from ompl_risk.helicopter.flight_file import write_flight as write_flight
from ompl_risk.helicopter.flying import fly as fly
from ompl_risk.helicopter.goals import HelicopterGoal as HelicopterGoal
from ompl_risk.helicopter.library import PrimitiveLibrary as PrimitiveLibrary
from ompl_risk.helicopter.library import default_library as default_library
from ompl_risk.helicopter.library_file import write_library as write_library
from ompl_risk.helicopter.model import control_matrix as control_matrix
from ompl_risk.helicopter.model import derivative as derivative
from ompl_risk.helicopter.model import make_state as make_state
from ompl_risk.helicopter.model import simulate as simulate
from ompl_risk.helicopter.model import world_velocity as world_velocity
from ompl_risk.helicopter.parameters import Helicopter as Helicopter
from ompl_risk.helicopter.parameters import Limits as Limits
from ompl_risk.helicopter.primitive_path import PrimitivePath as PrimitivePath
from ompl_risk.helicopter.primitives import Manoeuvre as Manoeuvre
from ompl_risk.helicopter.setup import simple_setup as simple_setup
from ompl_risk.helicopter.spaces import GENTLE as GENTLE
from ompl_risk.helicopter.spaces import control_space as control_space
from ompl_risk.helicopter.spaces import propagator as propagator
from ompl_risk.helicopter.spaces import state_space as state_space
from ompl_risk.helicopter.steering import HelicopterSteering as HelicopterSteering
from ompl_risk.helicopter.trims import Trim as Trim
from ompl_risk.helicopter.trims import solve_trim as solve_trim
from ompl_risk.helicopter.validity import HelicopterValidityChecker as HelicopterValidityChecker
