"""Units are drawn, flown and sampled as it is written down."""

import json
import math

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.evidence import grounds, procedure, schema, unit
from benchmarks.evidence.grounds import KINDS, parameters
from benchmarks.evidence.procedure import LEVELS, pair, place
from benchmarks.evidence.profiles import curvature, profile, rounded
from benchmarks.evidence.settings import Settings
from benchmarks.evidence.unit import draw_seed, evaluate, failed
from ompl_risk import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan
from ompl_risk.simulation.loop.rollouts import fly
from ompl_risk.terrains import Terrain

UNIT = 3
SMALL = Settings(0, 12, 1000)
"""Of a real unit that takes a second."""


def rows_of(done):
    return schema.read(pa.BufferReader(done.content)).to_pylist()


def test_units_take_turns_among_kinds_and_share_no_parametric_terrain():
    places = [place(number) for number in range(100)]
    for first in range(0, 100, 5):
        assert {p.terrain for p in places[first : first + 5]} == set(KINDS)
    parametric = [p for p in places if p.terrain != "jacksboro"]
    assert len(set(parametric)) == len(parametric) == 80
    assert {p.terrain for p in places if p.split == "train"} == {"hills", "ridge_valley"}
    assert {p.terrain for p in places if p.split == "test"} == {"jacksboro", "canyon", "fractal"}
    assert {p.terrain_seed for p in places if p.split == "train"} == set(range(20))
    assert min(p.terrain_seed for p in places if p.split == "test") == 1000
    assert {p.terrain_seed for p in places if p.terrain == "jacksboro"} == {1000}


@pytest.mark.parametrize("name", list(KINDS))
@given(seed=st.integers(0, 5000))
def test_parameters_are_drawn_within_their_ranges(name, seed):
    found = parameters(name, seed)
    assert parameters(name, seed) == found
    for key, (low, high) in KINDS[name].ranges.items():
        parameter, _, other = key.partition(" / ")
        assert low <= found[parameter] / found.get(other, 1.0) * (1.0 + 1e-12)
        assert found[parameter] / found.get(other, 1.0) <= high * (1.0 + 1e-12)
    assert ("seed" in found) == bool(KINDS[name].ranges)


def test_terrains_differ_by_seed_and_only_so():
    one, same, other = (grounds.terrain("canyon", seed) for seed in (1000, 1000, 1001))
    assert np.array_equal(one.heights, same.heights)
    assert not np.array_equal(one.heights, other.heights)


@pytest.mark.parametrize("number", range(10))
def test_pairs_are_as_written(number):
    ends = pair(5, number)
    assert pair(5, number) == ends
    terrain = procedure.ground(*place(number)[1:]).terrain
    xmin, xmax, ymin, ymax = terrain.extent
    for x, y, z in (ends.start, ends.goal):
        assert xmin + 1000.0 <= x <= xmax - 1000.0
        assert ymin + 1000.0 <= y <= ymax - 1000.0
        assert z - terrain.height(x, y) == pytest.approx(50.0, abs=1e-9)
    distance = math.dist(ends.start[:2], ends.goal[:2])
    assert 1200.0 <= distance <= 2500.0
    assert 20.0 <= ends.ceiling - max(ends.start[2], ends.goal[2]) <= 100.0
    assert 3.0 <= ends.least <= 20.0
    # Heights of all posts of the box, one after the other.
    beyond = 0.25 * math.dist(ends.start, ends.goal)
    near, count = 0, 0
    for j, row in enumerate(terrain.heights):
        y = terrain.origin[1] + j * terrain.spacing[1]
        if not min(ends.start[1], ends.goal[1]) <= y + beyond:
            continue
        if not y - beyond <= max(ends.start[1], ends.goal[1]):
            continue
        x = terrain.origin[0] + np.arange(len(row)) * terrain.spacing[0]
        low, high = min(ends.start[0], ends.goal[0]), max(ends.start[0], ends.goal[0])
        inside = row[(x >= low - beyond) & (x <= high + beyond)]
        near, count = near + int((inside > ends.ceiling - 40.0).sum()), count + len(inside)
    assert 0.2 <= near / count <= 0.6
    share = procedure._high_ground(terrain, procedure.problem(number, ends))
    assert share == pytest.approx(near / count, abs=1e-12)


