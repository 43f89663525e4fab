"""A validity checker that returns numpy.bool_, as every comparison of numpy numbers does."""

import numpy as np
from scene import reached, report, setup


def main():
    """Only Python's own bool is converted."""
    simple = setup(checker=lambda state: np.float64(state[0]) < 2.0)
    information = simple.getSpaceInformation()
    reached()
    try:
        valid = information.isValid(information.allocState())
    except RuntimeError as error:
        report(good=False, saw=f"RuntimeError: {error}")
    else:
        report(good=valid, saw=f"understood as {valid}")


if __name__ == "__main__":
    main()
