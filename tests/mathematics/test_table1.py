import io
import math

import numpy as np
import pytest
from rich.console import Console

from ompl_risk.errors import ArgumentError
from ompl_risk.table1 import CURVES, NORMS, PRINTED, curve, table1


def test_every_printed_figure_is_reconstructed_to_its_digit():
    rows = table1().rows
    assert len(rows) == 16
    assert all(row.agrees for row in rows)
    assert {(row.curve, row.norm): row.printed for row in rows} == {
        (c, n): printed for c in PRINTED for n, printed in PRINTED[c].items()
    }


def test_our_norms_are_plain_norms():
    """Closed forms: a unit Gaussian, and two of them 5 s apart, which overlap as exp(-25/4)."""
    table = table1()
    root_pi = math.sqrt(math.pi)
    assert table.row("A", "L1").ours == pytest.approx(1.0, rel=1e-6)
    assert table.row("A", "L2").ours == pytest.approx((2 * root_pi) ** -0.5, rel=1e-6)
    assert table.row("A", "L∞").ours == pytest.approx((2 * math.pi) ** -0.5, rel=1e-6)
    assert table.row("A", "H1").ours == pytest.approx((0.75 / root_pi) ** 0.5, rel=1e-6)
    assert table.row("B", "L2").ours == pytest.approx(
        ((1 + math.exp(-25 / 4)) / root_pi) ** 0.5, rel=1e-6
    )


def test_what_the_paper_computed_is_a_sum_over_samples():
    """10 x the norm, or the norm squared: sums at 0.1 s without the step."""
    t = np.arange(-100, 101) * 0.1
    for name in CURVES:
        f = curve(name, t)
        assert round(f.sum(), 1) == PRINTED[name]["L1"]
        assert round((f**2 + np.gradient(f, t) ** 2).sum(), 0) == pytest.approx(
            PRINTED[name]["H1"], rel=0.15
        )


def test_the_orders_of_section_iii_c():
    table = table1()
    assert table.order("L1") == ("A", "D", "C", "B")
    assert table.order("L2") == ("A", "D", "B", "C")
    assert table.order("L∞") == ("A", "B", "C", "D")
    assert table.order("H1") == ("A", "B", "C", "D")


def test_it_prints_in_80_columns():
    console = Console(file=io.StringIO(), width=80)
    console.print(table1())
    text = console.file.getvalue()
    assert "…" not in text
    assert all(f"{value:.1f}" in text for row in PRINTED.values() for value in row.values())
    assert all(norm.label in text for norm in NORMS)


def test_what_is_refused():
    with pytest.raises(ArgumentError, match="name = 'E': must be one of A, B, C, D"):
        curve("E", 0.0)
    with pytest.raises(ArgumentError, match="step = 0"):
        table1(step=0)
    with pytest.raises(KeyError):
        table1(step=0.1).row("A", "H2")
