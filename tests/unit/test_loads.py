"""Loads as such: what they sum up to, their keys in files, directions, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
import solids
from drystone.analysis.directions import around, towards
from drystone.cli import app
from drystone.engines.base import EngineError
from drystone.model.loading import Acting, DeadForces
from drystone.model.loading.patterns import PATTERNS
from drystone.report.load_arrows import acting_points
from drystone.report.model_figure import draw_model

#: Sums of a few products of doubles.
ROUNDING = 1e-12
RIGHT = np.array([1.0, 0.0])

FILE = """
title = "wall with a floor"
dimension = 2
thickness = 0.5

[material.stone]
unit_weight = 20e3

[joint]
friction_coefficient = 0.7
normal_stiffness = 1e9
shear_stiffness = 1e9

[[block]]
id = "ground"
vertices = [[-1, -1], [3, -1], [3, 0], [-1, 0]]
support = true

[[block]]
id = "low"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
groups = ["wall"]

[[block]]
id = "high"
vertices = [[0, 1], [0.6, 1], [0.6, 3], [0, 3]]
groups = ["wall"]

[load]
pattern = "mass"
direction = [1.0, 0.0]
"""


def read(tmp_path, *changes, text=FILE, more=""):
    """The model of the file with pieces of text replaced, and more at its end."""
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    (tmp_path / "model.toml").write_text(text + more)
    return ds.read_model(tmp_path / "model.toml")


def dead(**keys):
    return "\n[[dead_load]]\n" + "\n".join(f"{k} = {json.dumps(v)}" for k, v in keys.items())


LISTED = {
    "forces": '[[load.force]]\nblock = "high"\npoint = [0.6, 3.0]\nforce = [500.0, 0.0]\n',
    "acceleration": '[[load.acceleration]]\ngroup = "wall"\nacceleration = [1.0, 0.2]\n',
}


class TestFiles:
    @pytest.mark.parametrize("name", PATTERNS.ours)
    def test_patterns_come_back(self, tmp_path, name):
        text = FILE.replace('"mass"', f'"{name}"')
        if name in LISTED:
            text = text.replace("direction = [1.0, 0.0]\n", "") + LISTED[name]
        model = read(tmp_path, text=text)
        assert model.load.name == name
        ds.write_model(model, tmp_path / "again.toml")
        again = ds.read_model(tmp_path / "again.toml")
        forces = [Acting.of(m.assembly, m.load).pattern for m in (model, again)]
        np.testing.assert_array_equal(forces[0].force, forces[1].force)
        assert (forces[0].lever is None) == (forces[1].lever is None)

    def test_dead_loads_come_back(self, tmp_path):
        model = read(
            tmp_path,
            more=dead(kind="force", block="high", point=[0.1, 3.0], force=[0.0, -900.0], mass=True)
            + dead(kind="surcharge", group="wall", weight=800.0, point="top", mass=False, stage=0)
            + dead(kind="face", block="low", side=[0, 1], total=[0.0, -50.0], mass=True)
            + dead(kind="fill", name="earth", group="wall", side=[-1, 0], unit_weight=18e3,
                   level=2.0, at_rest=0.5, within=10.0, mass=False),
        )  # fmt: skip
        ds.write_model(model, tmp_path / "again.toml")
        again = ds.read_model(tmp_path / "again.toml")
        assert len(again.dead_loads) == 4
        for first, second in zip(model.dead_loads, again.dead_loads, strict=True):
            assert (first.stage, first.mass, first.name) == (
                second.stage, second.mass, second.name,
            )  # fmt: skip
            a, b = first.forces(model.assembly), second.forces(again.assembly)
            np.testing.assert_array_equal(a.force, b.force)

    def test_the_same_curve_from_file_and_python(self, tmp_path):
        model = read(
            tmp_path,
            ('"mass"', '"tilt"'),
            more=dead(kind="force", block="high", point=[0.1, 3.0], force=[0.0, -900.0], mass=True),
        )
        load = ds.ForceLoad(
            block="high", point=np.array([0.1, 3.0]), force=np.array([0.0, -900.0]), mass=True
        )
        made = read(tmp_path).with_load(ds.TiltPattern(direction=RIGHT), dead_loads=(load,))
        curves = [ds.pushover(m, max_steps=5) for m in (model, made)]
        np.testing.assert_array_equal(curves[0].load_multiplier, curves[1].load_multiplier)

    @pytest.mark.parametrize(
        ("changes", "more", "said"),
        [
            ([("[1.0, 0.0]", "[1.0, 0.5]"), ('"mass"', '"tilt"')], "", "acts sideways"),
            ([], 'base = 1.0\n', 'has base, which belongs to pattern = "triangular"'),
            ([('"mass"', '"triangular"')], "base = 9.0\n", "load.base: all blocks lie below it"),
            ([("direction = [1.0, 0.0]\n", ""), ('"mass"', '"forces"')], "", "load.force: is miss"),
            ([], dead(kind="force", block="high", force=[0, -1.0]), "mass is missing"),
            ([], dead(kind="force", block="hig", force=[0, -1], mass=True), "dead_load[1].bl"),
            ([], dead(kind="force", force=[0, -1.0], mass=True), "neither block nor group"),
            ([], dead(kind="force", block="high", force=[0, 9.0], mass=True), "acts upwards"),
            ([], dead(kind="force", block="ground", force=[0, -1.0], mass=True), "is a support"),
            ([], dead(kind="force", block="low", mass=True), "force is missing"),
            ([], dead(kind="force", block="low", force=[0, -1.0, 0], mass=True), "must have 2"),
            ([], dead(kind="force", block="low", point=[5, 5], force=[0, -1], mass=True), "not on"),
            ([], dead(kind="force", block="low", level=1.0, force=[0, -1], mass=True), "has level"),
            ([], dead(kind="face", block="low", side=[0, 1], mass=True), "neither pressure"),
            (
                [],
                dead(kind="face", block="low", side=[0, -1], pressure=[0, -1], mass=True),
                "no free face",
            ),
            (
                [],
                dead(kind="fill", block="low", side=[1, 0], unit_weight=1e4, level=-5.0,
                     at_rest=0.5, mass=True),
                "lies below the faces",
            ),
        ],
    )  # fmt: skip
    def test_what_is_refused(self, tmp_path, changes, more, said):
        with pytest.raises(ds.ModelError, match=said.replace("[", r"\[")):
            read(tmp_path, *changes, more=more)

    def test_acceleration_of_a_block_is_given_once(self, tmp_path):
        text = FILE.replace('"mass"', '"acceleration"').replace("direction = [1.0, 0.0]\n", "")
        with pytest.raises(ds.ModelError, match='block "high" is given two'):
            read(
                tmp_path,
                text=text + LISTED["acceleration"],
                more='[[load.acceleration]]\nblock = "high"\nacceleration = [1.0, 0.0]\n',
            )


class TestFaces:
    def forces(self, tmp_path, **keys):
        model = read(tmp_path, more=dead(mass=False, **keys))
        (load,) = model.dead_loads
        return model, load.forces(model.assembly)

    def test_free_part_of_a_top(self, tmp_path):
        """0.4 of 1 m of the lower top is free, amid 0.6 and 1: 0.3 beside its centroid."""
        keys = {"kind": "face", "block": "low", "side": [0, 1], "pressure": [0.0, -1e4]}
        _, found = self.forces(tmp_path, **keys)
        weight = 1e4 * 0.4 * 0.5
        assert found.force[1] == pytest.approx([0.0, -weight], abs=ROUNDING * weight)
        assert found.moments()[1, 0] == pytest.approx(-weight * 0.3)
        # A total is shared by area: the top of the upper block is 0.6 m long.
        keys = {"kind": "face", "group": "wall", "side": [0, 1], "total": [0.0, -1000.0]}
        _, found = self.forces(tmp_path, **keys)
        assert found.force[1:, 1] == pytest.approx([-400.0, -600.0])

    @pytest.mark.parametrize("level", [3.0, 2.0, 5.0])
    def test_thrust_of_earth(self, tmp_path, level):
        """K g d^2 / 2 at a third of the height from below, of what is under the level."""
        keys = {"kind": "fill", "group": "wall", "side": [-1, 0], "unit_weight": 18e3,
                "level": level, "at_rest": 0.5}  # fmt: skip
        model, found = self.forces(tmp_path, **keys)
        top = max(level - 3.0, 0.0)  # pressed on where the wall ends
        thrust = 0.5 * 18e3 * 0.5 * (level**2 - top**2) / 2.0
        assert found.force.sum(axis=0) == pytest.approx([thrust, 0.0], rel=ROUNDING)
        moments = found.moments()[:, 0] - model.assembly.centroid[:, 1] * found.force[:, 0]
        # About the ground: the integral of -K g (level - y) y from 0 to the top, times 0.5 m.
        y = min(level, 3.0)
        exact = -0.5 * 0.5 * 18e3 * (level * y**2 / 2.0 - y**3 / 3.0)
        assert moments.sum() == pytest.approx(exact)

    def test_weight_of_a_fill(self, tmp_path):
        """On the free step of 0.4 m, two metres under the level."""
        keys = {"kind": "fill", "block": "low", "side": [0, 1], "unit_weight": 18e3,
                "level": 3.0, "at_rest": 0.5}  # fmt: skip
        _, found = self.forces(tmp_path, **keys)
        assert found.force[1] == pytest.approx([0.0, -18e3 * 2.0 * 0.4 * 0.5], abs=1e-9)

    def test_in_space_as_in_the_plane(self, tmp_path):
        """Extruded, the same forces and moments, also where the level cuts a face."""
        for keys in (
            {"kind": "fill", "group": "wall", "side": [-1, 0], "unit_weight": 18e3, "level": 1.7,
             "at_rest": 0.4},
            {"kind": "face", "group": "wall", "side": [0, 1], "pressure": [100.0, -1e4]},
        ):  # fmt: skip
            model, plane = self.forces(tmp_path, **keys)
            solid = ds.extruded(model)
            space = solid.dead_loads[0].forces(solid.assembly)
            assert space.force[:, [0, 2]] == pytest.approx(plane.force)
            # About y, from z towards x: the other way round.
            assert space.moments()[:, 1] == pytest.approx(-plane.moments()[:, 0])

    def test_random_slopes(self):
        """Of a fill over any polygon at K = 1 it is the pressure of a fluid: that on a closed body
        under the level is its volume times the unit weight, upwards at the centroid."""
        rng = np.random.default_rng(3)
        for _ in range(20):
            angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, 6))
            if np.diff(np.append(angle, angle[0] + 2.0 * np.pi)).max() > 2.5:
                continue
            corners = rng.uniform(1.0, 3.0) * np.column_stack((np.cos(angle), np.sin(angle)))
            body = ds.Block(id="b", vertices=corners, unit_weight=1e4)
            assembly = ds.Assembly.build(
                [body],
                joint=ds.JointLaw(friction_coefficient=0.5, normal_stiffness=1, shear_stiffness=1),
            )
            fluid = ds.FillLoad(
                block="b", side=np.array([0.0, 1.0]), within=180.0, unit_weight=1e4, level=9.0,
                at_rest=1.0, mass=False,
            )  # fmt: skip
            found = fluid.forces(assembly)
            assert found.force[0] == pytest.approx([0.0, assembly.weight[0]], abs=1e-8)
            assert found.moments()[0, 0] == pytest.approx(0.0, abs=1e-8)


class TestPictures:
    def test_arrows_end_where_the_sum_acts(self, tmp_path):
        """Of a force at a corner, somewhere on its line of action."""
        model = read(
            tmp_path,
            more=dead(
                kind="force", block="high", point=[0.6, 3.0], force=[300.0, -400.0], mass=True
            ),
        )
        for m in (model, ds.extruded(model)):
            point = acting_points(m.assembly, m.dead_loads[0].forces(m.assembly))[2]
            way = (point - m.dead_loads[0].point) / 500.0
            along = np.array([0.6, -0.8]) if len(way) == 2 else np.array([0.6, 0.0, -0.8])
            assert np.linalg.norm(way - (way @ along) * along) < ROUNDING
            draw_model(m.with_load(ds.MassPattern(direction=m.load_along)), tmp_path / "m.png")
            tilted = m.with_load(ds.TiltPattern(direction=m.load_along))
            draw_model(tilted, tmp_path / "tilted.png")


class TestDeadForces:
    @pytest.mark.parametrize("dimension", [2, 3])
    def test_stiffness_is_how_moments_fall(self, dimension, tmp_path):
        """Against differences over small turns; about principal axes as they were."""
        rng = np.random.default_rng(dimension)
        model = read(tmp_path)
        model = model if dimension == 2 else ds.extruded(model)
        assembly = model.assembly
        body = rng.integers(1, 3, 5)
        points, forces = rng.normal(size=(2, 5, dimension))
        loads = DeadForces.at_points(assembly, body, points, forces)
        pose = assembly.moved(
            assembly.design_pose(), rng.normal(size=(assembly.n_bodies, assembly.n_dof))
        )
        stiffness = loads.stiffness(assembly, pose)
        small = 1e-6
        before = loads.wrenches(assembly, pose)[:, dimension:]
        for k in range(stiffness.shape[1]):
            turn = np.zeros((assembly.n_bodies, assembly.n_dof))
            turn[:, dimension + k] = small
            after = loads.wrenches(assembly, assembly.moved(pose, turn))[:, dimension:]
            if dimension == 3:  # in the axes before: those after have turned as well
                one = np.eye(3)[k]
                after = after + small * np.cross(one, before)
            fall = -(after - before) / small
            assert fall == pytest.approx(stiffness[:, :, k], abs=1e-5)

    def test_near_a_multiplier_tilted_loads_are_their_tangent(self, tmp_path):
        model = read(tmp_path, ('"mass"', '"tilt"'))
        acting = Acting.of(model.assembly, model.load)
        pose = model.assembly.design_pose()

        def load(x):
            dead, pattern = acting.near(pose, x)
            return dead + x * pattern

        weight = model.assembly.weight[1]
        assert load(0.75)[1] == pytest.approx([0.6 * weight, -0.8 * weight, 0.0])
        _, pattern = acting.near(pose, 0.75)
        step = 1e-6
        assert pattern == pytest.approx((load(0.75 + step) - load(0.75 - step)) / (2 * step))


class TestDirections:
    def test_the_model_follows(self, tmp_path):
        model = ds.extruded(read(tmp_path))
        side = towards(model, 90.0)
        assert side.load_along == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)
        assert side.control_point.direction == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)
        assert towards(model, 0.0) is model

    def test_both_senses_of_given_forces(self, tmp_path):
        text = FILE.replace('"mass"', '"forces"').replace("direction = [1.0, 0.0]\n", "")
        model = read(tmp_path, text=text + LISTED["forces"])
        assert towards(model, 180.0).load_along == pytest.approx([-1.0, 0.0])
        with pytest.raises(EngineError, match="has the directions of its forces"):
            towards(ds.extruded(model), 90.0)
        with pytest.raises(EngineError, match="a plane model has"):
            ds.polar(model, 4)

    def test_polar(self, tmp_path):
        """A column of 0.6 m by 0.5 m: each side overturns by itself over its height."""
        model = ds.extruded(read(tmp_path))
        high = model.with_load(direction=(0.0, 1.0, 0.0))
        one = ds.pushover(high, max_steps=8)  # compiles, once
        found = ds.polar(model, [0.0, 90.0], max_steps=8, processes=2)
        assert found.curves[1].load_multiplier == pytest.approx(one.load_multiplier, rel=1e-12)
        assert found.peaks.argmin() == found.weakest
        assert found.plot().name == "rectilinear"  # two directions: their curves

    def test_around_a_structure_what_counts_is_the_capacity(self, tmp_path):
        """A parapet, 0.1 x 0.8 m, overturns at 1/8 across; the wall under it bears 0.6 then."""
        blocks = [
            solids.box("ground", (-2.0, -2.0, -1.0), (4.0, 4.0, 0.0), support=True),
            solids.box("wall", (0.0, 0.0, 0.0), (1.0, 0.6, 1.0)),
            solids.box("parapet", (0.1, 0.25, 1.0), (0.9, 0.35, 1.8)),
        ]
        joint = ds.JointLaw(friction_coefficient=0.9, normal_stiffness=1e10, shear_stiffness=1e10)
        path = tmp_path / "model.toml"
        ds.write_model(solids.model_of(blocks, joint, push=(1.0, 0.0, 0.0), control="wall"), path)
        out = tmp_path / "out"
        arguments = ["run", str(path), "--directions", "4", "--engine", "equilibrium"]
        result = CliRunner().invoke(app, [*arguments, "--out", str(out)])
        assert result.exit_code == 0, result.output
        summary = json.loads((out / "summary.json").read_text())
        assert summary["least_capacity_multiplier"] == pytest.approx(0.125, rel=1e-3)
        assert summary["least_peak_multiplier"] == pytest.approx(0.6, rel=1e-3)
        assert summary["least_capacity_at"] in (90.0, 270.0)
        assert "capacity_multiplier" in (out / "directions.csv").read_text().splitlines()[0]
        assert "before a part collapses, peak 0.5999 of what is left" in result.output
        capacity = f"{summary['least_capacity_multiplier']:.4f}"
        assert f"least capacity         {capacity}" in result.output
        across = str(out / "direction-090")
        picture = ["--out", str(tmp_path / "both.png")]
        compared = CliRunner().invoke(app, ["compare", across, *picture])
        assert capacity in compared.output
        assert "of what is left" in compared.output

    def test_both_senses_watch_the_part_that_falls(self, tmp_path):
        """A slender column, 0.3 x 1.5 m, beside a stout one that is taller and bears 0.5.

        Nobody has named a control point.  In both senses it stayed on the stout one.
        """
        sides = {"stout": (-0.75, 0.75, 3.0), "slender": (3.85, 4.15, 1.5)}
        blocks = [
            ds.Block(
                id=name,
                vertices=[(left, 0.0), (right, 0.0), (right, top), (left, top)],
                unit_weight=20e3,
            )
            for name, (left, right, top) in sides.items()
        ]
        ground = [(-2.0, -0.2), (6.0, -0.2), (6.0, 0.0), (-2.0, 0.0)]
        blocks.append(ds.Block(id="ground", vertices=ground, unit_weight=20e3, support=True))
        joint = ds.JointLaw(friction_coefficient=0.7, normal_stiffness=1e9, shear_stiffness=5e8)
        model = ds.make_model(blocks, joint=joint, load_direction=(1.0, 0.0), thickness=1.0)
        ds.write_model(model, tmp_path / "model.toml")
        arguments = ["run", str(tmp_path / "model.toml"), "--engine", "equilibrium"]
        out = ["--out", str(tmp_path / "out"), "--quiet"]
        told = CliRunner().invoke(app, [*arguments, "--directions", "both", *out])
        assert told.exit_code == 0, told.output
        for row in json.loads((tmp_path / "out" / "summary.json").read_text())["directions"]:
            assert row["peak_multiplier"] == pytest.approx(0.2, rel=2e-3)
            assert row["ultimate_displacement"] == pytest.approx(0.28, abs=0.01)

    def test_run_in_both_senses(self, tmp_path):
        read(tmp_path, more="[analysis]\nmax_steps = 4\n")
        out = tmp_path / "out"
        arguments = ["run", str(tmp_path / "model.toml"), "--directions", "both", "--json"]
        result = CliRunner().invoke(app, [*arguments, "--out", str(out)])
        assert result.exit_code == 3, result.output  # both stopped by the number of steps
        summary = json.loads((out / "summary.json").read_text())
        assert [row["angle"] for row in summary["directions"]] == [0.0, 180.0]
        assert {row["status"] for row in summary["directions"]} == {"stopped"}
        for name in ("direction-000", "direction-180"):
            assert json.loads((out / name / "summary.json").read_text())["n_points"] == 5
        assert (out / "directions.png").exists()
        assert len((out / "directions.csv").read_text().splitlines()) == 3

    @pytest.mark.parametrize("given", ["1", "0", "-3", "all", "361"])
    def test_numbers_that_make_no_sense(self, tmp_path, given):
        read(tmp_path)
        arguments = ["run", str(tmp_path / "model.toml"), "--directions", given]
        assert CliRunner().invoke(app, arguments).exit_code == 2

    def test_a_structure_that_falls_in_every_direction(self, tmp_path):
        """The blocks' sentence once, and nothing is written."""
        text = FILE.replace(
            "[[0, 1], [0.6, 1], [0.6, 3], [0, 3]]", "[[0.8, 1], [2, 1], [2, 3], [0.8, 3]]"
        )
        read(tmp_path, text=text)
        out = tmp_path / "out"
        arguments = ["run", str(tmp_path / "model.toml"), "--directions", "both", "--out", str(out)]
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 2, result.output
        said = result.output.count("does not stand under its own weight")
        assert said == 1, (result.output, result.exception)
        assert not out.exists()


