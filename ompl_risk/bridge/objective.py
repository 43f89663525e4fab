"""Risk as an OMPL optimization objective."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og

from ompl_risk.avoidance import Avoidance, InverseDistance
from ompl_risk.bridge import faults
from ompl_risk.bridge.paths import read_steps
from ompl_risk.bridge.states import StateReader
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, motion_model
from ompl_risk.motion.moving import refuse_moving
from ompl_risk.motion.timed import timed_norm
from ompl_risk.norms import Norm, Sobolev


class RiskObjective(ob.OptimizationObjective):
    """Minimise a norm of the avoidance function along the path.

    ::

        cost(path) = ||f||^p + duration_weight * duration,      f(t) = f(d(q(t)))

    OMPL adds costs up along a path, so the cost is the p-th power of the norm (the square for
    H^1); ``norm(path)`` takes the root. For ``Lp(inf)`` it is the maximum of f, and costs combine
    by their maximum. A motion that touches an obstacle costs inf, so the objective is sound even
    with a coarse motion validator.

    Works with RRTstar, InformedRRTstar, SORRTstar and BITstar. With planners that would hang, crash
    or ignore it, ``solve`` says so (``ompl-risk doctor`` lists them).

    Args:
        si: over R^3, SE(3), or a compound space that starts with one of these.
        clearance: d(q); callable with points (n, 3) [m]. A ``TerrainClearance`` costs one compiled
            call a motion; others are sampled from Python, some hundred times slower.
        avoidance: f as a function of d: ``InverseDistance``, ``FlatCap`` or ``GaussianTail``, all
            compiled, or a class of your own, sampled; ``InverseDistance(d0=100)`` if left out.
        norm: ``Lp(p)`` or ``Sobolev(1)``; ``Sobolev(1)`` if left out.
        speed: constant speed along motions [m/s].
        duration_weight: cost of a second, in the unit of f^p. ``None`` is a tie-break so small that
            it only decides between ways without risk; with ``f(d1)**p`` a second of flight costs as
            much as one at clearance d1. Not with ``Lp(inf)``.
        tolerance: see ``Risk``.

    Raises:
        ArgumentError: a value out of range, a norm that does not add up along a path, a state space
            of another kind.

    Attributes:
        clearance: the clearance.
        risk: how risk is counted.

    Example:
        >>> import numpy as np
        >>> from ompl import base as ob
        >>> from ompl_risk import InverseDistance, RiskObjective, TerrainClearance, terrains
        >>> space = ob.RealVectorStateSpace(3)
        >>> space.setBounds(0.0, 90.0)
        >>> flat = terrains.Terrain(np.zeros((10, 10)), spacing=(10.0, 10.0))
        >>> objective = RiskObjective(
        ...     ob.SpaceInformation(space), TerrainClearance(flat), InverseDistance(20.0), speed=1.0
        ... )

    Reference: Nair and Kobilarov, eqs. (3) to (5).
    """

    is_risk_objective = True

    def __new__(cls, *args: Any, **options: Any) -> RiskObjective:
        """Choose the class: what is overridden costs a Python call each, so only where it must."""
        norm = options.get("norm", args[3] if len(args) > 3 else None)
        maximum = isinstance(norm, Norm) and math.isinf(norm.exponent)
        kind: Any = _with_maximum(cls) if maximum else cls
        return super().__new__(kind)

    def __init__(
        self,
        si: ob.SpaceInformation,
        clearance: Any,
        avoidance: Avoidance | None = None,
        norm: Norm | None = None,
        *,
        speed: float,
        duration_weight: float | None = None,
        tolerance: float = 1e-2,
    ) -> None:
        super().__init__(si)
        self.risk = Risk(
            InverseDistance() if avoidance is None else avoidance,
            Sobolev(1) if norm is None else norm,
            speed=speed,
            duration_weight=duration_weight,
            tolerance=tolerance,
        )
        refuse_moving(clearance)
        self.clearance, self._reader = clearance, StateReader(si.getStateSpace())
        reader = self._reader
        self._model = motion_model(clearance, self.risk, reader.width)
        self._read_a, self._read_b = reader.into(self._model.a), reader.into(self._model.b)

    def stateCost(self, state: ob.State) -> ob.Cost:
        """f(d)^p at a state, inf in collision."""
        try:
            self._read_a(state)
            f = float(self.risk.avoidance([self._model.clearance()])[0])
            return ob.Cost(f if math.isinf(self.risk.exponent) else f**self.risk.exponent)
        except BaseException as error:
            if not faults.keep(error):
                raise
            return ob.Cost(math.inf)

    def motionCost(self, s1: ob.State, s2: ob.State) -> ob.Cost:
        """Cost of the straight motion from ``s1`` to ``s2``, inf in collision."""
        try:
            self._read_a(s1)
            self._read_b(s2)
            return ob.Cost(self._model.cost())
        except BaseException as error:
            if not faults.keep(error):
                raise
            return ob.Cost(math.inf)

    def motionCostHeuristic(self, s1: ob.State, s2: ob.State) -> ob.Cost:
        """A cost that no way from ``s1`` to ``s2`` undercuts."""
        try:
            self._read_a(s1)
            self._read_b(s2)
            return ob.Cost(self._model.heuristic())
        except BaseException as error:
            if not faults.keep(error):
                raise
            return ob.Cost(0.0)

    def isSymmetric(self) -> bool:
        """A motion costs the same in both directions."""
        return True

    def norm(self, path: og.PathGeometric | oc.PathControl) -> float:
        """The norm of f along a path: rooted, without the weight of time, from the path itself.

        A ``PathGeometric`` is flown at the objective's speed. A ``PathControl`` has its own time:
        it is propagated, and between two propagation steps the vehicle moves straight.

        Args:
            path: over the objective's state space.

        Returns:
            ||f||, inf if the path touches an obstacle.

        Raises:
            ArgumentError: another kind of path, a path without a state, or a PathControl over a
                space whose states cannot be read, or lack the orientation that the clearance needs.
        """
        if not isinstance(path, og.PathGeometric | oc.PathControl):
            allowed = "an og.PathGeometric or oc.PathControl"
            raise ArgumentError("path", type(path).__name__, allowed)
        if path.getStateCount() == 0:
            raise ArgumentError("path", "no states", "a path with at least one state")
        pure = replace(self.risk, duration_weight=0.0, tolerance=min(1e-3, self.risk.tolerance))
        if isinstance(path, oc.PathControl):
            return timed_norm(*read_steps(path), self.clearance, pure)
        return self._norm_at_constant_speed(path, pure)

    def _norm_at_constant_speed(self, path: og.PathGeometric, pure: Risk) -> float:
        model = motion_model(self.clearance, pure, self._reader.width)
        read_a, read_b = self._reader.into(model.a), self._reader.into(model.b)
        states, powers = path.getStates(), []
        for first, second in pairwise(states) if len(states) > 1 else [(states[0], states[0])]:
            read_a(first)
            read_b(second)
            powers.append(model.cost())
        return self.risk.root(self.risk.combine(powers))


def _larger(_objective: Any, c1: ob.Cost, c2: ob.Cost) -> ob.Cost:
    """The larger of two costs: with ``Lp(inf)`` a path costs what its worst motion costs."""
    return c1 if c1.value() >= c2.value() else c2


@cache
def _with_maximum(kind: type[RiskObjective]) -> type:
    """The objective class with costs that combine by their maximum."""
    if "combineCosts" in vars(kind):
        return kind
    return type(kind.__name__, (kind,), {"__doc__": kind.__doc__, "combineCosts": _larger})
