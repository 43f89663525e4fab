"""`ompl-risk rank` on flights in NPZ files, as `plan --vehicle helicopter` writes them."""

import json
from pathlib import Path

import numpy as np
import pytest
from run_files import read_columns, read_ranking

from ompl_risk import InverseDistance, TerrainClearance, rank, simulation
from ompl_risk.cli import main
from ompl_risk.cli.inputs import read_input
from ompl_risk.errors import FileError
from ompl_risk.helicopter import Flight, Helicopter, HelicopterSteering, make_state, write_flight
from ompl_risk.trajectory_files import write_csv

JUDGED = ("--duration-tolerance", "0.3", "--uncertainty", "40", "--d0", "80")
HEIGHTS = {"high": 190.0, "low": 150.0, "middle": 170.0}


@pytest.fixture(scope="module")
def flights():
    """Three flights through the southern pass of the wall, one above the other."""
    steering = HelicopterSteering()
    return {
        name: steering.flight(
            np.array(
                [
                    steering.vertex_at((1000.0, 500.0, z), 0.0, speed=0.0),
                    steering.vertex_at((2000.0, 520.0, z - 20.0), 0.1, speed=20.0),
                ]
            )
        )
        for name, z in HEIGHTS.items()
    }


@pytest.fixture(scope="module")
def written(flights, tmp_path_factory):
    """The folders of the flights as NPZ, and as CSV every 0.1 s as `plan` writes chosen.csv."""
    npz, table = (tmp_path_factory.mktemp(kind) for kind in ("npz", "csv"))
    for name, flight in flights.items():
        write_flight(npz / f"{name}.npz", flight)
        write_csv(table / f"{name}.csv", flight.trajectory(name, step=0.1))
    return npz, table


def ranked(wall_file, files, out, *options):
    given = [str(file) for file in files]
    assert main(["rank", wall_file, *given, *JUDGED, *options, "--output", str(out)]) == 0
    return read_ranking(out)


def as_files(folder):
    return sorted(Path(folder).iterdir())


@pytest.fixture(scope="module")
def alone(wall_file, written, tmp_path_factory):
    """The folder of the ranking of the NPZ files."""
    out = tmp_path_factory.mktemp("alone") / "out"
    ranked(wall_file, as_files(written[0]), out)
    return out


def test_flights_rank_as_their_trajectories(wall_file, written, alone, tmp_path):
    npz, table = read_ranking(alone), ranked(wall_file, as_files(written[1]), tmp_path / "out")
    assert npz == table
    assert npz["orders"]["H1"] == ["high", "middle", "low"]
    for name in HEIGHTS:
        flown, read = (
            read_columns(folder / "trajectories" / f"{name}.csv")
            for folder in (alone, tmp_path / "out")
        )
        assert "gamma_r" in flown
        for column, values in flown.items():
            np.testing.assert_array_equal(values, read[column])


def test_the_ranking_is_that_of_every_state_of_the_flight(wall, flights, alone):
    trajectories = [flight.trajectory(name) for name, flight in flights.items()]
    coarse = read_ranking(alone)
    fine = rank(trajectories, TerrainClearance(wall, 5.0), InverseDistance(80.0))
    assert fine.orders["H1"] == tuple(coarse["orders"]["H1"])
    found = {t["name"]: t for t in coarse["trajectories"]}
    for one in fine.assessments:
        assert found[one.name]["norms"]["H1"] == pytest.approx(one.norms["H1"], rel=1e-3)
        assert found[one.name]["norms"]["L2"] == pytest.approx(one.norms["L2"], rel=1e-3)
        assert found[one.name]["duration"] == pytest.approx(one.duration, abs=1e-9)


def test_flights_and_trajectories_go_together(wall_file, written, alone, tmp_path, capsys):
    npz, table = written
    plain = tmp_path / "middle.npz"  # a trajectory, whatever else is in the file
    rows = np.genfromtxt(table / "middle.csv", delimiter=",", names=True)
    np.savez(plain, t=rows["t"], positions=np.column_stack([rows[a] for a in "xyz"]), states=[1])
    out = tmp_path / "out"
    mixed = ranked(wall_file, [npz / "high.npz", table / "low.csv", plain], out)
    expected = read_ranking(alone)
    assert mixed["orders"] == expected["orders"]
    found = {t["name"]: t["norms"] for t in mixed["trajectories"]}
    for t in expected["trajectories"]:
        assert found[t["name"]] == t["norms"]
    facts = json.loads((out / "provenance.json").read_text(encoding="utf-8"))
    assert facts["vehicles"] == {"high": "helicopter", "low": "point", "middle": "point"}
    assert facts["files"]["high"] == str(npz / "high.npz")
    assert "Flown by" not in capsys.readouterr().out


