"""The view from the camera behind a flying vehicle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patheffects import withStroke

from ompl_risk._arrays import FloatArray
from ompl_risk.report.attitudes import heading_and_bank
from ompl_risk.report.camera import Camera, ground_below
from ompl_risk.report.chase import Chase
from ompl_risk.report.faces import Faces, draw_faces
from ompl_risk.report.flight_lines import draw_flight
from ompl_risk.report.ground import Paint, around
from ompl_risk.report.helicopter_glyph import LENGTH, ROTOR, draw_helicopter
from ompl_risk.report.style import INK, SIZES
from ompl_risk.trajectory import Trajectory

SKY = np.array([0.87, 0.92, 0.97])
HAZE = 14.0, 6000.0
"""Ground fades into the sky within so many times the camera's distance, or within this [m]."""
VIEW = 0.62
"""Half the width of the picture at depth 1."""
GLYPH = 0.3
"""Length of the helicopter, as a part of the camera's distance."""
CELL = 1.0 / 14.0
"""Smallest cells of the ground, as a part of the camera's distance."""
REACH = 25.0, 3000.0
"""The path is drawn as far as so many times the camera's distance, or as this [m]."""
SHADE = (0.1, 0.1, 0.12, 0.35)
BLADE_STEP = 0.9
"""Turn of the rotor from frame to frame [rad]."""


