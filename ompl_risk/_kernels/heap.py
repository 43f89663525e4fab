"""An indexed 4-ary heap of vertices: the least key first, keys may be lowered in place."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.jit import entry, kernel


class Heap(NamedTuple):
    """Work space for up to n items.

    Attributes:
        items: those in the heap, in heap order, shape (n,).
        place: where an item stands among them, -1 if it is not in the heap, shape (n,).
        size: how many there are, shape (1,).
    """

    items: NDArray[np.int32]
    place: NDArray[np.int32]
    size: NDArray[np.int64]


@entry
def empty_heap(n):
    """A heap that can hold the items 0 to n - 1."""
    return Heap(np.empty(n, np.int32), np.full(n, -1, np.int32), np.zeros(1, np.int64))


@kernel
def push(heap, keys, item):
    """Put an item in, or restore the order after its key has been lowered."""
    k = heap.place[item]
    if k < 0:
        k = heap.size[0]
        heap.size[0] += 1
    key = keys[item]
    while k > 0:
        above = (k - 1) >> 2
        other = heap.items[above]
        if keys[other] <= key:
            break
        heap.items[k] = other
        heap.place[other] = k
        k = above
    heap.items[k] = item
    heap.place[item] = k


@kernel
def pop(heap, keys):
    """Take out the item with the least key; the heap must not be empty."""
    least = heap.items[0]
    heap.place[least] = -1
    heap.size[0] -= 1
    n = heap.size[0]
    if n == 0:
        return least
    item = heap.items[n]
    key = keys[item]
    k = 0
    while True:
        child = 4 * k + 1
        if child >= n:
            break
        best = child
        for c in range(child + 1, min(child + 4, n)):
            if keys[heap.items[c]] < keys[heap.items[best]]:
                best = c
        other = heap.items[best]
        if keys[other] >= key:
            break
        heap.items[k] = other
        heap.place[other] = k
        k = best
    heap.items[k] = item
    heap.place[item] = k
    return least
