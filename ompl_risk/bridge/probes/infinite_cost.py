"""RRTstar with an objective that forbids every motion."""

import math

from scene import report_constant_cost


def main():
    """A path of infinite cost is called a solution."""
    report_constant_cost(math.inf)


if __name__ == "__main__":
    main()
