"""The database that Planner Arena reads, made by OMPL's own script."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from benchmarks.campaign.ompl_log import RISK, SAMPLES
from benchmarks.campaign.store import Record
from ompl_risk.errors import FileError

SCRIPT = "ompl.ompl_benchmark_statistics"
"""What the command `ompl_benchmark_statistics` runs."""


class Content(NamedTuple):
    """What a database holds: its runs, those with a path, rows of progress, risk columns."""

    runs: int
    judged: int
    progress: int
    risk_columns: tuple[str, ...]


def write_database(path: Path, logs: Sequence[Path], records: Sequence[Record]) -> Content:
    """Feed logs to OMPL's script and check what has arrived.

    Args:
        path: of the database; one that is there is replaced in one go.
        logs: of `write_logs`.
        records: the runs in them.

    Raises:
        FileError: the script fails, or runs, risks or progress are missing in its database.
    """
    draft = path.with_suffix(".draft")
    draft.unlink(missing_ok=True)
    command = [sys.executable, "-m", SCRIPT, "-d", str(draft), *map(str, logs)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        last = (ran.stderr.strip().splitlines() or ["no message"])[-1]
        raise FileError(path, f"{SCRIPT} failed: {last}")
    found = content(draft)
    judged = sum(each["result"]["status"] == "solved" for each in records)
    columns = tuple(name.replace(" ", "_") for name in RISK.values())
    wanted = Content(len(records), judged, SAMPLES * len(records), columns)
    if found != wanted:
        raise FileError(path, f"holds {found} where {wanted} was given to {SCRIPT}")
    draft.replace(path)
    return found


def content(path: Path) -> Content:
    """Read what a database holds; a run counts as judged if every risk column has a number."""
    with closing(sqlite3.connect(path)) as database:
        there = [name for _, name, *_ in database.execute("PRAGMA table_info(runs)")]
        columns = tuple(c for name in RISK.values() if (c := name.replace(" ", "_")) in there)
        known = " AND ".join(f"{column} IS NOT NULL" for column in columns) or "0"
        runs, progress = (
            database.execute(f"SELECT COUNT(*) FROM {table}").fetchone()[0]
            for table in ("runs", "progress")
        )
        judged = database.execute(f"SELECT COUNT(*) FROM runs WHERE {known}").fetchone()[0]
    return Content(runs, judged, progress, columns)
