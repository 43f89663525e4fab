"""The indexed heap of ``heap`` for keys that are pairs: by the first, ties by the second."""

from __future__ import annotations

from ompl_risk._kernels.jit import kernel


@kernel
def precedes(keys, a, b):
    """Whether the pair of item a stands before that of item b."""
    return keys[a, 0] < keys[b, 0] or (keys[a, 0] == keys[b, 0] and keys[a, 1] < keys[b, 1])


@kernel
def push_pair(heap, keys, item):
    """Put an item in, or restore the order after its key has been lowered."""
    k = heap.place[item]
    if k < 0:
        k = heap.size[0]
        heap.size[0] += 1
    while k > 0:
        above = (k - 1) >> 2
        other = heap.items[above]
        if not precedes(keys, item, other):
            break
        heap.items[k] = other
        heap.place[other] = k
        k = above
    heap.items[k] = item
    heap.place[item] = k


@kernel
def pop_pair(heap, keys):
    """Take out the item with the least key; the heap must not be empty."""
    least = heap.items[0]
    heap.place[least] = -1
    heap.size[0] -= 1
    n = heap.size[0]
    if n == 0:
        return least
    item = heap.items[n]
    k = 0
    while True:
        child = 4 * k + 1
        if child >= n:
            break
        best = child
        for c in range(child + 1, min(child + 4, n)):
            if precedes(keys, heap.items[c], heap.items[best]):
                best = c
        other = heap.items[best]
        if not precedes(keys, other, item):
            break
        heap.items[k] = other
        heap.place[other] = k
        k = best
    heap.items[k] = item
    heap.place[item] = k
    return least
