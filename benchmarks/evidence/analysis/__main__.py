"""``python -m benchmarks.evidence.analysis PARQUET [--output FOLDER] [--page PAGE.md]``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from benchmarks.evidence.analysis.reporting import report
from ompl_risk.errors import OmplRiskError


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the report.

    Returns:
        0; 2 if the Parquet cannot be reported on.
    """
    parser = argparse.ArgumentParser(
        "python -m benchmarks.evidence.analysis",
        description="Fit settings on a campaign's training units and judge them on its test units.",
    )
    parser.add_argument("parquet", type=Path, help="what the campaign wrote")
    parser.add_argument(
        "--output", type=Path, default=Path("runs/evidence/report"), help="(%(default)s)"
    )
    parser.add_argument("--page", type=Path, help="the results page (evidence.md in the output)")
    options = parser.parse_args(arguments)
    try:
        console = Console(width=None if sys.stdout.isatty() else 170, highlight=False)
        report(options.parquet, options.output, console, page=options.page)
    except (OmplRiskError, OSError) as error:
        Console(stderr=True).print(f"error: {error}", style="red", markup=False, soft_wrap=True)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
