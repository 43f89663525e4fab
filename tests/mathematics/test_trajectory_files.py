import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.trajectory import Trajectory
from ompl_risk.trajectory_files import read_trajectory, write_csv

number = st.floats(allow_nan=False, allow_infinity=False)


@pytest.fixture
def write(tmp_path):
    def write(name, content):
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write


def test_csv_with_comments_spaces_and_other_columns(write):
    text = "# made by hand\nNote, Z ,t,x,y\n\nstart,1,0,2,3\n# half way\nend,4,10,5,6\n"
    trajectory = read_trajectory(write("first flight.csv", "\ufeff" + text))
    np.testing.assert_array_equal(trajectory.t, [0, 10])
    np.testing.assert_array_equal(trajectory.positions, [[2, 3, 1], [5, 6, 4]])
    assert trajectory.name == "first flight"
    assert trajectory.orientations is None
    assert trajectory.velocities is None


def test_csv_with_orientations_and_velocities(write):
    header = "t,x,y,z,qx,qy,qz,qw,vx,vy,vz"
    path = write("a.CSV", f"{header}\r\n0,1,2,3,0,0,0.6,0.8,7,8,9\r\n1,1,2,3,0,0,0,1,7,8,9\r\n")
    trajectory = read_trajectory(path, name="B")
    np.testing.assert_array_equal(trajectory.orientations, [[0, 0, 0.6, 0.8], [0, 0, 0, 1]])
    np.testing.assert_array_equal(trajectory.velocities, [[7, 8, 9]] * 2)
    assert trajectory.name == "B"


