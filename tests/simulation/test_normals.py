"""Normal numbers in kernels: the inverse of the distribution function, one uniform number each."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ndtri
from scipy.stats import kstest

from ompl_risk._kernels import draws, normals


def test_quantiles_are_those_of_the_normal_distribution() -> None:
    tails = 2.0 ** -np.arange(2.0, 54.5, 0.25)
    p = np.concatenate([np.linspace(1e-4, 1 - 1e-4, 4001), tails, 1.0 - tails[tails > 2.0**-53]])
    out = np.empty_like(p)
    normals.quantiles(p, out)
    np.testing.assert_allclose(out, ndtri(p), rtol=2e-14, atol=1e-16)


@settings(deadline=None)  # the first call compiles
@given(st.integers(0, 2**64 - 1), st.integers(1, 50))
def test_each_takes_one_uniform_number_of_the_stream(seed: int, count: int) -> None:
    one, other = np.array([seed], np.uint64), np.array([seed], np.uint64)
    uniform, normal = np.empty(count), np.empty(count)
    draws.fill(one, uniform)
    normals.fill_normal(other, normal)
    assert one[0] == other[0]
    np.testing.assert_allclose(normal, ndtri(uniform + 2.0**-54), rtol=2e-14, atol=1e-15)


def test_a_long_stream_is_normal() -> None:
    out = np.empty(200_000)
    normals.fill_normal(np.array([3], np.uint64), out)
    assert kstest(out, "norm").pvalue > 1e-3
    lagged = out[1:] @ out[:-1] / len(out)
    assert abs(lagged) < 4.0 / np.sqrt(len(out))
