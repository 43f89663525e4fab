"""Trajectories and flights from files, as the command `rank` takes them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ompl_risk.cli.closed_loop import STEP
from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.flight_file import ARRAYS, read_flight
from ompl_risk.helicopter.library_file import DAMAGE
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan
from ompl_risk.trajectory import Trajectory
from ompl_risk.trajectory_files import read_trajectory

KINDS = (
    "expected a trajectory (arrays t, positions) or a flight as plan --vehicle helicopter writes "
    f"it (arrays format, helicopter, {', '.join(ARRAYS)})"
)


@dataclass(frozen=True, eq=False)
class Input:
    """What a file holds.

    Args:
        file: the file.
        trajectory: what is ranked.
        flight: what the trajectory was sampled from; None if the file holds a trajectory.
    """

    file: Path
    trajectory: Trajectory
    flight: Flight | None = None

    @property
    def vehicle(self) -> str:
        """What flies it in closed loop, as `plan` calls its vehicles."""
        return "point" if self.flight is None else "helicopter"

    def plan(self) -> Trajectory | HelicopterPlan:
        """What is flown in closed loop: the flight itself, or a trajectory that a point follows.

        Raises:
            FileError: a flight that its helicopter cannot track.
        """
        if self.flight is None:
            return self.trajectory
        try:
            return HelicopterPlan(self.flight, name=self.trajectory.name)
        except ValueError as error:  # also what linear algebra makes of states that are no flight
            remedy = "rank knows no other limits; without --rollouts it ranks the flight as it is"
            raise FileError(self.file, str(error), remedy) from None


def read_input(file: Path, name: str) -> Input:
    """Read a trajectory or a flight.

    The suffix of the file says how, see `read_trajectory`; of NPZ files the names of the arrays say
    which of the two they hold. A flight is ranked at the times at which `plan` ranks and writes it,
    every 0.1 s, or the nearest multiple of its own step below.

    Args:
        file: the file.
        name: name of the trajectory.

    Raises:
        FileError: no such file, another format, or a content that is neither.
    """
    if file.suffix.lower() != ".npz":
        return Input(file, read_trajectory(file, name=name))
    names = _array_names(file)
    if names and not names & {"positions", "states"}:
        raise FileError(file, f"holds the arrays {', '.join(sorted(names))}", KINDS)
    if "positions" in names or "states" not in names:
        return Input(file, read_trajectory(file, name=name))
    flight = read_flight(file)
    every = max(math.floor(min(STEP / flight.dt + 1e-9, len(flight))), 1)
    try:
        return Input(file, flight.trajectory(name, step=every * flight.dt), flight)
    except ArgumentError as error:
        raise FileError(file, str(error)) from None


def _array_names(file: Path) -> set[str]:
    """Names of the arrays in an NPZ file; none if it is not one: its reader says why."""
    try:
        with np.load(file, allow_pickle=False) as arrays:
            return set(arrays.files)
    except (OSError, *DAMAGE):
        return set()
