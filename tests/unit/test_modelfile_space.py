"""Model files in space, and concave blocks in the plane: what is read, written, and said."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drystone.geometry.space.solid import Part, box
from drystone.io.modelfile import ModelError, model_to_dict, read_model, write_model
from drystone.limit import collapse_load
from drystone.model.assembly import GRAVITY, Block
from drystone.model.builders import make_model
from drystone.model.inspection import inspect
from drystone.model.joint_law import JointLaw
from drystone.model.loading import dead_load

EXAMPLES = Path(__file__).parents[2] / "examples"
LAW = JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)

GOOD = """\
dimension = 3
[material.stone]
unit_weight = 10e3
[joint]
friction_coefficient = 0.6
normal_stiffness = 1e9
shear_stiffness = 1e9
[contact]
points = 9
[[block]]
id = "base"
box = [[-1, -1, -0.2], [2, 2, 0]]
support = true
[[block]]
id = "b1"
box = [[0, 0, 0], [0.4, 0.3, 0.2]]
[load]
pattern = "mass"
direction = [0, -1, 0]
[control]
point = "top"
"""
BOX = "box = [[0, 0, 0], [0.4, 0.3, 0.2]]"
VERTICES = (
    "vertices = [[0,0,0], [0.4,0,0], [0.4,0.3,0], [0,0.3,0], "
    "[0,0,0.2], [0.4,0,0.2], [0.4,0.3,0.2], [0,0.3,0.2]]"
)
NOTCHED = "outline = [[0,0], [0.4,0], [0.4,0.1], [0.1,0.1], [0.1,0.2], [0,0.2]]"
FACES = "faces = [[0,3,2,1], [4,5,6,7], [0,1,5,4], [1,2,6,5], [2,3,7,6], [3,0,4,7]]"

#: A model of the plane, whose last block has no shape yet.
BLOCK_IN_THE_PLANE = """
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 1e4
[joint]
friction_coefficient = 0.6
normal_stiffness = 1e9
shear_stiffness = 1e9
[load]
pattern = "mass"
direction = [1, 0]
[[block]]
id = "base"
vertices = [[-1, -1], [3, -1], [3, 0], [-1, 0]]
support = true
[[block]]
id = "L"
"""


def read(tmp_path, text):
    path = tmp_path / "model.toml"
    path.write_text(text)
    return read_model(path)


def problems(tmp_path, text):
    with pytest.raises(ModelError) as caught:
        read(tmp_path, text)
    return [
        problem.removeprefix(f"{tmp_path / 'model.toml'}: ") for problem in caught.value.problems
    ]


def shaped(text):
    assert GOOD.count(BOX) == 1
    return GOOD.replace(BOX, text)


class TestShapes:
    @pytest.mark.parametrize(
        "shape",
        [
            BOX,
            VERTICES,
            f"{VERTICES}\n{FACES}",
            "outline = [[0, 0], [0.4, 0], [0.4, 0.2], [0, 0.2]]\ndepth = [0, 0.3]",
            "parts = [{ box = [[0, 0, 0], [0.1, 0.3, 0.2]] }, "
            "{ box = [[0.1, 0, 0], [0.4, 0.3, 0.2]] }]",
            "parts = [{ outline = [[0, 0], [0.4, 0], [0, 0.2]], depth = [0, 0.3] }, "
            "{ vertices = [[0.4,0,0], [0.4,0,0.2], [0,0,0.2], "
            "[0.4,0.3,0], [0.4,0.3,0.2], [0,0.3,0.2]] }]",
        ],
        ids=["box", "hull", "faces", "outline", "parts", "prisms"],
    )  # fmt: skip
    def test_one_box_in_every_way(self, tmp_path, shape):
        assembly = read(tmp_path, shaped(shape)).assembly
        assert assembly.dimension == 3 and assembly.points == 9
        assert assembly.volume[1] == pytest.approx(0.4 * 0.3 * 0.2, rel=1e-12)
        assert assembly.centroid[1] == pytest.approx([0.2, 0.15, 0.1], abs=1e-12)
        m = 10e3 / GRAVITY * 0.024
        moments = m / 12.0 * np.array([0.3**2 + 0.2**2, 0.4**2 + 0.2**2, 0.4**2 + 0.3**2])
        assert assembly.mass[1] == pytest.approx([m, m, m, *moments], rel=1e-12)

    def test_vertices_of_a_box_stay_as_they_are(self, tmp_path):
        vertices, faces = box([[0, 0, 0], [0.4, 0.3, 0.2]])
        block = read(tmp_path, shaped(f"{VERTICES}\n{FACES}")).assembly.blocks[1]
        assert np.array_equal(block.vertices, vertices)
        assert block.faces == faces

    @pytest.mark.parametrize(
        "shape",
        [
            f"{VERTICES}\nfaces = [[1,2,3,0], [7,6,5,4], "
            "[4,5,1,0], [5,6,2,1], [6,7,3,2], [7,4,0,3]]",
            "outline = [[0, 0.2], [0.4, 0.2], [0.4, 0], [0, 0]]\ndepth = [0, 0.3]",
        ],
        ids=["faces", "outline"],
    )  # fmt: skip
    def test_what_is_inside_out_is_turned_round(self, tmp_path, shape):
        model = read(tmp_path, shaped(shape))
        assert model.assembly.volume[1] == pytest.approx(0.024, rel=1e-12)
        assert model.notes == ('block: the faces of one ran clockwise and were turned round: "b1"',)

    def test_concave_in_space(self):
        model = read_model(EXAMPLES / "solids.toml")
        assembly = model.assembly
        assert [len(figure.parts) for figure in assembly.figures] == [1, 1, 1, 2, 2]
        # By hand: prisms, and a pyramid of 0.2 x 0.2 x 0.3 on a slab.
        volumes = [2.3 * 1.3 * 0.2, 0.3**2 * 0.9, 0.35 * 0.9 * 0.3]
        volumes += [(1.3 * 0.2 + 0.1 * 0.1) * 0.3, 0.4 * 0.3 * 0.1 + 0.2 * 0.2 * 0.3 / 3.0]
        assert assembly.volume == pytest.approx(volumes, rel=1e-12)
        assert model.control_point.point == pytest.approx([0.55, 0.15, 1.1])

    def test_concave_in_the_plane(self):
        model = read_model(EXAMPLES / "capital.toml")
        assembly = model.assembly
        assert [len(figure.parts) for figure in assembly.figures] == [1, 2]
        # The shaft, 0.4 x 0.8, and the capital, 1.0 x 0.4.
        y = (0.32 * 0.4 + 0.4 * 1.0) / 0.72
        assert assembly.volume[1] == pytest.approx(0.3 * 0.72, rel=1e-12)
        assert assembly.centroid[1] == pytest.approx([0.5, y], rel=1e-12)
        # It rocks about its toe at x = 0.7.
        found = collapse_load(model, flow="associative").load_multiplier
        assert found == pytest.approx(0.2 / y, rel=1e-6)

    def test_parts_in_the_plane(self, tmp_path):
        text = (
            BLOCK_IN_THE_PLANE
            + """
            parts = [{ vertices = [[0, 0], [2, 0], [2, 1], [0, 1]] },
                     { vertices = [[0, 3], [1, 3], [1, 1], [0, 1]] }]
        """
        )
        model = read(tmp_path, text)
        assert model.assembly.volume[1] == pytest.approx(4.0)
        assert model.assembly.centroid[1] == pytest.approx([0.75, 1.25])
        # The second part ran clockwise; the first one's joint is closed, and is the block's.
        assert model.notes == ('block: an outline ran clockwise and was turned round: "L"',)
        assert inspect(model).n_joints == 1
        assert len(model_to_dict(model)["block"][1]["parts"]) == 2
        write_model(model, tmp_path / "again.toml")
        assert (
            model_to_dict(read_model(tmp_path / "again.toml"))["block"]
            == (model_to_dict(model)["block"])
        )


@pytest.mark.parametrize("name", ["solids.toml", "capital.toml"])
@pytest.mark.parametrize("ending", ["toml", "json"])
def test_written_models_are_read_again(tmp_path, name, ending):
    model = read_model(EXAMPLES / name)
    path = tmp_path / f"model.{ending}"
    write_model(model, path)
    again = read_model(path)
    assert model_to_dict(again) == model_to_dict(model)
    for mine, theirs in zip(model.assembly.blocks, again.assembly.blocks, strict=True):
        assert np.array_equal(mine.vertices, theirs.vertices)
        assert mine.faces == theirs.faces
    assert np.array_equal(model.assembly.mass, again.assembly.mass)


class TestControl:
    @pytest.mark.parametrize(
        ("point", "place"),
        [
            ('point = "top"', [0.2, 0.15, 0.2]),
            ('point = "centre"', [0.2, 0.15, 0.1]),
            ("point = [0.4, 0.1, 0.2]", [0.4, 0.1, 0.2]),
            ("", [0.0, 0.0, 0.2]),  # the highest; of those, the furthest along the load: at y = 0
        ],
    )
    def test_where_it_is(self, tmp_path, point, place):
        model = read(tmp_path, GOOD.replace('point = "top"', point))
        assert model.control_point.block == 1
        assert model.control_point.point == pytest.approx(place, abs=1e-15)
        assert model.control_point.direction.tolist() == [0.0, -1.0, 0.0]

    def test_in_the_notch_of_a_concave_block_it_is_not_on_it(self, tmp_path):
        text = shaped(f"{NOTCHED}\ndepth = [0, 0.3]").replace(
            'point = "top"', "point = [0.3, 0.1, 0.15]"
        )
        assert problems(tmp_path, text) == [
            'control.point: (0.3, 0.1, 0.15) is not on block "b1", which spans x from 0 to 0.4, '
            "y from 0 to 0.3 and z from 0 to 0.2 m: move the point onto it"
        ]


class TestWhatIsWrong:
    @pytest.mark.parametrize(
        ("old", "new", "said"),
        [
            (BOX, "", 'block[2] "b1": vertices is missing: add it ([x, y, z] in metres'),
            (BOX, BOX + "\n" + VERTICES, 'block[2] "b1": has both vertices and box: leave one'),
            (BOX, BOX + "\n" + FACES, 'block[2] "b1": has faces, but no vertices'),
            (BOX, "outline = [[0, 0], [1, 0], [0, 1]]", 'block[2] "b1": depth is missing'),
            (BOX, BOX + "\ndepth = [0, 1]", 'block[2] "b1": has depth, but no outline'),
            (BOX, "parts = []", 'block[2] "b1" parts: must have 1 entry, it has 0'),
            (BOX, "parts = [{}]", 'block[2] "b1" parts[1]: vertices is missing'),
            (
                BOX,
                "parts = [{ parts = [] }]",
                'block[2] "b1" parts[1]: unknown key "parts"',
            ),
            (
                BOX,
                "parts = [{ box = [[0, 0, 0], [0.4, 0.3, 0]] }]",
                'block[2] "b1" parts[1].box: the box runs from z = 0 to 0: give the lower corner',
            ),
            ("[0.4, 0.3, 0.2]]", "[0.4, 0.3]]", 'b1" box[2]: must have 3 entries, it has 2'),
            ("[0.4, 0.3, 0.2]]", "[0.4, 0.3, -1]]", 'b1" box: the box runs from z = 0 to -1'),
            (
                BOX,
                f"{VERTICES}\n{FACES}".replace("[3,0,4,7]", "[3,0,4]"),
                'block[2] "b1" vertices: the surface is open',
            ),
            (
                BOX,
                f"{VERTICES}\n{FACES}".replace("[3,0,4,7]", "[3,0,4,8]"),
                'block[2] "b1" vertices: face 6 [3, 0, 4, 8] names a vertex that is not there',
            ),
            (
                BOX,
                f"{VERTICES}\n{FACES}".replace("[3,0,4,7]", "[3,0,4,-7]"),
                'block[2] "b1" faces[6][4]: must be at least 0, it is -7',
            ),
            (
                BOX,
                f"{VERTICES}\n{FACES}".replace("[0.4,0.3,0.2]", "[0.4,0.3,0.21]"),
                'block[2] "b1" vertices: face',
            ),
            (
                BOX,
                "outline = [[0, 0], [1, 1], [1, 0], [0, 1]]\ndepth = [0, 1]",
                'block[2] "b1" outline: the outline encloses no area',
            ),
            (
                BOX,
                VERTICES.replace("]]", "], [0.2, 0.1, 0.1]]"),
                'block[2] "b1" vertices: vertex 8 (0.2, 0.1, 0.1) lies 0.1 m inside the hull',
            ),
            ("[0.4, 0.3, 0.2]", "[0.4, 0.3, 4e8]", 'block[2] "b1" box[2][3]: must be at most'),
            ("[0, -1, 0]", "[0, -1]", "load.direction: must have 3 entries"),
            (
                "direction = [0, -1, 0]",
                "direction = [0, 0, 0]",
                "load.direction: has no length: give a direction, as in [1.0, 0.0, 0.0]",
            ),
            ("points = 9", "points = 5", "contact.points: must be 4, 9, 16 or the square"),
            ('"top"', '"top right"', 'control.point: there is no point "top right": did you'),
            ('"top"', "[0, 0]", 'control.point: must be [x, y, z] in metres, or one of "top"'),
            ("dimension = 3", "dimension = [3]", "dimension: must be 2 or 3, it is a list of 1"),
            ("dimension = 3", "dimension = 3\nthickness = 1.0", "thickness: is for models in"),
            (
                "dimension = 3",
                "dimension = 2\nthickness = 1.0",
                'block[2] "b1" box: is for models in space only: take it out, or set dimension = 3',
            ),
            (
                "[load]",
                '[wall]\nunit = [0.4, 0.2]\ncourses = ["1"]\n[load]',
                "wall: is for models in the plane only",
            ),
            ("[[0, 0, 0], [0.4", "[[0, 0, -0.1], [0.4", "overlap by 100 mm"),
            ("[[0, 0, 0], [0.4", "[[0, 0, 0.1], [0.4", "touches no other block"),
        ],
    )  # fmt: skip
    def test_names_the_place_and_the_mend(self, tmp_path, old, new, said):
        assert GOOD.count(old) == 1
        found = problems(tmp_path, GOOD.replace(old, new))
        assert any(said in problem for problem in found), found

    def test_a_part_that_is_not_convex(self, tmp_path):
        found = problems(tmp_path, shaped(f"parts = [{{ {NOTCHED}, depth = [0, 0.3] }}]"))
        assert found == [
            'block[2] "b1" parts: part 1: it is not convex: cut it, or give the block as a whole'
        ]

    @pytest.mark.parametrize(
        ("other", "by"),
        [
            ("{ box = [[0, 0, 0.15], [0.8, 0.3, 0.2]] }", "50 mm"),
            ("{ box = [[0, 0, 0], [0.4, 0.3, 0.2]] }", "200 mm"),  # the same one again
        ],
    )
    def test_parts_that_overlap(self, tmp_path, other, by):
        # The beam drawn through the column weighed twice where both are.
        found = problems(
            tmp_path, shaped(f"parts = [{{ box = [[0, 0, 0], [0.4, 0.3, 0.2]] }}, {other}]")
        )
        assert found == [
            f'block[2] "b1" parts: parts 1 and 2 overlap by {by}, and what they share would weigh '
            "twice: cut one of them so that they only touch, or take it out"
        ]

    def test_parts_that_overlap_in_the_plane(self, tmp_path):
        found = problems(
            tmp_path,
            BLOCK_IN_THE_PLANE
            + """
            parts = [{ vertices = [[0, 0], [2, 0], [2, 1], [0, 1]] },
                     { vertices = [[0, 0.9], [1, 0.9], [1, 3], [0, 3]] },
                     { vertices = [[0, 2.8], [1, 2.8], [1, 4], [0, 4]] }]
            """,
        )
        assert len(found) == 1
        assert '"L" parts: parts 2 and 3 overlap by 200 mm (and 1 more), and' in found[0]

    def test_an_edge_that_is_too_round(self, tmp_path):
        found = problems(tmp_path, GOOD.replace("[contact]", "[corner]\nradius = 0.15\n[contact]"))
        assert len(found) == 1
        # Of the base too: 0.2 m thick.
        assert found[0].startswith(
            'corner, at block[1] "base": the corner radius 0.15 m leaves nothing of face '
        )
        assert found[0].endswith("(and so at 1 more)")

    def test_in_python(self):
        vertices, faces = box([[0, 0, 0], [1, 1, 1]])
        block = Block(id="a", vertices=vertices, faces=faces, unit_weight=1e4, support=True)
        with pytest.raises(ModelError, match="thickness: is for models in the plane only"):
            make_model([block], joint=LAW, thickness=1.0, load_direction=(1, 0, 0))
        with pytest.raises(ModelError, match=r"load.direction: must be three finite numbers"):
            make_model([block], joint=LAW, load_direction=(1, 0))
        with pytest.raises(ModelError, match=r"contact.points: must be 4, 9, 16 or .*, it is 7"):
            make_model([block], joint=LAW, load_direction=(1, 0, 0), points=7)
        with pytest.raises(ModelError, match="thickness: is missing"):
            make_model(
                [Block(id="a", vertices=vertices[:4, :2], unit_weight=1e4)],
                joint=LAW,
                load_direction=(1, 0),
            )


def test_a_gap_below_a_block_of_parts_is_closed_and_they_stay_together(tmp_path):
    path = tmp_path / "model.json"
    data = model_to_dict(read_model(EXAMPLES / "capital.toml"))
    gap = 2e-4
    del data["block"][1]["vertices"]
    shaft = [[0.3, gap], [0.7, gap], [0.7, 0.8 + gap], [0.3, 0.8 + gap]]
    head = [[0.0, 0.8 + gap], [1.0, 0.8 + gap], [1.0, 1.2], [0.0, 1.2]]
    data["block"][1]["parts"] = [{"vertices": shaft}, {"vertices": head}]
    path.write_text(json.dumps(data))
    block = read_model(path).assembly.blocks[1]
    shaft[0][1] = shaft[1][1] = 0.0
    assert block.parts[0].vertices == pytest.approx(np.array(shaft), abs=1e-12)
    assert block.parts[1].vertices == pytest.approx(np.array(head), abs=1e-12)
    assert np.array_equal(block.vertices, np.vstack([part.vertices for part in block.parts]))


def test_what_supports_carry_is_the_weight():
    model = read_model(EXAMPLES / "solids.toml")
    found = inspect(model)
    assert -dead_load(model.assembly).sum(axis=0)[:3] == pytest.approx([0.0, 0.0, found.weight])
    assert found.weight == pytest.approx(found.volume * 2200.0 * GRAVITY, rel=1e-12)
    assert found.dimension == 3
    assert found.lower == (-0.1, 0.0, 0.0) and found.upper == (1.3, 0.3, 1.5)
    # Piers on the ground, lintel on both, finial on the lintel.
    assert found.n_joints == 5
    # The lintel lies on one pier with two of its parts.
    assert found.n_contacts == (5 + 1) * 4
    assert found.problems == ()
    json.dumps(found.lower)


def test_blocks_of_parts_go_to_their_places():
    parts = (Part(*box([[0, 0, 0], [1, 1, 1]])), Part(*box([[1, 0, 0], [2, 1, 2]])))
    block = Block.of_parts(parts, id="a", unit_weight=1e4)
    moved = block.with_vertices(block.vertices + 1.0)
    for mine, theirs in zip(moved.parts, parts, strict=True):
        assert np.array_equal(mine.vertices, theirs.vertices + 1.0)
        assert mine.faces == theirs.faces
