"""All paths whose duration and risk no other path undercuts: label setting with dominance.

A label is a path from a start to a vertex, with the least duration and risk of any way on to a
goal. Labels are settled in the order of that pair. So at each vertex durations come rising, and a
label is of use only if its risk is below that of the label settled there last, and below the
risk of the last path that reached a goal: two comparisons (Ulloa et al., 2020). The heap holds one
candidate a vertex, the next one; when it has been settled, the one after it is looked up among the
settled labels of the neighbours (Sedeño-Noda & Colebrook, 2019). So most labels are rejected
without ever having been in a heap.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.labels import empty_labels, empty_search, propose, settle, with_room
from ompl_risk._kernels.pair_heap import pop_pair
from ompl_risk._kernels.potentials import UNREACHED


@kernel
def extend(search, labels, label, out, longest, maximum):
    """Propose the extensions of a label along the edges that leave its vertex."""
    v, duration, risk = labels.trace[label, 1], labels.least[label, 0], labels.least[label, 1]
    for h in range(out.first[v], out.first[v + 1]):
        extra, w = out.extra[h, 1], out.other[h]
        there = max(risk, extra) if maximum else risk + extra
        if there < search.risk[w] and there < search.cut[0]:
            reached = duration + out.extra[h, 0]
            if reached <= longest:
                propose(search, w, reached, there, label, out.edge[h])


@kernel
def find_next(search, labels, v, into, longest, maximum):
    """Propose the first useful extension of settled labels to vertex v."""
    bound = min(search.risk[v], search.cut[0])
    for h in range(into.first[v], into.first[v + 1]):
        u, extra = into.other[h], into.extra[h, 1]
        # The last label at u has the least risk of all there.
        if (max(search.risk[u], extra) if maximum else search.risk[u] + extra) >= bound:
            continue
        rejected = search.rejected[h]
        label = search.ends[u, 0] if rejected < 0 else labels.after[rejected]
        there = labels.least[label, 1]
        there = max(there, extra) if maximum else there + extra
        while there >= bound:
            search.rejected[h] = label
            label = labels.after[label]
            there = labels.least[label, 1]
            there = max(there, extra) if maximum else there + extra
        reached = labels.least[label, 0] + into.extra[h, 0]
        if reached <= longest:
            propose(search, v, reached, there, label, into.edge[h])


@kernel
def least_useless(risk, precision):
    """Least risk that need not be found once a path of this risk has been."""
    if precision == 0.0:
        return risk
    return min(risk, np.int64(math.ceil(risk / (1.0 + precision))))


@entry
def pareto_labels(out, into, starts, is_goal, to_goal, limits, precision, maximum, most):
    """Settle labels until every path that is needed has reached a goal.

    Args:
        out: `Rows` of the edges that leave each vertex.
        into: `Rows` of those that lead to it.
        starts: vertices from which a goal can be reached within the limits, shape (s,).
        is_goal: shape (n,).
        to_goal: least duration and risk from each vertex to a goal, shape (n, 2).
        limits: greatest duration and risk of a path.
        precision: a path need not be found if one no slower, of at most (1 + precision) times its
            risk, has been.
        maximum: whether the greatest risk counts, rather than the sum.
        most: greatest number of labels.

    Returns:
        Labels; how many there are; those at goals, fastest first; whether ``most`` was enough.
    """
    labels, count = empty_labels(min(most, 4096)), 0
    search = empty_search(len(is_goal), len(into.other), limits[1])
    found = np.empty(64, np.int32)
    paths, least = 0, UNREACHED
    for s in starts:
        least = min(least, to_goal[s, 1])
        propose(search, s, to_goal[s, 0], to_goal[s, 1], -1, -1)
    while search.heap.size[0] > 0 and least < search.cut[0]:
        v = pop_pair(search.heap, search.candidate)
        if search.candidate[v, 1] < search.cut[0]:
            if count == most:
                return labels, count, found[:paths].copy(), False
            if count == len(labels.after):
                labels = with_room(labels, min(most, 2 * count))
            settle(search, labels, count, v)
            if is_goal[v]:
                search.cut[0] = least_useless(search.candidate[v, 1], precision)
                if paths == len(found):
                    found = np.append(found, np.empty(paths, np.int32))
                found[paths] = count
                paths += 1
            else:
                extend(search, labels, count, out, limits[0], maximum)
            count += 1
        find_next(search, labels, v, into, limits[0], maximum)
    return labels, count, found[:paths].copy(), True


@entry
def trace_back(trace, label):
    """Vertices and edges of the path that a label stands for."""
    length, k = 0, label
    while trace[k, 0] >= 0:
        length, k = length + 1, trace[k, 0]
    vertices, edges = np.empty(length + 1, np.int32), np.empty(length, np.int32)
    vertices[0] = trace[k, 1]
    while trace[label, 0] >= 0:
        length -= 1
        vertices[length + 1], edges[length] = trace[label, 1], trace[label, 2]
        label = trace[label, 0]
    return vertices, edges
