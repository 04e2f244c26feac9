"""Loads against closed forms: blocks that rock, slide and rest under each pattern and dead load.

Of a block that rocks on a vertex the moments of all loads about that vertex vanish, wherever it has
come to; each force keeps its direction and acts at its point of the block.  That gives the
multiplier from the pose alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

import drystone as ds
import solids
from drystone.limit import collapse_load, limits_beside
from drystone.model.inspection import VibrationMode
from drystone.model.loading import NO_MASSES, Acting, masses_of
from drystone.model.loading.modal import _bar_rows, first_mode, mass_matrices
from drystone.model.tie_kernels import ELONGATION, N_NOW, locate
from drystone.model.ties import Bars
from lmgc90_here import needs_lmgc90

UNIT_WEIGHT, THICKNESS = 20e3, 0.5
WIDTH, HEIGHT = 0.4, 1.0
WEIGHT = UNIT_WEIGHT * WIDTH * HEIGHT * THICKNESS  # N
RIGHT = np.array([1.0, 0.0])
#: Of rocking branches against rigid blocks with the toe where it is, over the larger of 1 and the
#: multiplier: a static step of 30 s leaves inertia of 3e-7 of the weight.
EXACT = 1e-6
#: What `distinct` is asked for; it rests at 1e-5 of the weight.
AT_REST = 1e-4


def box(name, x, y, width=WIDTH, height=HEIGHT, **more):
    corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    return ds.Block(id=name, vertices=np.array(corners), unit_weight=UNIT_WEIGHT, **more)


def column(n=1, *, load=None, dead=(), friction=5.0, stiffness=1e9, width=WIDTH, **more):
    """A column of n blocks as high as one, on a ground of rock."""
    height = HEIGHT / n
    blocks = [box("ground", -1.0, -0.5, 3.0, 0.5, support=True)]
    blocks += [box(f"b{k}", 0.0, k * height, width, height, groups=("all",)) for k in range(n)]
    return ds.make_model(
        blocks,
        joint=ds.JointLaw(
            friction_coefficient=friction, normal_stiffness=stiffness, shear_stiffness=stiffness
        ),
        thickness=THICKNESS,
        load=load or ds.MassPattern(direction=RIGHT),
        dead_loads=dead,
        **more,
    )


#: Of ties: what they are, and whether they are under tension where the block rests.
TAUT = [
    ({"compression": True}, True),
    ({"compression": False, "pretension": 100.0}, True),
    ({"compression": False}, False),
]


@dataclass(frozen=True)
class At:
    """A force at a point of a block as designed; `tilts` with the table, or is the pattern's."""

    block: int
    point: tuple[float, float]
    force: tuple[float, float]
    scaled: bool = False  # by the multiplier
    tilts: bool = False


def weights(n, share=None, width=WIDTH):
    """Weight of each block, and forces as large along the pattern times its share."""
    found = []
    for k in range(n):
        place, own = (0.5 * width, (k + 0.5) * HEIGHT / n), WEIGHT * width / WIDTH / n
        found.append(At(k + 1, place, (0.0, -own), tilts=True))
        part = own if share is None else own * share[k]
        found.append(At(k + 1, place, (part, 0.0), scaled=True, tilts=True))
    return found


def multiplier_of(model, pose, forces, *, tilt=False):
    """From the moments about the lowest right vertex, in a pose."""
    assembly = model.assembly

    def place(block, point):
        return np.asarray(point) + assembly.displacement_at(block, point, pose)

    toe = place(1, (WIDTH, 0.0))
    steady, turned, scaled = 0.0, 0.0, 0.0
    for one in forces:
        arm = place(one.block, one.point) - toe
        moment = arm[0] * one.force[1] - arm[1] * one.force[0]
        if one.scaled:
            scaled += moment
        elif tilt and one.tilts:
            turned += moment
        else:
            steady += moment
    if not tilt:
        return -steady / scaled
    return brentq(
        lambda x: (turned + x * scaled) / np.sqrt(1.0 + x * x) + steady, -1.0, 100.0, xtol=1e-14
    )