def test_pairs_differ_by_seed_and_number():
    starts = {pair(seed, number).start for seed in (0, 1) for number in (1, 6, 11)}
    assert len(starts) == 6


def test_a_terrain_without_room_is_told(monkeypatch):
    monkeypatch.setattr(procedure, "DRAWS", 50)
    monkeypatch.setattr(procedure, "FEWEST", 1.1)
    with pytest.raises(RuntimeError, match="no start and goal found in 50 draws"):
        pair(0, 0)


def test_problems_heed_nothing_but_time():
    ends = pair(0, UNIT)
    task = procedure.problem(UNIT, ends)
    assert task.min_clearance == ends.least
    assert task.high[2] == ends.ceiling
    assert (task.avoidance(np.array([0.003, 1.0, 50.0])) == 0.0).all()


@pytest.fixture(scope="module")
def done():
    return evaluate(SMALL, UNIT)


def test_a_complete_unit_has_five_rows(done):
    assert (done.status, done.reason) == ("complete", "")
    rows = rows_of(done)
    ends = pair(0, UNIT)
    assert [row["flight"] for row in rows] == [0, 1, 2, 3, 4]
    for row in rows:
        assert (row["unit"], row["split"], row["terrain"]) == (UNIT, "test", "canyon")
        assert (row["start"], row["goal"]) == (list(ends.start), list(ends.goal))
        assert rows[0]["duration"] <= row["duration"] <= 1.05 * rows[0]["duration"] + 0.02
        samples = math.ceil(row["duration"] / 0.2 - 1e-9) + 1
        for name in ("d", "up", "curvature", "speed", "pc"):
            assert len(row[name]) == samples
        assert min(row["d"]) > ends.least - 0.5
        assert row["d"][0] == pytest.approx(rows[0]["d"][0])  # all begin at the same place
        assert np.mean(row["speed"]) * row["duration"] == pytest.approx(row["length"], rel=0.02)
        assert row["length"] >= math.dist(ends.start, ends.goal)
        assert 0.0 <= min(row["pc"]) <= max(row["pc"]) < 1.0
        assert 0.0 < max(row["up"]) <= 1.0


def test_hits_are_those_of_the_bits_and_of_the_clearances(done):
    for row in rows_of(done):
        for level in LEVELS:
            assert row[f"{level}_rollouts"] == 12
            bits = np.unpackbits(np.frombuffer(row[f"{level}_bits"], np.uint8))
            assert len(bits) == 16
            assert bits.sum() == bits[:12].sum() == row[f"{level}_hits"]
            least = row[f"{level}_least"]
            assert len(least) == 5
            assert least == sorted(least)
            assert (row[f"{level}_hits"] >= 1) == (least[0] <= 0.0)  # 5 % of 12 is the first


def test_the_bits_are_of_rollouts_flown_alone_with_the_units_draws(done):
    flights = procedure.flights(UNIT, pair(0, UNIT), places=1000)
    clearance = procedure.ground(*place(UNIT)[1:])
    rows, hits = rows_of(done), 0
    disturbances = Disturbances.level("severe")
    draws = Draws.make(12, draw_seed(SMALL, UNIT), disturbances)
    for flight in (0, 4):
        outcomes = fly(HelicopterPlan(flights[flight]), clearance, disturbances, draws, threads=1)
        assert np.packbits(outcomes.hits).tobytes() == rows[flight]["severe_bits"]
        hits += outcomes.hits.sum()
    assert hits > 0


def test_a_unit_depends_on_nothing_but_its_number(done):
    evaluate(SMALL, UNIT + 5)
    assert rows_of(evaluate(SMALL, UNIT)) == rows_of(done)


def test_draws_differ_between_units_and_seeds():
    seeds = [draw_seed(Settings(seed), number) for seed in range(9) for number in range(9)]
    assert len(set(seeds)) == 81
    assert 0 <= min(seeds) <= max(seeds) < 2**63


def test_the_file_says_how_it_was_made(done):
    facts = schema.facts_of(schema.read(pa.BufferReader(done.content)).schema)
    assert facts["procedure"] == json.loads(json.dumps(SMALL.fingerprint))
    assert facts["unit"] == UNIT
    assert facts["seconds"] > 0.0
    assert {"python", "numpy", "numba", "ompl-risk"} <= set(facts["versions"])


