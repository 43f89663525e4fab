"""Films as files: GIF by Pillow, MP4 by the program ffmpeg."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from ompl_risk.errors import FileError
from ompl_risk.report.style import DPI

if TYPE_CHECKING:
    from ompl_risk.report.flight_film import Film

Progress = Callable[[int, int], object]
COLOURS = 128
"""Colours of a GIF, the same in all its pictures: what has not moved then takes no room."""
SAMPLED = 6
"""Pictures that the colours are chosen from."""
BITRATE = 2500
"""Of an MP4 [kbit/s]."""


def check_film_path(path: Path) -> None:
    """Refuse what could not be written, before the work begins.

    Raises:
        FileError: another suffix than .gif and .mp4, an .mp4 without ffmpeg, or no such folder.
    """
    suffix = path.suffix.lower()
    if suffix not in (".gif", ".mp4"):
        raise FileError(path, "is no kind of film", "the suffix may be .gif or .mp4")
    if not path.parent.is_dir():
        raise FileError(path, "No such file or directory", "its folder must exist")
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise FileError(
            path, "MP4 needs the program ffmpeg, which is not found", "install it, or write a .gif"
        )


def write_film(film: Film, path: Path, seconds: float, progress: Progress | None) -> None:
    """Write a film that `check_film_path` has let pass.

    Args:
        film: what is shown.
        path: the file.
        seconds: how long it takes.
        progress: called with the pictures done and their number after each.

    Raises:
        FileError: the file cannot be written.
    """
    write = _write_gif if path.suffix.lower() == ".gif" else _write_mp4
    try:
        write(film, path, seconds, progress)
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except subprocess.CalledProcessError as error:
        raise FileError(path, f"ffmpeg ended with code {error.returncode}") from None


def _write_gif(film: Film, path: Path, seconds: float, progress: Progress | None) -> None:
    palette = _palette(film)
    ends = np.round(np.linspace(0.0, 100.0 * seconds, film.frames + 1))  # GIF counts hundredths

    def pictures() -> Iterator[Image.Image]:
        for picture in _frames(film, progress):
            yield _picture(picture).quantize(palette=palette, dither=Image.Dither.NONE)

    rest = pictures()
    next(rest).save(
        path, format="GIF", save_all=True, append_images=rest, loop=0,
        duration=(10.0 * np.diff(ends)).astype(int).tolist(),
    )  # fmt: skip


def _write_mp4(film: Film, path: Path, seconds: float, progress: Progress | None) -> None:
    writer = FFMpegWriter(fps=film.frames / seconds, bitrate=BITRATE)  # type: ignore[arg-type]
    with writer.saving(film.figure, str(path), DPI):
        for _ in _frames(film, progress):
            writer.grab_frame()


def _frames(film: Film, progress: Progress | None) -> Iterator[Figure]:
    """The film's figure, frame after frame."""
    for frame in range(film.frames):
        film.draw(frame)
        yield film.figure
        if progress is not None:
            progress(frame + 1, film.frames)


def _palette(film: Film) -> Image.Image:
    """A picture of the colours to use, chosen from some frames."""
    chosen = np.unique(np.linspace(0, film.frames - 1, SAMPLED).round().astype(int))
    samples = []
    for frame in chosen.tolist():
        film.draw(frame)
        samples.append(np.asarray(_picture(film.figure)))
    together = Image.fromarray(np.concatenate(samples))
    palette = together.quantize(COLOURS, method=Image.Quantize.MEDIANCUT)
    colours = np.reshape(palette.getpalette() or [], (-1, 3))
    colours[colours.min(axis=1) > 247] = 255  # paper stays white
    palette.putpalette(colours.ravel().tolist())
    return palette


def _picture(figure: Figure) -> Image.Image:
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        raise TypeError(type(canvas).__name__)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])
