"""How figures look: colours that colour-blind readers can tell apart, sizes, canvas."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ompl_risk.errors import FileError

COLOURS = ("#0072B2", "#009E73", "#E69F00", "#D55E00", "#CC79A7", "#56B4E9", "#000000")
"""Okabe and Ito's palette without its yellow, which is lost on white."""
DASHES = ("solid", (0, (5, 1.5)), (0, (6, 1.5, 1.5, 1.5)))
"""Line styles of the first seven lines, the next seven, and so on."""
SAFEST, RISKIEST = "#CFE3F5", "#FBD9C2"
"""Backgrounds of the least and the greatest number of a column: blue and orange, which also those
tell apart who see no difference of red and green."""
INK, FAINT = "#222222", "#777777"
SIZES = {"title": 14.0, "text": 11.0, "small": 9.5}
"""Sizes of type [pt]; at 100 dots per inch the small one is 13 pixels high."""
DPI = 100


def colour(index: int) -> str:
    """The colour of the line of that index."""
    return COLOURS[index % len(COLOURS)]


def dashes(index: int) -> object:
    """The dashes of the line of that index."""
    return DASHES[index // len(COLOURS) % len(DASHES)]


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch] with a canvas of its own, so that no global state is touched."""
    figure = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure; the suffix says how (.png, .pdf, .svg).

    Raises:
        FileError: the file cannot be written, or the suffix is unknown.
    """
    try:
        figure.savefig(path)
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except ValueError:
        formats = ", ".join(f".{name}" for name in figure.canvas.get_supported_filetypes())
        raise FileError(path, "is no kind of picture", f"the suffix may be {formats}") from None


def short(names: Sequence[str], longest: int = 14) -> list[str]:
    """Names cut in the middle so that they fit into tables."""
    half = (longest - 1) // 2
    return [n if len(n) <= longest else f"{n[:half]}…{n[-half:]}" for n in names]