def rocking_errors(model, engine, forces, **options):
    """Errors of the multiplier over the larger of 1 and itself, where the block rocks."""
    curve = ds.pushover(model, engine=engine, keep_poses=True, **options)
    tilt = model.load.name == "tilt"
    errors, values = [], []
    for point, pose in zip(curve.points, curve.poses, strict=True):
        if point.status == "static" and abs(pose[1, 2]) > 0.004:  # else a joint still closes
            exact = multiplier_of(model, pose, forces, tilt=tilt)
            errors.append((point.load_multiplier - exact) / max(1.0, abs(exact)))
            values.append(exact)
    assert len(errors) > 3
    return np.array(errors), np.array(values), curve


LOAD = 0.6 * WEIGHT
POINT = (0.1, HEIGHT)
ECCENTRIC = ds.ForceLoad(
    block="b0", point=np.array(POINT), force=np.array([0.0, -LOAD]), mass=False
)
HEAVY = ds.ForceLoad(block="b0", point=np.array(POINT), force=np.array([0.0, -LOAD]), mass=True)
ON_TOP = replace(HEAVY, point="top")
HELD = ds.ForceLoad(
    block="b0", point=np.array([0.0, 0.8]), force=np.array([-200.0, -100.0]), mass=False
)
#: Model, the forces on it by hand.
CASES = {
    "mass": (column(), weights(1)),
    "uniform": (column(load=ds.UniformPattern(direction=RIGHT)), weights(1)),
    "tilt": (column(load=ds.TiltPattern(direction=RIGHT)), weights(1)),
    "triangular": (
        # Heights 1/4 and 3/4, of mean 1/2.
        column(2, load=ds.TriangularPattern(direction=RIGHT)),
        weights(2, (0.5, 1.5)),
    ),
    "acceleration": (
        column(
            2,
            load=ds.AccelerationPattern(
                entries=(ds.Acceleration(block="b1", acceleration=np.array([0.7, 0.0])),)
            ),
        ),
        weights(2, (0.0, 0.7)),
    ),
    "forces": (
        column(
            load=ds.ForcesPattern(
                entries=(
                    ds.PointForce(block="b0", point="top", force=np.array([900.0, 0.0])),
                    ds.PointForce(
                        block="b0", point=np.array([0.0, 0.5]), force=np.array([300.0, 120.0])
                    ),
                )
            )
        ),
        [
            *weights(1)[:1],
            At(1, (0.2, 1.0), (900.0, 0.0), scaled=True),
            At(1, (0.0, 0.5), (300.0, 120.0), scaled=True),
        ],
    ),
    "eccentric load": (column(dead=(ECCENTRIC,)), [*weights(1), At(1, POINT, (0.0, -LOAD))]),
    "load with mass": (
        column(dead=(HEAVY,)),
        [*weights(1), At(1, POINT, (0.0, -LOAD)), At(1, POINT, (LOAD, 0.0), scaled=True)],
    ),
    "triangular and load with mass": (
        # Heights 1/2 and 1, of mean (0.5 + 0.6)/1.6 = 11/16 by weight.
        column(load=ds.TriangularPattern(direction=RIGHT), dead=(HEAVY,)),
        [
            *weights(1, (8.0 / 11.0,)),
            At(1, POINT, (0.0, -LOAD)),
            At(1, POINT, (16.0 / 11.0 * LOAD, 0.0), scaled=True),
        ],
    ),
    "tilt and load": (
        column(load=ds.TiltPattern(direction=RIGHT), dead=(HELD,)),
        [*weights(1), At(1, (0.0, 0.8), (-200.0, -100.0))],
    ),
    "tilt and load with mass": (
        column(load=ds.TiltPattern(direction=RIGHT), dead=(HEAVY,)),
        [
            *weights(1),
            At(1, POINT, (0.0, -LOAD), tilts=True),
            At(1, POINT, (LOAD, 0.0), scaled=True, tilts=True),
        ],
    ),
}


