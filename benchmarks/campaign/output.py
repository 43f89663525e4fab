"""Everything that a campaign writes, made anew from its records."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.campaign.database import write_database
from benchmarks.campaign.figures import convergence_figure, matrix_figure, pareto_figure
from benchmarks.campaign.ompl_log import write_logs
from benchmarks.campaign.report import markdown
from benchmarks.campaign.store import SESSIONS, Store
from benchmarks.campaign.summary import Standing, standings, summary_rows
from benchmarks.campaign.table import Row, columns, curve_rows, write_csv, write_parquet
from ompl_risk.report.style import save


def write_all(store: Store, rows: Sequence[Row]) -> list[str]:
    """Write tables, figures, OMPL's logs and database into the campaign's folder.

    Args:
        store: the records.
        rows: the same as flat rows.

    Returns:
        What was written, in words.
    """
    folder, records = store.folder, list(store.records.values())
    everything = standings(rows)
    made = _write_tables(
        folder,
        {
            "runs": rows,
            "curves": curve_rows(records),
            "summary": summary_rows(everything),
        },
    )
    write_csv(folder / "columns.csv", columns())
    (folder / "summary.md").write_text(markdown(rows), encoding="utf-8")
    figures = _draw(folder / "figures", store, rows, everything)
    logs = write_logs(folder / "ompl", records, _began(folder))
    found = write_database(folder / "ompl" / "benchmark.db", logs, records)
    return [
        "summary.md, columns.csv",
        *made,
        f"figures/ ({figures} PNG)",
        f"ompl/*.log ({len(logs)}) and ompl/benchmark.db ({found.runs} runs, {found.judged} with "
        f"risk, {found.progress} rows of progress)",
    ]


def _write_tables(folder: Path, tables: dict[str, Sequence[dict[str, Any]]]) -> list[str]:
    made, missing = [], False
    for name, rows in tables.items():
        write_csv(folder / f"{name}.csv", rows)
        parquet = write_parquet(folder / f"{name}.parquet", rows)
        missing = missing or not parquet
        made.append(f"{name}.csv{' and .parquet' if parquet else ''}")
    return [*made, "no Parquet, as pyarrow is not installed"] if missing else made


def _draw(folder: Path, store: Store, rows: Sequence[Row], everything: Sequence[Standing]) -> int:
    folder.mkdir(exist_ok=True)
    scenes = list(dict.fromkeys(each["scene"] for each in rows))
    for scene in scenes:
        records = [e for e in store.records.values() if e["configuration"]["scene"] == scene]
        chosen = [each for each in rows if each["scene"] == scene]
        standing = [each for each in everything if each.scene == scene]
        save(convergence_figure(scene, records), folder / f"convergence-{scene}.png")
        save(matrix_figure(scene, standing), folder / f"matrix-{scene}.png")
        save(pareto_figure(scene, chosen), folder / f"pareto-{scene}.png")
    return 3 * len(scenes)


def _began(folder: Path) -> str:
    """When the campaign was started first, as OMPL writes dates."""
    with (folder / SESSIONS).open(encoding="utf-8") as file:
        started = json.loads(file.readline())["started"]
    return started[:19].replace("T", " ")
