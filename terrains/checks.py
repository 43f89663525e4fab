"""Checks of arguments, shared by everything in this package that takes numbers from a caller."""

from __future__ import annotations

import math
import numbers
from typing import TypeAlias

from ompl_risk.errors import ArgumentError

Pair: TypeAlias = tuple[float, float]
Box: TypeAlias = tuple[float, float, float, float]


def number(
    argument: str,
    value: object,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    most: float = math.inf,
) -> float:
    """Return `value` as a finite float with above < value and least <= value <= most.

    Raises:
        ArgumentError: it is no number, not finite or outside the range.
    """
    limits = [f"> {above:g}"] if above > -math.inf else []
    limits += [f">= {least:g}"] if least > -math.inf else []
    limits += [f"<= {most:g}"] if most < math.inf else []
    allowed = " and ".join(["a finite number", *limits])
    if not isinstance(value, numbers.Real) or isinstance(value, bool):
        raise ArgumentError(argument, value, allowed)
    result = float(value)
    if not (math.isfinite(result) and result > above and least <= result <= most):
        raise ArgumentError(argument, value, allowed)
    return result


def whole(argument: str, value: object, *, least: int) -> int:
    """Return `value` as an int of at least `least`.

    Raises:
        ArgumentError: it is no whole number or too small.
    """
    if not isinstance(value, numbers.Integral) or isinstance(value, bool) or value < least:
        raise ArgumentError(argument, value, f"a whole number >= {least}")
    return int(value)


def pair(argument: str, value: object, *, above: float = -math.inf) -> Pair:
    """Return `value` as two finite floats, each greater than `above`.

    Raises:
        ArgumentError: it is not two such numbers.
    """
    first, second = _sequence(argument, value, "two numbers (x, y)", 2)
    return number(f"{argument}[0]", first, above=above), number(
        f"{argument}[1]", second, above=above
    )


def grid_shape(argument: str, value: object) -> tuple[int, int]:
    """Return `value` as (ny, nx), both at least 2.

    Raises:
        ArgumentError: it is not two such whole numbers.
    """
    ny, nx = _sequence(argument, value, "two whole numbers (ny, nx)", 2)
    return whole(f"{argument}[0]", ny, least=2), whole(f"{argument}[1]", nx, least=2)


def box(argument: str, value: object) -> Box:
    """Return `value` as (xmin, ymin, xmax, ymax) with xmin < xmax and ymin < ymax.

    Raises:
        ArgumentError: it is not four such numbers.
    """
    allowed = "(xmin, ymin, xmax, ymax) with xmin < xmax and ymin < ymax"
    parts = _sequence(argument, value, allowed, 4)
    xmin, ymin, xmax, ymax = (number(f"{argument}[{k}]", part) for k, part in enumerate(parts))
    if not (xmin < xmax and ymin < ymax):
        raise ArgumentError(argument, value, allowed)
    return xmin, ymin, xmax, ymax


def _sequence(argument: str, value: object, allowed: str, length: int) -> list[object]:
    try:
        parts = list(value)  # pyright: ignore[reportArgumentType, reportCallIssue]
    except TypeError:
        raise ArgumentError(argument, value, allowed) from None
    if len(parts) != length or isinstance(value, str | bytes | dict):
        raise ArgumentError(argument, value, allowed)
    return parts
