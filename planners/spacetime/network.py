"""Places, and which of them are connected by a straight flight."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import dijkstra

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, as_floats, readonly
from ompl_risk.errors import ArgumentError

Integers = NDArray[np.int64]


class Network(ReadOnlyArrays):
    """Places that a vehicle may fly between, both ways, along straight edges.

    Args:
        places: positions [m], shape (n, 3).
        edges: pairs of numbers of places, shape (m, 2); those given twice count once, those from a
            place to itself not at all.

    Raises:
        ArgumentError: a wrong shape, or a place that does not exist.

    Attributes:
        places: positions [m], shape (n, 3).
        first: where the edges that leave a place begin in ``target``, shape (n + 1,).
        source, target: places at the ends of the edges, each edge once in either direction.
        length: of those [m].
    """

    def __init__(self, places: ArrayLike, edges: ArrayLike) -> None:
        self.places = readonly("places", places, (None, 3), "(n, 3): x, y, z")
        n = len(self.places)
        pairs = _pairs(edges, n)
        tail, head = np.hstack([pairs.T, pairs.T[::-1]])
        rows = coo_matrix((np.ones(len(tail), np.bool_), (tail, head)), shape=(n, n)).tocsr()
        self.first: Integers = rows.indptr.astype(np.int64)
        self.target: Integers = rows.indices.astype(np.int64)
        self.source: Integers = np.repeat(np.arange(n), np.diff(self.first))
        steps = self.places[self.target] - self.places[self.source]
        self.length: FloatArray = np.linalg.norm(steps, axis=1)
        for array in (self.source, self.target, self.first, self.length):
            array.setflags(write=False)

    @property
    def n(self) -> int:
        """Number of places."""
        return len(self.places)

    def lengths_to_go(self, goals: list[int]) -> FloatArray:
        """Length of the shortest way to the nearest goal [m], inf where there is none, shape (n,).

        No way through obstacles is shorter.
        """
        return dijkstra(self._matrix, directed=False, indices=goals, min_only=True)

    @cached_property
    def _matrix(self) -> csr_matrix:
        # An entry of 0 would be no edge: places on top of each other are next to nothing apart.
        length = np.maximum(self.length, np.finfo(float).tiny)
        return csr_matrix((length, self.target, self.first), shape=(self.n, self.n))


def _pairs(edges: ArrayLike, n: int) -> Integers:
    given = np.asarray(edges)
    if given.dtype.kind not in "iu":
        given = as_floats("edges", edges)
    if given.size == 0:
        return np.empty((0, 2), np.int64)
    if given.ndim != 2 or given.shape[1] != 2:
        raise ArgumentError("edges.shape", given.shape, "(m, 2)")
    there = (given >= 0) & (given < n)
    if given.dtype.kind == "f":
        there &= given == np.round(given)
    if not there.all():
        row = int(np.argmin(there.all(axis=1)))
        raise ArgumentError(f"edges[{row}]", given[row].tolist(), f"two places from 0 to {n - 1}")
    pairs = given.astype(np.int64)
    return pairs[pairs[:, 0] != pairs[:, 1]]
