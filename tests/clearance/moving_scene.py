"""Moving obstacles and their distances by another way: numpy and scipy alone, a time at a time."""

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from ompl_risk.clearance.moving.obstacles import MovingBox, MovingSphere


def pose(obstacle, time):
    """Position and rotation of an obstacle at a time."""
    t = np.clip(time, obstacle.times[0], obstacle.times[-1])
    p = [np.interp(t, obstacle.times, column) for column in obstacle.positions.T]
    return np.array(p), Slerp(obstacle.times, Rotation.from_quat(obstacle.orientations))(t)


def true_distance(obstacles, point, time):
    """Least signed distance of a point to spheres and boxes."""
    found = []
    for obstacle in obstacles:
        position, rotation = pose(obstacle, time)
        local = rotation.inv().apply(np.asarray(point) - position)
        if isinstance(obstacle, MovingSphere):
            found.append(np.linalg.norm(local) - obstacle.radius)
        else:
            q = np.abs(local) - obstacle.extents / 2
            found.append(np.linalg.norm(np.maximum(q, 0)) + min(q.max(), 0.0))
    return min(found)


def wandering(seed, *, samples=5, spread=20.0, duration=10.0, spheres=1, boxes=2):
    """Spheres and boxes that wander and tumble."""
    rng, found = np.random.default_rng(seed), []
    for k in range(spheres + boxes):
        t = np.sort(rng.uniform(0.0, duration, samples))
        p = rng.uniform(-spread, spread, (samples, 3))
        if k < spheres:
            found.append(MovingSphere(rng.uniform(0.5, 4.0), t, p))
        else:
            q = Rotation.random(samples, random_state=rng).as_quat()
            found.append(MovingBox(rng.uniform(1.0, 9.0, 3), t, p, q))
    return found


def motions(seed, count, *, spread=25.0, duration=10.0):
    """Straight timed motions: a, ta, b, tb."""
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(-spread, spread, (2, count, 3))
    ta = rng.uniform(-1.0, duration, count)
    return a, ta, b, ta + rng.uniform(0.01, 0.5 * duration, count)


def along(a, ta, b, tb, shares):
    """Places and times at shares of one motion."""
    return a + shares[:, None] * (b - a), ta + shares * (tb - ta)


def circling(extents, rate, turns, centre=(0.0, 0.0, 0.0)):
    """A box that turns about the z axis at its centre, at so many rad/s."""
    count = 4 * turns + 1
    t = np.arange(count) * (0.5 * np.pi / rate)
    q = Rotation.from_rotvec(np.outer(rate * t, [0.0, 0.0, 1.0])).as_quat()
    return MovingBox(extents, t, np.tile(centre, (count, 1)), q)
