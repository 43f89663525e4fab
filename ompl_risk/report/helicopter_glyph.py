"""A small helicopter for pictures: fuselage, rotors, tail boom, fins and skids."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from ompl_risk._arrays import FloatArray
from ompl_risk.report.camera import Camera
from ompl_risk.report.faces import SUN, Faces, draw_faces

ROTOR = 0.775
"""Radius of the main rotor [m]; this and the hub and tail below are those of an X-Cell 60."""
HUB = (0.0, 0.0, 0.235)
TAIL = (-0.91, 0.0, 0.04)
LENGTH = ROTOR - TAIL[0] + 0.14
"""From the front of the main rotor to the end of the tail rotor [m]."""

_STATIONS = (  # of the fuselage: x, height of the middle, half width, half height
    (0.46, -0.06, 0.01, 0.01),
    (0.38, -0.05, 0.10, 0.09),
    (0.22, -0.02, 0.15, 0.15),
    (0.00, 0.01, 0.15, 0.17),
    (-0.20, 0.02, 0.09, 0.11),
    (-0.34, 0.03, 0.035, 0.045),
)
_PLATES = (  # fin, lower fin, tailplane
    ((-0.84, 0.0, 0.05), (-0.99, 0.0, 0.05), (-1.05, 0.0, 0.27), (-0.97, 0.0, 0.27)),
    ((-0.84, 0.0, 0.03), (-0.93, 0.0, 0.03), (-0.98, 0.0, -0.10), (-0.93, 0.0, -0.10)),
    ((-0.60, 0.22, 0.04), (-0.70, 0.22, 0.04), (-0.70, -0.22, 0.04), (-0.60, -0.22, 0.04)),
)
_GLASS = (0.16, 0.22, 0.30, 1.0)
_METAL = (0.25, 0.25, 0.27, 1.0)
_DISC = (0.13, 0.13, 0.15, 0.32)
_BLADE = (0.10, 0.10, 0.11, 1.0)
_SIDES = 12


def draw_helicopter(
    axes: Axes,
    camera: Camera,
    position: ArrayLike,
    orientation: ArrayLike,
    colour: str,
    *,
    scale: float = 1.0,
    blade: float = 0.6,
    opacity: float = 1.0,
    zorder: float = 10.0,
) -> tuple[PolyCollection, PolyCollection]:
    """Draw a helicopter, in its true shape and attitude even where heights are exaggerated.

    Args:
        axes: whose data coordinates are the picture's.
        camera: where it is seen from.
        position: of its centre of gravity [m], shape (3,).
        orientation: quaternion (x, y, z, w) from body (forward, left, up) to world.
        colour: of its fuselage.
        scale: how many times its size it is drawn.
        blade: angle of the rotor blades [rad].
        opacity: 1, or less where it is hidden.
        zorder: of the whole.

    Returns:
        Its body and its main rotor.
    """
    body, rotor = helicopter_faces(
        position, orientation, colour, scale=scale, exaggeration=camera.exaggeration, blade=blade
    )
    for part in (body, rotor):
        part.colours[:, 3] *= opacity
    # The plane of the rotor has the body on one side: no depths of faces need be compared.
    upwards = Rotation.from_quat(orientation).apply([0.0, 0.0, 1.0])
    towards = (camera.position - rotor.centres[0]) * camera.stretch
    above = 0.1 if towards @ upwards > 0.0 else -0.1
    return (
        draw_faces(axes, camera, body, zorder=zorder, seam=0.3),
        draw_faces(axes, camera, rotor, zorder=zorder + above, seam=0.3),
    )


def helicopter_faces(
    position: ArrayLike,
    orientation: ArrayLike,
    colour: str,
    *,
    scale: float = 1.0,
    exaggeration: float = 1.0,
    blade: float = 0.6,
) -> tuple[Faces, Faces]:
    """The body and the main rotor of a helicopter in the world.

        corner = position + diag(1, 1, 1 / exaggeration) scale R corner_body

    Args:
        position: of its centre of gravity [m], shape (3,).
        orientation: quaternion (x, y, z, w) from body (forward, left, up) to world.
        colour: of its fuselage.
        scale: how many times its size it is drawn.
        exaggeration: factor on the heights of the picture.
        blade: angle of the rotor blades [rad].
    """
    stretch = np.array([1.0, 1.0, 1.0 / exaggeration])
    turn = Rotation.from_quat(orientation).as_matrix()
    placed: list[Faces] = []
    for part in (_body(to_rgb(colour)), _rotor(blade)):
        turned = part.corners @ turn.T
        corners = np.asarray(position, dtype=np.float64) + scale * stretch * turned
        placed.append(Faces(corners, part.ends, _lit(turned, part)))
    return placed[0], placed[1]


def _lit(corners: FloatArray, part: Faces) -> FloatArray:
    """Colours under the sun; what is translucent has no shade."""
    a, b, c = (corners[part.starts + k] for k in range(3))
    normal = np.cross(b - a, c - b)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    bright = np.where(part.colours[:, 3] < 1.0, 1.0, 0.88 + 0.34 * normal @ SUN)
    lit = part.colours.copy()
    lit[:, :3] = np.clip(lit[:, :3] * bright[:, None], 0.0, 1.0)
    return lit


@cache
def _body(colour: tuple[float, float, float]) -> Faces:
    """All but the main rotor, in the helicopter's own frame [m]."""
    paint = (*colour, 1.0)
    parts = [(face, _GLASS if _is_window(k, face) else paint) for k, face in _hull()]
    parts += [(face, paint) for face in _prism((-0.3, 0.0, 0.035), TAIL, 0.032)]
    parts += [(np.array(plate), paint) for plate in _PLATES]
    parts += [(face, _METAL) for face in _skids()]
    parts += [(face, _METAL) for face in _prism((0.0, 0.0, 0.15), HUB, 0.022)]
    parts.append((_disc(TAIL, 0.14, across=1), _DISC))
    return Faces.of([face for face, _ in parts], np.array([paint for _, paint in parts]))


