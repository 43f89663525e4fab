"""What several test files of the command line share."""

import json

import numpy as np

from ompl_risk.cli.compiling import LINE

QUICK = (
    "--start", "200", "1000", "--goal", "2800", "1000", "--ceiling", "200", "--min-clearance", "10",
    "--margin", "0.3", "--d0", "80", "--uncertainty", "70", "--effort", "0.1", "--workers", "1",
    "--searches", "length", "L1@20", "H1@20", "H1@40", "--count", "3",
    "--duration-tolerance", "0.3", "--planner", "portfolio",
)  # fmt: skip
"""A plan over the wall in this process, within a second."""


def read_ranking(folder):
    return json.loads((folder / "ranking.json").read_text(encoding="utf-8"))


def read_columns(path):
    """The columns of a CSV file by name."""
    table = np.genfromtxt(path, delimiter=",", names=True)
    return {name: table[name] for name in table.dtype.names}


def without_notice(errors):
    """The lines of the error stream but that on compilation, which comes if the cache is empty."""
    return [line for line in errors.splitlines() if line != LINE]
