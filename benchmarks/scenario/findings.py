"""The paper's three findings, asked of one scene and of many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scipy.stats import binomtest

Orders = Mapping[str, Sequence[str]]
"""Names from the safest to the riskiest, by norm."""

REFERENCE = "L2"
"""Norm of the probability of collision that says which flight is the safest, and the riskiest,
where the norms of the probability do not agree."""

CLAIMS = {
    "pc norms agree": "all norms of P_c order the five alike",
    "all find riskiest": "every norm of f finds the riskiest",
    "only H1 finds safest": "of the norms of f only H1 finds the safest",
    "all three": "all three at once, as in the paper",
}
"""What the paper found, section IV B."""


@dataclass(frozen=True)
class Share:
    """How often something holds, with its 95 % interval (Clopper and Pearson)."""

    count: int
    total: int
    low: float
    high: float

    @classmethod
    def of(cls, flags: Sequence[bool]) -> Share:
        """The share of those that are true."""
        count, total = sum(flags), len(flags)
        if total == 0:
            return cls(0, 0, 0.0, 1.0)
        interval = binomtest(count, total).proportion_ci(0.95, "exact")
        return cls(count, total, float(interval.low), float(interval.high))

    def __str__(self) -> str:
        if self.total == 0:
            return "none"
        share = 100.0 * self.count / self.total
        return f"{share:.0f} % [{100 * self.low:.0f}, {100 * self.high:.0f}]"


def claims(orders: Orders, pc_orders: Orders) -> dict[str, bool]:
    """Whether the paper's findings hold for five flights.

    Args:
        orders: by norms of the avoidance function.
        pc_orders: by norms of the probability of collision.
    """
    truth = list(pc_orders[REFERENCE])
    finders = [label for label, order in orders.items() if order[0] == truth[0]]
    found = {
        "pc norms agree": all(list(order) == truth for order in pc_orders.values()),
        "all find riskiest": all(order[-1] == truth[-1] for order in orders.values()),
        "only H1 finds safest": finders == ["H1"],
    }
    return {**found, "all three": all(found.values())}


def claims_with_ties(record: Mapping[str, Any]) -> dict[str, bool]:
    """The same for a record, where flights that a norm ties count in either order.

    Orders put the shorter of two tied flights first. Ties are common by L-infinity: flights that
    share their riskiest place have it to the last bit.
    """
    truth = record["pc orders"][REFERENCE]
    pc, f = (
        {label: [record[table][name][label] for name in truth] for label in record["orders"]}
        for table in ("pc norms", "norms")
    )
    finders = [label for label, values in f.items() if values[0] == min(values)]
    found = {
        "pc norms agree": all(values == sorted(values) for values in pc.values()),
        "all find riskiest": all(values[-1] == max(values) for values in f.values()),
        "only H1 finds safest": finders == ["H1"],
    }
    return {**found, "all three": all(found.values())}


def hits(records: Sequence[Mapping[str, Any]], end: int) -> dict[str, dict[str, Share]]:
    """How often each norm of f finds the safest (end 0) or riskiest (-1) of each norm of P_c."""
    labels = list(records[0]["orders"]) if records else []
    return {
        label: {
            pc: Share.of([r["orders"][label][end] == r["pc orders"][pc][end] for r in records])
            for pc in labels
        }
        for label in labels
    }
