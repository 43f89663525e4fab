"""One file for each numbered piece of work that is done, kept whatever happens to the rest."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from ompl_risk.errors import ArgumentError

TOLD = 3
"""Differences between two procedures; the others are counted."""

Known = TypeVar("Known")
Say = Callable[[str], object]


@dataclass(frozen=True)
class Pieces:
    """Where pieces of work of one kind are kept in a folder.

    Attributes:
        thing: what a piece is called; its plural is the name of the folder within.
        holds: what its file is called in messages, such as "record".
        digits: of its number in the file's name.
        suffix: of the file's name.
    """

    thing: str
    holds: str
    digits: int
    suffix: str

    def path(self, folder: Path, number: int) -> Path:
        """The file of a piece."""
        return folder / f"{self.thing}s" / f"{number:0{self.digits}d}{self.suffix}"

    def keep(self, folder: Path, number: int, content: bytes) -> None:
        """Write a piece's file in one go: a reader never sees half of one."""
        path = self.path(folder, number)
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_suffix(".part")
        with draft.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)

    def kept(
        self,
        folder: Path,
        read: Callable[[Path, int], Known],
        differences: Callable[[Known], Iterable[str]],
        *,
        count: int | None = None,
        say: Say = lambda _message: None,
    ) -> Iterator[tuple[int, Known]]:
        """Numbers and contents of the pieces that are there, in order.

        Args:
            folder: where.
            read: read(folder, number) reads a piece's file; it raises OSError or ValueError if that
                is not what it should be.
            differences: between what made a piece and what would make it here.
            count: how many pieces are of interest, the first ones; all if left out.
            say: called with a message for each file that is not what it should be; its piece counts
                as not done.

        Raises:
            ArgumentError: a piece of another seed or procedure. It is neither counted with the
                others nor written over.
        """
        for number in self._numbers(folder, count):
            try:
                known = read(folder, number)
            except (OSError, ValueError) as error:
                what = f"{self.path(folder, number)} is no {self.holds} of {self.thing} {number}"
                say(f"{what} ({error}): the {self.thing} counts as not done")
                continue
            if what := list(differences(known)):
                self._refuse(folder, number, what)
            yield number, known

    def _numbers(self, folder: Path, count: int | None) -> list[int]:
        """Of the pieces that have a file, in order."""
        paths = set((folder / f"{self.thing}s").glob(f"*{self.suffix}"))
        found = {int(path.stem) for path in paths if path.stem.isdecimal()}
        ours = found.intersection(range(count)) if count is not None else found
        return sorted(number for number in ours if self.path(folder, number) in paths)

    def _refuse(self, folder: Path, number: int, what: list[str]) -> None:
        more = f" and {len(what) - TOLD} more" if len(what) > TOLD else ""
        some = f"{self.path(folder, number).name}: {' and '.join(what[:TOLD])}{more}"
        allowed = f"another folder, as this one holds {self.thing}s of another seed or procedure"
        raise ArgumentError("output", str(folder), f"{allowed} ({some})")
