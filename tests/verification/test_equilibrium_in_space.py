"""The equilibrium engine in space against closed forms.

Joints are stiff, so that blocks are next to rigid: a block that rocks on an edge closes it by
W / (k_n A / 2), some 1e-6 m at 1e10 Pa/m, and leans by that over its width.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from builders import (
    BONDED_JOINT,
    PUBLISHED_JOINT,
    problem_of,
    small_wall,
    with_corner,
    with_joint,
)
from drystone.analysis.driver import pushover
from drystone.engines.base import Demand
from drystone.model.assembly import Corner
from drystone.model.builders import extruded
from drystone.model.model import Model
from drystone.results.curve import DYNAMIC, FINISHED, STATIC, CapacityCurve
from drystone.statics import solution
from drystone.statics.equilibrium import EquilibriumEngine
from random_kinds import KINDS
from solids import box, joint, leaf, model_of, one_block, twisting_lever

UP = np.array([0.0, 0.0, 1.0])


def rocking(moved: np.ndarray, width: float, height: float, share: float = 1.0) -> np.ndarray:
    """Multiplier of a rigid block on its edge, `width` across it, read above that edge.

    ``share`` of the load and of the displacement is across the edge.  With s the cosine,

        s lambda = tan(arctan(b / h) - theta),     s d = h sin(theta) s^2, d = h sin(theta) s
    """
    theta = np.arcsin(moved / (share * height))
    return np.tan(np.arctan2(width, height) - theta) / share


def certified(curve: CapacityCurve) -> CapacityCurve:
    """The curve, once every point at rest is in equilibrium."""
    for point in curve.points:
        if point.status != DYNAMIC:
            assert point.residual <= 1e-8
            assert point.inertia_ratio <= 1e-3
            assert point.friction_violation <= 1e-9
    return curve


def at_rest(curve: CapacityCurve) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and multipliers of the points at rest."""
    kept = np.array([point.status == STATIC for point in curve.points])
    return curve.control_displacement[kept], curve.load_multiplier[kept]


def keeps_to(curve: CapacityCurve, form, *, beyond: float, off: float) -> None:
    """At least twenty points beyond a displacement [m] are as near to the form as ``off`` peaks."""
    moved, multiplier = at_rest(curve)
    branch = moved > beyond
    assert np.count_nonzero(branch) > 20
    error = np.abs(multiplier - form(moved))[branch]
    assert error.max() <= off * curve.peak.load_multiplier


class TestOneBlock:
    """0.4 x 0.6 x 1.5 m, friction 0.7, on joints of 1e11 Pa/m."""

    @pytest.mark.parametrize("points", [4, 9])
    def test_rocks_over_an_edge(self, points):
        """1e-4 of the peak, W / k_n is 1e-7 m: to where it carries nothing."""
        curve = certified(pushover(one_block(points=points), engine="equilibrium"))
        assert curve.status == FINISHED
        assert curve.peak.load_multiplier == pytest.approx(0.4 / 1.5, rel=1e-4)
        keeps_to(curve, lambda d: rocking(d, 0.4, 1.5), beyond=1e-3, off=1e-4)
        # Ends at a multiplier of 0.01, a step of 8 mm at most beyond.
        end = 1.5 * np.sin(np.arctan2(0.4, 1.5) - np.arctan(0.01))
        assert curve.ultimate_displacement == pytest.approx(end, rel=1e-3)

    @pytest.mark.parametrize(("angle", "peak"), [(30.0, 0.30792), (45.0, 0.37712)])
    def test_an_oblique_push(self, angle, peak):
        """It tips over the edge that gives way first: b / (h cos) or d / (h sin)."""
        share = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        assert min(0.4 / (1.5 * share[0]), 0.6 / (1.5 * share[1])) == pytest.approx(peak, abs=1e-5)
        curve = certified(pushover(one_block(angle=angle), engine="equilibrium"))
        assert curve.peak.load_multiplier == pytest.approx(peak, rel=1e-4)
        keeps_to(curve, lambda d: rocking(d, 0.4, 1.5, share[0]), beyond=1e-3, off=1e-4)

    @pytest.mark.parametrize("angle", [0.0, 30.0, 77.0])
    def test_slides_straight_wherever_it_is_pushed(self, angle):
        """A low block with friction 0.2, by 0.1 m: multiplier mu, path straight to 1e-6 of it."""
        model = one_block(0.4, 0.6, 0.3, friction=0.2, stiffness=1e10, angle=angle)
        curve = pushover(model, engine="equilibrium", max_displacement=0.1, keep_poses=True)
        certified(curve)
        moved, multiplier = at_rest(curve)
        slides = moved > 1e-4
        assert np.count_nonzero(slides) > 5
        # The inertia of a step of 8 mm, long as it takes, is 4e-7 of the weight.
        assert multiplier[slides] == pytest.approx(0.2, rel=5e-6)
        path = curve.poses[-1][1, :3] - curve.poses[0][1, :3]
        along = path @ model.load.direction
        assert along > 0.099
        assert abs(path @ np.cross(UP, model.load.direction)) < 1e-6 * along
        assert np.abs(curve.poses[-1][1, 4:]).max() < 1e-6  # nor does it twist


