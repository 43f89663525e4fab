"""Portfolio: every safe planner a member, the same paths everywhere, a ranking of all."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ompl import base as ob
from ompl import geometric as og
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ompl_risk import Lp, Sobolev, rank
from ompl_risk.errors import ArgumentError, DurationWarning, PlanningError
from ompl_risk.planners import Candidate, Length, Status, Task, parse_criterion, solve_task
from ompl_risk.planners.candidate_ranking import rank_candidates
from ompl_risk.planners.menu import parse_task
from ompl_risk.planners.methods import ALIASES, METHODS, Heeds, method_of
from ompl_risk.planners.portfolio import Portfolio
from ompl_risk.planners.searching import best_path

BUDGETS = {"BITstar": 1500, "RRTstar": 400, "InformedRRTstar": 400, "SORRTstar": 300,
           "PRM": 500, "PRMstar": 500, "RiskRoadmap": 1000}  # fmt: skip
SAFE = [
    (name, criterion)
    for name, method in METHODS.items()
    for kind, criterion in (("length", "length"), ("risk", "H1@20"))
    if kind not in method.refused
] + [("RiskRoadmap", "length"), ("RiskRoadmap", "H1@20")]
NORMS = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))


class Raises(Length):
    """A criterion that fails."""

    def objective(self, si, problem):
        raise RuntimeError("no objective")


# --- planners written in Python, by their path "test_portfolio.NAME" ---------------------------


class Planned(ob.Planner):
    """Publishes a path through given corners."""

    def __init__(self, si, *, seed=1, iterations=1):
        super().__init__(si, type(self).__name__)
        self.seed, self.iterations = seed, iterations

    def corners(self, start, goal):
        raise NotImplementedError

    def solve(self, ptc):
        si, inputs = self.getSpaceInformation(), self.getPlannerInputStates()
        start, goal = (list(s[0:3]) for s in (inputs.nextStart(), inputs.nextGoal()))
        path = og.PathGeometric(si)
        for corner in self.corners(start, goal):
            state = si.allocState()
            state[0:3] = [float(x) for x in corner]
            path.append(state)
        self.getProblemDefinition().addSolutionPath(path, False, -1.0, self.getName())
        return ob.PlannerStatus(True, False)


class ByThePass(Planned):
    """Through the southern pass, or with an odd seed through the northern; high in the box."""

    def corners(self, start, goal):
        y = 1500.0 if self.seed % 2 else 500.0
        return [start, [1500.0, y, 190.0 + 1e-3 * self.iterations], goal]


class ThroughTheRidge(Planned):
    def corners(self, start, goal):
        return [start, goal]


class Elsewhere(Planned):
    def corners(self, start, goal):
        return [start, [start[0] + 1.0, *start[1:]]]


class AboveTheCeiling(Planned):
    def corners(self, start, goal):
        return [start, [1500.0, 1000.0, 500.0], goal]


class Asks(ob.Planner):
    """Asks whether to stop until told so, and finds nothing; takes no options."""

    def __init__(self, si):
        super().__init__(si, "Asks")

    def solve(self, ptc):
        while not ptc():
            pass
        return ob.PlannerStatus(False, False)


# --- members -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("planner", "criterion"), SAFE)
def test_every_safe_planner_gives_the_same_free_path_each_time(problem, planner, criterion):
    task = Task(planner, parse_criterion(criterion), 3, BUDGETS.get(planner, 0))
    first, second = solve_task(problem, task), solve_task(problem, task)
    assert first.status is Status.SOLVED, first.reason
    np.testing.assert_array_equal(first.positions, second.positions)
    np.testing.assert_array_equal(first.positions[[0, -1]], [problem.start, problem.goal])
    path = first.trajectory(problem.speed).densify(2.0)
    assert problem.clearance(path.positions).min() > problem.min_clearance - 1e-9
    assert (path.positions <= problem.high + 1e-9).all()
    assert (path.positions >= problem.low - 1e-9).all()
    assert first.iterations <= task.iterations
    assert not first.timed_out


@pytest.mark.parametrize("planner", ["PRMstar", "RRTConnect"])
def test_the_criterion_counts_though_the_planner_does_not_look_at_it(problem, planner):
    short, safe = (
        solve_task(problem, Task(planner, parse_criterion(c), 1, BUDGETS.get(planner, 0)))
        for c in ("length", "H1@40")
    )
    ranking = rank_candidates(problem, [short, safe], [Sobolev(1)])
    assert ranking.safest("H1") == safe.task.label


def test_what_a_planner_heeds_can_be_asked():
    assert parse_task("RRTConnect:H1@20").heeds is Heeds.NOTHING
    assert parse_task("FMT").heeds is Heeds.LENGTH
    assert parse_task("H1@20").heeds is Heeds.CRITERION


@pytest.mark.parametrize(
    ("member", "reason"),
    [
        ("AORRTC", "SIGSEGV"),
        ("AORRTC:H1@20", "SIGSEGV"),
        ("SORRTstar:length", "hangs for ever if the straight way is free"),
        ("SORRTstar", "hangs for ever"),
        ("FMT:H1@20", "no metric"),
        ("BFMT:L2@20", "no metric"),
        ("RRTsharp:length", "one of BITstar, RRTstar"),
        ("RRTsharp", "planner:criterion"),
        ("BITstar:H9000", "norm@clearance"),
        ("no.such.Planner", "installed planner"),
        ("ompl.base.Planner.X", "installed planner"),
        ("test_portfolio.Raises", "derived from ob.Planner"),
        (7, "a Task, or a text"),
    ],
)
def test_members_that_would_hang_or_crash_or_do_not_exist_are_refused(member, reason):
    with pytest.raises(ArgumentError, match=reason) as caught:
        Portfolio(["length", member])
    assert caught.value.argument == "members"


def test_a_task_refuses_them_too():
    with pytest.raises(ArgumentError, match="SIGSEGV"):
        Task("AORRTC", Length())
    with pytest.raises(ArgumentError, match="hangs for ever"):
        Task("SORRTstar", Length())


def test_members_are_read_and_multiplied_by_seeds():
    own = Task("RRTstar", Length(), 9)
    tasks = Portfolio([" length ", own, "RRTConnect", "KPIECE1:H1@20"], seeds=(1, 4)).tasks
    assert [task.label for task in tasks] == [
        "BITstar length seed 1", "RRTstar length seed 9", "RRTConnect length seed 1",
        "KPIECE1 H1@20 seed 1",
        "BITstar length seed 4", "RRTConnect length seed 4", "KPIECE1 H1@20 seed 4",
    ]  # fmt: skip
    assert tasks[1] is own
    assert Portfolio("length", effort=0.1, time_limit=5.0).tasks == (
        Task("BITstar", Length(), 1, 1500, 5.0),
    )


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("members", lambda: Portfolio([])),
        ("members", lambda: Portfolio(["length", "BITstar:length"])),
        ("members", lambda: Portfolio([Task("BITstar", Length(), 2)] * 2)),
        ("seeds", lambda: Portfolio(["length"], seeds=())),
        ("seed", lambda: Portfolio(["length"], seeds=(0,))),
        ("effort", lambda: Portfolio(["length"], effort=-1.0)),
        ("time_limit", lambda: Portfolio(["length"], time_limit=0.0)),
        ("time_limit", lambda: Portfolio(["length"], time_limit="long")),
        ("engine", lambda: Portfolio(["length"], engine="lucky")),
        ("workers", lambda: Portfolio(["length"], workers=0)),
    ],
)
def test_wrong_portfolios_are_refused(argument, make):
    with pytest.raises(ArgumentError) as caught:
        make()
    assert caught.value.argument == argument


# --- planners written in Python ----------------------------------------------------------------


def test_a_planner_written_in_python_is_named_by_its_path_or_class(problem):
    name = "test_portfolio.ByThePass"
    south, north = (solve_task(problem, Task(name, Length(), seed)) for seed in (2, 3))
    assert south.solved
    assert north.solved
    assert south.positions[:, 1].min() < 700.0
    assert north.positions[:, 1].max() > 1300.0
    assert south.task.label == "ByThePass length seed 2"
    assert Task(ByThePass, Length()) == Task(name, Length())
    assert Task(og.RRTConnect, Length()) == Task("RRTConnect", Length())
    assert method_of(name).counts_itself
    for short in ALIASES:
        assert method_of(short).name.endswith(short)


def test_one_that_does_not_count_is_told_to_stop(problem):
    found = solve_task(problem, Task("test_portfolio.Asks", Length(), 1, 123))
    assert found.status is Status.NO_PATH
    assert found.iterations == 123


@pytest.mark.parametrize(
    ("planner", "fault"),
    [
        (ThroughTheRidge, "is not free"),
        (Elsewhere, "does not lead from the start to the goal"),
        (AboveTheCeiling, "leaves the box"),
    ],
)
def test_no_planner_is_believed(problem, planner, fault):
    found = solve_task(problem, Task(planner, Length()))
    assert found.status is Status.NO_PATH
    assert fault in found.reason


def test_classes_that_no_worker_could_import_are_refused():
    class Inner(Planned):
        pass

    with pytest.raises(ArgumentError, match="other processes can import"):
        Task(Inner, Length())


# --- the search of a grown roadmap -------------------------------------------------------------


class Graph:
    """Plays OMPL's PlannerData."""

    def __init__(self, places, edges, ends):
        self.places, self.edges, self.ends = places, edges, ends

    def numVertices(self):
        return len(self.places)

    def numStartVertices(self):
        return 1

    numGoalVertices = numStartVertices

    def getVertex(self, v):
        return self

    def getState(self):
        self.read = getattr(self, "read", itertools.count())
        return list(self.places[next(self.read)])

    def getEdges(self, v):
        return [w for e in self.edges if v in e for w in e if w != v]

    def getStartIndex(self, _):
        return self.ends[0]

    def getGoalIndex(self, _):
        return self.ends[1]


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_the_roadmap_is_searched_for_the_shortest_path(problem, data):
    n = data.draw(st.integers(2, 9))
    pairs = list(itertools.combinations(range(n), 2))
    edges = data.draw(st.sets(st.sampled_from(pairs)))
    start, goal = data.draw(st.sampled_from(pairs))
    numbers = st.integers(0, 100).map(float)
    places = data.draw(
        st.lists(st.tuples(numbers, numbers, numbers), min_size=n, max_size=n, unique=True)
    )
    places = np.array(places)
    found = best_path(Graph(places, edges, (start, goal)), problem, Task("PRM", Length()))
    weights = np.zeros((n, n))
    for v, w in edges:
        weights[v, w] = np.linalg.norm(places[v] - places[w])
    least = dijkstra(csr_array(weights), directed=False, indices=start)[goal]
    if not math.isfinite(least):
        assert found is None
        return
    np.testing.assert_array_equal(found[[0, -1]], places[[start, goal]])
    assert np.linalg.norm(np.diff(found, axis=0), axis=1).sum() == pytest.approx(least)
    index = {tuple(p): k for k, p in enumerate(places)}
    steps = [
        tuple(sorted((index[tuple(a)], index[tuple(b)]))) for a, b in itertools.pairwise(found)
    ]
    assert set(steps) <= edges


