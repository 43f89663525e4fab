"""Memory that OMPL writes states and controls into and that kernels read."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

_new_capsule = ctypes.pythonapi.PyCapsule_New
_new_capsule.restype = ctypes.py_object
_new_capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]


def capsule_of(address: int) -> object:
    """What ``serialize`` and ``deserialize`` of OMPL's spaces take for memory at an address."""
    return _new_capsule(address, b"nb_handle", None)


class Buffer:
    """Numbers at a fixed place.

    Args:
        size: how many.

    Attributes:
        numbers: shape (size,).
        address: where they are.
        capsule: the same for OMPL's spaces, see ``capsule_of``.
    """

    def __init__(self, size: int) -> None:
        self.numbers = np.zeros(size)
        self.address = self.numbers.ctypes.data
        self.capsule = capsule_of(self.address)


def table(*addresses: int) -> NDArray[np.int64]:
    """Addresses as kernels take them; the caller keeps what is behind them alive."""
    return np.array(addresses, dtype=np.int64)
