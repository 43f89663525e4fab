"""Disturbances: switches, published levels, and what reports and records say of them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.gusts import DrydenGusts
from ompl_risk.simulation.disturbances.navigation import NavigationError
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import LEVELS, Disturbances

TABLE = {  # W20 [kn], horizontal and vertical [m] at 95 %, roll, heading [deg], [m/s], map [m]
    "calm": (15, 1.062, 1.790, 0.2, 1.0, 0.1, 9.0 / 1.645),
    "moderate": (30, 8.0, 13.0, 0.4, 1.0, 0.1, 16 / 1.645),
    "severe": (45, 15.0, 33.0, 0.8, 2.0, 0.2, 14.38),
}


@pytest.mark.parametrize("name", LEVELS)
def test_levels_are_as_documented(name: str) -> None:
    level = Disturbances.level(name)
    assert level.gusts is not None
    assert level.navigation is not None
    assert level.terrain is not None
    parts = (level.navigation.position, level.navigation.attitude, level.navigation.velocity)
    position, attitude, velocity = (np.hypot(part.bias, part.noise) for part in parts)
    found = (
        level.gusts.wind_at_6m * 3600 / 1852,
        position[0] * math.sqrt(-2 * math.log(0.05)),
        position[2] * 1.959964,
        math.degrees(attitude[0]),
        math.degrees(attitude[2]),
        velocity[0],
        level.terrain.deviation,
    )
    np.testing.assert_allclose(found, TABLE[name], rtol=1e-6)


def test_the_table_of_the_documentation_is_that_of_the_test() -> None:
    text = Disturbances.level.__doc__ or ""
    for name, place in (("W20", 0), ("roll/pitch", 3), ("heading", 4), ("velocity", 5), ("map", 6)):
        line = next(line for line in text.splitlines() if line.strip().startswith(name))
        numbers = [float(word) for word in line.split() if word.replace(".", "").isdigit()]
        assert numbers == [round(TABLE[level][place], 2) for level in LEVELS]


def test_a_higher_level_is_worse_in_everything_but_heading() -> None:
    calm, moderate, severe = (TABLE[name] for name in LEVELS)
    assert all(a <= b <= c for a, b, c in zip(calm, moderate, severe, strict=True))


def test_each_has_its_own_switch() -> None:
    assert Disturbances() == Disturbances(None, None, None)
    only = Disturbances(terrain=TerrainError(3.0))
    assert (only.gusts, only.navigation) == (None, None)
    assert only != Disturbances(terrain=TerrainError(4.0))


def test_equal_numbers_are_equal_and_hash_alike() -> None:
    for name in LEVELS:
        assert Disturbances.level(name) == Disturbances.level(name)
    assert len({Disturbances.level(name) for name in LEVELS * 2}) == 3


def test_an_unknown_level_names_those_that_there_are() -> None:
    with pytest.raises(ArgumentError, match="calm, moderate, severe"):
        Disturbances.level("gale")


@pytest.mark.parametrize("name", ["gusts", "navigation", "terrain"])
def test_something_of_another_kind(name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        Disturbances(**{name: 3.0})  # type: ignore[arg-type]


def test_a_line_on_each() -> None:
    none = Disturbances().describe()
    assert [line.endswith("none") for line in none] == [True] * 3
    gusts, navigation, terrain = Disturbances.level("moderate").describe()
    assert "15.43 m/s" in gusts
    assert "[2.5, 3.6, 18.1] kg/s" in gusts
    assert "6.63 m up" in navigation
    assert "10 Hz" in navigation
    assert "9.73 m" in terrain
    assert "300 m" in terrain
    assert "of the vehicle" in Disturbances(gusts=DrydenGusts(3.0, None)).describe()[0]


def test_records_hold_every_number() -> None:
    data = json.loads(json.dumps(Disturbances.level("severe").as_data()))
    assert data["terrain"] == {
        "deviation": 14.38, "correlation_length": 300.0, "waves": 64, "seed": 0,
    }  # fmt: skip
    assert data["gusts"]["drag"] == [2.5, 3.6, 18.1]
    assert data["navigation"]["position"]["time"] == 1100.0
    assert Disturbances(navigation=NavigationError()).as_data()["gusts"] is None
