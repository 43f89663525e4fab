"""What the compiled steering looks up, from a library of trims and manoeuvres."""

from __future__ import annotations

import cmath
import math

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive, readonly
from ompl_risk._kernels import connect_tables as columns
from ompl_risk._kernels.connect_tables import ConnectTables
from ompl_risk._kernels.pieces import Tracks, joined_tracks
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.library import PrimitiveLibrary
from ompl_risk.helicopter.primitives import Manoeuvre

LEVEL = 1e-9
"""How far a turn or a change of speed may end from the height at which it began [m]."""
PLANE = 1e-9
"""How far a climb or a change of speed may end from its vertical plane [m], [rad]."""


def tracks(library: PrimitiveLibrary) -> Tracks:
    """Where the manoeuvres of a library lead."""
    return joined_tracks([m.track for m in library.manoeuvres], library.dt)


def connect_tables(
    library: PrimitiveLibrary, *, cruise: ArrayLike | None = None, longest_ratio: float = 3.0
) -> ConnectTables:
    """Tables of a library.

    At each speed there are four turns, hard and gentle to both sides, and four counter-turns: a
    gentle turn followed by one to the other side, one of them as short as can be, for heading
    changes that are smaller than those of the manoeuvres into and out of a turn.

    Args:
        library: trims and manoeuvres; what it lacks is not flown.
        cruise: speeds of straight flights [m/s], shape (m,); None: all above 0.
        longest_ratio: a way may take so many times as long as straight flight over its distance,
            and in addition half a circle of the hard turn at both ends.

    Raises:
        ArgumentError: a cruise speed that the library does not have, a ratio below 1, a manoeuvre
            that leaves its plane or its height, or more primitives than there is room for.
    """
    if positive("longest_ratio", longest_ratio) < 1.0:
        raise ArgumentError("longest_ratio", longest_ratio, "1 or more")
    n = len(library.speeds)
    blocks = np.stack([_blocks(library, k) for k in range(n)])
    chosen = _cruise(library, cruise)
    climbs = _climbs(library, chosen.tolist())
    if len(chosen) * climbs.shape[2] > columns.MOST_OPTIONS:
        allowed = f"at most {columns.MOST_OPTIONS}"
        raise ArgumentError("cruise speeds x climb rates", len(chosen) * climbs.shape[2], allowed)
    ends = [m.displacement for m in library.manoeuvres]
    fields = {
        "speeds": np.array(library.speeds),
        "blocks": blocks,
        "changes": np.array([[_change(library, i, j) for j in range(n)] for i in range(n)]),
        "climbs": climbs,
        "cruise": chosen,
        "ends": np.array(ends).reshape(-1, 4),
        "durations": np.array([m.duration for m in library.manoeuvres]),
        "allowance": np.array([_allowance(rows) for rows in blocks]),
    }
    for array in fields.values():
        array.setflags(write=False)
    return ConnectTables(**fields, longest_ratio=float(longest_ratio))


def used(tables: ConnectTables) -> list[int]:
    """Numbers of the manoeuvres that the tables refer to."""
    numbers = [
        tables.blocks[..., columns.BEFORE :],
        tables.changes[..., columns.CHANGE],
        tables.climbs[..., columns.CLIMB_ENTRY :],
    ]
    found = np.unique(np.concatenate([part.ravel() for part in numbers])).astype(int)
    return [k for k in found.tolist() if k != columns.NONE]


def _manoeuvre(library: PrimitiveLibrary, first: ArrayLike, last: ArrayLike) -> Manoeuvre | None:
    """The manoeuvre between the trims of two keys, if there is one."""
    try:
        ends = [library.trim(*np.asarray(key, dtype=np.float64).tolist()) for key in (first, last)]
        return library.manoeuvre(*ends)
    except ArgumentError:
        return None


