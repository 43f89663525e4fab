"""Trims over a grid of speed, climb and turn rate."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, readonly
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.trims import Key, Trim, solve_trim

SAME = 1e-9
"""Share by which a speed, climb or turn rate may differ from the tabulated one: rounding."""


@dataclass(frozen=True, init=False, eq=False)
class TrimGrid(ReadOnlyArrays):
    """The trims of all combinations of speed, climb and turn rate that keep the limits.

    Trims to the right are the mirror images of those to the left.

    Args:
        helicopter: what flies, in still air.
        limits: what it may do; a trim that breaks them is left out.
        speeds: speeds [m/s], shape (k,), 0 or more and increasing.
        turns: turn rates by speed [rad/s], shape (k, 4): hard right, gentle right, gentle left,
            hard left.
        climbs: climb rates by speed, other than 0 [m/s], increasing, k of them.

    Raises:
        ArgumentError: a number out of range, or a speed whose level straight trim does not exist
            or breaks a limit.
    """

    speeds: FloatArray
    turns: FloatArray
    climbs: tuple[FloatArray, ...]
    trims: tuple[Trim, ...]
    _by_key: dict[Key, Trim] = field(repr=False)

    def __init__(
        self,
        helicopter: Helicopter,
        limits: Limits,
        *,
        speeds: ArrayLike,
        turns: ArrayLike,
        climbs: Sequence[ArrayLike],
    ) -> None:
        given = _speeds(speeds)
        object.__setattr__(self, "speeds", given)
        object.__setattr__(self, "turns", _turns(turns, len(given)))
        object.__setattr__(self, "climbs", _climbs(climbs, len(given)))
        object.__setattr__(self, "trims", tuple(self._solved(helicopter, limits)))
        object.__setattr__(self, "_by_key", {trim.key: trim for trim in self.trims})

    def trim(self, speed: float, climb: float = 0.0, turn: float = 0.0) -> Trim:
        """The trim of a speed and climb [m/s] and turn rate [rad/s].

        Raises:
            ArgumentError: no such trim; names those that exist.
        """
        key = Key(speed, climb, turn)
        found = self._by_key.get(key)
        if found is not None:
            return found
        near = self.trims
        for place, (name, value) in enumerate(zip(Key._fields, key, strict=True)):
            fits = tuple(t for t in near if _is_same(t.key[place], value))
            if not fits:
                raise _no_trim(name, value, near, key[:place])
            near = fits
        return near[0]

    def _solved(self, helicopter: Helicopter, limits: Limits) -> Iterator[Trim]:
        """The trims within the limits, by speed, climb and turn rate."""
        for speed, turns, climbs in zip(self.speeds.tolist(), self.turns, self.climbs, strict=True):
            solve_trim(helicopter, speed, limits=limits)  # the one that must exist
            for climb in sorted([0.0, *climbs.tolist()]):
                left: list[Trim] = []
                for turn in (0.0, *turns[2:].tolist()):
                    try:
                        left.append(solve_trim(helicopter, speed, climb, turn, limits))
                    except ArgumentError:
                        continue
                yield from (t.mirrored() for t in reversed(left) if t.turn)
                yield from left


def _is_same(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=SAME, abs_tol=1e-12)


def _no_trim(name: str, value: float, near: tuple[Trim, ...], before: Sequence[float]) -> Exception:
    """The error that says what there is, among trims that agree in what comes before."""
    there = ", ".join(f"{v:.6g}" for v in sorted({getattr(t, name) for t in near}))
    given = zip(Key._fields[: len(before)], before, strict=True)
    at = " and ".join(f"{known} {v:.6g}" for known, v in given)
    return ArgumentError(name, value, f"one of {there}" + f" at {at}" * bool(at))


def _speeds(value: ArrayLike) -> FloatArray:
    speeds = readonly("speeds", value, (None,), "(k,)")
    if not len(speeds) or speeds[0] < 0.0 or (np.diff(speeds) <= 0.0).any():
        raise ArgumentError("speeds", speeds.tolist(), "0 or more and increasing, at least one")
    return speeds


def _turns(value: ArrayLike, count: int) -> FloatArray:
    turns = readonly("turns", value, (count, 4), f"({count}, 4), a row for each speed")
    wrong = (np.diff(turns, axis=1) <= 0.0).any(axis=1) | (turns != -turns[:, ::-1]).any(axis=1)
    if wrong.any():
        k = int(np.flatnonzero(wrong)[0])
        allowed = "(-hard, -gentle, gentle, hard) with 0 < gentle < hard"
        raise ArgumentError(f"turns[{k}]", turns[k].tolist(), allowed)
    return turns


def _climbs(value: Sequence[ArrayLike], count: int) -> tuple[FloatArray, ...]:
    climbs = tuple(readonly(f"climbs[{k}]", c, (None,), "(n,)") for k, c in enumerate(value))
    if len(climbs) != count:
        raise ArgumentError("len(climbs)", len(climbs), f"{count}, one for each speed")
    for k, rates in enumerate(climbs):
        if (np.diff(rates) <= 0.0).any() or (rates == 0.0).any():
            raise ArgumentError(f"climbs[{k}]", rates.tolist(), "increasing and other than 0")
    return climbs
