"""The legend of views of flights."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ompl_risk.report.flight_scene import Scene
from ompl_risk.report.style import FAINT, INK, SIZES, colour, dashes
from ompl_risk.report.text_size import text_width
from ompl_risk.trajectory import Trajectory

ROW, NOTE = 0.26, 0.21
"""Height of a row, and of one in small type [inch]."""
SWATCH, TEXT = 0.55, 0.7
"""Length of a sample of a line, and where the text beside it begins [inch]."""
PAD = 0.2
"""Around the legend and between its blocks [inch]."""


@dataclass(frozen=True)
class Shown:
    """A flight that has a view.

    Args:
        index: of its colour and dashes.
        label: its name, short.
        trajectory: the flight.
    """

    index: int
    label: str
    trajectory: Trajectory


@dataclass(frozen=True)
class _Block:
    """A part of the legend: its size [inch], and how to draw it from its upper left corner."""

    width: float
    height: float
    draw: Callable[[Axes, float, float], None]


@dataclass(frozen=True)
class ViewLegend:
    """The flights' lines, durations and lengths, what other signs mean, and what is not to scale.

    Args:
        blocks: stand side by side where there is room, else one below the other.
    """

    blocks: Sequence[_Block]

    def height(self, width: float) -> float:
        """Height [inch] that it needs within a width [inch]."""
        return 2.0 * PAD + max(_height(column) for column in self._columns(width))

    def draw(self, axes: Axes, width: float, height: float) -> None:
        """Draw it into axes of a size [inch], from their upper left corner."""
        axes.set_axis_off()
        axes.set_xlim(0.0, width)
        axes.set_ylim(0.0, height)
        x = PAD
        for column in self._columns(width):
            y = height - PAD
            for block in column:
                block.draw(axes, x, y)
                y -= block.height + PAD
            x += max(block.width for block in column) + 3.0 * PAD

    def _columns(self, width: float) -> list[Sequence[_Block]]:
        """Blocks by column: as many columns as there is room for."""
        first, *rest = self.blocks
        for columns in ([[block] for block in self.blocks], [[first], rest]):
            wide = [max(block.width for block in column) for column in columns]
            if sum(wide) + 3.0 * PAD * (len(wide) - 1) + 2.0 * PAD <= width:
                return list(columns)
        return [self.blocks]


def view_legend(scene: Scene, flights: Sequence[Shown], poses: int) -> ViewLegend:
    """The legend of flights that have a view, with so many helicopters in each."""
    return ViewLegend([_entries(flights), _signs(), _notes(scene, flights, poses)])


def _height(column: Sequence[_Block]) -> float:
    return sum(block.height for block in column) + PAD * (len(column) - 1)


def _entries(flights: Sequence[Shown]) -> _Block:
    rows = [
        (f.label, f"{f.trajectory.duration:.1f} s", f"{1e-3 * f.trajectory.length:.2f} km")
        for f in flights
    ]
    size = SIZES["text"]
    wide = [max(text_width(row[k], size, bold=k == 0) for row in rows) for k in range(3)]
    names, durations = TEXT + wide[0], TEXT + wide[0] + PAD + wide[1]
    width = max(durations, names) + PAD + wide[2]

    def draw(axes: Axes, x: float, y: float) -> None:
        for k, (flight, (label, duration, length)) in enumerate(zip(flights, rows, strict=True)):
            line = y - (k + 0.5) * ROW
            _sample(
                axes, x, line, color=colour(flight.index), linestyle=dashes(flight.index),
                linewidth=3.0,
            )  # fmt: skip
            _text(axes, x + TEXT, line, label, fontweight="bold")
            _text(axes, x + durations, line, duration, ha="right")
            _text(axes, x + width, line, length, ha="right")

    return _Block(width, ROW * len(rows), draw)


def _signs() -> _Block:
    hidden, below, ends = "hidden behind a hill", "ground below the flight", ("start", "goal")
    width = TEXT + text_width(below, SIZES["text"])

    def draw(axes: Axes, x: float, y: float) -> None:
        rows = [y - (k + 0.5) * ROW for k in range(3)]
        _sample(axes, x, rows[0], color=FAINT, linewidth=1.6, linestyle=(0, (1, 2)))
        _text(axes, x + TEXT, rows[0], hidden)
        _sample(axes, x, rows[1], color=INK, linewidth=0.9, alpha=0.6)
        _text(axes, x + TEXT, rows[1], below)
        for name, mark, size, left in zip(ends, "o*", (9, 15), (0.0, 1.2), strict=True):
            axes.plot(
                x + 0.5 * SWATCH + left, rows[2], mark, markersize=size, color=INK,
                markeredgecolor="white",
            )  # fmt: skip
            _text(axes, x + left + (TEXT if left == 0.0 else TEXT - 0.2), rows[2], name)

    return _Block(width, 3.0 * ROW, draw)


def _notes(scene: Scene, flights: Sequence[Shown], poses: int) -> _Block:
    (west, south, _), (east, north, _) = scene.box
    between = np.mean([flight.trajectory.duration for flight in flights]) / poses
    notes = [
        f"helicopters: {scene.scale:g} times their size, every {between:.3g} s",
        f"ground: {1e-3 * (east - west):.3g} km from west to east, "
        f"{1e-3 * (north - south):.3g} km from south to north",
        f"heights: drawn {scene.exaggeration:g} times; attitudes are true",
    ]
    size = SIZES["small"]

    def draw(axes: Axes, x: float, y: float) -> None:
        for k, note in enumerate(notes):
            _text(axes, x, y - (k + 0.5) * NOTE, note, fontsize=size, color=FAINT)

    return _Block(max(text_width(note, size) for note in notes), NOTE * len(notes), draw)


def _sample(axes: Axes, x: float, y: float, **style: Any) -> None:
    axes.plot([x, x + SWATCH], [y, y], **style)


def _text(axes: Axes, x: float, y: float, text: str, **style: Any) -> None:
    axes.text(x, y, text, **{"va": "center", "fontsize": SIZES["text"], "color": INK, **style})