def test_rollouts_fly_the_helicopter_of_the_file(
    wall, wall_file, written, flights, tmp_path, capsys
):
    npz, table = written
    out = tmp_path / "out"
    options = ["--rollouts", "100", "--disturbances", "severe"]
    ranked(wall_file, [table / "high.csv", npz / "low.npz", npz / "middle.npz"], out, *options)
    flown = json.loads((out / "closed_loop.json").read_text(encoding="utf-8"))
    found = {one["name"]: one for one in flown["paths"]}
    expected = simulation.closed_loop_probability(
        [
            flights["high"].trajectory("high", step=0.1),
            *(simulation.HelicopterPlan(flights[name], name=name) for name in ("low", "middle")),
        ],
        TerrainClearance(wall, 5.0),
        simulation.Disturbances.level("severe"),
        rollouts=100,
    )
    assert {one.name: one.to_dict() for one in expected} == found
    (point,) = simulation.closed_loop_probability(
        flights["low"].trajectory("low", step=0.1),
        TerrainClearance(wall, 5.0),
        simulation.Disturbances.level("severe"),
        rollouts=100,
    )
    assert point.to_dict() != found["low"]
    text = " ".join(capsys.readouterr().out.split())
    assert "Flown by the helicopter: low, middle; by a point: high." in text


@pytest.mark.parametrize(
    ("dt", "step"), [(0.02, 0.1), (0.1 / 11, 0.1), (0.03, 0.09), (0.1, 0.1), (0.25, 0.25)]
)
def test_flights_are_ranked_every_tenth_of_a_second_or_a_little_less(dt, step, tmp_path):
    hover = np.tile(make_state((10.0, 20.0, 30.0)), (101, 1))
    hover[:, 0] += 1e-3 * np.arange(101.0)
    file = tmp_path / "hover.npz"
    write_flight(file, Flight(dt, hover, np.zeros((100, 4)), hover))
    read = read_input(file, "H")
    assert read.trajectory.name == "H"
    assert read.vehicle == "helicopter"
    assert np.diff(read.trajectory.t)[:-1] == pytest.approx(step)
    assert read.trajectory.duration == pytest.approx(100 * dt)
    every = round(step / dt)
    assert read.trajectory.positions[1].tolist() == hover[every, :3].tolist()


def test_steps_of_next_to_no_time_are_ranked_as_one(tmp_path):
    hover = np.tile(make_state((10.0, 20.0, 30.0)), (11, 1))
    write_flight(tmp_path / "hover.npz", Flight(1e-320, hover, np.zeros((10, 4)), hover))
    assert len(read_input(tmp_path / "hover.npz", "H").trajectory) == 2


def changed(file, **arrays):
    with np.load(file) as given:
        arrays = {**{name: given[name] for name in given.files}, **arrays}
    np.savez(file, **{name: array for name, array in arrays.items() if array is not None})


@pytest.mark.parametrize(
    ("arrays", "parts"),
    [
        ({"goal": None}, ["no array goal", "expected a flight", "planned_times"]),
        ({"controls": np.zeros((3, 4))}, ["(4, 13)", "expected a flight"]),
        ({"format": np.array(7)}, ["format 7", "reads format 1"]),
        ({"states": None}, ["holds the arrays", "t, positions", "plan --vehicle helicopter"]),
    ],
)
def test_a_file_that_is_no_flight_is_named(wall_file, written, tmp_path, refused, arrays, parts):
    wrong = tmp_path / "wrong.npz"
    wrong.write_bytes((written[0] / "low.npz").read_bytes())
    changed(wrong, **arrays)
    if "states" in arrays:
        changed(wrong, planned=None)
    line = refused("rank", wall_file, written[0] / "high.npz", wrong)
    assert str(wrong) in line
    assert all(part in line for part in parts), line


def test_states_without_a_unit_quaternion_are_named(wall_file, written, flights, tmp_path, refused):
    wrong = tmp_path / "wrong.npz"
    states = flights["low"].states.copy()
    states[10, 3:7] *= 1.1
    write_flight(wrong, Flight(0.02, states, flights["low"].controls, states))
    line = refused("rank", wall_file, written[0] / "high.npz", wrong)
    assert f"{wrong}: orientations[2]" in line
    assert "unit quaternion" in line


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 no more", b"t,x,y,z\n0,1,2,3\n"])
def test_a_damaged_file_is_named(wall_file, written, tmp_path, refused, content):
    wrong = tmp_path / "wrong.npz"
    wrong.write_bytes(content)
    line = refused("rank", wall_file, written[0] / "high.npz", wrong)
    assert f"{wrong}: is no NPZ file of plain arrays" in line
    missing = tmp_path / "missing.npz"
    line = refused("rank", wall_file, written[0] / "high.npz", missing)
    assert f"{missing}: No such file" in line


def test_a_flight_beyond_the_limits_is_ranked_but_not_flown(
    wall_file, written, flights, tmp_path, refused
):
    low, wild = flights["low"], tmp_path / "wild.npz"
    controls = low.controls.copy()
    controls[7, 2] = 2.0
    write_flight(wild, Flight(low.dt, low.states, controls, low.planned))
    files, out = [written[0] / "high.npz", wild], tmp_path / "out"
    line = refused("rank", wall_file, *files, *JUDGED, "--rollouts", "10", "--output", out)
    assert f"{wild}: flight.controls[7] = 2.0: must be " in line
    assert "without --rollouts" in line
    assert not out.exists()
    assert ranked(wall_file, files, out)["orders"]["L2"] == ["high", "wild"]


def test_states_that_no_law_can_track_are_named(flights, tmp_path):
    low, wild = flights["low"], tmp_path / "wild.npz"
    states = low.states.copy()
    states[:, 7:] = 1e200
    write_flight(wild, Flight(low.dt, states, low.controls, states, helicopter=Helicopter()))
    with np.errstate(all="ignore"), pytest.raises(FileError, match=str(wild)):
        read_input(wild, "wild").plan()
