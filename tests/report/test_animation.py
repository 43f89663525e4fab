"""A film has the frames asked for, and each shows the flight at its time."""

from itertools import pairwise

import numpy as np
import pytest
from banked_flights import circling, level
from matplotlib import rc_context
from matplotlib.animation import FFMpegWriter
from PIL import Image

from ompl_risk import InverseDistance, TerrainClearance, Trajectory
from ompl_risk.errors import ArgumentError, ExtentError, FileError
from ompl_risk.report.animation import animate_flight
from ompl_risk.report.camera import ground_below
from ompl_risk.report.chase import NEAREST, Chase
from ompl_risk.report.flight_film import Film
from ompl_risk.terrains import Terrain

AVOIDANCE = InverseDistance(100.0)
FRAMES = 5


@pytest.fixture(scope="module")
def flight():
    return circling((1500, 1000), 600, 130, 30, "A", start=1.0)


@pytest.fixture(scope="module")
def clearance(hill):
    return TerrainClearance(hill, 5.0, threads=1)


@pytest.fixture(scope="module")
def film(flight, hill, clearance):
    return Film(flight, hill, clearance, AVOIDANCE, np.linspace(10.0, 70.0, FRAMES), 2)


def test_a_gif_has_the_frames_the_size_and_the_duration_asked_for(
    flight, hill, clearance, tmp_path
):
    path, calls = tmp_path / "flight.gif", []
    animate_flight(
        flight, hill, clearance, path, avoidance=AVOIDANCE, frames=FRAMES, seconds=0.77,
        progress=lambda done, total: calls.append((done, total)),
    )  # fmt: skip
    assert calls == [(k + 1, FRAMES) for k in range(FRAMES)]
    with Image.open(path) as film:
        assert film.size == (960, 540)
        assert film.n_frames == FRAMES
        assert film.info["loop"] == 0
        durations, pictures = [], []
        for k in range(FRAMES):
            film.seek(k)
            durations.append(film.info["duration"])
            pictures.append(np.asarray(film.convert("RGB"), dtype=int))
    assert sum(durations) == 770
    for first, second in pairwise(pictures):
        assert (np.abs(first - second).max(axis=2) > 30).mean() > 0.01
    assert (pictures[0][530, 700:] == 255).all()  # paper is white


def test_markers_run_along_d_f_and_the_map(film, flight, clearance):
    at = flight.resample(np.linspace(10.0, 70.0, FRAMES))
    d = clearance(at.positions)
    _, plan, distance, avoidance = film.figure.axes
    for k in range(FRAMES):
        film.draw(k)
        for axes, place in (
            (plan, at.positions[k, :2] / 1000),
            (distance, (at.t[k], min(d[k], 0.97 * distance.get_ylim()[1]))),
            (avoidance, (at.t[k], AVOIDANCE(d[k]))),
        ):
            np.testing.assert_allclose(axes.lines[-1].get_xydata(), [place])
    (line,) = [line for line in distance.lines if len(line.get_xdata()) > 100]
    t, drawn = line.get_xydata().T
    np.testing.assert_allclose(drawn, clearance(flight.resample(t).positions))
    assert distance.get_xlim() == (10.0, 70.0)


def test_the_helicopter_is_where_the_camera_sees_it_in_its_attitude(film, flight):
    for k in range(FRAMES):
        film.draw(k)
        rotor = film.figure.axes[0].collections[-1]
        disc = rotor.get_paths()[0].vertices[:-1]
        at = flight.resample([film.chase.flight.t[k], 75.0])
        x, y, z, w = at.orientations[0]
        up = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        hub = at.positions[0] + film.view.scale * 0.235 * up
        places, _ = film.chase.cameras[k].project(hub[None])
        # a disc's mean is seen a little nearer than its centre: perspective
        np.testing.assert_allclose(disc.mean(axis=0), places[0], atol=0.02)
        assert np.abs(disc).max() < 0.6  # within the picture
        assert np.ptp(disc, axis=0).max() > 0.1  # large enough to be seen
        words = film.figure.axes[0].texts[0].get_text()
        assert f"t = {film.chase.flight.t[k]:.1f} s" in words
        assert "30.0 m/s" in words
        assert "bank 9° left" in words  # atan(30^2 / (600 g))


def test_frames_replace_each_other(film):
    film.draw(0)
    axes = film.figure.axes[0]
    before = len(axes.get_children())
    for k in (1, 2, 0):
        film.draw(k)
    assert len(axes.get_children()) == before


def test_the_dashed_line_leads_to_the_nearest_point(film, clearance):
    flight = film.chase.flight
    gaps = np.linalg.norm(film.nearest - flight.positions, axis=1)
    np.testing.assert_allclose(gaps - 5.0, clearance(flight.positions))
    film.draw(3)
    (line,) = film.figure.axes[0].lines
    places, _ = film.chase.cameras[3].project(np.stack([flight.positions[3], film.nearest[3]]))
    np.testing.assert_allclose(line.get_xydata(), places)


