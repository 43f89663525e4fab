"""``python -m benchmarks.campaign``: the same as ``python -m benchmarks objectives``."""

import sys

from benchmarks.campaign.cli import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
