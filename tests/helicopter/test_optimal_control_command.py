import math
import sys
from pathlib import Path

import numpy as np
import pytest

from ompl_risk.errors import ArgumentError, ExtraError, FileError
from ompl_risk.helicopter.library import SHIPPED, PrimitiveLibrary, default_library
from ompl_risk.helicopter.optimal_control import running, store
from ompl_risk.helicopter.optimal_control.command import main
from ompl_risk.helicopter.optimal_control.grid import Grid
from ompl_risk.helicopter.optimal_control.making import Made
from ompl_risk.helicopter.optimal_control.needs import casadi
from ompl_risk.helicopter.optimal_control.settings import default_settings, read_settings
from ompl_risk.helicopter.optimal_control.store import Store
from ompl_risk.helicopter.optimal_control.task import Task
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.trims import solve_trim

SMALL = """
[helicopter]
mass = 9.0
[limits]
yaw_force = 5.0
[grid]
speeds = [0.0]
hover_climbs = [1.0]
"""


def written(tmp_path, text):
    path = tmp_path / "settings.toml"
    path.write_text(text)
    return path


# settings


def test_default_settings_read_back_as_the_defaults(tmp_path):
    settings = read_settings(written(tmp_path, default_settings()))
    assert settings.vehicle == Vehicle()
    np.testing.assert_allclose(settings.grid.turns, Grid().turns, rtol=1e-14)
    assert settings.grid.speeds == Grid().speeds
    assert settings.grid.climbs == Grid().climbs


def test_settings_that_are_left_out_have_their_defaults(tmp_path):
    text = SMALL + "banks = [10, 30]\n[manoeuvres]\nheight = 0.5\nreserve = 0\n"
    vehicle, grid = read_settings(written(tmp_path, text))
    assert vehicle.helicopter == Helicopter(9.0)
    assert vehicle.limits == Limits(yaw_force=5.0)
    assert (vehicle.height, vehicle.reserve, vehicle.dt) == (0.5, 0.0, 0.02)
    assert read_settings(written(tmp_path, SMALL)).vehicle.reserve == 0.1
    assert grid.banks == (math.radians(10.0), math.radians(30.0))
    assert grid.hover_turns == Grid().hover_turns


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("[rotor]\n", r"'rotor'.*helicopter, limits, grid, manoeuvres"),
        ("helicopter = 3\n", r"helicopter is no table"),
        ("[helicopter]\nmas = 3\n", r"'mas'.*mass, inertia"),
        ("[helicopter]\nmass = -3\n", r"mass = -3"),
        ("[helicopter]\nmass = 'heavy'\n", r"mass = 'heavy'"),
        ("[helicopter]\ninertia = [1.0, 0.1, 0.1]\n", r"inertia"),
        ("[manoeuvres]\ndt = 0.0\n", r"dt = 0.0"),
        ("[manoeuvres]\nhelicopter = 1\n", r"'helicopter'.*height, reserve, dt$"),
        ("[manoeuvres]\nreserve = 1.0\n", r"reserve = 1\.0: must be 0 or more and below 1"),
        ("[manoeuvres]\nreserve = '10 %'\n", r"reserve = '10 %'"),
        ("[grid]\nspeeds = [10, 5]\n", r"speeds.*increasing"),
        ("[grid]\nspeeds = []\n", r"speeds"),
        ("[grid]\nspeeds = 10\n", r"wrong kind"),
        ("[grid]\nbanks = [15]\n", r"banks"),
        ("[grid]\nbanks = [40, 15]\n", r"banks.*gentle one below"),
        ("[grid]\nbanks = [15, 95]\n", r"banks.*pi/2"),
        ("[grid]\nclimbs = [-1, 0, 1]\n", r"climbs.*other than 0"),
        ("[grid]\nspeeds = [nan]\n", r"speeds\[0\].*finite"),
        ("mass = \n", r"no TOML"),
    ],
)
def test_wrong_settings_are_named(tmp_path, text, problem):
    path = written(tmp_path, text)
    with pytest.raises(FileError, match=problem) as caught:
        read_settings(path)
    assert str(path) in str(caught.value)