def test_the_camera_is_above_ground_and_sees_the_vehicle():
    x = np.arange(0.0, 2001.0, 20.0)
    profile = np.clip(100.0 - np.abs(x - 500.0), 0.0, None)
    ridge = Terrain(np.tile(profile, (51, 1)), spacing=(20.0, 20.0))
    away = level([570, 500, 40], [1500, 520, 40], 30)  # from the foot of the ridge
    chase = Chase.along(away, ridge, np.linspace(0.0, away.duration, 60))
    positions = np.array([camera.position for camera in chase.cameras])
    assert (positions[:, 2] > ground_below(ridge, positions)).all()
    gaps = np.linalg.norm(positions - chase.flight.positions, axis=1)
    np.testing.assert_allclose(gaps, chase.distance, rtol=0.05)
    for camera, vehicle in zip(chase.cameras, chase.flight.positions, strict=True):
        assert camera.sees(vehicle[None], ridge).all()
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    assert steps.max() < 3.0 * chase.flight.steps.max()  # no jumps
    assert chase.elevations[0] > chase.elevations[-1] + 0.2  # the ridge made it rise


def test_hovering_is_shown_from_near(hill):
    t = np.linspace(0.0, 10.0, 21)
    hover = Trajectory(t, np.tile([700.0, 700.0, 90.0], (21, 1)), "hover")
    film = Film(hover, hill, lambda p: p[:, 2], None, np.linspace(0.0, 10.0, 3), 0)
    assert film.chase.distance == NEAREST
    assert len(film.figure.axes) == 3  # f is not drawn
    film.draw(1)
    assert film.nearest is None
    assert "0.0 m/s" in film.figure.axes[0].texts[0].get_text()
    assert np.isfinite(film.figure.axes[2].get_ylim()).all()


def test_a_flight_through_the_ground_can_be_shown(hill, clearance):
    through = level([800, 1000, 60], [2200, 1000, 60], 30)
    film = Film(through, hill, clearance, AVOIDANCE, np.linspace(0.0, through.duration, 7), 0)
    film.draw(3)
    film.figure.canvas.draw()
    _, _, distance, avoidance = film.figure.axes
    assert distance.get_ylim()[0] < -50.0
    assert np.isfinite(avoidance.get_ylim()).all()
    assert distance.lines[-1].get_ydata()[0] < 0.0


@pytest.fixture
def recorder(tmp_path):
    """A program that stands in for ffmpeg: it writes what it is given to the last argument."""
    program = tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\nfor last; do :; done\ncat > "$last"\n')
    program.chmod(0o755)
    with rc_context({"animation.ffmpeg_path": str(program)}):
        yield program


def test_an_mp4_is_given_every_picture(flight, hill, clearance, tmp_path, recorder):
    calls = []
    animate_flight(
        flight, hill, clearance, tmp_path / "a.mp4", frames=2, seconds=1,
        progress=lambda *counts: calls.append(counts),
    )  # fmt: skip
    assert (tmp_path / "a.mp4").stat().st_size == 2 * 960 * 540 * 4
    assert calls == [(1, 2), (2, 2)]


def test_an_ffmpeg_that_fails_is_named(flight, hill, clearance, tmp_path, recorder):
    recorder.write_text("#!/bin/sh\ncat > /dev/null\nexit 3\n")
    with pytest.raises(FileError, match=r"a.mp4: ffmpeg ended with code 3"):
        animate_flight(flight, hill, clearance, tmp_path / "a.mp4", frames=2, seconds=1)


def test_an_mp4_without_ffmpeg_is_refused(flight, hill, clearance, tmp_path, monkeypatch):
    monkeypatch.setattr(FFMpegWriter, "isAvailable", lambda: False)
    with pytest.raises(FileError, match=r"a.mp4: MP4 needs the program ffmpeg.*\.gif"):
        animate_flight(flight, hill, clearance, tmp_path / "a.mp4")


@pytest.mark.parametrize("name", ["a.avi", "flight", "a.png"])
def test_other_suffixes_are_refused(flight, hill, clearance, tmp_path, name):
    with pytest.raises(FileError, match=r"no kind of film; the suffix may be .gif or .mp4"):
        animate_flight(flight, hill, clearance, tmp_path / name)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"frames": 1}, "frames = 1: must be a whole number, 2 to 1000"),
        ({"frames": 10.0}, "frames = 10.0"),
        ({"frames": True}, "frames = True"),
        ({"frames": 1001}, "frames = 1001"),
        ({"seconds": 0}, "seconds = 0"),
        ({"seconds": np.inf}, "seconds = inf"),
        ({"begin": -1.0}, "begin = -1.0: must be a time within the flight's 0 to"),
        ({"end": 1e6}, "end = 1000000.0"),
        ({"begin": 20.0, "end": 20.0}, "end = 20.0.*begin before end"),
        ({"begin": np.nan}, "begin = nan"),
    ],
)
def test_numbers_out_of_range_are_refused(flight, hill, clearance, tmp_path, wrong, words):
    with pytest.raises(ArgumentError, match=words):
        animate_flight(flight, hill, clearance, tmp_path / "a.gif", **wrong)
    assert list(tmp_path.iterdir()) == []


def test_flights_and_files_that_do_not_fit_are_refused(flight, hill, clearance, tmp_path):
    with pytest.raises(FileError, match="No such file"):
        animate_flight(flight, hill, clearance, tmp_path / "missing" / "a.gif")
    outside = level([0, 0, 100], [4000, 0, 100], 20)
    with pytest.raises(ExtentError, match="outside the terrain"):
        animate_flight(outside, hill, clearance, tmp_path / "a.gif")
    (tmp_path / "folder.gif").mkdir()
    with pytest.raises(FileError, match=r"folder.gif: Is a directory"):
        animate_flight(flight, hill, clearance, tmp_path / "folder.gif", frames=2)