# --- solving and ranking -----------------------------------------------------------------------


MEMBERS = ["length", "H1@20", "RRTConnect", "PRMstar:L1@20"]


def test_one_process_and_two_find_the_same(problem):
    here, there = (
        Portfolio(MEMBERS, seeds=(1, 2), effort=0.1, workers=workers).solve(problem)
        for workers in (1, 2)
    )
    for a, b in zip(here, there, strict=True):
        assert a.solved
        assert a.task == b.task
        assert (a.iterations, a.length) == (b.iterations, b.length)
        np.testing.assert_array_equal(a.positions, b.positions)
        assert 0.0 < b.seconds < 60.0


def test_the_ranking_is_that_by_hand_and_reports_who_found_nothing(problem):
    members = [*MEMBERS, Task("BITstar", Raises(), 5), Task("RRT", Length(), 2, 1)]
    portfolio = Portfolio(members, effort=0.1, workers=1)
    arrived = []
    ranking = portfolio.rank(problem, NORMS, on_done=arrived.append, duration_tolerance=0.2)
    assert tuple(arrived) == portfolio.arrived == ranking.candidates
    assert [c.task for c in ranking.candidates] == list(portfolio.tasks)
    by_hand = rank(
        [c.trajectory(problem.speed) for c in arrived[:4]],
        problem.clearance,
        problem.avoidance,
        NORMS,
        duration_tolerance=0.2,
    )
    assert ranking.orders == by_hand.orders
    assert [a.norms for a in ranking.assessments] == [a.norms for a in by_hand.assessments]
    assert ranking.duration_tolerance == 0.2
    assert ranking.by_name["BITstar H1@20 seed 1"] is arrived[1]
    failed, lost = ranking.unsolved
    assert (failed.status, lost.status) == (Status.FAILED, Status.NO_PATH)
    assert ranking.summary == (
        "4 of 6 tasks found a path; BITstar length seed 5: failed, RuntimeError: no objective; "
        "RRT length seed 2: no path found, no path in 1 iterations"
    )


