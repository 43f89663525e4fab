"""Turbulence: what the wind does to a vehicle on its way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive, readonly
from ompl_risk._kernels import gusts as kernels
from ompl_risk.errors import ArgumentError

FOOT = 0.3048
"""[m]"""

LOWEST, HIGHEST = 10.0 * FOOT, 1000.0 * FOOT
"""Heights between which the low-altitude model holds [m]."""

X_CELL_DRAG = (2.5, 3.6, 18.1)
"""Force [N] for each m/s of gust along the body's axes of an X-Cell 60 at 20 m/s [kg/s].

By the model of Gavrilets, linear about level flight at V = 20 m/s in air of rho = 1.225 kg/m^3,
with the fuselage's areas S = (0.10, 0.22, 0.15) m^2:

- forward: fuselage ``rho S_x V`` = 2.45, rotor 0.02 (the disk tilts back by
  ``2 K_mu (4/3 theta_0 - lambda_0)`` for each unit of advance ratio, K_mu = 0.2);
- sideways: fuselage ``rho S_y V / 2`` = 2.70, vertical fin ``rho S_vf C_La V / 2`` = 0.29, tail
  rotor 0.65 by the formula below, of which the fin leaves 0.83;
- upward: fuselage ``rho S_z V / 2`` = 1.84, stabiliser ``rho S_ht C_La V / 2`` = 0.37, main rotor
  15.9: ``rho Omega R pi R^2 (a sigma / 4) / (1 + a sigma / (8 eta mu))``, the change of its thrust
  with the flow through the disk, inflow included, at the advance ratio mu = V / (Omega R).

A rotor answers to gusts upward far more than a fuselage does.

Mass, areas of the fuselage, radii and speeds of the rotors agree with quotations of the report;
chords, lift slopes a and C_La, K_mu, eta = 0.9 and the fins could not be checked so and are
assumptions. So is that a gust acts everywhere at once and the rotors' inflow settles with it.

