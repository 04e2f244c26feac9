"""``drystone show``, and the joints that `check` finds missing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from built import LAW
from drystone.cli import app
from drystone.common.tolerances import MISSED_GAP
from drystone.geometry.missed import Missed
from drystone.geometry.plane.outlines import TOUCHING
from drystone.model.assembly import Assembly
from drystone.model.builders import panel, placed

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
BEGINNINGS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


def drystone(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


@pytest.mark.parametrize("name", ["wall1", "facade", "builders/dome"])
@pytest.mark.parametrize("ending", BEGINNINGS)
def test_a_picture_in_every_format(tmp_path, name, ending):
    if ending != ".png" and name != "facade":
        pytest.skip("one model is enough")
    path = tmp_path / f"picture{ending}"
    result = drystone("show", EXAMPLES / f"{name}.toml", "--out", path)
    assert result.exit_code == 0, result.output
    assert path.read_bytes().startswith(BEGINNINGS[ending])


def test_a_title_with_letters_of_formulas(tmp_path):
    text = (EXAMPLES / "wall1.toml").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("title =")]
    model, path = tmp_path / "a.toml", tmp_path / "a.png"
    title = r"title = 'Cost $5_{ and \frac{ $x'"
    model.write_text("\n".join((title, *lines)), encoding="utf-8")
    result = drystone("show", model, "--out", path)  # it ended in a traceback
    assert result.exit_code == 0, result.output
    assert path.read_bytes().startswith(BEGINNINGS[".png"])


def test_what_show_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = drystone("show", EXAMPLES / "wall1.toml", "--json")
    assert json.loads(result.stdout) == {"status": "done", "file": "wall1.png"}
    assert (tmp_path / "wall1.png").is_file()
    result = drystone("show", EXAMPLES / "wall1.toml", "--out", "wall1.bmp")
    assert result.exit_code == 2
    assert "must end in .png, .svg, .pdf" in result.stderr
    result = drystone("show", tmp_path / "none.toml")
    assert result.exit_code == 2 and "Traceback" not in result.stderr


def apart(gap, dimension):
    """Two panels of one stone each, beside each other with a gap [m]."""
    more = {"thickness": 0.3} if dimension == 3 else {}
    stone = panel(length=0.4, height=0.2, unit=(0.4, 0.2), unit_weight=20e3, **more)
    origin = (0.4 + gap, *(0.0,) * (dimension - 1))
    blocks = [*placed(stone, name="a", base=True), *placed(stone, name="b", origin=origin)]
    return Assembly.build(blocks, joint=LAW)


@pytest.mark.parametrize("dimension", [2, 3])
def test_faces_near_each_other_without_a_joint_are_found(dimension):
    """From what counts as touching up to MISSED_GAP of the smallest extent, 0.2 m."""
    size = 0.45 if dimension == 2 else 0.54  # of a stone, see `pair_size`: no less than 0.4 m
    for gap, missed in ((0.0, 0), (0.5 * TOUCHING * 0.4, 0), (2.0 * TOUCHING * size, 1),
                        (0.9 * MISSED_GAP * 0.2, 1), (1.1 * MISSED_GAP * 0.2, 0)):  # fmt: skip
        found = Missed.of(apart(gap, dimension))
        assert len(found.size) == missed, gap
        if missed:
            assert found.gap == pytest.approx([gap], rel=1e-9)
            assert found.size == pytest.approx([0.2 if dimension == 2 else 0.06], rel=1e-9)


def test_a_missed_joint_beside_others_is_found_and_check_says_so(tmp_path):
    path = tmp_path / "model.toml"
    text = (EXAMPLES / "facade.toml").read_text()
    old = "[[0.4, 0.0, 0.8], [0.8, 0.2, 1.0]]"
    assert old in text
    path.write_text(text.replace(old, "[[0.4, 0.0, 0.8], [0.798, 0.2, 1.0]]"))
    result = drystone("check", path, "--json")
    found = json.loads(result.stdout)
    assert found["problems"] == [
        'block: "c5u2" and "c5u3" have faces 2 mm apart over 0.04 m2, and no joint: move them '
        "together, or farther apart"
    ]
    # Supports carry the weight, by forces in balance to 1e-7.
    assert found["reaction"] == pytest.approx(found["weight"], rel=1e-6)
    whole = json.loads(drystone("check", EXAMPLES / "facade.toml", "--json").stdout)
    assert whole["joint_area"] - found["joint_area"] == pytest.approx(0.04 + 2 * 2e-3 * 0.2)


def test_no_joint_is_missed_in_what_stands_close(tmp_path):
    """Blocks that meet at edges, or lean on others with a joint, are none."""
    from drystone.io.modelfile import read_model

    for name in ("dome", "groin_vault", "arch", "rubble"):
        assembly = read_model(EXAMPLES / "builders" / f"{name}.toml").assembly
        assert not len(Missed.of(assembly).size)
        assert np.all(assembly.interfaces.size > 0.0)
