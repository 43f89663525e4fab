"""RiskObjective inside OMPL's planners, judged from the paths alone."""

import gc
import math
import weakref

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from ompl_risk import (
    ClearanceMotionValidator,
    InverseDistance,
    Lp,
    MeshClearance,
    RiskObjective,
    Sobolev,
    TerrainClearance,
    Trajectory,
    rank,
)
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain

AVOIDANCE, SPEED = InverseDistance(60.0), 20.0


def risk(clearance, norm=None, **options):
    return lambda si: RiskObjective(si, clearance, AVOIDANCE, norm, speed=SPEED, **options)


def recomputed(path, clearance, norm):
    """The norm by way of a trajectory: nothing of the objective is used."""
    trajectory = Trajectory.from_path(path, speed=SPEED).densify(0.5)
    return norm(trajectory.t, AVOIDANCE(clearance(trajectory.positions)))


def solve(setup, condition):
    assert setup.solve(condition)
    return setup.getProblemDefinition().getSolutionPath()


@pytest.mark.parametrize(
    "planner", [og.RRTstar, og.InformedRRTstar, og.SORRTstar, og.BITstar], ids=lambda p: p.__name__
)
def test_the_risk_aware_path_is_safer_than_the_shortest(planner, make_setup, pass_clearance, after):
    ou.RNG.setSeed(1)
    norm = Sobolev(1)
    calls = 15_000 if planner is og.BITstar else 500
    safe = solve(make_setup(risk(pass_clearance, norm), planner), after(calls))
    short = solve(make_setup(ob.PathLengthOptimizationObjective), after(500))
    assert recomputed(safe, pass_clearance, norm) < 0.5 * recomputed(short, pass_clearance, norm)
    assert short.length() < safe.length()
    for path in (safe, short):
        dense = Trajectory.from_path(path, speed=SPEED).densify(0.5)
        assert pass_clearance(dense.positions).min() > 0.0


@pytest.mark.parametrize("norm", [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1, time_scale=0.5)])
def test_every_norm_is_optimised_and_its_cost_is_what_the_path_says(
    norm, make_setup, pass_clearance, after
):
    ou.RNG.setSeed(2)
    setup = make_setup(risk(pass_clearance, norm))
    path = solve(setup, after(300))
    objective = setup.getProblemDefinition().getOptimizationObjective()
    expected = recomputed(path, pass_clearance, norm)
    assert objective.norm(path) == pytest.approx(expected, rel=5e-3)
    cost = path.cost(objective).value()
    assert objective.risk.root(cost) == pytest.approx(expected, rel=2e-2)


def test_maximum_costs_combine_by_their_maximum(make_setup, pass_clearance):
    objective = risk(pass_clearance, Lp(math.inf))(make_setup().getSpaceInformation())
    assert isinstance(objective, RiskObjective)
    assert objective.combineCosts(ob.Cost(2.0), ob.Cost(3.0)).value() == 3.0


def test_a_subclass_with_a_maximum_combines_by_the_maximum_too(make_setup, pass_clearance):
    class Mine(RiskObjective):
        pass

    si = make_setup().getSpaceInformation()
    objective = Mine(si, pass_clearance, AVOIDANCE, Lp(math.inf), speed=SPEED)
    assert isinstance(objective, Mine)
    assert objective.combineCosts(ob.Cost(2.0), ob.Cost(3.0)).value() == 3.0
    plain = Mine(si, pass_clearance, AVOIDANCE, Lp(1), speed=SPEED)
    assert plain.combineCosts(ob.Cost(2.0), ob.Cost(3.0)).value() == 5.0


def test_norm_agrees_with_the_ranking(make_setup, pass_clearance, after):
    setup = make_setup(risk(pass_clearance))
    path = solve(setup, after(300))
    objective = setup.getProblemDefinition().getOptimizationObjective()
    trajectory = Trajectory.from_path(path, speed=SPEED, name="A")
    ranking = rank([trajectory], pass_clearance, AVOIDANCE, [Sobolev(1)])
    assert ranking.assessments[0].norms["H1"] == pytest.approx(objective.norm(path), rel=5e-3)


def test_a_motion_in_collision_costs_inf_even_without_a_motion_validator(
    make_setup, pass_clearance
):
    setup = make_setup()
    si = setup.getSpaceInformation()
    objective = risk(pass_clearance)(si)
    path = og.PathGeometric(si)
    for position in ([100.0, 200.0, 30.0], [900.0, 200.0, 30.0]):
        state = si.allocState()
        state[0:3] = position
        path.append(state)
    assert path.cost(objective).value() == math.inf
    assert objective.norm(path) == math.inf


def test_the_weight_of_time_shortens_the_path(make_setup, pass_clearance, after):
    lengths = []
    for weight in (0.0, 1.0):
        ou.RNG.setSeed(4)
        setup = make_setup(risk(pass_clearance, duration_weight=weight))
        lengths.append(solve(setup, after(500)).length())
    assert lengths[1] < lengths[0]
    assert lengths[1] < 1.03 * 800.0


def test_ties_without_risk_are_broken_by_time(make_setup, after):
    """Far above the ground no path has a risk; the tie-break still finds the straight one."""
    flat = TerrainClearance(Terrain(np.full((3, 3), -500.0), spacing=(500.0, 500.0)))
    lengths = {}
    for weight in (None, 0.0):
        ou.RNG.setSeed(5)
        setup = make_setup(risk(flat, duration_weight=weight), clearance=flat)
        path = solve(setup, after(700))
        assert setup.getProblemDefinition().getOptimizationObjective().norm(path) == 0.0
        lengths[weight] = path.length()
    assert lengths[None] == pytest.approx(800.0, rel=1e-2)
    assert lengths[0.0] > 1.05 * 800.0


