"""Names of the columns of trajectories in text files."""

from __future__ import annotations

import re
from collections.abc import Sequence

POSITION = ("t", "x", "y", "z")
ORIENTATION = ("qx", "qy", "qz", "qw")
VELOCITY = ("vx", "vy", "vz")
TUM = (*POSITION, *ORIENTATION)
HELICOPTER = ("u_c", "u_psi", "gamma_p", "gamma_r")
"""The four controls of the paper's helicopter."""
_NUMBERED = re.compile(r"u[1-9][0-9]*")


def control_columns(count: int) -> tuple[str, ...]:
    """Columns of so many controls: four are the helicopter's, others are u1, u2 and so on."""
    if count == len(HELICOPTER):
        return HELICOPTER
    return _numbered(count)


def is_control(column: str) -> bool:
    """Whether a column of that name holds a control."""
    return column in HELICOPTER or _NUMBERED.fullmatch(column) is not None


def is_known(column: str) -> bool:
    """Whether a column of that name is part of a trajectory, in upper or lower case."""
    column = column.lower()
    return column in (*TUM, *VELOCITY) or is_control(column)


def expected_columns(header: Sequence[str]) -> tuple[str, ...]:
    """The columns that a header must have, judged by those that it has.

    A group of columns is expected whole as soon as one of it is there; numbered controls are
    expected without a gap from u1 on.
    """
    expected = POSITION
    for group in (ORIENTATION, VELOCITY, HELICOPTER):
        if any(column in header for column in group):
            expected += group
    return expected + _numbered(sum(_NUMBERED.fullmatch(column) is not None for column in header))


def _numbered(count: int) -> tuple[str, ...]:
    return tuple(f"u{k + 1}" for k in range(count))
