"""Reading trajectories from CSV, TUM and NPZ files, and writing CSV."""

from __future__ import annotations

import csv
import math
import zipfile
from collections.abc import Iterator, Mapping
from itertools import zip_longest
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats
from ompl_risk._columns import (
    HELICOPTER,
    ORIENTATION,
    POSITION,
    TUM,
    VELOCITY,
    control_columns,
    expected_columns,
    is_control,
    is_known,
)
from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.trajectory import UNIT_TOLERANCE, Trajectory

FORMATS = (
    ".csv (header t,x,y,z), .tum or .txt (timestamp tx ty tz qx qy qz qw), .npz (t, positions)"
)
ROUNDED_UNIT = 1e-2
"""Quaternions in files are rounded: one whose norm is this close to 1 is normalised."""


def read_trajectory(path: str | Path, *, name: str | None = None) -> Trajectory:
    """Read a trajectory; the suffix of the file says how.

    * `.csv`: a header line with the columns t,x,y,z [s, m], in any order, and optionally
      qx,qy,qz,qw, vx,vy,vz [m/s] and controls, which are either u_c,u_psi,gamma_p,gamma_r or
      u1,u2 and so on; other columns are ignored. Where the controls of the last line, and only
      there, are empty, they are held over the intervals: n - 1 controls for n times.
    * `.tum`, `.txt`: eight numbers a line, timestamp tx ty tz qx qy qz qw, by white space.
    * `.npz`: arrays t (n,), positions (n, 3), and optionally orientations (n, 4), velocities
      (n, 3) and controls (n, m) (samples) or (n - 1, m) (held).

    In text, empty lines and lines that start with # are skipped. Times are kept as they are.
    Quaternions within 1e-2 of unit norm are normalised, as files round them.

    Args:
        path: the file.
        name: name of the trajectory; the file's stem if None.

    Raises:
        FileError: no such file, another format, or a content that is no trajectory; names the line.
    """
    path = Path(path)
    readers = {".csv": _read_csv, ".tum": _read_tum, ".txt": _read_tum, ".npz": _read_npz}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise FileError(path, f"format {path.suffix or 'without suffix'!r} unknown", FORMATS)
    try:
        return reader(path, path.stem if name is None else name)
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except UnicodeDecodeError:
        raise FileError(path, "is not text", FORMATS) from None
    except (ArgumentError, csv.Error) as error:
        raise FileError(path, str(error)) from None


def write_csv(
    path: str | Path, trajectory: Trajectory, columns: Mapping[str, ArrayLike] | None = None
) -> None:
    """Write t,x,y,z, then qx,qy,qz,qw, vx,vy,vz and controls where known, then extra columns.

    Every number is written so that reading it back gives the same float. Four controls are
    u_c [N], u_psi [N], gamma_p and gamma_r [rad], the helicopter's; others are u1, u2 and so on.
    Controls held over the intervals stand in the line in which their interval begins, and are
    empty in the last line: none is in force after it. The name is not written.

    Args:
        path: the file to write; its folder must exist.
        trajectory: what to write.
        columns: further columns by name, each of shape (n,), such as {"d": d, "f": f}, or the
            angular velocities {"wx": ..., "wy": ..., "wz": ...}; a reader ignores them.

    Raises:
        ArgumentError: a column of another length, or a name that is taken or is no word.
        FileError: the file cannot be written.
    """
    table = _own_columns(trajectory)
    for name, values in (columns or {}).items():
        if is_known(name) or not name.isidentifier():
            raise ArgumentError("columns", name, "a word that is not a column of its own yet")
        column = as_floats(f"columns[{name!r}]", values)
        if column.shape != trajectory.t.shape:
            raise ArgumentError(f"columns[{name!r}].shape", column.shape, f"{trajectory.t.shape}")
        table[name] = column
    cells = zip_longest(*(map(repr, column.tolist()) for column in table.values()), fillvalue="")
    lines = [",".join(table), *map(",".join, cells), ""]
    try:
        Path(path).write_text("\n".join(lines), encoding="utf-8")
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None


def _own_columns(trajectory: Trajectory) -> dict[str, FloatArray]:
    """The trajectory's columns by name; those of held controls are one shorter than the others."""
    groups = [
        (POSITION[1:], trajectory.positions),
        (ORIENTATION, trajectory.orientations),
        (VELOCITY, trajectory.velocities),
    ]
    if trajectory.controls is not None:
        groups.append((control_columns(trajectory.controls.shape[1]), trajectory.controls))
    table = {"t": trajectory.t}
    for names, values in groups:
        if values is not None:
            table.update(zip(names, values.T, strict=True))
    return table


def _read_csv(path: Path, name: str) -> Trajectory:
    rows = ((line, next(csv.reader([text]))) for line, text in _lines(path))
    line, header = next(rows, (1, []))
    header = [column.strip().lower() for column in header]
    known = _columns_of(path, line, header)
    return _build(path, name, known, _numbers(path, rows, header, known))


