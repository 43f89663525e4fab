"""What a flight meets that its plan does not know."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.gusts import DrydenGusts
from ompl_risk.simulation.disturbances.navigation import (
    NavigationError,
    gps_position,
    small_ahrs,
    small_velocity,
)
from ompl_risk.simulation.disturbances.terrain_error import SRTM, SRTM_NORTH_AMERICA, TerrainError

KNOT = 1852.0 / 3600.0
"""[m/s]"""

LEVELS = ("calm", "moderate", "severe")
"""What ``Disturbances.level`` knows."""


@dataclass(frozen=True)
class Disturbances:
    """Gusts, navigation error and terrain error, each with its own switch.

    Args:
        gusts: None: still air.
        navigation: None: the vehicle knows its state.
        terrain: None: the map is right.

    Raises:
        ArgumentError: something of another kind.

    Example:
        >>> Disturbances.level("moderate").terrain.deviation.__round__(2)
        9.73
        >>> Disturbances(gusts=DrydenGusts(10.0)).navigation is None
        True
    """

    gusts: DrydenGusts | None = None
    navigation: NavigationError | None = None
    terrain: TerrainError | None = None

    def __post_init__(self) -> None:
        kinds = {"gusts": DrydenGusts, "navigation": NavigationError, "terrain": TerrainError}
        for name, kind in kinds.items():
            value = getattr(self, name)
            if value is not None and not isinstance(value, kind):
                raise ArgumentError(name, value, f"None or a {kind.__name__}")

    @staticmethod
    def level(name: str) -> Disturbances:
        """All three, of published sizes; that these belong together is an assumption.

        ==========  ===============  ==================  ===============
        ..          calm             moderate            severe
        ==========  ===============  ==================  ===============
        W20         15 kn            30 kn               45 kn
        horizontal  1.062 m (95 %)   8 m (95 %)          15 m (95 %)
        vertical    1.790 m (95 %)   13 m (95 %)         33 m (95 %)
        roll/pitch  0.2 deg          0.4 deg             0.8 deg
        heading     1.0 deg          1.0 deg             2.0 deg
        velocity    0.1 m/s          0.1 m/s             0.2 m/s
        map         5.47 m (rms)     9.73 m (rms)        14.38 m (rms)
        ==========  ===============  ==================  ===============

        - Wind: light, moderate and severe turbulence of MIL-F-8785C, W20 of 15, 30 and 45 knots
          (figure 9 there).
        - Position: calm, satellite-based augmentation: the worst of the stations in FAA, Wide-Area
          Augmentation System Performance Analysis Report 10, 2004 (Minneapolis, a quarter, while
          approaches with vertical guidance were served). Moderate and severe, Global Positioning
          System Standard Positioning Service Performance Standard, 5th edition, 2020, table 3.8-3:
          the global average and the worst site.
        - Attitude: calm, Movella MTi-300 data sheet, 2023; moderate, Moog Crossbow NAV440 data
          sheet; severe, twice that: an assumption.
        - Velocity: calm and moderate, Xsens MTi User Manual MT0605P (MTi-G-700); severe, twice
          that: an assumption.
        - Map: calm, what SRTM was found to keep to over North America, 9 m at 90 % (Rodriguez,
          Morris & Belz 2006). Moderate, the requirement on SRTM, 16 m at 90 % (Farr et al. 2007).
          Severe, SRTM of 3 arc seconds in the Himalaya and Peninsular India, rms after removing
          outliers and voids (Mukul, Srivastava, Jade & Mukul, Scientific Reports 7, 41672, 2017;
          47.24 m with them). Correlation as in ``TerrainError``.

        Args:
            name: "calm", "moderate" or "severe".

        Raises:
            ArgumentError: another name.
        """
        if name == "calm":
            return Disturbances(
                DrydenGusts(15.0 * KNOT),
                NavigationError(gps_position(1.062, 1.790), small_ahrs(0.2, 1.0)),
                TerrainError(SRTM_NORTH_AMERICA),
            )
        if name == "moderate":
            return Disturbances(DrydenGusts(30.0 * KNOT), NavigationError(), TerrainError(SRTM))
        if name == "severe":
            position, attitude = gps_position(15.0, 33.0), small_ahrs(0.8, 2.0)
            return Disturbances(
                DrydenGusts(45.0 * KNOT),
                NavigationError(position, attitude, small_velocity(0.2)),
                TerrainError(14.38),
            )
        raise ArgumentError("name", name, f"one of {', '.join(LEVELS)}")

    def describe(self) -> tuple[str, str, str]:
        """A line on each, for reports."""
        gusts, navigation, terrain = self.gusts, self.navigation, self.terrain
        lines = ["gusts: none", "navigation error: none", "terrain error: none"]
        if gusts is not None:
            lines[0] = f"gusts: Dryden, W20 {gusts.wind_at_6m:.4g} m/s, drag {_drag(gusts)}"
        if navigation is not None:
            east, north, up = navigation.position.bias
            lines[1] = (
                f"navigation error: bias {east:.3g} m east, {north:.3g} m north, {up:.3g} m up "
                f"over {navigation.position.time:g} s, {navigation.rate:g} Hz"
            )
        if terrain is not None:
            lines[2] = (
                f"terrain error: {terrain.deviation:.3g} m, correlated over "
                f"{terrain.correlation_length:g} m, {terrain.waves} waves, seed {terrain.seed}"
            )
        return lines[0], lines[1], lines[2]

    def as_data(self) -> dict[str, Any]:
        """Every number, as dictionaries, tuples and numbers, for records of provenance."""
        return asdict(self)


def _drag(gusts: DrydenGusts) -> str:
    return "of the vehicle" if gusts.drag is None else f"{list(gusts.drag)} kg/s"
