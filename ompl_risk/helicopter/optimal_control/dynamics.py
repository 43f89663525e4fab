"""The step of `_kernels.rigid_body` as an expression of CasADi, which can be differentiated."""

from __future__ import annotations

from typing import Any

from ompl_risk._kernels import rigid_body
from ompl_risk.helicopter.optimal_control.needs import casadi
from ompl_risk.helicopter.parameters import Helicopter


def rotation(state: Any) -> Any:
    """R, from body to world, of a state of 13 expressions."""
    ca = casadi()
    x, y, z, w = (state[i] for i in range(3, 7))
    squared = ca.vertcat(
        ca.horzcat(w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )
    return squared / (x * x + y * y + z * z + w * w)


def product(a: Any, b: Any) -> list[Any]:
    """The product a b of two quaternions (x, y, z, w)."""
    ax, ay, az, aw = (a[i] for i in range(4))
    bx, by, bz, bw = (b[i] for i in range(4))
    return [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]


def rates(state: Any, control: Any, helicopter: Helicopter) -> Any:
    """Time derivatives of a state, eqs. (7) and (8)."""
    ca = casadi()
    given = [float(value) for value in helicopter.given]
    x, y, z, w = (state[i] for i in range(3, 7))
    v, o = state[7:10], state[10:13]
    R = rotation(state)
    torque, force = _wrench(control, helicopter)
    drag = ca.DM(given[rigid_body.DRAG : rigid_body.WIND])
    wind = ca.DM(given[rigid_body.WIND : rigid_body.PARAMETERS])
    air = v - R.T @ wind
    J = ca.DM(list(helicopter.inertia))
    turn = 0.5 * ca.vertcat(
        w * o[0] + y * o[2] - z * o[1],
        w * o[1] + z * o[0] - x * o[2],
        w * o[2] + x * o[1] - y * o[0],
        -(x * o[0] + y * o[1] + z * o[2]),
    )
    push = ca.cross(v, o) - helicopter.gravity * R[2, :].T + (force - drag * air) / helicopter.mass
    return ca.vertcat(R @ v, turn, push, (ca.cross(J * o, o) + torque) / J)


def step(state: Any, control: Any, dt: Any, helicopter: Helicopter) -> Any:
    """One step of the Runge-Kutta method of order 4, then a quaternion of norm 1."""
    ca = casadi()
    a = rates(state, control, helicopter)
    b = rates(state + 0.5 * dt * a, control, helicopter)
    c = rates(state + 0.5 * dt * b, control, helicopter)
    d = rates(state + dt * c, control, helicopter)
    end = state + dt / 6.0 * (a + 2.0 * (b + c) + d)
    return ca.vertcat(end[:3], end[3:7] / ca.norm_2(end[3:7]), end[7:])


def _wrench(control: Any, helicopter: Helicopter) -> tuple[Any, Any]:
    """Torque [N m] and force [N] of the controls in the body's frame, F(gamma) u."""
    ca = casadi()
    u_c, u_psi, gamma_p, gamma_r = (control[i] for i in range(4))
    fx = u_c * ca.sin(gamma_p) * ca.cos(gamma_r)
    fy = -u_c * ca.sin(gamma_r)
    fz = u_c * ca.cos(gamma_p) * ca.cos(gamma_r)
    torque = ca.vertcat(-helicopter.hub * fy, helicopter.hub * fx, helicopter.tail * u_psi)
    return torque, ca.vertcat(fx, fy - u_psi, fz)
