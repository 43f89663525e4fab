"""Batches of motions that turn: what is answered for poses, and at what rate they turn."""

import math

import numpy as np
import pytest
import trimesh
from batch_answers import D0, every_answer, risk_of
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import MeshClearance
from ompl_risk.motion import (
    Risk,
    SampledBatch,
    SampledMotion,
)
from ompl_risk.motion.lines import travelled, turned
from ompl_risk.norms import Lp, Sobolev


def poses(seed, n, spread=3.0):
    rng = np.random.default_rng(seed)
    return np.hstack([rng.normal(0, spread, (n, 3)), Rotation.random(n, rng).as_quat()])


def test_poses_are_answered_as_by_the_single_model_and_turning_is_checked_all_the_way():
    wall = trimesh.creation.box((1, 20, 20))
    wall.apply_translation((9, 0, 0))
    clearance = MeshClearance(wall, body=trimesh.creation.box((0.2, 10, 0.2)))
    risk = Risk(InverseDistance(20.0), speed=2.0)
    batch, single = SampledBatch(clearance, risk, 7), SampledMotion(clearance, risk, 7)
    a, b = poses(0, 25), poses(1, 25)
    a[0], b[0] = [5, 0, 0, 0, 0, 0, 1], [5, 0, 0, 0, 0, 1, 0]  # the rod sweeps through the wall
    b[1] = a[1]
    found = every_answer(batch, a, b)
    for k in range(len(a)):
        single.a[:], single.b[:] = a[k], b[k]
        assert found["clearances"][k] == pytest.approx(single.clearance())
        assert found["are_free"][k] == single.is_motion_free()
        assert found["costs"][k] == pytest.approx(single.cost(), rel=1e-9)
        assert found["heuristics"][k] == pytest.approx(single.heuristic(), rel=1e-9)
    assert found["clearances"][0] > 1.0
    assert batch.clearances(b[:1])[0] > 1.0
    assert not found["are_free"][0]
    assert found["costs"][0] == math.inf
    assert 0.2 < found["are_free"].mean() < 1.0
    assert (found["heuristics"] <= 1.01 * found["costs"]).all()
    turn = (Rotation.from_quat(a[:, 3:]).inv() * Rotation.from_quat(b[:, 3:])).magnitude()
    way = np.linalg.norm(b[:, :3] - a[:, :3], axis=1) + clearance.reach * turn
    assert found["durations"] == pytest.approx(way / 2.0, abs=1e-7)


@pytest.mark.parametrize("norm", [Lp(2), Sobolev(1)], ids=lambda norm: norm.label)
def test_costs_of_turning_motions_are_those_of_dense_sampling(norm):
    class Tip:
        """Height of the tip of a pole that the body carries, less its length."""

        uses_orientation, reach = True, 4.0

        def __call__(self, queries):
            tip = Rotation.from_quat(queries[:, 3:]).apply([4.0, 0.0, 0.0])
            return queries[:, 2] + tip[:, 2]

    batch = SampledBatch(Tip(), risk_of(norm, duration_weight=0.0, tolerance=1e-3), 7)
    a, b = poses(2, 12), poses(3, 12)
    a[:, 2], b[:, 2] = 9.0, 14.0
    costs, durations = batch.costs(a, b), batch.durations(a, b)
    s = np.linspace(0, 1, 20_001)
    for k in range(12):
        turning = Slerp([0.0, 1.0], Rotation.from_quat([a[k, 3:], b[k, 3:]]))(s).as_quat()
        way = a[k, :3] + s[:, None] * (b[k, :3] - a[k, :3])
        f = InverseDistance(D0)(Tip()(np.hstack([way, turning])))
        assert costs[k] == pytest.approx(norm.power(s * durations[k], f), rel=5e-3)


@given(
    seed=st.integers(0, 10_000),
    angle=st.one_of(st.floats(0.0, 3.1415), st.sampled_from([0.0, 1e-12, 1e-7, 1e-4, 3.1415])),
    s=st.floats(0.0, 1.0),
    flip=st.booleans(),
)
@settings(max_examples=150, deadline=None)
def test_turning_is_at_constant_rate_by_the_shorter_arc(seed, angle, s, flip):
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
    first = Rotation.random(1, rng)
    q0, q1 = first.as_quat(), (first * turn).as_quat() * (-1.0 if flip else 1.0)
    q = turned(q0, q1, np.array([s]))
    expected = first * Rotation.from_rotvec(s * turn.as_rotvec())
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-14)
    assert (expected.inv() * Rotation.from_quat(q)).magnitude()[0] == pytest.approx(0.0, abs=1e-7)
    a, b = np.hstack([np.zeros((1, 3)), q0]), np.hstack([np.ones((1, 3)), q1])
    assert travelled(a, b, 2.0)[0] == pytest.approx(math.sqrt(3) + 2 * angle, abs=1e-12)
