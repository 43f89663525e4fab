"""Views of any number fill rows, the legend has the room that is left, and nothing overlaps."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.report.view_layout import WIDTH, even_ranks, view_layout

ABOVE = 0.5


def laid_out(count, shape=0.6, needed=1.5):
    return view_layout([shape] * count, lambda width: needed * 16.0 / width, above=ABOVE)


def in_inches(place, layout):
    left, bottom, wide, tall = place
    return left * WIDTH, bottom * layout.height, wide * WIDTH, tall * layout.height


def overlap(one, other):
    return all(one[k] < other[k] + other[k + 2] and other[k] < one[k] + one[k + 2] for k in (0, 1))


@given(st.integers(1, 40), st.integers(2, 12))
def test_even_ranks_have_both_ends_and_equal_steps(count, most):
    ranks = even_ranks(count, most)
    assert len(ranks) == min(count, most)
    assert ranks[0] == 0
    assert ranks[-1] == count - 1
    steps = {b - a for a, b in itertools.pairwise(ranks)}
    assert all(step >= 1 for step in steps)
    assert max(steps, default=1) - min(steps, default=1) <= 1
    for k, rank in enumerate(ranks):  # none is farther than half a rank from its even place
        assert abs(rank - k * (count - 1) / max(len(ranks) - 1, 1)) <= 0.5


@given(
    st.lists(st.floats(0.2, 2.0), min_size=1, max_size=12),
    st.floats(0.5, 4.0),
)
def test_places_are_within_the_figure_and_apart(shapes, needed):
    layout = view_layout(shapes, lambda width: needed * 16.0 / width, above=ABOVE)
    places = [in_inches(place, layout) for place in [*layout.views, layout.legend]]
    assert len(layout.views) == len(shapes)
    for k, (left, bottom, wide, tall) in enumerate(places):
        assert left > 0.0
        assert bottom > 0.0
        assert left + wide < WIDTH
        assert bottom + tall < layout.height - ABOVE
        assert not any(overlap(places[k], other) for other in places[:k])
    _, _, wide, tall = places[-1]
    assert tall >= needed * 16.0 / wide - 0.121  # what the legend needs, but for the gap


@pytest.mark.parametrize(
    ("count", "columns", "rows"),
    [(1, 1, 1), (2, 2, 1), (3, 2, 2), (4, 2, 2), (5, 3, 2), (6, 3, 2), (7, 3, 3), (8, 3, 3)],
)
def test_rows_and_columns(count, columns, rows):
    views = laid_out(count).views
    assert len({round(left, 9) for left, *_ in views}) == columns
    assert len({round(bottom, 9) for _, bottom, *_ in views}) == rows


@pytest.mark.parametrize("count", range(1, 13))
def test_no_corner_is_left_empty(count):
    """Views and legend cover the width of every row."""
    layout = laid_out(count)
    places = [in_inches(place, layout) for place in [*layout.views, layout.legend]]
    for bottom in {round(place[1], 6) for place in places}:
        row = [place for place in places if round(place[1], 6) == bottom]
        assert sum(place[2] + 0.12 for place in row) == pytest.approx(WIDTH)


def test_a_row_is_as_high_as_what_it_shows():
    flat, steep = laid_out(2, shape=0.4), laid_out(2, shape=0.5)
    assert steep.height - flat.height == pytest.approx(0.1 * (8.0 - 0.12))
    assert laid_out(2, shape=5.0).height == laid_out(2, shape=9.0).height  # up to a limit
    assert laid_out(2, shape=0.01).height == laid_out(2, shape=0.02).height
