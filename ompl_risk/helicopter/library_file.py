"""The file of a primitive library: what its manoeuvres are for, and their inputs."""

from __future__ import annotations

import dataclasses
import struct
import zipfile
import zlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats, positive, readonly
from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.trims import Key

FORMAT = 1
"""Version of the file's format."""

REMEDY = "make it anew: python -m ompl_risk.helicopter.optimal_control"

DAMAGE = (
    ValueError, EOFError, TypeError, AttributeError, KeyError, OverflowError, RuntimeError,
    zipfile.BadZipFile, zlib.error, struct.error,
)  # fmt: skip
"""What numpy and zipfile raise for a file that is damaged, or another kind of file."""

ARRAYS = {
    "format": (),
    "helicopter": (13,),
    "limits": (10,),
    "dt": (),
    "speeds": (None,),
    "turns": (None, 4),
    "climbs": (None,),
    "climb_counts": (None,),
    "first": (None, 3),
    "last": (None, 3),
    "lengths": (None,),
    "controls": (None, 4),
}
"""Arrays of the file and their shapes; climbs and controls are concatenated."""


class Inputs(NamedTuple):
    """The inputs that lead from one trim to another.

    Args:
        first: (speed, climb, turn) of the trim in which they begin.
        last: (speed, climb, turn) of the trim in which they end.
        controls: u_c [N], u_psi [N], gamma_p and gamma_r [rad], shape (n, 4).
    """

    first: Key
    last: Key
    controls: FloatArray


class Contents(NamedTuple):
    """What a library is made of; see `PrimitiveLibrary` for the fields."""

    helicopter: Helicopter
    limits: Limits
    dt: float
    speeds: FloatArray
    turns: FloatArray
    climbs: tuple[FloatArray, ...]
    manoeuvres: tuple[Inputs, ...]


def write_library(
    path: str | Path,
    helicopter: Helicopter,
    limits: Limits,
    dt: float,
    speeds: ArrayLike,
    turns: ArrayLike,
    climbs: Sequence[ArrayLike],
    manoeuvres: Iterable[tuple[ArrayLike, ArrayLike, ArrayLike]],
) -> None:
    """Write what a library is made of; `PrimitiveLibrary.load` reads and checks it.

    Args:
        path: the NPZ file to write; its folder must exist.
        helicopter: what flies.
        limits: what it may do.
        dt: time for which each input is held [s].
        speeds: speeds of the trims [m/s], shape (k,), increasing.
        turns: turn rates by speed [rad/s], shape (k, 4): hard right, gentle right, gentle left,
            hard left.
        climbs: climb rates by speed, other than 0 [m/s], k of them.
        manoeuvres: triples of first key, last key and controls (n, 4), a key being (speed, climb,
            turn); without those to the right, which are mirrored.

    Raises:
        ArgumentError: an array of another shape, or a number that is not finite.
        FileError: the file cannot be written.
    """
    manoeuvres = list(manoeuvres)
    rows = [(*_key("first", a), *_key("last", b)) for a, b, _ in manoeuvres]
    parts = [readonly("controls", c, (None, 4), "(n, 4)") for *_, c in manoeuvres]
    speeds = readonly("speeds", speeds, (None,), "(k,)")
    turns = readonly("turns", turns, (len(speeds), 4), f"({len(speeds)}, 4)")
    climbs = [readonly(f"climbs[{k}]", c, (None,), "(n,)") for k, c in enumerate(climbs)]
    if len(climbs) != len(speeds):
        raise ArgumentError("len(climbs)", len(climbs), f"{len(speeds)}, one for each speed")
    keys = np.array(rows, dtype=np.float64).reshape(-1, 6)
    arrays = {
        "format": np.array(FORMAT),
        "helicopter": helicopter.given,
        "limits": _numbers_of(limits),
        "dt": np.array(positive("dt", dt)),
        "speeds": speeds,
        "turns": turns,
        "climbs": np.concatenate([np.empty(0), *climbs]),
        "climb_counts": np.array([len(c) for c in climbs], dtype=np.int64),
        "first": keys[:, :3],
        "last": keys[:, 3:],
        "lengths": np.array([len(c) for c in parts], dtype=np.int64),
        "controls": np.concatenate([np.empty((0, 4)), *parts]),
    }
    try:
        with Path(path).open("wb") as file:
            np.savez_compressed(file, **arrays)
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None


