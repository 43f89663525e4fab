"""A plan over flat ground whose rollouts are known in closed form, without a simulated vehicle."""

from __future__ import annotations

import numpy as np

from ompl_risk import TerrainClearance
from ompl_risk.simulation.loop.air import Air
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.plans import Plan
from ompl_risk.simulation.rare.steered_seeds import upward_biases
from ompl_risk.terrains import Terrain

RADIUS = 5.0


def flat(radius: float = RADIUS) -> TerrainClearance:
    """Level ground at height 0, 4 km square."""
    terrain = Terrain(np.zeros((41, 41)), spacing=(100.0, 100.0))
    return TerrainClearance(terrain, radius=radius, threads=1)


class LevelPlan(Plan):
    """Straight and level at so many metres of clearance; each rollout is off by its own height.

    With ``shake`` the height of rollout k is off by a normal number of that deviation, which
    depends on its seed only; with ``misled`` it is too low by so much times the normal number of
    which its navigation's upward bias is made.
    """

    def __init__(
        self,
        clearance: float,
        name: str = "",
        *,
        shake: float = 0.0,
        misled: float = 0.0,
        end: float = 3e3,
    ) -> None:
        self.name, self.dt = name, 0.1
        self.times = np.arange(301) * self.dt
        east = np.linspace(500.0, end, 301)
        self.positions = np.column_stack([east, np.full(301, 2000.0), np.full(301, clearance)])
        self.positions[:, 2] += RADIUS
        self.velocities = np.gradient(self.positions, self.dt, axis=0)
        self.drag, self.shake, self.misled = np.zeros(3), shake, misled

    def off(self, seeds: np.ndarray) -> np.ndarray:
        """By how much the rollouts fly too high [m]."""
        off = -self.misled * upward_biases(seeds)
        if self.shake:
            off += [np.random.default_rng(int(s)).normal(0.0, self.shake) for s in seeds]
        return off

    def run(self, air: Air, first: int, last: int, outcomes: Outcomes) -> None:
        off = self.off(air.seeds[first:last])
        phases = self.positions[:, :2] @ air.waves.T
        waves = np.vstack([np.cos(phases).T, np.sin(phases).T])
        # einsum, not @: a rollout must not depend on how many others there are, to the last bit
        errors = np.einsum("kj,jt->kt", air.amplitudes[first:last], waves)
        errors *= air.scale / max(1, len(air.waves)) ** 0.5
        d = self.positions[:, 2] - RADIUS + off[:, None] - errors
        at = d.argmin(axis=1)
        rows = slice(first, last)
        outcomes.least[rows] = d.min(axis=1)
        outcomes.when[rows], outcomes.where[rows] = self.times[at], self.positions[at]
        hit = outcomes.least[rows] <= 0.0
        outcomes.collided[rows] = np.where(hit, self.times[at], np.inf)
        outcomes.endings[rows] = hit
        if outcomes.traces.shape[1]:
            outcomes.traces[rows] = self.positions[:: air.trace_every]
            outcomes.traces[rows, :, 2] += off[:, None]
