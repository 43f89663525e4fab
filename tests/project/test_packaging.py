"""The repository is laid out, imported and packed as it promises."""

import importlib
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import ompl_risk

ROOT = Path(__file__).parents[2]


def test_every_public_name_imports_and_is_documented():
    names = [name for name in vars(ompl_risk) if not name.startswith("_")]
    assert {"rank", "RiskObjective", "TerrainClearance", "Sobolev", "Lp", "terrains"} <= set(names)
    for name in names:
        assert getattr(ompl_risk, name).__doc__, name


@pytest.mark.parametrize("name", ["terrains", "planners"])
def test_top_level_folders_are_relative_links_into_the_package(name):
    link = ROOT / "ompl_risk" / name
    assert link.is_symlink()
    assert str(link.readlink()) == f"../{name}"
    assert importlib.import_module(f"ompl_risk.{name}")


def test_no_stray_packages_and_all_data_are_in_the_wheel(tmp_path):
    tracked = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if tracked.returncode:
        pytest.skip("not a git checkout")
    source = tmp_path / "source"  # a build leaves files behind, which a later one would pack
    for name in filter(None, tracked.stdout.split("\0")):
        if (ROOT / name).exists() or (ROOT / name).is_symlink():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, source / name, follow_symlinks=False)
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*build, "--wheel-dir", str(tmp_path), str(source)], check=True)
    (wheel,) = tmp_path.glob("*.whl")
    packed = set(zipfile.ZipFile(wheel).namelist())
    tops = {name.split("/")[0] for name in packed}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"ompl_risk"}
    for name in tracked.stdout.split("\0"):
        if name.startswith(("ompl_risk/", "terrains/", "planners/")) and name.endswith(".py"):
            inside = name if name.startswith("ompl_risk/") else f"ompl_risk/{name}"
            assert inside in packed or "/data/" in inside
    assert "ompl_risk/terrains/data/jacksboro_fault.tif" in packed
