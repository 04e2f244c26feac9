"""Groups of blocks: in Python, in files, and as names in joint laws."""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from drystone.io.modelfile import read_model, write_model
from drystone.model.assembly import Assembly, Block
from drystone.model.builders import ModelError
from drystone.model.joint_law import JointLaw

LAW = JointLaw(friction_coefficient=0.6, normal_stiffness=1e8, shear_stiffness=1e8)
SLIPPERY = JointLaw(friction_coefficient=0.2, normal_stiffness=1e8, shear_stiffness=1e8)
SMOOTH = JointLaw(friction_coefficient=0.1, normal_stiffness=1e8, shear_stiffness=1e8)

HEAD = """\
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.6
normal_stiffness = 1e8
shear_stiffness = 1e8
[load]
pattern = "mass"
direction = [1.0, 0.0]
[wall]
unit = [0.4, 0.2]
courses = ["11", "h1h", "11"]
base = true
"""


def stacked(*groups: tuple[str, ...]) -> list[Block]:
    """Unit squares on each other, each with its groups."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return [
        Block(id=f"b{i}", vertices=square + [0.0, i], unit_weight=1e4, material="stone", groups=own)
        for i, own in enumerate(groups)
    ]


def read(tmp_path, text: str) -> ds.Model:
    path = tmp_path / "model.toml"
    path.write_text(text)
    return read_model(path)


def test_rows_of_groups():
    assembly = Assembly.build(stacked(("low",), ("low", "all"), ("all",), ()), joint=LAW)
    assert list(assembly.groups) == ["low", "all"]
    assert assembly.groups["low"].tolist() == [0, 1]
    assert assembly.groups["all"].tolist() == [1, 2]


def test_blocks_go_before_groups_and_groups_before_materials():
    between = {
        frozenset(("stone",)): SMOOTH,
        frozenset(("low", "b2")): SLIPPERY,
        frozenset(("b0", "b1")): LAW,
    }
    blocks = stacked(("low",), ("low",), (), ())
    assembly = Assembly.build(blocks, joint=LAW, joint_between=between)
    index = assembly.law_index(np.array([0, 2, 2, 0]), np.array([1, 1, 3, 3]))
    assert [assembly.laws[k] for k in index] == [LAW, SLIPPERY, SMOOTH, SMOOTH]


def test_a_group_beside_itself_means_the_joints_within():
    assembly = Assembly.build(
        stacked(("low",), ("low",), ()),
        joint=LAW,
        joint_between={frozenset(("low",)): SMOOTH},
    )
    index = assembly.law_index(np.array([0, 1]), np.array([1, 2]))
    assert [assembly.laws[k] for k in index] == [SMOOTH, LAW]


def test_groups_of_files(tmp_path):
    more = '[group.low]\nblocks = ["c1*"]\n[group."top two"]\nblocks = ["c3u?", "c2u2"]\n'
    law = '[joint.between."low top two"]\nfriction_coefficient = 0.3\n'
    model = read(tmp_path, HEAD + more + law)
    assembly = model.assembly
    assert [assembly.ids[i] for i in assembly.groups["low"]] == ["c1u1", "c1u2"]
    assert [assembly.ids[i] for i in assembly.groups["top two"]] == ["c2u2", "c3u1", "c3u2"]
    index = assembly.law_index(
        np.array([assembly.index("c1u1"), assembly.index("c1u1")]),
        np.array([assembly.index("c2u2"), assembly.index("c2u1")]),
    )
    assert [assembly.laws[k].friction_coefficient for k in index] == [0.3, 0.6]
    again = tmp_path / "again.toml"
    write_model(model, again)
    same = read_model(again).assembly
    assert {k: v.tolist() for k, v in same.groups.items()} == {
        k: v.tolist() for k, v in assembly.groups.items()
    }
    assert same.joint_between == assembly.joint_between


def test_a_group_may_be_the_supports(tmp_path):
    text = HEAD.replace("base = true\n", "") + '[group.foot]\nblocks = ["c1*"]\nsupport = true\n'
    assembly = read(tmp_path, text).assembly
    assert assembly.fixed.tolist() == [name.startswith("c1") for name in assembly.ids]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ('[group.low]\nblocks = ["d*"]\n', 'group.low.blocks[1]: no block has an id like "d*"'),
        ('[group.low]\nblocks = ["c1u9"]\n', 'there is no block "c1u9": did you mean'),
        ("[group.low]\nblocks = []\n", "group.low.blocks: must have at least 1 entry, it has 0"),
        ("[group.low]\n", "group.low: blocks is missing"),
        (
            '[group.a]\nblocks = ["c1*"]\n[group.b]\nblocks = ["c2*"]\n'
            '[group.c]\nblocks = ["c?u1"]\n'
            '[joint.between."a b"]\nfriction_coefficient = 0.3\n'
            '[joint.between."a c"]\nfriction_coefficient = 0.4\n',
            'between blocks "c1u1" and "c2u1" "a c" gives another law',
        ),
        (
            '[group.stone]\nblocks = ["c1*"]\n[joint.between."stone c2u1"]\n'
            "friction_coefficient = 0.3\n",
            '"stone" is a group and a material: give the group another name',
        ),
        (
            '[group.a]\nblocks = ["c1*"]\n[joint.between."a stone"]\nfriction_coefficient = 0.3\n',
            "names a block or a group and a material",
        ),
    ],
)
def test_what_is_said_of_groups_that_are_wrong(tmp_path, more, said):
    with pytest.raises(ModelError) as error:
        read(tmp_path, HEAD + more)
    assert said in str(error.value)