class TestRocking:
    @pytest.mark.parametrize("case", CASES)
    def test_equilibrium_is_exact(self, case):
        model, forces = CASES[case]
        error, values, curve = rocking_errors(model, "equilibrium", forces)
        assert curve.status == "finished"
        assert np.ptp(values) > 0.1  # down the branch
        assert np.abs(error).max() < EXACT

    @pytest.mark.parametrize("case", ["tilt", "forces", "load with mass", "tilt and load"])
    def test_distinct(self, case):
        model, forces = CASES[case]
        error, _, _ = rocking_errors(model, "distinct", forces, max_steps=12)
        assert np.abs(error).max() < AT_REST

    @pytest.mark.parametrize("case", ["tilt", "eccentric load"])
    def test_nscd_comes_to_it_with_the_step(self, case):
        """Loads are those where a step starts: of first order, falling with it; steps of a curve
        adapt, so that a quarter of the largest is about half of the mean."""
        model, forces = CASES[case]
        worst = [
            np.abs(rocking_errors(model, "nscd", forces, displacement_step=step)[0]).max()
            for step in (2e-3, 5e-4)
        ]
        assert worst[0] < 0.02
        assert worst[1] < 0.65 * worst[0]

    @needs_lmgc90
    @pytest.mark.parametrize("case", ["tilt", "load with mass"])
    def test_lmgc90(self, case):
        """Of first order as well, with the steps of its own: 4e-4 to 9e-4."""
        model, forces = CASES[case]
        error, _, _ = rocking_errors(model, "lmgc90", forces, max_steps=75)
        assert np.abs(error).max() < 3e-3

    @pytest.mark.parametrize("engine", ["equilibrium", "distinct"])
    @pytest.mark.parametrize("case", ["tilt and load", "load with mass"])
    def test_the_same_in_space(self, case, engine):
        """A plane model as solids, whose displacements are those of the plane."""
        model, forces = CASES[case]
        steps = {"max_steps": 36}
        curve = ds.pushover(ds.extruded(model), engine=engine, keep_poses=True, **steps)
        seen = 0
        for point, pose in zip(curve.points, curve.poses, strict=True):
            plane = np.zeros((2, 3))
            plane[:, :2] = pose[:, [0, 2]]
            # About y, from z towards x: the other way round than from x to z.
            plane[:, 2] = -2.0 * np.arctan2(pose[:, 5], pose[:, 3])
            if abs(plane[1, 2]) > 0.004:
                exact = multiplier_of(model, plane, forces, tilt=model.load.name == "tilt")
                wanted = EXACT if engine == "equilibrium" else AT_REST
                assert abs(point.load_multiplier - exact) < wanted * max(1.0, exact)
                seen += 1
        assert seen > 1

    def test_random_forces(self):
        """Any forces at any points, that neither lift the block nor slide it."""
        rng = np.random.default_rng(18)
        for _ in range(4):
            points = rng.uniform((0.0, 0.0), (WIDTH, HEIGHT), (3, 2))
            forces = rng.uniform((-300.0, -600.0), (300.0, -50.0), (2, 2))
            push = (rng.uniform(300.0, 900.0), rng.uniform(-100.0, 100.0))
            points[2, 1] = rng.uniform(0.5, 1.0)
            dead = tuple(
                ds.ForceLoad(block="b0", point=p, force=f, mass=False)
                for p, f in zip(points, forces, strict=False)
            )
            entry = ds.PointForce(block="b0", point=points[2], force=np.array(push))
            model = column(load=ds.ForcesPattern(entries=(entry,)), dead=dead)
            known = [At(1, tuple(p), tuple(f)) for p, f in zip(points, forces, strict=False)]
            known += [*weights(1)[:1], At(1, tuple(points[2]), push, scaled=True)]
            error, _, _ = rocking_errors(model, "equilibrium", known, max_steps=25)
            # Inertia is that share of the weight, and the multiplier one of the pattern.
            assert np.abs(error).max() < EXACT * WEIGHT / np.hypot(*push)


class TestSliding:
    @pytest.mark.parametrize("engine", ["equilibrium", "distinct", "nscd"])
    @pytest.mark.parametrize("pattern", [ds.MassPattern, ds.TiltPattern])
    def test_at_the_coefficient_of_friction(self, engine, pattern):
        model = column(
            load=pattern(direction=RIGHT),
            friction=0.3,
            width=2.0,
            stiffness=1e11 if engine == "equilibrium" else 1e9,  # turns by 2e-8, or 2e-6
        )
        curve = ds.pushover(model, engine=engine, max_displacement=5e-3, max_steps=60)
        # The weight on a table shrinks with the multiplier, and so does friction under the excess
        # of `nscd`, 0.01: to its square.
        tolerance = {"equilibrium": EXACT, "distinct": AT_REST, "nscd": 1e-4}[engine]
        assert curve.peak.load_multiplier == pytest.approx(0.3, abs=tolerance)

    def test_under_a_dead_load(self):
        """lambda W = mu (W + P); and of a table (x W) / s = mu (W / s + P), s = sqrt(1 + x^2)."""
        weight = WEIGHT * 2.0 / WIDTH
        load = 0.5 * weight
        dead = (ds.ForceLoad(block="b0", point="top", force=np.array([0.0, -load]), mass=False),)
        for pattern in (ds.MassPattern, ds.TiltPattern):
            model = column(
                load=pattern(direction=RIGHT), dead=dead, friction=0.3, width=2.0, stiffness=1e11
            )
            curve = ds.pushover(model, max_displacement=5e-3)
            exact = 0.45
            if pattern is ds.TiltPattern:
                exact = brentq(lambda x: x - 0.3 * (1.0 + 0.5 * np.sqrt(1.0 + x * x)), 0.0, 1.0)
            assert curve.peak.load_multiplier == pytest.approx(exact, abs=EXACT)