def test_other_programs_get_the_pattern_mass_alone(tmp_path):
    from drystone.io.convert import udec

    model = read(tmp_path)
    tilted = model.with_load(ds.TiltPattern(direction=RIGHT))
    load = ds.SurchargeLoad(group="wall", weight=1.0, mass=False)
    for other in (tilted, model.with_load(dead_loads=(load,))):
        with pytest.raises(ds.ModelError, match="a file for UDEC has"):
            udec.write(replace(other, title="x"))


class TestModalOfLooseBlocks:
    """`Factor is exactly singular`, or the free motion of what touches no support."""

    MOVE = "move them onto one another, or take another pattern"

    def told(self, blocks):
        joint = ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e8, shear_stiffness=1e8)
        pattern = ds.ModalPattern(direction=(1.0, 0.0))
        model = ds.make_model(blocks, joint=joint, thickness=1.0, load=pattern)
        with pytest.raises(ds.ModelError, match=f'"modal" has no mode here: .* {self.MOVE}') as e:
            pattern.mode(model.assembly)
        return str(e.value)

    def test_blocks_that_touch_no_support_are_named(self):
        model = ds.read_model(Path(__file__).parent.parent / "cases" / "modal_no_contact.toml")
        with pytest.raises(ds.ModelError, match=r'blocks "a", "b" have no closed joint'):
            ds.pushover(model)

    def test_of_many_blocks(self):
        """From 20 blocks on modes are found otherwise."""
        floating = [box(f"b{k}", 0.0, 0.1 + 0.2 * k) for k in range(24)]
        told = self.told([box("ground", -2.0, -0.2, support=True), *floating])
        assert 'blocks "b0", "b1", "b2", "b3", "b4" and 19 more have' in told

    def test_beside_a_structure_that_stands(self):
        """Two of three blocks are loose: their free motion has the larger mass."""
        standing = box("low", 0.0, 0.0)
        loose = [box("x", 2.0, 0.0), box("y", 2.0, 0.2)]
        told = self.told([box("ground", 0.0, -0.2, support=True), standing, *loose])
        assert 'blocks "x", "y" have' in told


