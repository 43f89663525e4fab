import io
import json
import platform
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from importlib.metadata import version

import pytest
from rich.console import Console

from ompl_risk.bridge import doctor
from ompl_risk.bridge.doctor import Diagnosis, Row, Verdict, examine, interpret
from ompl_risk.bridge.probes import ASSUMPTIONS, IMPORT, TRAPS, Probe

TRAP = Probe("prm_objective", "a trap", "handled")
ASSUMPTION = Probe("serialize_capsule", "an assumption", "needed", assumption=True)

# ---- on the installed OMPL: one test, so that parallel workers do not repeat the diagnosis -------

ON_2_0_1 = {
    "prm_objective": "hangs",
    "prm_goals": "hangs",
    "prm_exception": "SIGABRT",
    "benchmark_exception": "SIGABRT",
    "benchmark_runs": "hangs|crashes",
    "fmt_cost": "SIGSEGV",
    "aorrtc_cost": "never asks",
    "rrtconnect_cost": "never asks",
    "integral_override": r"ignored: cost 1\.00, 10\.00 expected",
    "nan_cost": 'says "Exact solution" to a path of cost nan',
    "infinite_cost": 'says "Exact solution" to a path of cost inf',
    "simplify_cost": r"cost [\d.e+]+ before, [\d.e+]+ after",
    "periodic_condition": "hangs",
    "lazy_goal": "Invalid goal",
    "numpy_bool": "bad_cast",
    "planner_data": "SIGABRT",
    "control_sst": "no constructor",
    "control_path_cost": "cost 0 of a path of length 0.8",
    "get_solutions": "TypeError",
    "copy_from_reals": "SIGSEGV",
    "sorrt_straight": "hangs",
}


def test_the_diagnosis_of_the_installed_ompl():
    diagnosis = doctor.diagnose()
    rows = {row.trap: row for row in diagnosis.rows}
    assert {rows[p.subject].verdict for p in ASSUMPTIONS} == {Verdict.HOLDS}
    assert not [row for row in diagnosis.rows if row.verdict is Verdict.UNCLEAR]
    assert diagnosis.healthy
    assert diagnosis.versions["ompl"] == version("ompl")
    assert diagnosis.versions["numba"] == version("numba")
    assert diagnosis.versions["python"] == platform.python_version()
    if version("ompl") != "2.0.1":
        pytest.skip("the traps were observed on OMPL 2.0.1")
    found = {p.script: rows[p.subject] for p in TRAPS}
    assert found.keys() == ON_2_0_1.keys()
    differing = {
        script: row.observed
        for script, row in found.items()
        if row.verdict is not Verdict.PRESENT or not re.search(ON_2_0_1[script], row.observed)
    }
    assert differing == {}


# ---- the report ---------------------------------------------------------------------------------


@pytest.fixture
def told(monkeypatch):
    """A diagnosis of made-up findings, the later probes being the faster, and its progress."""
    probes = (*TRAPS, *ASSUMPTIONS)

    def pretend(probe, python):
        if probe is IMPORT:
            return Row("import ompl", "ok", "", Verdict.HOLDS)
        time.sleep(0.002 * (len(probes) - probes.index(probe)))
        verdict = Verdict.HOLDS if probe.assumption else Verdict.PRESENT
        return Row(probe.subject, f"saw {probe.script}", probe.handling, verdict)

    monkeypatch.setattr(doctor, "examine", pretend)
    progress = []
    diagnosis = doctor.diagnose(progress=lambda *args: progress.append(args))
    return diagnosis, progress


def test_every_probe_has_its_row_in_order(told):
    assert [row.trap for row in told[0].rows] == [p.subject for p in (*TRAPS, *ASSUMPTIONS)]
    assert [row.handling for row in told[0].rows] == [p.handling for p in (*TRAPS, *ASSUMPTIONS)]


def test_progress_is_told_of_every_row(told):
    diagnosis, progress = told
    assert [done for _, done, _ in progress] == list(range(1, len(diagnosis.rows) + 1))
    assert {total for _, _, total in progress} == {len(diagnosis.rows)}
    assert sorted(row.trap for row, _, _ in progress) == sorted(r.trap for r in diagnosis.rows)


def test_as_dict_is_json(told):
    diagnosis = told[0]
    again = json.loads(json.dumps(diagnosis.as_dict()))
    assert again == diagnosis.as_dict()
    assert again["rows"][0] == {
        "trap": TRAPS[0].subject,
        "observed": "saw prm_objective",
        "handling": TRAPS[0].handling,
        "verdict": "present",
    }
    assert again["summary"] == diagnosis.summary
    assert again["healthy"] is True
    assert again["versions"]["ompl"] == version("ompl")


def test_the_table_shows_everything(told):
    diagnosis = told[0]
    console = Console(file=io.StringIO(), width=400)
    console.print(diagnosis)
    text = console.file.getvalue()
    for row in diagnosis.rows:
        assert row.trap in text
        assert row.observed in text
        assert row.handling in text
    assert f"ompl {version('ompl')}" in text
    assert diagnosis.summary in text


def test_ctrl_c_stops_the_diagnosis(monkeypatch):
    started = []

    def pretend(probe, python):
        started.append(probe)
        time.sleep(0.01)
        return Row(probe.subject, "ok", "", Verdict.HOLDS)

    def interrupt(row, done, total):
        raise KeyboardInterrupt

    monkeypatch.setattr(doctor, "examine", pretend)
    with pytest.raises(KeyboardInterrupt):
        doctor.diagnose(progress=interrupt)
    assert len(started) < len(TRAPS)


