"""Degrees to local metres and back, and how far a map's metres are from metres on the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk.errors import TerrainError

if TYPE_CHECKING:
    from rasterio.crs import CRS

MAX_SCALE_ERROR = 0.01
"""Worst relative error of a horizontal distance that `load` accepts."""

_A = 6378137.0  # WGS84 semi-major axis [m]
_E2 = 0.0066943799901413165  # WGS84 first eccentricity squared
_STEP = 50.0  # of the difference quotients of a projection [m]


def metres_per_degree(latitude: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    r"""Length of a degree of longitude and of latitude on the WGS84 ellipsoid.

    (pi/180) N cos(phi) and (pi/180) M with N = a / w, M = a (1 - e^2) / w^3, w^2 = 1 - e^2 sin^2.

    Args:
        latitude: geodetic latitude [degree], any shape.

    Returns:
        Metres per degree of longitude and metres per degree of latitude, in the same shape.
    """
    phi = np.radians(np.asarray(latitude, dtype=np.float64))
    w = np.sqrt(1.0 - _E2 * np.sin(phi) ** 2)
    degree = math.pi / 180.0
    return degree * _A * np.cos(phi) / w, degree * _A * (1.0 - _E2) / w**3


@dataclass(frozen=True)
class Georeference:
    """Local metres of a terrain that was given in degrees: x east and y north of one post.

    x = (lon - lon0) metres_per_lon, y = (lat - lat0) metres_per_lat: no post is moved relative to
    its neighbours, a degree merely gets one length each way, that at the centre latitude.

    Attributes:
        lon0: longitude of (x, y) = (0, 0) [degree].
        lat0: latitude of (x, y) = (0, 0) [degree].
        metres_per_lon: length of a degree of longitude [m].
        metres_per_lat: length of a degree of latitude [m].
    """

    lon0: float
    lat0: float
    metres_per_lon: float
    metres_per_lat: float

    @classmethod
    def about(cls, latitude: float, *, lon0: float, lat0: float) -> Georeference:
        """Scale degrees as they are at `latitude`, with (0, 0) at (lon0, lat0)."""
        per_lon, per_lat = metres_per_degree(latitude)
        return cls(lon0, lat0, float(per_lon), float(per_lat))

    def to_lonlat(
        self, x: ArrayLike, y: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Longitude and latitude [degree] of local positions x, y [m]."""
        lon = self.lon0 + np.asarray(x, dtype=np.float64) / self.metres_per_lon
        lat = self.lat0 + np.asarray(y, dtype=np.float64) / self.metres_per_lat
        return lon, lat

    def from_lonlat(
        self, lon: ArrayLike, lat: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Local positions x, y [m] of longitude and latitude [degree]."""
        x = (np.asarray(lon, dtype=np.float64) - self.lon0) * self.metres_per_lon
        y = (np.asarray(lat, dtype=np.float64) - self.lat0) * self.metres_per_lat
        return x, y

    def scale_error(self, south: float, north: float) -> float:
        """Worst relative error of a distance between the latitudes `south` and `north` [degree].

        The map is a pure scaling of each axis, so the error of any direction lies between those
        of the two axes; both are monotonic on each side of the equator.
        """
        latitudes = np.array([south, north] + [0.0] * (south < 0.0 < north))
        per_lon, per_lat = metres_per_degree(latitudes)
        with np.errstate(divide="ignore"):  # a pole has no length of longitude: the error is inf
            errors = [self.metres_per_lon / per_lon - 1.0, self.metres_per_lat / per_lat - 1.0]
        return float(np.abs(errors).max())


def projection_error(crs: CRS, bounds: tuple[float, float, float, float]) -> float:
    """Worst relative error of a distance in a projected metric CRS, over `bounds`.

    The largest |s - 1| over the singular values s of d(map metres)/d(ground metres), from
    central differences on 5 x 5 positions: a UTM zone gives 0.0004, Web Mercator at 60 degrees 1.

    Args:
        crs: the projected CRS, in metres.
        bounds: (xmin, ymin, xmax, ymax) [m].
    """
    from rasterio.warp import transform

    xs, ys = np.meshgrid(np.linspace(bounds[0], bounds[2], 5), np.linspace(bounds[1], bounds[3], 5))
    stencil = _STEP * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    at = np.stack([xs.ravel(), ys.ravel()], axis=1)[:, None, :] + stencil
    lon, lat, *_ = transform(crs, "EPSG:4326", at[..., 0].ravel(), at[..., 1].ravel())
    lon, lat = np.reshape(lon, (-1, 4)), np.reshape(lat, (-1, 4))
    if not (np.isfinite(lon).all() and np.isfinite(lat).all()):
        return math.inf
    per_lon, per_lat = metres_per_degree(lat.mean(axis=1))
    lon = (lon - lon[:, :1] + 180.0) % 360.0 - 180.0  # neighbours across the date line
    east, north = lon * per_lon[:, None], lat * per_lat[:, None]
    ground = np.stack([east, north], axis=1)  # (n, 2, 4)
    jacobian = (ground[..., 0::2] - ground[..., 1::2]) / (2.0 * _STEP)  # ground by map
    with np.errstate(divide="ignore"):
        stretch = 1.0 / np.linalg.svd(jacobian, compute_uv=False)
    return float(np.abs(stretch - 1.0).max())


def utm_zone(lon: float, lat: float) -> str:
    """Return the CRS of the UTM zone of a position, as "EPSG:32616"."""
    zone = int((lon + 180.0) % 360.0 // 6.0) + 1
    return f"EPSG:{(32600 if lat >= 0.0 else 32700) + zone}"


def check_scale(error: float, source: object, crs: str) -> float:
    """Return `error` if it is small enough for distances to be taken as metres on the ground.

    Args:
        error: worst relative error of a horizontal distance.
        source: what is being loaded.
        crs: a CRS to suggest instead.

    Raises:
        TerrainError: it exceeds `MAX_SCALE_ERROR`.
    """
    if error > MAX_SCALE_ERROR:
        raise TerrainError(
            f"{source}: horizontal distances would be wrong by up to {error:.2%}, "
            f"more than {MAX_SCALE_ERROR:.0%}",
            "pass bounds= to load a smaller window, or reproject in a way that keeps the "
            f'summits: terrains.reproject_max({str(source)!r}, "{crs}")',
        )
    return error
