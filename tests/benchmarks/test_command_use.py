"""The commands that can be stopped: what is wrong is refused before anything is done or written."""

import os

import pytest

from benchmarks import __main__ as command

COUNT = "must be a whole number of at least 1"
SECONDS = "must be a positive number of seconds"


def run(name, folder, *options):
    return command.main([name, "--output", str(folder), *options])


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("evidence", ["--units", "0"], COUNT),
        ("evidence", ["--units", "1.5"], COUNT),
        ("evidence", ["--rollouts", "-3"], COUNT),
        ("evidence", ["--workers", "none"], COUNT),
        ("evidence", ["--seed", "-1"], "argument --seed: -1: must be 0 or more"),
        ("evidence", ["--seed", "x"], "argument --seed: invalid int value: 'x'"),
        ("evidence", ["--engine", "ray"], "invalid choice: 'ray'"),
        (
            "evidence", ["--scheduler", "tcp://a:1"],
            "argument --scheduler: tcp://a:1: only with --engine dask",
        ),
        ("evidence", ["--terrain", "hills"], "unrecognized arguments"),
        ("helicopter", ["--pairs", "0"], COUNT),
        ("helicopter", ["--pairs", "1.5"], COUNT),
        ("helicopter", ["--places", "-3"], COUNT),
        ("helicopter", ["--workers", "none"], COUNT),
        ("helicopter", ["--seed", "-1"], "argument --seed: -1: must be 0 or more"),
        ("helicopter", ["--seed", "x"], "argument --seed: invalid int value: 'x'"),
        ("helicopter", ["--terrain", "hills"], "unrecognized arguments"),
        ("objectives", ["--seconds", "0"], SECONDS),
        ("objectives", ["--seconds", "nan"], SECONDS),
        ("objectives", ["--seeds", "1.5"], COUNT),
        ("objectives", ["--scenes", "moon"], "'moon'"),
        ("objectives", ["--objectives", "L3"], "'L3'"),
        ("objectives", ["--planners", "PRM"], "'PRM'"),
        (
            "objectives", ["--workers", str(len(os.sched_getaffinity(0)) + 1)],
            "take each other's time",
        ),
    ],
)  # fmt: skip
def test_wrong_use_is_refused(tmp_path, capsys, name, options, message):
    with pytest.raises(SystemExit) as refusal:
        run(name, tmp_path / "a", *options)
    assert refusal.value.code == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize("name", ["evidence", "helicopter", "objectives"])
def test_a_file_is_no_folder(tmp_path, capsys, name):
    (tmp_path / "thesis.tex").write_text("x")
    assert run(name, tmp_path / "thesis.tex", "--quick") == 2
    err = capsys.readouterr().err
    assert err.startswith("error: ")
    assert "thesis.tex" in err
    assert (tmp_path / "thesis.tex").read_text() == "x"
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        (
            "evidence",
            "units quick seed rollouts workers engine scheduler output retry-failed report-only",
            ("each a set in every level (520; quick 10)", "in each level (512; quick 100);"),
        ),
        (
            "helicopter",
            "pairs quick seed workers places output retry-failed no-example",
            ("(200; quick 8)", "of a roadmap (3000)"),
        ),
        (
            "objectives",
            "quick output seconds seeds scenes planners objectives workers retry-failed",
            ("processor time of each run (5; quick 1)", "--seeds N (5; quick 2)"),
        ),
    ],
)
def test_help_names_every_option(capsys, name, options, words):
    with pytest.raises(SystemExit) as ending:
        command.main([name, "--help"])
    assert ending.value.code == 0
    text = " ".join(capsys.readouterr().out.split())
    for option in options.split():
        assert f" --{option} " in text
    for some in (*words, f"runs/{name}", "the same command and it goes on where it was stopped"):
        assert some in text
