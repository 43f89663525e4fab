"""One run of one planner, and what comes out of it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.criteria import Criterion
from ompl_risk.trajectory import Trajectory

ITERATIONS = {"BITstar": 15_000, "RRTstar": 2_000, "InformedRRTstar": 2_000}
"""Planners that heed an objective, and how many iterations make a usual run. BIT* looks at one edge
in an iteration, the others at one sample and its neighbours."""


@dataclass(frozen=True)
class Task:
    """One run of one planner.

    The budget counts iterations, so that the same task gives the same path however fast or busy the
    machine is.

    Args:
        planner: name of a planner, see `ITERATIONS`.
        criterion: what it minimises.
        seed: of OMPL's random numbers, at least 1.
        iterations: budget; the planner's entry in `ITERATIONS` if left out.
        time_limit: most seconds [s]; a safety net that makes the result depend on the machine.

    Raises:
        ArgumentError: an unknown planner or a number out of range.
    """

    planner: str
    criterion: Criterion
    seed: int = 1
    iterations: int = 0
    time_limit: float = 60.0

    def __post_init__(self) -> None:
        if self.planner not in ITERATIONS:
            raise ArgumentError("planner", self.planner, f"one of {', '.join(ITERATIONS)}")
        for name, least in (("seed", 1), ("iterations", 0)):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or value < least:
                raise ArgumentError(name, value, f"a whole number of at least {least}")
        if not self.time_limit > 0.0:
            raise ArgumentError("time_limit", self.time_limit, "a positive number of seconds")
        if self.iterations == 0:
            object.__setattr__(self, "iterations", ITERATIONS[self.planner])

    @property
    def label(self) -> str:
        """Such as "BITstar H1@25 seed 7"."""
        return f"{self.planner} {self.criterion.name} seed {self.seed}"


class Status(str, Enum):
    """How a task ended."""

    SOLVED = "solved"
    NO_PATH = "no path found"
    FAILED = "failed"  # the planner raised an exception, or its process died


@dataclass(frozen=True, eq=False)
class Candidate:
    """What came out of a task.

    Args:
        task: the task.
        status: how it ended.
        positions: corners of the path [m], shape (n, 3); None if there is none.
        length: length of the path [m]; inf if there is none.
        iterations: iterations that the planner ran.
        seconds: time that it took [s].
        timed_out: whether the time limit ended it, so that another run may differ.
        reason: why there is no path, in words.
    """

    task: Task
    status: Status
    positions: FloatArray | None = None
    length: float = float("inf")
    iterations: int = 0
    seconds: float = 0.0
    timed_out: bool = False
    reason: str = ""

    @property
    def solved(self) -> bool:
        """Whether there is a path."""
        return self.status is Status.SOLVED

    def trajectory(self, speed: float, name: str = "") -> Trajectory:
        """The path flown at constant speed [m/s].

        Raises:
            ArgumentError: there is no path, or the speed is not positive.
        """
        if self.positions is None:
            raise ArgumentError("candidate", self.task.label, f"solved; {self.reason}")
        return Trajectory.at_constant_speed(self.positions, speed, name or self.task.label)
