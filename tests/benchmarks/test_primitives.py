"""The benchmark of primitive roadmaps in a tiny configuration. Times are not judged."""

import math
from dataclasses import replace

import pytest

from benchmarks import primitives
from benchmarks.metric import Target
from benchmarks.registry import BENCHMARKS
from ompl_risk.cli.settings import PLACES
from ompl_risk.helicopter.flight import Deviation, Flight

CORRECTNESS = {
    "replay of the inputs, from the flight": 0.0,
    "flight, from the plan": 0.5,
    "attitude of the flight, from the plan": 1.0,
}


@pytest.fixture(scope="module")
def tiny(terrain_file):
    return primitives.Config(
        terrain=terrain_file, start=(400.0, 400.0), goal=(2600.0, 2500.0), places=60,
        alternatives=3, apart=50.0, connections=300, repeats=1,
    )  # fmt: skip


def measured(config):
    said = []
    metrics = list(primitives.measure(config, 0, said.append))
    assert said
    assert len({metric.name for metric in metrics}) == len(metrics)
    return {metric.name: metric for metric in metrics}


def test_figures_of_correctness_hold(tiny):
    metrics = measured(tiny)
    for name, limit in CORRECTNESS.items():
        assert metrics[name].target == Target(limit, correctness=True)
        assert not metrics[name].failed
    found = int(metrics["alternatives found"].value.median)
    assert 2 <= found <= 3
    assert metrics["flight, from the plan"].note.startswith(f"{found} flights of up to 3.")
    alone = metrics["60 places, 3 alternatives: the roadmap alone"].value.median
    assert 0.0 < alone < metrics["60 places, 3 alternatives"].value.median
    duration, risk = (metrics[f"a connection: its {x}"] for x in ("duration", "H1 risk"))
    assert 0.0 < duration.value.median < risk.value.median
    assert duration.note.startswith("one thread; ")
    assert {m.unit for m in metrics.values()} == {"s", "us", "m", "deg", ""}


def failed(config):
    return [name for name, metric in measured(config).items() if metric.failed]


def test_a_replay_that_differs_by_little_is_noticed(tiny, monkeypatch):
    original = Flight.replay

    def wrong(self, helicopter=None):
        states = original(self, helicopter).copy()
        states[-1, 12] += 1e-12
        return states

    monkeypatch.setattr(Flight, "replay", wrong)
    assert failed(tiny) == ["replay of the inputs, from the flight"]


@pytest.mark.parametrize(
    ("deviation", "name"),
    [
        (Deviation(0.51, 0.0), "flight, from the plan"),
        (Deviation(0.0, math.radians(1.01)), "attitude of the flight, from the plan"),
    ],
)
def test_a_flight_off_the_plan_is_noticed(tiny, monkeypatch, deviation, name):
    monkeypatch.setattr(Flight, "deviation", deviation)
    assert failed(tiny) == [name]


def test_without_a_flight_nothing_is_shown_to_be_right(tiny, monkeypatch):
    monkeypatch.setattr(primitives, "alternative_routes", lambda *_, **__: ())
    assert failed(tiny) == list(CORRECTNESS)


def test_a_run_measures_what_was_promised():
    """3,000 vertices with every cruise speed and 50 alternatives, on the default flight."""
    for config in (BENCHMARKS["primitives"].full, BENCHMARKS["primitives"].quick):
        assert replace(config, connections=1, repeats=1) == replace(
            primitives.Config(), connections=1, repeats=1
        )
        assert (config.places, config.alternatives) == (3000, 50)
        assert {"start": config.start, "goal": config.goal} == PLACES[config.terrain]
