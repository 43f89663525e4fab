"""A film of a flight, with the distance to obstacles running beside it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ompl_risk._arrays import FloatArray, positive, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.report.film_files import check_film_path, write_film
from ompl_risk.report.flight_film import Film
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.avoidance import Avoidance
    from ompl_risk.ranking.sampling import Clearance
    from ompl_risk.terrains import Terrain

FEWEST, MOST = 2, 1000
"""Frames of a film."""


def animate_flight(
    trajectory: Trajectory,
    terrain: Terrain,
    clearance: Clearance,
    path: str | Path,
    *,
    avoidance: Avoidance | None = None,
    begin: float | None = None,
    end: float | None = None,
    frames: int = 120,
    seconds: float = 12.0,
    index: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> None:
    """Write a film of a flight: the helicopter from behind, the map, d(t) and f(t).

    The camera is as far behind as the vehicle comes in a few frames, so a film of a whole flight
    is seen from farther away than one of a minute; the helicopter is drawn larger in proportion,
    and the film says how much. A dashed line leads to the nearest point of the ground if the
    clearance is a `TerrainClearance`.

    Args:
        trajectory: the flight; where it has no orientations, the helicopter is level.
        terrain: the ground.
        clearance: distance to obstacles.
        path: the file to write, .gif or .mp4.
        avoidance: f(d), drawn over time and with its d0 if given.
        begin: where the film begins [s], the flight's first time if None.
        end: where it ends [s], the flight's last time if None.
        frames: number of pictures, 2 to 1000.
        seconds: how long the film takes.
        index: of the flight's colour, as in the figures of a ranking.
        progress: called with the pictures done and their number after each.

    Raises:
        ArgumentError: a number out of range.
        ExtentError: the flight leaves the terrain.
        FileError: another suffix, an .mp4 without the program ffmpeg, or a file that cannot be
            written.
    """
    if isinstance(frames, bool) or not isinstance(frames, int) or not FEWEST <= frames <= MOST:
        raise ArgumentError("frames", frames, f"a whole number, {FEWEST} to {MOST}")
    seconds = positive("seconds", seconds)
    times = _times(trajectory, begin, end, frames)
    check_film_path(Path(path))
    film = Film(trajectory, terrain, clearance, avoidance, times, index)
    write_film(film, Path(path), seconds, progress)


def _times(
    trajectory: Trajectory, begin: float | None, end: float | None, frames: int
) -> FloatArray:
    first, last = float(trajectory.t[0]), float(trajectory.t[-1])
    allowed = f"a time within the flight's {first:g} to {last:g} s, begin before end"
    low = first if begin is None else real_number("begin", begin, allowed)
    high = last if end is None else real_number("end", end, allowed)
    if not first <= low < last:
        raise ArgumentError("begin", begin, allowed)
    if not low < high <= last:
        raise ArgumentError("end", end, allowed)
    return np.linspace(low, high, frames)
