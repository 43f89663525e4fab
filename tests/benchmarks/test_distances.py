"""Libraries of distances: agreement before time, and what becomes of those that are not there."""

import importlib
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import __main__ as command
from benchmarks import distances
from benchmarks.metric import Absent, figure
from benchmarks.peers import menu
from benchmarks.peers.ground import Ground, Single
from benchmarks.peers.menu import NotThereError, Offer
from benchmarks.peers.quadtree import QuadtreeGround
from benchmarks.registry import Benchmark
from benchmarks.scenes import above_ground
from ompl_risk import TerrainClearance, terrains
from ompl_risk.terrains import Terrain

ROUGH = Terrain(
    np.random.default_rng(5).normal(size=(23, 34)) * 2.0, spacing=(1.0, 1.5), origin=(-3.0, 40.0)
)


class Tree(Ground):
    """A peer that is right."""

    interface, threading = "one", "many"

    def __init__(self, terrain):
        self._tree = QuadtreeGround(terrain)

    def distances(self, points):
        return self._tree.distances(points)


class Off(Tree):
    """One that is wrong at one point."""

    def distances(self, points):
        d = super().distances(points)
        d[3] += 1e-5
        return d


class Nothing(Tree):
    """One that answers not-a-number."""

    def distances(self, points):
        return np.full(len(points), np.nan)


class Broken(Tree):
    """One whose interface has changed."""

    def distances(self, points):
        raise AttributeError("no such method")


@pytest.fixture(autouse=True)
def here(monkeypatch):
    """The peers above as a module."""
    kinds = {kind.__name__: kind for kind in (Tree, Off, Nothing, Broken)}
    monkeypatch.setitem(sys.modules, "peers_of_the_test", SimpleNamespace(**kinds))


def offer(kind, *packages):
    return Offer(kind.lower(), "peers_of_the_test", kind, packages or ("numpy",))


def measured(terrain_file, *offers):
    config = distances.Config(
        terrain=terrain_file, points=60, single_points=20, oracle_points=3, repeats=2
    )
    return list(distances.measure(config, 0, lambda _: None, offers))


def test_who_agrees_is_timed_in_one_thread_and_in_all(terrain_file):
    rows = measured(terrain_file, offer("Tree"))
    assert [row.name.split(":")[0] for row in rows] == [
        "our error against all triangles",
        f"tree {np.__version__}",
        "one thread, tree",
        "all threads, on the wall, tree",
    ]
    assert all(row.met is not False for row in rows)
    assert rows[1].value.median <= 1e-9
    assert all(row.advantage.median > 0.0 for row in rows[2:])
    assert "one" in rows[2].note
    assert "many" in rows[3].note


@pytest.mark.parametrize(("kind", "differing"), [("Off", 1), ("Nothing", 60)])
def test_who_computes_something_else_is_reported_and_not_timed(terrain_file, kind, differing):
    rows = measured(terrain_file, offer(kind))
    assert len(rows) == 2
    assert rows[1].met is False
    assert rows[1].failed is False  # theirs, not ours
    assert rows[1].note == f"differs at {differing} of 60 points, so it is not timed"


def test_who_is_not_there_is_told_with_the_way_to_get_it(terrain_file):
    missing = Offer("some", "benchmarks.peers.no_such_ground", "Some", ("no-such-package-at-all",))
    stale = Offer("other", "benchmarks.peers.no_such_ground", "Other", ("numpy",))
    _, *rows = measured(terrain_file, missing, stale, offer("Broken"))
    assert rows[0] == Absent("some", "not installed", "pip install no-such-package-at-all")
    assert rows[1].reason == "does not load"
    assert "no_such_ground" in rows[1].remedy
    assert rows[2] == Absent(
        f"broken {np.__version__}", "does not work", "AttributeError('no such method')"
    )


@pytest.mark.parametrize("chosen", menu.PEERS, ids=lambda each: each.name)
def test_each_peer_that_is_installed_answers_distances(chosen):
    if chosen.version is None:
        with pytest.raises(NotThereError, match=f"not installed: pip install {chosen.packages[0]}"):
            chosen.load()
        pytest.skip(f"{chosen.name} is not installed")
    ground = chosen.load()(ROUGH)
    points = above_ground(ROUGH, 300, np.random.default_rng(1), low=0.5, high=12.0)
    expected = ROUGH.surface().nearest.on_surface(points)[1]
    for answers in (ground.distances(points), ground.distances_threaded(points)):
        assert answers.dtype == np.float64
        assert answers == pytest.approx(expected, abs=ground.tolerance)
    assert ground.interface
    assert ground.threading


def test_single_precision_is_about_the_middle_of_the_map():
    class Rounded(Single):
        interface = threading = ""

        def distances(self, points):
            return TerrainClearance(self.terrain)(self.single(points) + self.middle)

    terrain = terrains.load("jacksboro")
    ground = Rounded(terrain)
    ground.terrain = terrain
    points = above_ground(terrain, 500, np.random.default_rng(2), low=20.0, high=100.0)
    off = np.abs(ground.distances(points) - TerrainClearance(terrain)(points)).max()
    assert 1e-5 < off < ground.tolerance < 0.01


def test_peers_is_a_command_of_its_own(monkeypatch, capsys):
    def measure(_config, seed, _say):
        yield figure("seed", seed, "")
        yield Absent("some", "not installed", "pip install some[all]")

    registry = {"fake": Benchmark(measure, Single, Single)}
    monkeypatch.setattr(command, "PEERS", registry)
    monkeypatch.setattr("benchmarks.running.asdict", lambda _: {})
    assert command.main(["peers", "--quick", "--seed", "7"]) == 0
    out = capsys.readouterr().out
    assert "seed" in out
    assert "some not installed: pip install some[all]" in out


def test_objectives_are_handed_on(monkeypatch):
    campaign = importlib.import_module("benchmarks.campaign.cli")
    monkeypatch.setattr(campaign, "main", len)
    assert command.main(["objectives", "--a", "b", "peers"]) == 3
