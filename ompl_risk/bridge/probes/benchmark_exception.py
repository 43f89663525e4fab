"""An exception in a validity checker while a Benchmark runs RRTstar."""

from ompl import geometric as og
from ompl import tools as ot
from scene import is_free, reached, report, setup


def main():
    """The benchmark owns a C++ thread that records the planner's progress."""
    running = []

    def checker(state):
        if running:
            raise ValueError("from a callback")
        return is_free(state)

    simple = setup(checker=checker)
    benchmark = ot.Benchmark(simple, "probe")
    benchmark.addPlanner(og.RRTstar(simple.getSpaceInformation()))
    benchmark.setPreRunEvent(running.append)
    reached()
    try:
        benchmark.benchmark(ot.Request(0.3, 4096.0, 1, 0.05, False, False, False))
    except ValueError as error:
        report(good=True, saw=f"raises ValueError: {error}")
    else:
        report(good=False, saw="the exception is lost")


if __name__ == "__main__":
    main()
