"""How much room text takes, before there is a figure to draw it in."""

from __future__ import annotations

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

POINTS_PER_INCH = 72.0


def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """Width of a line of text [inch].

    Args:
        text: without formulas.
        size: of the type [pt].
        bold: whether it is bold.
    """
    if not text.strip():
        return 0.0  # it has no outline
    font = FontProperties(weight="bold" if bold else "normal")
    return float(TextPath((0.0, 0.0), text, size, prop=font).get_extents().x1) / POINTS_PER_INCH
