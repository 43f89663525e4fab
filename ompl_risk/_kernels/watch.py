"""Least clearance and first contact of a rollout, checked continuously as it goes on.

Positions are recorded step by step, and every SEGMENT steps the way since the last check is
searched. d changes along it by at most the distance travelled: between two samples with clearances
d0 and d1, s apart along the way, it stays above (d0 + d1 - s) / 2. A piece whose bound is not
below the least clearance so far less TOLERANCE is done with, others are halved. So ``least`` is
above the least clearance of the way by no more than TOLERANCE, and contact is never missed.

The way is straight between two steps: an acceleration a bends it by a dt^2 / 8, at 40 m/s^2 and
50 Hz by 2 mm. A clearance below CONTACT, which is more than that, counts as touching.

Over ground that is e(x, y) higher than the map the clearance is that over the map at z - e. A way
of length s becomes one of length at most s times the greatest singular value of the shear
(x, y, z) -> (x, y, z - e), which for slopes of e up to L is (L + sqrt(L^2 + 4)) / 2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.air import LEFT_MAP, LOST_CONTROL, TOUCHED
from ompl_risk._kernels.height_field import HeightField, opened
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.nearest import signed_distance, workspace
from ompl_risk._kernels.terrain_error import error_at

TOLERANCE = 0.1
"""How much ``least`` may be above the least clearance of the way [m]."""

CONTACT = 5e-3
"""Clearance that counts as touching [m]."""

SEGMENT = 256
"""Steps that are recorded between two checks."""

DEPTH = 64
"""Pieces that can wait while their left neighbours are halved."""

RECORDED, BEFORE, CLEAR, STRETCH, STEP = range(5)
MARKS = 5
"""Places in ``marks``: steps recorded, steps before them, clearance at the first of them [m], what
lengths are multiplied by for the terrain's error, and the time of a step [s]."""


class Watch(NamedTuple):
    """Work space of the checks of one rollout after the other.

    Attributes:
        field: the ground.
        stack, keys: work space of a distance query.
        places: x, y, z [m] and length of the way since the last check, shape (SEGMENT + 1, 4).
        pieces: time [steps] and clearance [m] at the ends of pieces, shape (DEPTH, 2).
        marks: see above.
        watching: whether there is ground.
    """

    field: HeightField
    stack: NDArray[np.int64]
    keys: NDArray[np.float64]
    places: NDArray[np.float64]
    pieces: NDArray[np.float64]
    marks: NDArray[np.float64]
    watching: bool


@entry
def opened_watch(handle):
    """Work space over the ground behind a handle; one for each thread."""
    stack, keys = workspace()
    places, pieces, marks = np.empty((SEGMENT + 1, 4)), np.empty((DEPTH, 2)), np.zeros(MARKS)
    return Watch(opened(handle), stack, keys, places, pieces, marks, handle[0] != 0)


@kernel
def shared_watch(watch, places, marks):
    """A watch of a rollout of its own that shares the rest of the work space with another."""
    return Watch(watch.field, watch.stack, watch.keys, places, watch.pieces, marks, watch.watching)


@kernel
def begin_watch(watch, air, k, position, dt, record):
    """Rollout k begins at a position; returns whether it may go on."""
    slope = air.slopes[k] if len(air.waves) else 0.0
    marks = watch.marks
    marks[RECORDED], marks[BEFORE], marks[STEP] = 0.0, 0.0, dt
    marks[STRETCH] = 0.5 * (slope + math.sqrt(slope * slope + 4.0))
    for i in range(3):
        watch.places[0, i] = position[i]
    watch.places[0, 3] = 0.0
    record.least[k], record.when[k], record.collided[k] = math.inf, 0.0, math.inf
    record.endings[k] = 0
    _trace(air, k, 0, position)
    if not watch.watching:
        _put(watch, record, k, 0.0, math.inf)
        return True
    d = _clearance(watch, air, k, 0.0, math.inf)
    _put(watch, record, k, 0.0, d)
    marks[CLEAR] = d
    if d <= CONTACT:
        _collide(watch, record, k, 0.0, d)
        _trace_rest(air, k, 1, position)
    return d > CONTACT


