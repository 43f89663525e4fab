"""The figure of closed-loop rollouts shows what the estimates hold."""

import numpy as np
import pytest

from ompl_risk import Trajectory, terrains
from ompl_risk.report.closed_loop import closed_loop_figure
from ompl_risk.simulation import CollisionEstimate


@pytest.fixture(scope="module")
def figure():
    ground = terrains.Terrain(np.zeros((21, 21)), spacing=(100.0, 100.0))
    paths = [
        Trajectory([0.0, 10.0], [[200.0, y, 50.0], [1800.0, y, 50.0]], name)
        for name, y in (("low", 500.0), ("high", 1500.0))
    ]
    least = np.array([0.0, 0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0])
    where = np.column_stack([np.linspace(300, 1700, 10), np.full(10, 500.0), np.zeros(10)])
    collided = np.where(least > 0.0, np.inf, 3.0)
    made = [
        CollisionEstimate("low", least, np.ones(10), where, collided),
        CollisionEstimate("high", least + 5.0, np.ones(10), where, np.full(10, np.inf)),
    ]
    return closed_loop_figure(paths, made, ground, title="Two paths")


def test_crosses_are_where_rollouts_collide(figure):
    crosses = [line for line in figure.axes[0].get_lines() if line.get_marker() == "X"]
    assert [len(line.get_xdata()) for line in crosses] == [2, 0]
    np.testing.assert_allclose(crosses[0].get_xdata(), [0.3, 0.3 + 1.4 / 9])


def test_distributions_begin_at_the_share_that_collides(figure):
    low, high = figure.axes[1].get_lines()
    at_zero = low.get_ydata()[low.get_xdata() <= 0.0].max()
    assert at_zero == pytest.approx(0.2, abs=0.0026)
    assert high.get_xdata().min() == 5.0


def test_legend_never_says_a_bare_zero(figure):
    texts = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert texts[0].startswith("low: 0.2 (")
    assert texts[1] == "high: none of 10, at most 0.31"
