"""The peers that answer distances, each loaded only if it is there."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from benchmarks.peers.ground import Ground
from ompl_risk.terrains import Terrain


@dataclass(frozen=True)
class Offer:
    """A peer by name, which need not be installed.

    Attributes:
        name: of the library.
        module: where the peer's class is.
        kind: the class.
        packages: that install the library, the usual one first.
    """

    name: str
    module: str
    kind: str
    packages: tuple[str, ...]

    def load(self) -> Callable[[Terrain], Ground]:
        """The peer's class.

        Raises:
            NotThereError: the library is not installed, or does not load.
        """
        try:
            module: Any = importlib.import_module(self.module)
        except (ImportError, OSError) as error:
            if self.version is None:
                raise NotThereError("not installed", f"pip install {self.packages[0]}") from None
            raise NotThereError("does not load", " ".join(str(error).split())) from error
        return getattr(module, self.kind)

    @property
    def version(self) -> str | None:
        """The version that is installed, if any is."""
        for package in self.packages:
            try:
                return version(package)
            except PackageNotFoundError:
                continue
        return None


class NotThereError(Exception):
    """A peer that cannot be asked.

    Attributes:
        reason: in two words.
        remedy: what helps, or what the system says.
    """

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(f"{reason}: {remedy}")
        self.reason, self.remedy = reason, remedy


PEERS: tuple[Offer, ...] = (
    Offer("python-fcl", "benchmarks.peers.fcl_ground", "FclGround", ("python-fcl",)),
    Offer("coal", "benchmarks.peers.coal_ground", "CoalGround", ("coal",)),
    Offer(
        "Open3D", "benchmarks.peers.open3d_ground", "Open3dGround",
        ("open3d", "open3d-cpu", "open3d-xpu"),
    ),
    Offer("fcpw", "benchmarks.peers.fcpw_ground", "FcpwGround", ("fcpw",)),
    Offer("libigl", "benchmarks.peers.igl_ground", "IglGround", ("libigl",)),
)  # fmt: skip
