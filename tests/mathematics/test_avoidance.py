import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.avoidance import Avoidance, InverseDistance
from ompl_risk.errors import ArgumentError

f = InverseDistance(d0=100.0)
distances = st.floats(1e-6, 1e6)


def test_values_of_equation_3():
    d = [50.0, 25.0, 99.0, 100.0, 101.0, math.inf]
    np.testing.assert_allclose(f(d), [0.01, 0.03, 1 / 99 - 0.01, 0, 0, 0], rtol=1e-15)


@pytest.mark.parametrize("d", [0.0, -0.0, -1e-300, -5.0, -math.inf])
def test_touching_and_inside_is_infinite(d):
    assert f(d) == math.inf
    assert f.derivative(d) == -math.inf


def test_shape_is_kept():
    assert f(np.full((2, 3), 50.0)).shape == (2, 3)
    assert f(50.0).shape == ()
    assert f(50.0).dtype == np.float64


@given(distances, distances)
def test_never_increases_with_distance(a, b):
    near, far = sorted((a, b))
    assert f(near) >= f(far) >= 0


@given(st.floats(0.1, 1e4), st.floats(0.05, 0.98))
def test_derivative_against_central_differences(d0, part):
    g, d = InverseDistance(d0), part * d0
    h = 1e-5 * d
    slope = (g(d + h) - g(d - h)) / (2 * h)
    # The difference quotient itself errs by (h/d)^2 and by rounding of g over h.
    assert g.derivative(d) == pytest.approx(slope, rel=1e-8)


def test_derivative_is_zero_from_d0_on():
    np.testing.assert_array_equal(f.derivative([100.0, 200.0]), 0.0)


def test_subnormal_distance_gives_infinity_without_warning():
    assert f(5e-324) == math.inf


def test_nan_and_words_are_refused():
    with pytest.raises(ArgumentError, match="d = nan"):
        f([1.0, math.nan])
    with pytest.raises(ArgumentError, match="array of real numbers"):
        f("near")
    with pytest.raises(ArgumentError, match="array of real numbers"):
        f.derivative([1j])


@pytest.mark.parametrize("d0", [0.0, -1.0, math.inf, math.nan, "100", None, True])
def test_d0_must_be_positive_and_finite(d0):
    with pytest.raises(ArgumentError, match=r"d0 = .*positive finite"):
        InverseDistance(d0)


def test_equal_by_parameter_and_frozen():
    assert InverseDistance(100) == f
    assert hash(InverseDistance(100)) == hash(f)
    assert InverseDistance() == f
    assert InverseDistance(99.0) != f
    assert isinstance(f, Avoidance)
    with pytest.raises(AttributeError):
        f.d0 = 1.0