def box(name, x, y, **more):
    vertices = [[x, y], [x + 0.4, y], [x + 0.4, y + 0.2], [x, y + 0.2]]
    return ds.Block(id=name, vertices=vertices, unit_weight=2e4, **more)


class TestOpposedForces:
    """Two piers pushed apart, the slender one by a little less."""

    def test_a_block_may_be_watched_along_its_own_force(self):
        """The slender pier rocks about its corner: lambda F h = W b / 2."""

        def box(name, x, length, **more):
            outline = np.array([(x, 0.0), (x + length, 0.0), (x + length, 2.0), (x, 2.0)])
            return ds.Block(id=name, vertices=outline, unit_weight=2e4, **more)

        ground = np.array([(-1.0, -0.3), (5.0, -0.3), (5.0, 0.0), (-1.0, 0.0)])
        forces = [
            ds.PointForce(block="a", point="top", force=(1000.0, 0.0)),
            ds.PointForce(block="b", point="top", force=(-1001.0, 0.0)),
        ]
        model = ds.make_model(
            [
                ds.Block(id="ground", vertices=ground, unit_weight=2e4, support=True),
                box("a", 3.0, 0.5),
                box("b", 0.0, 1.5),
            ],
            joint=ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9),
            thickness=1.0,
            load=ds.ForcesPattern(entries=tuple(forces)),
            control_block="a",
            control_direction=(1.0, 0.0),
        )
        curve = ds.pushover(model)
        assert curve.status == "finished"
        assert curve.peak.load_multiplier == pytest.approx(2e4 * 0.25 / (1000.0 * 2.0), rel=2e-3)

    def test_across_the_load_is_refused_all_the_same(self, tmp_path):
        with pytest.raises(ds.ModelError, match="against the load or across it"):
            read(tmp_path).with_control(direction=(-1.0, 0.0))


def test_in_opposite_directions_the_control_points_mirror_each_other(tmp_path):
    """Of a block that topples, all upper corners are as fast: the leading one is watched."""
    path = tmp_path / "column.toml"
    path.write_text(
        """dimension = 3
[material.stone]
unit_weight = 2e4
[joint]
friction_coefficient = 0.6
normal_stiffness = 1e9
shear_stiffness = 1e9
[[block]]
id = "ground"
box = [[-1.0, -1.0, -0.3], [1.0, 1.0, 0.0]]
support = true
[[block]]
id = "b"
box = [[-0.2, -0.2, 0.0], [0.2, 0.2, 1.0]]
[load]
pattern = "mass"
direction = [1.0, 0.0, 0.0]
"""
    )
    models = around(ds.read_model(path), [0.0, 90.0, 180.0, 270.0])
    leading = [float(one.control_point.point @ one.load_along) for one in models]
    assert leading == pytest.approx([0.2] * 4)
