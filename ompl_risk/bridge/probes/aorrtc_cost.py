"""AORRTC with an objective written in Python."""

from ompl import geometric as og
from scene import report_motion_costs


def main():
    """AORRTC minimises the length, whatever the objective."""
    report_motion_costs(og.AORRTC)


if __name__ == "__main__":
    main()
