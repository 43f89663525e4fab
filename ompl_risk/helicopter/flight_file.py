"""The file of a flight: everything that it takes to replay it to the last bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.library_file import DAMAGE
from ompl_risk.helicopter.parameters import Helicopter

FORMAT = 1
"""Version of the file's format."""

GAP = 0.1
"""How far a state may be from where the velocities lead [m]: curves bend that little in a step."""

ARRAYS = "dt", "states", "controls", "planned", "planned_times", "goal"


def write_flight(path: str | Path, flight: Flight) -> None:
    """Write a flight: inputs, states, the plan, and what flew.

    Args:
        path: the NPZ file to write; its folder must exist. Other programs find there ``dt`` [s],
            ``states`` (n + 1, 13), ``controls`` (n, 4), ``planned`` (n + 1, 13) at
            ``planned_times`` (n + 1,), ``goal`` (13,), ``helicopter`` (13,) and ``format``.
        flight: the flight.

    Raises:
        FileError: the file cannot be written.
    """
    arrays = {name: getattr(flight, name) for name in ARRAYS}
    try:
        with Path(path).open("wb") as file:
            np.savez_compressed(file, format=FORMAT, helicopter=flight.helicopter.given, **arrays)
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None


def read_flight(path: str | Path) -> Flight:
    """Read what `write_flight` wrote.

    Raises:
        FileError: no such file, another format or version, arrays that do not make a flight, or
            states that do not follow from each other.
    """
    wanted = f"expected a flight: arrays format, helicopter, {', '.join(ARRAYS)}"
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        version = int(arrays["format"])
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except DAMAGE:
        raise FileError(path, "is no file of a flight", wanted) from None
    if version != FORMAT:
        raise FileError(path, f"format {version}", f"this version reads format {FORMAT}")
    try:
        flight = Flight(
            float(arrays["dt"]),
            arrays["states"],
            arrays["controls"],
            arrays["planned"],
            planned_times=arrays["planned_times"],
            goal=arrays["goal"],
            helicopter=_helicopter(arrays["helicopter"]),
        )
    except KeyError as error:
        raise FileError(path, f"no array {error.args[0]}", wanted) from None
    except (ArgumentError, TypeError) as error:
        raise FileError(path, str(error), wanted) from None
    gap, step = _greatest_gap(flight)
    if gap > GAP:
        what = f"the place jumps {gap:.3g} m off its velocity from states[{step}] to the next"
        raise FileError(path, what, f"states that follow from each other to {GAP:g} m")
    return flight


def _greatest_gap(flight: Flight) -> tuple[float, int]:
    """How far a state is from where the velocities lead from the one before it [m]; which one."""
    states = flight.states.copy()  # SciPy takes no read-only arrays
    velocity = Rotation.from_quat(states[:, 3:7]).apply(states[:, 7:10])
    way = 0.5 * flight.dt * (velocity[1:] + velocity[:-1])
    gaps = np.linalg.norm(np.diff(states[:, :3], axis=0) - way, axis=1)
    step = int(np.argmax(gaps))
    return float(gaps[step]), step


def _helicopter(given: np.ndarray) -> Helicopter:
    if given.shape != (13,):
        raise ArgumentError("helicopter.shape", given.shape, "(13,)")
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
