"""What is said of compilation: one line when it takes a while, and else nothing."""

import os
import re
import subprocess
import sys
import threading
import time
from functools import partial
from io import StringIO

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numba.core import event as events
from rich.console import Console
from run_files import without_notice

from ompl_risk.cli import main
from ompl_risk.cli.compiling import LINE, PATIENCE, CompilationNotice, compilation_announced
from ompl_risk.cli.progress import progress_bar
from ompl_risk.errors import ArgumentError

KIND = "numba:compile"


class HandClock:
    """Time that passes only when told, with timers that go off on the way."""

    def __init__(self):
        self.now, self.timers = 0, []

    def timer(self, delay, call):
        made = HandTimer(self.now + delay, call)
        self.timers.append(made)
        return made

    def wait(self, seconds):
        end = self.now + seconds
        for timer in self.timers:
            if timer.pending and timer.due <= end:
                self.now, timer.pending = timer.due, False
                timer.call()
        self.now = end


class HandTimer:
    def __init__(self, due, call):
        self.due, self.call = due, call
        self.pending = self.daemon = self.joined = False

    def start(self):
        assert self.daemon, "it would keep a process alive"
        self.pending = True

    def cancel(self):
        self.pending = False

    def join(self):
        self.joined = True


@pytest.fixture
def said():
    """When something was said, on a clock, by a notice that listens and loses patience after 10."""
    clock, times = HandClock(), []
    notice = noticing(clock, times)
    with events.install_listener(KIND, notice):
        yield clock, times, notice


def noticing(clock, times, patience=10):
    say = lambda: times.append(clock.now)  # noqa: E731
    return CompilationNotice(say, patience=patience, clock=lambda: clock.now, timer=clock.timer)


ACTIONS = st.lists(st.sampled_from(["start", "end"]) | st.integers(1, 4), max_size=40)


@settings(max_examples=300)
@given(actions=ACTIONS, patience=st.integers(0, 20))
@example(actions=["start", "end", 1, "end", "start", 1], patience=1)
@example(actions=["start", 1, "start", 1, "end", 1, "end", 20], patience=4)
def test_it_is_said_once_when_the_time_of_compilation_is_used_up(actions, patience):
    clock, times = HandClock(), []
    notice = noticing(clock, times, patience)
    depth, compiled, expected = 0, 0, []
    for action in actions:
        if action == "start":
            notice.notify(events.Event(KIND, events.EventStatus.START))
            depth += 1
        elif action == "end":  # also one whose start was before the notice
            notice.notify(events.Event(KIND, events.EventStatus.END))
            depth = max(depth - 1, 0)
        else:
            for second in range(action):
                if depth and compiled == patience and not expected:
                    expected = [clock.now + second]
                compiled += depth > 0
            if depth and compiled == patience and not expected:
                expected = [clock.now + action]
            clock.wait(action)
    assert times == expected


def test_a_failed_compilation_ends_as_well(said):
    clock, times, _ = said

    def fails():
        with events.trigger_event(KIND):
            clock.wait(9)
            raise TypeError

    with pytest.raises(TypeError):
        fails()
    clock.wait(100)
    assert times == []


def test_what_is_no_compilation_does_not_count(said):
    clock, times, _ = said
    for kind in ("numba:compiler_lock", "numba:llvm_lock", "numba:run_pass"):
        with events.trigger_event(kind):  # these come when code is loaded from the cache, too
            clock.wait(100)
    assert times == []
    assert clock.timers == []


def test_nothing_is_said_after_the_end(said):
    clock, times, notice = said
    with events.trigger_event(KIND):
        clock.wait(9)
        notice.close()
        clock.wait(100)
        clock.timers[0].call()  # as one that was on its way
    with events.trigger_event(KIND):
        clock.wait(100)
    assert times == []
    assert clock.timers[0].joined
    assert len(clock.timers) == 1


def test_once_said_compilation_starts_no_timers(said):
    clock, times, _ = said
    for _ in range(5):
        with events.trigger_event(KIND):
            clock.wait(6)
    assert times == [10]
    assert len(clock.timers) == 2


def compile_until(shown):
    """A compilation that lasts until something is shown, or a minute."""
    deadline = time.monotonic() + 60.0
    with events.trigger_event(KIND):
        while not shown() and time.monotonic() < deadline:
            time.sleep(0.001)


