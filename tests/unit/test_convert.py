"""Input files of other programs: what is written is read back and found equal."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

import fake_pylmgc90
from builders import PUBLISHED_JOINT, convex_polygons, rectangle, stack, turned
from drystone.cli import app
from drystone.io.convert import common, convert, itasca, read, target_of
from drystone.io.modelfile import write_model
from drystone.model.assembly import Block, Corner
from drystone.model.builders import ModelError, extruded, make_model, published_wall
from drystone.model.history import History
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model

#: Rounding of a friction angle, a density and a corner that was cut off and put back.
CLOSE = 1e-11


def written(model: Model, target: str) -> tuple[str, tuple[str, ...]]:
    found = target_of("", target).write(model, "file")
    return found.text, found.notes


def again(model: Model, target: str) -> Model:
    reader = target_of("", target).read
    assert reader is not None
    return reader(written(model, target)[0])


def assert_same_law(a: JointLaw, b: JointLaw, *, shear: bool = True) -> None:
    for key, value in vars(a).items():
        if shear or key != "shear_stiffness":
            same = value if value is None else pytest.approx(value, rel=CLOSE)
            assert getattr(b, key) == same, key


def assert_same(a: Model, b: Model, *, shear: bool = True) -> None:
    """Blocks, supports, joints where blocks touch, load, control point and strategy."""
    p, q = a.assembly, b.assembly
    assert q.ids == p.ids
    assert [block.material for block in q.blocks] == [block.material for block in p.blocks]
    np.testing.assert_array_equal(q.fixed, p.fixed)
    for mine, theirs in zip(p.blocks, q.blocks, strict=True):
        np.testing.assert_allclose(theirs.vertices, mine.vertices, rtol=0.0, atol=CLOSE)
    np.testing.assert_allclose(q.weight, p.weight, rtol=CLOSE)
    assert q.thickness == p.thickness
    assert_same_law(p.joint, q.joint, shear=shear)
    first, second = p.outlines.near_pairs()
    for i, j in zip(p.law_index(first, second), q.law_index(first, second), strict=True):
        assert_same_law(p.laws[i], q.laws[j], shear=shear)
    assert b.title == a.title
    np.testing.assert_allclose(b.load.direction, a.load.direction, rtol=CLOSE, atol=CLOSE)
    assert b.control_point.block == a.control_point.block
    np.testing.assert_array_equal(b.control_point.point, a.control_point.point)
    np.testing.assert_allclose(b.control_point.direction, a.control_point.direction, atol=CLOSE)
    assert b.analysis.stop_multiplier == a.analysis.stop_multiplier
    assert common.strategy(b) == common.strategy(a)


def is_stout(polygon: np.ndarray) -> bool:
    """No sliver: one loses its digits where its corners are cut off, or all of its edges."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    length = np.hypot(*edges.T)
    cosine = np.sum(edges * np.roll(edges, -1, axis=0), axis=1) / length / np.roll(length, -1)
    return bool(length.min() > 0.03 and cosine.min() > -0.9)


