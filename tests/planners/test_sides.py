import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError
from ompl_risk.planners.sides import Sides
from ompl_risk.terrains import Terrain

whole = st.integers(-4, 4).map(float)
places = st.tuples(whole, whole)
peaks_on_a_grid = st.lists(places, min_size=1, max_size=4, unique=True).map(np.array)
directions = st.floats(-4.0, 4.0)


def gap(path, peaks):
    """Least distance of a polyline to any of the points."""
    least = math.inf
    for a, b in pairwise(np.asarray(path, dtype=float)):
        u = b - a
        for peak in peaks:
            t = np.clip((peak - a) @ u / max(u @ u, 1e-300), 0.0, 1.0)
            least = min(least, float(np.linalg.norm(a + t * u - peak)))
    return least


def winding(loop, peak):
    """How often a closed polyline winds around a point, from the angles under which it is seen."""
    x, y = (np.asarray(loop) - peak).T
    turns = np.diff(np.arctan2(y, x))
    return round(float(((turns + np.pi) % (2 * np.pi) - np.pi).sum()) / (2 * np.pi))


def same(words):
    """Which of them are equal."""
    return [[a == b for b in words] for a in words]


def reduced(word):
    out = []
    for letter in word:
        if out and out[-1] == -letter:
            out.pop()
        else:
            out.append(letter)
    return tuple(out)


def test_a_peak_has_two_sides():
    peak = Sides([(0.0, 0.0)], direction=math.pi / 2)
    north = [(-5, 0), (0, 3), (5, 0)]
    south = [(-5, 0), (0, -3), (5, 0)]
    assert peak.word(south) == ()
    assert peak.word(north) == (-1,)
    assert peak.word([(-5, 0), (-1, 9), (2, 0.5), (5, 0)]) == peak.word(north)


def test_two_peaks_have_four_classes_of_paths_straight_on():
    peaks = Sides([(0.0, 0.0), (10.0, 0.0)])
    paths = [[(-5, 0), (0, s), (10, t), (15, 0)] for s in (-3, 3) for t in (-3, 3)]
    assert len({peaks.word(path) for path in paths}) == 4


def test_order_counts_where_windings_cancel():
    """Around a, around b, back around a, back around b: it winds around neither, yet is caught."""
    peaks = Sides([(-2.0, 0.0), (2.0, 0.0)], direction=math.pi / 2)
    a = [(0, -3), (-1, 1), (-3, 1), (-3, -1), (0, -3)]
    b = [(0, -3), (1, 1), (3, 1), (3, -1), (0, -3)]
    loop = a + b[1:] + a[::-1][1:] + b[::-1][1:]
    assert [winding(loop, peak) for peak in peaks.peaks] == [0, 0]
    assert len(peaks.word(loop)) == 4
    assert peaks.word(a + a[::-1][1:]) == ()


@given(st.lists(places, min_size=3, max_size=9), peaks_on_a_grid, directions)
@settings(deadline=None)
def test_letters_add_up_to_winding_numbers(corners, peaks, direction):
    loop = [*corners, corners[0]]
    assume(gap(loop, peaks) > 1e-6)
    sides = Sides(peaks, direction)
    word = sides.word(loop)
    counts = sorted(sum(math.copysign(1, n) for n in word if abs(n) == k + 1) for k in range(4))
    windings = sorted([winding(loop, peak) for peak in peaks] + [0] * (4 - len(peaks)))
    assert counts == windings


@given(st.lists(st.lists(places, max_size=6), min_size=2, max_size=6), peaks_on_a_grid, directions)
@settings(max_examples=150, deadline=None)
def test_equality_does_not_depend_on_the_direction_of_the_rays(middles, peaks, direction):
    """On a grid along whose lines the first rays run: peaks and corners level with each other."""
    paths = [[(-7.0, -1.0), *middle, (7.0, 1.0)] for middle in middles]
    paths += [[p[0], (a, b), (a, -b), p[-1]] for p in paths[:1] for a in (-5, 5) for b in (-5, 5)]
    assume(all(gap(path, peaks) > 1e-6 for path in paths))
    level, upright, turned = (Sides(peaks, d) for d in (0.0, math.pi / 2, direction))
    assert same([level.word(p) for p in paths]) == same([turned.word(p) for p in paths])
    assert same([upright.word(p) for p in paths]) == same([turned.word(p) for p in paths])


@given(st.lists(places, min_size=2, max_size=8), peaks_on_a_grid, st.integers(0, 2**32 - 1))
@settings(max_examples=100, deadline=None)
def test_small_deformations_change_nothing(path, peaks, seed):
    path = np.array(path)
    room = gap(path, peaks)
    assume(room > 1e-3)
    rng = np.random.default_rng(seed)
    fine = np.concatenate([np.linspace(a, b, 5)[:-1] for a, b in pairwise(path)] + [path[-1:]])
    moved = fine + 0.7 * room * rng.uniform(-1, 1, fine.shape)
    moved[0], moved[-1] = path[0], path[-1]
    sides = Sides(peaks, float(rng.uniform(-3, 3)))
    assert sides.word(fine) == sides.word(path) == sides.word(moved)


@given(st.lists(places, min_size=3, max_size=8), peaks_on_a_grid, st.data())
@settings(deadline=None)
def test_words_multiply_as_paths_join(path, peaks, data):
    assume(gap(path, peaks) > 1e-6)
    sides, cut = Sides(peaks), data.draw(st.integers(0, len(path) - 1))
    word = sides.word(path)
    assert word == reduced(word)
    assert reduced(sides.word(path[: cut + 1]) + sides.word(path[cut:])) == word
    assert sides.word(path[::-1]) == tuple(-n for n in word[::-1])


