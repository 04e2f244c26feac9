"""Input files of other programs, of models in space: what is written is read back as the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_convert import again, assert_same_law, run_fish, written

import fake_pylmgc90
import solids
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Part
from drystone.io.convert import common, convert, itasca
from drystone.io.convert.threedec_solids import block_command, prism_ends, solid_of
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.builders import ModelError, extruded, make_model, published_wall
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model

CASES = Path(__file__).parents[1] / "cases" / "solids"
#: Rounding of a friction angle and of a density.
CLOSE = 1e-11


def pyramid(side: float, height: float) -> np.ndarray:
    """With a square base, its apex off the middle: no prism."""
    h = 0.5 * side
    return np.array([[-h, -h, 0], [h, -h, 0], [h, h, 0], [-h, h, 0], [0.3 * h, 0.1, height]])


@st.composite
def models(draw, *, friction_only: bool = False) -> Model:
    """A stack of unequal boxes and voussoirs on a base, with a pyramid on top, turned about z."""
    n = draw(st.integers(1, 3))
    names = draw(
        st.lists(
            st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S")), min_size=1),
            min_size=n + 2, max_size=n + 2, unique=True,
        )
    )  # fmt: skip
    stone = {name: draw(st.floats(1e3, 3e4)) for name in ("stone", 'b"ri\\ck')}
    shapes = [solid.box([(-1.0, -1.0, -0.5), (1.0, 1.0, 0.0)])]
    z = 0.0
    for _ in range(n):
        height = draw(st.floats(0.2, 0.6))
        taper = draw(st.floats(0.0, 0.1))
        outline = np.array([[-0.3, z], [0.3, z], [0.3 - taper, z + height], [-0.3, z + height]])
        shapes.append(solid.extruded(outline, (-0.3, 0.3)))
        z += height
    vertices, faces = solid.hull(pyramid(0.3, 0.4) + (-0.05, 0.0, z))
    shapes.append((vertices, faces))
    angle = draw(st.floats(0.0, 1.5))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    material = [draw(st.sampled_from(sorted(stone))) for _ in shapes]
    blocks = [
        Block(
            id=name, vertices=v @ turn.T, faces=f, unit_weight=stone[m], material=m, support=i == 0
        )
        for i, (name, (v, f), m) in enumerate(zip(names, shapes, material, strict=True))
    ]

    def law(friction: float) -> JointLaw:
        rest = {} if friction_only else {"cohesion": draw(st.floats(0.0, 1e6))}
        return JointLaw(
            friction_coefficient=friction,
            normal_stiffness=draw(st.floats(1e7, 1e11)),
            shear_stiffness=draw(st.floats(1e7, 1e11)),
            **rest,
        )

    friction = draw(st.floats(0.1, 1.2))
    other = friction if friction_only else draw(st.floats(0.1, 1.2))
    between = {frozenset((names[0], names[1])): law(other)} if draw(st.booleans()) else {}
    push = draw(st.floats(-np.pi, np.pi))
    return make_model(
        blocks,
        joint=law(friction),
        joint_between=between,
        thickness=None,
        load_direction=(np.cos(push), np.sin(push), 0.0),
        analysis=Analysis(options={"overshoot": draw(st.floats(1.0, 1.1)), "patience": 7.0}),
        title=draw(st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "Zs")))),
    )


def assert_same(a: Model, b: Model, *, shear: bool = True) -> None:
    """Blocks as solids, supports, joints where blocks touch, load, control point, strategy."""
    p, q = a.assembly, b.assembly
    assert q.dimension == 3 and q.ids == p.ids
    assert [block.material for block in q.blocks] == [block.material for block in p.blocks]
    np.testing.assert_array_equal(q.fixed, p.fixed)
    for mine, theirs in zip(p.figures, q.figures, strict=True):
        (one,), (two,) = mine.parts, theirs.parts
        assert sorted(map(len, one.faces)) == sorted(map(len, two.faces))
        corners = [sorted(map(tuple, part.vertices.tolist())) for part in (one, two)]
        assert corners[0] == corners[1]  # numbers are written to the last digit
    np.testing.assert_allclose(q.weight, p.weight, rtol=CLOSE)
    pairs = p.interfaces.block_a, p.interfaces.block_b
    for i, j in zip(p.law_index(*pairs), q.law_index(*pairs), strict=True):
        assert_same_law(p.laws[i], q.laws[j], shear=shear)
    assert b.title == a.title
    np.testing.assert_allclose(b.load.direction, a.load.direction, rtol=CLOSE, atol=CLOSE)
    assert b.control_point.block == a.control_point.block
    np.testing.assert_array_equal(b.control_point.point, a.control_point.point)
    np.testing.assert_allclose(b.control_point.direction, a.control_point.direction, atol=CLOSE)
    assert common.strategy(b) == common.strategy(a)


@given(models())
@settings(max_examples=8, deadline=None)
def test_3dec_is_read_back(model):
    text = written(model, "3dec")[0]
    commands = [line.partition(";")[0].rstrip() for line in text.splitlines()]
    assert max(map(len, commands)) <= 80
    assert_same(model, again(model, "3dec"))


@given(models(friction_only=True))
@settings(max_examples=8, deadline=None)
def test_the_script_for_lmgc90_is_read_back(model):
    compile(written(model, "lmgc90")[0], "script", "exec")
    assert_same(model, again(model, "lmgc90"), shear=False)  # a note says that it is left out


@pytest.mark.parametrize("target", ["3dec", "lmgc90"])
def test_a_facade_is_read_back(target):
    model = solids.from_boxes(CASES / "facade_5x3x8.toml", push=(0.0, -1.0, 0.0))
    assert_same(model, again(model, target), shear=target == "3dec")


# 3DEC


def test_prisms_are_found_and_others_not():
    for shape in (
        solid.box([(0, 0, 0), (1, 2, 3)]),
        solid.extruded(np.array([[0, 0], [2, 0], [1, 1]], float), (0, 1)),
        solid.extruded(np.array([[0, 0], [2, 0], [3, 1], [1, 3], [0, 1]], float), (0, 1)),
    ):
        ends = prism_ends(shape[1])
        assert ends is not None
        first, last = (shape[0][list(rows)] for rows in ends)
        assert len(first) == len(last) == len(shape[0]) / 2
        # What joins the ends of an extrusion is one vector.
        assert np.ptp(last - first, axis=0) == pytest.approx(0.0, abs=1e-15)
    assert prism_ends(solid.hull(pyramid(1, 1))[1]) is None
    octahedron = np.vstack((np.eye(3), -np.eye(3)))  # six corners, but eight faces
    assert prism_ends(solid.hull(octahedron)[1]) is None


def test_points_of_many_digits_fit_the_lines():
    vertices, faces = solid.box([(-1.0 / 3e5, -1.0 / 7e5, -1.0 / 9e5), (1e-5 / 3, 1e-5 / 7, 1e-5)])
    lines = block_command(12, Part(vertices, faces))
    assert max(map(len, lines)) <= 80
    found = solid_of(itasca.parse("\n".join(lines)).shapes[0][2:])
    assert sorted(map(tuple, found[0].tolist())) == sorted(map(tuple, vertices.tolist()))


@pytest.mark.parametrize("seed", range(6))
def test_solids_are_read_back_from_their_commands(seed):
    """Hulls of points on a ball, face by face, and boxes as prisms: volume and outward faces."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(9, 3))
    for vertices, faces in (
        solid.hull(points / np.linalg.norm(points, axis=1)[:, None]),
        solid.box([random.uniform(-1, 0, 3), random.uniform(0.5, 1, 3)]),
    ):
        lines = block_command(4, Part(vertices, faces))
        words = itasca.parse("\n".join(lines)).shapes[0]
        assert words[:2] == ["region", "4"]
        found = solid_of(words[2:])
        solid.check(*found)  # closed, faces flat, all one way round
        # Sums over the same corners in another order.
        assert solid.mass_properties(*found).volume == pytest.approx(
            solid.mass_properties(vertices, faces).volume, rel=1e-12
        )


