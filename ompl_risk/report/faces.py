"""Coloured faces in space, and how a camera draws them: from the farthest to the nearest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.report.camera import Camera

SUN = np.array([-1.0, 1.0, 2.0**0.5]) / 2.0
"""Towards the sun: in the north-west, 45 degrees high, as for hillshades."""


@dataclass(frozen=True, eq=False)
class Faces:
    """Flat faces with any number of corners.

    Args:
        corners: of all faces, one after the other [m], shape (c, 3).
        ends: where each face ends among the corners, shape (f,).
        colours: red, green, blue, alpha, each 0 to 1, shape (f, 4).
    """

    corners: FloatArray
    ends: NDArray[np.int64]
    colours: FloatArray

    @classmethod
    def of(cls, faces: Sequence[FloatArray], colours: FloatArray) -> Faces:
        """Faces given one by one, each of shape (corners, 3)."""
        return cls(np.concatenate(faces), np.cumsum([len(face) for face in faces]), colours)

    @classmethod
    def quads(cls, corners: FloatArray, colours: FloatArray) -> Faces:
        """Faces of four corners each, shape (f, 4, 3), in opaque colours, shape (f, 3)."""
        alpha = np.ones((len(colours), 1))
        ends = 4 * np.arange(1, len(corners) + 1)
        return cls(corners.reshape(-1, 3), ends, np.concatenate([colours, alpha], axis=1))

    def __len__(self) -> int:
        return len(self.ends)

    @property
    def starts(self) -> NDArray[np.int64]:
        """Where each face begins among the corners, shape (f,)."""
        return np.concatenate([[0], self.ends[:-1]])

    @property
    def centres(self) -> FloatArray:
        """Means of the corners [m], shape (f, 3)."""
        count = np.diff(self.ends, prepend=0)
        return np.add.reduceat(self.corners, self.starts) / count[:, None]


def draw_faces(
    axes: Axes, camera: Camera, faces: Faces, *, zorder: float = 1.0, seam: float = 0.5
) -> PolyCollection:
    """Draw faces in order of their centres' depth; those behind the camera are left out.

    Args:
        axes: whose data coordinates are the picture's.
        camera: where it is seen from.
        faces: what is seen.
        zorder: of the whole.
        seam: width of an edge in the face's own colour [pt], which closes gaps between faces.
    """
    flat, depth = camera.project(faces.corners)
    nearest = np.minimum.reduceat(depth, faces.starts)
    _, far = camera.project(faces.centres)
    order = np.argsort(-far, kind="stable")
    order = order[nearest[order] > 0.0]
    shown = PolyCollection(
        _picked(flat, faces, order),
        facecolors=faces.colours[order],
        edgecolors=faces.colours[order] if seam else "none",
        linewidths=seam,
        zorder=zorder,
    )
    axes.add_collection(shown, autolim=False)
    return shown


def _picked(flat: FloatArray, faces: Faces, order: NDArray[np.int64]) -> Any:
    """The places of the corners of some faces; one array if all have as many, which is quicker."""
    starts = faces.starts
    count = np.unique(faces.ends - starts)
    if len(count) == 1:
        return flat.reshape(len(faces), int(count[0]), 2)[order]
    return [flat[starts[i] : faces.ends[i]] for i in order]
