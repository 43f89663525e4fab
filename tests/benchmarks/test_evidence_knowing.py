"""Settings that know the level of disturbance, on tables with planted truths."""

import numpy as np
import pytest
from evidence_tables import no_difference, units, write

from benchmarks.evidence.analysis.knowing import (
    ByLevel,
    Predicted,
    evaluated_by_level,
    tuned_by_level,
)
from benchmarks.evidence.analysis.settings import NormOf, OfDistance, evaluated
from benchmarks.evidence.analysis.table import LEVELS, read
from ompl_risk import Lp
from ompl_risk.avoidance import GaussianTail
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances import Disturbances
from ompl_risk.simulation.prediction import errors_of

NARROW, WIDE = (NormOf(Lp(1), OfDistance(GaussianTail(s))) for s in (3.0, 25.0))


def of_level(flights, level):
    """Collisions by the narrow tail when it is calm, and by the wide one otherwise."""
    sigma, scale = (3.0, 0.5) if level == 0 else (25.0, 0.05)
    f = GaussianTail(sigma)
    return [min(0.9, scale * float(Lp(1)(each.t, f(each.d)))) for each in flights]


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    return read(write(tmp_path_factory.mktemp("knowing") / "t.parquet", units(30, no_difference)))


def test_numbers_of_a_setting_of_each_level(table):
    both = ByLevel("tails", (NARROW, WIDE, NARROW))
    blind = evaluated((NARROW, WIDE), table.profiles)
    found = evaluated_by_level((WIDE, both), table.profiles)
    assert found.shape == (2, len(LEVELS), *blind.shape[1:])
    for level, k in enumerate((0, 1, 0)):
        np.testing.assert_array_equal(found[0, level], blind[1])
        np.testing.assert_array_equal(found[1, level], blind[k])


def test_prediction_is_the_library_s_for_each_flight(table):
    found = Predicted().levels(table.profiles)
    for k in (0, 7, 31):
        flight = table.profiles.flight(k)
        model = errors_of(Disturbances.level("severe"), float(flight["speed"].mean()))
        one = model.probability(flight["t"], flight["d"], flight["up"])
        assert found[LEVELS.index("severe"), k] == one
    assert (found[0] <= found[2]).all()  # calm, severe


def test_tuning_finds_what_was_planted_at_each_level(tmp_path):
    planted = read(write(tmp_path / "t.parquet", units(60, of_level)))
    training = planted.part("train")
    found = tuned_by_level(training, "tails", (NARROW, WIDE))
    assert found.settings == (NARROW, WIDE, WIDE)
    assert found.label == "tails, by level"


def test_tuning_refuses_the_test_split(table):
    with pytest.raises(ArgumentError, match="train"):
        tuned_by_level(table, "tails", (NARROW, WIDE))
