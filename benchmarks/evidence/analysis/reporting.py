"""From the Parquet to tables, figures and the results page, in one call."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from benchmarks.evidence.analysis.families import families
from benchmarks.evidence.analysis.figures.calibration import calibration_figure
from benchmarks.evidence.analysis.figures.fits import fit_curves
from benchmarks.evidence.analysis.figures.standing import differences, standing
from benchmarks.evidence.analysis.figures.strata import strata_figure
from benchmarks.evidence.analysis.findings import Findings, analyse
from benchmarks.evidence.analysis.page import page as written
from benchmarks.evidence.analysis.table import Table, read
from benchmarks.evidence.analysis.tables import Sheet, sheets, terminal
from benchmarks.evidence.analysis.truth import decided
from benchmarks.evidence.analysis.words import answer
from ompl_risk.report.style import save


def report(parquet: Path, output: Path, console: Console, *, page: Path | None = None) -> None:
    """Fit on the training units, judge on the test units, and write what was found.

    Writes ``tables.json`` into the output folder, and the page with its figures, which lie in a
    folder of the page's name beside it. If the units are too few to fit or judge anything, says so
    and writes nothing.

    Args:
        parquet: what the campaign wrote.
        output: folder, made if it is not there.
        console: gets the answer and the tables.
        page: where the page goes; ``evidence.md`` in the output folder if left out.

    Raises:
        FileError: the Parquet is not what the campaign writes.
    """
    table = read(Path(parquet))
    if reason := too_little(table):
        console.print(f"no report: {reason}", markup=False, soft_wrap=True)
        return
    findings = analyse(table, families())
    tables = tuple(sheets(findings))
    _tell(findings, tables, console)
    Path(output).mkdir(parents=True, exist_ok=True)
    page = Path(output) / "evidence.md" if page is None else Path(page)
    page.parent.mkdir(parents=True, exist_ok=True)
    figures = _draw(findings, page)
    page.write_text(written(findings, tables, figures), encoding="utf-8")
    rows = json.dumps([sheet._asdict() for sheet in tables], indent=1, ensure_ascii=False)
    (Path(output) / "tables.json").write_text(rows + "\n", encoding="utf-8")
    console.print(f"{page}, {Path(output) / 'tables.json'}", markup=False, soft_wrap=True)


def too_little(table: Table) -> str:
    """Why nothing can be fitted, or judged; empty if something can."""
    if not decided(table.part("train")).any():
        return "there is no training set in which the flights' probabilities certainly differ"
    return "" if len(table.part("test")) else "there is no complete test unit among so few units"


def _draw(findings: Findings, page: Path) -> dict[str, str]:
    """Draw the figures; their paths as the page links them, by the heading they belong to."""
    folder = page.parent / page.stem
    folder.mkdir(exist_ok=True)
    drawn = {
        "Scores": ("settings.png", standing(findings)),
        "Fitted on training": ("fit.png", fit_curves(findings.fit)),
        "Recommended setting less": ("gain.png", differences(findings)),
        "Where settings win and lose: finds the safest": ("strata.png", strata_figure(findings)),
    }
    if findings.calibration:
        drawn["Calibration"] = ("calibration.png", calibration_figure(findings))
    for name, figure in drawn.values():
        save(figure, folder / name)
    return {heading: f"{folder.name}/{name}" for heading, (name, _) in drawn.items()}


def _tell(findings: Findings, tables: Sequence[Sheet], console: Console) -> None:
    for sheet in tables:
        console.print(terminal(sheet))
    for paragraph in answer(findings):
        console.print(paragraph.replace("**", ""), markup=False)
