"""Reading trajectories from CSV, TUM and NPZ files, and writing CSV."""

from __future__ import annotations

import csv
import math
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats
from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.trajectory import UNIT_TOLERANCE, Trajectory

POSITION = ("t", "x", "y", "z")
ORIENTATION = ("qx", "qy", "qz", "qw")
VELOCITY = ("vx", "vy", "vz")
TUM = (*POSITION, *ORIENTATION)
FORMATS = (
    ".csv (header t,x,y,z), .tum or .txt (timestamp tx ty tz qx qy qz qw), .npz (t, positions)"
)
ROUNDED_UNIT = 1e-2
"""Quaternions in files are rounded: one whose norm is this close to 1 is normalised."""


def read_trajectory(path: str | Path, *, name: str | None = None) -> Trajectory:
    """Read a trajectory; the suffix of the file says how.

    * `.csv`: a header line with the columns t,x,y,z [s, m], in any order, and optionally
      qx,qy,qz,qw and vx,vy,vz [m/s]; other columns are ignored.
    * `.tum`, `.txt`: eight numbers a line, timestamp tx ty tz qx qy qz qw, by white space.
    * `.npz`: arrays t (n,), positions (n, 3), and optionally orientations (n, 4) and
      velocities (n, 3).

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
    """Write t,x,y,z, then qx,qy,qz,qw and vx,vy,vz where known, then extra columns.

    Every number is written so that reading it back gives the same float. Controls and the name
    are not written.

    Args:
        path: the file to write; its folder must exist.
        trajectory: what to write.
        columns: further columns by name, each of shape (n,), such as {"d": d, "f": f}.

    Raises:
        ArgumentError: a column of another length, or a name that is taken or is no word.
        FileError: the file cannot be written.
    """
    table: dict[str, FloatArray] = {}
    table.update(zip(POSITION, [trajectory.t, *trajectory.positions.T], strict=True))
    if trajectory.orientations is not None:
        table.update(zip(ORIENTATION, trajectory.orientations.T, strict=True))
    if trajectory.velocities is not None:
        table.update(zip(VELOCITY, trajectory.velocities.T, strict=True))
    for name, values in (columns or {}).items():
        if name in (*TUM, *VELOCITY) or not name.isidentifier():
            raise ArgumentError("columns", name, "a word that is not a column of its own yet")
        column = as_floats(f"columns[{name!r}]", values)
        if column.shape != trajectory.t.shape:
            raise ArgumentError(f"columns[{name!r}].shape", column.shape, f"{trajectory.t.shape}")
        table[name] = column
    rows = zip(*(column.tolist() for column in table.values()), strict=True)
    lines = [",".join(table), *(",".join(map(repr, row)) for row in rows), ""]
    try:
        Path(path).write_text("\n".join(lines), encoding="utf-8")
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None


def _read_csv(path: Path, name: str) -> Trajectory:
    rows = ((line, next(csv.reader([text]))) for line, text in _lines(path))
    line, header = next(rows, (1, []))
    header = [column.strip().lower() for column in header]
    known = _columns_of(path, line, header)
    return _build(path, name, known, _numbers(path, rows, header, known))


def _columns_of(path: Path, line: int, header: list[str]) -> tuple[str, ...]:
    """The columns that make up the trajectory, after checking that the header has them."""
    expected = "expected a header of t,x,y,z and optionally qx,qy,qz,qw and vx,vy,vz, by commas"
    doubled = sorted({c for c in header if header.count(c) > 1})
    if doubled:
        raise FileError(path, f"line {line}: columns {', '.join(doubled)} stand twice", expected)
    known = POSITION
    for group in (ORIENTATION, VELOCITY):
        if any(column in header for column in group):
            known += group
    missing = [column for column in known if column not in header]
    if missing:
        raise FileError(path, f"line {line}: no column {', '.join(missing)}", expected)
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
    """The cells of the known columns, shape (n, columns); times are checked to increase."""
    where = [header.index(column) for column in known]
    table: list[list[float]] = []
    for line, cells in rows:
        if len(cells) != len(header):
            raise FileError(
                path,
                f"line {line}: {len(cells)} values",
                f"expected {len(header)}: {', '.join(header)}",
            )
        row = [_number(path, line, header[i], cells[i]) for i in where]
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
        return np.stack([column[n] for n in names], axis=1) if names[0] in column else None

    orientations, velocities = group(ORIENTATION), group(VELOCITY)
    return Trajectory(
        table[:, 0],
        table[:, 1:4],
        name,
        orientations=None if orientations is None else _normalised(path, orientations),
        velocities=velocities,
    )


def _read_npz(path: Path, name: str) -> Trajectory:
    expected = "expected arrays t (n,), positions (n, 3), optionally orientations, velocities"
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