def test_many_at_once_as_one_by_one():
    rng = np.random.default_rng(3)
    sides = Sides(rng.uniform(-1, 1, (30, 2)), 0.4)
    paths = [rng.uniform(-1, 1, (n, 3)) for n in (1, 2, 400, 7, 900, 1)]
    first = np.append(0, np.cumsum([len(path) for path in paths]))
    words = [sides.word(path) for path in paths]
    assert sides.words(np.concatenate(paths), first) == words
    assert sum(map(len, words)) > 2048
    assert words[0] == ()


def cones(*summits, size=41, radius=4.0):
    """A plain of height 0 with a cone of height 100 m on each (column, row)."""
    y, x = np.mgrid[0:size, 0:size].astype(float)
    away = np.min([np.hypot(x - i, y - j) for i, j in summits], axis=0)
    return Terrain(100.0 * np.maximum(0.0, 1.0 - away / radius), spacing=(10.0, 20.0))


def box(terrain, ceiling=60.0):
    xmin, xmax, ymin, ymax = terrain.extent
    return (xmin, ymin, 0.0), (xmax, ymax, ceiling)


def test_peaks_are_the_summits_above_the_ceiling():
    ground = cones((10, 20), (30, 12))
    assert Sides.of_terrain(ground, *box(ground)).peaks.tolist() == [[300, 240], [100, 400]]
    assert Sides.of_terrain(ground, *box(ground, 100.0)).count == 0
    assert Sides.of_terrain(ground, *box(ground, 100.0), radius=0.5).count == 2
    assert Sides.of_terrain(ground, *box(ground, 119.0), radius=5.0, min_clearance=15.0).count == 2
    assert Sides.of_terrain(ground, *box(ground, 120.0), radius=5.0, min_clearance=15.0).count == 0


def test_what_reaches_the_edge_of_map_or_box_has_no_other_side():
    ground = cones((1, 20), (20, 20))
    assert Sides.of_terrain(ground, *box(ground)).peaks.tolist() == [[200, 400]]
    low, high = (0.0, 0.0, 0.0), (205.0, 800.0, 60.0)
    assert Sides.of_terrain(ground, low, high).count == 0
    assert Sides.of_terrain(ground, low, (240.0, 800.0, 60.0)).count == 1
    assert Sides.of_terrain(ground, (-1e4, -1e4, 0), (1e4, 1e4, 60.0)).count == 1


def test_small_peaks_can_be_left_out():
    ground = cones((10, 20), (30, 12))
    assert Sides.of_terrain(ground, *box(ground, 75.1), min_extent=40.0).count == 0
    assert Sides.of_terrain(ground, *box(ground, 74.9), min_extent=40.0).count == 2


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.2, 0.4, 0.5, 0.6]))
@settings(max_examples=60, deadline=None)
def test_components_against_joining_along_the_triangles(seed, share):
    high = np.random.default_rng(seed).random((9, 8)) < share
    high[[0, -1]], high[:, [0, -1]] = False, False
    group = {post: {post} for post in zip(*np.nonzero(high), strict=True)}
    for j in range(8):
        for i in range(7):
            sw, se, nw, ne = (j, i), (j, i + 1), (j + 1, i), (j + 1, i + 1)
            for triangle in ((sw, se, ne), (sw, ne, nw)):
                up = [post for post in triangle if high[post]]
                joined = set().union(*(group[post] for post in up))
                group.update(dict.fromkeys(joined, joined))
    expected = {frozenset(posts) for posts in group.values()}
    ground = Terrain(np.where(high, 10.0, 0.0), spacing=(1.0, 1.0))
    peaks = Sides.of_terrain(ground, *box(ground, 5.0)).peaks
    found = {frozenset(group[int(y), int(x)]) for x, y in peaks}
    assert found == expected
    assert len(peaks) == len(expected)


def test_equal_by_way_of_a_gap_that_is_too_narrow():
    """Two summits 20 m apart: two words for the sides, though nothing passes between them."""
    peaks = Sides([(0.0, 0.0), (20.0, 0.0)], direction=1.0)
    north, south = ([(-50, 0), (10, y), (50, 0)] for y in (60, -60))
    wide = [(-50, 0), (-5, 90), (25, 90), (50, 0)]
    assert peaks.word(north) == peaks.word(wide) != peaks.word(south)


def test_what_is_refused():
    ground = cones((20, 20))
    with pytest.raises(ArgumentError, match=r"peaks.shape = \(1, 3\): must be \(k, 2\)"):
        Sides([(0.0, 0.0, 0.0)])
    with pytest.raises(ArgumentError, match=r"peaks\[0, 1\] = nan"):
        Sides([(0.0, math.nan)])
    for direction in (math.nan, math.inf, "north"):
        with pytest.raises(ArgumentError, match="direction"):
            Sides([(0.0, 0.0)], direction)
    with pytest.raises(ArgumentError, match=r"points.shape = \(2, 1\)"):
        Sides([(0.0, 0.0)]).word([[0.0], [1.0]])
    with pytest.raises(ArgumentError, match=r"points\[0, 0\] = inf"):
        Sides([(0.0, 0.0)]).word([[math.inf, 0.0]])
    with pytest.raises(ArgumentError, match="high"):
        Sides.of_terrain(ground, (0, 0, 0), (1, 0, 1))
    with pytest.raises(ArgumentError, match=r"low, high in y = .* 0 to 800"):
        Sides.of_terrain(ground, (0, 900, 0), (400, 1000, 60))
    for name in ("radius", "min_clearance", "min_extent"):
        with pytest.raises(ArgumentError, match=name):
            Sides.of_terrain(ground, *box(ground), **{name: -1.0})


def test_peaks_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        Sides([(0.0, 0.0)]).peaks[0, 0] = 1.0
