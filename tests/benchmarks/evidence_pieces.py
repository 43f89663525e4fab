"""Work that is quick and easily checked, and what goes wrong there; quick to import."""

import os
import signal
import time


def one_code():
    """The same everywhere, also while somebody edits the code."""
    return "c0de"


def square(unit):
    """Work that is easily checked, and says where it was done."""
    return unit * unit, os.getpid()


def noted(folder, unit, deaths=1):
    """Notes in the folder that it was done; unit 1 kills its process the first times."""
    (folder / f"{unit}.{time.monotonic_ns()}").touch()
    if unit == 1 and len(list(folder.glob("1.*"))) <= deaths:
        os.kill(os.getpid(), signal.SIGKILL)
    return square(unit)


def deadly(unit):
    """Unit 1 kills its process, unit 2 raises."""
    if unit == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    if unit == 2:
        raise RuntimeError("no wind")
    return square(unit)
