"""Guards are put in place and taken away again without a trace."""

import pytest
from guard_scene import run
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og
from ompl import tools as ot

from ompl_risk.bridge import guards

pytestmark = pytest.mark.usefixtures("guards_in_place")

GUARDED = [
    (og.SimpleSetup, "solve"),
    (oc.SimpleSetup, "solve"),
    (ob.Planner, "solve"),
    (og.PRM, "solve"),
    (og.RRTstar, "solve"),
    (oc.RRT, "solve"),
    (og.SimpleSetup, "simplifySolution"),
    (ob.PlannerTerminationCondition, "__init__"),
    (ot.Benchmark, "benchmark"),
]


def current():
    return [vars(owner)[name] for owner, name in GUARDED]


def test_install_and_remove_are_idempotent_and_exact():
    guarded_methods = current()
    assert guards.install()
    assert current() == guarded_methods
    guards.remove()
    originals = current()
    assert not guards.installed()
    assert {type(method).__name__ for method in originals} == {"nb_method"}
    guards.remove()
    assert current() == originals
    assert guards.install()
    assert all(m.__wrapped__ is o for m, o in zip(current(), originals, strict=True))


def test_every_class_with_a_solve_of_its_own_is_guarded():
    for module in (og, oc):
        for owner in vars(module).values():
            if isinstance(owner, type) and "solve" in vars(owner):
                assert hasattr(vars(owner)["solve"], "__wrapped__"), owner


def test_documentation_is_ompls():
    documented = og.SimpleSetup.solve.__doc__
    guards.remove()
    assert documented == og.SimpleSetup.solve.__doc__
    assert "time: float = 1.0" in documented


def test_somebody_elses_patch_survives_removal():
    ours = vars(og.SimpleSetup)["solve"]

    def theirs(self, *args):
        return ours(self, *args)

    original = ours.__wrapped__
    try:
        og.SimpleSetup.solve = theirs
        guards.remove()
        assert vars(og.SimpleSetup)["solve"] is theirs
    finally:
        og.SimpleSetup.solve = original


def test_the_environment_forbids_the_guards(monkeypatch):
    guards.remove()
    monkeypatch.setenv(guards.SWITCH, "0")
    assert guards.install() is False
    assert type(vars(og.SimpleSetup)["solve"]).__name__ == "nb_method"
    monkeypatch.setenv(guards.SWITCH, "1")
    assert guards.install() is True


def test_nothing_leaks_at_exit():
    """nanobind lists what outlives the interpreter; guarded classes and objects must not."""
    body = """
    go()
    simple = setup(RiskyLength, is_free, og.RRTstar)
    simple.solve(0.05)
    simple.solve(ob.PlannerTerminationCondition(lambda: True))
    bench = ot.Benchmark(simple, "test")
    bench.addPlanner(og.RRTstar(simple.getSpaceInformation()))
    bench.setPreRunEvent(lambda planner: None)
    bench.benchmark(ot.Request(0.05, 4096.0, 2, 0.05, False, False, False))
    try:
        setup(Length, is_free, og.PRM).solve(0.1)
    except TrapError:
        print("refused")
    """
    ending, lines, errors = run(body)
    assert (ending, lines) == ("ends", ["refused"])
    assert "leaked" not in errors
