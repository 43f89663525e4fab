"""Selection: equal time, different ways, and an account of the rest."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk import frechet_distance
from ompl_risk.errors import ArgumentError
from ompl_risk.planners import Candidate, Length, Status, Task, select
from ompl_risk.planners.selection import SAMPLES


def candidate(positions, seed=1):
    positions = np.array(positions, dtype=float)
    length = float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum())
    return Candidate(Task("BITstar", Length(), seed), Status.SOLVED, positions, length)


def bow(height, seed=1):
    """From (0, 0) to (10, 0) by way of (5, height)."""
    return candidate([[0, 0, 0], [5, height, 0], [10, 0, 0]], seed)


def dense(c):
    path = c.trajectory(1.0)
    return path.resample(np.linspace(0.0, path.duration, SAMPLES + 1)).positions


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.floats(-3, 3), min_size=1, max_size=9),
    st.integers(1, 5),
    st.sampled_from([0.02, 0.05, 0.3]),
    st.sampled_from([0.1, 0.5, 1.5]),
)
def test_chosen_are_timely_and_apart_and_none_that_fits_is_left_out(
    heights, count, tolerance, least
):
    given_ = [bow(h, k + 1) for k, h in enumerate(heights)]
    selection = select(given_, count, tolerance=tolerance, min_distance=least)
    chosen = selection.chosen
    fastest = min(c.length for c in given_)
    assert chosen[0].length == fastest
    assert len(chosen) <= count
    assert all(c.length <= (1 + tolerance) * fastest for c in chosen)
    gaps = [frechet_distance(dense(a), dense(b)) for a, b in itertools.combinations(chosen, 2)]
    assert min(gaps, default=math.inf) == selection.separation
    assert all(gap >= least for gap in gaps)
    if len(chosen) < count:  # every timely candidate left is too near to a chosen one
        for c in selection.alike:
            assert min(frechet_distance(dense(c), dense(b)) for b in chosen) < least
    groups = (chosen, selection.pathless, selection.slow, selection.alike, selection.surplus)
    seeds = sorted(c.task.seed for group in groups for c in group)
    assert seeds == [c.task.seed for c in given_]


def test_the_first_is_the_fastest_and_the_next_the_farthest():
    low, mid, high, other = bow(0.0, 1), bow(0.5, 2), bow(0.9, 3), bow(-0.7, 4)
    selection = select([mid, low, other, high], 3, tolerance=0.1, min_distance=0.1)
    assert [c.task.seed for c in selection.chosen] == [1, 3, 4]
    assert selection.surplus == (mid,)


def test_the_summary_tells_how_many_of_how_many_and_why():
    lost = Candidate(Task("BITstar", Length(), 9), Status.NO_PATH)
    given_ = [bow(0.0), bow(0.01), bow(3.0), lost]
    selection = select(given_, 3, min_distance=0.5)
    assert selection.summary == (
        "1 of 4 candidates chosen (1 without a path, 1 too slow, 1 too like a chosen one)"
    )


def test_nothing_is_chosen_of_nothing():
    lost = Candidate(Task("BITstar", Length()), Status.FAILED, reason="x")
    selection = select([lost], min_distance=1.0)
    assert selection.chosen == ()
    assert selection.pathless == (lost,)
    with pytest.raises(ArgumentError, match="BITstar length seed 1"):
        lost.trajectory(1.0)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("count", {"count": 0, "min_distance": 1.0}),
        ("tolerance", {"tolerance": -0.1, "min_distance": 1.0}),
        ("tolerance", {"tolerance": math.nan, "min_distance": 1.0}),
        ("min_distance", {"min_distance": 0.0}),
    ],
)
def test_numbers_out_of_range_are_refused(name, options):
    with pytest.raises(ArgumentError) as caught:
        select([bow(0.0)], **options)
    assert caught.value.argument == name
