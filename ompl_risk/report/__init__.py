"""Figures of rankings, of flights and of the paper's Table I, and films of flights."""

from ompl_risk.report.animation import animate_flight as animate_flight
from ompl_risk.report.closed_loop import closed_loop_figure as closed_loop_figure
from ompl_risk.report.figure import ranking_figure as ranking_figure
from ompl_risk.report.flight_views import flight_views as flight_views
from ompl_risk.report.table1 import table1_figure as table1_figure
