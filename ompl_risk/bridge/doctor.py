"""Try the known traps on the OMPL that is installed, and tell what is done about each.

Each probe runs in a process of its own, with raw OMPL and a time limit, so a hang or a crash is
an observation like any other. Nothing here imports OMPL.
"""

from __future__ import annotations

import json
import platform
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from enum import Enum
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from ompl_risk.bridge.probes import ASSUMPTIONS, IMPORT, TRAPS, Probe

PACKAGES = ("ompl-risk", "ompl", "numpy", "numba", "scipy", "python-fcl", "trimesh", "rasterio")
PROCESSES = 2
REACHED = "reached "  # a probe prints it, and its own time limit [s], before the trap
RESULT = '{"good": '  # its finding starts so; OMPL and nanobind may print lines of their own
TIME_LIMIT = 60.0  # [s] a probe; it stops itself long before, by the timer in scene.reached()


class Verdict(str, Enum):
    """What a finding means."""

    PRESENT = "present"  # the trap is there
    ABSENT = "fixed"  # OMPL behaves as one would expect
    HOLDS = "holds"  # ompl_risk may rely on it
    BROKEN = "BROKEN"  # ompl_risk relies on it in vain
    UNCLEAR = "unclear"  # the probe did not get as far as the trap


@dataclass(frozen=True)
class Row:
    """One finding.

    Attributes:
        trap: what was tried.
        observed: what OMPL did.
        handling: what ompl_risk does about it, or needs it for.
        verdict: what the finding means.
    """

    trap: str
    observed: str
    handling: str
    verdict: Verdict


Progress = Callable[[Row, int, int], object]


@dataclass(frozen=True)
class Diagnosis:
    """All findings.

    Attributes:
        versions: of Python, the platform and the packages that matter.
        rows: the findings, traps first.
    """

    versions: dict[str, str]
    rows: tuple[Row, ...]

    @property
    def healthy(self) -> bool:
        """Whether ompl_risk can be used: no assumption is broken. Traps alone are no harm."""
        return not self._with(Verdict.BROKEN)

    @property
    def summary(self) -> str:
        """The outcome in one line."""
        present, absent = self._with(Verdict.PRESENT), self._with(Verdict.ABSENT)
        line = f"{_count(len(present), 'trap')} present, all handled as listed"
        if absent:
            line += f"; {len(absent)} fixed in this version"
        if unclear := self._with(Verdict.UNCLEAR):
            line += f"; unclear: {_names(unclear)}"
        if broken := self._with(Verdict.BROKEN):
            return f"BROKEN, and ompl_risk relies on it: {_names(broken)}; {line}"
        return line

    def as_dict(self) -> dict[str, Any]:
        """Versions, findings and summary as plain values, ready for JSON."""
        rows = [{**asdict(row), "verdict": row.verdict.value} for row in self.rows]
        return {
            "versions": dict(self.versions),
            "rows": rows,
            "healthy": self.healthy,
            "summary": self.summary,
        }

    def __rich__(self) -> Any:
        from ompl_risk.bridge.doctor_table import diagnosis_table

        return diagnosis_table(self)

    def _with(self, verdict: Verdict) -> list[Row]:
        return [row for row in self.rows if row.verdict is verdict]


def diagnose(*, progress: Progress | None = None, python: str = sys.executable) -> Diagnosis:
    """Try all probes, two at a time; takes 10 to 20 seconds.

    Args:
        progress: called with each finding, the number of findings so far and their total number,
            in the order in which the probes end and in the calling thread.
        python: the interpreter whose OMPL is tried.

    Returns:
        The findings. If OMPL cannot be imported, that is the only one.
    """
    first = examine(IMPORT, python)
    if first.verdict is not Verdict.HOLDS:
        _tell(progress, first, 1, 1)
        return Diagnosis(versions(), (first,))
    return Diagnosis(versions(), _examine_all((*TRAPS, *ASSUMPTIONS), python, progress))


def examine(probe: Probe, python: str = sys.executable) -> Row:
    """Run one probe.

    Args:
        probe: what to try.
        python: the interpreter whose OMPL is tried.

    Returns:
        What was observed.
    """
    try:
        run = subprocess.run(
            [python, str(probe.path)],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=TIME_LIMIT,
            check=False,
        )
    except (subprocess.TimeoutExpired, OSError) as error:
        return _unclear(probe, f"the probe could not be run: {type(error).__name__}")
    return interpret(probe, run.returncode, run.stdout, run.stderr)


def interpret(probe: Probe, code: int, output: str, errors: str) -> Row:
    """Read what a probe left behind.

    Args:
        probe: what was tried.
        code: the exit status; negative if a signal ended the process.
        output: its standard output.
        errors: its standard error.

    Returns:
        The finding. A probe that died after it had reported a result counts as a trap that is
        present: destructors crash and hang too.
    """
    lines = output.splitlines()
    limit = next((line.removeprefix(REACHED) for line in lines if line.startswith(REACHED)), None)
    if limit is None or code > 0:
        return _unclear(probe, (errors.strip().splitlines() or [f"exit status {code}"])[-1])
    report = next((json.loads(line) for line in lines if line.startswith(RESULT)), {})
    observed = [report["saw"]] if report else []
    if code < 0:
        observed.append(_ending(-code, limit))
    return _row(probe, good=code == 0 and report.get("good", False), observed=observed)


def versions() -> dict[str, str]:
    """Python, the platform and the packages that matter."""
    found = {"python": platform.python_version(), "platform": platform.platform()}
    return found | {name: _version(name) for name in PACKAGES}


def _examine_all(
    probes: Iterable[Probe], python: str, progress: Progress | None
) -> tuple[Row, ...]:
    with ThreadPoolExecutor(PROCESSES) as pool:
        runs: list[Future[Row]] = [pool.submit(examine, probe, python) for probe in probes]
        try:
            for done, run in enumerate(as_completed(runs), start=1):
                _tell(progress, run.result(), done, len(runs))
        finally:
            pool.shutdown(cancel_futures=True)  # Ctrl-C: finish what runs, start no more
    return tuple(run.result() for run in runs)


def _tell(progress: Progress | None, row: Row, done: int, total: int) -> None:
    if progress is not None:
        progress(row, done, total)


def _row(probe: Probe, *, good: bool, observed: list[str]) -> Row:
    if probe.assumption:
        verdict = Verdict.HOLDS if good else Verdict.BROKEN
    else:
        verdict = Verdict.ABSENT if good else Verdict.PRESENT
    text = ", then ".join(observed) or "ends without a result"
    return Row(probe.subject, text, probe.handling, verdict)


def _unclear(probe: Probe, reason: str) -> Row:
    verdict = Verdict.BROKEN if probe.assumption else Verdict.UNCLEAR
    return Row(probe.subject, reason, probe.handling, verdict)


def _ending(number: int, limit: str) -> str:
    if number == signal.SIGALRM:
        return f"hangs (stopped after {limit} s)"
    return f"crashes ({signal.Signals(number).name})"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _names(rows: list[Row]) -> str:
    return ", ".join(row.trap for row in rows)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")