def _columns_of(path: Path, line: int, header: list[str]) -> tuple[str, ...]:
    """The columns that make up the trajectory, after checking that the header has them."""
    expected = (
        "expected a header of t,x,y,z and optionally qx,qy,qz,qw, vx,vy,vz and controls "
        "(u_c,u_psi,gamma_p,gamma_r, or u1,u2 and so on), by commas"
    )
    known = expected_columns(header)
    missing = [column for column in known if column not in header]
    if missing:
        raise FileError(path, f"line {line}: no column {', '.join(missing)}", expected)
    doubled = sorted({c for c in header if header.count(c) > 1})
    if doubled:
        raise FileError(path, f"line {line}: columns {', '.join(doubled)} stand twice", expected)
    if HELICOPTER[0] in known and "u1" in known:
        raise FileError(path, f"line {line}: both u_c and u1", "controls have one set of names")
    return known


def _read_tum(path: Path, name: str) -> Trajectory:
    rows = ((line, text.split()) for line, text in _lines(path))
    return _build(path, name, TUM, _numbers(path, rows, list(TUM), TUM))


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Line numbers, from 1, and texts of the lines that say something."""
    with path.open(encoding="utf-8-sig") as file:
        for line, text in enumerate(file, start=1):
            if text.strip() and not text.lstrip().startswith("#"):
                yield line, text.strip()


def _numbers(
    path: Path, rows: Iterator[tuple[int, list[str]]], header: list[str], known: tuple[str, ...]
) -> FloatArray:
    """The cells of the known columns, shape (n, columns); times are checked to increase.

    Controls that are empty in the last line are NaN there.
    """
    where = [header.index(column) for column in known]
    controls = [header.index(column) for column in known if is_control(column)]
    table: list[list[float]] = []
    ended = 0  # the line without controls, which must be the last
    for line, cells in rows:
        if ended:
            raise FileError(path, f"line {ended}: no controls", "only the last line may lack them")
        if len(cells) != len(header):
            raise FileError(
                path,
                f"line {line}: {len(cells)} values",
                f"expected {len(header)}: {', '.join(header)}",
            )
        if controls and not any(cells[i].strip() for i in controls):
            ended = line
        row = [
            math.nan if ended and i in controls else _number(path, line, header[i], cells[i])
            for i in where
        ]
        if table and row[0] <= table[-1][0]:
            raise FileError(
                path,
                f"line {line}: t = {row[0]!r} follows t = {table[-1][0]!r}",
                "times must increase from line to line",
            )
        table.append(row)
    if len(table) < 2:
        raise FileError(path, f"{len(table)} rows of numbers", "a trajectory has at least two")
    return np.array(table)


def _number(path: Path, line: int, column: str, cell: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        raise FileError(path, f"line {line}: {column} = {cell!r}", "must be a number") from None
    if not math.isfinite(number):
        raise FileError(path, f"line {line}: {column} = {cell.strip()}", "must be finite")
    return number


def _build(path: Path, name: str, known: tuple[str, ...], table: FloatArray) -> Trajectory:
    column = dict(zip(known, table.T, strict=True))

    def group(names: tuple[str, ...]) -> FloatArray | None:
        found = [column[n] for n in names if n in column]
        return np.stack(found, axis=1) if found else None

    orientations, velocities = group(ORIENTATION), group(VELOCITY)
    controls = group(tuple(filter(is_control, known)))
    if controls is not None and np.isnan(controls[-1]).all():
        controls = controls[:-1]
    return Trajectory(
        table[:, 0],
        table[:, 1:4],
        name,
        orientations=None if orientations is None else _normalised(path, orientations),
        velocities=velocities,
        controls=controls,
    )


def _read_npz(path: Path, name: str) -> Trajectory:
    expected = (
        "expected arrays t (n,), positions (n, 3), optionally orientations, velocities, controls"
    )
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
    except (ValueError, EOFError, zipfile.BadZipFile):
        raise FileError(path, "is no NPZ file of plain arrays", expected) from None
    except (AttributeError, TypeError):  # a single array, as numpy.save writes it
        raise FileError(path, "holds a single array without names", expected) from None
    missing = [key for key in ("t", "positions") if key not in arrays]
    if missing:
        raise FileError(path, f"no array {', '.join(missing)} among {sorted(arrays)}", expected)
    orientations = arrays.get("orientations")
    if orientations is not None and orientations.ndim == 2:
        orientations = _normalised(path, as_floats("orientations", orientations))
    return Trajectory(
        arrays["t"],
        arrays["positions"],
        name,
        orientations=orientations,
        velocities=arrays.get("velocities"),
        controls=arrays.get("controls"),
    )


def _normalised(path: Path, q: FloatArray) -> FloatArray:
    """Unit quaternions, where the file's rounding alone has kept them from being it."""
    norms = np.linalg.norm(q, axis=1, keepdims=True)
    wrong = np.flatnonzero(~(np.abs(norms[:, 0] - 1) <= ROUNDED_UNIT))
    if len(wrong):
        i = int(wrong[0])
        raise FileError(
            path,
            f"sample {i + 1}: quaternion {q[i].tolist()} has norm {norms[i, 0]:.6g}",
            "it must be 1 (order x, y, z, w)",
        )
    exact = np.abs(norms - 1) <= UNIT_TOLERANCE  # kept to the last digit: files round-trip
    return np.where(exact, q, q / norms)
