"""OMPL's paths as trajectories, and a ranking as OMPL's solutions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og
from scipy.spatial.transform import Rotation

from ompl_risk.bridge.controls import WHOLE
from ompl_risk.bridge.states import ALLOWED
from ompl_risk.bridge.timed import timed_rows
from ompl_risk.errors import ArgumentError
from ompl_risk.trajectory import Trajectory, register_path_reader

if TYPE_CHECKING:
    from ompl_risk.ranking import Ranking


def read_path(path: Any, speed: float | None = None, name: str = "") -> Trajectory:
    """The trajectory of an OMPL path; ``Trajectory.from_path`` calls this.

    A ``PathGeometric`` is flown at constant speed. A ``PathControl`` has its own time; it is
    propagated at the step size of its space information, and held controls come along; of states
    of SE(3) x R^6, as the helicopter's, also velocities in the world. Where a control's duration is
    no multiple of the step, the last step before the path's next state takes what is left of it.
    States of an ``ob.SpaceTimeStateSpace`` over R^3 carry their times.

    Args:
        path: og.PathGeometric or oc.PathControl over R^3, SE(3), or a compound space that starts
            with one of these, or over space-time.
        speed: speed [m/s] for a PathGeometric; must be left out where the path has its own time.
        name: name of the trajectory.

    Raises:
        ArgumentError: another kind of path or of space, a path without length, or a speed where
            none is wanted or none where one is.
    """
    if isinstance(path, oc.PathControl):
        if speed is not None:
            raise ArgumentError("speed", speed, "left out: a PathControl has its own time")
        return _read_controlled(path, name)
    if not isinstance(path, og.PathGeometric):
        raise ArgumentError("path", type(path).__name__, "an og.PathGeometric or oc.PathControl")
    timed = timed_rows(path)
    if timed is not None:
        return _read_timed(timed, speed, name)
    if speed is None:
        raise ArgumentError("speed", None, "given [m/s]: a PathGeometric has no time of its own")
    positions, orientations = _read_states(path)
    plain = Trajectory.at_constant_speed(positions, speed, name)
    if orientations is None:
        return plain
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    turns = 1.0 - np.abs(np.einsum("ij,ij->i", orientations[1:], orientations[:-1])) > 1e-12
    kept = np.append(True, np.diff(np.append(0.0, np.cumsum(steps)) / speed) > 0.0)
    if (turns & ~kept[1:]).any():
        state = int(np.flatnonzero(turns & ~kept[1:])[0])
        raise ArgumentError(
            "path",
            f"a turn on the spot after state {state}",
            "moving wherever it turns: at constant speed such a turn would take no time",
        )
    return Trajectory(plain.t, plain.positions, name, orientations=orientations[kept])


def read_steps(path: oc.PathControl) -> tuple[np.ndarray, np.ndarray]:
    """Where the states of a path are, at every propagation step, and how long each step takes.

    Args:
        path: over R^3, SE(3), or a compound space that starts with one of these; a state or more.

    Returns:
        Positions [m], shape (n, 3), or poses x, y, z, qx, qy, qz, qw, shape (n, 7), if the states
        have an orientation; and durations [s], 0 or more, shape (n - 1,).

    Raises:
        ArgumentError: no state, states of another space, or controls that do not fit.
    """
    fine, steps = _propagated(path)
    positions, orientations = _read_states(fine)
    poses = positions if orientations is None else np.hstack([positions, orientations])
    return poses, steps


def publish(
    problem: ob.ProblemDefinition,
    paths: Sequence[Any],
    ranking: Ranking,
    label: str | None = None,
) -> None:
    """Put ranked paths into a problem definition, so that ``getSolutionPath()`` is the safest.

    OMPL 2.0.1 orders exact solutions by length, whatever the objective, and approximate ones by
    their distance from the goal. So the safest goes in as exact, and the others as approximate
    with their rank as the distance; solutions that were there before are removed.

    Args:
        problem: the problem that the paths solve.
        paths: in the order in which the ranking got its trajectories.
        ranking: from ``rank``.
        label: norm to go by; the ranking's last one if left out.

    Raises:
        ArgumentError: paths and ranking differ in number, an unknown label, or the safest path is
            in collision, so that there is nothing to publish.
    """
    if not hasattr(ranking, "assessments"):
        raise ArgumentError("ranking", ranking, "a Ranking, as from rank(...)")
    names = [one.name for one in ranking.assessments]
    if len(paths) != len(names):
        raise ArgumentError("paths", f"{len(paths)} paths", f"{len(names)}, as in the ranking")
    label = list(ranking.orders)[-1] if label is None else label
    if label not in ranking.orders:
        raise ArgumentError("label", label, f"one of {', '.join(ranking.orders)}")
    safest = ranking.assessments[names.index(ranking.safest(label))]
    if not np.isfinite(safest.norms[label]):
        raise ArgumentError("ranking", f"{label} = inf for all", "with a path free of collision")
    problem.clearSolutionPaths()
    for rank, name in enumerate(ranking.orders[label]):
        path = paths[names.index(name)]
        problem.addSolutionPath(path, rank > 0, float(rank) if rank else -1.0, f"risk#{rank + 1}")


def _read_timed(rows: np.ndarray, speed: float | None, name: str) -> Trajectory:
    """States that carry their time; of states that are the same the first."""
    if speed is not None:
        raise ArgumentError("speed", speed, "left out: the states carry their times")
    kept = np.append(True, np.any(np.diff(rows, axis=0) != 0.0, axis=1))
    return Trajectory(rows[kept, 3], rows[kept, :3], name)


def _read_controlled(path: oc.PathControl, name: str) -> Trajectory:
    """States at every propagation step, with the time and the control of each."""
    fine, steps = _propagated(path)
    if fine.getStateCount() < 2:
        raise ArgumentError("path", f"{fine.getStateCount()} states", "a path of two or more")
    positions, orientations = _read_states(fine)
    t = np.concatenate([[0.0], np.cumsum(steps)])
    kept = np.append(True, steps > 0.0)
    columns = _columns(path)
    velocities = _read_velocities(fine, t, positions, orientations) if columns == 13 else None
    width = len(repr(fine).split("\n", 1)[0].split()) - columns - 1
    controls = None
    if width > 0:
        held: list[Any] = fine.getControls()
        controls = np.array([[c[k] for k in range(width)] for c in held])
        controls = controls[kept[1:]]
    return Trajectory(
        t[kept],
        positions[kept],
        name,
        orientations=None if orientations is None else orientations[kept],
        velocities=None if velocities is None else velocities[kept],
        controls=controls,
    )


def _propagated(path: oc.PathControl) -> tuple[oc.PathControl, np.ndarray]:
    """A copy with a state at every propagation step, and the durations of the steps (n - 1,) [s].

    OMPL rounds the number of steps of a control and gives the full step size to all of them. It
    keeps the path's own next state, so what is left of the control's duration is that of the last.

    Raises:
        ArgumentError: states and controls that do not fit, or a control that is not held for a
            finite time of 0 s or more.
    """
    states, controls = path.getStateCount(), path.getControlCount()
    if states not in (0, controls + 1):
        given = f"{states} states and {controls} controls"
        raise ArgumentError("path", given, "one of one state more than controls")
    held = path.getControlDurations()
    for duration in held:
        if not 0.0 <= duration < math.inf:
            raise ArgumentError("path", f"a control held for {duration:g} s", "one of 0 s or more")
    fine = oc.PathControl(path)
    fine.interpolate()
    steps = np.array(fine.getControlDurations(), dtype=np.float64)
    first = 0
    for duration in held:
        size = float(steps[first])
        count = 1 if size == duration else math.floor(0.5 + duration / size)
        rest = duration - (count - 1) * size
        first += count
        if abs(rest - size) > WHOLE * duration:
            steps[first - 1] = rest
    return fine, steps


def _read_velocities(
    path: Any, t: np.ndarray, positions: np.ndarray, orientations: np.ndarray | None
) -> np.ndarray | None:
    """Velocities in the world (n, 3) [m/s], of states of SE(3) x R^6 with those in the body first.

    A state does not tell what its numbers mean, but the flight does: they are velocities if, turned
    into the world, they lead from each position to the next.
    """
    states = path.getStates()
    parts = states[0] if isinstance(states[0], ob.CompoundState) else (None, None)
    if orientations is None or not isinstance(parts[0], ob.SE3State):
        return None
    if not isinstance(parts[1], ob.RealVectorStateType):
        return None
    body = np.array([state[1][0:3] for state in states], dtype=np.float64)
    found = Rotation.from_quat(orientations).apply(body)
    dt = np.diff(t)
    beside = np.diff(positions, axis=0) - 0.5 * dt[:, None] * (found[1:] + found[:-1])
    speeds = np.linalg.norm(found, axis=1)
    changes = np.linalg.norm(np.diff(found, axis=0), axis=1)
    allowed = dt * (0.01 * (speeds[1:] + speeds[:-1]) + 0.1 * changes) + 1e-9
    return found if (np.linalg.norm(beside, axis=1) <= allowed).all() else None


def _columns(path: Any) -> int:
    """Numbers in a state of the path. Only the printed path tells: its space is out of reach."""
    geometric = path.asGeometric() if isinstance(path, oc.PathControl) else path
    return len(repr(geometric).split("\n", 1)[0].split())


def _read_states(path: Any) -> tuple[np.ndarray, np.ndarray | None]:
    """Positions (n, 3) [m], and quaternions (n, 4) if the states have them."""
    states = [_leading(state) for state in path.getStates()]
    if not states:
        raise ArgumentError("path", "no states", "a path of two or more states")
    if isinstance(states[0], ob.SE3State):
        positions = np.array([(s.getX(), s.getY(), s.getZ()) for s in states])
        turns = [s.rotation() for s in states]
        quaternions = np.array([(q.x, q.y, q.z, q.w) for q in turns])
        return positions, quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
    if not isinstance(states[0], ob.RealVectorStateType):
        raise ArgumentError("path", f"states of {type(states[0]).__name__}", ALLOWED)
    first = path.getStates()[0]
    if not isinstance(first, ob.CompoundState) and (columns := _columns(path)) != 3:
        if columns == 0:  # what OMPL prints of a space that is not set up
            raise ArgumentError("path", "of a space not set up", "one after si.setup()")
        raise ArgumentError("path", f"states of R^{columns}", ALLOWED)
    return np.array([s[0:3] for s in states], dtype=np.float64), None


def _leading(state: Any) -> Any:
    """The R^3 or SE(3) part at the start of a state."""
    while isinstance(state, ob.CompoundState) and not isinstance(state, ob.SE3State):
        state = state[0]
    return state


register_path_reader(read_path)
