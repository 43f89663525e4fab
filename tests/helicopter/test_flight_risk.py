"""Risk and freedom of collision along pieces, against dense samples of formulas of their own."""

import math
from functools import cache

import numpy as np
import pytest
from flown_pieces import TRACKS, Way, dense
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance, UnionClearance
from ompl_risk.helicopter.flight_risk import Connections, TerrainFlightRisk
from ompl_risk.helicopter.sampled_flight_risk import SampledFlightRisk
from ompl_risk.motion import Risk, TerrainBatch
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.terrains import Terrain

NORMS = [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]
KINDS = [TerrainFlightRisk, SampledFlightRisk]
D0 = 30.0

norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
kinds = pytest.mark.parametrize("kind", KINDS, ids=["terrain", "sampled"])


def land(heights, spacing, radius=0.0):
    return TerrainClearance(Terrain(np.asarray(heights, dtype=float), spacing=spacing), radius)


@pytest.fixture(scope="module")
def hills():
    y, x = np.mgrid[0:60, 0:60] / 40
    return land(20 * np.sin(7 * x) * np.cos(9 * y) + 8 * np.sin(23 * x + 17 * y), (10.0, 10.0), 2.0)


@pytest.fixture(scope="module")
def flat():
    return land(np.zeros((3, 3)), (200.0, 200.0))


def wall(at=200.0, thickness=0.1, height=30.0):
    """A wall right across x = at on a map of 400 m; its flanks are as steep as a cell of 0.05 m."""
    n = round(thickness / 0.05)
    heights = np.zeros((2, 8001))
    heights[:, round(at / 0.05) : round(at / 0.05) + n + 1] = height
    return land(heights, (0.05, 400.0))


def peak():
    heights = np.zeros((41, 41))
    heights[20, 20] = 60.0
    return land(heights, (10.0, 10.0))


def risk_of(norm, **options):
    return Risk(InverseDistance(D0), norm, **{"speed": 40.0, "duration_weight": 0.0, **options})


def together(*ways):
    counts = np.array([len(way.rows) for way in ways])
    return Connections(
        np.array([way.pieces for way in ways]), counts, np.array([way.duration for way in ways])
    )


def cost(kind, clearance, risk, *ways):
    return kind(TRACKS, clearance, risk).costs(together(*ways))


def free(kind, clearance, *ways):
    return kind(TRACKS, clearance, risk_of(Lp(1))).are_free(together(*ways))


def winding(x=150.0, y=120.0, z=45.0, heading=0.3):
    """Every kind of piece: banking, a turn, a change of speed, a climb and hovering."""
    way = Way(x, y, z, heading).manoeuvre(0).trim(20.0, 0.0, 0.4, 5.0).manoeuvre(2)
    way.trim(20.0, -2.0, -0.2, 4.0).trim(20.0, 2.0, 0.0, 3.0).manoeuvre(1)
    return way.trim(0.0, 0.0, 0.8, 1.5).trim(0.0, 2.0, 0.0, 1.0).trim(20.0, 0.0, 0.0, 0.0)


@norms
@kinds
def test_risk_agrees_with_the_norm_of_dense_samples(kind, norm, hills):
    ways = [winding(), winding(300.0, 330.0, 40.0, 2.0)]
    found = cost(kind, hills, risk_of(norm, tolerance=1e-3), *ways)
    for k, way in enumerate(ways):
        t, places = dense(way.rows)
        expected = norm.power(t, InverseDistance(D0)(hills(places)))
        assert found[k] == pytest.approx(expected, rel=3e-3)
        assert 0.0 < expected < math.inf


@norms
def test_risk_beside_a_wall_and_a_peak_agrees_with_dense_samples(norm):
    risk = risk_of(norm, tolerance=1e-3)
    past = Way(150.0, 120.0, 12.0, 0.0).trim(10.0, 0.0, 0.25, 14.0)
    steep = Way(160.0, 150.0, 25.0, 0.0).manoeuvre(0).trim(20.0, 0.0, 0.4, 8.0)
    for clearance, way in ((wall(at=200.0), past), (peak(), steep)):
        t, places = dense(way.rows)
        expected = norm.power(t, InverseDistance(D0)(clearance(places)))
        found = cost(TerrainFlightRisk, clearance, risk, way)[0]
        assert found == pytest.approx(expected, rel=3e-3)
        assert 0.0 < expected < math.inf


