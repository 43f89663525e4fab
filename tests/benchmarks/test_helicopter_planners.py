"""The benchmark of OMPL's control planners in a tiny configuration. Times are not judged."""

import pytest

from benchmarks import helicopter_planners
from benchmarks.helicopter_problems import PROBLEMS
from ompl_risk import TerrainClearance


def test_every_planner_is_run_on_every_problem():
    config = helicopter_planners.Config(steps=1000, repeats=1, counted=0.02, runs=1, seconds=0.02)
    metrics = {m.name: m for m in helicopter_planners.measure(config, 0, lambda _: None)}
    assert not [m.name for m in metrics.values() if m.failed]
    for problem in PROBLEMS:
        for planner in helicopter_planners.PLANNERS:
            assert metrics[f"{problem}, {planner}: solved"].value.median in (0.0, 100.0)
    assert metrics["propagations inside EST"].value.median > 0.0


def test_a_path_is_flown_again():
    run = helicopter_planners.solve("forward flight round a pillar", "KPIECE1", 3, 20.0)
    assert run.solved
    assert run.mismatch == 0.0
    assert 0.0 < run.seconds < 20.0


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_straight_way_is_blocked(problem):
    """Else there would be nothing to plan."""
    setup = PROBLEMS[problem]()
    checker = setup.getStateValidityChecker()
    middle = setup.getGoal().state[:3].copy()
    middle[0] = {"hover to hover over a ridge": 50.0, "forward flight round a pillar": 60.0}[
        problem
    ]
    assert isinstance(checker.obstacles, TerrainClearance)
    assert checker.obstacles([middle])[0] < 0.0
