"""Errors say what they must, and survive the way between processes."""

import pickle

import pytest

from ompl_risk import errors

SAMPLES = [
    errors.ArgumentError("speed", -3.0, "above 0"),
    errors.FileError("a.tif", "no band 2", "choose band=1"),
    errors.TerrainError("1 x 5 posts", "at least 2 x 2 are needed"),
    errors.VoidError(3, (0, 7)),
    errors.ExtentError(2, (1.0, 2.0), (0.0, 1.0, 0.0, 1.0)),
    errors.TrapError("PRMstar.solve()", "hangs", "use RRTstar"),
    errors.LabelLimitError(100, 5.0, 6.0),
    errors.NoWayError("takes at most 3 s", "the fastest takes 5 s"),
]


@pytest.mark.parametrize("error", SAMPLES, ids=lambda e: type(e).__name__)
def test_errors_survive_pickling(error):
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert vars(copy) == vars(error)


def test_every_error_has_one_root():
    kinds = [k for k in vars(errors).values() if isinstance(k, type) and issubclass(k, Exception)]
    kinds = [k for k in kinds if not issubclass(k, Warning)]
    assert len(kinds) >= 8
    assert all(issubclass(k, errors.OmplRiskError) for k in kinds)


def test_argument_error_names_argument_value_and_what_is_allowed():
    assert str(SAMPLES[0]) == "speed = -3.0: must be above 0"
    assert isinstance(SAMPLES[0], ValueError)
