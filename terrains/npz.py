"""The library's own NPZ files: everything a `Terrain` knows, as plain arrays."""

from __future__ import annotations

import zipfile
from dataclasses import astuple
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ompl_risk.errors import ArgumentError, FileError, TerrainError
from ompl_risk.terrains.georeference import Georeference
from ompl_risk.terrains.voids import settle_voids

if TYPE_CHECKING:
    from ompl_risk.terrains.terrain import Terrain

_REQUIRED = ("heights", "spacing")
_TEXT = ("crs", "name", "source")


def write(terrain: Terrain, path: str | Path) -> None:
    """Write `terrain`, see `Terrain.to_npz`; not compressed, as that takes longer than it saves."""
    path = Path(path)
    if path.suffix.lower() != ".npz":
        raise ArgumentError("path", str(path), "a name that ends in .npz, as load() goes by it")
    content: dict[str, Any] = {
        "heights": terrain.heights,
        "spacing": terrain.spacing,
        "origin": terrain.origin,
        "scale_error": terrain.scale_error,
    }
    content |= {key: getattr(terrain, key) or "" for key in _TEXT}
    if terrain.geo is not None:
        content["geo"] = astuple(terrain.geo)
    try:
        np.savez(path, **content)
    except OSError as error:
        raise FileError(path, f"cannot be written ({error.strerror})") from error


def read(path: Path, fill: str | None) -> dict[str, Any]:
    """Return the arguments of the `Terrain` in an NPZ file.

    Only `heights` (row 0 in the south) and `spacing` are required; NaN heights are voids.

    Raises:
        FileError: the file is no NPZ file or lacks a key.
        VoidError: there are voids and `fill` is None.
    """
    content = _content(path)
    missing = [key for key in _REQUIRED if key not in content]
    if missing:
        raise FileError(
            path,
            f"lacks {', '.join(missing)} (it has {', '.join(sorted(content)) or 'nothing'})",
            "an NPZ terrain needs heights (ny, nx) [m], row 0 in the south, and spacing (dx, dy) "
            "[m]; Terrain.to_npz writes one",
        )
    heights = content["heights"]
    if heights.ndim != 2 or heights.dtype.kind not in "iuf":
        raise TerrainError(
            f"{path}: heights are of shape {heights.shape} and type {heights.dtype}",
            "they must be real numbers of shape (ny, nx)",
        )
    heights = heights.astype(np.float64, copy=False)
    arguments: dict[str, Any] = {"heights": settle_voids(heights, np.isnan(heights), fill)}
    arguments |= {key: content[key].tolist() for key in ("spacing", "origin") if key in content}
    arguments |= {key: str(content[key]) for key in _TEXT if key in content}
    arguments["crs"] = arguments.get("crs") or None
    if "scale_error" in content:
        arguments["scale_error"] = content["scale_error"].item()
    if "geo" in content:
        arguments["geo"] = Georeference(*(float(part) for part in content["geo"]))
    return arguments


def _content(path: Path) -> dict[str, np.ndarray]:
    try:
        with np.load(path, allow_pickle=False) as archive:
            return dict(archive)
    except (OSError, ValueError, EOFError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        raise FileError(path, f"cannot be read as an NPZ file ({error})") from error
