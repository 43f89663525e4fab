"""The README's examples run as they stand."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)


def test_there_are_examples_for_ompl_for_ranking_and_for_the_helicopter():
    assert len(EXAMPLES) == 3


@pytest.mark.parametrize("code", EXAMPLES, ids=["simple_setup", "rank", "helicopter"])
def test_example_runs_and_prints_a_result(code):
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False
    )
    assert run.returncode == 0, run.stderr
    printed = run.stdout.strip().splitlines()[-1]
    results = (
        r"H1 norm 0\.\d+, \d+ s",
        r"\('north', 'south'\) True",
        r"\d+ s, \d+\.\d km, valid: True",
    )
    assert any(re.fullmatch(result, printed) for result in results), printed


def test_the_link_targets_exist():
    for target in re.findall(r"\]\((?!http)([^)#]+)\)", README):
        assert (Path(__file__).parents[2] / target).exists(), target