@pytest.mark.parametrize("suffix", [".tum", ".txt"])
def test_tum_keeps_absolute_times_and_normalises_rounded_quaternions(write, suffix):
    text = (
        "# timestamp tx ty tz qx qy qz qw\n"
        "1700000000.25 1 2 3 0 0 0.707 0.707\n1700000000.50\t4 5 6  0 0 0 1\n"
    )
    trajectory = read_trajectory(write("slam" + suffix, text))
    np.testing.assert_array_equal(trajectory.t, [1700000000.25, 1700000000.5])
    np.testing.assert_array_equal(trajectory.positions, [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_allclose(trajectory.orientations[0], [0, 0, 0.5**0.5, 0.5**0.5], rtol=1e-15)


def test_npz(tmp_path):
    t, positions = np.arange(3.0), np.arange(9.0).reshape(3, 3)
    turn = np.tile([0.0, 0.0, 1.0, 0.0], (3, 1))
    np.savez(tmp_path / "a.npz", t=t, positions=positions, orientations=turn, velocities=positions)
    trajectory = read_trajectory(tmp_path / "a.npz")
    np.testing.assert_array_equal(trajectory.poses, np.hstack([positions, turn]))
    np.testing.assert_array_equal(trajectory.velocities, positions)
    np.savez(tmp_path / "b.npz", t=t, positions=positions)
    assert read_trajectory(str(tmp_path / "b.npz")).orientations is None


@given(
    st.lists(number, min_size=2, max_size=5, unique=True).map(sorted),
    st.lists(number, min_size=15, max_size=15),
)
def test_written_csv_reads_back_to_the_last_bit(tmp_path_factory, t, numbers):
    n = len(t)
    positions = np.array(numbers[: 3 * n]).reshape(n, 3)
    q = np.random.default_rng(n).normal(size=(n, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    original = Trajectory(t, positions, "A", orientations=q, velocities=-positions)
    path = tmp_path_factory.mktemp("csv") / "A.csv"
    write_csv(path, original, {"d": np.arange(n), "f": np.full(n, math.inf)})
    again = read_trajectory(path)
    for field in ("t", "positions", "orientations", "velocities"):
        assert getattr(again, field).tobytes() == getattr(original, field).tobytes()
    assert again.name == "A"
    lines = path.read_text().splitlines()
    assert lines[0] == "t,x,y,z,qx,qy,qz,qw,vx,vy,vz,d,f"
    assert lines[1].endswith(",0.0,inf")


NAMES = {1: "u1", 2: "u1,u2", 4: "u_c,u_psi,gamma_p,gamma_r", 5: "u1,u2,u3,u4,u5"}


@pytest.mark.parametrize("count", NAMES)
@pytest.mark.parametrize("held", [True, False])
@settings(max_examples=20)
@given(st.lists(number, min_size=15, max_size=15))
def test_controls_read_back_to_the_last_bit(tmp_path_factory, count, held, numbers):
    n = 3
    controls = np.array(numbers)[: (n - held) * count].reshape(n - held, count)
    original = Trajectory(np.arange(3.0), np.zeros((n, 3)), "A", controls=controls)
    path = tmp_path_factory.mktemp("csv") / "A.csv"
    write_csv(path, original, {"wx": np.arange(n), "d": np.arange(n)})
    again = read_trajectory(path)
    assert again.controls.shape == controls.shape
    assert again.controls.tobytes() == original.controls.tobytes()
    lines = path.read_text().splitlines()
    assert lines[0] == f"t,x,y,z,{NAMES[count]},wx,d"
    assert lines[-1].endswith("," * (count + 1) + "2.0,2.0") == held
    assert again.orientations is None


def test_a_whole_flight_reads_back(tmp_path):
    rng = np.random.default_rng(4)
    q = rng.normal(size=(5, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    flight = Trajectory(
        0.02 * np.arange(5),
        rng.normal(size=(5, 3)),
        orientations=q,
        velocities=rng.normal(size=(5, 3)),
        controls=rng.normal(size=(4, 4)),
    )
    write_csv(tmp_path / "a.csv", flight)
    fields = ("t", "positions", "orientations", "velocities", "controls")
    np.savez(tmp_path / "a.npz", **{field: getattr(flight, field) for field in fields})
    for name in ("a.csv", "a.npz"):
        again = read_trajectory(tmp_path / name)
        for field in fields:
            np.testing.assert_array_equal(getattr(again, field), getattr(flight, field))


def test_columns_of_controls_in_any_order_beside_others(write):
    text = "u2,t,note,x,y,z,u1,u0,u01\n2,0,a,0,0,0,1,7,7\n4,1,b,0,0,0,3,7,7\n ,2,c,0,0,0,,7,7\n"
    controls = read_trajectory(write("a.csv", text)).controls
    np.testing.assert_array_equal(controls, [[1, 2], [3, 4]])  # held: n - 1 of them


HEADER = "t,x,y,z\n"


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.csv", "", "line 1: no column t, x, y, z"),
        ("a.csv", "t,x,y\n0,0,0\n", "line 1: no column z; expected a header of t,x,y,z"),
        ("a.csv", "t;x;y;z\n0;0;0;0\n", "line 1: no column t, x, y, z.*by commas"),
        ("a.csv", "#\nt,x,y,z,qx,qw\n", "line 2: no column qy, qz"),
        ("a.csv", "t,x,y,z,vx\n", "line 1: no column vy, vz"),
        ("a.csv", "t,x,y,z,x\n", "line 1: columns x stand twice"),
        ("a.csv", "0,9,9,1\n5,9,8,1\n", "line 1: no column t, x, y, z; expected a header"),
        ("a.csv", "t,x,y,z,u_c,gamma_p\n", "line 1: no column u_psi, gamma_r; expected"),
        ("a.csv", "t,x,y,z,u1,u3\n", "line 1: no column u2"),
        ("a.csv", "t,x,y,z,u999999999\n", "line 1: no column u1;"),
        (
            "a.csv",
            "t,x,y,z,u_c,u_psi,gamma_p,gamma_r,u1\n",
            "line 1: both u_c and u1; controls have one set of names",
        ),
        ("a.csv", "t,x,y,z,u1\n0,0,0,0,nan\n", "line 2: u1 = nan; must be finite"),
        (
            "a.csv",
            "t,x,y,z,u1\n0,0,0,0,\n#\n1,0,0,0,1\n",
            "line 2: no controls; only the last line may lack them",
        ),
        (
            "a.csv",
            "t,x,y,z,u1,u2\n0,0,0,0,1,2\n1,0,0,0,,2\n",
            "line 3: u1 = ''; must be a number",
        ),
        ("a.csv", HEADER + "0,0,0,0\n1,0,up,0\n", "line 3: y = 'up'; must be a number"),
        ("a.csv", HEADER + "0,0,0,0\n1,0,,0\n", "line 3: y = ''; must be a number"),
        ("a.csv", HEADER + "0,0,0,nan\n", "line 2: z = nan; must be finite"),
        ("a.csv", HEADER + "0,-inf,0,0\n", "line 2: x = -inf; must be finite"),
        ("a.csv", HEADER + "0,0,0,0\n1,0,0\n", "line 3: 3 values; expected 4: t, x, y, z"),
        (
            "a.csv",
            HEADER + "1,0,0,0\n#\n0.5,0,0,0\n",
            "line 4: t = 0.5 follows t = 1.0; times must",
        ),
        ("a.csv", HEADER + "1,0,0,0\n1,0,0,0\n", "line 3: t = 1.0 follows t = 1.0"),
        ("a.csv", HEADER + "1,0,0,0\n", "1 rows of numbers; a trajectory has at least two"),
        ("a.csv", b"\xff\xfe\x00\x01", "is not text"),
        (
            "a.csv",
            "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,2\n",
            "sample 2: quaternion .* norm 2; it must be 1",
        ),
        ("a.tum", "0 0 0 0 0 0 0 1\n1 0 0 0\n", "line 2: 4 values; expected 8: t, x, y, z, qx"),
        ("a.txt", "0 0 0 0 0 0 0 one\n", "line 1: qw = 'one'; must be a number"),
        ("a.tum", "0 0 0 0 0 0 0 0\n1 0 0 0 0 0 0 1\n", "sample 1: quaternion .* norm 0"),
        ("a.npz", b"PK\x03\x04 no archive", "is no NPZ file of plain arrays"),
        ("a.npz", b"", "is no NPZ file of plain arrays"),
        ("a.json", "{}", "format '.json' unknown; .csv"),
        ("trajectory", "", "format 'without suffix' unknown"),
    ],
)
def test_files_that_are_refused(write, name, content, words):
    with pytest.raises(FileError, match=words) as caught:
        read_trajectory(write(name, content))
    assert name in str(caught.value)


def test_missing_files_and_folders(tmp_path):
    with pytest.raises(FileError, match=r"none.csv: No such file"):
        read_trajectory(tmp_path / "none.csv")
    with pytest.raises(FileError, match=r"none.npz: No such file"):
        read_trajectory(tmp_path / "none.npz")
    with pytest.raises(FileError, match="No such file"):
        write_csv(tmp_path / "no folder" / "a.csv", Trajectory([0, 1], np.zeros((2, 3))))


def test_npz_files_that_are_refused(tmp_path):
    path = tmp_path / "a.npz"
    np.savez(path, t=[0, 1], xyz=np.zeros((2, 3)))
    with pytest.raises(FileError, match=r"no array positions among \['t', 'xyz'\]"):
        read_trajectory(path)
    np.savez(path, t=[0, 1], positions=np.zeros((2, 2)))
    with pytest.raises(FileError, match=r"a.npz: positions.shape = \(2, 2\)"):
        read_trajectory(path)
    np.savez(path, t=[0, math.nan], positions=np.zeros((2, 3)))
    with pytest.raises(FileError, match=r"t\[1\] = nan"):
        read_trajectory(path)
    np.savez(path, t=[0, 1], positions=np.zeros((2, 3)), orientations=np.ones((2, 4)))
    with pytest.raises(FileError, match=r"sample 1: quaternion .* norm 2"):
        read_trajectory(path)
    np.savez(path, t=[0, 1], positions=np.zeros((2, 3)), controls=np.zeros((3, 4)))
    with pytest.raises(FileError, match=r"a.npz: controls.shape = \(3, 4\).*\(1, m\)"):
        read_trajectory(path)
    np.savez(path, t=np.array([{}, {}]), positions=np.zeros((2, 3)))
    with pytest.raises(FileError, match="plain arrays"):
        read_trajectory(path)
    with path.open("wb") as file:
        np.save(file, np.zeros(3))
    with pytest.raises(FileError, match="single array"):
        read_trajectory(path)


def test_columns_that_write_csv_refuses(tmp_path):
    trajectory = Trajectory([0, 1], np.zeros((2, 3)))
    for name in ("x", "qw", "vx", "X", "u_c", "gamma_R", "u1", "u12", "a,b", ""):
        with pytest.raises(ArgumentError, match="columns = "):
            write_csv(tmp_path / "a.csv", trajectory, {name: [0, 1]})
    with pytest.raises(ArgumentError, match=r"columns\['d'\].shape = \(3,\): must be \(2,\)"):
        write_csv(tmp_path / "a.csv", trajectory, {"d": [0, 1, 2]})
    assert not (tmp_path / "a.csv").exists()
