"""How a diagnosis looks in a terminal."""

from __future__ import annotations

from rich.console import Group
from rich.table import Table
from rich.text import Text

from ompl_risk.bridge.doctor import Diagnosis, Verdict

STYLES = {
    Verdict.PRESENT: "yellow",
    Verdict.ABSENT: "green",
    Verdict.HOLDS: "green",
    Verdict.BROKEN: "bold red",
    Verdict.UNCLEAR: "magenta",
}


def diagnosis_table(diagnosis: Diagnosis) -> Group:
    """Versions, a table of findings, and the summary."""
    versions = ", ".join(f"{name} {number}" for name, number in diagnosis.versions.items())
    style = "bold" if diagnosis.healthy else STYLES[Verdict.BROKEN]
    return Group(Text(versions), _findings(diagnosis), Text(diagnosis.summary, style=style))


def _findings(diagnosis: Diagnosis) -> Table:
    table = Table(show_lines=False, pad_edge=False)
    for heading in ("", "tried", "what OMPL does here", "what ompl_risk does, or needs it for"):
        table.add_column(heading, overflow="fold")
    for row in diagnosis.rows:
        mark = Text(row.verdict.value, style=STYLES[row.verdict])
        table.add_row(mark, Text(row.trap), Text(row.observed), Text(row.handling))
    return table
