"""The campaign's figures: convergence, objectives by metrics, Pareto fronts."""

from benchmarks.campaign.figures.convergence import convergence_figure as convergence_figure
from benchmarks.campaign.figures.matrix import matrix_figure as matrix_figure
from benchmarks.campaign.figures.pareto import pareto_figure as pareto_figure
