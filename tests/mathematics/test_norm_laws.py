"""Norm axioms and scaling laws, and what norms refuse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Norm, Sobolev

exponents = st.one_of(st.floats(1, 20), st.sampled_from([1.0, 2.0, math.inf]))
any_grid = st.one_of(
    st.builds(Lp, exponents),
    st.builds(
        lambda k, tau: Sobolev(k, time_scale=tau), st.sampled_from([0, 1]), st.floats(0.1, 9)
    ),
)
equal_steps = st.one_of(
    st.builds(Sobolev, st.sampled_from([2, 3])),
    st.builds(
        lambda k, w: Sobolev(k, form="fourier", weight=w),
        st.floats(0, 2),
        st.sampled_from(["angular", "hertz"]),
    ),
)
value = st.one_of(st.floats(-100, 100), st.sampled_from([0.0, 1.0, -1.0])).map(
    lambda x: 0.0 if abs(x) < 1e-9 else x
)


@st.composite
def cases(draw, functions=1):
    """A norm, times it can take, and functions on them."""
    norm = draw(st.one_of(any_grid, equal_steps))
    n = draw(st.integers(4, 12))
    if norm.needs_uniform_times:
        t = draw(st.floats(-5, 5)) + draw(st.floats(0.1, 3)) * np.arange(n)
    else:
        t = np.cumsum(draw(st.lists(st.floats(0.1, 3), min_size=n, max_size=n)))
    rows = st.lists(value, min_size=n, max_size=n)
    return norm, t, *(np.array(draw(rows)) for _ in range(functions))


@given(cases(functions=2))
def test_triangle_inequality(case):
    norm, t, f, g = case
    assert norm(t, f + g) <= (norm(t, f) + norm(t, g)) * (1 + 1e-12)


@given(cases(), st.floats(-1e3, 1e3).filter(lambda c: abs(c) > 1e-3))
def test_homogeneity(case, c):
    norm, t, f = case
    assert norm(t, c * f) == pytest.approx(abs(c) * norm(t, f), rel=1e-12)


@given(cases())
def test_positive_unless_zero(case):
    norm, t, f = case
    assert norm(t, f) >= 0
    assert (norm(t, f) == 0) == (not f.any())
    assert norm(t, 0 * f) == norm.power(t, 0 * f) == norm.shares(t, 0 * f).sum() == 0


@given(cases())
def test_shares_add_up_to_the_power_and_the_power_is_the_norms(case):
    norm, t, f = case
    power, shares = norm.power(t, f), norm.shares(t, f)
    assert shares.shape == (len(t) - 1,)
    assert (shares >= 0).all()
    assert shares.sum() == pytest.approx(power, rel=1e-12)
    degree = 1 if math.isinf(norm.exponent) else norm.exponent
    assert norm(t, f) ** degree == pytest.approx(power, rel=1e-12)


@given(cases(), st.floats(-50, 50))
def test_time_shift_and_reversal_change_nothing(case, shift):
    norm, t, f = case
    assert norm(t + shift, f) == pytest.approx(norm(t, f), rel=1e-9)
    assert norm(-t[::-1], f[::-1]) == pytest.approx(norm(t, f), rel=1e-12)


@given(cases(), st.floats(0.1, 10))
def test_time_scaling(case, c):
    """||f(. / c)|| with tau c is c^(1/p) ||f|| with tau."""
    norm, t, f = case
    slower = norm
    if isinstance(norm, Sobolev):
        slower = Sobolev(norm.k, time_scale=c * norm.time_scale, form=norm.form, weight=norm.weight)
    assert slower(c * t, f) == pytest.approx(c ** (1 / norm.exponent) * norm(t, f), rel=1e-10)


@given(cases(), st.data())
def test_power_adds_up_over_concatenation(case, data):
    norm, t, f = case
    if norm.needs_uniform_times:  # these look across the border
        norm = Sobolev(1)
    m = data.draw(st.integers(1, len(t) - 2))
    parts = norm.power(t[: m + 1], f[: m + 1]), norm.power(t[m:], f[m:])
    joined = max(parts) if math.isinf(norm.exponent) else sum(parts)
    assert norm.power(t, f) == pytest.approx(joined, rel=1e-12)


@given(cases())
def test_lp_tends_to_the_maximum_as_p_grows(case):
    _, t, f = case
    peak, duration = Lp(math.inf)(t, f), t[-1] - t[0]
    means = [Lp(p)(t, f) / duration ** (1 / p) for p in (1, 2, 8, 64, 1024)]
    assert all(a <= b * (1 + 1e-12) for a, b in zip(means, [*means[1:], peak], strict=True))
    assert Lp(1e7)(t, f) == pytest.approx(peak, rel=1e-5)
    assert peak == np.abs(f).max()


@pytest.mark.parametrize("scale", [1e-290, 1e290])
@pytest.mark.parametrize("norm", [Lp(7), Sobolev(1), Sobolev(1, form="fourier"), Sobolev(2)])
def test_no_overflow_on_the_way(norm, scale):
    t, f = np.arange(5.0), np.array([0.0, 1.0, 3.0, -2.0, 1.0])
    assert norm(t, scale * f) == pytest.approx(scale * norm(t, f), rel=1e-12)


def test_maximum_is_shared_by_the_intervals_that_touch_it():
    shares = Lp(math.inf).shares([0, 1, 2, 3, 4], [0.0, 5.0, 1.0, 0.0, -5.0])
    np.testing.assert_allclose(shares, [5 / 3, 5 / 3, 0, 5 / 3])


@pytest.mark.parametrize("norm", [Lp(1), Lp(math.inf), Sobolev(1), Sobolev(1, form="fourier")])
def test_an_infinite_sample_makes_the_norm_infinite(norm):
    t, f = np.arange(4.0), [0.0, math.inf, 1.0, 2.0]
    assert norm(t, f) == norm.power(t, f) == math.inf
    assert norm(t, np.negative(f)) == math.inf
    np.testing.assert_array_equal(norm.shares(t, f), [math.inf, math.inf, 0])


@pytest.mark.parametrize(
    ("t", "f", "words"),
    [
        ([0, 1], [1.0, math.nan], r"f\[1\] = nan"),
        ([0, 1], [1.0, 2.0, 3.0], r"f.shape = \(3,\): must be \(2,\)"),
        ([0], [1.0], r"t.shape = \(1,\)"),
        ([[0, 1]], [[1.0, 2.0]], r"t.shape = \(1, 2\)"),
        ([0, 1, 1], [1.0, 2.0, 3.0], r"t\[2\] = 1.0: must be greater"),
        ([0, 2, 1], [1.0, 2.0, 3.0], r"t\[2\] = 1.0: must be greater than .* 2.0"),
        ([0, math.inf], [1.0, 2.0], r"t\[1\] = inf: must be finite"),
        ([0, 1], ["a", "b"], "array of real numbers"),
    ],
)
def test_samples_that_are_refused(t, f, words):
    for call in (Lp(2), Sobolev(1).power, Lp(1).shares, Lp(1).grid_sensitivity):
        with pytest.raises(ArgumentError, match=words):
            call(t, f)


@pytest.mark.parametrize("norm", [Sobolev(2), Sobolev(0.5, form="fourier")])
def test_unequal_steps_name_the_way_out(norm):
    with pytest.raises(ArgumentError, match=r"steps from 1 to 2 s.*resample"):
        norm([0, 1, 3, 4], [1.0, 2.0, 3.0, 4.0])


def test_rounded_and_absolute_times_count_as_equal_steps():
    f = np.arange(100.0) % 7
    for t in (np.arange(100) * 0.1, np.cumsum(np.full(100, 0.1)), 1.7e9 + 0.01 * np.arange(100)):
        assert Sobolev(2)(t, f) > 0


def test_derivative_needs_samples():
    with pytest.raises(ArgumentError, match=r"len\(f\) = 3: must be at least 4"):
        Sobolev(3)([0, 1, 2], [1.0, 2.0, 3.0])


def test_grid_sensitivity_refuses_what_has_none():
    with pytest.raises(ArgumentError, match="at least 3"):
        Lp(1).grid_sensitivity([0, 1], [1.0, 2.0])
    with pytest.raises(ArgumentError, match="finite"):
        Lp(1).grid_sensitivity([0, 1, 2], [1.0, math.inf, 2.0])


@pytest.mark.parametrize("p", [0.99, 0, -1, -math.inf, math.nan, "2", None, True, 2j])
def test_p_must_be_a_real_of_at_least_one(p):
    with pytest.raises(ArgumentError, match=r"p = .*at least 1"):
        Lp(p)


@pytest.mark.parametrize(
    ("k", "options", "words"),
    [
        (-1, {}, "k = -1: must be a whole number"),
        (1.5, {}, "k = 1.5: must be a whole number"),
        (math.inf, {}, "k = inf"),
        (math.nan, {}, "k = nan"),
        (-0.5, {"form": "fourier"}, "k = -0.5: must be a real number >= 0"),
        (math.inf, {"form": "fourier"}, "k = inf"),
        (1, {"time_scale": 0.0}, "time_scale = 0.0"),
        (1, {"time_scale": math.inf}, "time_scale = inf"),
        (1, {"form": "wavelet"}, "form = 'wavelet'"),
        (1, {"form": "fourier", "weight": "rpm"}, "weight = 'rpm'"),
        (1, {"weight": "hertz"}, "weight = 'hertz'"),
    ],
)
def test_parameters_that_sobolev_refuses(k, options, words):
    with pytest.raises(ArgumentError, match=words):
        Sobolev(k, **options)


@pytest.mark.parametrize(
    ("norm", "label", "exponent"),
    [
        (Lp(1), "L1", 1),
        (Lp(2.5), "L2.5", 2.5),
        (Lp(math.inf), "L∞", math.inf),
        (Sobolev(1), "H1", 2),
        (Sobolev(), "H1", 2),
        (Sobolev(2), "H2", 2),
        (Sobolev(1, time_scale=0.5), "H1(τ=0.5 s)", 2),
        (Sobolev(1.5, form="fourier"), "H1.5(Fourier)", 2),
        (
            Sobolev(1, form="fourier", weight="hertz", time_scale=2),
            "H1(Fourier, Hz, τ=2 s)",
            2,
        ),
    ],
)
def test_labels_and_exponents(norm, label, exponent):
    assert norm.label == label
    assert norm.exponent == exponent
    assert isinstance(norm, Norm)


def test_equal_and_hashed_by_parameters():
    assert Lp(2) == Lp(2.0)
    assert Lp(2) != Lp(3)
    assert Sobolev(1) == Sobolev(1.0, time_scale=1)
    assert Sobolev(1) != Sobolev(1, time_scale=2)
    assert len({Lp(2), Lp(2.0), Sobolev(1), Sobolev(1), Sobolev(1, form="fourier")}) == 3
    with pytest.raises(AttributeError):
        Lp(2).p = 3
