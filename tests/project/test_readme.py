"""The README's examples run as they stand."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)


NAMES = ["simple_setup", "rank", "helicopter", "closed_loop", "moving"]


def test_there_is_an_example_of_each_use():
    assert len(EXAMPLES) == len(NAMES)


@pytest.mark.parametrize("code", EXAMPLES, ids=NAMES)
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
        r"\{'north': 0\.00\d+, 'south': 0\.1\d+\}",
        r"waits for the door, arrives after 2[67]\.\d s",
    )
    assert any(re.fullmatch(result, printed) for result in results), printed


def test_the_link_targets_exist():
    for target in re.findall(r"\]\((?!http)([^)#]+)\)", README):
        assert (Path(__file__).parents[2] / target).exists(), target
