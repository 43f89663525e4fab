"""Tables as the campaign writes them, with flights and collisions made up by a known rule."""

import json
from dataclasses import dataclass, field

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

LEVELS = ("calm", "moderate", "severe")
TERRAINS = {"train": ("hills", "ridge_valley"), "test": ("jacksboro", "canyon", "fractal")}


@dataclass
class Flight:
    """A flight's profile, before anybody judged it."""

    duration: float
    step: float
    d: np.ndarray
    up: np.ndarray
    curvature: np.ndarray
    speed: np.ndarray
    pc: np.ndarray = field(init=False)

    def __post_init__(self):
        x = np.clip(self.d / 100.0, 0.0, 1.0)
        self.pc = 0.25 * (1.0 - x) ** 2 * (2.0 + x)

    @property
    def t(self):
        return np.append(np.arange(len(self.d) - 1) * self.step, self.duration)


def flight(random, *, low=12.0, mean=60.0):
    """Clearances that wander about a mean and never fall below `low`."""
    step, duration = 0.4, random.uniform(30.0, 40.0)
    n = int(np.ceil(duration / step)) + 1
    t = np.arange(n) * step
    wave = sum(
        a * np.sin(2 * np.pi * t / period + phase)
        for a, period, phase in zip(
            random.exponential(12.0, 6),
            random.uniform(4.0, 40.0, 6),
            random.uniform(0, 7, 6),
            strict=True,
        )
    )
    d = low + np.logaddexp(0.0, (mean + wave - low) / 8.0) * 8.0
    return Flight(
        duration,
        step,
        d.astype(np.float32).astype(float),
        np.clip(random.normal(0.9, 0.1, n), 0.2, 1.0),
        random.normal(0.0, 1e-3, n),
        random.uniform(15.0, 25.0, n),
    )


def no_difference(flights, level):
    """Every flight collides as often as any other."""
    return np.full(5, (0.02, 0.05, 0.1)[level])


def as_they_are(flight, random):
    """Leave a flight alone."""


def units(
    count, rule, *, seed=0, rollouts=400, splits=("train", "test"), independent=False,
    change=as_they_are,
):  # fmt: skip
    """Rows of `count` complete units for each split.

    Args:
        rule: five flights and the number of the level to five probabilities of collision.
        independent: draw the rollouts of a unit's flights apart from each other.
        change: changes a flight before it is judged.
    """
    random = np.random.default_rng(seed)
    rows = []
    for split in splits:
        for k in range(count):
            kinds = TERRAINS[split]
            place = {
                "unit": len(rows) // 5, "split": split, "terrain": kinds[k % len(kinds)],
                "terrain_seed": (k // 4) + 1000 * (split == "test"), "status": "complete",
                "reason": "", "start": [0.0, 0.0, 60.0], "goal": [3000.0, 0.0, 60.0],
            }  # fmt: skip
            five = [flight(random) for _ in range(5)]
            for each in five:
                change(each, random)
            rows += unit(place, five, rule, random, rollouts, independent)
    return rows


def unit(place, five, rule, random, rollouts, independent=False):
    """The five rows of a unit."""
    rows = []
    for number, each in enumerate(five):
        row = {**place, "flight": number, "duration": each.duration, "step": each.step}
        row |= {"length": float(each.speed.mean() * each.duration)}
        row |= {name: getattr(each, name) for name in ("d", "up", "curvature", "speed", "pc")}
        rows.append(row)
    for index, level in enumerate(LEVELS):
        shape = (5, rollouts) if independent else (1, rollouts)
        bits = random.uniform(size=shape) < np.asarray(rule(five, index))[:, None]
        for row, collided in zip(rows, bits, strict=True):
            row[f"{level}_hits"] = int(collided.sum())
            row[f"{level}_rollouts"] = rollouts
            row[f"{level}_bits"] = np.packbits(collided).tobytes()
            row[f"{level}_least"] = [1.0, 2.0, 3.0, 4.0, 5.0]
    return rows


def incomplete(number, split="test", status="failed", reason="RuntimeError: no way"):
    """The one row of a unit that came to nothing."""
    return {
        "unit": number, "split": split, "terrain": TERRAINS[split][0], "terrain_seed": 0,
        "status": status, "reason": reason,
    }  # fmt: skip


LISTS = pa.list_(pa.float32())
SCHEMA = pa.schema(
    [
        ("unit", pa.int32()), ("split", pa.string()), ("terrain", pa.string()),
        ("terrain_seed", pa.int32()), ("status", pa.string()), ("reason", pa.string()),
        ("start", pa.list_(pa.float64())), ("goal", pa.list_(pa.float64())),
        ("flight", pa.int8()), ("duration", pa.float64()), ("length", pa.float64()),
        ("step", pa.float64()), ("d", LISTS), ("up", LISTS), ("curvature", LISTS),
        ("speed", LISTS), ("pc", LISTS),
        *(
            (f"{level}_{name}", kind)
            for level in LEVELS
            for name, kind in (("hits", pa.int32()), ("rollouts", pa.int32()),
                               ("bits", pa.binary()), ("least", pa.list_(pa.float64())))
        ),
    ],
    metadata={"procedure": json.dumps({"seed": 7, "versions": {"numpy": "2"}})},
)  # fmt: skip


def write(path, rows):
    """The rows as a Parquet file with the campaign's columns; the path."""
    pq.write_table(pa.Table.from_pylist(rows, schema=SCHEMA), path)
    return path
