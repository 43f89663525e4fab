"""How commands that can be stopped end, what they keep of each start, and options left out."""

import argparse
import json
from pathlib import Path

import pytest

from benchmarks.commands import Command
from benchmarks.evidence.engines import ClusterLostError
from benchmarks.sessions import exit_code, log
from benchmarks.working import WorkersDiedError
from ompl_risk.errors import ArgumentError, FileError

KEPT = "every finished loaf is kept, and the same command goes on from here"
BAKE = Command("bake", "loaf", full={"loaves": 30, "hours": 1.5}, quick={"loaves": 2, "hours": 0.5})


@pytest.mark.parametrize(
    ("error", "code", "told"),
    [
        (KeyboardInterrupt(), 130, f"\nstopped; {KEPT}\n"),
        (
            WorkersDiedError([1, 4], "loaves"),
            1,
            "error: worker processes died 3 times with nothing finished between, and 2 loaves are "
            f"left; if memory ran out, fewer --workers need less; {KEPT}\n",
        ),
        (ClusterLostError("it has gone"), 1, f"error: it has gone; {KEPT}\n"),
        (ArgumentError("output", "x", "[y]"), 2, "error: output = 'x': must be [y]\n"),
        (FileError("a.txt", "is torn"), 2, "error: a.txt: is torn\n"),
        (OSError(28, "No space left on device"), 2, "error: [Errno 28] No space left on device\n"),
    ],
)
def test_what_ends_a_session_is_told(capsys, error, code, told):
    def session(out, _err):
        out.print("done so far")
        raise error

    assert exit_code(session, "loaf") == code
    assert capsys.readouterr() == ("done so far\n", told)


@pytest.mark.parametrize("code", [0, 1])
def test_a_session_that_ends_by_itself_says_how(capsys, code):
    assert BAKE.run(lambda _out, _err: code) == code
    assert capsys.readouterr() == ("", "")


def test_faults_of_the_program_are_not_hidden():
    def session(_out, _err):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        exit_code(session, "loaf")


def test_every_start_has_a_line(tmp_path):
    for seed in (3, 4):
        log(tmp_path, argparse.Namespace(seed=seed, output=Path("runs/bake")))
    lines = (tmp_path / "sessions.jsonl").read_text().splitlines()
    facts = [json.loads(line) for line in lines]
    assert [each["options"] for each in facts] == [
        {"seed": "3", "output": "runs/bake"}, {"seed": "4", "output": "runs/bake"},
    ]  # fmt: skip
    for each in facts:
        assert list(each) == ["started", "options", "machine", "versions"]
        assert each["started"].endswith("+00:00")
        assert each["machine"]["processors"] >= 1
        assert {"python", "ompl", "numpy"} <= each["versions"].keys()


@pytest.mark.parametrize(
    ("argv", "expected"),
    [
        ([], (30, 1.5, "runs/bake")),
        (["--quick"], (2, 0.5, "runs/bake-quick")),
        (["--quick", "--loaves", "7"], (7, 0.5, "runs/bake-quick")),
        (["--hours", "3", "--output", "oven"], (30, 3.0, "oven")),
        (["--quick", "--output", "oven"], (2, 0.5, "oven")),
    ],
)
def test_options_that_are_left_out_are_filled_in(argv, expected):
    parser = BAKE.parser("Bread.")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--loaves", type=int, help=BAKE.sizes("loaves"))
    parser.add_argument("--hours", type=float, help=BAKE.sizes("hours"))
    BAKE.add_kept(parser)
    options = BAKE.parsed(parser, argv)
    assert (options.loaves, options.hours, options.output.as_posix()) == expected
    text = " ".join(parser.format_help().split())
    for words in ("(30; quick 2)", "(1.5; quick 0.5)", "(runs/bake)", "Bread. Start it again"):
        assert words in text
