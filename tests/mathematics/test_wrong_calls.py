"""Calls that a new user gets wrong are answered by name, not by a traceback from inside."""

import numpy as np
import pytest

import ompl_risk as risk
from ompl_risk.errors import ArgumentError

FLAT = risk.terrains.Terrain(np.zeros((5, 5)), spacing=(50.0, 50.0))
GROUND = risk.TerrainClearance(FLAT)
F = risk.InverseDistance(30.0)
A = risk.Trajectory([0, 10], [[10, 10, 20], [190, 10, 20]], name="A")
B = risk.Trajectory([0, 10], [[10, 10, 20], [190, 10, 10]], name="B")


@pytest.mark.parametrize(
    ("call", "names"),
    [
        (lambda: risk.rank(A, GROUND, F), "trajectories ="),
        (lambda: risk.rank([A, B], F, GROUND), "avoidance ="),
        (lambda: risk.rank([A, B], GROUND, 100.0), "avoidance = 100.0"),
        (lambda: risk.rank([A, B], FLAT, F), "clearance ="),
        (lambda: risk.rank([A, B], GROUND, F, norms=risk.Lp(2)), "norms ="),
        (lambda: risk.rank([A, B], GROUND, F, probability=[1, 2]), "probability['A'] = 1"),
        (lambda: risk.rank([A, A], GROUND, F), "name="),
        (lambda: risk.collision_probability([A], FLAT), "trajectory = 'list'"),
        (lambda: risk.collision_probability(A, FLAT, estimator="fast"), "estimator = 'fast'"),
        (lambda: risk.BallSampling(1.5), "samples = 1.5"),
        (lambda: risk.UnionClearance(GROUND), "members ="),
        (lambda: risk.publish(None, [], None), "ranking = None"),
    ],
)
def test_wrong_calls_are_named(call, names):
    with pytest.raises(ArgumentError) as error:
        call()
    assert names in str(error.value)


def test_a_ranking_prints_as_tables_and_shows_as_one_line():
    ranking = risk.rank([A, B], GROUND, F)
    assert "least clearance" in str(ranking)
    assert repr(ranking).count("\n") == 0
    assert "H1: A B" in repr(ranking)


def test_norms_at_equal_steps_take_probabilities_too():
    profiles = [risk.collision_probability(t, FLAT, 25.0) for t in (A, B)]
    norms = (risk.Sobolev(1), risk.Sobolev(1, form="fourier"))
    ranking = risk.rank([A, B], GROUND, F, norms, probability=profiles)
    for assessment in ranking.assessments:
        plain, fourier = assessment.pc_norms.values()
        assert fourier == pytest.approx(plain, rel=1e-2)