def _blocks(library: PrimitiveLibrary, k: int) -> FloatArray:
    hard_right, right, left, hard_left = library.turns[k].tolist()
    hard = [_turn(library, k, rate) for rate in (hard_right, hard_left)]
    gentle = [_turn(library, k, rate) for rate in (right, left)]
    rows = [*hard, *gentle]
    for one, two in (gentle, gentle[::-1]):
        rows += [_counter_turn(one, two, held=one), _counter_turn(one, two, held=two)]
    return np.array(rows)


def _missing_block() -> list[float]:
    row = [0.0] * columns.BLOCK_COLUMNS
    row[columns.RATE], row[columns.LEAST_TIME], row[columns.MOST_TAN] = 1.0, math.inf, math.inf
    row[columns.BEFORE :] = [columns.NONE] * (columns.BLOCK_COLUMNS - columns.BEFORE)
    return row


def _turn(library: PrimitiveLibrary, k: int, rate: float) -> list[float]:
    """A block of one turn: A = D_in - e^{i theta_in} r, B = e^{-i theta_out} (r + D_out).

    r = V / (i rate) points from the centre of the circle to where it begins.
    """
    speed = float(library.speeds[k])
    entry = _manoeuvre(library, (speed, 0.0, 0.0), (speed, 0.0, rate))
    leave = _manoeuvre(library, (speed, 0.0, rate), (speed, 0.0, 0.0))
    if entry is None or leave is None:
        return _missing_block()
    (d_in, turn_in), (d_out, turn_out) = _level_end(entry), _level_end(leave)
    r = speed / (1j * rate)
    a = d_in - cmath.exp(1j * turn_in) * r
    b = cmath.exp(-1j * turn_out) * (r + d_out)
    least = [turn_in + turn_out, entry.duration + leave.duration, rate, math.inf, math.inf]
    none = float(columns.NONE)
    return [*_parts(a), *_parts(b), *least, none, none, entry.number, leave.number, none, none]


def _counter_turn(one: list[float], two: list[float], *, held: list[float]) -> list[float]:
    """Block ``one`` followed by block ``two``, of which only ``held`` holds its turn trim.

    It is for heading changes up to twice that of the held turn's manoeuvres: from that on there is
    the turn alone, and the overlap leaves no gap though the two lead to different places.
    """
    if math.isinf(one[columns.LEAST_TIME] + two[columns.LEAST_TIME]):
        return _missing_block()
    (a1, b1), (a2, b2) = _constants(one), _constants(two)
    turn1, turn2 = one[columns.LEAST_TURN], two[columns.LEAST_TURN]
    u1, u2 = cmath.exp(1j * turn1), cmath.exp(1j * turn2)
    entry1, leave1 = one[columns.AFTER - 1 : columns.AFTER + 1]
    entry2, leave2 = two[columns.AFTER - 1 : columns.AFTER + 1]
    if held is one:
        a, b = a1, (b1 + a2 + u2 * b2) / u2
        numbers = [columns.NONE, columns.NONE, entry1, leave1, entry2, leave2]
    else:
        a, b = a1 + u1 * (b1 + a2), b2
        numbers = [entry1, leave1, entry2, leave2, columns.NONE, columns.NONE]
    turn, rate = turn1 + turn2, held[columns.RATE]
    most = 2.0 * abs(held[columns.LEAST_TURN])
    widest = math.tan(most + abs(turn)) if most + abs(turn) < 1.5 else math.inf
    time = one[columns.LEAST_TIME] + two[columns.LEAST_TIME]
    return [*_parts(a), *_parts(b), turn, time, rate, most / abs(rate), widest, *numbers]


def _parts(value: complex) -> list[float]:
    return [value.real, value.imag]


def _constants(row: list[float]) -> tuple[complex, complex]:
    """A and B of a block."""
    return complex(*row[columns.A_RE : columns.B_RE]), complex(
        *row[columns.B_RE : columns.B_IM + 1]
    )


def _level_end(manoeuvre: Manoeuvre) -> tuple[complex, float]:
    """Horizontal displacement and heading change of a manoeuvre that keeps its height."""
    x, y, z, heading = manoeuvre.displacement.tolist()
    if abs(z) > LEVEL:
        allowed = f"within {LEVEL:g} m: it must end at the height at which it began"
        raise ArgumentError(f"rise of manoeuvre {manoeuvre.number}", z, allowed)
    return complex(x, y), heading


