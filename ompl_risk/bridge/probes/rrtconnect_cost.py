"""RRTConnect with an objective written in Python."""

from ompl import geometric as og
from scene import report_motion_costs


def main():
    """RRTConnect looks for any path."""
    report_motion_costs(og.RRTConnect)


if __name__ == "__main__":
    main()