def over_a_corner(stiffness: float = 1e10) -> Model:
    """0.4 x 0.3 x 0.9 m, pushed along the diagonal of its base: both edges give way at once."""
    angle = float(np.degrees(np.arctan2(0.3, 0.4)))
    return one_block(0.4, 0.3, 0.9, stiffness=stiffness, angle=angle)


def test_a_block_pushed_towards_its_corner_falls_over_an_edge():
    """Of the two it takes the one that carries less, 0.285 at 82 mm.

    Balanced on the corner, where no structure would stay, it would carry 0.442.
    """
    curve = certified(pushover(over_a_corner(), engine="equilibrium", max_displacement=0.12))
    # Both edges close by some 1e-6 m of 0.3.
    assert curve.peak.load_multiplier == pytest.approx(0.4 / 0.9 / 0.8, rel=2e-3)
    moved, multiplier = at_rest(curve)
    assert np.interp(0.082, moved, multiplier) == pytest.approx(0.2849, abs=1e-4)
    assert rocking(np.array(0.082), 0.5, 0.9) == pytest.approx(0.442, abs=1e-3)
    beyond = moved > 0.02
    assert np.count_nonzero(beyond) > 10
    off = np.abs(rocking(moved, 0.3, 0.9, 0.6) - multiplier)[beyond]
    assert off.max() <= 1e-4 * curve.peak.load_multiplier


class TestTwist:
    """A cube on its base, twisted: friction of the points, uniform pressure shared by area."""

    side, friction = 0.4, 0.6

    @pytest.mark.parametrize(("points", "factor"), [(4, 1.85), (9, 1.12), (16, 1.09)])
    def test_strength(self, points, factor):
        """A torque in place of the load; how far a corner of the cube rotates is prescribed."""
        blocks = [
            box("base", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), support=True),
            box("b1", *np.array([[-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]]) * self.side),
        ]
        corner = np.array([0.5, 0.5, 1.0]) * self.side
        model = model_of(
            blocks, joint(self.friction), push=(-1.0, 1.0, 0.0), point=corner, points=points
        )
        engine = EquilibriumEngine()
        state, _ = engine.start(problem_of(model))
        pattern = engine.equations_of(state).loaded.loads.pattern
        pattern[1, :3] = 0.0
        pattern[1, 3:] = model.assembly.axes[1].T @ UP  # 1 N m
        for _ in range(6):
            state, report = engine.step(state, Demand(increment=2e-5))
            assert report.converged, report.reason
            assert report.residual <= 1e-8
        torque = state.multiplier / (self.friction * model.assembly.weight[1])
        # The joint is sheared by 1e-6 m when it slips; then nothing grows any more.
        assert torque == pytest.approx(twisting_lever(self.side, points), rel=1e-5)
        uniform = self.side / 6.0 * (np.sqrt(2.0) + np.log(1.0 + np.sqrt(2.0)))
        assert torque / uniform == pytest.approx(factor, rel=0.01)


class TestPredictor:
    """A block that rocks on its edge, in steps of one length, on the branch behind its peak."""

    @staticmethod
    def missed(step: float, n_steps: int) -> tuple[float, float]:
        """By how much [m] the tangent, and the second-order predictor, miss the last of some
        steps."""
        engine = EquilibriumEngine()
        state, _ = engine.start(problem_of(one_block()))
        for increment in (1e-6, 1e-5, 1e-4, 1e-3, *[step] * n_steps):
            before = state
            state, report = engine.step(state, Demand(increment=increment))
            assert report.converged, report.reason
        tangent = step * before.tangent
        second = tangent + 0.5 * step**2 * before.curvature
        return tuple(np.abs(state.last_increment - x)[1, :3].max() for x in (tangent, second))

    def test_misses_by_the_square_and_by_the_cube_of_the_step(self):
        """At the same place, with steps of half the length."""
        long, short = np.array(self.missed(0.01, 8)), np.array(self.missed(0.005, 16))
        assert np.log2(long / short) == pytest.approx((2.0, 3.0), abs=0.2)


class TestLeaf:
    """44 blocks, 2 m x 1.4 m, 0.2 m thick, pushed out of plane: it rocks on its foot as one."""

    thickness, height = 0.2, 1.4

    @staticmethod
    @cache
    def traced(stiffness: float) -> CapacityCurve:
        return certified(pushover(leaf(stiffness=stiffness), engine="equilibrium"))

    def test_the_peak_rises_to_that_of_a_rigid_one(self):
        peaks = np.array([self.traced(k).peak.load_multiplier for k in (1e9, 1e10, 1e11)])
        short = self.thickness / self.height - peaks
        assert np.all(short > 0.0)
        assert np.all(short[1:] < 0.5 * short[:-1])
        assert peaks[-1] == pytest.approx(self.thickness / self.height, rel=1e-3)

    def test_the_branch_is_that_of_a_rigid_one(self):
        form = lambda d: rocking(d, self.thickness, self.height)  # noqa: E731
        keeps_to(self.traced(1e11), form, beyond=0.02, off=1e-4)


