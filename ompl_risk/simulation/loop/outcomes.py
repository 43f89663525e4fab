"""What became of the rollouts of a plan."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.air import LEFT_MAP, LOST_CONTROL, Record


@dataclass(frozen=True, eq=False)
class Outcomes:
    """Least clearance and end of every rollout.

    A rollout ends where the vehicle touches the ground, leaves the map or is out of control, and
    each counts as a collision: ``collided`` is then its time, and ``least`` is not above 0. Where
    the map ends or control is lost nothing is known, and ``least`` is ``-inf``.

    Attributes:
        least: least clearance of the rollout [m], too high by no more than
            ``_kernels.watch.TOLERANCE``, 0.1 m; ``inf`` where nothing was checked; shape (N,).
        when: time of it [s], shape (N,).
        where: place of it [m], shape (N, 3).
        collided: time of the collision [s], ``inf`` where there was none, shape (N,).
        endings: COMPLETED, TOUCHED, LEFT_MAP or LOST_CONTROL of ``_kernels.air``, shape (N,).
        traces: positions every so many steps [m], shape (N, k, 3); a vehicle that has collided
            stays where it was. (N, 0, 3) unless asked for.
    """

    least: FloatArray
    when: FloatArray
    where: FloatArray
    collided: FloatArray
    endings: NDArray[np.int8]
    traces: FloatArray

    @classmethod
    def room(cls, count: int, traced: int = 0) -> Outcomes:
        """Writable arrays for so many rollouts with so many traced positions each."""
        return cls(
            least=np.full(count, np.nan),
            when=np.full(count, np.nan),
            where=np.full((count, 3), np.nan),
            collided=np.full(count, np.nan),
            endings=np.zeros(count, np.int8),
            traces=np.zeros((count, traced, 3)),
        )

    def __len__(self) -> int:
        """Rollouts."""
        return len(self.least)

    @property
    def hits(self) -> NDArray[np.bool_]:
        """Which rollouts collided, shape (N,)."""
        return self.collided < np.inf

    @property
    def left(self) -> NDArray[np.bool_]:
        """Which left the map, shape (N,)."""
        return self.endings == LEFT_MAP

    @property
    def lost(self) -> NDArray[np.bool_]:
        """Which lost control, shape (N,)."""
        return self.endings == LOST_CONTROL

    @property
    def record(self) -> Record:
        """The arrays that rollouts write, but for the traces."""
        return Record(self.least, self.when, self.where, self.collided, self.endings)

    def closed(self) -> Outcomes:
        """The same, read-only from now on."""
        for field in fields(self):
            getattr(self, field.name).setflags(write=False)
        return self
