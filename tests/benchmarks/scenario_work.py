"""Records as the scenario's worker processes would make them, without planning."""

import itertools
import os
import signal
import time

from benchmarks.scenario.findings import claims

LABELS = ("L1", "L2", "L∞", "H1")
NAMES = "ABCDE"


def answer(seed, number, places):
    """A pair with too few flights."""
    return {
        "seed": seed, "pair": number, "status": "fewer", "flights": places, "pid": os.getpid()
    }  # fmt: skip


def refused(*_, **__):
    """A part of the procedure that goes wrong."""
    raise RuntimeError("no wind")


def die_once(folder, seed, number, places):
    """Pair 1 kills its process when it is first done; others note that they were done."""
    if number == 1 and not (folder / "died").exists():
        time.sleep(0.2)
        (folder / "died").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    (folder / f"{number}.{time.monotonic_ns()}").touch()
    return answer(seed, number, places)


def die_always(seed, number, places):
    """Pairs 0 and 1 kill their process."""
    if number < 2:
        time.sleep(0.5)  # the others get somewhere
        os.kill(os.getpid(), signal.SIGKILL)
    return answer(seed, number, places)


def judged(number, norms, pc_norms):
    """A record of five flights; norms by label, a value for each of A to E."""
    durations = [300.0 + k for k in range(5)]

    def orders(table):
        ranked = {
            label: sorted(range(5), key=lambda k: (v[k], durations[k]))
            for label, v in table.items()
        }
        return {label: [NAMES[k] for k in order] for label, order in ranked.items()}

    def by_name(table):
        return {name: {label: table[label][k] for label in LABELS} for k, name in enumerate(NAMES)}

    return {
        "seed": 0,
        "pair": number,
        "status": "judged",
        "durations": dict(zip(NAMES, durations, strict=True)),
        "norms": by_name(norms),
        "pc norms": by_name(pc_norms),
        "orders": orders(norms),
        "pc orders": orders(pc_norms),
        "tau": {label: tau(norms[label], pc_norms["L2"]) for label in LABELS},
        "claims": claims(orders(norms), orders(pc_norms)),
    }


def tau(a, b):
    """Kendall's tau of values without ties, by counting."""
    pairs = list(itertools.combinations(range(len(a)), 2))
    return sum(1 if (a[i] < a[j]) == (b[i] < b[j]) else -1 for i, j in pairs) / len(pairs)
