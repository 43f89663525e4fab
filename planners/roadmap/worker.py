"""Work in a thread that the caller can leave at any moment."""

from __future__ import annotations

import threading
from collections.abc import Callable

POLL = 2e-3
"""Seconds between two looks at the condition: compiled work leaves the interpreter free."""

GRACE = 0.03
"""Seconds that work gets to come to an end once it should stop."""


class Worker:
    """Runs ``work(stop)`` in a thread, where ``stop()`` says whether to end.

    Args:
        work: what to run; it looks at ``stop`` every few milliseconds.
        abandon: whether a caller may go on while the work comes to its end, as compiled code that
            nobody else sees may; a user's code may not run on after the call that it belongs to.
    """

    def __init__(self, work: Callable[[Callable[[], bool]], object], *, abandon: bool) -> None:
        self._work, self._abandon = work, abandon
        self._stop, self._done = threading.Event(), threading.Event()
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="ompl_risk roadmap", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            self._work(self._stop.is_set)
        except BaseException as error:
            self._error = error
        finally:
            self._done.set()

    def wait(self, until: Callable[[], bool], meanwhile: Callable[[], object]) -> None:
        """Wait until the work is done or ``until`` says so, and it has come to its end.

        Args:
            until: whether to stop, asked in this thread.
            meanwhile: called in this thread between two looks.

        Raises:
            BaseException: what the work raised.
        """
        try:
            while not self._done.wait(POLL) and not until():
                meanwhile()
        finally:
            self._stop.set()
            self._done.wait(GRACE if self._abandon else None)
        self.check()

    def ended(self, until: Callable[[], bool]) -> bool:
        """Whether work that was told to stop has come to its end before ``until`` says so."""
        self._stop.set()
        while not self._done.wait(POLL):
            if until():
                return False
        self.check()
        return True

    def join(self) -> None:
        """Wait for the end of work that was told to stop."""
        self._stop.set()
        self._thread.join()

    def check(self) -> None:
        """Raise what the work raised, once."""
        error, self._error = self._error, None
        if error is not None:
            raise error
