"""Dryden gusts: their covariances and spectra are those of the specification."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.signal import welch

from ompl_risk._kernels import draws, normals
from ompl_risk._kernels import gusts as kernels
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.gusts import X_CELL_DRAG, DrydenGusts

STATIONARY = np.array([[0.5, 0.25], [0.25, 0.25]])
SHARES = np.array([math.sqrt(3.0), 1.0 - math.sqrt(3.0)])
STEPS = st.floats(1e-7, 30.0)


def matrices(row: np.ndarray, at: int) -> tuple[np.ndarray, np.ndarray]:
    """Transition and added covariance of the two states of an axis."""
    keep, passed, r11, r21, r22 = row[at : at + 5]
    root = np.array([[r11, 0.0], [r21, r22]])
    return np.array([[keep, 0.0], [passed, keep]]), root @ root.T


def row(a: float) -> np.ndarray:
    """The row of a step of ``a`` time constants of the upward gusts, at 100 m."""
    return DrydenGusts(1e-3).filters([100.0], [100.0], [0.0], a)[0]


def blown(filters: np.ndarray, seed: int) -> np.ndarray:
    winds = np.empty((len(filters), 3))
    kernels.blow(filters, np.array([seed], np.uint64), np.empty(kernels.GUST), winds)
    return winds


def spectrum(k: float, length: float, order: int) -> float:
    """Of MIL-F-8785C, for unit variance, over wave numbers from 0."""
    x = (length * k) ** 2
    if order == 1:
        return 2.0 * length / math.pi / (1.0 + x)
    return length / math.pi * (1.0 + 3.0 * x) / (1.0 + x) ** 2


def test_scales_and_intensities_by_hand() -> None:
    gusts = DrydenGusts(15.0)
    level, upward = gusts.scales([200 * 0.3048])
    factor = 0.177 + 0.000823 * 200
    assert upward == pytest.approx(60.96)
    assert level == pytest.approx(200 / factor**1.2 * 0.3048)
    sigma, sigma_w = gusts.deviations([200 * 0.3048])
    assert sigma_w == pytest.approx(1.5)
    assert sigma == pytest.approx(1.5 / factor**0.4)


def test_at_1000_ft_turbulence_is_the_same_in_all_directions() -> None:
    gusts = DrydenGusts(10.0)
    level, upward = gusts.scales([304.8, 5000.0])
    np.testing.assert_allclose(level, upward, rtol=1e-12)
    np.testing.assert_array_equal(upward, 304.8)
    sigma, sigma_w = gusts.deviations([304.8, 5000.0])
    np.testing.assert_allclose(sigma, sigma_w, rtol=1e-12)


def test_below_10_ft_the_values_there_hold() -> None:
    low, ten = DrydenGusts(10.0).scales([0.0, -5.0]), DrydenGusts(10.0).scales([3.048, 3.048])
    np.testing.assert_array_equal(low, ten)


@given(STEPS)
def test_every_step_leaves_the_stationary_covariance(a: float) -> None:
    for at in (kernels.ACROSS, kernels.UP):
        phi, q = matrices(row(a), at)
        np.testing.assert_allclose(phi @ STATIONARY @ phi.T + q, STATIONARY, atol=1e-14)
    keep, drive = row(a)[kernels.ALONG : kernels.ALONG + 2]
    assert keep**2 + drive**2 == pytest.approx(1.0, abs=1e-14)


@given(st.floats(1e-4, 5.0))
def test_autocovariance_after_a_step_is_the_specified_one(a: float) -> None:
    phi, _ = matrices(row(a), kernels.UP)
    expected = math.exp(-a) * (1.0 - 0.5 * a)
    assert SHARES @ phi @ STATIONARY @ SHARES == pytest.approx(expected, abs=1e-13)


@given(STEPS)
def test_two_half_steps_are_one_step(a: float) -> None:
    whole, half = matrices(row(a), kernels.UP), matrices(row(0.5 * a), kernels.UP)
    np.testing.assert_allclose(half[0] @ half[0], whole[0], atol=1e-14)
    np.testing.assert_allclose(half[0] @ half[1] @ half[0].T + half[1], whole[1], atol=1e-14)


@pytest.mark.parametrize("s", [0.0, 0.3, 1.0, 2.0, 4.0])
def test_specified_autocovariances_are_the_transforms_of_the_spectra(s: float) -> None:
    for order, expected in ((1, math.exp(-s)), (2, math.exp(-s) * (1.0 - 0.5 * s))):
        if s == 0.0:
            found, _ = quad(spectrum, 0.0, math.inf, args=(1.0, order))
        else:
            found, _ = quad(spectrum, 0.0, math.inf, args=(1.0, order), weight="cos", wvar=s)
        assert found == pytest.approx(expected, abs=1e-7)


def test_a_step_of_the_kernel_is_the_recursion_of_its_rows() -> None:
    gusts = DrydenGusts(12.0)
    rows = gusts.filters([20.0, 40.0, 90.0], [30.0, 5.0, 15.0], [0.0, 1.0, 2.0], 0.7)
    normal = np.empty(20)
    normals.fill_normal(np.array([6], np.uint64), normal)
    along, pairs = normal[0], [np.linalg.cholesky(STATIONARY) @ normal[i : i + 2] for i in (1, 3)]
    winds = blown(rows, 6)
    for k, one in enumerate(rows):
        new = normal[5 * k + 5 : 5 * k + 10]
        along = one[kernels.ALONG] * along + one[kernels.ALONG + 1] * new[0]
        for i, at in enumerate((kernels.ACROSS, kernels.UP)):
            phi, q = matrices(one, at)
            pairs[i] = phi @ pairs[i] + np.linalg.cholesky(q) @ new[1 + 2 * i : 3 + 2 * i]
        u, v = one[kernels.LEVEL_SIGMA] * np.array([along, SHARES @ pairs[0]])
        c, s = math.cos(float(k)), math.sin(float(k))
        expected = [c * u - s * v, s * u + c * v, one[kernels.UP_SIGMA] * (SHARES @ pairs[1])]
        np.testing.assert_allclose(winds[k], expected, atol=1e-12)


def test_variances_and_autocovariances_of_many_starts() -> None:
    gusts, count, steps, dt = DrydenGusts(12.0), 6000, 81, 0.1
    rows = gusts.filters(np.full(steps, 40.0), np.full(steps, 20.0), np.zeros(steps), dt)
    winds = np.stack([blown(rows, 977 * k) for k in range(count)])
    (level,), (upward,) = gusts.scales([40.0])
    (sigma,), (sigma_w,) = gusts.deviations([40.0])
    error = 5.0 / math.sqrt(count)
    for lag in (0, 10, 40, 80):
        s = 20.0 * dt * lag
        found = (winds[:, 0] * winds[:, lag]).mean(axis=0) / np.array([sigma, sigma, sigma_w]) ** 2
        wanted = [
            math.exp(-s / level),
            math.exp(-s / level) * (1.0 - 0.5 * s / level),
            math.exp(-s / upward) * (1.0 - 0.5 * s / upward),
        ]
        np.testing.assert_allclose(found, wanted, atol=error * math.sqrt(2.0))


def test_axes_are_independent() -> None:
    rows = DrydenGusts(12.0).filters(np.full(41, 40.0), np.full(41, 20.0), np.zeros(41), 0.1)
    winds = np.stack([blown(rows, 31 * k + 5) for k in range(5000)])
    for i, j in ((0, 1), (0, 2), (1, 2)):
        for a, b in ((0, 0), (0, 40), (40, 0)):
            correlation = np.corrcoef(winds[:, a, i], winds[:, b, j])[0, 1]
            assert abs(correlation) < 4.5 / math.sqrt(5000)


def test_spectra_of_a_long_flight() -> None:
    n, dt, speed = 2**19, 0.1, 30.0
    gusts = DrydenGusts(10.0)
    rows = gusts.filters(np.full(n, 30.0), np.full(n, speed), np.zeros(n), dt)
    winds = blown(rows, 12)
    (level,), (upward,) = gusts.scales([30.0])
    (sigma,), (sigma_w,) = gusts.deviations([30.0])
    axes = ((0, 1, level, sigma), (1, 2, level, sigma), (2, 2, upward, sigma_w))
    for i, order, length, deviation in axes:
        f, found = welch(winds[:, i], 1.0 / dt, nperseg=2**12)
        for low, high in ((0.02, 0.05), (0.05, 0.12), (0.12, 0.3), (0.3, 0.6)):
            band = (f >= low) & (f < high)
            k = 2.0 * math.pi * f[band] / speed
            wanted = [deviation**2 * spectrum(x, length, order) * 2.0 * math.pi / speed for x in k]
            # some 255 half-overlapping segments; windows leak little over bands as wide as these
            tolerance = 5.0 / math.sqrt(0.5 * 255 * band.sum()) + 0.01
            assert np.mean(found[band]) == pytest.approx(np.mean(wanted), rel=tolerance)


def test_states_are_stationary_while_height_and_speed_change() -> None:
    n = 200
    rows = DrydenGusts(10.0).filters(
        np.geomspace(10.0, 300.0, n), np.linspace(35.0, 0.0, n), np.zeros(n), 0.2
    )
    p = STATIONARY
    for one in rows:
        phi, q = matrices(one, kernels.UP)
        p = phi @ p @ phi.T + q
    np.testing.assert_allclose(p, STATIONARY, atol=1e-13)


def test_a_jump_in_height_scales_the_gust_and_no_more() -> None:
    gusts = DrydenGusts(10.0)
    rows = gusts.filters([30.0, 300.0], [25.0, 25.0], [0.0, 0.0], 1e-9)
    before, after = blown(rows, 8)
    ratio = (gusts.deviations([300.0])[0] / gusts.deviations([30.0])[0])[0]
    np.testing.assert_allclose(after, before * [ratio, ratio, 1.0], atol=2e-3)


def test_the_first_axis_lies_along_the_flight() -> None:
    heights, speeds = np.full(50, 60.0), np.full(50, 20.0)
    east = blown(DrydenGusts(9.0).filters(heights, speeds, np.zeros(50), 0.1), 4)
    turned = blown(DrydenGusts(9.0).filters(heights, speeds, np.full(50, 0.7), 0.1), 4)
    c, s = math.cos(0.7), math.sin(0.7)
    np.testing.assert_allclose(turned[:, 0], c * east[:, 0] - s * east[:, 1], atol=1e-12)
    np.testing.assert_allclose(turned[:, 1], s * east[:, 0] + c * east[:, 1], atol=1e-12)
    np.testing.assert_array_equal(turned[:, 2], east[:, 2])


def test_past_a_vehicle_that_hovers_the_wind_carries_the_gusts() -> None:
    gusts = DrydenGusts(9.0)
    hovering, slow = gusts.filters([50.0] * 3, [0.0, 9.0, 9.1], [0.0] * 3, 0.1)[:2]
    np.testing.assert_array_equal(hovering, slow)
    assert gusts.filters([50.0], [9.1], [0.0], 0.1)[0, 0] < slow[0]


@settings(deadline=None)  # the first call compiles
@given(st.integers(1, 30), st.integers(0, 2**64 - 1))
def test_a_step_draws_five_numbers(steps: int, seed: int) -> None:
    rows = DrydenGusts(9.0).filters([50.0] * steps, [20.0] * steps, [0.0] * steps, 0.1)
    one, other = np.array([seed], np.uint64), np.array([seed], np.uint64)
    kernels.blow(rows, one, np.empty(kernels.GUST), np.empty((steps, 3)))
    draws.fill(other, np.empty(5 * (steps + 1)))
    assert one[0] == other[0]


def test_default_drag_follows_from_the_published_model() -> None:
    rho, speed, mass = 1.225, 20.0, 8.2

    def thrust_by_flow(tip, radius, a, sigma, eta):
        mu = speed / tip
        change = 0.25 * a * sigma / (1.0 + a * sigma / (8.0 * eta * mu))
        return rho * tip * math.pi * radius**2 * change

    tip, radius, a = 167.0 * 0.775, 0.775, 5.5
    sigma = 2.0 * 0.058 / (math.pi * radius)
    mu, disk = speed / tip, math.pi * radius**2
    c_t = mass * 9.81 / (rho * tip**2 * disk)
    inflow = c_t / (2.0 * 0.9 * mu)
    collective = (2.0 * c_t / (a * sigma) + 0.5 * inflow) / (1.0 / 3.0 + 0.5 * mu**2)
    backward = 2.0 * 0.2 * (4.0 / 3.0 * collective - inflow) * mass * 9.81 / tip
    forward = rho * 0.10 * speed + backward
    fin = 1.0 - 0.75 * 0.012 / (math.pi * 0.13**2)
    tail = thrust_by_flow(167.0 * 4.66 * 0.13, 0.13, 5.0, 2.0 * 0.029 / (math.pi * 0.13), 0.9)
    sideways = 0.5 * rho * speed * (0.22 + 0.012 * 2.0) + fin * tail
    main = thrust_by_flow(tip, radius, a, sigma, 0.9)
    upward = 0.5 * rho * speed * (0.15 + 0.01 * 3.0) + main
    np.testing.assert_allclose(X_CELL_DRAG, (forward, sideways, upward), rtol=0.02)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((0.0,), "wind_at_6m"),
        ((math.nan,), "wind_at_6m"),
        ((5.0, (1.0, 1.0)), "drag"),
        ((5.0, (1.0, -1.0, 1.0)), "drag"),
    ],
)
def test_gusts_that_are_none(arguments: tuple, name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        DrydenGusts(*arguments)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (([math.inf], [1.0], [0.0], 0.1), "heights"),
        (([1.0], [1.0, 2.0], [0.0], 0.1), "speeds"),
        (([1.0], [-1.0], [0.0], 0.1), "speeds"),
        (([1.0], [1.0], [math.nan], 0.1), "headings"),
        (([1.0], [1.0], [0.0], 0.0), "dt"),
    ],
)
def test_plans_that_are_none(arguments: tuple, name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        DrydenGusts(5.0).filters(*arguments)


def test_drag_of_the_vehicle_and_read_only_rows() -> None:
    assert DrydenGusts(5.0, None).drag is None
    rows = DrydenGusts(5.0).filters([50.0], [20.0], [0.0], 0.1)
    assert rows.shape == (1, kernels.FILTER)
    assert not rows.flags.writeable
