"""What the tests of the campaign let worker processes do instead of planning."""

import os
import signal
import time

PIDS = []


def answer(run):
    """The seed and the process."""
    PIDS.append(os.getpid())
    return {"status": "solved", "seed": run.seed, "pid": os.getpid(), "calls": len(PIDS)}


def misbehave(run):
    """Seed 1 answers, 2 raises, 3 dies, 4 hangs, 5 answers."""
    if run.seed == 2:
        raise ValueError("no such thing\nand more")
    if run.seed == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    if run.seed == 4:
        time.sleep(600.0)
    return answer(run)


def sigint_is_blocked(run):
    """Whether Ctrl-C on the terminal reaches a worker."""
    return {"status": "solved", "blocked": signal.SIGINT in signal.pthread_sigmask(0, [])}


def record(seed=1, scene="circles", objective="H1", planner="RRTstar", **result):
    """A record as the store would hold it, of a run that found a path; or as `result` says."""
    from benchmarks.campaign.metrics import BOUNDS, METRICS
    from benchmarks.campaign.objectives import OBJECTIVES
    from benchmarks.campaign.run import prepared

    numbers = dict.fromkeys((*METRICS, *BOUNDS), 0.5)
    return {
        "key": f"{scene}{objective}{planner}{seed}",
        "configuration": {
            "scene": scene,
            "objective": objective,
            "planner": planner,
            "seed": seed,
            "seconds": 2.0,
            "objective recipe": OBJECTIVES[objective].recipe(prepared(scene).problem),
        },
        "code": "abc",
        "finished": "2026-01-01T00:00:00+00:00",
        "result": {
            "status": "solved",
            "reason": "",
            "seconds": 2.0,
            "wall seconds": 2.0,
            "memory": 100.0,
            "cost": 0.25,
            "length": 140.0,
            "metrics": numbers,
            "curve": [[0.5, 4.0], [1.5, 0.25]],
            "path": [],
        }
        | result,
    }
