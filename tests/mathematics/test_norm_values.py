"""Norms against closed forms, exact rational integrals and refinement."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.norms import Lp, Sobolev

T_GAUSS = np.linspace(-9.0, 9.0, 4001)
GAUSS = np.exp(-(T_GAUSS**2) / 2) / math.sqrt(2 * math.pi)


@pytest.mark.parametrize("p", [1, 1.5, 2, 3, 7.25, 50, math.inf])
def test_step_function_of_the_paper(p):
    """|h| w^(1/p), example after equation (4)."""
    assert Lp(p)([2.0, 2.5, 6.0], [-3.0, -3.0, -3.0]) == pytest.approx(
        3.0 * 4.0 ** (1 / p), rel=1e-15
    )


@pytest.mark.parametrize("p", [1, 1.5, 2, 3, 10])
def test_gaussian_lp(p):
    power = (2 * math.pi) ** (-p / 2) * math.sqrt(2 * math.pi / p)
    assert Lp(p)(T_GAUSS, GAUSS) == pytest.approx(power ** (1 / p), rel=1e-5)


def test_gaussian_sobolev():
    """Integrals of g^2, g'^2, g''^2: 1, 1/2 and 3/4 times 1 / (2 sqrt(pi))."""
    zero, one, two = np.array([1, 1 / 2, 3 / 4]) / (2 * math.sqrt(math.pi))
    tau = 0.7
    at_tau = [Sobolev(k, time_scale=tau).power(T_GAUSS, GAUSS) for k in (0, 1, 2)]
    expected = [zero, zero + tau**2 * one, zero + tau**2 * one + tau**4 * two]
    np.testing.assert_allclose(at_tau, expected, rtol=2e-5)


values = st.one_of(
    st.floats(-100, 100), st.just(0.0), st.builds(lambda e: 1.0 + e, st.floats(0, 1e-9))
)


@given(st.integers(1, 12), values, values, st.floats(1e-3, 10))
def test_lp_of_a_straight_piece_against_rational_arithmetic(p, a, b, dt):
    """The antiderivative of |f|^p without rounding, where cancellation is at its worst too."""
    a, b = (0.0 if abs(x) < 1e-12 else x for x in (a, b))

    def antiderivative(x):
        return (1 if x > 0 else -1) * abs(x) ** (p + 1) / (p + 1)

    fa, fb = Fraction(a), Fraction(b)
    mean = abs(fa) ** p if a == b else (antiderivative(fb) - antiderivative(fa)) / (fb - fa)
    assert Lp(p).power([0.0, dt], [a, b]) == pytest.approx(float(Fraction(dt) * mean), rel=1e-13)


def test_sobolev_zero_is_l2():
    t, f = [0.0, 0.3, 2.0], [1.0, -2.0, 0.5]
    assert Sobolev(0)(t, f) == pytest.approx(Lp(2)(t, f), rel=1e-15)


def test_first_order_sobolev_of_a_straight_piece():
    """Integral of (1 + 2 t / 3)^2 over [0, 3] is 13, plus tau^2 times 3 (2/3)^2."""
    norm = Sobolev(1, time_scale=0.5)
    assert norm.power([0.0, 3.0], [1.0, 3.0]) == pytest.approx(13 + 0.25 * 4 / 3, rel=1e-15)


def test_second_derivative_of_a_parabola_is_exact():
    """f = t^2 on [0, 1]: the integral of f''^2 is 4 on any grid; third differences vanish."""
    for n in (3, 4, 11):
        t = np.linspace(0, 1, n)
        extra = Sobolev(2).power(t, t**2) - Sobolev(1).power(t, t**2)
        assert extra == pytest.approx(4.0, rel=1e-11)
        if n > 3:
            assert Sobolev(3).power(t, t**2) == pytest.approx(Sobolev(2).power(t, t**2), rel=1e-9)


def _orders(norm, f, exact, counts):
    errors = [abs(norm.power(t, f(t)) - exact) for t in (np.linspace(0, 1, n) for n in counts)]
    return np.diff(np.log(errors)) / -np.diff(np.log(np.array(counts) - 1))


@pytest.mark.parametrize(
    ("norm", "exact"),
    [
        (Lp(1), math.e - 1),
        (Lp(2), (math.e**2 - 1) / 2),
        (Lp(3.5), (math.exp(3.5) - 1) / 3.5),
        (Sobolev(1), math.e**2 - 1),
        (Sobolev(2), (math.e**2 - 1) * 3 / 2),
        (Sobolev(3), (math.e**2 - 1) * 2),
    ],
)
def test_refinement_converges_with_the_square_of_the_step(norm, exact):
    """f = exp(t) on [0, 1], which does not vanish at the ends."""
    np.testing.assert_allclose(_orders(norm, np.exp, exact, [33, 65, 129]), 2.0, atol=0.1)


