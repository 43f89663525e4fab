"""Manoeuvres that have been made, kept in a folder, so that an interrupted run can go on."""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
from dataclasses import asdict
from pathlib import Path

import numpy as np

from ompl_risk.errors import FileError
from ompl_risk.helicopter.optimal_control.making import Made
from ompl_risk.helicopter.optimal_control.task import Task
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle

RECIPE = 3
"""To be raised when manoeuvres are made in another way: what is in the folder is then void."""


class Store:
    """A folder with a file for each manoeuvre, named by all that it depends on.

    Args:
        folder: the folder, which is made.

    Raises:
        FileError: it cannot be made.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise FileError(folder, error.strerror or str(error)) from None

    def find(self, task: Task, vehicle: Vehicle) -> Made | None:
        """The manoeuvre, if it has been made; None also if its file is damaged."""
        try:
            with np.load(self._path(task, vehicle), allow_pickle=False) as file:
                controls, (least, error) = file["controls"], file["figures"].tolist()
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        return Made(controls, least, error)

    def keep(self, task: Task, vehicle: Vehicle, made: Made) -> None:
        """Write a manoeuvre, whole or not at all.

        Raises:
            FileError: it cannot be written.
        """
        path = self._path(task, vehicle)
        part = path.with_name(f"{path.name}.{os.getpid()}.part")
        try:
            with part.open("wb") as file:
                np.savez(file, controls=made.controls, figures=np.array([made.least, made.error]))
            part.replace(path)
        except OSError as error:
            raise FileError(path, error.strerror or str(error)) from None

    def _path(self, task: Task, vehicle: Vehicle) -> Path:
        facts = [RECIPE, task.first.key, task.last.key, asdict(vehicle)]
        digest = hashlib.sha256(json.dumps(facts).encode()).hexdigest()
        return self._folder / f"{digest[:32]}.npz"
