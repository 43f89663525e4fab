import copy
import math
import pickle
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, stats

from ompl_risk.avoidance import (
    Avoidance,
    FlatCap,
    GaussianTail,
    InverseDistance,
    checked_distance,
)
from ompl_risk.avoidance.compiled import compiled_form, is_compiled
from ompl_risk.errors import ArgumentError

f = InverseDistance(d0=100.0)
distances = st.floats(1e-6, 1e6)
lengths = st.floats(0.1, 1e4)
functions = st.one_of(
    st.builds(InverseDistance, lengths),
    st.builds(FlatCap, lengths),
    st.builds(GaussianTail, lengths),
    st.builds(lambda sigma, part: GaussianTail(sigma, d0=part * sigma), lengths, st.floats(0.5, 9)),
)
SOME = [InverseDistance(40.0), FlatCap(40.0), GaussianTail(10.0), GaussianTail(10.0, d0=15.0)]
each = pytest.mark.parametrize("g", SOME, ids=repr)


# laws of every avoidance function


@each
@pytest.mark.parametrize("d", [0.0, -0.0, -1e-300, -5.0, -math.inf])
def test_touching_and_inside_is_infinite(g, d):
    assert g(d) == math.inf
    assert g.derivative(d) == -math.inf


@each
def test_shape_is_kept(g):
    for function in (g, g.derivative):
        assert function(np.full((2, 3), 5.0)).shape == (2, 3)
        assert function(5.0).shape == ()
        assert function(5.0).dtype == np.float64
        assert function([]).shape == (0,)


@given(functions, distances, distances)
def test_never_increases_with_distance(g, a, b):
    near, far = sorted((a, b))
    assert g(near) >= g(far) >= 0


@given(functions, st.floats(1.0, 1e3))
def test_is_zero_from_d0_on(g, part):
    assert g(part * g.d0) == g(math.inf) == 0.0
    assert g.derivative(part * g.d0) == g.derivative(math.inf) == 0.0


@given(functions, st.floats(1e-3, 1.0))
def test_is_continuous_up_to_d0(g, part):
    d = part * g.d0
    assert g(d * (1 - 1e-12)) - g(d) <= 1e-11 * (g(d) + g.typical) / part


@given(functions, st.floats(1e-3, 0.999), st.floats(1e-3, 0.999), st.floats(0, 1))
def test_is_convex_as_lower_bounds_take_it_to_be(g, a, b, share):
    a, b = a * g.d0, b * g.d0
    between = g(a + share * (b - a))
    assert between <= (1 - share) * g(a) + share * g(b) + 1e-12 * g(min(a, b))


@given(functions, st.floats(0.02, 0.98))
def test_derivative_against_central_differences(g, part):
    d = part * g.d0
    h = 1e-5 * d
    slope = (g(d + h) - g(d - h)) / (2 * h)
    # The quotient itself errs by (h/d)^2, and by rounding of what f is the difference of, over h.
    rounding = 1e-16 * (0.5 if g.steady else 1 / d) / h
    assert g.derivative(d) == pytest.approx(slope, rel=1e-7, abs=10 * rounding)


@each
def test_nan_and_words_are_refused(g):
    with pytest.raises(ArgumentError, match="d = nan"):
        g([1.0, math.nan])
    with pytest.raises(ArgumentError, match="array of real numbers"):
        g("near")
    with pytest.raises(ArgumentError, match="array of real numbers"):
        g.derivative([1j])


@each
def test_no_distance_warns(g):
    d = [5e-324, 1e-300, 1e300, math.inf]
    assert g(d)[0] == (math.inf if g.steady is None else pytest.approx(0.5, abs=0.07))
    assert (g.derivative(d) <= 0.0).all()


@each
def test_equal_by_parameters_frozen_and_fit_to_be_sent(g):
    assert isinstance(g, Avoidance)
    for same in (copy.deepcopy(g), pickle.loads(pickle.dumps(g))):
        assert same == g
        assert hash(same) == hash(g)
        assert same(7.0) == g(7.0)
    assert sum(other == g for other in SOME) == 1
    with pytest.raises(AttributeError):
        g.d0 = 1.0


@each
def test_what_is_typical_is_f_half_way_to_d0(g):
    assert g.typical == pytest.approx(float(g(0.5 * g.d0)), rel=1e-12)