def test_the_doctor_itself_imports_no_ompl():
    """So that a front end can reach it where OMPL is broken."""
    code = """
import importlib.util, pathlib, sys, types
root = pathlib.Path(importlib.util.find_spec("ompl_risk").origin).parent
for name, folder in (("ompl_risk", root), ("ompl_risk.bridge", root / "bridge")):
    sys.modules[name] = types.ModuleType(name)  # without what the real one imports
    sys.modules[name].__path__ = [str(folder)]
import ompl_risk.bridge.doctor, ompl_risk.bridge.doctor_table
print("ompl" in sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"


# ---- on an OMPL that is not there ---------------------------------------------------------------


def test_an_ompl_that_cannot_be_imported_is_the_one_finding(tmp_path, monkeypatch):
    (tmp_path / "ompl").mkdir()
    (tmp_path / "ompl" / "__init__.py").write_text("raise ImportError('libompl.so is missing')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    told = []
    diagnosis = doctor.diagnose(progress=lambda *args: told.append(args))
    (row,) = diagnosis.rows
    assert row.trap == "import ompl"
    assert row.verdict is Verdict.BROKEN
    assert "libompl.so is missing" in row.observed
    assert not diagnosis.healthy
    assert diagnosis.summary.startswith("BROKEN")
    assert told == [(row, 1, 1)]


def test_an_interpreter_that_does_not_start_is_a_finding():
    row = examine(IMPORT, python="/nowhere/python")
    assert row.verdict is Verdict.BROKEN
    assert "could not be run" in row.observed


# ---- reading what a probe left ------------------------------------------------------------------


HANGS = "hangs (stopped after 2 s)"


def result(good, saw="seen"):
    return "reached 3\n" + json.dumps({"good": good, "saw": saw}) + "\n"


@pytest.mark.parametrize(
    ("code", "output", "trap", "assumption", "observed"),
    [
        (0, result(True), Verdict.ABSENT, Verdict.HOLDS, "seen"),
        (0, result(False), Verdict.PRESENT, Verdict.BROKEN, "seen"),
        (
            -signal.SIGALRM,
            "reached 3\n",
            Verdict.PRESENT,
            Verdict.BROKEN,
            "hangs (stopped after 3 s)",
        ),
        (-signal.SIGSEGV, "reached 3\n", Verdict.PRESENT, Verdict.BROKEN, "crashes (SIGSEGV)"),
        (
            -signal.SIGSEGV,
            result(True),
            Verdict.PRESENT,
            Verdict.BROKEN,
            "seen, then crashes (SIGSEGV)",
        ),
        (0, "reached 3\n", Verdict.PRESENT, Verdict.BROKEN, "ends without a result"),
        (-signal.SIGSEGV, "", Verdict.UNCLEAR, Verdict.BROKEN, "last words"),
        (1, "reached 3\n", Verdict.UNCLEAR, Verdict.BROKEN, "last words"),
        (0, "", Verdict.UNCLEAR, Verdict.BROKEN, "last words"),
    ],
)
def test_interpretation(code, output, trap, assumption, observed):
    errors = "Traceback ...\nlast words\n"
    row = interpret(TRAP, code, output, errors)
    assert (row.verdict, row.observed) == (trap, observed)
    assert (row.trap, row.handling) == (TRAP.subject, TRAP.handling)
    assert interpret(ASSUMPTION, code, output, errors).verdict is assumption


def test_logging_of_ompl_does_not_disturb():
    output = "Debug: noise\n" + result(False) + "nanobind: leaked 1 instances!\n"
    assert interpret(TRAP, 0, output, "").observed == "seen"


def test_silence_is_reported_by_the_exit_status():
    assert interpret(TRAP, 2, "", "").observed == "exit status 2"


PRESENT = Row("one", "hangs", "refused", Verdict.PRESENT)


@pytest.mark.parametrize(
    ("others", "summary", "healthy"),
    [
        ((), "1 trap present, all handled as listed", True),
        ((replace(PRESENT, trap="two"),), "2 traps present, all handled as listed", True),
        (
            (replace(PRESENT, trap="two", verdict=Verdict.ABSENT),),
            "1 trap present, all handled as listed; 1 fixed in this version",
            True,
        ),
        (
            (replace(PRESENT, trap="two", verdict=Verdict.UNCLEAR),),
            "1 trap present, all handled as listed; unclear: two",
            True,
        ),
        (
            (replace(PRESENT, trap="two", verdict=Verdict.BROKEN),),
            "BROKEN, and ompl_risk relies on it: two; 1 trap present, all handled as listed",
            False,
        ),
    ],
)
def test_summary(others, summary, healthy):
    diagnosis = Diagnosis({}, (PRESENT, *others))
    assert diagnosis.summary == summary
    assert diagnosis.healthy is healthy


# ---- the probes themselves ----------------------------------------------------------------------


def test_every_script_is_listed_once():
    listed = [probe.script for probe in (IMPORT, *TRAPS, *ASSUMPTIONS)]
    scripts = {path.stem for path in IMPORT.path.parent.glob("*.py")} - {"__init__", "scene"}
    assert len(listed) == len(set(listed))
    assert set(listed) == scripts


def test_probes_show_raw_ompl():
    for path in IMPORT.path.parent.glob("*.py"):
        if path.stem != "__init__":
            imports = [
                ln for ln in path.read_text().splitlines() if ln.startswith(("import", "from"))
            ]
            assert not [line for line in imports if "ompl_risk" in line], path
