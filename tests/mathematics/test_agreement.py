import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.ranking.agreement import agreement, kendall_tau

numbers = st.one_of(st.integers(0, 4).map(float), st.just(math.inf))
pairs = st.integers(1, 7).flatmap(
    lambda n: st.tuples(*[st.lists(numbers, min_size=n, max_size=n)] * 2)
)


def compare(x, y):
    return (x > y) - (x < y)


@given(pairs)
def test_against_counting_pairs(values):
    """tau-b = (concordant - discordant) / sqrt(pairs not tied in a * pairs not tied in b)."""
    a, b = values
    signs = [(compare(a[i], a[j]), compare(b[i], b[j])) for i, j in combinations(range(len(a)), 2)]
    product = sum(x * y for x, y in signs)
    loose_a, loose_b = sum(x != 0 for x, _ in signs), sum(y != 0 for _, y in signs)
    if loose_a and loose_b:
        expected = product / math.sqrt(loose_a * loose_b)
    else:
        expected = float(loose_a == loose_b)
    assert kendall_tau(a, b) == pytest.approx(expected, abs=1e-12)


def test_nearly_equal_values_are_no_ties():
    assert kendall_tau([1.0, 1.0 + 1e-15, 2.0], [1.0, 2.0, 3.0]) == 1.0


def test_matrix_is_labelled_by_rows_and_columns():
    found = agreement({"L1": [1, 2, 3], "H1": [3, 2, 1]}, {"P": [1, 2, 3]})
    assert (found.rows, found.columns) == (("L1", "H1"), ("P",))
    np.testing.assert_array_equal(found.tau, [[1.0], [-1.0]])
    assert found["H1", "P"] == -1.0
    with pytest.raises(ValueError, match="read-only"):
        found.tau[0] = 0
