"""Tells of compilation, which without a word looks like a program that hangs."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core import event as events
from rich.console import Console
from rich.text import Text

LINE = "compiling fast code, once after an installation; this may take a minute"

PATIENCE = 1.0
"""Time of compilation that goes without a word [s]."""


@contextmanager
def compilation_announced(console: Console, *, patience: float = PATIENCE) -> Iterator[None]:
    """Within this context one line is printed if compilation keeps the user waiting.

    Code that comes from the cache on disk is not compiled, so nothing is said of it.

    Args:
        console: where progress is shown. The line goes above its bars if it is a terminal, and
            else to standard error, so that output that is piped stays as it is.
        patience: time of compilation that goes without a word, in all [s].
    """
    where = console if console.is_terminal else Console(stderr=True)

    def say() -> None:
        where.print(Text(LINE, style="dim"), soft_wrap=True)

    notice = CompilationNotice(say, patience=patience)
    with events.install_listener("numba:compile", notice):
        try:
            yield
        finally:
            notice.close()


class CompilationNotice(events.Listener):
    """Says once that code is being compiled, as soon as this has taken a while in all.

    Kernels are compiled one after the other, each with the kernels that it calls, so that starts
    and ends are nested; what counts is the sum of the outermost. Numba lets one thread compile at
    a time, whichever it is.

    Args:
        say: called once at most, from a thread of its own.
        patience: time of compilation that goes without a word [s].
        clock: the time [s].
        timer: calls a function after some seconds unless it is cancelled before.
    """

    def __init__(
        self,
        say: Callable[[], object],
        *,
        patience: float,
        clock: Callable[[], float] = time.monotonic,
        timer: Callable[[float, Callable[[], None]], threading.Timer] = threading.Timer,
    ) -> None:
        self._say, self._clock, self._make_timer = say, clock, timer
        self._left = patience
        self._depth, self._begun, self._over = 0, 0.0, False
        self._timer: threading.Timer | None = None
        self._lock = threading.Lock()

    def on_start(self, event: events.Event) -> None:  # noqa: ARG002 - which kernel does not matter
        """A kernel is being compiled."""
        with self._lock:
            self._depth += 1
            if self._depth == 1 and not self._over:
                self._begun = self._clock()
                self._timer = self._make_timer(max(self._left, 0.0), self._lost_patience)
                self._timer.daemon = True
                self._timer.start()

    def on_end(self, event: events.Event) -> None:  # noqa: ARG002 - a failure ends it as well
        """A kernel has been compiled."""
        with self._lock:
            if self._depth == 1 and self._timer is not None and not self._over:
                self._timer.cancel()
                self._left -= self._clock() - self._begun
            self._depth = max(self._depth - 1, 0)  # this one may have started before we listened

    def close(self) -> None:
        """Say nothing any more; a line that is being written is finished first."""
        with self._lock:
            self._over, timer = True, self._timer
        if timer is not None:
            timer.cancel()
            timer.join()

    def _lost_patience(self) -> None:
        with self._lock:
            if self._over:
                return
            self._over = True
        self._say()  # without the lock: a terminal that does not take it must not stop compilation