@st.composite
def models(draw, *, friction_only: bool = False, corners: bool = True) -> Model:
    """A turned stack of unequal blocks, and a convex polygon by itself, also a support."""
    tilt = draw(st.floats(-0.3, 0.3))
    heights = draw(st.lists(st.floats(0.2, 0.9), min_size=1, max_size=4))
    names = draw(
        st.lists(
            st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S")), min_size=1),
            min_size=len(heights) + 2,
            max_size=len(heights) + 2,
            unique=True,
        )
    )
    stone = {name: draw(st.floats(1e3, 3e4)) for name in ("stone", 'b"ri\\ck')}
    outlines = [rectangle(-3.0, -1.0, 6.0, 1.0)]
    y = 0.0
    for height in heights:
        outlines.append(rectangle(draw(st.floats(-0.5, 0.0)), y, 0.8, height))
        y += height
    outlines = [turned(v, tilt) for v in outlines]
    outlines.append(draw(convex_polygons().filter(is_stout)) + (10.0, 3.0))
    material = [draw(st.sampled_from(sorted(stone))) for _ in outlines]
    blocks = [
        Block(
            id=name, vertices=v, unit_weight=stone[m], material=m,
            support=i in (0, len(outlines) - 1),
        )
        for i, (name, v, m) in enumerate(zip(names, outlines, material, strict=True))
    ]  # fmt: skip

    def law(friction: float) -> JointLaw:
        rest = {} if friction_only else {
            "dilatancy_angle": draw(st.floats(0.0, 5.0)),
            "dilatancy_end": draw(st.sampled_from((np.inf, 0.05))),
            "cohesion": draw(st.floats(0.0, 1e6)),
            "tensile_strength": draw(st.floats(0.0, 1e6)),
        }  # fmt: skip
        return JointLaw(
            friction_coefficient=friction,
            normal_stiffness=draw(st.floats(1e7, 1e11)),
            shear_stiffness=draw(st.floats(1e7, 1e11)),
            **rest,
        )

    friction = draw(st.floats(0.1, 1.2))
    between = {}
    if draw(st.booleans()):
        other = friction if friction_only else draw(st.floats(0.1, 1.2))
        between = {frozenset((names[0], names[1])): law(other)}
    angle = draw(st.floats(-np.pi, np.pi))
    size = draw(st.floats(0.001, 0.003))
    corner = draw(st.sampled_from((Corner(radius=size), Corner(chamfer=size), Corner())))
    return make_model(
        blocks,
        joint=law(friction),
        joint_between=between,
        corner=corner if corners else Corner(radius=size),
        thickness=draw(st.floats(0.1, 2.0)),
        load_direction=(np.cos(angle), np.sin(angle)),
        analysis=Analysis(
            stop_multiplier=draw(st.floats(0.001, 0.1)),
            options={"overshoot": draw(st.floats(1.0, 1.1)), "patience": 7.0},
        ),
        title=draw(st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "Zs")))),
    )


@given(models(corners=False))
@settings(max_examples=40, deadline=None)
def test_udec_is_read_back(model):
    found = again(model, "udec")
    assert_same(model, found)
    assert found.assembly.corner == model.assembly.corner


@given(models())
@settings(max_examples=40, deadline=None)
def test_3dec_is_read_back(model):
    found = again(model, "3dec")
    assert_same(model, found)
    corner = model.assembly.corner  # a radius becomes a chamfer, which a note says
    assert found.assembly.corner == Corner(chamfer=corner.chamfer or corner.radius)
    # The prisms weigh what the blocks do, although their corners are off.
    prisms = common.chamfered(model.assembly)
    stuff = common.materials(model.assembly, prisms)
    density = [stuff.density[k - 1] for k in stuff.of_block]
    area = [0.5 * abs(np.sum(np.cross(p, np.roll(p, -1, axis=0)))) for p in _in_space(prisms)]
    weight = np.array(area) * density * model.assembly.thickness * 9.81
    np.testing.assert_allclose(weight, model.assembly.weight, rtol=CLOSE)


def _in_space(outlines):
    return [np.column_stack((outline, np.zeros(len(outline)))) for outline in outlines]


@given(models(friction_only=True))
@settings(max_examples=40, deadline=None)
def test_the_script_for_lmgc90_is_read_back(model):
    text, _ = written(model, "lmgc90")
    compile(text, "script", "exec")
    found = again(model, "lmgc90")
    assert_same(model, found, shear=False)  # a note says that it is left out
    corner = model.assembly.corner
    assert found.assembly.corner == Corner(chamfer=corner.chamfer or corner.radius)


@pytest.mark.parametrize("wall", [1, 2, 3])
@pytest.mark.parametrize("target", ["udec", "3dec", "lmgc90"])
def test_the_published_walls_are_read_back(wall, target):
    model = published_wall(wall)
    assert_same(model, again(model, target), shear=target != "lmgc90")