class TestTilt:
    def test_before_anything_moves_the_force_along_is_the_sine(self):
        """A wide block on closed joints is linear: it goes as far under x on the table as under x /
        sqrt(1 + x^2) of the pattern `mass`, to what it turns by, W / (k b) = 2e-6."""
        found = {}
        for pattern in (ds.MassPattern, ds.TiltPattern):
            model = column(load=pattern(direction=RIGHT), width=2.0, control_block="b0",
                           control_point="centre", friction=2.0)  # fmt: skip
            curve = ds.pushover(model, displacement_step=2e-6, max_displacement=2e-5)
            found[pattern] = curve
        mass, tilt = found[ds.MassPattern], found[ds.TiltPattern]
        x = tilt.load_multiplier
        sine = x / np.sqrt(1.0 + x * x)
        there = (x < 0.6) & (x > 0.0)  # up to a third of the height over the width it stays shut
        assert there.any() and x[there].max() > 0.5
        straight = np.interp(
            tilt.control_displacement, mass.control_displacement, mass.load_multiplier
        )
        assert sine[there] == pytest.approx(straight[there], abs=1e-5)
        small = (x < 0.02) & (x > 0.0)
        assert x[small] == pytest.approx(straight[small], rel=2e-4)  # half the square of 0.02

    def test_overturns_at_width_over_height(self):
        """b/h less what turning until the toe is alone takes: W / (k b/2) over b, of slope 1."""
        model = column(load=ds.TiltPattern(direction=RIGHT), stiffness=1e11)
        assert ds.pushover(model).peak.load_multiplier == pytest.approx(WIDTH / HEIGHT, abs=1e-5)


class TestLimitAnalysis:
    @pytest.mark.parametrize("case", CASES)
    def test_is_the_peak_of_stiff_joints(self, case):
        model, forces = CASES[case]
        tilt = model.load.name == "tilt"
        rigid = multiplier_of(model, model.assembly.design_pose(), forces, tilt=tilt)
        for flow in ("associative", "non-associative"):
            found = ds.collapse_load(model, flow=flow)
            assert found.load_multiplier == pytest.approx(rigid, rel=1e-6)
        curve = ds.pushover(model)
        # Before it rocks on one vertex a joint of 1e9 Pa/m turns by 1e-4, over slopes of up to 3.
        assert curve.peak.load_multiplier == pytest.approx(rigid, abs=2e-3)

    def test_load_with_mass_in_space(self):
        """As in the plane: the force of the mass is where the load acts."""
        model, _ = CASES["triangular and load with mass"]
        plane, space = (collapse_load(m, flow="associative") for m in (model, ds.extruded(model)))
        assert space.load_multiplier == pytest.approx(plane.load_multiplier, rel=1e-6)

    def test_cohesion_counts_more_on_a_table(self):
        """Sliding with cohesion c: x W / s = mu W / s + c A, s = sqrt(1 + x^2)."""
        weight, area, cohesion = WEIGHT * 2.0 / WIDTH, 2.0 * THICKNESS, 3e3
        glue = {"cohesion": cohesion}
        model = column(load=ds.TiltPattern(direction=RIGHT), friction=0.3, width=2.0)
        model = model.with_joint(**glue)
        share = cohesion * area / weight
        exact = brentq(lambda x: x - 0.3 - share * np.sqrt(1.0 + x * x), 0.0, 2.0)
        found = ds.collapse_load(model, flow="associative")
        assert found.load_multiplier == pytest.approx(exact, rel=1e-6)


