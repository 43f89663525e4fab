"""One pair in pictures: the paper's figures 4 and 5, and its table."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from benchmarks.scenario import procedure
from benchmarks.scenario.findings import CLAIMS, claims
from ompl_risk.cli.settings import PLACES
from ompl_risk.report import flight_views, ranking_figure

SEED = 1


def draw_example(folder: Path, out: Console, *, places: int = procedure.PLACES) -> None:
    """Fly the default pair of ``ompl-risk plan``, judge it as all the others, and draw it.

    Args:
        folder: where to.
        out: gets the ranking, and whether the findings hold.
        places: of the roadmap.
    """
    ends = procedure.Pair(**PLACES["jacksboro"])
    flights = procedure.flights(ends, SEED, places=places, threads=None)
    if len(flights) < procedure.FLIGHTS:
        out.print(f"no figures 4 and 5: {len(flights)} flights with {places} places")
        return
    judgement = procedure.judged(flights)
    ranking, terrain = judgement.ranking, procedure.scene().terrain
    out.print(ranking)
    found = claims(ranking.orders, ranking.pc_orders)
    for name, words in CLAIMS.items():
        out.print(f"{'holds' if found[name] else 'does not hold'}: {words}", markup=False)
    ceiling = float(procedure.problem(ends).high[2])
    title = "Jacksboro: five helicopter flights of equal time"
    ranking_figure(
        ranking,
        judgement.profiles,
        terrain,
        ceiling=ceiling,
        title=title,
        path=folder / "figure5.png",
    )
    trajectories = [assessment.trajectory for assessment in ranking.assessments]
    flight_views(trajectories, terrain, title=title, path=folder / "figure4.png")
    out.print(f"in {folder}: figure4.png, figure5.png", markup=False, soft_wrap=True)
