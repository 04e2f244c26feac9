"""What a release builds installs in a fresh environment and runs wall 1."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("release", ROOT / "tools" / "release.py")
release = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(release)

pytestmark = pytest.mark.slow
needs_build = pytest.mark.skipif(
    importlib.util.find_spec("build") is None, reason="pip install build"
)


def run_wall(python: Path, folder: Path) -> tuple[dict, str]:
    """Summary of wall 1 by the command of an environment, and what it told."""
    command = [python, "-c", release.RUN, "run", str(ROOT / "examples" / "wall1.toml")]
    clean = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA")}
    done = subprocess.run(
        [*command, "--out", str(folder / "out")],
        cwd=folder, env={**clean, "PYTHONPATH": ""}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8")), done.stderr


@pytest.mark.long
@needs_build
def test_a_wheel_with_kernels_runs_wall_1_without_the_compiler(tmp_path):
    plain = release.build(tmp_path)
    (sdist,) = tmp_path.glob("drystone-*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {"pyproject.toml", "LICENSE", "README.md", "src/drystone/py.typed"} <= names
    with zipfile.ZipFile(plain) as archive:
        names = set(archive.namelist())
    assert "drystone/py.typed" in names
    assert any(name.endswith("/viewer.html") for name in names)
    wheel = release.with_kernels(plain, tmp_path, ["examples/wall1.toml"])
    assert "none-any" not in wheel.name
    python = release.environment(tmp_path / "fresh", wheel)
    summary, told = run_wall(python, tmp_path)
    assert summary["status"] == "finished"
    assert summary["peak_multiplier"] == pytest.approx(0.575, rel=0.02)  # the figure of wall 1
    assert "compil" not in told
    assert summary["version"] == wheel.name.split("-")[1]


@needs_build
def test_a_tree_without_git_is_the_fallback(tmp_path):
    """Its version is that of pyproject.toml, as of an archive that was downloaded."""
    tree = tmp_path / "tree"
    listed = subprocess.run(
        ["git", "ls-files", "src", "pyproject.toml", "README.md", "LICENSE"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    for name in listed.stdout.splitlines():
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        (tree / name).write_bytes((ROOT / name).read_bytes())
    command = [sys.executable, "-m", "build", "--wheel", "--outdir", str(tmp_path), str(tree)]
    subprocess.run(command, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    fallback = re.search(r'fallback-version = "(.+)"', text).group(1)
    assert wheel.name.split("-")[1] == fallback