class TestStages:
    def counterweight(self, stage):
        """A slab that hangs over by more than half, and a weight on its other end."""
        blocks = [
            box("ground", 0.0, -0.5, 1.0, 0.5, support=True),
            box("slab", 0.6, 0.0, 1.0, 0.2),
        ]
        load = ds.ForceLoad(
            block="slab", point=np.array([0.65, 0.2]), force=np.array([0.0, -4000.0]),
            mass=False, stage=stage,
        )  # fmt: skip
        return ds.make_model(
            blocks, joint=ds.JointLaw(friction_coefficient=0.7, normal_stiffness=1e9,
                                      shear_stiffness=1e9),
            thickness=THICKNESS, load_direction=RIGHT, dead_loads=(load,),
        )  # fmt: skip

    @pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
    def test_come_one_after_another(self, engine):
        """What stands only with the load must have it from the start, which is stage 0."""
        ds.pushover(self.counterweight(0), engine=engine, max_steps=1)
        with pytest.raises(ds.UnstableError):
            ds.pushover(self.counterweight(1), engine=engine, max_steps=1)

    @pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
    def test_supports_carry_all_of_them(self, engine):
        loads = (ECCENTRIC, ds.SurchargeLoad(group="all", weight=700.0, mass=False, stage=2))
        curve = ds.pushover(column(dead=loads), engine=engine, max_steps=1)
        carried = curve.contacts[0].normal_reaction.sum()
        assert carried == pytest.approx(WEIGHT + LOAD + 700.0, rel=1e-4)


