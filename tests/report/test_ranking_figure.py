"""The figure shows the ranking's own numbers, in places where they can be read."""

import struct

import numpy as np
import pytest

from ompl_risk.errors import FileError
from ompl_risk.report import ranking_figure
from ompl_risk.report.map_labels import label_points
from ompl_risk.report.norm_tables import NormTable
from ompl_risk.report.style import RISKIEST, SAFEST, colour, new_figure, short
from ompl_risk.report.time_plots import draw_distance

D0 = 60.0


@pytest.fixture(scope="module")
def drawn(three, hill):
    ranking, profiles = three
    return ranking_figure(ranking, profiles, hill, ceiling=150.0, title="Round the hill")


def texts(figure):
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def lines(axes, name):
    """Data of the lines of a path's colour."""
    index = "ABC".index(name)
    return [line.get_xydata() for line in axes.lines if line.get_color() == colour(index)]


def test_it_is_1600_pixels_wide_and_written(three, hill, tmp_path):
    ranking, profiles = three
    ranking_figure(ranking, profiles, hill, path=tmp_path / "figure.png")
    header = (tmp_path / "figure.png").read_bytes()[:24]
    width, height = struct.unpack(">II", header[16:])
    assert width == 1600
    assert 800 < height < 1400


def test_no_figure_is_left_with_pyplot(drawn):
    from matplotlib import pyplot

    assert drawn.axes
    assert pyplot.get_fignums() == []


def test_the_plots_over_time_show_d_f_and_pc(drawn, three):
    ranking, profiles = three
    distance, avoidance, probability = drawn.axes[-3:]
    for a in ranking.assessments:
        (d,) = lines(distance, a.name)
        inside = a.d < 2.5 * D0
        np.testing.assert_array_equal(d[inside, 1], a.d[inside])
        np.testing.assert_array_equal(d[:, 0], a.trajectory.t)
        (f,) = lines(avoidance, a.name)
        np.testing.assert_array_equal(f[:, 1], a.f)
        (p,) = lines(probability, a.name)
        np.testing.assert_array_equal(p[:, 1], profiles[a.name].p)
    assert avoidance.get_ylim()[1] > max(a.f.max() for a in ranking.assessments)


def test_the_tables_show_every_norm(drawn, three):
    ranking, _ = three
    shown = texts(drawn)
    for a in ranking.assessments:
        for label in ranking.labels:
            assert format(a.norms[label], "#.3g") in shown
            assert format(a.pc_norms[label], "#.3g") in shown


def test_the_map_has_one_scale_and_holds_the_paths(drawn, three):
    ranking, _ = three
    drawn.canvas.draw()
    plan = drawn.axes[0]
    box, (x0, x1), (y0, y1) = plan.get_window_extent(), plan.get_xlim(), plan.get_ylim()
    assert (x1 - x0) / box.width == pytest.approx((y1 - y0) / box.height, rel=1e-3)
    for a in ranking.assessments:
        x, y, _ = a.trajectory.positions.T / 1000
        assert x0 < x.min() < x.max() < x1
        assert y0 < y.min() < y.max() < y1
        (curve,) = lines(plan, a.name)[-1:]
        np.testing.assert_allclose(curve[[0, -1]], np.c_[x, y][[0, -1]])


def test_text_does_not_overlap_within_its_axes(drawn):
    drawn.canvas.draw()
    renderer = drawn.canvas.get_renderer()
    for axes in drawn.axes:
        boxes = [t.get_window_extent(renderer) for t in axes.texts if t.get_text()]
        for k, box in enumerate(boxes):
            for other in boxes[:k]:
                assert not box.overlaps(other) or axes is drawn.axes[0]
            assert drawn.bbox.contains(box.x0, box.y0)
            assert drawn.bbox.contains(box.x1, box.y1)


def test_a_collision_is_marked_and_does_not_break_the_scales(crashing, hill):
    ranking, profiles = crashing
    figure = ranking_figure(ranking, profiles, hill)
    distance, avoidance, _ = figure.axes[-3:]
    through = ranking["through"]
    marks = [line for line in distance.lines if line.get_marker() == "X"]
    assert [line.get_xdata()[0] for line in marks] == [through.collision_time]
    assert np.isfinite(avoidance.get_ylim()).all()
    assert distance.get_ylim()[0] < 0.0
    assert texts(figure).count("collides") == len(ranking.labels)


def test_labels_are_where_the_curves_are_apart():
    x = np.linspace(0.0, 10.0, 101)
    bump = np.exp(-((x - 3.0) ** 2))
    low, high = np.c_[x, 0 * x], np.c_[x, 2 * bump]
    points = label_points([low, high])
    assert points[1] == pytest.approx([3.0, 2.0], abs=0.3)
    apart = np.linalg.norm(points[0] - points[1])
    assert apart > 1.0
    for curve, point in zip((low, high), points, strict=True):
        assert np.linalg.norm(curve - point, axis=1).min() == 0.0


def test_numbers_that_look_the_same_are_marked_the_same(hill):
    from matplotlib.colors import to_hex

    from ompl_risk.report.norm_tables import draw_norm_table

    values = [0.12301, 0.12302, 0.5, 0.4]
    table = NormTable("t", "ABCD", {"L2": values}, {"L2": "s"})
    axes = new_figure(4, 3).add_subplot()
    draw_norm_table(axes, table)
    fills = [to_hex(patch.get_facecolor()).upper() for patch in axes.patches]
    assert fills == [SAFEST, SAFEST, RISKIEST]
    assert "A B D C" in [text.get_text() for text in axes.texts]


def test_of_equal_values_the_fastest_comes_first():
    table = NormTable("t", "ABC", {"L2": [0.0, 0.0, 0.0]}, {"L2": "s"}, durations=[3.0, 1.0, 2.0])
    assert table.order("L2") == [1, 2, 0]


def test_some_of_the_distance_is_in_sight_however_small_d0_is(three):
    axes = new_figure(4, 3).add_subplot()
    draw_distance(axes, three[0].assessments, 0.5)
    least = min(a.d.min() for a in three[0].assessments)
    assert least > 2.5 * 0.5
    assert axes.get_ylim()[1] > least


def test_long_names_keep_both_ends():
    assert short(["a", "northern_approach_1"]) == ["a", "northe…oach_1"]


@pytest.mark.parametrize(("name", "part"), [("x.foo", ".png"), ("missing/x.png", "No such file")])
def test_a_figure_that_cannot_be_written_is_an_error_of_one_line(three, hill, tmp_path, name, part):
    ranking, profiles = three
    with pytest.raises(FileError, match=part):
        ranking_figure(ranking, profiles, hill, path=tmp_path / name)