class ChaseView:
    """Draws frame after frame into the same axes.

    Args:
        axes: of fixed size; limits and background are set.
        chase: the flight and its cameras.
        whole: the flight in short steps, also before and after the frames.
        colour: of helicopter and flight.

    Attributes:
        scale: how many times its size the helicopter is drawn.
    """

    def __init__(self, axes: Axes, chase: Chase, whole: Trajectory, colour: str) -> None:
        self._axes, self._chase, self._whole, self._colour = axes, chase, whole, colour
        self.scale = _round(max(GLYPH * chase.distance / LENGTH, 1.0))
        self._paint = Paint(chase.terrain)
        self._drawn: list[Artist] = []
        box = axes.get_window_extent()
        high = VIEW * box.height / box.width
        axes.set_xlim(-VIEW, VIEW)
        axes.set_ylim(-high, high)
        axes.set_facecolor(tuple(SKY))
        axes.set_xticks([])
        axes.set_yticks([])
        axes.spines[:].set_visible(False)
        stroke = [withStroke(linewidth=3, foreground="white", alpha=0.7)]
        self._text = axes.text(
            0.025, 0.965, "", transform=axes.transAxes, va="top", fontsize=SIZES["text"],
            color=INK, zorder=40.0, linespacing=1.5,
            path_effects=stroke,
        )  # fmt: skip

        axes.text(
            0.025, 0.025, f"helicopter drawn {self.scale:g} times its size", color=INK,
            transform=axes.transAxes, fontsize=SIZES["small"], zorder=40.0, path_effects=stroke,
        )  # fmt: skip

    def draw(self, frame: int, distance: float, nearest: FloatArray | None = None) -> None:
        """Show a frame in place of the one before.

        Args:
            frame: its number.
            distance: to obstacles [m].
            nearest: the nearest obstacle's point [m], shape (3,), to which a line is drawn.
        """
        for artist in self._drawn:
            artist.remove()
        chase, axes = self._chase, self._axes
        flight, camera = chase.flight, chase.cameras[frame]
        position, orientation = flight.positions[frame], flight.poses[frame, 3:]
        self._drawn = [self._ground(camera, position), self._shadow(camera, position)]
        self._drawn += self._path(camera, float(flight.t[frame]))
        if nearest is not None:
            self._drawn.append(self._distance(camera, position, nearest))
        self._drawn += draw_helicopter(
            axes, camera, position, orientation, self._colour, scale=self.scale,
            blade=BLADE_STEP * frame, zorder=20.0,
        )  # fmt: skip
        self._text.set_text(self._words(frame, distance))

    def _ground(self, camera: Camera, position: FloatArray) -> Artist:
        cell = CELL * self._chase.distance
        faces = around(self._chase.terrain, self._paint, position, cell)
        faces = _within(faces, camera, self._axes)
        _, depth = camera.project(faces.centres)
        haze = max(HAZE[0] * self._chase.distance, HAZE[1])
        clear = np.exp(-np.maximum(depth, 0.0) / haze)[:, None]
        faces.colours[:, :3] = SKY + clear * (faces.colours[:, :3] - SKY)
        return draw_faces(self._axes, camera, faces, zorder=1.0, seam=0.7)

    def _shadow(self, camera: Camera, position: FloatArray) -> Artist:
        """The rotor's shadow at noon, on the ground right below."""
        angles = 2.0 * np.pi * np.arange(24) / 24
        size = 0.6 * ROTOR * self.scale
        ring = position + size * np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
        ring[:, 2] = ground_below(self._chase.terrain, ring) + 0.2
        places, depth = camera.project(ring)
        middle = ring.mean(axis=0)[None]
        seen = (depth > 0.0).all() and camera.sees(middle, self._chase.terrain)[0]
        shade = PolyCollection(
            [places] if seen else [], facecolors=[SHADE], edgecolors="none", zorder=2.0
        )
        self._axes.add_collection(shade, autolim=False)
        return shade

    def _path(self, camera: Camera, now: float) -> list[Artist]:
        """The path flown so far, and thinner the one ahead, as far as they can be made out."""
        t, curve = self._whole.t, self._whole.positions
        reach = max(REACH[0] * self._chase.distance, REACH[1])
        near = np.linalg.norm(curve - camera.position, axis=1) < reach
        drawn: list[Artist] = []
        for chosen, width in ((near & (t <= now), 2.2), (near & (t >= now), 1.1)):
            i = np.flatnonzero(chosen)
            for run in np.split(i, np.flatnonzero(np.diff(i) > 1) + 1):
                drawn += draw_flight(
                    self._axes, camera, self._chase.terrain, curve[run], self._colour,
                    width=width, casing=False, opacity=0.9,
                )  # fmt: skip
        return drawn

    def _distance(self, camera: Camera, position: FloatArray, nearest: FloatArray) -> Artist:
        places, _ = camera.project(np.stack([position, nearest]))
        style: dict[str, Any] = {"color": INK, "linewidth": 1.2, "linestyle": (0, (3, 2))}
        (line,) = self._axes.plot(*places.T, marker=".", markevery=[1], zorder=5.0, **style)
        return line

    def _words(self, frame: int, distance: float) -> str:
        flight = self._chase.flight
        speed = float(np.linalg.norm(np.asarray(flight.velocities)[frame]))
        heading, bank = heading_and_bank(flight.poses[frame, 3:])
        side = "right" if bank > 0.0 else "left"
        return (
            f"{flight.name}   t = {flight.t[frame]:.1f} s\nd = {distance:.0f} m\n{speed:.1f} m/s\n"
            f"heading {heading:03.0f}°\nbank {abs(bank):.0f}° {side if abs(bank) >= 0.5 else ''}"
        )


def _within(faces: Faces, camera: Camera, axes: Axes) -> Faces:
    """The faces, of four corners each, that may be in the picture."""
    places, depth = camera.project(faces.corners)
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    x, y = places.reshape(-1, 4, 2).transpose(2, 0, 1)
    ahead = (depth.reshape(-1, 4) > 0.0).all(axis=1)
    with np.errstate(invalid="ignore"):
        shown = ahead & (x.max(axis=1) > x0) & (x.min(axis=1) < x1)
        shown &= (y.max(axis=1) > y0) & (y.min(axis=1) < y1)
    corners = faces.corners.reshape(-1, 4, 3)[shown]
    return Faces.quads(corners, faces.colours[shown, :3])


def _round(value: float) -> float:
    """To one digit."""
    step = 10.0 ** math.floor(math.log10(value))
    return round(value / step) * step
