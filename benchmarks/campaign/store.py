"""The folder of a campaign: one line for each finished run, kept whatever happens."""

from __future__ import annotations

import fcntl
import json
import math
import os
from collections.abc import Iterator, Mapping
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from benchmarks.campaign.run import Run, code, configuration, key
from ompl_risk.errors import ArgumentError, FileError

RUNS, SESSIONS = "runs.jsonl", "sessions.jsonl"

Record = dict[str, Any]


class Store:
    """Finished runs, in a file that only grows; open it in a `with` statement.

    A run's line is written and synced to the disk in one go, with its whole configuration. If the
    campaign is killed while it writes, what is left of the line is cut off when the file is opened
    again, and that run counts as not done.

    Args:
        folder: where; made if it does not exist.

    Raises:
        ArgumentError: the folder holds something that is no campaign, or another process is
            writing to it.
        FileError: it cannot be read or written, or a line other than the last is broken.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._file = self._open()
        try:
            self.records: dict[tuple[str, str, str, int], Record] = {
                identity(record): record for record in self._read()
            }
        except BaseException:
            os.close(self._file)
            raise

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._file)  # gives the lock back

    def check(self, seconds: float) -> None:
        """Refuse to add to runs that were made otherwise than this program would make them.

        Args:
            seconds: time for each run that is now asked for.

        Raises:
            ArgumentError: names the first thing that differs.
        """
        for record in self.records.values():
            there = record["configuration"]
            try:
                here = configuration(Run(*identity(record), seconds=seconds))
            except KeyError as unknown:
                raise ArgumentError(
                    "output", str(self.folder), f"a folder without runs of {unknown}"
                ) from None
            if key(here) != record["key"]:
                what = " and ".join(_differences(there, json.loads(_line(here))))
                raise ArgumentError(
                    "output",
                    str(self.folder),
                    f"another folder, as this one holds runs of another configuration ({what})",
                )

    def add(self, run: Run, result: Mapping[str, Any]) -> Record:
        """Keep a finished run.

        Returns:
            Its record, as it would be read back.
        """
        facts = configuration(run)
        text = _line(
            {
                "key": key(facts),
                "configuration": facts,
                "code": code(),
                "finished": datetime.now(timezone.utc).isoformat(timespec="seconds"),
                "result": result,
            }
        )
        self._append(self._file, text)
        record = json.loads(text)
        self.records[run.identity] = record
        return record

    def log_session(self, facts: Mapping[str, Any]) -> None:
        """Keep what one start of the program was called with."""
        file = os.open(self.folder / SESSIONS, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        try:
            self._append(file, _line(facts))
        finally:
            os.close(file)

    def _open(self) -> int:
        path = self.folder / RUNS
        try:
            if self.folder.is_dir() and any(self.folder.iterdir()) and not path.exists():
                raise ArgumentError("output", str(self.folder), "a campaign's folder or a new one")
            self.folder.mkdir(parents=True, exist_ok=True)
            file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
        except OSError as error:
            raise FileError(path, error.strerror or str(error)) from None
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(file)
            allowed = "a folder to which no other campaign is writing"
            raise ArgumentError("output", str(self.folder), allowed) from None
        return file

    def _read(self) -> Iterator[Record]:
        path = self.folder / RUNS
        text = path.read_bytes()
        whole = text.rfind(b"\n") + 1
        if whole < len(text):
            os.ftruncate(self._file, whole)
        for number, line in enumerate(text[:whole].splitlines(), start=1):
            try:
                record = json.loads(line)
                identity(record)
            except (ValueError, KeyError, TypeError):
                raise FileError(path, f"line {number} is no record of a run") from None
            yield record

    def _append(self, file: int, text: str) -> None:
        data = text.encode() + b"\n"
        try:
            while data:
                data = data[os.write(file, data) :]
            os.fsync(file)
        except OSError as error:
            raise FileError(self.folder, error.strerror or str(error)) from None


def identity(record: Record) -> tuple[str, str, str, int]:
    """What there can be one run of in a folder: scene, objective, planner, seed."""
    facts = record["configuration"]
    return facts["scene"], facts["objective"], facts["planner"], facts["seed"]


def _line(value: Mapping[str, Any]) -> str:
    return json.dumps(_plain(value), ensure_ascii=False, allow_nan=False)


def _plain(value: Any) -> Any:
    """Strict JSON: numbers that it has no signs for become the words that `float` reads."""
    if isinstance(value, Mapping):
        return {str(name): _plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def _differences(there: Any, here: Any, name: str = "") -> Iterator[str]:
    """Such as "seconds: 5.0 there, 2.0 here"."""
    if isinstance(there, dict) and isinstance(here, dict):
        for part in [*there, *(k for k in here if k not in there)]:
            label = f"{name}.{part}" if name else part
            yield from _differences(there.get(part), here.get(part), label)
    elif there != here:
        yield f"{name}: {there} there, {here} here"
