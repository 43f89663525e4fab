"""An exception in a validity checker while PRM solves."""

import itertools

from ompl import geometric as og
from scene import is_free, reached, report, setup


def main():
    """The exception unwinds a frame that owns a running C++ thread."""
    calls = itertools.count()

    def checker(state):
        if next(calls) > 200:
            raise ValueError("from a callback")
        return is_free(state)

    simple = setup(checker=checker)
    simple.setPlanner(og.PRM(simple.getSpaceInformation()))
    reached()
    try:
        simple.solve(0.5)
    except ValueError as error:
        report(good=True, saw=f"raises ValueError: {error}")
    else:
        report(good=False, saw="the exception is lost")


if __name__ == "__main__":
    main()