def test_seeds_reproduce(make_setup, pass_clearance, after):
    lengths = []
    for seed in (7, 7, 8):
        ou.RNG.setSeed(seed)
        lengths.append(solve(make_setup(risk(pass_clearance)), after(200)).length())
    assert lengths[0] == lengths[1] != lengths[2]


def test_other_clearances_plan_too(make_setup, after):
    def wall(points):
        """Distance to a wall of 20 m thickness at x = 500, up to y = 700."""
        beside = np.maximum(np.abs(points[:, 0] - 500) - 10, 0)
        beyond = np.maximum(points[:, 1] - 700, 0)
        return np.hypot(beside, beyond)

    ou.RNG.setSeed(3)
    norm = Lp(2)
    path = solve(make_setup(risk(wall, norm), clearance=wall), after(60))
    objective = make_setup(risk(wall, norm), clearance=wall)
    assert recomputed(path, wall, norm) < math.inf
    assert objective.getOptimizationObjective().norm(path) == pytest.approx(
        recomputed(path, wall, norm), rel=5e-3
    )


def states_of(space, si, *positions):
    found = []
    for position in positions:
        state = si.allocState()
        first = state
        while not isinstance(first, ob.SE3State):
            first = first[0]
        first.setXYZ(*position)
        first.rotation().setIdentity()
        found.append(state)
    return found


@pytest.mark.parametrize("nested", [False, True])
def test_se3_and_compound_spaces(nested, pass_clearance):
    se3 = ob.SE3StateSpace()
    bounds = ob.RealVectorBounds(3)
    bounds.setLow(0.0)
    bounds.setHigh(1000.0)
    se3.setBounds(bounds)
    space = se3
    if nested:
        velocities = ob.RealVectorStateSpace(6)
        velocities.setBounds(-1.0, 1.0)
        space = ob.CompoundStateSpace()
        space.addSubspace(se3, 1.0)
        space.addSubspace(velocities, 0.1)
        space.lock()
    si = ob.SpaceInformation(space)
    objective = risk(pass_clearance, Sobolev(1))(si)
    validator = ClearanceMotionValidator(si, pass_clearance)
    a, b, c = states_of(space, si, (100, 800, 30), (900, 800, 30), (900, 200, 30))
    if nested:
        for state in (a, b, c):
            state[1][0:6] = [0.5] * 6
    assert validator.checkMotion(a, b)
    assert not validator.checkMotion(a, c)
    flat = ob.SpaceInformation(r3 := ob.RealVectorStateSpace(3))
    r3.setBounds(0.0, 1000.0)
    p, q = flat.allocState(), flat.allocState()
    p[0:3], q[0:3] = [100.0, 800.0, 30.0], [900.0, 800.0, 30.0]
    expected = risk(pass_clearance, Sobolev(1))(flat).motionCost(p, q).value()
    assert objective.motionCost(a, b).value() == expected > 0.0


def test_other_spaces_are_refused_by_name(pass_clearance):
    for space, name in ((ob.RealVectorStateSpace(2), "R^2"), (ob.SE2StateSpace(), "SE2")):
        with pytest.raises(ArgumentError, match="SE\\(3\\)") as error:
            risk(pass_clearance)(ob.SpaceInformation(space))
        assert name in str(error.value)


def test_spaces_whose_motions_are_curves_are_refused(pass_clearance):
    space = ob.OwenStateSpace(10.0, 0.5)
    with pytest.raises(ArgumentError, match="OwenStateSpace"):
        risk(pass_clearance)(ob.SpaceInformation(space))


def test_what_cannot_be_called_is_no_clearance(pass_clearance):
    with pytest.raises(ArgumentError, match="clearance ="):
        risk(pass_clearance.terrain)(ob.SpaceInformation(ob.RealVectorStateSpace(3)))


def test_a_mesh_body_needs_an_orientation():
    import trimesh

    space = ob.RealVectorStateSpace(3)
    posed = MeshClearance(trimesh.creation.box(), body=trimesh.creation.box())
    with pytest.raises(ArgumentError, match="orientation"):
        risk(posed)(ob.SpaceInformation(space))


def test_norm_refuses_what_is_no_path(make_setup, pass_clearance):
    objective = risk(pass_clearance)(make_setup().getSpaceInformation())
    with pytest.raises(ArgumentError, match="PathGeometric"):
        objective.norm([1, 2])
    with pytest.raises(ArgumentError, match="no states"):
        objective.norm(og.PathGeometric(make_setup().getSpaceInformation()))


def test_objective_keeps_no_cycle_alive(make_setup, pass_clearance, after):
    setup = make_setup(risk(pass_clearance))
    solve(setup, after(50))
    gone = weakref.ref(setup.getProblemDefinition().getOptimizationObjective())
    del setup
    gc.collect()
    assert gone() is None


def test_a_million_callbacks_leak_nothing(make_setup, pass_clearance):
    setup = make_setup()
    si = setup.getSpaceInformation()
    objective = risk(pass_clearance)(si)
    path = og.PathGeometric(si)
    for k in range(1001):
        state = si.allocState()
        state[0:3] = [100.0 + 0.1 * k, 800.0, 50.0]
        path.append(state)

    def resident():
        with open("/proc/self/statm") as file:  # noqa: PTH123
            return int(file.read().split()[1]) * 4096

    def work(rounds):
        for _ in range(rounds):
            path.cost(objective)  # 1000 motion costs
            path.check()  # 1000 motions and 1001 states checked

    work(20)
    before = resident()
    work(340)  # over a million callbacks
    assert resident() - before < 4e6
