"""The commands that can be stopped: killed, interrupted and started again, they lose nothing."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from benchmarks.campaign.store import RUNS

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Resumed:
    """A command, and what it leaves behind.

    Args:
        line: what Python is called with.
        thing: what it does one of after the other.
        names: of all that it has to do, in the order in which it is done.
        code: of exit when all is done.
        done: what is kept in a folder, by name.
        tear: leaves what a killed process may leave: half of something.
        check: of a folder with everything, and of what was told to the end.
    """

    line: tuple[str, ...]
    thing: str
    names: tuple[str, ...]
    code: int
    done: Callable[[Path], dict[str, bytes]]
    tear: Callable[[Path], None]
    check: Callable[[Path, str, str], None]


def start(line, folder):
    return subprocess.Popen(
        [sys.executable, *line, "--workers", "1", "--output", str(folder)],
        cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def wait_for(process, done, count):
    while process.poll() is None:
        if len(done()) >= count:
            return
        time.sleep(0.005)
    pytest.fail(f"it ended by itself: {process.communicate()}")


def living(parent):
    """Process ids of the children of a process, as far as the system tells."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, ppid = path.read_text().rsplit(")", 1)[1].split()[:2]
            if int(ppid) == parent and state != "Z":
                found.append(int(path.parent.name))
    return found


def is_alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def kill(process):
    """With its workers, which notice it by themselves."""
    workers = living(process.pid)
    process.kill()
    process.communicate()
    deadline = time.monotonic() + 60.0
    while any(map(is_alive, workers)):
        assert time.monotonic() < deadline, "workers of a killed process live on"
        time.sleep(0.05)


def files(pattern):
    return lambda folder: {path.name: path.read_bytes() for path in folder.glob(pattern)}


def drafted(name):
    return lambda folder: (folder / name).write_bytes(b"PAR1")


def lines_of_runs(folder):
    """Whole lines of the file of runs."""
    path = folder / RUNS
    text = path.read_bytes() if path.exists() else b""
    lines = text[: text.rfind(b"\n") + 1].splitlines()
    facts = [json.loads(line)["configuration"] for line in lines]
    names = [f"{c['scene']} {c['objective']} {c['planner']} {c['seed']}" for c in facts]
    assert len({*names}) == len(names), "a run was done twice"
    return dict(zip(names, lines, strict=True))


def torn_run(folder):
    with (folder / RUNS).open("ab") as file:
        file.write(b'{"key": "torn')


def evidence_ended(folder, out, told):
    assert "14 units: 1 complete, 1 failed, 12 few" in told.splitlines()
    assert out.endswith("reported\n")


def helicopter_ended(folder, out, told):
    assert told.splitlines()[-1].startswith("6/6  0:00 left")
    assert re.findall(r"left  pair (\d) (?:judged|fewer)$", told, re.M)[-1] == "5"
    assert f"in {folder}: report.md, hits.png, pairs/" in out
    records = files("pairs/*.json")(folder).values()
    judged = sum(b'"status": "judged"' in record for record in records)
    assert f"6 pairs: {judged} judged" in out
    assert f"6 pairs: {judged} judged" in (folder / "report.md").read_text()
    assert (folder / "hits.png").stat().st_size > 0


def objectives_ended(folder, out, told):
    assert "4 runs: 4 solved" in out
    for name in (
        "summary.md", "runs.csv", "curves.csv", "summary.csv", "columns.csv", "ompl/circles.log",
        "ompl/benchmark.db", "figures/convergence-circles.png", "figures/matrix-circles.png",
        "figures/pareto-circles.png",
    ):  # fmt: skip
        assert (folder / name).stat().st_size > 0
    before = (folder / RUNS).read_bytes()
    other = start((*OBJECTIVES, "--seconds", "0.3"), folder)
    _, told = other.communicate(timeout=60)
    assert other.returncode == 2
    assert "seconds: 0.2 there, 0.3 here" in told
    assert (folder / RUNS).read_bytes() == before


OBJECTIVES = (
    "-m", "benchmarks.campaign", "--seconds", "0.2", "--seeds", "2", "--scenes", "circles",
    "--objectives", "length", "--planners", "RRTstar", "BITstar",
)  # fmt: skip

COMMANDS = {
    "evidence": Resumed(
        (str(Path(__file__).with_name("evidence_work.py")), "--units", "14"),
        "unit",
        tuple(f"{unit:05d}.parquet" for unit in range(14)),
        1,  # unit 3 fails
        files("units/*.parquet"),
        drafted("units/00013.part"),
        evidence_ended,
    ),
    "helicopter": Resumed(
        ("-m", "benchmarks", "helicopter", "--pairs", "6", "--places", "60", "--no-example"),
        "pair",
        tuple(f"{number:04d}.json" for number in range(6)),
        0,
        files("pairs/*.json"),
        drafted("pairs/0005.part"),
        helicopter_ended,
    ),
    "objectives": Resumed(
        OBJECTIVES,
        "run",
        tuple(f"circles length {p} {k}" for k in (1, 2) for p in ("RRTstar", "BITstar")),
        0,
        lines_of_runs,
        torn_run,
        objectives_ended,
    ),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_killed_interrupted_and_started_again(tmp_path, name):
    """It repeats nothing and loses nothing, and ends as if nothing had happened."""
    command, folder = COMMANDS[name], tmp_path / "campaign"
    total, thing = len(command.names), command.thing

    def done():
        return command.done(folder)

    killed = start(command.line, folder)
    wait_for(killed, done, 1)
    kill(killed)
    command.tear(folder)
    first = done()

    interrupted = start(command.line, folder)
    wait_for(interrupted, done, len(first) + 1)
    interrupted.send_signal(signal.SIGINT)
    _, told = interrupted.communicate(timeout=60)
    assert interrupted.returncode == 130, told
    goes_on = f"every finished {thing} is kept, and the same command goes on from here"
    assert f"stopped; {goes_on}" in told
    assert "Traceback" not in told
    second = done()
    assert len(second) < total
    assert first.items() <= second.items()

    last = start(command.line, folder)
    out, told = last.communicate(timeout=120)
    assert last.returncode == command.code, told
    lines = told.splitlines()
    assert lines[0] == f"{len(second)} of {total} {thing}s were done before"
    finished = [re.match(rf"(\d+)/{total}  \d+:\d\d left  \w", line) for line in lines]
    assert [int(one[1]) for one in finished if one] == list(range(len(second) + 1, total + 1))
    assert second.items() <= done().items()
    assert tuple(sorted(done(), key=command.names.index)) == command.names
    assert len((folder / "sessions.jsonl").read_text().splitlines()) == 3
    command.check(folder, out, told)