def _straight_end(manoeuvre: Manoeuvre) -> tuple[float, float]:
    """Length and rise of a manoeuvre that keeps its vertical plane."""
    x, y, z, heading = manoeuvre.displacement.tolist()
    if max(abs(y), abs(heading)) > PLANE:
        allowed = f"within {PLANE:g} m and rad: it must stay in its vertical plane"
        raise ArgumentError(f"deviation of manoeuvre {manoeuvre.number}", (y, heading), allowed)
    return x, z


def _change(library: PrimitiveLibrary, i: int, j: int) -> list[float]:
    if i == j:
        return [0.0, 0.0, columns.NONE]
    first, last = float(library.speeds[i]), float(library.speeds[j])
    found = _manoeuvre(library, (first, 0.0, 0.0), (last, 0.0, 0.0))
    if found is None:
        return [0.0, math.inf, columns.NONE]
    _level_end(found)
    return [_straight_end(found)[0], found.duration, found.number]


def _climbs(library: PrimitiveLibrary, cruise: list[int]) -> FloatArray:
    """Ascents and descents at the cruise speeds; fewer than the most are filled up."""
    found = [
        [_rates(library, k, sign) if k in cruise else [] for sign in (1.0, -1.0)]
        for k in range(len(library.speeds))
    ]
    most = max(1, *(len(rows) for pair in found for rows in pair))
    for pair in found:
        for rows, sign in zip(pair, (1.0, -1.0), strict=True):
            missing = [sign, 0.0, 0.0, math.inf, columns.NONE, columns.NONE]
            rows.extend([missing] * (most - len(rows)))
    return np.array(found, dtype=np.float64)


def _rates(library: PrimitiveLibrary, k: int, sign: float) -> list[list[float]]:
    """The climbs of one sign at a speed, gentler ones first."""
    level = (float(library.speeds[k]), 0.0, 0.0)
    rows: list[list[float]] = []
    for climb in sorted((c for c in library.climbs[k].tolist() if c * sign > 0.0), key=abs):
        entry = _manoeuvre(library, level, (level[0], climb, 0.0))
        leave = _manoeuvre(library, (level[0], climb, 0.0), level)
        if entry is None or leave is None:
            continue
        (x1, z1), (x2, z2) = _straight_end(entry), _straight_end(leave)
        time = entry.duration + leave.duration
        rows.append([climb, x1 + x2, z1 + z2, time, entry.number, leave.number])
    return rows


def _cruise(library: PrimitiveLibrary, cruise: ArrayLike | None) -> np.ndarray:
    """Indices of the cruise speeds, fastest first, and of hovering for purely vertical flight."""
    speeds = library.speeds
    if cruise is None:
        return np.arange(len(speeds), dtype=np.int64)[::-1].copy()
    wanted = readonly("cruise", cruise, (None,), "(m,)")
    flown = ", ".join(f"{v:g}" for v in speeds.tolist() if v > 0.0)
    if not len(wanted):
        raise ArgumentError("cruise", wanted.tolist(), f"at least one of {flown} m/s")
    chosen = {int(np.abs(speeds - v).argmin()) for v in wanted.tolist()}
    for k, v in enumerate(wanted.tolist()):
        if v <= 0.0 or np.abs(speeds - v).min() > 1e-9:
            raise ArgumentError(f"cruise[{k}]", v, f"one of {flown} m/s")
    hover = {int(k) for k in np.flatnonzero(speeds == 0.0)}
    return np.array(sorted(chosen | hover, reverse=True), dtype=np.int64)


def _allowance(blocks: FloatArray) -> float:
    """Time of half a circle of the quickest turn."""
    times = blocks[:, columns.LEAST_TIME] + math.pi / np.abs(blocks[:, columns.RATE])
    fastest = float(times.min())
    return fastest if math.isfinite(fastest) else 0.0