@pytest.mark.parametrize("target", ["udec", "3dec"])
def test_lines_fit_and_what_begins_ends(target):
    text, _ = written(published_wall(1), target)
    assert text.isascii()
    lines = [line.partition(";")[0].strip() for line in text.splitlines()]
    assert max(map(len, text.splitlines())) <= 80
    for opening, closing in (
        ("def ", "end"), ("loop ", "end_loop"), ("if ", "end_if"), ("command", "end_command"),
    ):  # fmt: skip
        count = sum(line.startswith(opening) for line in lines)
        assert count == lines.count(closing) > 0
    # What is called has been defined before.
    defined: set[str] = set()
    for line in lines:
        if line.startswith("def "):
            defined.add(line.split()[1].partition("(")[0])
        if line.startswith("@"):
            assert line[1:].partition("(")[0] in defined


def test_the_file_carries_the_strategy():
    model = published_wall(1, analysis=Analysis(options={"overshoot": 1.01, "patience": 5.0}))
    values = itasca.parse(written(model, "udec")[0]).values
    assert values["overshoot"] == 1.01
    assert values["patience"] == 5.0
    assert values["increment"] == 0.005  # the published strategy's default
    assert values["stop_mult"] == 0.01


def fish_as_python(text: str, function: str) -> list[str]:
    """The body of a FISH function in Python, indented.

    The grammar that the strategy is written in is small: assignments, ``if``, ``loop while``.
    """
    start = text.index(f"def {function}")
    body = text[start : text.index("\nend\n", start)].splitlines()[1:]
    python, depth = [], 1
    for raw in body:
        line = raw.strip()
        if line in ("end_if", "end_loop"):
            depth -= 1
            continue
        if line == "else":
            python.append("  " * (depth - 1) + "else:")
            continue
        opened = False
        if line.startswith("if "):
            line, opened = "if " + compared(line[3:].removesuffix(" then")) + ":", True
        elif line.startswith("loop while "):
            line, opened = "while " + compared(line[11:]) + ":", True
        elif line.startswith(("xtable", "ytable")):
            name, value = line.split(" = ")
            table, row = name[7:-1].split(", ")
            line = f"table[{name[0]!r}, {table}, {row}] = {value}"
        elif line == "look":
            line = "lam_c, ctl_u = look(lam)"
        python.append("  " * depth + line)
        depth += opened
    return python


def compared(condition: str) -> str:
    """A condition of FISH in Python."""
    return condition.replace(" = ", " == ").replace(" # ", " != ")


def run_fish(text: str, wall) -> list[tuple[float, float]]:
    """Run the file's ``pushover`` on a stand-in for the wall."""
    table: dict = {}
    scope = {**itasca.parse(text).values, "look": wall, "table": table}
    names = ", ".join(f"{key}=0.0" for key in ("lam_c", "ctl_u"))
    exec(f"def pushover({names}):\n" + "\n".join(fish_as_python(text, "pushover")), scope)
    scope["pushover"]()
    n = max(row for _, _, row in table)
    return [(table["x", 1, k], table["y", 1, k]) for k in range(1, n + 1)]


@pytest.mark.parametrize("target", ["udec", "3dec"])
@pytest.mark.parametrize(
    ("softening", "waited"),
    [
        (0.002, 21),  # the first and twenty more
        (0.01, 11),  # until a tenth less is carried, and what counts as equal
    ],
)
def test_the_strategy_in_fish_is_the_published_one(target, softening, waited):
    """On a wall of one degree of freedom whose supports carry up to 0.3 (1 - u): the curve climbs
    by increments to the first multiplier that is not carried, waits out its patience or until the
    wall falls, then follows the recursion down to the stop value."""
    state = {"u": 0.0}

    def wall(multiplier: float) -> tuple[float, float]:
        capacity = 0.3 * (1.0 - state["u"])
        if multiplier > capacity:
            state["u"] = min(state["u"] + softening, 1.0)
        return min(multiplier, capacity), state["u"]

    curve = run_fish(written(published_wall(1), target)[0], wall)
    applied = np.array([multiplier for _, multiplier in curve])
    peak = int(np.argmax(applied))
    np.testing.assert_allclose(applied[:60], 0.005 * np.arange(1, 61))
    assert applied[peak] == pytest.approx(0.305 if applied[peak] < 0.31 else 1.05 * 0.3, abs=1e-9)
    assert int(np.sum(np.isclose(applied, 0.305))) == waited
    descent = applied[peak:]
    assert np.all(np.diff(descent)[1:] <= 0.0)
    assert applied[-1] < 0.01 <= applied[-2]