class TestModal:
    @pytest.mark.parametrize("space", [False, True])
    def test_block_on_two_springs(self, space):
        """About its foot: m u'' + K_s (u + h/2 t) = 0 and J t'' + K_s h/2 (u + h/2 t) + K_n (b/2)^2
        t = 0 with points at both ends of the joint; in space those of a square lie as far out."""
        k, area = 1e9, WIDTH * THICKNESS
        model = column(stiffness=k)
        direction = RIGHT
        if space:
            model, direction = ds.extruded(model), np.array([1.0, 0.0, 0.0])
        mass = WEIGHT / 9.81
        inertia = mass * (WIDTH**2 + HEIGHT**2) / 12.0
        half = 0.5 * HEIGHT
        stiffness = k * area * np.array([[1.0, half], [half, half**2 + (0.5 * WIDTH) ** 2]])
        square, shapes = np.linalg.eigh(
            stiffness / np.sqrt(np.outer([mass, inertia], [mass, inertia]))
        )
        share = shapes[0] ** 2  # of mass one, along u
        best = int(np.argmax(share))
        mode = first_mode(model.assembly, direction)
        points = mode.frequency * 2.0 * np.pi
        if not space:
            assert points == pytest.approx(np.sqrt(square[best]), rel=1e-9)
            assert mode.participation == pytest.approx(share[best], rel=1e-9)
        else:  # contact points are taken in a little: less stiff against turning
            assert points == pytest.approx(np.sqrt(square[best]), rel=0.3)

    def test_mass_moves_where_it_lies(self):
        """As above with a mass m1 at the top, which moves by u - h/2 t and adds m1 h^2/4 to J."""
        k, half = 1e9, 0.5 * HEIGHT
        model = column(stiffness=k, load=ds.ModalPattern(direction=RIGHT), dead=(ON_TOP,))
        mass, more = WEIGHT / 9.81, LOAD / 9.81
        inertia = mass * (WIDTH**2 + HEIGHT**2) / 12.0
        matrix = np.array([[mass + more, -more * half], [-more * half, inertia + more * half**2]])
        stiffness = np.array([[1.0, half], [half, half**2 + (0.5 * WIDTH) ** 2]])
        square, shapes = eigh(k * WIDTH * THICKNESS * stiffness, matrix)
        share = (shapes.T @ matrix[0]) ** 2 / (mass + more)
        best = int(np.argmax(share))
        masses = masses_of(model.assembly, model.dead_loads)
        mode = first_mode(model.assembly, RIGHT, masses)
        assert mode.frequency * 2.0 * np.pi == pytest.approx(np.sqrt(square[best]), rel=1e-9)
        assert mode.participation == pytest.approx(share[best], rel=1e-9)
        # Forces are as masses times displacements; that of the second acts at the top.
        u, t = shapes[:, best]
        force = np.array([WEIGHT * u, LOAD * (u - half * t)])
        force *= (WEIGHT + LOAD) / force.sum()
        acting = Acting.of(model.assembly, model.load, model.dead_loads).pattern
        assert acting.force[1] == pytest.approx([WEIGHT + LOAD, 0.0])
        assert acting.moments()[1, 0] == pytest.approx(-half * force[1], rel=1e-9)

    @pytest.mark.parametrize(("more", "counts"), TAUT)
    def test_a_spring_or_a_tie_that_is_taut_holds_the_top(self, more, counts):
        """As above with a bar k_1 at the top, which moves by u - h/2 t; one that carries no
        compression counts where it is under tension at rest."""
        k, half, bar = 1e9, 0.5 * HEIGHT, 2e8
        ends = (
            ds.TieEnd(block="b0", point=np.array([WIDTH, HEIGHT])),
            ds.TieEnd(point=np.array([WIDTH + 1.0, HEIGHT])),
        )
        tie = ds.Tie(start=ends[0], end=ends[1], stiffness=bar, yield_force=1e6, **more)
        model = column(stiffness=k, load=ds.ModalPattern(direction=RIGHT), ties=(tie,))
        mass = WEIGHT / 9.81
        inertia = mass * (WIDTH**2 + HEIGHT**2) / 12.0
        stiffness = (
            k * WIDTH * THICKNESS * np.array([[1.0, half], [half, half**2 + (0.5 * WIDTH) ** 2]])
        )
        stiffness += counts * bar * np.array([[1.0, -half], [-half, half**2]])
        square, shapes = eigh(stiffness, np.diag([mass, inertia]))
        share = mass * shapes[0] ** 2
        best = int(np.argmax(share))
        mode = model.load.mode(model.assembly, masses_of(model.assembly, (), model.ties))
        assert mode.frequency * 2.0 * np.pi == pytest.approx(np.sqrt(square[best]), rel=1e-9)
        assert mode.participation == pytest.approx(share[best], rel=1e-9)
        assert VibrationMode.of(model).period == mode.period

    def test_the_row_of_a_tie_is_how_it_grows_shorter(self):
        """Against the elongation of a small motion, of an oblique tie in space."""
        model = ds.extruded(
            column(
                ties=(
                    ds.spring(
                        start=ds.TieEnd(block="b0", point=np.array([0.0, 0.7])),
                        end=ds.TieEnd(point=np.array([-0.8, 0.1])),
                        stiffness=1e6,
                    ),
                )
            )
        )
        assembly, bars = model.assembly, Bars.of(model.assembly, model.ties)
        motion = np.zeros((assembly.n_bodies, assembly.n_dof))
        motion[1] = 1e-7 * np.random.default_rng(3).standard_normal(assembly.n_dof)
        now = np.zeros((1, N_NOW))
        locate(bars.body, bars.value, assembly.moved(assembly.design_pose(), motion), now)
        (row,) = _bar_rows(assembly, bars)
        shorter = row[0] @ motion[bars.body[0]].ravel()
        assert shorter == pytest.approx(-now[0, ELONGATION], rel=1e-5)
        assert not row[1:].any()

    def test_rollers_hold_what_they_hold(self):
        """A column that cannot turn moves along: m u'' + K_s u = 0."""
        k = 1e9
        model = column(stiffness=k)
        ground, block = model.assembly.blocks
        load = ds.ModalPattern(direction=RIGHT)
        model = ds.make_model(
            [ground, replace(block, held=("turn",))],
            joint=model.assembly.joint,
            thickness=THICKNESS,
            load=load,
        )
        mode = model.load.mode(model.assembly)
        exact = np.sqrt(k * WIDTH * THICKNESS * 9.81 / WEIGHT)
        assert mode.frequency * 2.0 * np.pi == pytest.approx(exact, rel=1e-9)
        assert mode.participation == pytest.approx(1.0, rel=1e-12)
        assert mode.shape[1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)

    @pytest.mark.parametrize("space", [False, True])
    def test_kinetic_energy_is_that_of_the_masses(self, space):
        """Of a small motion x M x has m1 times the square of what its point moves by more."""
        model = column(dead=(HEAVY,))
        model = ds.extruded(model) if space else model
        assembly = model.assembly
        where = assembly.centroid[1] + masses_of(assembly, model.dead_loads).carried[0].arm[1]
        motion = 1e-7 * np.random.default_rng(5).standard_normal((2, assembly.n_dof))
        motion[0] = 0.0
        pose = assembly.moved(assembly.design_pose(), motion)
        way = assembly.displacement_at(1, where, pose)
        with_it, alone = (
            motion[1] @ mass_matrices(assembly, masses)[1] @ motion[1]
            for masses in (masses_of(assembly, model.dead_loads), NO_MASSES)
        )
        # Of an angle of 1e-7 the square is left out.
        assert with_it - alone == pytest.approx(LOAD / 9.81 * (way @ way), rel=1e-6)

    def test_mode_is_found_anew_for_a_mass_elsewhere(self):
        """Of the same weight; what is known goes by where it lies too."""
        load = ds.ModalPattern(direction=RIGHT)
        assembly, periods = column().assembly, []
        for dead in (HEAVY, replace(HEAVY, point=np.array([0.2, 0.0]))):
            periods.append(load.mode(assembly, masses_of(assembly, (dead,))).period)
        assert periods[0] > 1.1 * periods[1]

    def test_forces_go_with_the_mode(self):
        """Mass times the mode's displacement, of the whole weight in all."""
        model = column(4, load=ds.ModalPattern(direction=RIGHT), stiffness=1e8)
        forces = Acting.of(model.assembly, model.load).pattern.force[1:]
        shape = model.load.mode(model.assembly).shape[1:]
        assert forces.sum(axis=0) == pytest.approx([WEIGHT, 0.0], abs=1e-9 * WEIGHT)
        assert forces[:, 0] / forces[-1, 0] == pytest.approx(shape[:, 0] / shape[-1, 0], rel=1e-9)
        assert np.all(np.diff(forces[:, 0]) > 0.0)  # it grows with height


