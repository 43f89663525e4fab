import gc
import signal
import threading
import time
import weakref

import pytest
from guard_scene import run, start

from ompl_risk.bridge import faults


class Broken(Exception):
    pass


def test_outside_of_a_call_into_ompl_nothing_is_kept():
    assert faults.keep(Broken()) is False


def test_leaving_raises_the_very_exception():
    error = Broken("first")
    with pytest.raises(Broken) as caught, faults.deferred():
        assert faults.keep(error) is True
    assert caught.value is error
    assert faults.keep(Broken()) is False


def test_the_first_exception_wins_and_stops_ompl_once():
    stops = []

    def ompl():
        with faults.deferred(lambda: stops.append(None)):
            assert faults.keep(Broken("first"))
            assert faults.keep(Broken("second"))

    with pytest.raises(Broken, match="first"):
        ompl()
    assert len(stops) == 1


def test_nothing_kept_nothing_raised():
    stops = []
    with faults.deferred(lambda: stops.append(None)):
        pass
    assert not stops


@pytest.mark.parametrize("error", [KeyboardInterrupt(), SystemExit(3), GeneratorExit()])
def test_any_exception_is_kept(error):
    with pytest.raises(type(error)) as caught, faults.deferred():
        faults.keep(error)
    assert caught.value is error


def test_the_innermost_call_keeps_the_exception():
    with faults.deferred():
        with pytest.raises(Broken), faults.deferred():
            faults.keep(Broken())
        with pytest.raises(KeyError), faults.deferred():
            faults.keep(KeyError("outer still open"))


def test_an_error_of_ompl_itself_becomes_the_context():
    def ompl():
        with faults.deferred():
            faults.keep(Broken())
            raise RuntimeError("what C++ made of it")

    with pytest.raises(Broken) as caught:
        ompl()
    assert isinstance(caught.value.__context__, RuntimeError)


def test_an_error_of_ompl_alone_passes():
    with pytest.raises(RuntimeError, match="its own"), faults.deferred():
        raise RuntimeError("its own")
    assert faults.keep(Broken()) is False


def test_release_raises_once():
    with faults.deferred() as deferral:
        faults.keep(Broken())
        with pytest.raises(Broken):
            deferral.release()


def test_threads_do_not_see_each_other():
    kept = []
    with faults.deferred():
        thread = threading.Thread(target=lambda: kept.append(faults.keep(Broken())))
        thread.start()
        thread.join()
    assert kept == [False]


def test_the_exception_is_freed_without_the_garbage_collector():
    gc.disable()
    try:
        error = Broken()
        alive = weakref.ref(error)
        try:
            with faults.deferred():
                faults.keep(error)
        except Broken:
            del error
        assert alive() is None
    finally:
        gc.enable()


def test_a_kept_exception_holds_no_variables_of_its_callbacks():
    """What they hold belongs to the planner; see the next test for what comes of it."""

    class State:
        pass

    def inner(state):
        raise Broken from KeyError(state)

    def callback(state):
        try:
            inner(state)
        except Broken as error:
            error.__cause__ = None
            faults.keep(error)

    state = State()
    alive = weakref.ref(state)
    with pytest.raises(Broken) as caught, faults.deferred():
        callback(state)
    del state
    gc.collect()
    assert caught.value.__traceback__ is not None
    assert alive() is None


def test_states_of_a_failed_solve_do_not_come_back():
    """Tracebacks that are kept must not make new states look like the planner's freed ones."""
    ending, lines, errors = run(
        """
        go()
        kept = []
        for _ in range(200):
            simple = setup(ob.PathLengthOptimizationObjective, FailingChecker, og.PRM)
            simple.setup()
            try:
                simple.solve(20.0)
            except ValueError as error:
                kept.append(error)
        print(len(kept))
        """,
        limit=20.0,
    )
    assert (ending, lines) == ("ends", ["200"]), errors


