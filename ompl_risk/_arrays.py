"""Checked, read-only arrays: how every value object of the library takes its arrays in."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk.errors import ArgumentError

FloatArray = NDArray[np.float64]


class ReadOnlyArrays:
    """An object whose arrays are read-only, and stay so where it is copied or pickled.

    NumPy forgets it: copies from ``copy.deepcopy`` and most from ``pickle``, so those in worker
    processes, are writable. They could then be changed, and kernels, which are compiled for either
    kind of array, would be compiled anew. Arrays in tuples, lists and dictionaries count too;
    objects in them take care of their own.
    """

    def __setstate__(self, state: Any) -> None:
        for part in state if isinstance(state, tuple) else (state,):  # a subclass may have slots
            for name, value in (part or {}).items():
                object.__setattr__(self, name, value)
        _close(state)


def _close(value: Any) -> None:
    """Make an array read-only, or all arrays in a container."""
    if isinstance(value, np.ndarray):
        value.setflags(write=False)
    elif isinstance(value, dict):
        _close(tuple(value.values()))
    elif isinstance(value, tuple | list):
        for part in value:
            _close(part)


def as_floats(argument: str, value: ArrayLike) -> FloatArray:
    """A float64 array of `value`, which may hold infinities and NaN.

    Raises:
        ArgumentError: `value` is not an array of real numbers.
    """
    try:
        array = np.asarray(value)
        if np.iscomplexobj(array):
            raise TypeError
        return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError):
        raise ArgumentError(argument, value, "an array of real numbers") from None


def readonly(
    argument: str, value: ArrayLike, shape: tuple[int | None, ...], shape_in_words: str
) -> FloatArray:
    """A read-only copy of `value`, finite and of the shape asked for (None: any length).

    Raises:
        ArgumentError: another shape, or a number that is not finite.
    """
    array = np.array(as_floats(argument, value), order="C", copy=True)
    fits = array.ndim == len(shape) and all(
        want is None or have == want for have, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        raise ArgumentError(f"{argument}.shape", array.shape, shape_in_words)
    if not np.isfinite(array).all():
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ArgumentError(f"{argument}{list(first)}", float(array[first]), "finite")
    array.setflags(write=False)
    return array


def increasing_times(argument: str, value: ArrayLike) -> FloatArray:
    """Read-only times [s], shape (n,), n >= 2, finite and strictly increasing.

    Raises:
        ArgumentError: anything else; names the first time that does not increase.
    """
    t = readonly(argument, value, (None,), "(n,), n >= 2")
    if len(t) < 2:
        raise ArgumentError(f"{argument}.shape", t.shape, "(n,), n >= 2")
    stuck = np.flatnonzero(np.diff(t) <= 0)
    if len(stuck):
        i = int(stuck[0]) + 1
        raise ArgumentError(
            f"{argument}[{i}]", float(t[i]), f"greater than the time before it, {t[i - 1]!s}"
        )
    return t


def positive(argument: str, value: float) -> float:
    """A finite float above zero.

    Raises:
        ArgumentError: anything else.
    """
    number = real_number(argument, value, "a positive finite number")
    if not (number > 0 and np.isfinite(number)):
        raise ArgumentError(argument, value, "a positive finite number")
    return number


def real_number(argument: str, value: object, allowed: str) -> float:
    """A float (infinity included) from a real number; bool and NaN are none.

    Raises:
        ArgumentError: anything else.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise ArgumentError(argument, value, allowed)
    if np.isnan(value):
        raise ArgumentError(argument, value, allowed)
    return float(value)
