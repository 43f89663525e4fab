"""Every error and warning that the library raises; each takes facts and writes its own message."""

from __future__ import annotations

from typing import Any


class OmplRiskError(Exception):
    """Root of the library's errors: catch this to catch them all."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by facts and message, since constructors take facts: errors cross processes."""
        return _restored, (type(self), self.args, self.__dict__)


def _restored(kind: type[OmplRiskError], args: tuple[Any, ...], facts: dict[str, Any]) -> Any:
    error = kind.__new__(kind, *args)
    error.__dict__.update(facts)
    return error


class ArgumentError(OmplRiskError, ValueError):
    """An argument has a value that is not allowed.

    Args:
        argument: name of the argument as the caller wrote it.
        value: what was given.
        allowed: what would have been accepted, in words.
    """

    def __init__(self, argument: str, value: object, allowed: str) -> None:
        self.argument, self.value, self.allowed = argument, value, allowed
        super().__init__(f"{argument} = {value!r}: must be {allowed}")


class FileError(OmplRiskError):
    """A file cannot be read as what it should be.

    Args:
        path: the file.
        problem: what is wrong, and where in the file if that is known.
        remedy: what to do about it.
    """

    def __init__(self, path: object, problem: str, remedy: str = "") -> None:
        self.path, self.problem, self.remedy = path, problem, remedy
        super().__init__(f"{path}: {problem}" + (f"; {remedy}" if remedy else ""))


class TerrainError(OmplRiskError, ValueError):
    """Heights cannot serve as a terrain.

    Args:
        problem: what is wrong and where.
        remedy: what to do about it.
    """

    def __init__(self, problem: str, remedy: str = "") -> None:
        self.problem, self.remedy = problem, remedy
        super().__init__(problem + (f"; {remedy}" if remedy else ""))


class VoidError(TerrainError):
    """A terrain has posts without a height.

    Args:
        count: number of void posts.
        first: (row, column) of the first, counted from the south-west.
    """

    def __init__(self, count: int, first: tuple[int, int]) -> None:
        self.count, self.first = count, first
        super().__init__(
            f"{count} void posts, the first at row {first[0]}, column {first[1]} "
            "from the south-west",
            'a void is never read as 0: pass fill="interpolate" to fill them, '
            "or bounds= to leave them out",
        )


class ExtentError(OmplRiskError, ValueError):
    """A query lies outside the terrain.

    Args:
        count: number of queries outside.
        first: the first of them, (x, y) [m].
        extent: (xmin, xmax, ymin, ymax) [m].
    """

    def __init__(
        self, count: int, first: tuple[float, float], extent: tuple[float, float, float, float]
    ) -> None:
        self.count, self.first, self.extent = count, first, extent
        xmin, xmax, ymin, ymax = extent
        super().__init__(
            f"{count} of the queried positions lie outside the terrain, the first at "
            f"({first[0]:g}, {first[1]:g}) m; the terrain spans x {xmin:g} to {xmax:g} m, "
            f"y {ymin:g} to {ymax:g} m"
        )


class TrapError(OmplRiskError):
    """OMPL would hang, crash or silently ignore the objective; names the way round.

    Args:
        what: the call or class that is unsafe.
        symptom: what OMPL would do.
        instead: what to use.
    """

    def __init__(self, what: str, symptom: str, instead: str) -> None:
        self.what, self.symptom, self.instead = what, symptom, instead
        super().__init__(f"{what} {symptom}; {instead}")


class TrapWarning(UserWarning):
    """OMPL goes on, but not as one would expect; the message names the way round."""


class CollisionError(OmplRiskError):
    """The safest trajectory is asked for, and every one is in collision.

    Args:
        names: the trajectories.
    """

    def __init__(self, names: tuple[str, ...]) -> None:
        self.names = names
        super().__init__(
            f"none of the trajectories is free of collision: {', '.join(names)}; "
            "collision_time and collision_position of each assessment say where"
        )


class PlanningError(OmplRiskError):
    """Planning has left too few paths to compare.

    Args:
        outcome: how many candidates there were, and what became of them.
        remedy: what to do about it.
    """

    def __init__(self, outcome: str, remedy: str) -> None:
        self.outcome, self.remedy = outcome, remedy
        super().__init__(f"too few paths to compare: {outcome}; {remedy}")


class LabelLimitError(OmplRiskError):
    """The Pareto set needs more labels than are allowed.

    Args:
        labels: how many were allowed.
        fastest: least duration of a path [s].
        reached: ways of a duration below this have all been found [s].
    """

    def __init__(self, labels: int, fastest: float, reached: float) -> None:
        self.labels, self.fastest, self.reached = labels, fastest, reached
        super().__init__(
            f"the Pareto set has more than {labels} labels (most_labels); they reach to ways of "
            f"{reached:.6g} s, where the fastest takes {fastest:.6g} s: allow more, ask for a "
            "precision above 0, or pass longest="
        )


class NoWayError(OmplRiskError, LookupError):
    """No way of a Pareto set is as fast, or of as little risk, as asked for.

    Args:
        wanted: what was asked for, in words.
        best: the nearest that there is, in words.
    """

    def __init__(self, wanted: str, best: str) -> None:
        self.wanted, self.best = wanted, best
        super().__init__(f"no way {wanted}: {best}")


class ExtraError(OmplRiskError, ImportError):
    """An optional package is needed and not installed.

    Args:
        package: what could not be imported.
        extra: the extra of ompl-risk that brings it.
    """

    def __init__(self, package: str, extra: str) -> None:
        self.package, self.extra = package, extra
        super().__init__(f"{package} is not installed; pip install 'ompl-risk[{extra}]'")


class DurationWarning(UserWarning):
    """Trajectories of different duration are ranked together, so their norms do not compare.

    Args:
        fastest: name of the trajectory of least duration, and that duration [s].
        slowest: name of the trajectory of greatest duration, and that duration [s].
        tolerance: relative spread that would have passed.
    """

    def __init__(
        self, fastest: tuple[str, float], slowest: tuple[str, float], tolerance: float
    ) -> None:
        self.fastest, self.slowest, self.tolerance = fastest, slowest, tolerance
        spread = slowest[1] / fastest[1] - 1
        super().__init__(
            f"durations differ by {100 * spread:.3g} %, more than {100 * tolerance:.3g} %: "
            f"{fastest[0]} takes "
            f"{fastest[1]:.6g} s, {slowest[0]} {slowest[1]:.6g} s; a norm grows with time spent, "
            "so compare by ranking.pareto(label), which weighs duration against the norm"
        )