def read_library(path: str | Path) -> Contents:
    """Read what `write_library` wrote.

    Raises:
        FileError: no such file, another format or version, or arrays that are missing, damaged or
            do not fit together; names them.
    """
    arrays = _arrays(Path(path))
    try:
        counts, lengths = (
            _counts(arrays, "climb_counts", "climbs"),
            _counts(arrays, "lengths", "controls"),
        )
        keys = [_keys(arrays, name) for name in ("first", "last")]
        parts = np.split(arrays["controls"], np.cumsum(lengths)[:-1]) if len(lengths) else []
        climbs = np.split(arrays["climbs"], np.cumsum(counts)[:-1]) if len(counts) else []
        return Contents(
            _helicopter(arrays["helicopter"]),
            _limits(arrays["limits"]),
            float(arrays["dt"]),
            arrays["speeds"],
            arrays["turns"],
            tuple(climbs),
            tuple(Inputs(*row) for row in zip(*keys, parts, strict=True)),
        )
    except ValueError as error:  # an ArgumentError too
        raise FileError(path, str(error), REMEDY) from None


def _key(name: str, value: ArrayLike) -> Key:
    return Key(*readonly(name, value, (3,), "(speed, climb, turn)").tolist())


def _keys(arrays: Mapping[str, FloatArray], name: str) -> list[Key]:
    """The keys of all manoeuvres."""
    count = len(arrays["lengths"])
    rows = readonly(name, arrays[name], (count, 3), f"({count}, 3), as lengths has {count}")
    return [Key(*row) for row in rows.tolist()]


def _arrays(path: Path) -> Mapping[str, FloatArray]:
    """The arrays of the file, of the shapes that they must have, in a version that is known."""
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            found: dict[str, Any] = {name: file[name] for name in file.files}
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except DAMAGE:
        raise FileError(path, "is no NPZ file of plain arrays", REMEDY) from None
    missing = [name for name in ARRAYS if name not in found]
    if "format" not in missing and found["format"].tolist() != FORMAT:
        version = found["format"].tolist()
        raise FileError(path, f"format = {version!r}: this version reads {FORMAT}", REMEDY)
    if missing:
        raise FileError(path, f"no array {', '.join(missing)} among {sorted(found)}", REMEDY)
    try:
        return {
            name: readonly(name, found[name], shape, _in_words(shape))
            for name, shape in ARRAYS.items()
        }
    except ArgumentError as error:
        raise FileError(path, str(error), REMEDY) from None


def _in_words(shape: tuple[int | None, ...]) -> str:
    return str(shape).replace("None", "n") if shape else "a single number"


def _counts(arrays: Mapping[str, FloatArray], name: str, rows: str) -> list[int]:
    """Lengths of the parts of a concatenated array, which they must add up to."""
    counts, total = arrays[name], len(arrays[rows])
    if (counts != np.floor(counts)).any() or (counts < 0.0).any() or counts.sum() != total:
        allowed = f"whole numbers, 0 or more, that add up to the {total} rows of {rows}"
        raise ArgumentError(name, counts.tolist(), allowed)
    return counts.astype(np.int64).tolist()


def _helicopter(given: FloatArray) -> Helicopter:
    mass, j1, j2, j3, hub, tail, gravity, *rest = given.tolist()
    return Helicopter(
        mass,
        inertia=(j1, j2, j3),
        hub=hub,
        tail=tail,
        gravity=gravity,
        drag=rest[:3],
        wind=rest[3:],
    )


def _numbers_of(limits: Limits) -> FloatArray:
    (low, high), *rest = (getattr(limits, f.name) for f in dataclasses.fields(limits))
    return as_floats("limits", [low, high, *rest])


def _limits(numbers: FloatArray) -> Limits:
    low, high, *rest = numbers.tolist()
    names = [f.name for f in dataclasses.fields(Limits)][1:]
    return Limits(lift=(low, high), **dict(zip(names, rest, strict=True)))