@norms
def test_the_default_tolerance_holds_over_many_arcs(norm, hills):
    rng = np.random.default_rng(4)
    arcs = []
    while len(arcs) < 12:
        x, y = rng.uniform(150.0, 400.0, 2)
        z = float(hills.terrain.height(x, y)) + rng.uniform(15.0, 35.0)
        way = Way(x, y, z, rng.uniform(-3.0, 3.0))
        way.trim(rng.uniform(8.0, 30.0), rng.uniform(-1.0, 4.0), rng.uniform(-0.8, 0.8), 5.0)
        if hills(dense(way.rows, 201)[1]).min() > 2.0:
            arcs.append(way)
    found = cost(TerrainFlightRisk, hills, risk_of(norm), *arcs)
    for k, way in enumerate(arcs):
        t, places = dense(way.rows, 5_001)
        expected = norm.power(t, InverseDistance(D0)(hills(places)))
        assert abs(
            found[k] - expected
        ) <= 1e-2 * expected + 1e-3 * way.duration * D0 ** -risk_power(norm)


def risk_power(norm):
    return 1.0 if math.isinf(norm.exponent) else norm.exponent


@norms
def test_a_straight_piece_costs_what_a_straight_motion_costs(norm, hills):
    rng = np.random.default_rng(5)
    risk = Risk(InverseDistance(D0), norm, speed=25.0, tolerance=1e-2)
    ways = []
    for _ in range(40):
        x, y = rng.uniform(150.0, 400.0, 2)
        climb = rng.uniform(-6.0, 6.0)
        way = Way(x, y, float(hills.terrain.height(x, y)) + 30.0, rng.uniform(-3.0, 3.0))
        ways.append(way.trim(math.sqrt(25.0**2 - climb**2), climb, 0.0, 4.0))
    a = np.array([way.rows[0][2:5] for way in ways])
    b = np.array([[way.pose[0].real, way.pose[0].imag, way.pose[1]] for way in ways])
    straight = TerrainBatch(hills, risk)
    expected = straight.costs(a, b)
    assert cost(TerrainFlightRisk, hills, risk, *ways) == pytest.approx(expected, rel=1e-6)
    assert free(TerrainFlightRisk, hills, *ways).tolist() == straight.are_free(a, b).tolist()
    assert 0.2 < np.isfinite(expected).mean() < 0.95


@norms
def test_a_way_costs_the_same_however_it_is_cut(norm, hills):
    whole, cut = winding(), winding()
    cut.rows = [part for row in whole.rows for part in halves(row)]
    risk = risk_of(norm, tolerance=1e-4)
    assert cost(TerrainFlightRisk, hills, risk, cut) == pytest.approx(
        cost(TerrainFlightRisk, hills, risk, whole), rel=3e-4
    )


def halves(row):
    """A trim cut at 0.37 of its time; manoeuvres stay."""
    if row[0] != 0.0:
        return [row]
    first, rest = row.copy(), row.copy()
    first[1], rest[1] = 0.37 * row[1], 0.63 * row[1]
    x, y, z = dense([first], 2)[1][-1]
    rest[2:6] = x, y, z, row[5] + row[8] * first[1]
    return [first, rest]


@norms
@kinds
def test_hovering_costs_its_time(kind, norm, flat):
    way = Way(200.0, 200.0, 12.0, 0.0).trim(0.0, 0.0, 0.8, 7.0)
    f = 1 / 12.0 - 1 / D0
    expected = f if math.isinf(norm.exponent) else 7.0 * f**norm.exponent
    assert cost(kind, flat, risk_of(norm), way) == pytest.approx([expected], rel=1e-12)
    assert free(kind, flat, way).tolist() == [True]


@kinds
def test_level_arcs_over_flat_ground_cost_their_time_and_the_duration_its_weight(kind, flat):
    way = Way(200.0, 200.0, 12.0, 0.0).manoeuvre(0).trim(20.0, 0.0, 0.4, 6.0)
    f = 1 / 12.0 - 1 / D0
    found = cost(kind, flat, risk_of(Sobolev(1), duration_weight=0.01), way)
    assert found == pytest.approx([7.0 * (f * f + 0.01)], rel=1e-12)
    high = Way(200.0, 200.0, 3 * D0, 0.0).trim(20.0, 0.0, 0.4, 6.0)
    assert cost(kind, flat, risk_of(Sobolev(1)), high).tolist() == [0.0]


@given(
    heading=st.floats(-3.1, 3.1), share=st.floats(0.05, 0.95),
    turn=st.floats(0.1, 1.0), sign=st.sampled_from([-1.0, 1.0]),
)  # fmt: skip
@settings(max_examples=30, deadline=None)
def test_no_wall_is_jumped_over_however_thin(heading, share, turn, sign):
    clearance, w = thin(), sign * turn
    arc = 25.0 * (np.exp(1j * w * np.array([share, 1.0]) * 3.0) - 1.0) / (1j * w)
    place = 200.025 - (np.exp(1j * heading) * arc[0]).real  # meets the wall at that share
    way = Way(place, 200.0, 29.0, heading).trim(25.0, 0.0, w, 3.0)
    above = Way(place, 200.0, 30.01, heading).trim(25.0, 0.0, w, 3.0)
    cut = Way(place, 200.0, 29.0, heading)
    for _ in range(24):
        cut.trim(25.0, 0.0, w, 3.0 / 24)
    for kind in KINDS:
        assert cost(kind, clearance, risk_of(Sobolev(1)), way).tolist() == [math.inf]
        assert cost(kind, clearance, risk_of(Lp(math.inf)), way).tolist() == [math.inf]
        assert free(kind, clearance, way, cut, above).tolist() == [False, False, True]


