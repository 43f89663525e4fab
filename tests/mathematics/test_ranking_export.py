import io
import json
import math
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from ompl_risk.avoidance import InverseDistance
from ompl_risk.errors import ArgumentError, ExtraError, FileError
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.ranking import rank
from ompl_risk.ranking.export import norm_unit
from ompl_risk.trajectory import Trajectory

T = np.linspace(0.0, 10.0, 11)
HEIGHTS = {"high": 80.0, "[low]": 40.0, "hit": -1.0}


@pytest.fixture(scope="module")
def ranking():
    trajectories = [
        Trajectory(T, np.stack([30 * T, 0 * T, 0 * T + z], axis=1), name)
        for name, z in HEIGHTS.items()
    ]
    profiles = [SimpleNamespace(t=T, p=0 * T + p) for p in (0.0, 0.25, 1.0)]
    return rank(
        trajectories,
        lambda p: p[:, 2],
        InverseDistance(100.0),
        max_step=None,
        probability=profiles,
    )


def printed(renderable, width=80):
    console = Console(file=io.StringIO(), width=width)
    console.print(renderable)
    return console.file.getvalue()


def refuse(constant):
    raise AssertionError(f"{constant} is not strict JSON")


def test_json_is_strict_and_infinity_is_a_word(ranking):
    data = json.loads(ranking.to_json(), parse_constant=refuse)
    assert data == json.loads(json.dumps(ranking.to_dict(), allow_nan=False))
    high, low, hit = data["trajectories"]
    assert hit["norms"] == dict.fromkeys(["L1", "L2", "L∞", "H1"], "inf")
    assert float(hit["norms"]["L1"]) == math.inf
    assert hit["collides"] is True
    assert (hit["collision_time"], hit["collision_position"]) == (0.0, [0.0, 0.0, -1.0])
    assert hit["attribution"] == dict.fromkeys(["L1", "L2", "L∞", "H1"])
    assert high["norms"]["L1"] == pytest.approx(10 * (1 / 80 - 1 / 100))
    assert low["pc_norms"]["L1"] == pytest.approx(2.5)
    assert low["attribution"]["L1"]["segments"] == pytest.approx([0.05] * 20)
    assert data["orders"]["H1"] == ["high", "[low]", "hit"]
    assert data["pc_orders"]["H1"] == ["high", "[low]", "hit"]
    assert data["pareto"]["H1"] == ["high"]
    assert data["agreement"]["kendall_tau_b"] == [[1.0] * 4] * 4
    assert data["pc_agreement"]["rows"] == ["L1", "L2", "L∞", "H1"]
    assert data["durations_comparable"] is True
    assert data["units"]["norms"] == {
        "L1": "s/m", "L2": "s^(1/2)/m", "L∞": "1/m", "H1": "s^(1/2)/m"
    }  # fmt: skip


def test_json_to_a_file(ranking, tmp_path):
    path = tmp_path / "ranking.json"
    text = ranking.to_json(path, indent=None, segments=3)
    assert path.read_text(encoding="utf-8") == text + "\n"
    assert "\n" not in text
    assert len(json.loads(text)["trajectories"][0]["attribution"]["L1"]["segments"]) == 3
    with pytest.raises(FileError, match="No such file"):
        ranking.to_json(tmp_path / "none" / "ranking.json")
    with pytest.raises(ArgumentError, match="count = 0"):
        ranking.to_json(segments=0)


def test_units_of_norms():
    assert norm_unit(Lp(1.5)) == "s^(1/1.5)/m"
    assert norm_unit(Sobolev(1), of="1") == "s^(1/2)"
    assert norm_unit(Lp(math.inf), of="1") == "1"


def test_pandas(ranking):
    pd = pytest.importorskip("pandas")
    frame = ranking.to_pandas()
    assert isinstance(frame, pd.DataFrame)
    assert list(frame.index) == list(HEIGHTS)
    assert frame.loc["[low]", "L1"] == pytest.approx(10 * (1 / 40 - 1 / 100))
    assert frame.loc["hit", "H1"] == math.inf
    assert frame.loc["hit", "PC L∞"] == 1.0
    assert list(frame["collides"]) == [False, False, True]


def test_without_pandas_the_extra_is_named(ranking, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ExtraError, match=r"pip install 'ompl-risk\[pandas\]'"):
        ranking.to_pandas()


def test_tables_fit_80_columns_and_keep_brackets(ranking):
    text = printed(ranking)
    assert "…" not in text
    assert "high  [low]  hit" in text
    for heading in ("duration [s]", "length [m]", "clearance [m]", "at t [s]"):
        assert heading in text
    for title in ("From safest to riskiest", "Kendall tau-b between norms"):
        assert title in text
    assert "* 0.025" in text  # the safest by L1
    assert "collides, first at t = 0.0 s near (0, 0) m" in text
    assert "of H1 between t = " in text
    assert "Durations differ" not in text


def test_tables_mark_all_that_are_equally_safe():
    trajectories = [
        Trajectory(T, np.stack([30 * T, 0 * T, 0 * T + z], axis=1), f"{z}") for z in (200, 300)
    ]
    ranking = rank(trajectories, lambda p: p[:, 2], InverseDistance(100.0))
    assert printed(ranking).count("* 0 ") == 2 * len(ranking.norms)


def test_tables_say_that_durations_do_not_compare():
    slow = Trajectory(2 * T, np.stack([30 * T, 0 * T, 0 * T + 50], axis=1), "slow")
    quick = Trajectory(T, np.stack([30 * T, 0 * T, 0 * T + 500], axis=1), "quick")
    with pytest.warns(UserWarning, match="durations differ"):
        ranking = rank([slow, quick], lambda p: p[:, 2], InverseDistance(100.0))
    text = " ".join(printed(ranking).split())
    assert "Durations differ by 100 %, more than 5 %" in text
    assert "L1: quick; L2: quick" in text
    assert "no obstacle nearer than d0" in text


def test_a_single_trajectory_and_no_safe_one_print(ranking):
    hit = ranking["hit"].trajectory
    alone = rank([hit], lambda p: p[:, 2], InverseDistance(100.0))
    text = printed(alone)
    assert "* inf" not in text
    assert "Kendall" not in text
