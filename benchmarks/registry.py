"""The benchmarks by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from benchmarks import clearance, large_terrain, objective, probability
from benchmarks.metric import Metric

Measure = Callable[[Any, int, Callable[[str], None]], Iterator[Metric]]


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


BENCHMARKS: Mapping[str, Benchmark] = MappingProxyType(
    {
        name: Benchmark(module.measure, module.Config(), module.QUICK)
        for name, module in (
            ("clearance", clearance),
            ("large-terrain", large_terrain),
            ("objective", objective),
            ("probability", probability),
        )
    }
)
