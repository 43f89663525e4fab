"""CasADi, if it is installed."""

from __future__ import annotations

from typing import Any

from ompl_risk.errors import ExtraError


def casadi() -> Any:
    """The module casadi.

    Raises:
        ExtraError: it is not installed.
    """
    try:
        import casadi  # pyright: ignore[reportMissingImports] - an extra
    except ImportError:
        raise ExtraError("casadi", "primitives") from None
    return casadi
