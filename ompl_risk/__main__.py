"""`python -m ompl_risk`: the command line."""

import sys

from ompl_risk.cli import main

sys.exit(main())