def test_a_unit_of_too_few_flights_says_so():
    done = evaluate(Settings(0, 12, 1), UNIT)
    (row,) = rows_of(done)
    assert (done.status, row["status"]) == ("few", "few")
    assert row["reason"] == done.reason == "0 flights"
    assert row["start"] == list(pair(0, UNIT).start)
    assert row["flight"] is None
    assert row["severe_hits"] is None


@pytest.mark.parametrize("name", ["pair", "flights"])
def test_what_goes_wrong_is_a_result_too(name, monkeypatch):
    def refused(*_, **__):
        raise RuntimeError("no wind")

    monkeypatch.setattr(procedure, name, refused)
    done = evaluate(SMALL, UNIT)
    (row,) = rows_of(done)
    assert (done.status, done.reason) == ("failed", "RuntimeError: no wind")
    assert (row["unit"], row["split"], row["terrain"]) == (UNIT, "test", "canyon")
    assert (row["start"] is not None) == (name == "flights")
    assert failed(SMALL, UNIT, "gone").status == unit.FAILED


def flown(points, velocity):
    """A flight through points 0.2 s apart."""
    states = np.zeros((len(points), 13))
    states[:, :3], states[:, 6], states[:, 7:10] = points, 1.0, velocity
    return Flight(0.2, states, np.zeros((len(points) - 1, 4)), states)


def test_the_profile_over_a_slope_is_known():
    """h = 0.75 x: the distance is 0.8 of the height, and so is its upward gradient."""
    x = np.arange(60) * 20.0
    clearance = TerrainClearance(Terrain(np.tile(0.75 * x, (60, 1)), spacing=(20.0, 20.0)), 5.0)
    places = np.column_stack([np.full(5, 600.0), np.linspace(500.0, 540.0, 5), np.zeros(5)])
    places[:, 2] = 450.0 + np.array([10.0, 20.0, 40.0, 80.0, 100.0])
    found = profile(flown(places, (0.0, 12.0, 5.0)), clearance, step=0.2, radius=60.0)
    assert found["d"] == pytest.approx(0.8 * (places[:, 2] - 450.0) - 5.0, rel=2e-4)
    assert found["up"] == pytest.approx(np.full(5, 0.8), rel=2e-4)
    assert found["curvature"] == pytest.approx(np.zeros(5), abs=1e-9)
    assert found["speed"] == pytest.approx(np.full(5, 13.0), rel=2e-4)
    depth = np.clip(60.0 - 0.8 * (places[:, 2] - 450.0), 0.0, None)
    cap = depth**2 * (180.0 - depth) / (4.0 * 60.0**3)
    assert found["pc"] == pytest.approx(cap, abs=2e-3)


@given(
    bowl=st.floats(-1e-3, 1e-3),
    trough=st.floats(-1e-3, 1e-3),
    place=st.tuples(st.floats(100.0, 900.0), st.floats(100.0, 900.0)),
)
def test_the_curvature_of_a_quadratic_ground_is_exact(bowl, trough, place):
    x = np.arange(51) * 20.0  # 60 m is three of them
    heights = 0.5 * bowl * x**2 + 0.5 * trough * x[:, None] ** 2 + 0.1 * x
    terrain = Terrain(heights, spacing=(20.0, 20.0))
    found = curvature(terrain, np.array([place]))
    assert found[0] == pytest.approx(0.5 * (bowl + trough), abs=1e-9)


def test_the_ground_goes_on_level_beyond_the_map():
    x = np.arange(51) * 20.0
    terrain = Terrain(np.tile(0.5 * x, (51, 1)), spacing=(20.0, 20.0))
    assert curvature(terrain, np.array([[0.0, 500.0]]))[0] == pytest.approx(0.5 * 30.0 / 60.0**2)


@given(st.floats(-1e6, 1e6).filter(lambda v: v == 0.0 or abs(v) > 1e-30))
def test_rounding_keeps_thirteen_bits(value):
    found = rounded(np.array([value]))
    assert found.dtype == np.float32
    assert abs(float(found[0]) - value) <= 2.0**-13 * abs(value)
    assert found.view(np.uint32)[0] & 0x7FF == 0
    assert np.array_equal(rounded(found.astype(float)), found)


def test_a_start_that_is_too_near_is_refused_by_the_problem():
    ends = pair(0, UNIT)._replace(least=60.0)
    with pytest.raises(ArgumentError, match="min_clearance"):
        procedure.problem(UNIT, ends)
