"""Two runs of AORRTC in a Benchmark."""

from ompl import geometric as og
from ompl import tools as ot
from scene import reached, report, setup


def main():
    """AORRTC does not survive the clear() between the runs."""
    simple = setup()
    benchmark = ot.Benchmark(simple, "probe")
    benchmark.addPlanner(og.AORRTC(simple.getSpaceInformation()))
    reached()
    benchmark.benchmark(ot.Request(0.3, 4096.0, 2, 0.05, False, False, False))
    report(good=True, saw="completes both runs")


if __name__ == "__main__":
    main()
