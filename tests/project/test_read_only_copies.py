"""Arrays that are read-only stay so in copies, pickled objects and those of worker processes."""

import copy
import inspect
import pickle
import pkgutil
import re
from functools import cache, cached_property
from importlib import import_module

import numpy as np
import pytest

import ompl_risk as risk
from ompl_risk import helicopter, motion, planners, probability, simulation
from ompl_risk._kernels import rigid_body
from ompl_risk._kernels.air import COMPLETED
from ompl_risk.planners.roadmap.graph import Way
from ompl_risk.ranking.agreement import agreement

FLAT = risk.terrains.Terrain(np.zeros((3, 3)), spacing=(500.0, 500.0))
X = [[100.0, 100.0, 50.0], [400.0, 100.0, 60.0], [400.0, 600.0, 50.0]]
LEVEL = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))
PATH = risk.Trajectory([0.0, 10.0, 30.0], X, orientations=LEVEL, velocities=X, controls=X[1:])


def height(points):
    return np.asarray(points)[:, 2]


@cache
def steering():
    return helicopter.HelicopterSteering()


@cache
def primitive_path():
    a = steering().vertex_at((0.0, 0.0, 100.0), 0.0, speed=20.0)
    b = steering().vertex_at((400.0, 100.0, 120.0), 1.0, speed=20.0)
    return steering().connect(a, b)


@cache
def flight():
    ends = [((0.0, 0.0, 100.0), 0.0), ((400.0, 100.0, 120.0), 1.0)]
    return steering().flight(np.stack([steering().vertex_at(*end, speed=20.0) for end in ends]))


@cache
def assessment():
    return risk.rank([PATH], risk.TerrainClearance(FLAT), risk.InverseDistance(80.0))[PATH.name]


def agreed():
    return agreement({"A": [1.0, 2.0]}, {"B": [2.0, 1.0]})


def estimate():
    n = np.zeros(3)
    endings = np.full(3, COMPLETED, np.int8)
    return simulation.CollisionEstimate(
        "A", n, n, np.zeros((3, 3)), n + np.inf, weights=n + 1.0, endings=endings
    )


def pareto():
    one = np.arange(2, dtype=np.int32)
    return planners.ParetoSet((Way(one, one[:1], 1.0, 5.0), Way(one, one[:1], 2.0, 4.0)))


def problem():
    return planners.Problem(height, X[0], X[2], [0, 0, 0], [900, 900, 90], speed=9.0)


MAKERS = {
    helicopter.Envelope: lambda: helicopter.Envelope([0, 0, 0], [1, 1, 1]),
    helicopter.Flight: flight,
    helicopter.Helicopter: helicopter.Helicopter,
    helicopter.HelicopterSteering: steering,
    helicopter.Manoeuvre: lambda: steering().library.manoeuvres[0],
    helicopter.PrimitiveLibrary: lambda: steering().library,
    helicopter.PrimitivePath: primitive_path,
    helicopter.Trim: lambda: steering().library.trims[0],
    motion.Connection: lambda: motion.Connection(2.0, X),
    planners.Improvement: lambda: planners.simplify(
        X, clearance=risk.TerrainClearance(FLAT), risk=motion.Risk(speed=9.0)
    ),
    planners.Network: lambda: planners.Network(X, [[0, 1]]),
    planners.ParetoSet: pareto,
    planners.Problem: problem,
    planners.Sides: lambda: planners.Sides([[1.0, 2.0], [3.0, 1.0]]),
    planners.TimedRoute: lambda: planners.TimedRoute(np.array(X), np.arange(3.0)),
    probability.CollisionProfile: lambda: risk.collision_probability(PATH, FLAT, 60.0),
    probability.Crossings: lambda: risk.CrossingRate(9.0, correlation_time=5.0).along(
        [0, 1], [9, 9]
    ),
    risk.MovingBox: lambda: risk.MovingBox([1, 2, 3], [0.0, 1.0], X[:2]),
    risk.MovingSphere: lambda: risk.MovingSphere(1.0, [0.0, 1.0], X[:2]),
    risk.Trajectory: lambda: PATH,
    risk.ranking.Agreement: agreed,
    risk.ranking.Assessment: assessment,
    risk.ranking.Attribution: lambda: assessment().attribution["L2"],
    simulation.CollisionEstimate: estimate,
    simulation.HelicopterPlan: lambda: simulation.HelicopterPlan(flight()),
    simulation.PointPlan: lambda: simulation.PointPlan(PATH),
    simulation.TerrainError: lambda: simulation.TerrainError(3.0, 200.0),
    risk.terrains.Terrain: lambda: FLAT,
}

