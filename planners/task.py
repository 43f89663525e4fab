"""One run of one planner, and what comes out of it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.criteria import Criterion
from ompl_risk.planners.methods import Heeds, Method, method_of
from ompl_risk.trajectory import Trajectory


@dataclass(frozen=True)
class Task:
    """One run of one planner.

    The budget counts iterations, so that the same task gives the same path however fast or busy the
    machine is. What a planner finds is simplified by the criterion, so that also planners that
    minimise nothing (RRT, RRTConnect and the KPIECE family) or only the length (FMT, BFMT) give
    candidates; `heeds` says which is the case.

    Args:
        planner: name of a planner of OMPL, or of one written in Python, see `method_of`.
        criterion: what is minimised.
        seed: of OMPL's random numbers, at least 1.
        iterations: budget; the usual one of the planner, see `METHODS`, if left out.
        time_limit: most seconds [s]; a safety net that makes the result depend on the machine.

    Raises:
        ArgumentError: an unknown planner, a planner that would hang or crash with the criterion, or
            a number out of range.
    """

    planner: str
    criterion: Criterion
    seed: int = 1
    iterations: int = 0
    time_limit: float = 60.0

    def __post_init__(self) -> None:
        method = method_of(self.planner)
        if isinstance(self.planner, type):
            object.__setattr__(self, "planner", method.name)
        if not isinstance(self.criterion, Criterion):
            allowed = 'a Criterion, as parse_criterion("H1@25") gives'
            raise ArgumentError("criterion", self.criterion, allowed)
        method.check(self.criterion)
        for name, least in (("seed", 1), ("iterations", 0)):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or value < least:
                raise ArgumentError(name, value, f"a whole number of at least {least}")
        if not (isinstance(self.time_limit, int | float) and self.time_limit > 0.0):
            raise ArgumentError("time_limit", self.time_limit, "a positive number of seconds")
        if self.iterations == 0:
            object.__setattr__(self, "iterations", method.iterations)

    @property
    def label(self) -> str:
        """Such as "BITstar H1@25 seed 7"."""
        return f"{self.planner.rpartition('.')[2]} {self.criterion.name} seed {self.seed}"

    @property
    def method(self) -> Method:
        """The planner."""
        return method_of(self.planner)

    @property
    def heeds(self) -> Heeds:
        """What the planner minimises."""
        return self.method.heeds


class Status(str, Enum):
    """How a task ended."""

    SOLVED = "solved"
    NO_PATH = "no path found"
    FAILED = "failed"  # the planner raised an exception, or its process died
    NOT_STARTED = "not started"  # the time for all tasks together was up


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
        timed_out: whether a time limit ended it, so that another run may differ.
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
