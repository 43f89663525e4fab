"""The trims and manoeuvres that flights of the helicopter are made of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import KW_ONLY, dataclass, field
from functools import cache
from pathlib import Path

from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive, readonly
from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.helicopter.library_file import REMEDY, read_library
from ompl_risk.helicopter.library_table import table
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.primitives import DT, Manoeuvre, mirrored_controls, replay
from ompl_risk.helicopter.trim_grid import TrimGrid
from ompl_risk.helicopter.trims import Key, Trim

SHIPPED = Path(__file__).parent / "data" / "xcell60.npz"
"""The library of the default helicopter; its manoeuvres keep to nine tenths of the limits."""

TOLERANCE = 1e-9
"""How far a manoeuvre may end from its last trim, see `Manoeuvre.miss`."""

Given = tuple[ArrayLike, ArrayLike, ArrayLike]
"""First key, last key and controls (n, 4) of a manoeuvre."""


@dataclass(frozen=True, init=False, eq=False)
class PrimitiveLibrary:
    """Trims over a grid of speed, climb and turn rate, and the manoeuvres that lead between them.

    Trims are solved and manoeuvres are replayed here, so the inputs are all that is given. Trims
    and manoeuvres to the right are the mirror images of those to the left.

    Args:
        helicopter: what flies, in still air.
        limits: what it may do; a trim of the grid that breaks them is left out.
        speeds: speeds [m/s], shape (k,), 0 or more and increasing.
        turns: turn rates by speed [rad/s], shape (k, 4): hard right, gentle right, gentle left,
            hard left.
        climbs: climb rates by speed, other than 0 [m/s], increasing, k of them.
        manoeuvres: triples of first key, last key and controls (n, 4), a key being (speed, climb,
            turn) of the grid; without those to the right.
        dt: time for which each input is held [s].

    Raises:
        ArgumentError: a number out of range; a level straight trim, or a manoeuvre, that breaks a
            limit; a manoeuvre between trims that do not exist, or one that ends further than 1e-9
            from its last trim: says which, and by how much.
    """

    helicopter: Helicopter
    limits: Limits
    _: KW_ONLY
    dt: float
    manoeuvres: tuple[Manoeuvre, ...]
    _grid: TrimGrid = field(repr=False)
    _by_ends: dict[tuple[Key, Key], Manoeuvre] = field(repr=False)

    def __init__(
        self,
        helicopter: Helicopter,
        limits: Limits,
        *,
        speeds: ArrayLike,
        turns: ArrayLike,
        climbs: Sequence[ArrayLike],
        manoeuvres: Iterable[Given] = (),
        dt: float = DT,
    ) -> None:
        grid = TrimGrid(helicopter, limits, speeds=speeds, turns=turns, climbs=climbs)
        object.__setattr__(self, "helicopter", helicopter)
        object.__setattr__(self, "limits", limits)
        object.__setattr__(self, "dt", positive("dt", dt))
        object.__setattr__(self, "_grid", grid)
        object.__setattr__(self, "_by_ends", {})
        for first, last, controls in manoeuvres:
            self._fly(first, last, controls)
        object.__setattr__(self, "manoeuvres", tuple(self._by_ends.values()))

    @classmethod
    def load(
        cls,
        path: str | Path | None = None,
        *,
        helicopter: Helicopter | None = None,
        limits: Limits | None = None,
    ) -> PrimitiveLibrary:
        """Read a library from its file.

        Args:
            path: the file; None: the one that comes with the package.
            helicopter: what the library must be made for; None: whatever it is made for.
            limits: the limits that it must be made for; None: whatever it is made for.

        Raises:
            FileError: no such file, another version, damaged or missing arrays, manoeuvres that
                miss their last trim, or a library for another helicopter or other limits.
        """
        path = SHIPPED if path is None else Path(path)
        made = read_library(path)
        _same(path, made.helicopter, helicopter)
        _same(path, made.limits, limits)
        try:
            return cls(
                made.helicopter,
                made.limits,
                speeds=made.speeds,
                turns=made.turns,
                climbs=made.climbs,
                manoeuvres=made.manoeuvres,
                dt=made.dt,
            )
        except ArgumentError as error:
            raise FileError(path, str(error), REMEDY) from None

    @property
    def speeds(self) -> FloatArray:
        """Speeds of the trims [m/s], shape (k,)."""
        return self._grid.speeds

    @property
    def turns(self) -> FloatArray:
        """Turn rates by speed [rad/s], (hard right, gentle right, gentle left, hard left)."""
        return self._grid.turns

    @property
    def climbs(self) -> tuple[FloatArray, ...]:
        """Climb rates by speed, other than 0 [m/s]."""
        return self._grid.climbs

    @property
    def trims(self) -> tuple[Trim, ...]:
        """The trims within the limits, by speed, climb and turn rate."""
        return self._grid.trims

    def trim(self, speed: float, climb: float = 0.0, turn: float = 0.0) -> Trim:
        """The trim of a speed and climb [m/s] and turn rate [rad/s].

        Raises:
            ArgumentError: no such trim; names those that exist.
        """
        return self._grid.trim(speed, climb, turn)

    def manoeuvre(self, first: Trim, last: Trim) -> Manoeuvre:
        """The manoeuvre that leads from one trim to another.

        Raises:
            ArgumentError: no such manoeuvre; names those that exist.
        """
        found = self._by_ends.get((first.key, last.key))
        if found is not None:
            return found
        ends = [str(b) for a, b in self._by_ends if a == first.key]
        if not ends:
            starts = ", ".join(dict.fromkeys(str(a) for a, _ in self._by_ends)) or "there is none"
            raise ArgumentError(
                "first", tuple(first.key), f"a trim in which a manoeuvre begins: {starts}"
            )
        allowed = f"a trim to which a manoeuvre leads from {first.key}: {', '.join(ends)}"
        raise ArgumentError("last", tuple(last.key), allowed)

    def summary(self) -> str:
        """Trims and manoeuvres as a table for people, in degrees."""
        return table(self.trims, self.manoeuvres)

    def _fly(self, first: ArrayLike, last: ArrayLike, controls: ArrayLike) -> None:
        """Add a manoeuvre and, if it turns, its mirror image."""
        a, b = self._at("first key", first), self._at("last key", last)
        self._add(a, b, controls)
        if a.turn or b.turn:
            a, b = (self.trim(t.speed, t.climb, -t.turn) for t in (a, b))
            self._add(a, b, mirrored_controls(controls))

    def _at(self, name: str, key: ArrayLike) -> Trim:
        name = f"{name} of manoeuvre {len(self._by_ends)}"
        return self.trim(*readonly(name, key, (3,), "(3,): speed, climb, turn").tolist())

    def _add(self, first: Trim, last: Trim, controls: ArrayLike) -> None:
        number = len(self._by_ends)
        name = f"manoeuvre {number}, {first.key} to {last.key}"
        if (first.key, last.key) in self._by_ends:
            raise ArgumentError("manoeuvres", name, "given once, and not to the right as well")
        made = replay(self.helicopter, first, last, controls, number=number, dt=self.dt)
        if not made.miss <= TOLERANCE:
            allowed = f"within {TOLERANCE:g} of its last trim in v, omega and the quaternion"
            raise ArgumentError(f"end of {name}", made.miss, allowed)
        broken = made.broken_limit(self.helicopter, self.limits)
        if broken is not None:
            where = f"{broken.name} at step {broken.step} of {name}"
            raise ArgumentError(where, broken.value, broken.range)
        self._by_ends[first.key, last.key] = made


@cache
def default_library() -> PrimitiveLibrary:
    """The library that comes with the package, for the default helicopter; read once."""
    return PrimitiveLibrary.load()


def _same(path: Path, made: Helicopter | Limits, asked: Helicopter | Limits | None) -> None:
    if asked is not None and made != asked:
        raise FileError(path, f"is made for {made}", f"asked for is {asked}; {REMEDY}")
