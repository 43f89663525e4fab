"""Where text stands in a figure."""

from itertools import combinations

from matplotlib.text import Text


def boxes(figure, axes=None):
    """Extents of all texts in pixels, with their frames, by text; of one axes or of all."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    texts = [] if axes else list(figure.texts)
    for each in [axes] if axes else figure.axes:
        texts += each.texts
    found = []
    for text in texts:
        if text.get_text() and text.get_visible():
            frame = text.get_bbox_patch()
            box = frame.get_window_extent(renderer) if frame else _letters(text, renderer)
            found.append((text.get_text(), box))
    return found


def _letters(text, renderer):
    """Without the arrow that an annotation's own `get_window_extent` includes."""
    return Text.get_window_extent(text, renderer)


def overlapping(found):
    """Pairs of texts whose boxes overlap."""
    return [(a, b) for (a, one), (b, other) in combinations(found, 2) if one.overlaps(other)]


def outside(found, room):
    """Texts that reach out of a box."""
    return [
        name
        for name, box in found
        if not (room.x0 <= box.x0 and box.x1 <= room.x1 and room.y0 <= box.y0 and box.y1 <= room.y1)
    ]