def _rotor(blade: float) -> Faces:
    """The main rotor: its disc and two blades."""
    along = ROTOR * np.array([np.cos(blade), np.sin(blade), 0.0])
    across = 0.032 * np.array([-np.sin(blade), np.cos(blade), 0.0])
    blades = np.add(HUB, [along + across, across - along, -along - across, along - across])
    return Faces.of([_disc(HUB, ROTOR, across=2), blades], np.array([_DISC, _BLADE]))


def _is_window(section: int, face: FloatArray) -> bool:
    return section == 1 and face[:, 2].mean() > -0.06


def _hull() -> list[tuple[int, FloatArray]]:
    """Faces of the fuselage, normals outwards, with the number of their section."""
    angles = 2.0 * np.pi * np.arange(_SIDES + 1) / _SIDES
    rings = [
        np.stack([np.full(_SIDES + 1, x), w * np.sin(angles), z + h * np.cos(angles)], axis=1)
        for x, z, w, h in _STATIONS
    ]
    return [
        (k, np.array([fore[i], fore[i + 1], aft[i + 1], aft[i]]))
        for k, (fore, aft) in enumerate(pairwise(rings))
        for i in range(_SIDES)
    ]


def _skids() -> list[FloatArray]:
    faces: list[FloatArray] = []
    for y in (-0.15, 0.15):
        faces += _prism((0.3, y, -0.27), (-0.26, y, -0.27), 0.014)
        for x in (0.16, -0.12):
            faces += _prism((x, 0.5 * y, -0.1), (x, y, -0.27), 0.012)
    return faces


def _prism(begin: ArrayLike, end: ArrayLike, half: float) -> list[FloatArray]:
    """The four long sides of a bar of square section, normals outwards."""
    begin, end = np.asarray(begin, dtype=np.float64), np.asarray(end, dtype=np.float64)
    axis = (end - begin) / np.linalg.norm(end - begin)
    side = np.cross(axis, [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0])
    side *= half * 2.0**0.5 / np.linalg.norm(side)
    other = np.cross(axis, side)
    ring = [side, other, -side, -other, side]
    return [np.array([begin + a, begin + b, end + b, end + a]) for a, b in pairwise(ring)]


def _disc(centre: tuple[float, float, float], radius: float, *, across: int) -> FloatArray:
    """A disc across one of the axes."""
    angles = 2.0 * np.pi * np.arange(28) / 28
    disc = np.zeros((28, 3))
    disc[:, (across + 1) % 3], disc[:, (across + 2) % 3] = np.cos(angles), np.sin(angles)
    return np.asarray(centre) + radius * disc
