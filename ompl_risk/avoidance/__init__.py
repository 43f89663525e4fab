"""Avoidance functions: how much danger a distance to obstacles stands for."""

from ompl_risk.avoidance.base import Avoidance as Avoidance
from ompl_risk.avoidance.base import checked_distance as checked_distance
from ompl_risk.avoidance.flat_cap import FlatCap as FlatCap
from ompl_risk.avoidance.gaussian_tail import GaussianTail as GaussianTail
from ompl_risk.avoidance.inverse_distance import InverseDistance as InverseDistance