Reference: Gavrilets, Mettler & Feron, Nonlinear model for a small-size acrobatic helicopter, AIAA
2001-4333; Gavrilets, Mettler & Feron, Dynamic model for a miniature aerobatic helicopter, MIT-LIDS
report P-2579, 2003 (the parameters).
"""


@dataclass(frozen=True, init=False)
class DrydenGusts:
    """Dryden turbulence at low altitude, met by a vehicle that flies through it.

    Along the flight (u), across it (v) and upward (w), with the height h above the ground in feet:

    ::

        L_w = h,           L_u = L_v = h / (0.177 + 0.000823 h)^1.2
        sigma_w = 0.1 W20, sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4
        Phi_u(k) = sigma_u^2 2 L_u / pi / (1 + (L_u k)^2)
        Phi_w(k) = sigma_w^2 L_w / pi (1 + 3 (L_w k)^2) / (1 + (L_w k)^2)^2,  Phi_v alike

    for wave numbers k from 0 [rad/m], whose autocovariances at a distance s are
    ``sigma^2 exp(-s / L)`` and ``sigma^2 exp(-s / L) (1 - s / (2 L))``. The vehicle passes through
    frozen turbulence: s = V t. The samples at the steps have exactly these covariances, whatever
    the step, and height and speed may change along a plan without a jump (see the kernel).

    Limits of the model:

    - It holds from 10 ft to 1000 ft; beyond, the scales and intensities at these heights are taken.
    - It is one of aeroplanes, whose speed is large beside the wind and its gusts: that the
      turbulence is frozen holds the less, the slower the flight. For a small helicopter it is an
      assumption.
    - V is the airspeed, but at least W20, an assumption made here: past a vehicle that hovers
      turbulence is carried by the wind. The mean wind itself is not simulated: it is taken to be
      known to the plan.
    - The axes are those of the flight: u lies along the air's motion past the vehicle, and in a
      turn the horizontal gusts turn with it. JSBSim lays u along the wind over the ground instead.
    - The angular gusts p, q, r are left out: a small vehicle is a point here.
    - A gust w pushes with ``drag * (R^T w)``, as if turbulence were the same all over the body.

    Args:
        wind_at_6m: mean wind 6 m (20 ft) above the ground, W20 [m/s].
        drag: force for each m/s of gust along the body's axes, forward, left and up [kg/s], shape
            (3,); None takes the vehicle's own.

    Raises:
        ArgumentError: a wind that is not positive, or a drag below 0.

    Reference: MIL-F-8785C, Flying qualities of piloted airplanes, 1980, section 3.7, the scales in
    its figure 10, the intensities in figure 11 (L_v and L_w are twice those of MIL-HDBK-1797, 1997,
    whose formulas have 2 L in their place: the same gusts).
    """

    wind_at_6m: float
    drag: tuple[float, float, float] | None

    def __init__(self, wind_at_6m: float, drag: ArrayLike | None = X_CELL_DRAG) -> None:
        object.__setattr__(self, "wind_at_6m", positive("wind_at_6m", wind_at_6m))
        object.__setattr__(self, "drag", None if drag is None else _drag(drag))

    def scales(self, heights: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Scale lengths of the level and the upward gusts [m], shapes (n,).

        Args:
            heights: above the ground [m], shape (n,).
        """
        feet = _feet(heights)
        return feet / (0.177 + 0.000823 * feet) ** 1.2 * FOOT, feet * FOOT

    def deviations(self, heights: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Standard deviations of the level and the upward gusts [m/s], shapes (n,).

        Args:
            heights: above the ground [m], shape (n,).
        """
        feet = _feet(heights)
        upward = np.full(len(feet), 0.1 * self.wind_at_6m)
        return upward / (0.177 + 0.000823 * feet) ** 0.4, upward

    def filters(
        self, heights: ArrayLike, speeds: ArrayLike, headings: ArrayLike, dt: float
    ) -> FloatArray:
        """What the shaping filters need at each step, shape (n, FILTER), read-only.

        Args:
            heights: above the ground [m], shape (n,).
            speeds: airspeed [m/s], shape (n,).
            headings: direction of flight, counterclockwise from east [rad], shape (n,).
            dt: the step [s].

        Raises:
            ArgumentError: a wrong shape, a number that is not finite, a negative speed.
        """
        heights = readonly("heights", heights, (None,), "(n,)")
        n = len(heights)
        speeds = readonly("speeds", speeds, (n,), f"({n},)")
        headings = readonly("headings", headings, (n,), f"({n},)")
        if n and speeds.min() < 0.0:
            raise ArgumentError("speeds", float(speeds.min()), "0 or more [m/s]")
        way = np.maximum(speeds, self.wind_at_6m) * positive("dt", dt)
        level, upward = self.scales(heights)
        rows = np.empty((n, kernels.FILTER))
        keep = np.exp(-way / level)
        rows[:, kernels.ALONG] = keep
        rows[:, kernels.ALONG + 1] = np.sqrt(-np.expm1(-2.0 * way / level))
        rows[:, kernels.ACROSS : kernels.ACROSS + 5] = _second_order(way / level)
        rows[:, kernels.UP : kernels.UP + 5] = _second_order(way / upward)
        rows[:, kernels.COSINE], rows[:, kernels.SINE] = np.cos(headings), np.sin(headings)
        rows[:, kernels.LEVEL_SIGMA], rows[:, kernels.UP_SIGMA] = self.deviations(heights)
        rows.setflags(write=False)
        return rows


def _second_order(a: FloatArray) -> FloatArray:
    """Kept, passed on and the three numbers of the root of the added covariance, shape (n, 5).

    Args:
        a: the step over the time constant, shape (n,).
    """
    keep = np.exp(-a)
    q11 = 0.5 * -np.expm1(-2.0 * a)
    q12 = 0.25 - keep**2 * (0.5 * a + 0.25)
    q22 = 0.25 - keep**2 * (0.5 * a * a + 0.5 * a + 0.25)
    root = np.sqrt(q11)
    rest = np.sqrt(np.maximum(q22 - q12**2 / q11, 0.0))
    return np.column_stack([keep, keep * a, root, q12 / root, rest])


def _feet(heights: ArrayLike) -> FloatArray:
    return np.clip(readonly("heights", heights, (None,), "(n,)"), LOWEST, HIGHEST) / FOOT


def _drag(value: ArrayLike) -> tuple[float, float, float]:
    x, y, z = readonly("drag", value, (3,), "(3,): along the body's axes [kg/s]").tolist()
    if min(x, y, z) < 0.0:
        raise ArgumentError("drag", [x, y, z], "0 or more in every direction")
    return x, y, z
