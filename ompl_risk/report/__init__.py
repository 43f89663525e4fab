"""Figures of rankings and of the paper's Table I."""

from ompl_risk.report.figure import ranking_figure as ranking_figure
from ompl_risk.report.table1 import table1_figure as table1_figure