def screen(text):
    """The lines that a terminal shows after what rich writes."""
    lines, row, column = [""], 0, 0
    for code, letter in re.findall(r"\x1b\[([?\d;]*[A-Za-z])|([^\x1b])", text):
        if code == "2K":
            lines[row] = ""
        elif code.endswith("A"):
            row -= int(code[:-1])
        elif letter == "\r":
            column = 0
        elif letter == "\n":
            row, column = row + 1, 0
            lines += [""] * (row == len(lines))
        elif letter:
            lines[row] = lines[row][:column].ljust(column) + letter + lines[row][column + 1 :]
            column += 1
    return [line.rstrip() for line in lines if line.strip()]


@pytest.mark.parametrize("threaded", [False, True])
def test_the_line_stands_above_a_bar(threaded):
    file = StringIO()
    console = Console(file=file, force_terminal=True, width=100)
    with compilation_announced(console, patience=0.0), progress_bar(console) as progress:
        bar = progress.add_task("growing", total=200)
        work = partial(compile_until, lambda: LINE in file.getvalue())
        compiling = threading.Thread(target=work)
        if threaded:
            compiling.start()
        else:
            work()
        for _ in range(200):
            progress.advance(bar)
            progress.refresh()
        if threaded:
            compiling.join()
    assert file.getvalue().count("\x1b[2m") == 1  # the bar keeps its colours
    above, below = screen(file.getvalue())
    assert above == LINE
    assert re.fullmatch(r"growing ━+ 200/200 0:00:\d\d", below)


def test_a_command_that_is_interrupted_says_nothing_afterwards(capsys):
    def interrupted():
        with compilation_announced(Console(), patience=0.1):
            events.start_event(KIND)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    time.sleep(0.2)
    assert capsys.readouterr() == ("", "")


def test_without_a_terminal_it_is_one_plain_line_on_the_error_stream(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "20")
    heard = []
    with compilation_announced(Console(), patience=0.0):
        compile_until(lambda: heard.append(capsys.readouterr()) or heard[-1].err)
    assert "".join(each.err for each in heard) == f"{LINE}\n"
    assert not any(each.out for each in heard)


def test_what_is_soon_compiled_goes_without_a_word_or_a_thread(capsys):
    before = threading.enumerate()
    with compilation_announced(Console()):
        for _ in range(50):
            with events.trigger_event(KIND):
                pass
    for thread in set(threading.enumerate()) - set(before):
        thread.join(0.5 * PATIENCE)  # none waits for its time to come
        assert not thread.is_alive()
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("command", "function"),
    [
        (["plan"], "ompl_risk.cli.planning.plan"),
        (["rank", "hills", "a.csv", "b.csv"], "ompl_risk.cli.ranking_files.rank_files"),
        (["table1"], "ompl_risk.table1.table1"),
        (["doctor"], "ompl_risk.bridge.doctor.diagnose"),
    ],
)
def test_every_command_says_it_and_stops_listening(command, function, monkeypatch, capfd):
    errors = []

    def compiles(*_arguments, **_options):
        compile_until(lambda: errors.append(capfd.readouterr().err) or errors[-1])
        raise ArgumentError("d0", 0, "positive")

    quick = partial(compilation_announced, patience=0.0)
    monkeypatch.setattr("ompl_risk.cli.entry.compilation_announced", quick)
    monkeypatch.setattr(function, compiles)
    assert main(command) == 1
    with events.trigger_event(KIND):
        time.sleep(0.01)
    told = "".join([*errors, capfd.readouterr().err])
    assert told.splitlines() == [LINE, "ompl-risk: --d0 = 0: must be positive"]
    assert without_notice(told) == ["ompl-risk: --d0 = 0: must be positive"]


TINY = """
import numba, numpy as np

@numba.njit(cache=True)
def ordered(x):
    return np.sort(x)[0]
"""

RUN = """
import numpy as np
from rich.console import Console
from ompl_risk.cli.compiling import compilation_announced
import tiny

with compilation_announced(Console(), patience=0.0):
    assert tiny.ordered(np.array([2.0, 1.0])) == 1.0
print(sum(tiny.ordered.stats.cache_hits.values()))
"""


def test_a_kernel_that_is_compiled_and_then_cached(tmp_path):
    (tmp_path / "tiny.py").write_text(TINY, encoding="utf-8")
    own = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "NUMBA_DISABLE_JIT": "0"}

    def run():
        command = [sys.executable, "-c", RUN]
        return subprocess.run(
            command, cwd=tmp_path, env=os.environ | own, capture_output=True, text=True, check=True
        )

    first, second = run(), run()
    assert (first.stdout, first.stderr) == ("0\n", f"{LINE}\n")
    assert (second.stdout, second.stderr) == ("1\n", "")
