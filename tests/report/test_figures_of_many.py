"""Figures of one to many paths: everything is there, and no text covers another."""

import numpy as np
import pytest
from banked_flights import circling
from conftest import judged, passing
from matplotlib.colors import to_hex
from text_boxes import boxes, outside, overlapping

from ompl_risk.errors import ArgumentError, ExtentError
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.report import closed_loop_figure, flight_views, ranking_figure
from ompl_risk.report.flight_views import MOST
from ompl_risk.report.map_labels import label_points
from ompl_risk.report.norm_tables import NormTable, draw_norm_table
from ompl_risk.report.pareto import pareto_figure
from ompl_risk.report.plan_view import draw_plan_view
from ompl_risk.report.style import colour, dashes, new_figure
from ompl_risk.simulation import CollisionEstimate

LONG = "northern_approach"


def flights(count, name="{}"):
    """Circles round the hill, from wide to narrow."""
    names = [name.format(chr(ord("A") + k)) for k in range(count)]
    return [
        circling((1500, 1000), 850 - 40 * k, 150 + 5 * k, 25, names[k], samples=61, start=0.3 * k)
        for k in range(count)
    ]


@pytest.fixture(scope="module", params=[1, 2, 5, 12])
def views(request, hill):
    count = request.param
    figure = flight_views(
        flights(count), hill, poses=2, ranked_by="height", title="Round and round the hill"
    )
    return count, figure


def test_views_and_legend(views):
    count, figure = views
    shown = min(count, MOST)
    assert len(figure.axes) == shown + 1
    labels = [axes.texts[0].get_text() for axes in figure.axes[:-1]]
    assert labels[0] == "A"
    assert labels[-1] == chr(ord("A") + count - 1)
    legend = [text.get_text() for text in figure.axes[-1].texts]
    assert [text for text in legend if text in set("ABCDEFGHIJKL")] == labels
    assert {"start", "goal", "hidden behind a hill", "ground below the flight"} <= set(legend)


def test_views_say_what_they_leave_out(views):
    count, figure = views
    title, *remark = [text.get_text() for text in figure.texts if text.get_text()]
    assert title == "Round and round the hill"
    if count <= MOST:
        assert remark == []
    else:
        words = "8 of 12 flights, at even ranks by height, from the safest, A, to the riskiest, L"
        assert remark == [words]


def test_no_text_of_the_views_covers_another(views):
    _, figure = views
    found = boxes(figure)
    assert overlapping(found) == []
    assert outside(found, figure.bbox) == []


def test_text_of_a_view_is_above_what_it_shows(views):
    count, figure = views
    found = iter(boxes(figure)[1 if count <= MOST else 2 :])
    for axes in figure.axes[:-1]:
        corners = [p.vertices for c in axes.collections for p in c.get_paths()]
        top = axes.transData.transform(np.concatenate(corners))[:, 1].max()
        for name, box in [next(found) for _ in range(3)]:
            assert box.y0 >= top - 1.0, name
            assert outside([(name, box)], axes.bbox.padded(1.0)) == []


def test_colours_that_repeat_are_dashed_in_the_legend(views):
    count, figure = views
    lines = [line for line in figure.axes[-1].lines if line.get_linewidth() == 3.0]
    looks = {(to_hex(line.get_color()), str(line._dash_pattern)) for line in lines}
    assert len(looks) == len(lines) == min(count, MOST)


def test_long_names_have_room(hill):
    figure = flight_views(flights(3, LONG + "_{}"), hill, poses=2, title="t")
    found = boxes(figure)
    assert overlapping(found) == []
    assert outside(found, figure.bbox) == []


def test_flights_without_names_are_drawn(hill):
    unnamed = flights(2, "")
    assert len(flight_views(unnamed, hill, poses=2).axes) == 3
    axes = new_figure(5.0, 5.0).add_axes((0.1, 0.1, 0.8, 0.8))
    draw_plan_view(axes, hill, unnamed, ["", ""])
    assert len(axes.texts) >= 2


def test_most_can_be_chosen(hill):
    many = flights(5)
    figure = flight_views(many, hill, poses=2, most=3)
    labels = [axes.texts[0].get_text() for axes in figure.axes[:-1]]
    assert labels == ["A", "C", "E"]
    assert "3 of 5 flights, evenly from the first, A, to the last, E" in [
        text.get_text() for text in figure.texts
    ]
    for most in (1, 2.0, True):
        with pytest.raises(ArgumentError, match=r"most = .*2 or more"):
            flight_views(many, hill, most=most)


def test_flights_that_are_drawn_must_be_above_the_terrain(hill):
    far = circling((9000, 9000), 500, 150, 25, "X", samples=61)
    with pytest.raises(ExtentError):
        flight_views([far, *flights(2)], hill, poses=2, most=2)
    a, b = flights(2)
    assert len(flight_views([a, far, b], hill, poses=2, most=2).axes) == 3


@pytest.fixture(scope="module", params=[("{}", 9), (LONG + "_{}", 4)])
def ranked(request, hill):
    name, count = request.param
    names = [name.format(chr(ord("A") + k)) for k in range(count)]
    sides = [(-1) ** k * (300 + 45 * k) for k in range(count)]
    return judged(hill, [passing(n, s) for n, s in zip(names, sides, strict=True)])


