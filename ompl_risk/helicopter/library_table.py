"""Trims and manoeuvres as text, for people."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ompl_risk.helicopter.primitives import Manoeuvre
from ompl_risk.helicopter.trims import Trim

TRIM_COLUMNS = (
    " speed  climb    turn    roll   pitch     u_c   u_psi gamma_p gamma_r",
    "   m/s    m/s   deg/s     deg     deg       N       N     deg     deg",
)
MANOEUVRE_COLUMNS = (
    "no.  from m/s climb  deg/s  to m/s climb  deg/s   time       x       y       z heading   top",
    "                                                     s       m       m       m     deg   m/s",
)


def table(trims: Sequence[Trim], manoeuvres: Sequence[Manoeuvre]) -> str:
    """Trims with attitude and inputs, and manoeuvres with duration and displacement."""
    lines = [*TRIM_COLUMNS, *map(_trim, trims), ""]
    lines += [*MANOEUVRE_COLUMNS, *map(_manoeuvre, manoeuvres)]
    return "\n".join(lines)


def _trim(trim: Trim) -> str:
    u_c, u_psi, *tilt = trim.control.tolist()
    angles = [math.degrees(angle) for angle in (trim.turn, trim.roll, trim.pitch)]
    gammas = [math.degrees(angle) for angle in tilt]
    values = [trim.speed, trim.climb, *angles, u_c, u_psi, *gammas]
    return _row(values, ("6.1", "6.1", "7.2", "7.2", "7.2", "7.2", "7.4", "7.4", "7.4"))


def _manoeuvre(manoeuvre: Manoeuvre) -> str:
    ends = [(t.speed, t.climb, math.degrees(t.turn)) for t in (manoeuvre.first, manoeuvre.last)]
    x, y, z, heading = manoeuvre.displacement.tolist()
    values = [*ends[0], *ends[1], manoeuvre.duration, x, y, z, math.degrees(heading)]
    widths = ("9.1", "5.1", "6.1", "7.1", "5.1", "6.1", "6.2", "7.2", "7.2", "7.2", "7.2", "5.1")
    return f"{manoeuvre.number:3d} " + _row([*values, manoeuvre.fastest], widths)


def _row(values: Sequence[float], widths: Sequence[str]) -> str:
    """Numbers in columns, without a minus before a zero."""
    pairs = zip(values, widths, strict=True)
    return " ".join(f"{round(v, int(w[-1])) + 0.0:{w}f}" for v, w in pairs)
