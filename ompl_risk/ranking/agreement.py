"""How far two sets of norms agree on an order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ompl_risk._arrays import FloatArray, ReadOnlyArrays


@dataclass(frozen=True, eq=False)
class Agreement(ReadOnlyArrays):
    """Kendall's tau-b between the norms of the rows and those of the columns.

    1: the same order, -1: the reverse order, 0: none. Ties count as tau-b does; infinite norms
    are tied with each other and greater than all finite ones. Where a norm ties all
    trajectories tau-b is undefined; here it is then 1 if the other ties them all too, else 0. So
    there is no NaN.

    Args:
        rows: labels of the rows.
        columns: labels of the columns.
        tau: tau-b, shape (rows, columns).
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    tau: FloatArray

    def __getitem__(self, labels: tuple[str, str]) -> float:
        """Tau-b of a row's norm and a column's: agreement["L2", "H1"]."""
        row, column = labels
        return float(self.tau[self.rows.index(row), self.columns.index(column)])


def agreement(
    rows: Mapping[str, Sequence[float]], columns: Mapping[str, Sequence[float]]
) -> Agreement:
    """Compare each row's values with each column's.

    Args:
        rows: label to one value a trajectory.
        columns: label to one value a trajectory, in the same order.
    """
    tau = np.array([[kendall_tau(a, b) for b in columns.values()] for a in rows.values()])
    tau.setflags(write=False)
    return Agreement(tuple(rows), tuple(columns), tau)


def kendall_tau(a: Sequence[float], b: Sequence[float]) -> float:
    """Kendall's tau-b, defined for values that are all tied too; see `Agreement`."""
    tied_a, tied_b = len(set(a)) <= 1, len(set(b)) <= 1
    if tied_a or tied_b:
        return float(tied_a and tied_b)
    import scipy.stats  # slow to import, and not everybody ranks

    ranks = (scipy.stats.rankdata(values, method="dense") for values in (a, b))
    result: Any = scipy.stats.kendalltau(*ranks, variant="b")
    return float(result.statistic)
