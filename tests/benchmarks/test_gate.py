"""What counts as a regression, and what of a figure is compared."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks import gate, yardstick
from benchmarks.metric import LIMIT_ONLY, Target, Tolerance, comparison, error, figure
from benchmarks.readings import LOOSE, ROUNDING, TIGHT, Reading, reading

INF, NAN = math.inf, math.nan


def low(value, relative=1.0, absolute=0.0):
    return Reading(value, "s", "lower", Tolerance(relative, absolute=absolute))


def high(value, relative=1.0, absolute=0.0):
    return Reading(value, "1/s", "higher", Tolerance(relative, absolute=absolute))


@pytest.mark.parametrize(
    ("before", "now", "verdict"),
    [
        (low(2.0), 4.0, "kept"),  # may double, to the digit
        (low(2.0), 4.000001, "worse"),
        (low(2.0), 1.0, "kept"),
        (low(2.0), 0.999, "better"),
        (high(2.0), 1.0, "kept"),  # may halve
        (high(2.0), 0.999, "worse"),
        (high(2.0), 4.0, "kept"),
        (high(2.0), 4.1, "better"),
        (low(2.0, 0.0), 2.0, "kept"),
        (low(2.0, 0.0), np.nextafter(2.0, 3.0), "worse"),
        (low(2.0, 0.0), np.nextafter(2.0, 1.0), "better"),
        (low(0.0, 0.5), 1e-300, "worse"),
        (low(0.0, 0.5, absolute=1e-3), 1e-3, "kept"),
        (low(1e-12, 0.02, absolute=1e-11), 9e-12, "kept"),  # rounding
        (low(1e-12, 0.02, absolute=1e-11), 2e-11, "worse"),
        (high(0.0, 0.5, absolute=1e-3), -2e-3, "worse"),
        (low(INF), INF, "kept"),
        (low(INF), 5.0, "better"),
        (low(5.0), INF, "worse"),
        (high(INF), INF, "kept"),
        (high(INF), 5.0, "worse"),
        (high(5.0), INF, "better"),
        (low(5.0), NAN, "worse"),
        (high(5.0), NAN, "worse"),
        (low(INF), NAN, "worse"),
        (low(5.0, INF), 1e300, "kept"),  # only its limit matters
        (low(5.0, INF), INF, "kept"),
        (high(5.0, INF), 0.0, "kept"),
        (low(5.0, INF), NAN, "worse"),
        (low(5.0, INF), 0.0, "kept"),
    ],
)
def test_verdicts(before, now, verdict):
    change = gate.Change("x", before, replace(before, value=now))
    assert change.verdict == verdict
    assert change.closes is (verdict == "worse")


finite = st.floats(-1e6, 1e6)
positive = st.floats(1e-6, 1e6)


@given(positive, st.floats(0.0, 10.0), st.sampled_from([low, high]))
def test_the_same_value_is_kept(value, relative, make):
    assert gate.Change("x", make(value, relative), make(value, relative)).verdict == "kept"


@given(positive, positive, st.floats(0.0, 10.0))
def test_a_rate_and_its_time_are_judged_alike(before, now, relative):
    ratio = now / before
    margin = abs(ratio / (1.0 + relative) - 1.0)
    if margin < 1e-9 or abs(ratio * (1.0 + relative) - 1.0) < 1e-9:
        return  # rounding decides
    as_time = gate.Change("x", low(before, relative), low(now, relative))
    as_rate = gate.Change("x", high(1.0 / before, relative), high(1.0 / now, relative))
    assert as_time.verdict == as_rate.verdict
    assert as_time.factor == pytest.approx(as_rate.factor)
    assert as_time.factor == pytest.approx(ratio)


@given(finite, finite, st.floats(0.0, 10.0), st.floats(0.0, 10.0), st.sampled_from([low, high]))
def test_what_is_worse_stays_worse_the_further_it_goes(value, now, relative, absolute, make):
    before = make(value, relative, absolute)
    if gate.is_worse(before, now):
        further = now + (1.0 if make is low else -1.0) * (1.0 + abs(now))
        assert gate.is_worse(before, further)
        assert not gate.is_better(before, now)


def test_factors_that_cannot_be_told():
    assert math.isnan(gate.Change("x", low(5.0), low(NAN)).factor)
    assert math.isnan(gate.Change("x", None, low(5.0)).factor)
    assert gate.Change("x", low(0.0), low(1.0)).factor == INF
    assert gate.Change("x", low(5.0), low(INF)).factor == INF
    assert gate.Change("x", low(INF), low(5.0)).factor == 0.0
    assert gate.Change("x", low(INF), low(INF)).factor == 1.0


def test_what_is_gone_or_changed_closes_and_what_is_new_does_not():
    before = {"a: x": low(1.0), "a: y": low(1.0), "b: z": low(1.0)}
    now = {"a: x": low(1.0), "a: new": low(9.0), "b: z": high(1.0)}
    verdicts = {c.name: (c.verdict, c.closes) for c in gate.compared(before, now)}
    assert verdicts == {
        "a: x": ("kept", False),
        "a: y": ("gone", True),
        "b: z": ("changed", True),
        "a: new": ("new", False),
    }
    part = gate.compared(before, {"a: x": low(1.0)}, ["a"])
    assert [c.name for c in part] == ["a: x", "a: y"]  # b was not run


BY_YARDSTICK = Tolerance(LOOSE, of="yardstick")
OF_ERROR = Tolerance(TIGHT, absolute=ROUNDING * 1e-9)


@pytest.mark.parametrize(
    ("metric", "expected"),
    [
        # beside a peer: how many times better
        (
            comparison("m", np.array([2.0]), "us", "p", np.array([8.0])),
            Reading(4.0, "times p", "higher", Tolerance(LOOSE, of="advantage")),
        ),
        # alone: by the yardstick of 0.5 s
        (figure("m", 3.0, "s"), Reading(6.0, "s, by yardstick", "lower", BY_YARDSTICK)),
        (
            figure("m", 3.0, "1/s", better="higher"),
            Reading(1.5, "1/s, by yardstick", "higher", BY_YARDSTICK),
        ),
        # correctness: itself, even beside a peer
        (error("m", 1e-12, "m", 1e-9), Reading(1e-12, "m", "lower", OF_ERROR)),
        (
            comparison(
                "m", np.array([0.1]), "", "p", np.array([0.2]), target=Target(1.0, correctness=True)
            ),
            Reading(0.1, "", "lower", Tolerance(TIGHT, absolute=0.01)),
        ),
        # counts and memory
        (
            comparison("m", np.array([0.7]), "heights", "p", np.array([0.9])),
            Reading(0.7, "heights", "lower", Tolerance(TIGHT)),
        ),
        (figure("m", 26, "edges"), Reading(26.0, "edges", "lower", Tolerance(TIGHT))),
        # as the benchmark says
        (figure("m", 3.0, "m", tolerance=LIMIT_ONLY), Reading(3.0, "m", "lower", LIMIT_ONLY)),
    ],
)  # fmt: skip
def test_what_is_compared(metric, expected):
    assert reading(metric, 0.5) == expected


def test_the_yardstick_takes_the_least_of_its_repeats(monkeypatch):
    ticks = iter([0.0, 5.0, 10.0, 12.0, 20.0, 24.0])
    monkeypatch.setattr(yardstick, "REPEATS", 3)
    monkeypatch.setattr(yardstick.time, "thread_time", lambda: next(ticks))
    assert yardstick.seconds() == 2.0
