"""Criteria: their names, and that they mean the same inside and outside of OMPL."""

import math

import numpy as np
import pytest
from ompl import base as ob

from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Sobolev, parse_norm
from ompl_risk.norms.naming import norm_name
from ompl_risk.planners import Length, WeightedRisk, parse_criterion

NAMES = {
    "L1": Lp(1),
    "L2": Lp(2),
    "L2.5": Lp(2.5),
    "Linf": Lp(math.inf),
    "H1": Sobolev(1),
    "H2": Sobolev(2),
    "H1(0.5)": Sobolev(1, time_scale=0.5),
}


@pytest.mark.parametrize(("name", "norm"), NAMES.items())
def test_names_of_norms_go_both_ways(name, norm):
    assert parse_norm(name) == norm
    assert parse_norm(name.lower()) == norm
    assert norm_name(norm) == name


@pytest.mark.parametrize("name", ["", "L", "L0.5", "L-1", "H", "H1(0)", "H1(", "2", "Lq", "H1.5"])
def test_other_names_of_norms_are_refused(name):
    with pytest.raises(ArgumentError, match=r"norms = .*must be"):
        parse_norm(name, argument="norms")


@pytest.mark.parametrize("name", ["length", "L1@10", "L4@12.5", "H1@25", "H1(0.5)@25"])
def test_names_of_criteria_go_both_ways(name):
    assert parse_criterion(name).name == name
    assert isinstance(parse_criterion(name), Length if name == "length" else WeightedRisk)


@pytest.mark.parametrize("name", ["", "H1", "H1@", "H1@x", "H1@0", "H1@-3", "H2@9", "Linf@9", "@9"])
def test_other_names_of_criteria_are_refused(name):
    with pytest.raises(ArgumentError, match=r"searches = .*must be"):
        parse_criterion(name, argument="searches")


@pytest.mark.parametrize("name", ["L1@20", "L4@20", "H1@20"])
def test_a_second_costs_as_much_as_one_at_the_clearance_named(name, problem):
    """Level flight at clearance d costs f(d)^p a second for the risk, and f(20 m)^p for time."""
    criterion = parse_criterion(name)
    risk = criterion.risk(problem)
    assert risk.weight == pytest.approx(float(problem.avoidance(20.0)) ** risk.exponent, rel=1e-15)


def test_a_clearance_from_d0_on_would_give_time_no_weight(problem):
    with pytest.raises(ArgumentError, match=r"H1@80.*below d0 = 80 m"):
        parse_criterion("H1@80").risk(problem)


@pytest.mark.parametrize("name", ["length", "L2@20", "H1@20"])
def test_the_objective_counts_as_the_motion_costs_outside_do(name, problem):
    from ompl_risk.planners.solving import motion_cost

    space = ob.RealVectorStateSpace(3)
    space.setBounds(-1e4, 1e4)
    si = ob.SpaceInformation(space)
    criterion = parse_criterion(name)
    objective = criterion.objective(si, problem)
    cost = motion_cost(problem, criterion.risk(problem))
    a, b = si.allocState(), si.allocState()
    rng = np.random.default_rng(5)
    for _ in range(20):
        p, q = rng.uniform((100, 100, 120), (1200, 1900, 180), (2, 3))
        a[0:3], b[0:3] = p.tolist(), q.tolist()
        assert cost(p, q) == pytest.approx(objective.motionCost(a, b).value(), rel=1e-12)
