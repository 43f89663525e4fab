"""`table1`, `doctor`, `--version`, `--help`, `python -m`."""

import re
import subprocess
import sys
from dataclasses import fields

import pytest

import ompl_risk
from ompl_risk.bridge.doctor import Diagnosis, Row, Verdict
from ompl_risk.cli import main
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.table1 import table1


def test_table1_shows_ours_beside_the_printed(capsys, tmp_path):
    assert main(["table1", "--output", str(tmp_path / "t.png")]) == 0
    output = capsys.readouterr().out
    for row in table1().rows:
        line = next(
            line
            for line in output.splitlines()
            if re.match(rf"[│|] {row.norm} +[│|] {row.curve} ", line)
        )
        assert f"{row.printed:.1f}" in line
        assert f"{row.ours:.3f}" in line
    assert (tmp_path / "t.png").stat().st_size > 10_000


@pytest.mark.parametrize(("verdict", "code"), [(Verdict.HOLDS, 0), (Verdict.BROKEN, 1)])
def test_doctor_fails_if_something_relied_on_is_broken(verdict, code, monkeypatch, capsys):
    def diagnose(progress):
        row = Row("the seed", "does as it should", "reproducible plans", verdict)
        progress(row, 1, 1)
        return Diagnosis({"ompl": "2.0.1"}, (row,))

    monkeypatch.setattr("ompl_risk.bridge.doctor.diagnose", diagnose)
    assert main(["doctor"]) == code
    assert "the seed" in capsys.readouterr().out


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.strip() == ompl_risk.__version__


def test_help_lists_every_parameter_with_its_meaning(capsys):
    assert main(["plan", "--help"]) == 0
    output = capsys.readouterr().out
    for field in fields(PlanSettings):
        assert f"--{field.name.replace('_', '-')} " in output
    assert "above the ground" in output


def test_help_without_a_command(capsys):
    assert main([]) == 0
    for command in ("plan", "rank", "table1", "doctor"):
        assert command in capsys.readouterr().out or command != "plan"


def test_the_module_runs_and_heavy_packages_wait():
    code = (
        "import sys, ompl_risk.cli; "
        "sys.exit(sum(name in sys.modules for name in ('matplotlib', 'joblib', 'rasterio')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
    run = subprocess.run(
        [sys.executable, "-m", "ompl_risk", "rank"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 1
    assert run.stderr.startswith("ompl-risk: ")
    assert len(run.stderr.splitlines()) == 1