WRITABLE = {
    motion.MotionModel: "buffers that motions are written into",
    motion.SampledMotion: "likewise",
    motion.TerrainMotion: "likewise",
    planners.Candidate: "a path as its planner gave it",
    planners.Graph: "columns as they were given",
    planners.Route: "corners as they were sampled",
    planners.Way: "numbers of vertices and edges",
}
BASES = {risk.clearance.MovingObstacle, simulation.Plan}
FILE_BASED = {risk.MovingMesh: "its tracks are those of the other moving obstacles"}

COPIES = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda one: pickle.loads(pickle.dumps(one)),
    "pickle 5": lambda one: pickle.loads(pickle.dumps(one, protocol=5)),  # as joblib and Dask
}


def cached(kind):
    """Names of the properties of a class that are computed once."""
    members = (vars(base).items() for base in kind.__mro__)
    return {name for some in members for name, one in some if isinstance(one, cached_property)}


def arrays(one, at=""):
    """Every array that an object holds, itself or in parts of it that are this library's."""
    if isinstance(one, np.ndarray):
        yield at, one
    elif isinstance(one, dict):
        for key, value in one.items():
            yield from arrays(value, f"{at}[{key}]")
    elif isinstance(one, tuple | list):
        for k, value in enumerate(one):
            yield from arrays(value, f"{at}[{k}]")
    elif type(one).__module__.startswith("ompl_risk.") and hasattr(one, "__dict__"):
        for name, value in vars(one).items():
            yield from arrays(value, f"{at}.{name}")


@pytest.mark.parametrize("kind", MAKERS, ids=lambda kind: kind.__name__)
def test_read_only_arrays_stay_read_only(kind):
    one = MAKERS[kind]()
    assert type(one) is kind
    for name in cached(kind):
        getattr(one, name)
    before = dict(arrays(one))
    own = [array for at, array in before.items() if at in {f".{name}" for name in vars(one)}]
    assert not any(array.flags.writeable for array in own)
    assert not all(array.flags.writeable for array in before.values())
    for how, copied in COPIES.items():
        other = copied(one)
        for name in cached(kind):
            getattr(other, name)
        after = dict(arrays(other))
        assert after.keys() == before.keys()
        for at, array in after.items():
            np.testing.assert_array_equal(array, before[at], err_msg=at)
            assert array.flags.writeable == before[at].flags.writeable, f"{how} {at}"


def public():
    """Classes that the packages of this library offer."""
    packages = [risk] + [
        import_module(f"ompl_risk.{module.name}")
        for module in pkgutil.iter_modules(risk.__path__)
        if module.ispkg and not module.name.startswith("_")
    ]
    found = {one for package in packages for one in vars(package).values() if inspect.isclass(one)}
    return {one for one in found if one.__module__.startswith("ompl_risk.")}


def holds_arrays(kind):
    fields = {
        k: v for base in kind.__mro__ for k, v in vars(base).get("__annotations__", {}).items()
    }
    fields |= {
        k: inspect.getattr_static(kind, k).func.__annotations__["return"] for k in cached(kind)
    }
    return any(re.search("Array|Integers|Tracks", str(one)) for one in fields.values())


def test_no_class_that_holds_arrays_is_left_out():
    known = {*MAKERS, *WRITABLE, *BASES, *FILE_BASED}
    assert {kind for kind in public() if holds_arrays(kind)} <= known


@pytest.mark.parametrize("how", COPIES)
def test_kernels_are_not_compiled_anew(how):
    if not hasattr(rigid_body.rollout, "signatures"):
        pytest.skip("nothing is compiled")
    machine = helicopter.Helicopter(9.0)
    flight().replay(machine)
    compiled = list(rigid_body.rollout.signatures)
    flight().replay(COPIES[how](machine))
    assert rigid_body.rollout.signatures == compiled


def test_a_copy_of_a_subclass_is_one():
    class Named(risk.Trajectory):
        pass

    named = Named([0.0, 1.0], X[:2], "A")
    assert type(copy.deepcopy(named)) is Named
    assert copy.copy(named).name == "A"


class Slotted(risk.Trajectory):
    """Has a place for an array outside its dictionary."""

    __slots__ = ("marks",)


@pytest.mark.parametrize("how", COPIES)
def test_slots_of_a_subclass_are_copied_too(how):
    slotted = Slotted([0.0, 1.0], X[:2], "A")
    object.__setattr__(slotted, "marks", np.ones(2))
    other = COPIES[how](slotted)
    assert other.name == "A"
    assert other.marks.tolist() == [1.0, 1.0]
    assert not other.marks.flags.writeable
    assert not other.positions.flags.writeable