def test_durations_that_differ_are_told(problem):
    found = [straight(1.0), straight(2.0)]
    with pytest.warns(DurationWarning):
        rank_candidates(problem, found)


def straight(factor, seed=1, iterations=10):
    """A path of some length high above the ground."""
    positions = np.array([[0.0, 0.0, 190.0], [0.0, 1000.0 * factor, 190.0]])
    task = Task("BITstar", Length(), seed, iterations)
    return Candidate(task, Status.SOLVED, positions, 1000.0 * factor)


def test_tasks_of_one_label_are_told_apart(problem):
    found = [straight(1.0, 1, k) for k in (10, 20, 30)] + [straight(1.0, 12)]
    ranking = rank_candidates(problem, found)
    assert list(ranking.by_name.items()) == [
        ("BITstar length seed 1", found[0]),
        ("BITstar length seed 1 #2", found[1]),
        ("BITstar length seed 1 #3", found[2]),
        ("BITstar length seed 12", found[3]),
    ]


def test_a_portfolio_that_finds_nothing_says_what_became_of_each(problem):
    with pytest.raises(PlanningError, match=r"0 of 1 tasks .* failed, RuntimeError: no objective"):
        Portfolio([Task("BITstar", Raises())], workers=1).rank(problem)


def test_what_came_in_before_an_interruption_is_kept(problem):
    def stop(candidate):
        raise KeyboardInterrupt

    portfolio = Portfolio(["length"], seeds=(1, 2), effort=0.1, workers=1)
    with pytest.raises(KeyboardInterrupt):
        portfolio.solve(problem, on_done=stop)
    assert [c.task.seed for c in portfolio.arrived] == [1]
    assert portfolio.arrived[0].solved


def test_the_time_for_all_is_kept(problem):
    portfolio = Portfolio([Task("BITstar", Length(), seed, 10**9) for seed in (1, 2)], workers=1)
    ranking = portfolio.rank(problem, total_time=0.3)
    assert len(ranking.assessments) == 1
    assert ranking.unsolved[0].status is Status.NOT_STARTED


def test_a_criterion_that_the_problem_has_no_use_for_is_refused_before_anything_runs(problem):
    portfolio = Portfolio(["length", "H1@90"], workers=1)
    arrived = []
    with pytest.raises(ArgumentError, match="below d0 = 80"):
        portfolio.solve(problem, on_done=arrived.append)
    assert arrived == []
