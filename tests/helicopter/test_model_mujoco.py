"""The model against an independent simulator."""

import numpy as np
import pytest
from model_scene import XCELL, random_controls, random_states, rotation
from scipy.spatial.transform import Rotation

from ompl_risk.helicopter import model

MUJOCO = """
<mujoco>
  <option gravity="0 0 -{g}" timestep="0.001" integrator="RK4"><flag contact="disable"/></option>
  <worldbody><body><freejoint/>
    <inertial pos="0 0 0" mass="{m}" diaginertia="{J[0]} {J[1]} {J[2]}"/>
  </body></worldbody>
</mujoco>
"""


class MujocoBody:
    """A free body of the same mass and inertia; its quaternions have w first, and its velocities
    are in the world but for the angular one."""

    def __init__(self, machine):
        self.mujoco = pytest.importorskip("mujoco")
        text = MUJOCO.format(g=machine.gravity, m=machine.mass, J=machine.inertia)
        self.model = self.mujoco.MjModel.from_xml_string(text)
        self.data = self.mujoco.MjData(self.model)
        self.machine = machine

    def put(self, state):
        self.data.qpos[:] = [*state[:3], state[6], *state[3:6]]
        self.data.qvel[:] = [*rotation(state).apply(np.array(state[7:10])), *state[10:]]

    def state(self):
        x, q, v = self.data.qpos[:3], self.data.qpos[3:], self.data.qvel
        turn = np.array([*q[1:], q[0]])
        turn /= np.linalg.norm(turn)
        body = Rotation.from_quat(turn).inv().apply(v[:3])
        return np.concatenate([x, turn, body, v[3:]])

    def push(self, control):
        """Lift and tail force at the places where they act: only a free body's own frame counts."""
        q = self.data.qpos[3:]
        R = Rotation.from_quat([*q[1:], q[0]])
        u_c, u_psi, gp, gr = control
        lift = u_c * np.array([np.sin(gp) * np.cos(gr), -np.sin(gr), np.cos(gp) * np.cos(gr)])
        self.data.qfrc_applied[:] = 0.0
        for force, place in ((lift, (0, 0, self.machine.hub)),
                             ((0, -u_psi, 0), (-self.machine.tail, 0, 0))):  # fmt: skip
            at = self.data.qpos[:3] + R.apply(place)
            self.mujoco.mj_applyFT(
                self.model, self.data, R.apply(force), np.zeros(3), at, 1, self.data.qfrc_applied
            )


@pytest.mark.parametrize("seed", range(20))
def test_accelerations_are_mujocos(seed):
    body = MujocoBody(XCELL)
    state, control = random_states(1, seed)[0], random_controls(1, seed)[0]
    body.put(state)
    body.mujoco.mj_forward(body.model, body.data)
    body.push(control)
    body.mujoco.mj_forward(body.model, body.data)
    found = model.derivative(XCELL, state, control)
    omega, v = state[10:], state[7:10]
    world = rotation(state).apply(found[7:10] + np.cross(omega, v))  # of v in the world
    assert world == pytest.approx(body.data.qacc[:3], abs=1e-9)
    assert found[10:] == pytest.approx(body.data.qacc[3:], abs=1e-9)


def test_a_flight_is_mujocos():
    """One second; the wrench is renewed at MuJoCo's small steps, which limits it to 1e-3."""
    body = MujocoBody(XCELL)
    start = model.make_state((0, 0, 50), heading=0.4, velocity=(15, 0, 1), rates=(0.1, -0.2, 0.3))
    control = np.array([85.0, 0.05, 0.004, -0.003])
    body.put(start)
    body.mujoco.mj_forward(body.model, body.data)
    for _ in range(1000):
        body.push(control)
        body.mujoco.mj_step(body.model, body.data)
    ours = model.simulate(XCELL, start, np.tile(control, (50, 1)))[-1]
    theirs = body.state()
    assert np.abs(ours - start).max() > 1.0
    assert ours[:3] == pytest.approx(theirs[:3], abs=2e-3)
    assert abs(ours[3:7] @ theirs[3:7]) == pytest.approx(1.0, abs=1e-6)
    assert ours[7:] == pytest.approx(theirs[7:], abs=5e-3)