@pytest.mark.parametrize("weight", ["angular", "hertz"])
@pytest.mark.parametrize("k", [0, 0.5, 1, 2.5])
@pytest.mark.parametrize("mode", [0, 1, 5, 20])
def test_fourier_form_of_a_cosine(weight, k, mode):
    """One line of the cosine series: T/2 (1 + (w tau xi)^2)^k with xi = mode / (2 T)."""
    T, tau = 3.0, 0.4
    t = np.linspace(0, T, 21)
    w = 2 * math.pi if weight == "angular" else 1.0
    energy = T if mode == 0 else T / 2
    expected = energy * (1 + (w * tau * mode / (2 * T)) ** 2) ** k
    norm = Sobolev(k, time_scale=tau, form="fourier", weight=weight)
    assert norm.power(t, np.cos(math.pi * mode * t / T)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("n", [2, 3, 8, 17])
def test_fourier_powers_add_up_as_parseval_says(n):
    """Coefficients by solving for the cosine series, not by a transform."""
    f = np.random.default_rng(n).normal(size=n)
    t = np.linspace(1.0, 4.0, n)
    modes = np.arange(n)
    c = np.linalg.solve(np.cos(np.pi * np.outer((t - 1) / 3, modes)), f)
    energy = 3.0 * c**2 * np.where(modes == 0, 1, 0.5)
    expected = np.sum(energy * (1 + (2 * np.pi * modes / 6) ** 2) ** 1.5)
    norm = Sobolev(1.5, form="fourier")
    assert norm.power(t, f) == pytest.approx(expected, rel=1e-10)
    assert norm.shares(t, f).sum() == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("f", [np.exp, lambda t: np.maximum(0, 0.3 - np.abs(t - 0.6))])
def test_fourier_form_tends_to_the_derivative_form(f):
    """At k = 1 with the angular weight, for slopes at the ends and for kinks."""
    differences = []
    for n in (101, 401, 1601):
        t = np.linspace(0, 1, n)
        exact = Sobolev(1, time_scale=0.3)(t, f(t))
        differences.append(abs(Sobolev(1, time_scale=0.3, form="fourier")(t, f(t)) / exact - 1))
    assert differences[2] < 1e-3
    assert differences[0] > 3 * differences[1] > 9 * differences[2]


def test_the_papers_weight_is_equivalent_and_smaller():
    t = np.linspace(0, 1, 201)
    f = np.exp(t)
    angular, hertz = (Sobolev(1, form="fourier", weight=w)(t, f) for w in ("angular", "hertz"))
    assert hertz < 0.9 * angular
    assert angular <= 2 * math.pi * hertz


@pytest.mark.parametrize("n", [11, 101, 1001])
def test_a_constant_has_no_derivative_whatever_the_grid(n):
    """A function cut off by zero would jump at the ends, and its norm grow with n."""
    t = np.linspace(0, 4, n)
    for norm in (Sobolev(1), Sobolev(1, form="fourier"), Sobolev(2)):
        assert norm(t, np.full(n, 3.0)) == pytest.approx(6.0, rel=1e-12)


@pytest.mark.parametrize(("k", "exists"), [(0, True), (1, True), (2, False)])
def test_grid_sensitivity_tells_whether_a_kinked_f_has_the_norm(k, exists):
    def sensitivity(n):
        t = np.linspace(0, 1, n)
        return Sobolev(k).grid_sensitivity(t, np.maximum(0, 0.31 - np.abs(t - 0.47)))

    if exists:
        assert sensitivity(1601) < 1e-3
    else:
        # f'' is a spike of area 1 and height 1/dt: halving the step multiplies the norm by sqrt 2.
        assert sensitivity(1601) == pytest.approx(1 - 1 / math.sqrt(2), abs=0.1)
        assert sensitivity(6401) == pytest.approx(1 - 1 / math.sqrt(2), abs=0.1)


def test_grid_sensitivity_of_zero_and_of_an_even_count():
    assert Lp(2).grid_sensitivity([0.0, 1.0, 2.0], [0.0, 0.0, 0.0]) == 0.0
    # Without the last sample: 0, 1, 0 against 0, 0.
    assert Lp(1).grid_sensitivity([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 0.0, 9.0]) == 1.0
