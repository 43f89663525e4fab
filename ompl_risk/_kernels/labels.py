"""Labels of a search for paths of little duration and risk, and its state at the vertices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.heap import Heap, empty_heap
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.pair_heap import push_pair
from ompl_risk._kernels.potentials import UNREACHED


class Labels(NamedTuple):
    """Settled labels, in the order of settling; 32 bytes each.

    Attributes:
        least: least duration and risk of a path to a goal that starts with it, shape (c, 2).
        after: next label at the same vertex, -1 if there is none yet, shape (c,).
        trace: label before (-1 at a start), its own vertex, edge between, shape (c, 3).
    """

    least: NDArray[np.int64]
    after: NDArray[np.int32]
    trace: NDArray[np.int32]


class Search(NamedTuple):
    """State of the search at the vertices.

    Attributes:
        heap: vertices that have a candidate.
        candidate: its least duration and risk, shape (n, 2).
        origin: label before it and edge from there, shape (n, 2).
        risk: that of the label settled last, `UNREACHED` before the first, shape (n,).
        ends: first and last settled label, -1 before there is one, shape (n, 2).
        rejected: for each edge inward, the last label at its tail of which the extension has been
            found useless, -1 for none, shape (k,).
        cut: paths of this risk or more need not be found, shape (1,).
    """

    heap: Heap
    candidate: NDArray[np.int64]
    origin: NDArray[np.int32]
    risk: NDArray[np.int64]
    ends: NDArray[np.int32]
    rejected: NDArray[np.int32]
    cut: NDArray[np.int64]


@entry
def empty_labels(capacity):
    """Room for labels."""
    return Labels(
        np.empty((capacity, 2), np.int64),
        np.empty(capacity, np.int32),
        np.empty((capacity, 3), np.int32),
    )


@entry
def with_room(labels, capacity):
    """The same labels with room for more."""
    more, n = empty_labels(capacity), len(labels.after)
    more.least[:n], more.after[:n], more.trace[:n] = labels.least, labels.after, labels.trace
    return more


@entry
def empty_search(n, edges_inward, most_risk):
    """Before anything is settled."""
    return Search(
        empty_heap(n),
        np.empty((n, 2), np.int64),
        np.full((n, 2), -1, np.int32),
        np.full(n, UNREACHED, np.int64),
        np.full((n, 2), -1, np.int32),
        np.full(edges_inward, -1, np.int32),
        np.full(1, most_risk + 1, np.int64),
    )


@kernel
def propose(search, vertex, duration, risk, label, edge):
    """Make a label the candidate of a vertex, if it comes before the one that is."""
    now = search.candidate[vertex]
    if search.heap.place[vertex] < 0 or duration < now[0] or (duration == now[0] and risk < now[1]):
        now[0], now[1] = duration, risk
        search.origin[vertex, 0], search.origin[vertex, 1] = label, edge
        push_pair(search.heap, search.candidate, vertex)


@kernel
def settle(search, labels, label, v):
    """Make the candidate of vertex v its next label."""
    labels.least[label, 0], labels.least[label, 1] = search.candidate[v, 0], search.candidate[v, 1]
    labels.after[label] = -1
    labels.trace[label, 0], labels.trace[label, 1] = search.origin[v, 0], v
    labels.trace[label, 2] = search.origin[v, 1]
    search.risk[v] = search.candidate[v, 1]
    last = search.ends[v, 1]
    if last < 0:
        search.ends[v, 0] = label
    else:
        labels.after[last] = label
    search.ends[v, 1] = label
