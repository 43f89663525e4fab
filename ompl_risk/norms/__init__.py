"""Norms of a function of time: L^p and Sobolev H^k, equations (4) to (6) of the paper."""

from ompl_risk.norms.base import Norm as Norm
from ompl_risk.norms.lp import Lp as Lp
from ompl_risk.norms.naming import parse_norm as parse_norm
from ompl_risk.norms.sobolev import Sobolev as Sobolev