def test_settings_that_are_not_there():
    with pytest.raises(FileError, match="No such file"):
        read_settings(Path("nowhere.toml"))


# the grid


def test_turn_rates_are_those_of_the_banks():
    grid = Grid(speeds=[12.0], banks=(0.1, 0.5))
    rates = np.array([math.tan(0.1), math.tan(0.5)]) * 9.81 / 12.0
    np.testing.assert_allclose(grid.turns, [[-rates[1], -rates[0], *rates]], rtol=1e-14)


def test_trim_beyond_the_limits_is_named():
    with pytest.raises(ArgumentError, match=r"40\.0.*speed"):
        Grid(speeds=[0.0, 40.0]).tasks(Vehicle())
    tight = Vehicle(limits=Limits(speed=33.0))
    with pytest.raises(ArgumentError, match=r"speed 30, not 0 to 29\.7 m/s"):  # 10 % in reserve
        Grid().tasks(tight)
    assert len(Grid().tasks(Vehicle(limits=Limits(speed=33.0), reserve=0.05))) == 56
    with pytest.raises(ArgumentError, match="still air"):
        Grid().tasks(Vehicle(Helicopter(wind=(1.0, 0.0, 0.0))))


def test_tasks_go_from_level_flight_and_back():
    tasks = Grid(speeds=[0.0, 10.0], climbs=[2.0], hover_climbs=[]).tasks(Vehicle())
    keys = [(t.first.key, t.last.key) for t in tasks]
    assert len(keys) == len(set(keys)) == 4 + 4 + 2 + 2
    level = {(0.0, 0.0, 0.0), (10.0, 0.0, 0.0)}
    assert all(a in level or b in level for a, b in keys)
    assert all(t.first.turn >= 0.0 and t.last.turn >= 0.0 for t in tasks)


# the store


@pytest.fixture
def task():
    return Task(*(solve_trim(Helicopter(), *key) for key in ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))))


def made():
    return Made(np.arange(8.0).reshape(2, 4) / 3.0, 0.0371, 1e-14)


def test_store_gives_back_what_it_keeps(tmp_path, task):
    folder = Store(tmp_path / "new" / "work")
    assert folder.find(task, Vehicle()) is None
    folder.keep(task, Vehicle(), made())
    found = Store(tmp_path / "new" / "work").find(task, Vehicle())
    np.testing.assert_array_equal(found.controls, made().controls)
    assert (found.least, found.error) == (made().least, made().error)


@pytest.mark.parametrize(
    "other",
    [
        Vehicle(Helicopter(8.3)),
        Vehicle(Helicopter(drag=(0.1, 0.0, 0.0))),
        Vehicle(limits=Limits(tilt=0.21)),
        Vehicle(height=0.9),
        Vehicle(reserve=0.11),
        Vehicle(dt=0.01),
    ],
)
def test_store_tells_vehicles_apart(tmp_path, task, other):
    folder = Store(tmp_path)
    folder.keep(task, Vehicle(), made())
    assert folder.find(task, other) is None
    assert folder.find(Task(task.last, task.first), Vehicle()) is None


def test_manoeuvres_made_in_another_way_are_void(tmp_path, task, monkeypatch):
    folder = Store(tmp_path)
    folder.keep(task, Vehicle(), made())
    monkeypatch.setattr(store, "RECIPE", store.RECIPE + 1)
    assert folder.find(task, Vehicle()) is None


def test_damaged_file_in_the_store_counts_as_none(tmp_path, task):
    folder = Store(tmp_path)
    folder.keep(task, Vehicle(), made())
    (path,) = tmp_path.iterdir()
    path.write_bytes(path.read_bytes()[:100])
    assert folder.find(task, Vehicle()) is None
    path.write_bytes(b"")
    assert folder.find(task, Vehicle()) is None


