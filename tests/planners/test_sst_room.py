"""SST with little room: a tree that is full, and radii that shrink."""

import pytest
from sst_scene import planned, setup_of, solution, walled

from ompl_risk.planners.sst import planner as planner_module
from ompl_risk.planners.sst import searching


def test_a_full_tree_makes_room(monkeypatch):
    monkeypatch.setattr(planner_module, "NODES", 200)
    setup, planner = planned(iterations=4000)
    assert solution(setup).check()
    assert planner.tree.count(4) <= 200
    assert len(planner.history) > 3


def test_without_a_path_a_full_tree_becomes_coarser(monkeypatch):
    monkeypatch.setattr(planner_module, "NODES", 200)
    _, planner = planned(setup_of(walled()), iterations=2000)
    assert planner.history == []
    assert planner.tree.count(4) <= 200
    assert planner.tree.pruning > 1.2 * 0.012 * 140.0


@pytest.mark.parametrize("shrink", [True, False])
def test_radii_shrink_unless_they_must_not(monkeypatch, shrink):
    monkeypatch.setattr(searching, "ROUND", 100)
    monkeypatch.setattr(searching, "TURNS", 0.1)
    _, planner = planned(shrink=shrink, pruning_radius=3.0, selection_radius=20.0)
    pruning, selection = planner.tree.pruning, planner.tree.arrays.radii[0]
    assert pruning < 1.0 if shrink else pruning == 3.0
    assert selection == pytest.approx(pruning * 20.0 / 3.0)
