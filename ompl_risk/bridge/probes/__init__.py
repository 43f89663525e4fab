"""What is tried on the installed OMPL: one small script a trap, and what is done about each.

The scripts are run, never imported: they show raw OMPL, some of them hang or crash, and each can
be handed to an OMPL developer as it is (with ``scene.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Probe:
    """A script and what its finding means.

    Attributes:
        script: file name without ``.py``.
        subject: what is tried, in a few words.
        handling: what ompl_risk does about it, or needs it for.
        assumption: True if ompl_risk relies on it; False if it is a trap.
    """

    script: str
    subject: str
    handling: str
    assumption: bool = False

    @property
    def path(self) -> Path:
        """The script."""
        return Path(__file__).parent / f"{self.script}.py"


IMPORT = Probe("can_import", "import ompl", "everything in ompl_risk.bridge", assumption=True)

TRAPS: tuple[Probe, ...] = (
    Probe(
        "prm_objective",
        "PRM, PRMstar with a Python objective",
        "solve() raises TrapError",
    ),
    Probe(
        "prm_goals",
        "PRM, PRMstar with several goals and a Python checker",
        "solve() raises TrapError",
    ),
    Probe(
        "prm_exception",
        "exception or Ctrl-C in a callback of PRM",
        "the clearance checker and RiskObjective defer it; solve() raises it at the end",
    ),
    Probe(
        "benchmark_exception",
        "exception or Ctrl-C in a callback under Benchmark",
        "the same; benchmark() ends after the current run",
    ),
    Probe(
        "benchmark_runs",
        "Benchmark with several runs of AORRTC",
        "benchmark() raises TrapError",
    ),
    Probe(
        "fmt_cost",
        "FMT, BFMT with a cost that is no metric",
        "TrapError with a RiskObjective, TrapWarning with another Python objective",
    ),
    Probe(
        "aorrtc_cost",
        "AORRTC and the objective",
        "TrapError with a RiskObjective, TrapWarning with another Python objective",
    ),
    Probe(
        "sorrt_straight",
        "SORRTstar minimising length on a free straight way",
        "TrapWarning; with a RiskObjective it was not seen to hang",
    ),
    Probe(
        "rrtconnect_cost",
        "RRT, RRTConnect, KPIECE and the objective",
        "TrapWarning with a RiskObjective, in control planning too; rank several paths",
    ),
    Probe(
        "integral_override",
        "subclass of StateCostIntegralObjective",
        "solve() raises TrapError; RiskObjective derives from OptimizationObjective",
    ),
    Probe(
        "nan_cost",
        "objective that returns NaN",
        "RiskObjective returns inf instead; solve() warns of a path without finite cost",
    ),
    Probe(
        "infinite_cost",
        "objective that forbids every motion",
        "solve() warns of a path without finite cost",
    ),
    Probe(
        "simplify_cost",
        "simplifySolution() after planning with a risk",
        "TrapError with a RiskObjective; an og.PathSimplifier by itself is not seen",
    ),
    Probe(
        "periodic_condition",
        "PlannerTerminationCondition(fn, period)",
        "its constructor raises TrapError; seconds and fn without a period are safe",
    ),
    Probe(
        "lazy_goal",
        "GoalLazySamples with a Python sampler",
        "TrapWarning while it has no samples; use GoalStates",
    ),
    Probe(
        "numpy_bool",
        "checker that returns numpy.bool_",
        "ClearanceValidityChecker returns bool; in a checker of your own write bool(...)",
    ),
    Probe(
        "planner_data",
        "Python planner that overrides getPlannerData",
        "the planners of ompl_risk do not; nor should yours",
    ),
    Probe(
        "control_sst",
        "oc.SST, the optimising control planner",
        "rank the paths of several oc.RRT, EST or KPIECE1 runs",
    ),
    Probe(
        "control_path_cost",
        "PathControl.cost(objective)",
        "not used: norms are computed from Trajectory.from_path(path)",
    ),
    Probe(
        "get_solutions",
        "ProblemDefinition.getSolutions()",
        "not used: rankings are kept in Python, the safest is published first",
    ),
    Probe(
        "copy_from_reals",
        "copyFromReals before the space is set up",
        "not used: states are written through deserialize",
    ),
)

ASSUMPTIONS: tuple[Probe, ...] = (
    Probe(
        "serialize_capsule",
        "serialize and deserialize into numpy buffers",
        "checker, validator and objective read states this way",
        assumption=True,
    ),
    Probe(
        "objective_identity",
        "OMPL's classes can be patched; objects keep their identity",
        "the guards around solve()",
        assumption=True,
    ),
    Probe(
        "terminate_from_callback",
        "a callback can terminate the planner",
        "exceptions and Ctrl-C are deferred this way",
        assumption=True,
    ),
)
