"""A flight survives its file to the last bit; what is none is refused by name."""

import numpy as np
import pytest

from ompl_risk.errors import FileError
from ompl_risk.helicopter.flight_file import FORMAT, read_flight, write_flight
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.steering import HelicopterSteering


@pytest.fixture(scope="module")
def flight():
    steering = HelicopterSteering()
    chain = [
        steering.vertex_at((0.0, 0.0, 100.0), 0.0, speed=0.0),
        steering.vertex_at((500.0, 200.0, 120.0), 1.0, speed=20.0),
    ]
    return steering.flight(np.array(chain))


def test_a_flight_survives_its_file(flight, tmp_path):
    path = tmp_path / "flight.npz"
    write_flight(path, flight)
    again = read_flight(path)
    for name in ("states", "controls", "planned", "planned_times", "goal"):
        np.testing.assert_array_equal(getattr(again, name), getattr(flight, name))
    assert (again.dt, again.helicopter) == (flight.dt, flight.helicopter)
    np.testing.assert_array_equal(again.replay(), flight.states)


def test_another_helicopter_survives(flight, tmp_path):
    other = Helicopter(7.0, inertia=(0.2, 0.3, 0.4), drag=(0.1, 0.2, 0.3), wind=(1.0, 2.0, 3.0))
    path = tmp_path / "flight.npz"
    made = type(flight)(flight.dt, flight.states, flight.controls, flight.planned, helicopter=other)
    write_flight(path, made)
    assert read_flight(path).helicopter == other


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"format": np.array(FORMAT + 1)}, f"format {FORMAT + 1}.*reads format {FORMAT}"),
        ({"controls": np.zeros((3, 4))}, "planned|states"),
        ({"states": np.full((2, 13), np.nan)}, "states|planned"),
        ({"helicopter": np.ones(12)}, "helicopter.shape"),
        ({"helicopter": np.full(13, -1.0)}, "mass"),
        ({"goal": None}, "goal"),
        ({"format": None}, "no file of a flight"),
    ],
)
def test_a_wrong_file_is_named(change, says, flight, tmp_path):
    path = tmp_path / "flight.npz"
    write_flight(path, flight)
    with np.load(path) as file:
        arrays = {**{name: file[name] for name in file.files}, **change}
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    with pytest.raises(FileError, match=says):
        read_flight(path)


def test_states_that_jump_are_refused(flight, tmp_path):
    states = flight.states.copy()
    states[100:, 0] += 0.3
    made = type(flight)(flight.dt, states, flight.controls, flight.planned)
    write_flight(tmp_path / "flight.npz", made)
    with pytest.raises(FileError, match=r"jumps 0\.\d+ m off its velocity from states\[99\]"):
        read_flight(tmp_path / "flight.npz")


def test_no_file_and_no_npz_are_named(tmp_path):
    with pytest.raises(FileError, match="No such file"):
        read_flight(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("text")
    with pytest.raises(FileError, match="no file of a flight"):
        read_flight(tmp_path / "text.npz")


def test_a_folder_that_is_not_there_is_named(flight, tmp_path):
    with pytest.raises(FileError, match="No such file"):
        write_flight(tmp_path / "no" / "flight.npz", flight)