@pytest.mark.parametrize("name", ["load_", "ctl_", "ctl_b", "read_"])
def test_3dec_gets_three_components(name):
    values = itasca.parse(written(solids.one_block(angle=30.0), "3dec")[0]).values
    assert {name + axis for axis in "xyz"} <= values.keys()
    assert "thick" not in values and "leg" not in values


def test_gravity_is_along_z_and_loads_have_three_components():
    text = written(solids.one_block(), "3dec")[0]
    assert "gravity 0.0 0.0 -9.81" in text.splitlines()
    for axis in "xyz":
        assert f"b_{axis}load(ib) = lam * grav * b_mass(ib) * load_{axis}" in text
    plane = written(published_wall(1), "3dec")[0]
    assert "gravity 0.0 -9.81 0.0" in plane.splitlines() and "b_zload" not in plane


def test_the_strategy_is_that_of_the_plane():
    """On supports that carry up to 0.302, and less from there on: it climbs to the first step that
    is not carried, and comes down to where it stops."""
    state = {"carried": 0.302}

    def wall(multiplier: float) -> tuple[float, float]:
        if multiplier > state["carried"]:
            state["carried"] *= 0.9
        return min(multiplier, state["carried"]), 0.302 - state["carried"]

    curve = run_fish(written(solids.one_block(), "3dec")[0], wall)
    applied = np.array([multiplier for _, multiplier in curve])
    np.testing.assert_allclose(applied[:61], 0.005 * np.arange(1, 62))
    assert applied.max() == pytest.approx(0.305) and applied[-1] < 0.01


