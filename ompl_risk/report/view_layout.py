"""Where the views of flights and their legend stand in a figure."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

WIDTH = 16.0
"""Of the figure [inch]."""
HEADING = 0.8
"""Room above what a view shows, for its heading and compass [inch]."""
LOWEST, HIGHEST, SQUARE = 2.6, 5.4, 0.9
"""A row's least and greatest height [inch], and the greatest over the width of a view."""
GAP = 0.12
"""Between views [inch]."""
BESIDE = 5.2
"""Width of a legend beside a single view [inch]."""

Place = tuple[float, float, float, float]
"""Left, bottom, width, height, as parts of the figure."""


@dataclass(frozen=True)
class ViewLayout:
    """Places in a figure.

    Args:
        height: of the figure [inch].
        views: a place for each view, row by row.
        legend: its place.
    """

    height: float
    views: Sequence[Place]
    legend: Place


def even_ranks(count: int, most: int) -> list[int]:
    """The first, the last and those between at even ranks: at most so many of 0 to count - 1."""
    if count <= most:
        return list(range(count))
    return [round(k * (count - 1) / (most - 1)) for k in range(most)]


def view_layout(
    shapes: Sequence[float], legend_height: Callable[[float], float], *, above: float
) -> ViewLayout:
    """Arrange views and legend; rows are as high as what they show.

    One view has the legend beside it; up to four views stand in two columns, more in three. The
    legend fills what the last row leaves free, or else a row of its own.

    Args:
        shapes: height over width of what each view shows, one or more.
        legend_height: height that the legend needs [inch] within a width [inch].
        above: room for the title [inch].
    """
    if len(shapes) == 1:
        widths, columns = [WIDTH - BESIDE, BESIDE], 2
    else:
        columns = 2 if len(shapes) <= 4 else 3
        widths = [WIDTH / columns] * columns
    rows = math.ceil(len(shapes) / columns)
    heights = [
        max(_row_height(s, widths[0]) for s in shapes[k * columns : (k + 1) * columns])
        for k in range(rows)
    ]
    free = rows * columns - len(shapes)
    if free:
        width = sum(widths[-free:])
        heights[-1] = max(heights[-1], legend_height(width - GAP))
    else:
        width = WIDTH
        heights.append(legend_height(width - GAP))
    height = above + sum(heights)
    bottoms = [height - above - sum(heights[: k + 1]) for k in range(len(heights))]

    def place(row: int, left: float, wide: float) -> Place:
        inches = left + 0.5 * GAP, bottoms[row] + 0.5 * GAP, wide - GAP, heights[row] - GAP
        x, y, w, h = inches
        return x / WIDTH, y / height, w / WIDTH, h / height

    views = [
        place(k // columns, sum(widths[: k % columns]), widths[k % columns])
        for k in range(len(shapes))
    ]
    return ViewLayout(height, views, place(len(heights) - 1, WIDTH - width, width))


def _row_height(shape: float, width: float) -> float:
    needed = shape * (width - GAP) + HEADING + GAP
    return min(max(needed, LOWEST), HIGHEST, SQUARE * width)
