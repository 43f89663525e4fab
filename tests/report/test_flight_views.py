"""Flights from several sides: each view shows its flight, with helicopters in their attitude."""

import math
import struct

import numpy as np
import pytest
from banked_flights import circling, level
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex

from ompl_risk.errors import ArgumentError, ExtentError, FileError
from ompl_risk.report.attitudes import attitudes, heading_and_bank, headings, velocities
from ompl_risk.report.flight_scene import nice
from ompl_risk.report.flight_views import flight_views
from ompl_risk.report.style import colour
from ompl_risk.report.viewpoints import APART, named, viewpoints

POSES = 4


@pytest.fixture(scope="module")
def flights():
    return [
        circling((1500, 1000), 700, 150, 25, "A"),
        level([300, 300, 150], [2700, 1700, 120], 25, "B"),
        circling((1500, 1000), 500, 230, 25, "C", start=2.0),
    ]


@pytest.fixture(scope="module")
def drawn(flights, hill):
    return flight_views(flights, hill, poses=POSES, exaggeration=2.0, title="Round the hill")


def helicopters(axes):
    """Rotor discs and bodies, by collections; the first collection of faces is the ground."""
    parts = [c for c in axes.collections if isinstance(c, PolyCollection)][1:]
    rotors = [p for p in parts if len(p.get_paths()) == 2]
    return rotors, [p for p in parts if len(p.get_paths()) > 2]


def places_of_lines(axes, index, width):
    """Places of the lines of a flight's colour and width, hidden parts among them."""
    runs = [
        run
        for lines in axes.collections
        if isinstance(lines, LineCollection)
        and to_hex(lines.get_color()[0]).upper() == colour(index)
        and lines.get_linewidth()[0] in (pytest.approx(width), pytest.approx(0.6 * width))
        for run in lines.get_segments()
    ]
    return np.concatenate(runs)


def test_every_flight_has_a_view_and_a_legend_follows(drawn, flights):
    assert len(drawn.axes) == len(flights) + 1
    for axes, flight in zip(drawn.axes, flights, strict=False):
        texts = [text.get_text() for text in axes.texts]
        assert texts[0] == flight.name
        assert any(text.startswith("seen from the ") for text in texts)
        assert "N" in texts
    legend = [text.get_text() for text in drawn.axes[-1].texts]
    for flight in flights:
        assert flight.name in legend
        assert f"{flight.duration:.1f} s" in legend
        assert f"{flight.length / 1000:.2f} km" in legend
    assert any("heights: drawn 2 times" in text for text in legend)
    assert any("times their size" in text for text in legend)


def test_helicopters_are_on_the_flight_of_the_view(drawn, flights):
    for i, axes in enumerate(drawn.axes[:-1]):
        rotors, bodies = helicopters(axes)
        assert len(rotors) == len(bodies) == POSES
        line = places_of_lines(axes, i, 2.0)
        for rotor, body in zip(rotors, bodies, strict=True):
            disc = max((p.vertices for p in rotor.get_paths()), key=len)
            across = np.ptp(disc, axis=0).max()
            gap = np.linalg.norm(line - disc.mean(axis=0), axis=1).min()
            assert gap < 0.4 * across  # the hub is that much above the flight
            paint = body.get_facecolor()[:, :3]
            hue = paint[np.argmax(np.ptp(paint, axis=1))]
            want = np.array([int(colour(i)[k : k + 2], 16) for k in (1, 3, 5)]) / 255
            np.testing.assert_allclose(hue / hue.max(), want / want.max(), atol=0.05)


def test_the_other_flights_are_thin(drawn, flights):
    for i, axes in enumerate(drawn.axes[:-1]):
        for k in range(len(flights)):
            width = 2.0 if k == i else 1.1
            assert len(places_of_lines(axes, k, width)) >= 400


