"""RRTstar with an objective whose costs are NaN."""

import math

from scene import report_constant_cost


def main():
    """Comparisons with NaN are false, so nothing stops it."""
    report_constant_cost(math.nan)


if __name__ == "__main__":
    main()
