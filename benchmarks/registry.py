"""The benchmarks by name, those of the library and those beside peers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from benchmarks import (
    anytime,
    clearance,
    closed_loop,
    distances,
    helicopter_planners,
    large_terrain,
    objective,
    primitives,
    probability,
    ranking,
    roadmap,
    sst,
)
from benchmarks.metric import Absent, Metric

Measure = Callable[[Any, int, Callable[[str], None]], Iterator[Metric | Absent]]


@dataclass(frozen=True)
class Benchmark:
    """Something that can be measured.

    Attributes:
        measure: measure(config, seed, say) yields the figures; ``say`` reports progress.
        full: configuration of a full run.
        quick: one that takes seconds.
    """

    measure: Measure
    full: Any
    quick: Any


def _registered(**modules: Any) -> Mapping[str, Benchmark]:
    """Benchmarks by name; each module has ``measure``, ``Config`` and ``QUICK``."""
    return MappingProxyType(
        {
            name.replace("_", "-"): Benchmark(module.measure, module.Config(), module.QUICK)
            for name, module in modules.items()
        }
    )


BENCHMARKS = _registered(
    clearance=clearance,
    closed_loop=closed_loop,
    helicopter_planners=helicopter_planners,
    large_terrain=large_terrain,
    objective=objective,
    primitives=primitives,
    probability=probability,
    ranking=ranking,
    roadmap=roadmap,
    sst=sst,
)
"""What the library promises; kept by the gate."""

PEERS = _registered(distances=distances, anytime=anytime)
"""Beside others, as far as they are installed."""