def test_everything_is_within_its_view_in_one_scale(drawn):
    drawn.canvas.draw()
    for axes in drawn.axes[:-1]:
        box, (x0, x1), (y0, y1) = axes.get_window_extent(), axes.get_xlim(), axes.get_ylim()
        assert (x1 - x0) / box.width == pytest.approx((y1 - y0) / box.height)
        for faces in axes.collections:
            for path in faces.get_paths():
                x, y = path.vertices.T
                assert x0 < x.min()
                assert x.max() < x1
                assert y0 < y.min()
                assert y.max() < y1


def test_attitudes_are_the_flights_own_or_level_along_the_path(flights):
    circle, line, _ = flights
    assert attitudes(circle) is circle.orientations
    q = attitudes(line)[0]
    heading, bank = heading_and_bank(q)
    assert heading == pytest.approx(90.0 - math.degrees(math.atan2(1400, 2400)))
    assert bank == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(np.linalg.norm(velocities(line), axis=1), 25.0)
    heading, bank = heading_and_bank(circle.orientations[0])
    assert heading == pytest.approx(0.0, abs=1e-9) or heading == pytest.approx(360.0)
    assert bank == pytest.approx(-math.degrees(math.atan2(25.0**2, 700 * 9.81)))  # to the left


def test_headings_go_on_where_there_is_no_way():
    ways = np.array([[0.0, 0], [1, 0], [0, 0], [-1, -1e-3], [-1, 1e-3]])
    found = headings(ways, start=0.3)
    np.testing.assert_allclose(found[:3], [0.3, 0.0, 0.0])
    assert abs(found[4] - found[3]) < 0.01  # no jump by 2 pi


def test_views_are_from_directions_that_differ(flights, hill):
    curves = [f.resample(np.linspace(0, f.duration, 100)).positions for f in flights] * 2
    taken = viewpoints(curves, hill, 2.0)
    apart = [
        abs(math.remainder(a - b, 2 * math.pi)) for i, a in enumerate(taken) for b in taken[:i]
    ]
    assert min(apart) >= APART
    assert len({named(a) for a in taken}) == len(taken)


def test_a_flight_behind_the_hill_is_seen_from_its_own_side(hill):
    x = np.linspace(1100.0, 1900.0, 60)
    north = np.stack([x, np.full_like(x, 1500.0), np.full_like(x, 30.0)], axis=1)
    (azimuth,) = viewpoints([north], hill, 2.0)
    assert math.sin(azimuth) > 0.5
    assert named(azimuth) == "north"


def test_points_of_the_compass():
    points = [named(math.radians(angle)) for angle in (0, 44, 90, 181, 270, 359)]
    assert points == ["east", "north-east", "north", "west", "south", "east"]


@pytest.mark.parametrize(
    ("value", "round_value"), [(0.2, 1), (1.1, 1), (38, 30), (640, 700), (904, 1000)]
)
def test_scales_are_round(value, round_value):
    assert nice(value) == round_value


def test_it_is_1600_pixels_wide_and_left_with_no_pyplot_figure(flights, hill, tmp_path):
    from matplotlib import pyplot

    flight_views(flights[:1], hill, path=tmp_path / "views.png")
    width, height = struct.unpack(">II", (tmp_path / "views.png").read_bytes()[16:24])
    assert width == 1600
    assert 300 < height < 1400
    assert pyplot.get_fignums() == []


def test_what_cannot_be_drawn_is_refused(flights, hill, tmp_path):
    with pytest.raises(ArgumentError, match=r"trajectories = .*one or more"):
        flight_views([], hill)
    for poses in (1, 2.0, True):
        with pytest.raises(ArgumentError, match=r"poses = .*2 or more"):
            flight_views(flights, hill, poses=poses)
    with pytest.raises(ArgumentError, match="exaggeration = 0"):
        flight_views(flights, hill, exaggeration=0)
    with pytest.raises(ExtentError, match="outside the terrain"):
        flight_views([level([0, 0, 100], [4000, 0, 100], 20)], hill)
    with pytest.raises(FileError, match=r"views.foo.*\.png"):
        flight_views(flights[:1], hill, path=tmp_path / "views.foo")