# LMGC90


def test_the_script_for_lmgc90_runs_the_strategy(monkeypatch, tmp_path):
    """On a stand-in that holds 0.1 of the weight at most: see `fake_pylmgc90`."""
    monkeypatch.chdir(tmp_path)
    model = solids.one_block(stiffness=1e8, point=(0.4, 0.3, 1.5))
    assembly, turn = model.assembly, 0.25
    program = fake_pylmgc90.Chipy(
        assembly.weight, assembly.fixed, contacts=[(1, 0)] * 4, dimension=3, turn=turn
    )
    pre = fake_pylmgc90.install(monkeypatch, program)
    scope: dict = {"__name__": "__main__"}
    exec(compile(written(model, "lmgc90")[0], "script", "exec"), scope)
    moved, applied, carried = np.loadtxt("curve.csv", delimiter=",", skiprows=1).T
    assert applied.max() == pytest.approx(0.105, abs=1e-9)  # the first that is not carried
    assert carried.max() <= 0.1 + 1e-12
    # The joint of 0.4 m x 0.6 m at 1e8 Pa/m over its four points.
    assert [program.internal[k] for k in range(1, 5)] == pytest.approx([6e6] * 4)
    # Read at the top, by (0.2, 0.75) from the centroid, turned about y from z to x.
    way = 0.01 * np.arange(200)
    by_turn = (np.cos(turn) - 1.0) * 0.2 + np.sin(turn) * 0.75
    assert moved[-1] - by_turn == pytest.approx(way[np.argmin(np.abs(way + by_turn - moved[-1]))])
    told = pre.told("rigidPolyhedron")
    assert [len(named["vertices"]) for named in told] == [8, 8]
    assert [named["faces"].shape for named in told] == [(12, 3), (12, 3)]
    assert told[0]["faces"].min() == 1 and told[0]["generation_type"] == "full"
    (see,) = pre.told("see_table")
    assert see["candidat"] == see["antagoniste"] == "POLYR"
    assert scope["WEIGHT"] == pytest.approx(assembly.weight, rel=1e-12)
    centres = [centre for _, centre in scope["SOLIDS"]]
    np.testing.assert_allclose(centres, assembly.centroid, atol=1e-14)


