"""The command line: `ompl-risk plan`, `rank`, `table1` and `doctor`."""

from ompl_risk.cli.entry import main as main
