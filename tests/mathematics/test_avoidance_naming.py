"""Avoidance functions by name."""

import pytest

from ompl_risk.avoidance import FlatCap, GaussianTail, InverseDistance
from ompl_risk.avoidance.naming import parse_avoidance
from ompl_risk.errors import ArgumentError


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("inverse", InverseDistance(80.0)),
        (" Cap ", FlatCap(80.0)),
        ("tail(12)", GaussianTail(12.0)),
        ("TAIL(7.5, 60)", GaussianTail(7.5, d0=60.0)),
    ],
)
def test_names(text, meant):
    found = parse_avoidance(text, 80.0)
    assert found == meant
    assert type(found) is type(meant)


@pytest.mark.parametrize("text", ["", "tail", "tail()", "tail(-1)", "tail(0)", "tail(12,)", "1/d"])
def test_other_names_are_refused(text):
    with pytest.raises(ArgumentError, match="avoidance"):
        parse_avoidance(text, 80.0)


@pytest.mark.parametrize("text", ["inverse", "cap"])
def test_a_wrong_length_is_called_by_its_name(text):
    with pytest.raises(ArgumentError, match="d0 = -1"):
        parse_avoidance(text, -1.0)