class TestMasses:
    def test_count_where_they_lie(self):
        model = column(dead=(HEAVY,))
        masses = masses_of(model.assembly, model.dead_loads)
        assert masses.weights(model.assembly)[1] == pytest.approx(WEIGHT + LOAD)
        arm = np.array(POINT) - (0.2, 0.5)
        assert masses.carried[0].moment[1] == pytest.approx(LOAD * arm)


def twisted_slab(*forces, push=1000.0):
    """A square slab of 1 m on the ground, with forces ``(point, direction)`` of ``push`` [N]."""
    blocks = [
        solids.box("ground", [-2.0, -2.0, -0.3], [2.0, 2.0, 0.0], support=True),
        solids.box("slab", [-0.5, -0.5, 0.0], [0.5, 0.5, 0.2]),
    ]
    entries = tuple(
        ds.PointForce(block="slab", point=np.array(at), force=push * np.array(along))
        for at, along in forces
    )
    return ds.make_model(
        blocks,
        joint=solids.joint(0.4),
        load=ds.ForcesPattern(entries=entries),
        control_block="slab",
        control_point=(0.5, 0.0, 0.1),
        control_direction=(0.0, 1.0, 0.0),
    )


class TestACouple:
    """Two forces P at opposite sides twist a slab about its axis: lambda P b = mu W r, with the
    friction at its corners, r from the axis."""

    EAST, WEST = (0.5, 0.0, 0.1), (-0.5, 0.0, 0.1)
    NORTH, SOUTH = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)

    @pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
    def test_what_twists_it(self, engine):
        model = twisted_slab((self.EAST, self.NORTH), (self.WEST, self.SOUTH))
        curve = ds.pushover(model, engine=engine, max_displacement=5e-3)
        exact = 0.4 * solids.UNIT_WEIGHT * 0.2 * np.sqrt(0.5) / 1000.0
        # As it turns by 0.01 the arm of the forces, whose direction stays, is 5e-5 of it shorter.
        assert curve.peak.load_multiplier == pytest.approx(exact, rel=1e-3)
        assert collapse_load(model).load_multiplier == pytest.approx(exact, rel=1e-6)

    def test_above_the_bound_it_has_turned(self):
        model = twisted_slab((self.EAST, self.NORTH), (self.WEST, self.SOUTH))
        curve = ds.pushover(model, max_displacement=0.3)
        said = limits_beside(model).warning(curve, model)
        assert "rotated by up to 0.6" in said and "motion" not in said

    def test_forces_that_balance_on_a_block(self):
        with pytest.raises(ds.ModelError, match="balance each other: nothing is loaded"):
            twisted_slab((self.EAST, self.SOUTH), (self.EAST, self.NORTH))
        with pytest.raises(ds.ModelError, match="balance each other: nothing is loaded"):
            twisted_slab((self.EAST, (1.0, 0.0, 0.0)), (self.WEST, (-1.0, 0.0, 0.0)))
