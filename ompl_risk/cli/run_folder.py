"""The folder of a run: what went in, what came out, and with which versions."""

from __future__ import annotations

import json
import platform
import sys
from collections.abc import Mapping
from dataclasses import asdict
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ompl_risk.cli.config import to_toml
from ompl_risk.cli.settings import JudgeSettings
from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.trajectory_files import write_csv

if TYPE_CHECKING:
    from ompl_risk.probability import CollisionProfile
    from ompl_risk.ranking import Ranking

PACKAGES = (
    "ompl-risk", "ompl", "numpy", "scipy", "numba", "rasterio", "matplotlib", "joblib", "cyclopts",
)  # fmt: skip


CONFIG = "config.toml"

RESOLVED = "Resolved configuration"
"""What the comment at the top of a run's configuration begins with."""


class RunFolder:
    """Where a run's results are written; made at once, so that an obstacle shows early.

    Args:
        path: a folder that does not exist, is empty, or holds no more than the configuration of a
            run that was broken off; runs/TIME if None.

    Raises:
        ArgumentError: the folder holds something already.
        FileError: it cannot be made.
    """

    def __init__(self, path: Path | None) -> None:
        self.begin = datetime.now(timezone.utc)
        self.path = _unused() if path is None else path
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            occupied = any(not _is_resolved(entry) for entry in self.path.iterdir())
        except OSError as error:
            raise FileError(self.path, error.strerror or str(error)) from None
        if occupied:
            raise ArgumentError(
                "output", str(self.path), "a folder that is empty or does not exist"
            )

    def made(self, name: str) -> Path:
        """A folder in it, made if it is not there.

        Raises:
            FileError: it cannot be made.
        """
        path = self.path / name
        try:
            path.mkdir(exist_ok=True)
        except OSError as error:
            raise FileError(path, error.strerror or str(error)) from None
        return path

    def write_config(self, command: str, values: Mapping[str, Any]) -> None:
        """Write the resolved configuration."""
        comment = f"{RESOLVED}; repeat with: ompl-risk {command} --config config.toml"
        self._write(CONFIG, to_toml(values, comment))

    def write_trajectories(
        self, ranking: Ranking, profiles: Mapping[str, CollisionProfile]
    ) -> None:
        """Write each trajectory with d, f and the probability of collision at its samples."""
        folder = self.made("trajectories")
        for a in ranking.assessments:
            columns = {"d": a.d, "f": a.f, "pc": profiles[a.name].p}
            write_csv(folder / f"{_file_name(a.name)}.csv", a.trajectory, columns)

    def write_provenance(self, facts: Mapping[str, Any]) -> None:
        """Write versions, times and further facts."""
        end = datetime.now(timezone.utc)
        whole = {
            "started": self.begin.isoformat(timespec="seconds"),
            "seconds": round((end - self.begin).total_seconds(), 2),
            "arguments": sys.argv[1:],
            "versions": versions(),
            **facts,
        }
        self.write_json("provenance.json", whole)

    def write_json(self, name: str, data: Mapping[str, Any]) -> None:
        """Write plain data as strict JSON."""
        text = json.dumps(data, indent=2, allow_nan=False, ensure_ascii=False)
        self._write(name, text + "\n")

    def _write(self, name: str, text: str) -> None:
        try:
            (self.path / name).write_text(text, encoding="utf-8")
        except OSError as error:
            raise FileError(self.path / name, error.strerror or str(error)) from None


def settings_as_values(terrain: str, settings: JudgeSettings) -> dict[str, Any]:
    """The settings that make up a run's configuration: all but where it is written.

    The path of a terrain file is made absolute, so that it means the same from any folder.
    """
    values = {"terrain": terrain, **asdict(settings)}
    del values["output"]
    path = Path(terrain)
    values["terrain"] = str(path.resolve()) if path.is_file() else terrain
    return values


def versions() -> dict[str, str]:
    """Python, the platform and the packages that results depend on."""
    found = {"python": platform.python_version(), "platform": platform.platform()}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "not installed"
    return found


def _is_resolved(path: Path) -> bool:
    """Whether that is the configuration which a run wrote when it began."""
    if path.name != CONFIG or not path.is_file():
        return False
    with path.open("rb") as file:
        return file.readline().startswith(f"# {RESOLVED}".encode())


def _unused() -> Path:
    """A folder named by the time, with a number if there is one already."""
    base = Path("runs") / datetime.now().strftime("%Y-%m-%dT%H-%M-%S")
    path, k = base, 1
    while path.exists():
        k += 1
        path = base.with_name(f"{base.name}-{k}")
    return path


def _file_name(name: str) -> str:
    """A trajectory's name as a file name."""
    return "".join(c if c.isalnum() or c in "-_. " else "_" for c in name)
