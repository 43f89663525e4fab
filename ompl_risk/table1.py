"""Table I of the paper: four avoidance functions, printed norms and ours."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from ompl_risk._arrays import FloatArray, as_floats, positive
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Norm, Sobolev

CURVES = ("A", "B", "C", "D")
NORMS: tuple[Norm, ...] = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))
PRINTED = {
    "A": {"L1": 10.0, "L2": 0.5, "L∞": 0.4, "H1": 4.2},
    "B": {"L1": 20.0, "L2": 0.8, "L∞": 0.4, "H1": 8.4},
    "C": {"L1": 11.1, "L2": 0.8, "L∞": 0.8, "H1": 17.5},
    "D": {"L1": 10.0, "L2": 0.7, "L∞": 0.8, "H1": 37.8},
}
"""The table as printed, one decimal."""

EXPLANATION = (
    "L2 and L∞ are the norms. The printed L1 column is 10 times the L1 norm and the printed H1 "
    "column 10 times the squared H1 norm: sums over samples 0.1 s apart, without the step, and "
    "for H1 without the root. The orders by each norm are not affected."
)


@dataclass(frozen=True)
class Row:
    """One entry of the table.

    Args:
        curve: "A" to "D".
        norm: label of the norm.
        printed: the figure in the paper.
        ours: the norm of the curve.
        reconstructed: what the paper must have computed, from `ours`.
    """

    curve: str
    norm: str
    printed: float
    ours: float
    reconstructed: float

    @property
    def agrees(self) -> bool:
        """Whether the reconstruction rounds to the printed figure, which has one decimal."""
        return round(self.reconstructed, 1) == self.printed


@dataclass(frozen=True)
class Table1:
    """The printed table, our norms and what links them.

    Args:
        rows: the entries, norm by norm.
        explanation: how the printed figures come from the norms.
    """

    rows: tuple[Row, ...]
    explanation: str

    def row(self, curve: str, norm: str) -> Row:
        """The entry of a curve and a norm's label."""
        for row in self.rows:
            if (row.curve, row.norm) == (curve, norm):
                return row
        raise KeyError((curve, norm))

    def order(self, norm: str) -> tuple[str, ...]:
        """Curves from safest to riskiest by our norm."""
        values = {row.curve: row.ours for row in self.rows if row.norm == norm}
        return tuple(sorted(values, key=values.__getitem__))

    def __rich__(self) -> RenderableType:
        table = Table(title="Table I: norms of the curves of Fig. 2", title_justify="left")
        for heading in ("norm", "curve"):
            table.add_column(heading)
        for heading in ("printed", "our norm", "printed figure from ours"):
            table.add_column(heading, justify="right")
        for row in self.rows:
            table.add_row(*_cells(row), end_section=row.curve == CURVES[-1])
        return Group(table, Text(self.explanation))


def curve(name: str, t: ArrayLike) -> FloatArray:
    """The avoidance function of a curve of Fig. 2 at times t [s].

        g(t) = exp(-t^2 / (2 sigma^2)) / (sigma sqrt(2 pi)),  sigma = 1
        A: g(t)                          C: g(t) (1 + cos(2 pi t / 3))
        B: g(t + 2.5) + g(t - 2.5)       D: g(t) (1 + cos(2 pi t 3 / 4))

    Raises:
        ArgumentError: no such curve.

    Reference:
        Nair & Kobilarov, section III-C.
    """
    t = as_floats("t", t)
    if name == "A":
        return _gauss(t)
    if name == "B":
        return _gauss(t + 2.5) + _gauss(t - 2.5)
    if name == "C":
        return _gauss(t) * (1 + np.cos(2 * np.pi * t / 3))
    if name == "D":
        return _gauss(t) * (1 + np.cos(2 * np.pi * t * 3 / 4))
    raise ArgumentError("name", name, f"one of {', '.join(CURVES)}")


def table1(*, step: float = 1e-3, half_width: float = 10.0) -> Table1:
    """Compute Table I.

    Args:
        step: time between samples [s].
        half_width: the curves are taken on [-half_width, half_width] [s]; beyond 10 s they are
            below 1e-12.

    Raises:
        ArgumentError: an argument is not positive and finite.

    Reference:
        Nair & Kobilarov, Table I.
    """
    count = math.ceil(2 * positive("half_width", half_width) / positive("step", step))
    t = np.linspace(-half_width, half_width, count + 1)
    rows = []
    for norm in NORMS:
        for name in CURVES:
            ours = norm(t, curve(name, t))
            reconstructed = {"L1": 10 * ours, "H1": 10 * ours**2}.get(norm.label, ours)
            rows.append(Row(name, norm.label, PRINTED[name][norm.label], ours, reconstructed))
    return Table1(tuple(rows), EXPLANATION)


def _gauss(t: FloatArray) -> FloatArray:
    return np.exp(-(t**2) / 2) / math.sqrt(2 * math.pi)


def _cells(row: Row) -> tuple[Text, ...]:
    rule = {"L1": "10 x norm = ", "H1": "10 x norm² = "}.get(row.norm, "")
    return (
        Text(row.norm),
        Text(row.curve),
        Text(f"{row.printed:.1f}"),
        Text(f"{row.ours:.3f}"),
        Text(f"{rule}{row.reconstructed:.1f}", style="green" if row.agrees else "red"),
    )