def test_store_in_a_place_that_cannot_be(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(FileError, match="file"):
        Store(tmp_path / "file" / "work")


# the command


def shipped_make(task, vehicle):
    """The shipped inputs, in place of the solver."""
    library = default_library()
    ends = (library.trim(*trim.key) for trim in (task.first, task.last))
    return Made(library.manoeuvre(*ends).controls, 0.1, 1e-14)


def test_interrupted_run_goes_on_where_it_was(tmp_path, monkeypatch, capsys):
    pytest.importorskip("casadi")
    path, count = tmp_path / "own.npz", []
    arguments = ["--output", str(path), "--work", str(tmp_path / "work")]

    def stopped_at_the_third(task, vehicle):
        count.append(task.name)
        if len(count) == 3:
            raise KeyboardInterrupt
        return shipped_make(task, vehicle)

    monkeypatch.setattr(running, "make", stopped_at_the_third)
    assert main(arguments) == 130
    assert "again" in capsys.readouterr().err
    assert not path.exists()
    assert main(arguments) == 0
    assert len(count) == 3 + 54  # of 56, two had been kept
    assert count[3] == count[2]
    assert "56 manoeuvres in" in capsys.readouterr().out
    first = path.read_bytes()
    assert main(arguments) == 0
    assert len(count) == 57
    assert path.read_bytes() == first == SHIPPED.read_bytes()


def test_library_is_written_for_the_settings(tmp_path):
    pytest.importorskip("casadi")
    settings = read_settings(written(tmp_path, SMALL))
    path = tmp_path / "own.npz"
    job = settings.grid.tasks(settings.vehicle)[4]
    assert job.name == "0 m/s to 0 m/s climb +1"
    running.write(path, settings, [running.Row(job, running.make(job, settings.vehicle))])
    library = PrimitiveLibrary.load(path)
    assert library.helicopter == Helicopter(9.0)
    assert library.limits == Limits(yaw_force=5.0)
    assert library.speeds.tolist() == [0.0]
    (found,) = library.manoeuvres
    assert found.last.climb == 1.0
    assert found.controls[:, 0].max() > Helicopter(9.0).weight


def test_only_some_are_made_and_no_library(tmp_path, monkeypatch, capsys):
    pytest.importorskip("casadi")
    monkeypatch.chdir(tmp_path)
    assert main(["--only", "0 m/s climb +", "--only", "to 0 m/s climb -2"]) == 0
    rows = [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()]
    made = [row for row in rows if " to " in row]
    # not those of 10 m/s, whose names have "0 m/s climb" too
    names = ["0 m/s to 0 m/s climb -2", "0 m/s to 0 m/s climb +2", "0 m/s climb +2 to 0 m/s"]
    assert made[-3:] == names
    assert not (tmp_path / "primitives.npz").exists()
    assert len(list((tmp_path / "runs" / "primitives").iterdir())) == 3


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["--only", "40 m/s"], "--only = ['40 m/s']"),
        (["--output", "nowhere/x.npz"], "--output = 'nowhere/x.npz'"),
        (["--settings", "nowhere.toml"], "nowhere.toml: No such file"),
        (["--nonsense"], "--nonsense"),
    ],
)
def test_wrong_use_ends_in_one_line(tmp_path, monkeypatch, capsys, arguments, problem):
    pytest.importorskip("casadi")
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 1
    error = capsys.readouterr().err
    assert problem in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_settings_are_shown_for_a_start(tmp_path, capsys):
    assert main(["--show-settings"]) == 0
    text = capsys.readouterr().out
    assert text.endswith("\n[manoeuvres]\nheight = 1.0\nreserve = 0.1\ndt = 0.02\n")
    assert read_settings(written(tmp_path, text)).vehicle == Vehicle()


def test_without_casadi_the_extra_is_named(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(sys.modules, "casadi", None)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ExtraError, match=r"ompl-risk\[primitives\]"):
        casadi()
    assert main([]) == 1
    assert "pip install 'ompl-risk[primitives]'" in capsys.readouterr().err
