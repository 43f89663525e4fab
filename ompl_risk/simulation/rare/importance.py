"""Rare collisions: draw errors that bring ground and vehicle together, and weigh them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, logsumexp

from ompl_risk._arrays import FloatArray, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.estimates.until import whole
from ompl_risk.simulation.loop.clearance_parts import grounds
from ompl_risk.simulation.rare.raised_ground import lifts
from ompl_risk.simulation.rare.steered_seeds import upward_biases, with_upward_biases

Floats = NDArray[np.float64]

FARTHEST = 30.0
"""Standard deviations of the error of the map beyond which lifts are not told apart."""

LOWEST = 4.0
"""Standard deviations by which the vehicle is brought down at most: there are words of 53 bits
for the normal numbers up to 8."""

SMALLEST = 1e-6
"""Share of the rollouts below which a point is left out."""

GOLDEN = 0.5 * (5.0**0.5 - 1.0)


@dataclass(frozen=True)
class RaisedGround:
    """Importance sampling of errors of height: of the map, and of the vehicle's navigation.

    At a place x the true ground is ``sigma <u(x), a>`` higher than the map, with standard normal
    amplitudes a and unit vectors u(x). The vehicle is ``tau(t) b`` lower than it believes, with the
    standard normal number b of which its upward bias at the beginning is made, and
    ``tau(t) = bias exp(-t / time)``. Where the plan would touch the ground if that were higher by
    the lift c_j, the shift of (a, b) of least norm that brings them together is

    ::

        v_j = c_j / s_j^2 (sigma u(x_j), tau_j)          s_j^2 = sigma^2 + tau_j^2

    Rollouts draw z = (a, b) from a mixture of normal densities n:

    ::

        q(z) = alpha_0 n(z) + sum_j alpha_j n(z - v_j)

        w(z) = n(z) / q(z) = 1 / (alpha_0 + sum_j alpha_j exp(<v_j, z> - |v_j|^2 / 2))

    (the balance heuristic) with shares alpha_j in proportion to the normal tail beyond
    ``c_j / s_j`` for the points of each plan, and the plans alike. The share alpha_0 that is
    drawn as usual bounds every weight by 1 / alpha_0: collisions that have other causes are never
    lost, and however ill the points are chosen the estimate is unbiased.

    It is as good as those two errors are to blame. What else moves the vehicle, such as gusts and
    what its navigation forgets, is drawn as usual; where it moves it by more than a small part of
    s, rare hits have large weights and so the interval, which knows only of hits that were met, is
    too low more often than it says. Compare seeds then.

    All plans of a call share one design, so that rollout k of each still meets the same ground,
    wind and navigation errors and differences between them can be told apart. The price: of K
    plans each has only some 1/K of the rollouts for its own points. Of rollouts without weights
    only those of the share alpha_0 remain as they would be without a design.

    Args:
        nominal: alpha_0.
        points: for each plan, the point of least lift in each of so many equal times.

    Raises:
        ArgumentError: a share that is not between 0 and 1, or no point.

    Reference: Owen and Zhou, Safe and effective importance sampling, JASA 95 (2000); Adler,
    Blanchet and Liu, Efficient Monte Carlo for high excursions of Gaussian random fields, Annals
    of Applied Probability 22 (2012); Veach and Guibas, Optimally combining sampling techniques for
    Monte Carlo rendering, SIGGRAPH 1995.
    """

    nominal: float = 0.25
    points: int = 64

    def __post_init__(self) -> None:
        share = real_number("nominal", self.nominal, "between 0 and 1")
        if not 0.0 < share < 1.0:
            raise ArgumentError("nominal", self.nominal, "between 0 and 1")
        whole("points", self.points)

    def design(self, plans: Sequence[Any], clearance: Any, disturbances: Any) -> Design:
        """The design for some plans.

        Args:
            plans: of class ``Plan``.
            clearance: a terrain's, or a union with one.
            disturbances: with a terrain error.

        Raises:
            ArgumentError: there is no terrain error, or no terrain: there is nothing to raise.
        """
        if disturbances.terrain is None:
            raise ArgumentError("importance", self, "None without a terrain error to draw")
        if not grounds(clearance):
            raise ArgumentError("importance", self, "None for a clearance without a terrain")
        parts = [self._near(plan, clearance, disturbances) for plan in plans]
        shares = np.concatenate([shares / len(parts) for shares, _ in parts])
        shifts = np.concatenate([shifts for _, shifts in parts])
        kept = shares >= SMALLEST
        shares = shares[kept] * (1.0 - self.nominal) / shares[kept].sum()
        return Design(np.concatenate([[self.nominal], shares]), shifts[kept], disturbances)

    def _near(self, plan: Any, clearance: Any, disturbances: Any) -> tuple[Floats, Floats]:
        """Shares (summing to 1) and shifts of the points of a plan."""
        terrain, every = disturbances.terrain, max(1, len(plan.positions) // (16 * self.points))
        positions, times = np.asarray(plan.positions)[::every], np.asarray(plan.times)[::every]
        lift = lifts(clearance, positions, FARTHEST * terrain.deviation)
        parts = np.array_split(np.arange(len(lift)), min(self.points, len(lift)))
        chosen = np.array([part[np.argmin(lift[part])] for part in parts])
        lift, sigma, tau = lift[chosen], terrain.deviation, _vertical(disturbances, times[chosen])
        both = np.hypot(sigma, tau)
        tails = log_ndtr(-lift / both)
        lower = np.minimum(lift * tau / both**2, LOWEST)
        raised = (lift - tau * lower) / sigma
        directions = wave_vectors(terrain.wave_numbers, positions[chosen, :2])
        shifts = np.column_stack([raised[:, None] * directions, lower])
        return np.exp(tails - logsumexp(tails)), shifts


@dataclass(frozen=True, eq=False)
class Design:
    """A mixture of normal densities from which amplitudes and upward biases are drawn.

    Attributes:
        shares: of the unshifted density first, then of the shifted ones, shape (J + 1,).
        shifts: of the amplitudes and of b, shape (J, 2 m + 1).
        disturbances: what is drawn for.
    """

    shares: FloatArray
    shifts: FloatArray
    disturbances: Any

    @property
    def heaviest(self) -> float:
        """Greatest weight there can be."""
        return 1.0 / float(self.shares[0])

    def draws(self, count: int, seed: int) -> Draws:
        """Draws with weights; rollout k's depend on the design, ``seed`` and k only.

        Which density a rollout is drawn from goes by a golden-ratio sequence from a random
        beginning: each is drawn from the mixture, and their counts are as even as can be.
        """
        plain = Draws.make(count, seed, self.disturbances)
        start = np.random.default_rng([seed, 0x5A15]).random()
        turns = (start + GOLDEN * np.arange(count)) % 1.0
        chosen = np.searchsorted(np.cumsum(self.shares)[:-1], turns, side="right")
        shifts = np.vstack([np.zeros_like(self.shifts[:1]), self.shifts])[chosen]
        amplitudes, seeds = plain.amplitudes + shifts[:, :-1], plain.seeds.copy()
        low = shifts[:, -1] != 0.0
        seeds[low] = with_upward_biases(seeds[low], upward_biases(seeds[low]) + shifts[low, -1])
        return Draws(seeds, amplitudes, self.log_weights(seeds, amplitudes))

    def log_weights(self, seeds: NDArray[np.uint64], amplitudes: FloatArray) -> Floats:
        """``log w(z)``, shape (N,).

        Args:
            seeds: of rollouts, shape (N,).
            amplitudes: of the waves, shape (N, 2 m).
        """
        z = np.column_stack([amplitudes, upward_biases(seeds)])
        exponents = z @ self.shifts.T - 0.5 * (self.shifts**2).sum(axis=1)
        exponents = np.column_stack([np.zeros(len(z)), exponents])
        return -np.asarray(logsumexp(exponents, axis=1, b=self.shares))


def wave_vectors(wave_numbers: FloatArray, places: FloatArray) -> Floats:
    """Unit vectors u(x) with ``e(x) = sigma <u(x), a>``.

    Args:
        wave_numbers: [rad/m], shape (m, 2).
        places: x, y [m], shape (n, 2).

    Returns:
        Shape (n, 2 m).
    """
    phases = places @ wave_numbers.T
    return np.hstack([np.cos(phases), np.sin(phases)]) / np.sqrt(len(wave_numbers))


def _vertical(disturbances: Any, times: FloatArray) -> Floats:
    """Heights that an upward bias of one standard deviation at the beginning still makes [m]."""
    if disturbances.navigation is None:
        return np.zeros(len(times))
    position = disturbances.navigation.position
    return position.bias[2] * np.exp(-times / position.time)
