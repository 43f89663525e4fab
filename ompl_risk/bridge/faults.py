"""Carry a Python exception from a callback, past OMPL's C++, to whoever called OMPL.

OMPL calls clearances, checkers and objectives from C++. When one of them raises, the exception
has to unwind C++ frames. Most planners survive that; ``PRM``, ``PRMstar`` and ``ot.Benchmark``
own a running C++ thread at that moment, and the C++ runtime aborts the process. So callbacks
must not raise while OMPL runs. They hand the exception over instead::

    try:
        return bool(self._clearance(position) > 0.0)
    except BaseException as error:
        if not faults.keep(error):  # nobody is there to raise it later
            raise
        return False  # or an infinite cost: whatever ends this branch of the search

and the call into OMPL is made inside :func:`deferred`, which asks the planner to stop and raises
the exception once OMPL has returned. ``ompl_risk.bridge.guards`` wraps every ``solve`` that way.

Ctrl-C needs more. Python raises KeyboardInterrupt between any two bytecodes of the main thread,
also before the ``try`` above is entered. So while a call into OMPL is open, the handler of SIGINT
hands its exception over as well instead of raising it; PRM survives, whatever the callbacks look
like. A second Ctrl-C acts at once, as ever. Out of reach is a ``solve`` in which nothing calls
Python: it sees Ctrl-C only after it has returned.

The record is per thread: OMPL runs callbacks in the thread that called ``solve``.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from traceback import clear_frames
from types import FrameType, TracebackType


class Deferral:
    """One call into OMPL: keeps the first exception of its callbacks and raises it at the end.

    Args:
        stop: asks OMPL to return soon, such as ``ptc.terminate``; None if nothing can.
    """

    def __init__(self, stop: Callable[[], object] | None) -> None:
        self._stop = stop
        self._error: BaseException | None = None

    @property
    def failed(self) -> bool:
        """Whether an exception waits to be raised."""
        return self._error is not None

    def keep(self, error: BaseException) -> None:
        """Remember ``error`` if it is the first, and ask OMPL to return."""
        if self._error is not None:
            return  # the planner has not stopped yet and asked the broken callback once more
        self._error = error
        if self._stop is not None:
            self._stop()

    def release(self) -> None:
        """Raise the exception that was kept, if there is one, and forget it."""
        error, self._error = self._error, None
        if error is None:
            return
        _forget_states(error)
        try:
            raise error
        finally:
            del error  # its traceback holds this frame: they would keep each other alive

    def __enter__(self) -> Deferral:
        if not _open.stack:
            _open.interrupts.defer()
        _open.stack.append(self)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        _open.stack.remove(self)
        if not _open.stack:
            _open.interrupts.restore()
        _forget_states(error)
        self.release()


def _forget_states(error: BaseException | None) -> None:
    """Clear the local variables of the callbacks that the tracebacks of ``error`` still hold.

    The states in them belong to the planner and are freed with it. As long as their Python objects
    live on (debuggers, notebooks and pytest keep tracebacks), nanobind takes a new state at the
    same address for the old one, and using it crashes.
    """
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        clear_frames(error.__traceback__)  # leaves frames that are still running alone
        error = error.__cause__ or error.__context__


class _Interrupts:
    """Has the handler of SIGINT hand its exception over, in the main thread."""

    def __init__(self) -> None:
        self._handler: Callable[[int, FrameType | None], object] | None = None

    def defer(self) -> None:
        """Put a deferring handler before the present one, unless that is the system's own."""
        if threading.current_thread() is not threading.main_thread():
            return  # signals are the main thread's business
        handler = signal.getsignal(signal.SIGINT)
        if callable(handler):
            self._handler = handler
            signal.signal(signal.SIGINT, self._on_interrupt)

    def restore(self) -> None:
        """Put the handler back."""
        handler, self._handler = self._handler, None
        if handler is not None:
            signal.signal(signal.SIGINT, handler)

    def _on_interrupt(self, number: int, frame: FrameType | None) -> None:
        handler = self._handler or signal.default_int_handler
        if not _open.stack or _open.stack[-1].failed:
            handler(number, frame)  # nothing to wait for, or the user insists
            return
        try:
            handler(number, frame)
        except BaseException as error:
            keep(error)


class _Open(threading.local):
    """The deferrals that this thread is inside, outermost first, and its SIGINT handler."""

    def __init__(self) -> None:
        self.stack: list[Deferral] = []
        self.interrupts = _Interrupts()


_open = _Open()


def deferred(stop: Callable[[], object] | None = None) -> Deferral:
    """Context in which callbacks may hand over their exceptions; leaving it raises the first.

    Contexts nest; the innermost one keeps the exception.

    Args:
        stop: called once when an exception is handed over, so that OMPL returns soon.

    Returns:
        The context manager.

    Example:
        >>> with deferred():
        ...     kept = keep(ValueError("from a callback"))
        Traceback (most recent call last):
        ValueError: from a callback
    """
    return Deferral(stop)


def keep(error: BaseException) -> bool:
    """Hand over an exception that must not cross C++.

    Args:
        error: what a callback was about to raise.

    Returns:
        True if it will be raised once OMPL has returned; False if this thread is in no call into
        OMPL that would do so, and the callback should simply raise it.
    """
    if not _open.stack:
        return False
    _open.stack[-1].keep(error)
    return True
