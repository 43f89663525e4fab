"""SST and refinement with other avoidance functions than the paper's."""

from dataclasses import dataclass

import numpy as np
import pytest
from flown_paths import hills, walk
from sst_kernel_pieces import left_to_pay
from sst_scene import GOAL, START, growth, planned, ridge, setup_of

from ompl_risk.avoidance import FlatCap, GaussianTail
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.model import simulate
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.motion import Risk
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.improve import Outcome, refine, simplify
from ompl_risk.trajectory import Trajectory

DT, SPEED = 0.02, 12.0
FUNCTIONS = [FlatCap(40.0), GaussianTail(10.0)]
NORMS = [Lp(1), Lp(3), Sobolev(1, time_scale=3.0)]
functions = pytest.mark.parametrize("f", FUNCTIONS, ids=repr)
norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)


# SST


@functions
def test_the_cost_of_sst_s_path_is_its_risk_by_this_function(f):
    norm = Sobolev(1, time_scale=2.0)
    setup, planner = planned(setup_of(risk=True, norm=norm, avoidance=f))
    path = setup.getProblemDefinition().getSolutionPath()
    rows = []
    for control, duration in zip(path.getControls(), path.getControlDurations(), strict=True):
        rows += [[control[k] for k in range(4)]] * round(duration / DT)
    states = simulate(Helicopter(), START, np.array(rows), dt=DT)
    d = TerrainClearance(ridge(), 1.0)(states[:, :3])
    risk = norm.power(DT * np.arange(len(d)), f(d))
    weight = 1e-9 * float(f(20.0)) ** 2
    assert risk > 1e-4
    assert planner.history[-1].cost == pytest.approx(risk + weight * path.length(), rel=1e-9)
    assert planner.tree.cost == pytest.approx(planner.history[-1].cost, rel=1e-9)


@functions
@pytest.mark.parametrize("p", [1.0, 2.0, 3.0])
def test_sst_s_bound_is_the_way_straight_away_from_the_goal_at_top_speed(f, p):
    problem = growth(setup_of(risk=True, norm=Lp(p), avoidance=f)).problem
    state, out = np.zeros((1, 13)), np.empty(1)
    state[0, :3], state[0, 6] = START, 1.0
    left_to_pay(problem.vehicle, state, np.array([30.0]), out)
    nearest = float(problem.clearance(np.array([GOAL]))[0]) + 5.0  # anywhere in the goal
    s = np.linspace(0.0, f.d0 - nearest, 2001)
    exact = np.trapezoid(f(nearest + s) ** p, s / 35.0)
    assert 0.8 * exact < out[0] <= 1.001 * exact


def test_sst_refuses_what_compiled_code_does_not_know():
    @dataclass(frozen=True)
    class Derived(FlatCap):
        """Might compute anything."""

    with pytest.raises(ArgumentError, match="Derived"):
        planned(setup_of(risk=True, avoidance=Derived(40.0)), iterations=10)


# refinement


@functions
@norms
def test_refinement_lowers_the_norm_of_this_function(f, norm):
    clearance, improved = TerrainClearance(hills(2), radius=1.0, threads=1), 0
    for seed in (0, 2):
        path, risk = walk(clearance, seed, 5), Risk(f, norm, speed=SPEED)
        box = {"low": path.min(axis=0) - 10.0, "high": path.max(axis=0) + np.array([10.0, 10, 0])}
        result = refine(path, clearance=clearance, risk=risk, seconds=60.0, **box)
        old, new = (norm_along(clearance, p, f, norm) for p in (path, result.positions))
        slight = 1e-4 * f.typical
        assert result.before.norm == pytest.approx(old, rel=3e-3, abs=slight)
        assert result.after.norm == pytest.approx(new, rel=3e-3, abs=slight)
        assert new <= old * (1 + 1e-12)
        assert result.after.duration <= result.before.duration * (1 + 1e-12)
        improved += result.outcome is Outcome.IMPROVED and new < 0.8 * old
    assert improved >= 1


@functions
def test_simplification_never_raises_the_norm(f):
    clearance = TerrainClearance(hills(4), radius=1.0, threads=1)
    path, risk = walk(clearance, 3, 8), Risk(f, Sobolev(1), speed=SPEED)
    result = simplify(path, clearance=clearance, risk=risk)
    old, new = (norm_along(clearance, p, f, Sobolev(1)) for p in (path, result.positions))
    assert new <= old
    assert result.compiled


def norm_along(clearance, path, f, norm):
    """From samples 5 cm apart."""
    fine = Trajectory.at_constant_speed(path, SPEED).densify(0.05)
    return norm(fine.t, f(clearance(fine.positions)))
