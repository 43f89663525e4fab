"""Ranking trajectories by the norms of their avoidance function."""

from ompl_risk.ranking.agreement import Agreement as Agreement
from ompl_risk.ranking.assessment import Assessment as Assessment
from ompl_risk.ranking.attribution import Attribution as Attribution
from ompl_risk.ranking.compare import DEFAULT_NORMS as DEFAULT_NORMS
from ompl_risk.ranking.compare import rank as rank
from ompl_risk.ranking.result import Ranking as Ranking