@pytest.mark.parametrize("direction", [(1.0, 0.0), (1.0, 1.0), (1.0, -0.5)])
@pytest.mark.parametrize(
    ("target", "solid"),
    [("udec", False), ("3dec", False), ("3dec", True), ("lmgc90", False), ("lmgc90", True)],
)
def test_what_is_carried_of_a_load_that_leans(target, solid, direction, monkeypatch):
    """The supports carry the weight, too, and with it a part along the load: 0.7 of the load at
    multiplier zero was told where it leads up by 45 degrees."""
    model = stack((0.4, 1.0), direction=direction)
    model = extruded(model) if solid else model
    weight, along, axes = model.assembly.weight, model.load_along, "xyz"[: 3 if solid else 2]
    text = written(model, target)[0]
    for multiplier in (0.0, 0.05):
        force = multiplier * weight[1] * along - weight[1] * np.eye(len(axes))[-1]  # on the support
        if target == "lmgc90":
            program = fake_pylmgc90.Chipy(weight, model.assembly.fixed, [], dimension=len(axes))
            fake_pylmgc90.install(monkeypatch, program)
            scope: dict = {"__name__": "script"}
            exec(compile(text, "script", "exec"), scope)
            scope["begin"]()
            assert scope["step"](multiplier)[0] == pytest.approx(multiplier, abs=1e-12)
            continue
        values = itasca.parse(text).values
        force -= weight[0] * np.eye(len(axes))[-1]  # programs add it to what acts on a block
        known = {
            "block_head": 1, "total": weight[1], **values,
            "b_fix": lambda body: body == 1, "b_next": {1: 2, 2: 0}.get,
            "b_mass": dict(enumerate(weight / values["grav"], start=1)).get,
            **{f"b_{a}force": {1: f, 2: 0.0}.get for a, f in zip(axes, force, strict=True)},
        }  # fmt: skip
        body = [*fish_as_python(text, "read_carried"), "  return lam_c"]
        exec("def read_carried():\n" + "\n".join(body), known)
        assert known["read_carried"]() == pytest.approx(multiplier, abs=1e-12)


def test_the_script_for_lmgc90_runs_the_strategy(monkeypatch, tmp_path):
    """On a stand-in that holds 0.1 of the weight at most: see `fake_pylmgc90`."""
    monkeypatch.chdir(tmp_path)
    model = stack((0.4, 0.5), (0.4, 0.5), corner=Corner(radius=0.02))
    assembly = model.assembly
    program = fake_pylmgc90.Chipy(
        assembly.weight, assembly.fixed, contacts=[(0, 1), (0, 1), (2, 1), (2, 1), (0, 2)]
    )
    pre = fake_pylmgc90.install(monkeypatch, program)
    scope: dict = {"__name__": "__main__"}
    exec(compile(written(model, "lmgc90")[0], "script", "exec"), scope)
    curve = np.loadtxt("curve.csv", delimiter=",", skiprows=1)
    moved, applied, carried = curve.T
    peak = int(np.argmax(applied))
    assert applied[peak] == pytest.approx(0.105, abs=1e-9)  # the first that is not carried
    waited = np.isclose(applied, 0.105)
    assert waited.sum() >= 11
    # Until it has fallen by a tenth, and by what counts as equal.
    assert carried[waited][-1] < 0.9 * carried.max() - 1e-3 <= carried[waited][-2]
    assert applied[-1] < 0.01 <= applied[-2]
    below = slice(peak + 15, -1)
    np.testing.assert_allclose(applied[below][1:], 1.05 * carried[below][:-1])
    assert moved[-1] > 0.85
    # Each joint of 0.4 m2 at 1e8 Pa/m is shared over its two points; the pair that does not touch
    # gets the spare stiffness: block size 0.4 m by 1 m.
    assert [program.internal[k] for k in range(1, 6)] == pytest.approx([2e7] * 4 + [4e7])
    # The corners are off, the weight is not.
    outlines = [named["vertices"] for named in pre.told("rigidPolygon")]
    assert [len(outline) for outline in outlines] == [8, 8, 8]
    density = [named["density"] for named in pre.told("material")]
    area = 0.4 * 0.5 - 4 * 0.5 * 0.02**2
    assert max(density) == pytest.approx(0.4 * 0.5 * 1e4 / 9.81 / area)


