"""What the evidence says: settings fitted on training units, judged on test units, written up."""

from benchmarks.evidence.analysis.reporting import report as report
