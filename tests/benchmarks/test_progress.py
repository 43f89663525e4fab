"""What is left to do, what gets done, and how long the rest will take."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks import progress
from benchmarks.progress import Pace, Queue


@pytest.fixture
def clock(monkeypatch):
    """Seconds that pass when they are added to."""
    now = [1000.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_the_rest_is_expected_at_the_pace_of_this_session(clock):
    pace = Pace(10, 4)
    clock[0] += 30.0
    pace.step()
    assert (pace.done, pace.left) == (5, "2:30 left")
    clock[0] += 10.0
    pace.step()  # 20 s each, and 4 are left
    assert pace.line("words") == "6/10  1:20 left  words"
    for _ in range(4):
        pace.step()
    assert pace.line("x") == "10/10  0:00 left  x"


def test_each_is_told_as_it_gets_done(clock):
    said = []
    queue = Queue("unit", 4, {2: "few"}, again=False, say=said.append)
    assert queue.left == [0, 1, 3]
    assert said == ["1 of 4 units were done before"]
    clock[0] += 7.0
    queue.tell(0, "complete")
    queue.tell(3, "failed", "no wind")
    assert said[1:] == ["2/4  0:14 left  unit 0 complete", "3/4  0:04 left  unit 3 failed: no wind"]


def test_what_failed_is_left_if_it_is_done_again():
    statuses = {0: "failed", 1: "few", 3: "complete"}
    said = []
    assert Queue("pair", 5, statuses, again=False, say=said.append).left == [2, 4]
    assert Queue("pair", 5, statuses, again=True, say=said.append).left == [0, 2, 4]
    assert said == ["3 of 5 pairs were done before", "2 of 5 pairs were done before"]


def test_nothing_is_told_of_nothing():
    assert Queue("pair", 2, {}, again=True, say=pytest.fail).left == [0, 1]
    assert Queue("pair", 1, {0: "failed"}, again=True, say=pytest.fail).left == [0]


@given(st.integers(0, 50), st.dictionaries(st.integers(0, 49), st.sampled_from(["few", "failed"])))
def test_everything_is_either_left_or_done(total, statuses):
    statuses = {number: status for number, status in statuses.items() if number < total}
    left = Queue("unit", total, statuses, again=False, say=lambda _: None).left
    assert left == sorted({*range(total)} - statuses.keys())
