"""[[build]]: the table of a kind is its builder's arguments; place, names, groups, sentences."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Annotated

import numpy as np
import pytest

import drystone as ds
from drystone.common.keys import NEEDED, OF_SPACE, Choice, Key, Number, keys_of
from drystone.common.ranges import RANGES
from drystone.io.modelfile.builds import BuildSection
from drystone.model.builders import ModelError, column, panel, placed
from drystone.model.builders.base import Length, Metres
from drystone.model.builders.kinds import BUILDERS

LENGTH = Number(RANGES["unit"])  # as of `Length`
PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "model-file.md"

HEAD = """
dimension = {dimension}
{thickness}
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.65
normal_stiffness = 1e9
shear_stiffness = 1e9
[load]
pattern = "mass"
direction = {direction}
"""
PANEL = """
[[build]]
kind = "panel"
length = 1.2
height = 0.4
unit = [0.4, 0.2]
base = true
"""


def read(folder, text, dimension=2):
    """The model of a file with that text after its head."""
    head = HEAD.format(
        dimension=dimension,
        thickness="thickness = 0.3" if dimension == 2 else "",
        direction=[1.0, 0.0, 0.0][:dimension],
    )
    path = folder / "model.toml"
    path.write_text(head + text)
    return ds.read_model(path)


def problems(folder, text, dimension=2):
    with pytest.raises(ModelError) as error:
        read(folder, text, dimension)
    where = str(folder / "model.toml") + ": "
    assert all(problem.startswith(where) for problem in error.value.problems)
    return [problem.removeprefix(where) for problem in error.value.problems]


def test_every_parameter_of_a_builder_is_a_key():
    for kind, builder in BUILDERS.own():
        given = inspect.signature(builder.make).parameters
        assert all(parameter.kind is parameter.KEYWORD_ONLY for parameter in given.values())
        own = {name for name in given if name not in ("unit_weight", "material", "base")}
        assert own == {key.name for key in builder.keys}, kind
        assert not own & set(BuildSection.model_fields), kind
        thick = [key for key in builder.keys if key.of_space]  # along y
        assert len(thick) == (2 in builder.dimensions), kind


@pytest.mark.parametrize("kind", BUILDERS.ours)
def test_the_reference_page_has_the_keys_of_the_builder(kind):
    """Those that may be left out in italics, and after a choice what there is to choose from."""
    builder = BUILDERS[kind]
    (row,) = [line for line in PAGE.read_text().splitlines() if line.startswith(f'| `"{kind}"`')]
    head, text = row.strip("| ").split(" | ")
    assert head.endswith("in space") == (builder.dimensions == (3,))
    bare = re.sub(r"\([^)]*\)", "", text)
    left_out = {key.name for key in builder.keys if key.of_space or key.default is not NEEDED}
    assert sorted(re.findall(r"`(\w+)`", bare)) == sorted(key.name for key in builder.keys)
    assert set(re.findall(r"\*`(\w+)`\*", bare)) == left_out
    for key in builder.keys:
        if isinstance(key.type, Choice):
            told = ", ".join(f'`"{word}"`' for word in key.type.among)
            assert f"`{key.name}`* ({told})" in text, key.name


def test_the_builder_that_the_page_writes_is_one():
    page = PAGE.with_name("builders.md").read_text()
    (code,) = re.findall(r"```python\n(from typing .*?)```", page, flags=re.DOTALL)
    made = {}
    exec(code, made)
    assert [key.name for key in made["PILE"].keys] == ["width", "height", "stones", "depth"]
    blocks = made["PILE"].blocks({"width": 0.6, "height": 0.3, "stones": 3}, 20e3, "stone")
    np.testing.assert_allclose(blocks[2].vertices[2], (0.6, 0.9), rtol=1e-15)


@pytest.mark.parametrize(
    ("annotation", "default", "key"),
    [
        (Length, NEEDED, {"type": LENGTH, "default": NEEDED}),
        (Length | None, None, {"type": LENGTH, "default": None}),
        (Annotated[Length, "in m"], 0.5, {"type": LENGTH, "default": 0.5, "says": "in m"}),
        (Annotated[Metres, "of all"], 0.5, {"type": LENGTH, "default": 0.5, "says": "of all"}),
        (
            Annotated[float | None, LENGTH, OF_SPACE],
            None,
            {"type": LENGTH, "default": NEEDED, "of_space": True},
        ),
    ],
)
def test_a_key_is_what_its_annotation_says(annotation, default, key):
    def make(*, unit_weight: float, size):
        raise NotImplementedError

    make.__annotations__["size"] = annotation
    make.__kwdefaults__ = {} if default is NEEDED else {"size": default}
    assert keys_of(make) == (Key(name="size", **key),)


def test_blocks_are_those_of_the_function(tmp_path):
    model = read(tmp_path, PANEL)
    made = panel(length=1.2, height=0.4, unit=(0.4, 0.2), unit_weight=20e3, material="stone")
    made = placed(made, name="panel", base=True)
    assert list(model.assembly.ids) == [block.id for block in made]
    for block, own in zip(model.assembly.blocks, made, strict=True):
        np.testing.assert_allclose(block.vertices, own.vertices, rtol=0, atol=1e-15)
        assert block.groups == own.groups
        assert block.support == own.support
    assert model.assembly.ids[:2] == ("panel/base", "panel/c1u1")
    assert set(model.assembly.groups) == {"panel", "course 1", "course 2"}


def test_several_tables_have_names_and_groups_of_their_own(tmp_path):
    text = PANEL + PANEL.replace('"panel"', '"panel"\nname = "b"\ngroup = "new"\norigin = [5, 0]')
    groups = read(tmp_path, text).assembly.groups
    assert {"panel", "b", "new", "panel/course 1", "b/course 1"} <= set(groups)
    assert "course 1" not in groups
    np.testing.assert_array_equal(groups["b"], groups["new"])
    (problem,) = problems(tmp_path, PANEL + PANEL)
    assert problem == 'build[2] name: "panel" is taken by build[1]: give it a name of its own'


def test_groups_of_builders_have_laws_of_their_own(tmp_path):
    text = PANEL + '[joint.between."course 1 course 2"]\nfriction_coefficient = 0.2\n'
    assembly = read(tmp_path, text).assembly
    joints = assembly.interfaces
    law = assembly.law_index(joints.block_a, joints.block_b)
    course = {i: g for g in ("course 1", "course 2") for i in assembly.groups[g].tolist()}
    pairs = zip(joints.block_a.tolist(), joints.block_b.tolist(), strict=True)
    beds = [a in course and b in course and course[a] != course[b] for a, b in pairs]
    np.testing.assert_array_equal(law == 1, beds)


@pytest.mark.parametrize("rotation", [30.0, -90.0, 360.0])
def test_a_place_in_the_plane(rotation):
    blocks = column(width=0.4, height=1.0, n_blocks=2, base=False, unit_weight=1.0)
    moved = placed(blocks, name="a", origin=(3.0, 1.0), rotation=rotation)
    c, s = np.cos(np.radians(rotation)), np.sin(np.radians(rotation))
    for block, before in zip(moved, blocks, strict=True):
        wanted = before.vertices @ np.array([[c, s], [-s, c]]) + (3.0, 1.0)
        np.testing.assert_allclose(block.vertices, wanted, rtol=0, atol=1e-14)


def test_rotations_in_space_are_about_fixed_axes_in_order():
    """A quarter about x takes z to -y; one about y after it leaves that; one about z: to x."""
    (block,) = column(width=0.2, depth=0.2, height=1.0, n_blocks=1, base=False, unit_weight=1.0)
    for rotation, way in (
        ([90, 0, 0], (0, -1, 0)), ([90, 90, 0], (0, -1, 0)), ([90, 90, 90], (1, 0, 0)),
        ([0, 90, 0], (1, 0, 0)), ([0, 0, 90], (0, 0, 1)), (90, (0, 0, 1)),
    ):  # fmt: skip
        (moved,) = placed([block], rotation=rotation)
        middle = 0.5 * (moved.vertices.min(axis=0) + moved.vertices.max(axis=0))
        np.testing.assert_array_equal(middle, 0.5 * np.array(way))
    for rotation in ([1, 2], "x" * 0 or [1.0, np.inf, 0.0]):
        with pytest.raises(ModelError, match="rotation: must be one number"):
            placed([block], rotation=rotation)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (('"panel"', '"panl"'), 'build[1].kind: must not be "panl": did you mean "panel"?'),
        (('kind = "panel"\n', ""), 'build[1]: kind is missing: add it (as in kind = "panel")'),
        (
            ("length = 1.2", "lenght = 1.2"),
            'build[1]: unknown key "lenght": did you mean "length"?',
        ),
        (
            ("length = 1.2", "length = -1.2"),
            "build[1].length: must be greater than 0, it is -1.2",
        ),
        (
            ("length = 1.2", "length = 1.2\nspan = 2.0"),
            'build[1]: has span, which does not belong to kind = "panel": take it out',
        ),
        (
            ("height = 0.4", "height = 0.5"),
            "build[1] height: 0.5 m is no whole number of courses of 0.2 m: the nearest that fit "
            "are 0.4 m and 0.6 m",
        ),
        (
            ("base = true", "thickness = 0.3"),
            "build[1].thickness: is for models in space only: take it out, or set dimension = 3",
        ),
        (
            ("base = true", 'material = "brick"'),
            'build[1] material: there is no material "brick": only "stone" is known',
        ),
        (
            ("base = true", 'name = "w"\nopenings = [{ at = 0.1, width = 9.0 }]'),
            'build[1] "w" openings[1]: height is missing: add it (in m)',
        ),
        (("base = true", "rotation = [1.0, 2.0]"), "build[1].rotation: must be one angle"),
        (
            ('"panel"', '"dome"\nspan = 2.0\nthickness = 0.2\nrings = 3\nsectors = 8\n#'),
            None,
        ),
    ],
)
def test_sentences_name_place_and_mend(tmp_path, change, sentence):
    assert change[0] in PANEL
    found = problems(tmp_path, PANEL.replace(*change))
    if sentence is None:
        found = [text for text in found if "three dimensions" in text]
        sentence = 'build[1]: kind = "dome" is for models in space only: set dimension = 3'
        text = "\n[[build]]\nkind = 'dome'\nspan = 2.0\nthickness = 0.2\nrings = 3\nsectors = 8\n"
        found = problems(tmp_path, text)
    assert any(text.startswith(sentence) for text in found), found


def test_what_a_wall_in_space_lacks(tmp_path):
    (problem,) = problems(tmp_path, PANEL, 3)
    assert problem.startswith("build[1]: thickness is missing: add it")
