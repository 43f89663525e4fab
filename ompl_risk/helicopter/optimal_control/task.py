"""What a manoeuvre has to do, and in how many of the 13 numbers of a state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from ompl_risk.helicopter.trims import Trim

STATE, CONTROL = 13, 4
Z, SPEEDS, RATES = 2, 7, 10  # places of the height, v and omega in a state


class Motion(NamedTuple):
    """The numbers of a state and of a control that change; all others stay 0.

    Args:
        states: their places in a state.
        controls: their places in a control.
    """

    states: tuple[int, ...]
    controls: tuple[int, ...]

    def whole_state(self, part: Any) -> list[Any]:
        """The 13 numbers of a state, of those that change."""
        return _spread(part, self.states, STATE)

    def whole_control(self, part: Any) -> list[Any]:
        """The 4 numbers of a control, of those that change."""
        return _spread(part, self.controls, CONTROL)


PLANE = Motion((0, 2, 4, 6, 7, 9, 11), (0, 2))
"""Flight in a vertical plane: eqs. (7) and (8) never leave it without u_psi and gamma_r."""

SPACE = Motion(tuple(range(STATE)), tuple(range(CONTROL)))
"""Any flight."""


@dataclass(frozen=True)
class Task:
    """To fly from one trim into another.

    The place of the end is free, its height only if a trim climbs, and its heading only if a trim
    turns.

    Args:
        first: the trim at the beginning.
        last: the trim at the end.
    """

    first: Trim
    last: Trim

    @property
    def name(self) -> str:
        """The two trims in words: speed and climb [m/s], turn rate [rad/s]."""
        return f"{_words(self.first)} to {_words(self.last)}"

    @property
    def motion(self) -> Motion:
        """Straight trims are joined in the vertical plane."""
        return SPACE if self.turning else PLANE

    @property
    def turning(self) -> bool:
        """Whether a trim turns."""
        return self.first.turn != 0.0 or self.last.turn != 0.0

    @property
    def level(self) -> bool:
        """Whether neither trim climbs."""
        return self.first.climb == 0.0 and self.last.climb == 0.0


def _spread(part: Any, places: Sequence[int], size: int) -> list[Any]:
    whole: list[Any] = [0.0] * size
    for i, place in enumerate(places):
        whole[place] = part[i]
    return whole


def _words(trim: Trim) -> str:
    parts = [f"{trim.speed:g} m/s"]
    if trim.climb:
        parts.append(f"climb {trim.climb:+g}")
    if trim.turn:
        parts.append(f"turn {trim.turn:+.3g}")
    return " ".join(parts)