#: Joints that are more than dry, as soft along as across.
JOINTS = {
    "cohesive": BONDED_JOINT,
    "tensile": replace(BONDED_JOINT, tensile_strength=5e3),
    "dilatant": replace(PUBLISHED_JOINT, shear_stiffness=1e8, dilatancy_angle=10.0),
}


@pytest.mark.parametrize("name", JOINTS)
def test_joints_that_are_more_than_dry_are_those_of_the_plane(name):
    """A small wall 1 m deep: the joints' ends lie as far out and have the same areas."""
    flat = with_joint(with_corner(small_wall(), Corner()), JOINTS[name])
    options = {"engine": "equilibrium", "max_displacement": 5e-3}
    plane, space = pushover(flat, **options), certified(pushover(extruded(flat), **options))
    peak = plane.peak.load_multiplier
    assert space.peak.load_multiplier == pytest.approx(peak, rel=1e-3)
    (x, y), (other_x, other_y) = at_rest(plane), at_rest(space)
    places = np.linspace(1e-5, min(x.max(), other_x.max()), 400)
    off = np.abs(np.interp(places, x, y) - np.interp(places, other_x, other_y))
    assert np.median(off) <= 2e-3 * peak


def test_a_point_at_a_rim_stays_from_step_to_step():
    """A stone of these stairs comes to rest on the rim of another, and slides along it.

    Its point of contact was there in every second step only, or each step found other points than
    it had followed: that took three times the iterations.
    """
    model = KINDS["stairs"](6)
    curve = pushover(model, engine="equilibrium", keep_contacts=True)
    assert curve.status == "finished" and curve.residual.max() < 1e-8
    assert curve.column("n_iterations").sum() < 3_000
    change = np.diff([len(contacts.normal_reaction) for contacts in curve.contacts])
    assert not (change[1:] * change[:-1] < 0).any()  # to and fro, in two steps that follow


def on_its_diagonal(angle, engine, slab):
    """One column of 0.5 x 0.5 x 2 m, of four drums, or four under a slab, pushed at an angle in
    degrees."""
    places = [(x, y) for x in (0.0, 3.0) for y in (0.0, 3.0)] if slab else [(0.0, 0.0)]
    blocks = [box("ground", (-2.0, -2.0, -0.5), (6.0, 6.0, 0.0), support=True)]
    for k, (x, y) in enumerate(places):
        for i in range(1 if slab else 4):
            low, high = (0.0, 2.0) if slab else (0.5 * i, 0.5 * (i + 1))
            blocks.append(box(f"c{k}d{i}", (x, y, low), (x + 0.5, y + 0.5, high)))
    if slab:
        blocks.append(box("slab", (0.0, 0.0, 2.0), (3.5, 3.5, 2.3)))
    push = (np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0)
    model = model_of(blocks, joint(0.8, 1e10), push=push)
    return pushover(model, engine=engine)


@pytest.mark.parametrize("slab", [False, True])
def test_what_rocks_on_corners_falls_to_a_side(slab):
    """On its diagonal a square column has an equilibrium on one corner up to 0.7 m, which no column
    stays in: beside the diagonal, and by `distinct`, it rocks on an edge and falls at half of that.
    Four columns under a slab also spin freely on their corners: the mode that grows hides behind
    those that are neutral."""
    along, beside = (on_its_diagonal(angle, "equilibrium", slab) for angle in (45.0, 44.9))
    assert along.status == beside.status == "finished"
    assert along.peak.load_multiplier == pytest.approx(beside.peak.load_multiplier, rel=5e-3)
    # Where the slab leaves the diagonal it is on its way already.
    end = pytest.approx(beside.ultimate_displacement, rel=0.05 if slab else 0.01)
    assert along.ultimate_displacement == end
    assert np.mean(along.column("unstable")) < 0.15  # 75 of 85 points where it stayed on one


def test_a_step_that_leaves_no_unstable_equilibrium_ends_in_it(monkeypatch):
    """Wherever the search for a stable one beside it has ended, and with which contacts."""

    def lost(solver):
        solver.step.update_contacts()
        solver.step.restart(solver.step.x + 0.01, 2.0)

    curves = []
    for leave in (lambda solver: None, lost):
        monkeypatch.setattr(solution, "_leave", leave)
        curves.append(certified(on_its_diagonal(45.0, "equilibrium", slab=False)))
    unstable = [curve.column("unstable") for curve in curves]
    assert np.count_nonzero(unstable[0]) > 10
    assert np.array_equal(*unstable)
    assert np.array_equal(*(curve.load_multiplier for curve in curves))