# what is left out, and what is refused


@pytest.mark.parametrize(
    ("target", "corner", "said"),
    [
        ("3dec", Corner(radius=0.01), "rounded"),
        ("3dec", Corner(chamfer=0.01), "chamfered"),
        ("lmgc90", Corner(radius=0.01), "sharp in LMGC90"),
        ("lmgc90", Corner(), "rigid in shear"),
        ("vtk", Corner(), "joints, corners, load and analysis are left out"),
    ],
)
def test_what_a_target_cannot_express_is_listed(target, corner, said):
    _, notes = written(solids.one_block(corner=corner), target)
    assert any(said in note for note in notes)
    assert (
        not corner.radius
        or again(solids.one_block(corner=corner), target).assembly.corner == Corner()
    )


def test_udec_refuses_solids():
    with pytest.raises(ModelError, match="only the plane"):
        written(solids.one_block(), "udec")


@pytest.mark.parametrize("target", ["3dec", "lmgc90"])
def test_blocks_of_several_parts_are_refused(target):
    low, high = solid.box([(0, 0, 0), (1, 1, 0.5)]), solid.box([(0, 0, 0.5), (0.5, 1, 1)])
    steps = Block.of_parts([Part(*low), Part(*high)], id="stairs", unit_weight=1e4)
    base = solids.box("base", (-1, -1, -1), (2, 2, 0), support=True)
    model = solids.model_of([base, steps], solids.joint(0.6), push=(1, 0, 0))
    with pytest.raises(ModelError, match=r'"stairs".*only convex blocks'):
        written(model, target)


@pytest.mark.parametrize("target", ["udec", "3dec", "lmgc90"])
def test_concave_outlines_are_refused(target):
    plane = published_wall(1)
    corner = np.array([[0, 0], [1, 0], [1, 0.5], [0.5, 0.5], [0.5, 1], [0, 1]], float)
    blocks = [plane.assembly.blocks[0], Block(id="L", vertices=corner, unit_weight=1e4)]
    assembly = Assembly.build(blocks, joint=plane.assembly.joint, corner=Corner(radius=0.01))
    model = replace(plane, assembly=assembly, control_point=replace(plane.control_point, block=1))
    with pytest.raises(ModelError, match=r'"L".*only convex blocks'):
        written(model, target)


# VTK


def test_vtk_holds_faces_and_polyhedra(tmp_path):
    model = extruded(published_wall(3).with_corner())
    n = model.assembly.n_bodies
    convert(model, tmp_path / "wall.vtk")
    lines = (tmp_path / "wall.vtk").read_text().splitlines()
    points = np.loadtxt(lines[5 : 5 + 8 * n])
    np.testing.assert_array_equal(points, model.assembly.polyhedra.vertices)
    faces = np.loadtxt(lines[6 + 8 * n : 6 + 14 * n], dtype=int)
    assert lines[5 + 8 * n] == f"POLYGONS {6 * n} {30 * n}"
    # By the divergence theorem, over two triangles of each face.
    a, b, c, d = (points[faces[:, k]] for k in range(1, 5))
    six = np.sum(a * np.cross(b, c), axis=1) + np.sum(a * np.cross(c, d), axis=1)
    # Differences of products of coordinates of some metres.
    np.testing.assert_allclose(
        six.reshape(n, 6).sum(axis=1) / 6.0, model.assembly.volume, rtol=1e-9
    )
    block = lines.index("SCALARS block int 1") + 2
    assert lines[block : block + 6 * n] == [str(k // 6) for k in range(6 * n)]
    convert(model, tmp_path / "wall.vtu")
    assert 'Name="faceoffsets"' in (tmp_path / "wall.vtu").read_text()