CRUSHED = replace(PUBLISHED_JOINT, compressive_strength=1e7)


@pytest.mark.parametrize(
    ("target", "change", "said"),
    [
        ("udec", {"corner": Corner(chamfer=0.02)}, "no chamfers"),
        ("udec", {"corner": Corner()}, "no sharp corners"),
        ("3dec", {"corner": Corner(radius=0.02)}, "no rounded corners"),
        ("lmgc90", {"corner": Corner(radius=0.02)}, "no rounded corners"),
        ("lmgc90", {}, "rigid in shear"),
        ("udec", {"analysis": Analysis(options={"max_steps": 10.0})}, "max_steps"),
        ("udec", {"control_point": "centre"}, "nearest corner"),
        ("3dec", {"control_point": "centre"}, "nearest corner"),
        *((target, {"points": 16}, "16 contact points") for target in ("udec", "3dec", "lmgc90")),
        ("udec", {"joint": CRUSHED}, "compressive_strength left out"),
        ("3dec", {"joint": CRUSHED}, "compressive_strength left out"),
        ("udec", {"history": History(targets=(0.01, -0.01))}, "the history of displacements"),
        ("vtk", {}, "joints, corners, load and analysis are left out"),
    ],
)
def test_what_a_target_cannot_express_is_listed(target, change, said):
    _, notes = written(stack((0.4, 1.0), **change), target)
    assert any(said in note for note in notes)


def test_a_wall_of_another_thickness_is_noted_for_udec():
    blocks = stack((0.4, 1.0)).assembly.blocks
    model = make_model(blocks, joint=PUBLISHED_JOINT, thickness=0.5, load_direction=(1.0, 0.0))
    _, notes = written(model, "udec")
    assert any("1 m thick" in note for note in notes)


def test_corners_that_are_not_right_are_noted_for_udec():
    triangle = np.array([[-0.5, 0.0], [0.5, 0.0], [0.0, 0.8]])
    blocks = [
        Block(id="base", vertices=rectangle(-1, -1, 2, 1), unit_weight=1e4, support=True),
        Block(id="t", vertices=triangle, unit_weight=1e4),
    ]
    model = make_model(
        blocks,
        joint=PUBLISHED_JOINT,
        thickness=1.0,
        load_direction=(1.0, 0.0),
        corner=Corner(radius=0.02),
    )
    assert any("not right" in note for note in written(model, "udec")[1])
    assert not any("not right" in note for note in written(published_wall(1), "udec")[1])


@pytest.mark.parametrize("target", ["udec", "3dec", "lmgc90"])
def test_stiffnesses_are_needed(target):
    model = stack((0.4, 1.0), joint=replace(PUBLISHED_JOINT, shear_stiffness=None))
    with pytest.raises(ModelError, match="shear_stiffness"):
        written(model, target)


def test_laws_that_lmgc90_has_not_are_refused():
    model = stack((0.4, 1.0), joint=replace(PUBLISHED_JOINT, cohesion=1e3))
    with pytest.raises(ModelError, match="cohesion"):
        written(model, "lmgc90")


@pytest.mark.parametrize("target", ["udec", "3dec", "lmgc90"])
@pytest.mark.parametrize("text", ["", "new\n", "BLOCKS = 1\n", "def (\n"])
def test_other_files_are_refused(target, text):
    reader = target_of("", target).read
    assert reader is not None
    with pytest.raises(ModelError, match=r"drystone (wrote|did not write)"):
        reader(text)


