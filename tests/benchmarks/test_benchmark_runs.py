"""Each benchmark in a tiny configuration: its figures of correctness hold. Times are not judged."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import (
    anytime,
    clearance,
    convergence,
    large_terrain,
    objective,
    planning,
    probability,
    ranking,
    roadmap,
)
from benchmarks.metric import Metric, Target


def run(module, config) -> dict[str, Metric]:
    steps = []
    metrics = list(module.measure(config, 0, steps.append))
    assert steps
    assert len({metric.name for metric in metrics}) == len(metrics)
    checks = [m for m in metrics if m.target is not None and m.target.correctness]
    assert checks
    assert [m.name for m in metrics if m.failed] == []
    return {metric.name: metric for metric in metrics}


def peers(metric: Metric) -> float:
    assert metric.peer is not None
    return metric.peer.value.median


def test_clearance(terrain_file):
    metrics = run(
        clearance,
        clearance.Config(
            terrain=terrain_file, points=200, fcl_points=50, oracle_points=3, single_points=20,
            repeats=2,
        ),
    )  # fmt: skip
    exact = metrics["exact distance, one thread"]
    assert exact.target == Target(50.0, of="advantage")
    assert peers(exact) > 0.0


def test_large_terrain():
    config = large_terrain.Config(
        posts=300, roughness=((0.8, 1.3), (1.0, 0.3)), high=60.0, low=5.0, bound=30.0, points=100,
        peer_points=40, oracle_points=2, repeats=2, builds=1,
    )  # fmt: skip
    metrics = run(large_terrain, config)
    assert len(metrics) == 20
    memory = metrics["H 0.8, slope 1.3: extra memory"]
    assert 0.0 < memory.value.median <= 1.5  # of no machine, so it can be judged here
    assert memory.met


def test_objective(problem):
    config = objective.Config(
        problem, seconds=0.5, seeds=1, motions=10, longest=500.0, repeats=1, in_processes=False
    )
    metrics = run(objective, config)
    assert metrics["motion costs in RRT*"].value.median > 0.0
    assert peers(metrics["motion costs in RRT*"]) > 0.0
    assert metrics["least clearance of our paths"].value.median > 0.0
    assert peers(metrics["rms relative error of a cost"]) < 0.1


def test_planners_run_in_processes_of_their_own(problem):
    config = objective.Config(problem, seconds=0.1)
    plan = objective._run("ours", config, 0)
    assert plan.motion_costs > 0
    assert plan.seconds > 0.0


def test_a_seed_reproduces_the_problem(problem):
    terrain = planning.terrains.load(problem.terrain)
    ends = problem.ends(terrain)
    assert ends[:, 2] - terrain.height(*ends[:, :2].T) == pytest.approx(problem.above_ground)
    low, high = problem.box(terrain).T
    assert np.all(low <= ends)
    assert np.all(ends <= high)
    assert high[2] == pytest.approx(ends[:, 2].max() + problem.headroom)


@pytest.mark.parametrize("grown", [0.0, 0.02])
def test_probability(terrain_file, monkeypatch, grown):
    """A quadrature that is wrong by 2 % of the ball is noticed."""
    config = probability.Config(
        terrain=terrain_file, states=40, few=128, many=1000, columns=20_000, repeats=1
    )
    original = probability.ColumnQuadrature.estimate

    def shifted(self, *arguments):
        estimate = original(self, *arguments)
        return estimate._replace(p=estimate.p + grown)

    monkeypatch.setattr(probability.ColumnQuadrature, "estimate", shifted)
    if grown == 0.0:
        metrics = run(probability, config)
        assert metrics["columns against sampling, 128: speed"].better == "higher"
    else:
        failed = [m.name for m in probability.measure(config, 0, lambda _: None) if m.failed]
        assert failed
        assert all(name.startswith("columns against") and "rms error" in name for name in failed)


def test_a_wrong_distance_is_noticed(terrain_file, monkeypatch):
    config = replace(
        clearance.QUICK, terrain=terrain_file, points=50, fcl_points=20, single_points=5, repeats=1
    )
    original = clearance.TerrainClearance.__call__

    def wrong(self, points, **options):
        return original(self, points, **options) + 2e-9

    monkeypatch.setattr(clearance.TerrainClearance, "__call__", wrong)
    failed = [m.name for m in clearance.measure(config, 0, lambda _: None) if m.failed]
    assert failed == ["error against all triangles"]


def test_ranking(terrain_file):
    metrics = run(
        ranking,
        ranking.Config(
            terrain=terrain_file, trajectories=3, states=60, start=(500.0, 600.0),
            goal=(2300.0, 2200.0), shared=2, repeats=1,
        ),
    )  # fmt: skip
    assert metrics["norms of f and P_c, relative error"].value.median <= 1e-12
    assert peers(metrics["one trajectory, states as given"]) > 0.0


def test_a_wrong_norm_is_noticed(terrain_file, monkeypatch):
    config = ranking.Config(
        terrain=terrain_file, trajectories=2, states=60, start=(500.0, 600.0),
        goal=(2300.0, 2200.0), shared=1, repeats=1,
    )  # fmt: skip
    original = ranking.four_norms

    def wrong(t, g):
        return [*original(t, g)[:3], original(t, g)[3] * (1.0 + 1e-8)]

    monkeypatch.setattr(ranking, "four_norms", wrong)
    failed = [m.name for m in ranking.measure(config, 0, lambda _: None) if m.failed]
    assert failed == ["norms of f and P_c, relative error"]


def test_anytime(problem):
    config = anytime.Config(problem, seconds=1.0, ours=0.5, short=0.2, seeds=1, in_processes=False)
    metrics = run(anytime, config)
    for name in ("RRTstar", "BITstar"):
        when = metrics[f"time to the cost that {name} has after 1 s"]
        assert 0.0 < peers(when) <= 1.1
    assert np.isfinite(metrics["cost after 0.5 s, RRTstar's after 1 s"].value.median)
    assert metrics["least clearance of our paths"].value.median > 0.0


def test_what_a_run_reached_and_when():
    rows = np.array([[0.1, 8.0], [0.5, 5.0], [2.0, 1.0]])
    reached = convergence.Run(rows, np.zeros((2, 3)))
    assert [reached.seconds_to(c) for c in (9.0, 8.0, 6.0, 5.0, 1.0)] == [0.1, 0.1, 0.5, 0.5, 2.0]
    assert reached.seconds_to(0.9) == np.inf
    assert reached.cost == 1.0
    nothing = convergence.Run(np.empty((0, 2)), np.empty((0, 3)))
    assert (nothing.cost, nothing.seconds_to(1e9)) == (np.inf, np.inf)


def test_roadmap(problem):
    config = roadmap.Config(
        problem, vertices=300, sizes=(300, 600), complete_sizes=(300, 600), alternatives=3,
        apart=50.0, repeats=1,
    )  # fmt: skip
    metrics = {m.name: m for m in roadmap.measure(config, 0, lambda _: None)}
    lazy = metrics["300 vertices, edges as a search needs them: evaluated"].value.median
    complete = metrics["300 vertices, every edge: evaluated"].value.median
    assert 0 < lazy < 0.5 * complete
    assert complete > 300 * 5
    assert 1 <= metrics["alternatives found"].value.median <= 3
    # 16 bytes for each of some ten edges a vertex at the very least
    assert metrics["memory of 600 vertices"].value.median > 160.0
    assert {m.name for m in metrics.values() if m.failed} == set()