@kernel
def watched(watch, air, k, position, last, record):
    """Rollout k has made a step to a position; returns whether it may go on.

    Args:
        watch: work space.
        air: what the rollouts meet.
        k: number of the rollout.
        position: at least x, y, z [m].
        last: whether that was the last step.
        record: written.
    """
    marks, places = watch.marks, watch.places
    n = int(marks[RECORDED]) + 1
    marks[RECORDED] = n
    dx, dy = position[0] - places[n - 1, 0], position[1] - places[n - 1, 1]
    dz = position[2] - places[n - 1, 2]
    places[n, 0], places[n, 1], places[n, 2] = position[0], position[1], position[2]
    way = math.sqrt(dx * dx + dy * dy + dz * dz)
    places[n, 3] = places[n - 1, 3] + marks[STRETCH] * way
    step = int(marks[BEFORE]) + n
    _trace(air, k, step, position)
    if n < SEGMENT and not last:
        return True
    free = not watch.watching or _search(watch, air, k, n, record)
    if last or not free:
        _trace_rest(air, k, step + 1, position)
    marks[RECORDED], marks[BEFORE] = 0.0, step
    for i in range(3):
        places[0, i] = places[n, i]
    return free


@kernel
def lose(watch, air, k, position, record):
    """Rollout k is out of control: it ends here, unless it has collided before."""
    unchecked = watch.marks[RECORDED] > 0.0
    if unchecked and not watched(watch, air, k, position, unchecked, record):
        return
    _collide(watch, record, k, 0.0, -math.inf)
    record.endings[k] = LOST_CONTROL
    _trace_rest(air, k, int(watch.marks[BEFORE]) + 1, watch.places[0])


@kernel
def _search(watch, air, k, n, record):
    """Search the way of n steps by halving, first things first; returns whether it is free."""
    places, pieces, marks = watch.places, watch.pieces, watch.marks
    t0, d0, hit = 0.0, marks[CLEAR], False
    d1 = _clearance(watch, air, k, float(n), record.least[k] + places[n, 3])
    marks[CLEAR] = d1
    pieces[0, 0], pieces[0, 1] = n, d1
    top = 1
    while top > 0:
        t1, d1 = pieces[top - 1, 0], pieces[top - 1, 1]
        if d1 <= CONTACT:
            hit = True
            pieces[0, 0], pieces[0, 1] = t1, d1  # what comes later does not matter any more
            top = 1
        elif d1 < record.least[k]:
            _put(watch, record, k, t1, d1)
        s = _length(places, t1) - _length(places, t0)
        low = 0.5 * (d0 + d1 - s)
        if low >= (CONTACT if hit else max(record.least[k] - TOLERANCE, CONTACT)):
            t0, d0 = t1, d1
            top -= 1
            continue
        if not s > CONTACT:
            _collide(watch, record, k, t1, d1)
            return False
        t = 0.5 * (t0 + t1)
        pieces[top, 0], pieces[top, 1] = t, _clearance(watch, air, k, t, record.least[k] + s)
        top += 1
    return True


@kernel
def _length(places, t):
    """Length of the way up to a time [steps]."""
    i = min(int(t), SEGMENT - 1)
    return places[i, 3] + (t - i) * (places[i + 1, 3] - places[i, 3]) if t > i else places[i, 3]


@kernel
def _place(places, t):
    """Position at a time [steps]."""
    i = int(t)
    f = t - i
    if f == 0.0:
        return places[i, 0], places[i, 1], places[i, 2]
    return (
        places[i, 0] + f * (places[i + 1, 0] - places[i, 0]),
        places[i, 1] + f * (places[i + 1, 1] - places[i, 1]),
        places[i, 2] + f * (places[i + 1, 2] - places[i, 2]),
    )


@kernel
def _clearance(watch, air, k, t, bound):
    """Clearance over the true ground at a time [steps], at most ``bound``."""
    x, y, z = _place(watch.places, t)
    if len(air.waves):
        z -= error_at(air.waves, air.scale, air.amplitudes[k], x, y)
    reach = max(bound, CONTACT) + air.radius
    return signed_distance(watch.field, x, y, z, reach, watch.stack, watch.keys) - air.radius


@kernel
def _put(watch, record, k, t, d):
    """The least clearance so far is here."""
    record.least[k], record.when[k] = d, (watch.marks[BEFORE] + t) * watch.marks[STEP]
    x, y, z = _place(watch.places, t)
    record.where[k, 0], record.where[k, 1], record.where[k, 2] = x, y, z


@kernel
def _collide(watch, record, k, t, d):
    """The rollout ends here."""
    _put(watch, record, k, t, min(d, 0.0))
    record.collided[k] = record.when[k]
    record.endings[k] = TOUCHED if d > -math.inf else LEFT_MAP


@kernel
def _trace(air, k, step, position):
    """Write the position if it is the turn of this step."""
    row = step // air.trace_every
    if row < air.traces.shape[1] and row * air.trace_every == step:
        for i in range(3):
            air.traces[k, row, i] = position[i]


@kernel
def _trace_rest(air, k, step, position):
    """A vehicle that has ended stays where it is."""
    for row in range(-(-step // air.trace_every), air.traces.shape[1]):
        for i in range(3):
            air.traces[k, row, i] = position[i]