def test_vtk_holds_outlines_supports_and_weights(tmp_path):
    model = published_wall(3)
    convert(model, tmp_path / "wall.vtk")
    lines = (tmp_path / "wall.vtk").read_text().splitlines()
    assert lines[0].startswith("# vtk DataFile") and lines[2:4] == ["ASCII", "DATASET POLYDATA"]
    n = 4 * model.assembly.n_bodies
    points = np.loadtxt(lines[5 : 5 + n])
    np.testing.assert_array_equal(
        points[:, :2], np.vstack([block.vertices for block in model.assembly.blocks])
    )
    polygons = np.loadtxt(lines[6 + n : 6 + n + model.assembly.n_bodies], dtype=int)
    np.testing.assert_array_equal(polygons[:, 1:], np.arange(n).reshape(-1, 4))
    weights = lines[lines.index("SCALARS weight double 1") + 2 :]
    np.testing.assert_array_equal([float(w) for w in weights], model.assembly.weight)
    convert(model, tmp_path / "wall.vtu")
    assert "UnstructuredGrid" in (tmp_path / "wall.vtu").read_text()


def test_the_ending_or_the_name_says_which_target():
    assert target_of("wall.dat").name == "udec"
    assert target_of("wall.3ddat").name == "3dec"
    assert target_of("wall.py").name == "lmgc90"
    assert target_of("wall.VTU").name == "vtk"
    assert target_of("wall.dat", "3dec").name == "3dec"
    with pytest.raises(ModelError, match="belongs to no program"):
        target_of("wall.txt")
    with pytest.raises(ModelError, match="no target"):
        target_of("wall.dat", "abaqus")


def test_files_are_read_by_their_names(tmp_path):
    model = published_wall(1)
    convert(model, tmp_path / "wall.dat", "3dec")
    assert read(tmp_path / "wall.dat", "3dec").assembly.ids == model.assembly.ids
    with pytest.raises(ModelError, match="only its geometry"):
        read(tmp_path / "wall.vtk")


def test_the_command_writes_and_tells(tmp_path):
    write_model(published_wall(1), tmp_path / "wall.toml")
    run = CliRunner().invoke(
        app, ["convert", str(tmp_path / "wall.toml"), str(tmp_path / "wall.py"), "--json"]
    )
    assert run.exit_code == 0, run.output
    told = json.loads(run.stdout)
    assert told["target"] == "lmgc90"
    assert any("shear stiffness" in note for note in told["notes"])
    assert Path(told["file"]).is_file()
    run = CliRunner().invoke(app, ["convert", str(tmp_path / "wall.toml"), "wall.txt"])
    assert run.exit_code == 2
    assert "belongs to no program" in run.stderr


@pytest.mark.parametrize("target", ["3dec", "lmgc90"])
def test_chamfers_longer_than_an_edge_are_refused(tmp_path, target):
    """At blunt corners a radius takes r tan(15 degrees) of an edge, a chamfer all of the radius."""
    angle = np.radians(15.0 + 30.0 * np.arange(12))
    round_stone = 0.2 * np.column_stack((np.cos(angle), np.sin(angle)))
    round_stone[:, 1] -= round_stone[:, 1].min()
    base = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.0], [-1.0, 0.0]])
    model = make_model(
        [
            Block(id="base", vertices=base, unit_weight=1e4, support=True),
            Block(id="b", vertices=round_stone, unit_weight=1e4),
        ],
        joint=JointLaw(friction_coefficient=0.6, normal_stiffness=1e8, shear_stiffness=1e8),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        corner=Corner(radius=0.08),  # edges are 0.104 m long
    )
    with pytest.raises(ModelError, match='at block "b": corners become chamfers, and the chamfer'):
        convert(model, tmp_path / "model.dat", target)
    assert not (tmp_path / "model.dat").exists()


def test_a_block_of_udec_without_corners_is_refused(tmp_path):
    """In a sentence, and without a warning of the libraries beside."""
    path = tmp_path / "a.dat"
    path.write_text(written(published_wall(1), "udec")[0])
    kept = path.read_text().splitlines()
    blocks = [k for k, line in enumerate(kept) if line.startswith("block ")]
    kept[blocks[-1]] = "block "
    path.write_text("\n".join(kept))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ModelError, match="fewer than three corners"):
            read(path)