def test_no_text_of_a_ranking_covers_another(ranked, hill):
    ranking, profiles = ranked
    figure = ranking_figure(ranking, profiles, hill, ceiling=150.0, title="Round the hill")
    for axes in figure.axes:
        found = boxes(figure, axes)
        assert overlapping(found) == []
        assert outside(found, figure.bbox if axes is not figure.axes[0] else axes.bbox) == []
    orders = [text.get_text() for axes in figure.axes[1:3] for text in axes.texts]
    names = ranking.orders["H1"]
    if len(names[0]) == 1:
        assert {"order", " ".join(names[:5]), " ".join(names[5:])} <= set(orders)
    else:
        assert orders.count("safest") == 2
        safest = [o[0] for o in [*ranking.orders.values(), *ranking.pc_orders.values()]]
        for name in names:  # in a row of each table, and below the columns where it comes first
            cut = [text for text in orders if "…" in text and text[-1] == name[-1]]
            assert len(cut) == 2 + safest.count(name)


@pytest.mark.parametrize("columns", [1, 4, 6])
def test_orders_fit_into_their_columns(columns):
    labels = list("ABCDEFGHIJKL")
    values = {f"L{k + 1}": list(np.linspace(0.01, 0.02, 12)) for k in range(columns)}
    figure = new_figure(16, 5)
    axes = figure.add_axes((0.0, 0.0, 0.35, 1.0))
    draw_norm_table(axes, NormTable("t", labels, values, dict.fromkeys(values, "s")))
    found = boxes(figure, axes)
    assert overlapping(found) == []
    assert outside(found, axes.bbox) == []
    ends = {1: "A B C D E F G H I J K L", 4: "G H I J K L", 6: "A"}
    shown = [text for text, _ in found]
    assert shown.count(ends[columns]) == columns + (columns == 6)  # and the row's own label
    assert ("safest" if columns == 6 else "order") in shown


def estimate(name, hits, count=200):
    least = np.linspace(5.0, 80.0, count)
    least[:hits] = 0.0
    where = np.column_stack([np.full(count, 1500.0), np.full(count, 1600.0), np.zeros(count)])
    return CollisionEstimate(name, least, np.ones(count), where, np.where(least > 0.0, np.inf, 3.0))


@pytest.mark.parametrize(("name", "count"), [("{}", 2), ("{}", 12), (LONG + "_{}", 20)])
def test_the_legend_of_rollouts_is_beside_the_plot(hill, name, count):
    paths = [passing(name.format(k), 20 * k) for k in range(count)]
    figure = closed_loop_figure(paths, [estimate(p.name, 1) for p in paths], hill, title="t")
    figure.draw_without_rendering()
    plot = figure.axes[1]
    legend = plot.get_legend().get_window_extent()
    assert legend.x0 > plot.bbox.x1
    assert legend.x1 < figure.bbox.x1
    assert legend.y0 > 0.0
    assert figure.get_size_inches()[0] == 16.0
    assert outside(boxes(figure, figure.axes[0]), figure.axes[0].bbox) == []


def test_labels_do_not_cover_collisions(hill):
    paths = [passing("A", 600), passing("B", -600)]
    figure = closed_loop_figure(paths, [estimate("A", 1), estimate("B", 0)], hill, title="t")
    plan = figure.axes[0]
    label = dict(boxes(figure, plan))["A"]
    (cross,) = plan.transData.transform([[1.5, 1.6]])  # where A is farthest from B
    assert not label.contains(*cross)
    plain = label_points([p.positions[:, :2] / 1000 for p in paths])
    np.testing.assert_allclose(plain[0], [1.5, 1.6], atol=0.05)


def test_names_of_ends_stay_on_a_small_map(hill):
    figure = new_figure(3.0, 3.0)
    axes = figure.add_axes((0.2, 0.2, 0.7, 0.7))
    draw_plan_view(axes, hill, [passing("A", 600)], ["A"])
    names = [found for found in boxes(figure, axes) if found[0] in {"start", "goal"}]
    assert len(names) == 2
    assert outside(names, axes.bbox) == []


def test_a_label_makes_way_for_what_is_marked():
    x = np.linspace(0.0, 10.0, 101)
    bump = np.exp(-(((x - 3.0) / 1.5) ** 2))
    curves = [np.c_[x, 0 * x], np.c_[x, 2 * bump]]
    size = (0.5, 0.5)
    (_, top) = label_points(curves, size=size)
    (_, moved) = label_points(curves, size=size, avoid=np.array([top]))
    assert np.abs(moved - top).max() >= 0.5
    assert moved[1] > 1.0  # still on the part that is its own


def test_labels_of_near_curves_do_not_overlap():
    x = np.linspace(0.0, 10.0, 201)
    curves = [np.c_[x, 0.02 * k * np.sin(x)] for k in range(8)]
    points = np.array(label_points(curves, size=(0.6, 0.4)))
    for k, point in enumerate(points):
        steps = np.abs(points[:k] - point) / [0.6, 0.4]
        assert (steps.max(axis=1) >= 1.0).all()


@pytest.mark.parametrize(("count", "title"), [(1, "1 path"), (2, "2 paths"), (12, "12 paths")])
def test_a_pareto_set_of_any_size(count, title):
    t, risk = np.linspace(100.0, 120.0, count), np.linspace(0.5, 0.1, count)
    figure = pareto_figure(list(t), list(risk), Sobolev(1))
    assert figure.texts[0].get_text().endswith(f": {title}")
    axes = figure.axes[0]
    (shade,) = axes.collections
    left, top = axes.get_xlim()[0], axes.get_ylim()[1]
    path = shade.get_paths()[0]
    # What is faster than the fastest, or less risky than the least, no path reaches.
    assert path.contains_point((0.5 * (left + t[0]), 0.99 * top))
    assert path.contains_point((t[-1], 0.05))
    assert not path.contains_point((t[0] + 0.01, 0.99 * top))
    assert axes.get_ylabel().endswith("[√s/m]")
    assert pareto_figure([1.0], [1.0], Lp(float("inf")), unit="1").axes[0].get_ylabel()[-1] != "]"


def test_the_first_twenty_one_lines_look_different():
    assert len({(colour(k), str(dashes(k))) for k in range(21)}) == 21