# the paper's


def test_values_of_equation_3():
    d = [50.0, 25.0, 99.0, 100.0, 101.0, math.inf]
    np.testing.assert_allclose(f(d), [0.01, 0.03, 1 / 99 - 0.01, 0, 0, 0], rtol=1e-15)


@pytest.mark.parametrize("d0", [0.0, -1.0, math.inf, math.nan, "100", None, True])
def test_d0_must_be_positive_and_finite(d0):
    with pytest.raises(ArgumentError, match=r"d0 = .*positive finite"):
        InverseDistance(d0)


def test_the_paper_s_d0_is_the_default():
    assert InverseDistance() == f
    assert InverseDistance(100) == f


# the ball's cap


@pytest.mark.parametrize("d", [0.5, 10.0, 39.0])
def test_the_cap_is_the_share_of_the_ball_behind_a_plane(d):
    """The sum of disks of radius sqrt(r^2 - z^2)."""
    r = 40.0
    volume = integrate.quad(lambda z: math.pi * (r * r - z * z), d, r)[0]
    assert FlatCap(r)(d) == pytest.approx(volume / (4 / 3 * math.pi * r**3), rel=1e-12)


def test_the_cap_ends_at_the_radius():
    assert FlatCap(40.0).d0 == 40.0
    assert FlatCap(40.0).steady == 20.0
    assert repr(FlatCap(40.0)) == "FlatCap(r=40.0)"
    assert FlatCap() == FlatCap(100.0)


@pytest.mark.parametrize("r", [0.0, -1.0, math.inf, math.nan, "100", None, True])
def test_the_radius_must_be_positive_and_finite(r):
    with pytest.raises(ArgumentError, match=r"r = .*positive finite"):
        FlatCap(r)


# the tail


@pytest.mark.parametrize("d", [0.1, 10.0, 25.0, 39.9])
def test_the_tail_is_the_probability_that_the_error_exceeds_the_distance(d):
    """But for what of the tail lies beyond d0."""
    expected = stats.norm.sf(d, scale=10.0) - stats.norm.sf(40.0, scale=10.0)
    assert GaussianTail(10.0)(d) == pytest.approx(expected, rel=1e-11)
    nearer = stats.norm.sf(d, scale=10.0) - stats.norm.sf(15.0, scale=10.0)
    assert GaussianTail(10.0, d0=15.0)(d) == pytest.approx(max(nearer, 0.0), rel=1e-11)


def test_the_tail_ends_at_four_deviations():
    g = GaussianTail(10.0)
    assert g.d0 == 40.0
    assert g == GaussianTail(10.0, d0=40.0)
    assert g.steady == 10.0
    assert GaussianTail(10.0, d0=15.0).steady == 7.5
    assert g.offset == pytest.approx(stats.norm.sf(4.0))


@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, math.nan, "100", True])
def test_sigma_and_d0_must_be_positive_and_finite(value):
    with pytest.raises(ArgumentError, match=r"sigma = .*positive finite"):
        GaussianTail(value)
    with pytest.raises(ArgumentError, match=r"d0 = .*positive finite"):
        GaussianTail(1.0, d0=value)


# others


@dataclass(frozen=True)
class Step(Avoidance):
    """1 at less than a tenth of d0, if it is not 0 everywhere."""

    d0: float = 20.0
    height: float = 1.0

    def __call__(self, d):
        d = checked_distance(d)
        return np.where(d <= 0, np.inf, np.where(d < 0.1 * self.d0, self.height, 0.0))

    def derivative(self, d):
        return np.where(checked_distance(d) <= 0, -np.inf, 0.0)


def test_what_is_typical_is_positive():
    assert Step().typical == 1.0
    assert Step(height=7.0).typical == 7.0
    assert Step(height=0.0).typical == 1.0


def test_only_what_kernels_compute_is_known_to_them():
    class Derived(FlatCap):
        """Might compute anything."""

    for g in SOME:
        form = compiled_form(g)
        assert is_compiled(g)
        assert form is not None
        assert form[0] == g.d0
        assert not form.flags.writeable
    for g in (Step(), Derived(3.0)):
        assert not is_compiled(g)
        assert compiled_form(g) is None