@cache
def thin():
    return wall(thickness=0.05)


@kinds
def test_a_wall_amid_a_manoeuvre_is_met(kind):
    clearance = thin()
    through = Way(190.0, 200.0, 25.0, 0.1).manoeuvre(0)
    before = Way(150.0, 200.0, 25.0, 0.1).manoeuvre(0)
    hop = Way(185.0, 200.0, 29.9, 0.0).manoeuvre(2)  # rises by 0.5 m half-way, 12.5 m on
    assert free(kind, clearance, through, before, hop).tolist() == [False, True, True]
    assert np.isinf(cost(kind, clearance, risk_of(Lp(2)), through, before, hop)).tolist() == [
        True, False, False,
    ]  # fmt: skip


@kinds
@pytest.mark.parametrize("norm", [Sobolev(1), Lp(math.inf)], ids=lambda norm: norm.label)
def test_a_way_that_leaves_the_map_on_the_way_is_not_free(kind, norm, flat):
    """The edge is no obstacle: d near it says nothing, and beyond it is -inf."""
    ways = [turned_towards_the_edge(beyond) for beyond in (-1.0, -1e-6, 1e-6, 1.0)]
    stay = [True, True, False, False]
    assert free(kind, flat, *ways).tolist() == stay
    assert np.isfinite(cost(kind, flat, risk_of(norm), *ways)).tolist() == stay


def turned_towards_the_edge(beyond):
    """An arc whose easternmost point, half-way, lies so far beyond x = 400 m."""
    w = 0.4
    half = 0.5 * math.pi - 0.9
    x = 400.0 + beyond - 20.0 / w * (1.0 - math.sin(0.9))
    return Way(x, 200.0, 90.0, 0.9).trim(20.0, 0.0, w, 2 * half / w)


@kinds
def test_manoeuvres_and_straight_pieces_that_leave_the_map_are_not_free(kind, flat):
    out = Way(390.0, 200.0, 20.0, 0.0).manoeuvre(2).trim(20.0, 0.0, math.pi / 4, 6.0)
    back = Way(399.9, 200.0, 20.0, math.pi / 2 - 0.1).manoeuvre(0)
    over = Way(390.0, 200.0, 20.0, 0.1).trim(20.0, 0.0, 0.0, 2.0)
    along = Way(400.0, 200.0, 20.0, math.pi / 2).trim(20.0, 0.0, 0.0, 2.0)
    assert free(kind, flat, out, back, over, along).tolist() == [False, False, False, True]


@kinds
def test_ways_in_contact_at_their_ends_and_those_that_are_not(kind, flat):
    """Where there is no connection nothing is free and the risk is infinite."""
    made = together(Way(200.0, 200.0, 10.0, 0.0).trim(20.0, -2.0, 0.3, 4.999))
    down = together(Way(200.0, 200.0, 10.0, 0.0).trim(20.0, -2.0, 0.3, 5.0))
    nowhere = made._replace(counts=np.array([0]), durations=np.array([math.inf]))
    judge = kind(TRACKS, flat, risk_of(Lp(2), duration_weight=1.0))
    assert [bool(judge.are_free(ways)[0]) for ways in (made, down, nowhere)] == [True, False, False]
    assert [bool(np.isfinite(judge.costs(ways)[0])) for ways in (made, down, nowhere)] == [
        True, False, False,
    ]  # fmt: skip


@norms
def test_compiled_and_sampled_agree(norm, hills):
    rng = np.random.default_rng(6)
    ways = [
        winding(*rng.uniform(150.0, 400.0, 2), rng.uniform(20.0, 60.0), rng.uniform(-3.0, 3.0))
        for _ in range(40)
    ]
    risk = risk_of(norm, tolerance=1e-3)
    compiled, sampled = (cost(kind, hills, risk, *ways) for kind in KINDS)
    assert np.array_equal(np.isinf(compiled), np.isinf(sampled))
    flown = np.isfinite(compiled)
    assert sampled[flown] == pytest.approx(compiled[flown], rel=5e-3)
    assert free(KINDS[0], hills, *ways).tolist() == free(KINDS[1], hills, *ways).tolist()
    assert 0.1 < flown.mean() < 0.9


def test_the_edge_of_a_terrain_in_a_union_counts(flat):
    union = UnionClearance([lambda x: x[:, 2] + 5.0, UnionClearance([flat])])
    inside, outside = (turned_towards_the_edge(d) for d in (-0.1, 0.1))
    assert free(SampledFlightRisk, union, inside, outside).tolist() == [True, False]
