"""The columns of the campaign's Parquet, a row for each flight, and how they are written."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from benchmarks.evidence import profiles
from benchmarks.evidence.procedure import LEVELS

Row = dict[str, Any]


def _schema() -> pa.Schema:
    """See `SCHEMA`."""
    floats = pa.list_(pa.float32())
    place = pa.list_(pa.float64())
    fields: dict[str, Any] = {
        "unit": pa.int32(),
        "split": pa.string(),
        "terrain": pa.string(),
        "terrain_seed": pa.int32(),
        "status": pa.string(),
        "reason": pa.string(),
        "start": place,
        "goal": place,
        "flight": pa.int8(),
        "duration": pa.float64(),
        "length": pa.float64(),
        "step": pa.float64(),
        **dict.fromkeys(profiles.COLUMNS, floats),
    }
    for level in LEVELS:
        fields[f"{level}_hits"] = pa.int32()
        fields[f"{level}_rollouts"] = pa.int32()
        fields[f"{level}_bits"] = pa.binary()
        fields[f"{level}_least"] = floats
    return pa.schema(list(fields.items()))


SCHEMA = _schema()
"""A complete unit has a row for each flight, fastest first; any other has one, with its reason:

- unit, split ("train" or "test"), terrain and terrain_seed;
- status: "complete", "few" (fewer than five flights) or "failed"; reason: of the last two;
- start and goal: x, y, z [m]; flight: 0 to 4; duration [s], length [m];
- step [s]: sample k of the lists is at k steps, the last one at the duration; the lists, see
  ``profiles``: d, up, curvature, speed, pc;
- for each level of disturbances: hits of so many rollouts; bits, which of them they were, in the
  order of the rollouts as ``numpy.packbits`` packs them: rollout k of all flights of a unit met the
  same disturbances; least, the 5, 25, 50, 75 and 95 % quantiles of the least clearance [m].
"""

COMPRESSION = "zstd"
SPLIT = [f"{name}.list.element" for name in profiles.COLUMNS]
WORDS = ["unit", "split", "terrain", "terrain_seed", "status", "reason"]


def table(rows: Sequence[Row], facts: Mapping[str, Any]) -> pa.Table:
    """Rows, of which absent columns are null, with facts as JSON in the metadata."""
    return with_facts(pa.Table.from_pylist(list(rows), SCHEMA), facts)


def with_facts(content: pa.Table, facts: Mapping[str, Any]) -> pa.Table:
    """The table with other metadata."""
    return content.replace_schema_metadata({k: json.dumps(v) for k, v in facts.items()})


def facts_of(schema: pa.Schema) -> dict[str, Any]:
    """The metadata that was written.

    Raises:
        ValueError: it is not JSON.
    """
    return {k.decode(): json.loads(v) for k, v in (schema.metadata or {}).items()}


def write(content: pa.Table, target: Any) -> None:
    """Write as Parquet: small, and with checksums.

    Args:
        content: the table.
        target: a path or a file.
    """
    encodings: dict[str, Any] = {
        "use_dictionary": WORDS,
        "use_byte_stream_split": SPLIT,  # the bytes of a float that change little lie together
    }
    pq.write_table(
        content,
        target,
        compression=COMPRESSION,
        compression_level=None if COMPRESSION == "none" else 15,
        write_page_checksum=True,
        **encodings,
    )


def packed(content: pa.Table) -> bytes:
    """What ``write`` writes."""
    sink = pa.BufferOutputStream()
    write(content, sink)
    return sink.getvalue().to_pybytes()


def read(source: Any) -> pa.Table:
    """Read a file that ``write`` wrote.

    Raises:
        OSError: there is none, or checksums say that it is damaged.
        ValueError: it has other columns, or is no Parquet.
    """
    content = pq.read_table(source, page_checksum_verification=True)
    for field in SCHEMA:
        k = content.schema.get_field_index(field.name)
        if k < 0 or content.schema.field(k).type != field.type:
            raise ValueError(f"no column {field.name} of {field.type}")
    return content.select(SCHEMA.names)
