"""Fig. 2 and Table I as a figure."""

import numpy as np

from ompl_risk.report import table1_figure
from ompl_risk.table1 import CURVES, PRINTED, curve, table1


def test_it_draws_the_curves_and_both_tables(tmp_path):
    figure = table1_figure(path=tmp_path / "table1.png")
    assert (tmp_path / "table1.png").stat().st_size > 10_000
    curves, ours, printed = figure.axes
    for line, name in zip(curves.lines, CURVES, strict=True):
        t, f = line.get_xydata().T
        np.testing.assert_array_equal(f, curve(name, t))
    shown = [text.get_text() for text in printed.texts]
    for row in PRINTED.values():
        assert all(f"{value:.1f}" in shown for value in row.values())
    shown = [text.get_text() for text in ours.texts]
    assert all(f"{row.ours:.3f}" in shown for row in table1().rows)
    assert "A D C B" in shown  # the paper's order by L1
    assert shown.count("A B C D") == 2  # by the maximum and by H1