RAISING = """
go()
for planner, limit in {cases}:
    simple = setup(ob.PathLengthOptimizationObjective, is_free, planner)
    information = simple.getSpaceInformation()
    simple.setStateValidityChecker(FailingChecker(information))
    simple.setup()
    try:
        simple.solve(limit)
    except ValueError as error:
        print("caught", error)
"""
PLANNERS = "[(p, 60.0) for p in (og.PRM, og.PRMstar, og.RRTstar, og.BITstar, og.RRTConnect)]"
LIMITS = "[(og.PRM, limit) for limit in (60, ob.timedPlannerTerminationCondition(60.0))]"


@pytest.mark.parametrize(("cases", "number"), [(PLANNERS, 5), (LIMITS, 2)])
def test_an_exception_of_a_callback_ends_every_planner_at_once(cases, number):
    ending, lines, errors = run(RAISING.format(cases=cases), limit=10.0)
    assert (ending, lines) == ("ends", ["caught boom"] * number), errors


def test_without_guards_the_same_exception_aborts_prm():
    body = RAISING.format(cases="[(og.PRM, 60.0)]")
    assert run(body, guarded=False)[0] == f"code {-signal.SIGABRT}"


def interrupt(body, **options):
    """Run a script, send it SIGINT 0.3 s after ``go``, and again if ``twice``."""
    twice = options.pop("twice", False)
    process = start(body, **options)
    assert process.stdout is not None
    assert process.stdout.readline() == "go\n"
    for _ in range(2 if twice else 1):
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=30)
    return process.returncode, output.splitlines(), errors


INTERRUPTED = """
simple = setup(ob.PathLengthOptimizationObjective, is_free, og.PRM)
simple.setup()
go()
try:
    simple.solve(30.0)
except KeyboardInterrupt:
    print("interrupted", signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""


def test_ctrl_c_ends_prm_even_with_a_plain_function_as_checker():
    code, lines, errors = interrupt(INTERRUPTED)
    assert (code, lines) == (0, ["interrupted True"]), errors


def test_without_guards_ctrl_c_aborts_prm():
    assert interrupt(INTERRUPTED, guarded=False)[0] == -signal.SIGABRT


def test_a_handler_of_the_users_is_called_and_may_end_the_solve():
    body = INTERRUPTED.replace("except KeyboardInterrupt", "except TimeoutError").replace(
        "go()\n",
        "def handler(number, frame):\n    raise TimeoutError(number)\n"
        "signal.signal(signal.SIGINT, handler)\ngo()\n",
    )
    code, lines, errors = interrupt(body)
    assert (code, lines) == (0, ["interrupted False"]), errors


def test_a_second_ctrl_c_acts_at_once():
    body = """
    go()
    try:
        with faults.deferred():
            try:
                while True:
                    pass
            except KeyboardInterrupt:
                print("second")
    except KeyboardInterrupt:
        print("first")
    """
    assert interrupt(body, twice=True)[:2] == (0, ["second", "first"])


def test_the_handler_of_sigint_is_restored():
    before = signal.getsignal(signal.SIGINT)
    with faults.deferred():
        with faults.deferred():
            assert signal.getsignal(signal.SIGINT) != before
        assert signal.getsignal(signal.SIGINT) != before
    assert signal.getsignal(signal.SIGINT) is before


def test_a_failing_benchmark_ends_after_the_run():
    ending, lines, _ = run(
        """
        simple = setup(ob.PathLengthOptimizationObjective)
        information = simple.getSpaceInformation()
        checker = FailingChecker(information, 10**9)
        simple.setStateValidityChecker(checker)
        benchmark = ot.Benchmark(simple, "test")
        benchmark.addPlanner(og.RRTstar(information))
        runs = []
        def fail_in_the_third(planner):
            runs.append(None)
            if len(runs) == 3:
                checker.left = 0
        benchmark.setPreRunEvent(fail_in_the_third)
        go()
        try:
            benchmark.benchmark(ot.Request(0.1, 4096.0, 100, 0.05, False, False, False))
        except ValueError as error:
            print("caught", error, "after", len(runs))
        """
    )
    assert (ending, lines) == ("ends", ["caught boom after 3"])
