"""Where a planned route has the vehicle at given times: exact, also between the steps."""

from __future__ import annotations

import numpy as np

from ompl_risk._kernels.deviations import placed
from ompl_risk._kernels.jit import entry
from ompl_risk._kernels.pieces import HEADING, KIND, NUMBER, TRIM, X, Y, Z, position_at
from ompl_risk._kernels.rigid_body import STATE, step


@entry
def planned(times, rows, begins, trims, tracks, flown, inputs, given, out):
    """``out`` (n, 13) = the states of a route at increasing times.

    A trim is known in closed form; within a step of a manoeuvre the vehicle is where a shorter
    step leads. Before the first and after the last piece that piece goes on.

    Args:
        times: [s], shape (n,).
        rows: pieces; the number of a trim is its row in ``trims``, shape (m, 10).
        begins: when the pieces begin [s], shape (m,).
        trims: states at the origin and heading 0, shape (k, 13).
        tracks: of the manoeuvres.
        flown: states of the manoeuvres from the origin and heading 0, one after the other.
        inputs: their controls, each with one more row than it has steps.
        given: parameters of the helicopter.
        out: written.
    """
    body, i = np.zeros(STATE), 0
    for k in range(len(times)):
        while i + 1 < len(rows) and times[k] >= begins[i + 1]:
            i += 1
        row, since = rows[i], times[k] - begins[i]
        number = int(row[NUMBER])
        if row[KIND] == TRIM:
            x, y, z, heading = position_at(row, tracks, since)
            placed(trims[number], x, y, z, heading, out[k])
        else:
            begin, last = tracks.first[number], tracks.first[number + 1] - 1
            j = min(begin + int(since / tracks.dt), last - 1)
            step(flown[j], inputs[j], since - (j - begin) * tracks.dt, given, body)
            placed(body, row[X], row[Y], row[Z], row[HEADING], out[k])
