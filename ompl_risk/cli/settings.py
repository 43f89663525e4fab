"""The parameters of the commands: their names, defaults and meaning, each once.

Every field is an option of the command line and a key of the configuration file.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from ompl_risk.planners.menu import SEARCHES


def _whole(_type: Any, tokens: Any) -> int:
    """A whole number: the parser's own conversion would round 2.5."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f'"{tokens[0].value}" is no whole number.') from None


Whole = Annotated[int, Parameter(converter=_whole)]


@dataclass(frozen=True, kw_only=True)
class JudgeSettings:
    """How trajectories are judged.

    Args:
        bounds: read only the posts that cover xmin ymin xmax ymax, in the file's coordinates.
        fill: what to do about posts without a height; refused if left out.
        crs: coordinate reference system of a file that states none, such as EPSG:32616.
        terrain_seed: seed of a parametric terrain.
        radius: radius of the vehicle's sphere [m].
        avoidance: how dangerous a distance d is: inverse, the paper's 1/d - 1/d0; cap, the share of
            a ball of radius d0 below flat ground; tail(12), the probability that a normal error
            of 12 m exceeds d.
        d0: distance from which obstacles pose no danger [m], for inverse and cap.
        uncertainty: radius r of the ball in which the vehicle may really be [m].
        norms: norms to rank by: L1, L2, any Lp, Linf, H1, H1(0.5) with a time scale [s].
        duration_tolerance: relative spread of durations within which norms compare.
        rollouts: also fly each path so often in wind, navigation and terrain error, and rank by how
            often it collides.
        disturbances: how strong wind, navigation and terrain error are.
        output: folder for the results, new or empty; runs/TIME if left out.
    """

    bounds: tuple[float, float, float, float] | None = None
    fill: Literal["interpolate"] | None = None
    crs: str | None = None
    terrain_seed: Whole | None = None
    radius: float = 5.0
    avoidance: str = "inverse"
    d0: float = 100.0
    uncertainty: float = 100.0
    norms: tuple[str, ...] = ("L1", "L2", "Linf", "H1")
    duration_tolerance: float = 0.05
    rollouts: Whole | None = None
    disturbances: Literal["calm", "moderate", "severe"] = "moderate"
    output: Path | None = None


@dataclass(frozen=True, kw_only=True)
class PlanSettings(JudgeSettings):
    """What is planned, and how.

    Args:
        terrain: a name of the catalogue (jacksboro, hills, ridge_valley, canyon, fractal), or a
            GeoTIFF, ESRI ASCII grid, SRTM .hgt or NPZ file.
        start: x y of the start in the terrain's metres [m].
        goal: x y of the goal [m].
        start_height: height of the start above the ground [m].
        goal_height: height of the goal above the ground [m].
        ceiling: altitude that no path exceeds [m]; 320 m above the higher of start and goal if
            left out. Without a ceiling paths would climb out of all risk.
        min_clearance: least clearance that a path may have [m].
        margin: how far paths may leave the rectangle of start and goal, in distances between them.
        vehicle: point, which flies straight legs at constant speed; or helicopter, which flies
            trajectory primitives, at up to 30.6 m/s, from hover to hover.
        speed: constant speed of the point [m/s].
        planner: roadmap; portfolio, which runs the searches by the planners that they name; or a
            planner of OMPL that runs them all, such as rrtstar or bitstar.
        count: number of paths to find and rank, also called --alternatives.
        separation: least Frechet distance between two chosen paths, in distances from start to
            goal; those of the roadmap that pass summits on different sides may be nearer.
        samples: places that the roadmap samples; 30,000 for the point and 3,000 for the
            helicopter, whose roadmap has a vertex for every cruise speed at each, if left out.
        roadmap_norm: norm that the roadmap counts risk by: L1, L2, any Lp, Linf, H1.
        pareto: also find all paths of the roadmap that no other undercuts in duration and risk.
        max_collision_probability: also find the fastest path, of the alternatives and of the
            roadmap's Pareto set, whose probability of collision in these disturbances is for sure
            (95 %) no greater than this; 1e-5 at least, and some 7 / P rollouts a path.
        animation: also write a film of the helicopter's safest flight by the last norm: the minute
            around the place where it is nearest to the ground on its way. mp4 needs ffmpeg.
        searches: criteria that planners of OMPL plan by, each "length" or norm@clearance such as
            H1@20, where a second of flight costs as much as a second at that clearance [m];
            "planner:criterion" for another planner than BITstar.
        runs: how often each search is run, each time with another seed.
        effort: factor on the iterations of the planners.
        seed: of the first run; the others count up from it.
        workers: number of worker processes, or threads of the roadmap; all processors if left out.
        time_limit: most seconds for a run [s]; whatever is cut short is not reproducible.
    """

    terrain: str = "jacksboro"
    start: tuple[float, float] | None = None
    goal: tuple[float, float] | None = None
    start_height: float = 60.0
    goal_height: float = 60.0
    ceiling: float | None = None
    min_clearance: float = 20.0
    margin: float = 0.15
    vehicle: Literal["point", "helicopter"] = "point"
    speed: float = 30.0
    planner: str = "roadmap"
    count: Annotated[Whole, Parameter(name=("--count", "--alternatives"))] = 5
    separation: float = 0.02
    samples: Whole | None = None
    roadmap_norm: str = "H1"
    pareto: bool = False
    max_collision_probability: float | None = None
    animation: Literal["gif", "mp4"] | None = None
    searches: tuple[str, ...] = SEARCHES
    runs: Whole = 2
    effort: float = 1.0
    seed: Whole = 1
    workers: Whole | None = None
    time_limit: float = 20.0


PLACES = {"jacksboro": {"start": (6500.0, 16000.0), "goal": (20700.0, 11000.0)}}
"""Start and goal where none are given: 15 km apart, with a block of summits between them that paths
of nearly the same length pass on either side."""
