"""Units as the campaign's workers would make them, without planning."""

import sys
import time

from benchmarks.evidence import schema
from benchmarks.evidence.unit import Done, failed

COMPLETE = {"status": "complete", "reason": ""}


def done(settings, unit, *, code="c0de", **columns):
    """A unit with too few flights, unless columns say otherwise."""
    row = {"unit": unit, "split": "train", "terrain": "hills", "terrain_seed": unit}
    row |= {"status": "few", "reason": "3 flights", **columns}
    facts = {
        "procedure": settings.fingerprint, "unit": unit, "code": code, "processor": "abacus",
        "versions": {"python": "3"}, "seconds": 1.5,
    }  # fmt: skip
    content = schema.packed(schema.table([row], facts))
    return Done(unit, row["status"], row["reason"], content)


def slow(settings, unit):
    """A unit that takes a while; unit 0 is complete, unit 3 fails."""
    time.sleep(0.15)
    if unit == 3:
        return failed(settings, unit, "no wind")
    return done(settings, unit, **(COMPLETE if unit == 0 else {}))


if __name__ == "__main__":  # the command, with units that take no planning
    from benchmarks.evidence import analysis, cli

    cli.evaluate = slow
    analysis.report = lambda _parquet, _folder, console: console.print("reported")
    sys.exit(cli.main(sys.argv[1:]))
