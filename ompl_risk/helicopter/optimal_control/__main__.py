"""`python -m ompl_risk.helicopter.optimal_control`."""

import sys

from ompl_risk.helicopter.optimal_control.command import main

sys.exit(main())
