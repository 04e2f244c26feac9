"""Joints that soften, are crushed and close hyperbolically, against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from builders import UNIT_WEIGHT, rectangle, stack
from drystone.analysis.driver import pushover
from drystone.engines.base import EngineError
from drystone.limit import collapse_load
from drystone.model.assembly import Block
from drystone.model.builders import coursed_wall, extruded, make_model
from drystone.model.joint_law import JointLaw
from drystone.model.mortar import Mortar

#: Of a joint that takes next to no shear beside others [Pa/m].
SOFT = 1e6

#: Steps: one, its half and its double.
STEPS = [1e-4, 5e-5, 2e-4]


def joint(friction=3.0, stiffness=1e11, **values):
    return JointLaw(
        friction_coefficient=friction,
        normal_stiffness=stiffness,
        shear_stiffness=stiffness,
        **values,
    )


def integral(y, x):
    """Of a smooth curve through points, in order."""
    return float(PchipInterpolator(x, y).integrate(x[0], x[-1]))


class OnTwoPads:
    """A block B x H on two pads at its ends, each of the length e with two contact points.

    The block is rigid, so that its rotation tells all gaps; how far it is lifted follows from the
    balance of vertical forces, and the load from that of moments about its lower right corner.
    """

    width, height, pad = 1.0, 2.0, 0.1

    @property
    def weight(self):
        return UNIT_WEIGHT * self.width * self.height

    def trace(self, left, right, direction, step, **options):
        model = self.model(left, right, direction)
        return pushover(model, displacement_step=step, stop_multiplier=1e-3, **options)

    def model(self, left, right, direction):
        b, e, h = self.width, self.pad, self.height
        pads = [
            Block(
                id=name,
                vertices=rectangle(x, -0.2, e, 0.2),
                unit_weight=UNIT_WEIGHT,
                support=True,
            )
            for name, x in (("left", 0.0), ("right", b - e))
        ]
        block = Block(id="block", vertices=rectangle(0.0, 0.0, b, h), unit_weight=UNIT_WEIGHT)
        return make_model(
            [*pads, block],
            joint=right,
            joint_between={frozenset({"left", "block"}): left},
            thickness=1.0,
            load_direction=direction,
            control_block="block",
            control_point=(0.5 * b, 0.5 * h),
        )

    def multipliers(self, turns, pull):
        """At rotations (n,), with ``pull(gap)`` what the left pad pulls with per area."""
        b, h, e, k = self.width, self.height, self.pad, 1e11
        places = np.array([0.0, e, b - e, b])
        found = []
        for turn in turns:

            def force(lifted, turn=turn):
                gap = lifted + turn * (b - places)
                glued = [pull(g) if g > 0.0 else k * g for g in gap[:2]]
                return -0.5 * e * np.array([*glued, *np.minimum(k * gap[2:], 0.0)])

            lifted = brentq(lambda w: force(w).sum() - self.weight, -1e-3, 1e-3, xtol=1e-17)
            arm = 0.5 * (b * np.cos(turn) - h * np.sin(turn))
            high = 0.5 * (h * np.cos(turn) + b * np.sin(turn))
            moment = self.weight * arm - force(lifted) @ (b - places)
            found.append(moment / (self.weight * high))
        return np.array(found)


class TestTensionAndBending:
    """The left pad is glued, and torn off by turning the block about the right one."""

    pads = OnTwoPads()
    strength, energy, stiffness = 1e5, 20.0, 1e11
    left = joint(
        cohesion=4e5,
        tensile_strength=strength,
        tensile_fracture_energy=energy,
        shear_fracture_energy=200.0,
    )

    def pull(self, gap):
        """f_t exp(-f_t k / G) at the gap k + f / k_n."""
        if self.stiffness * gap <= self.strength:
            return self.stiffness * gap
        rate = self.strength / self.energy
        opened = brentq(
            lambda x: x + self.strength * np.exp(-rate * x) / self.stiffness - gap, 0.0, gap
        )
        return self.strength * np.exp(-rate * opened)

    @pytest.fixture(scope="class")
    @classmethod
    def curves(cls):
        return {
            step: cls.pads.trace(cls.left, joint(), (1.0, 0.0), step, max_displacement=4e-3)
            for step in STEPS
        }

    def test_the_peak_on_any_step(self, curves):
        turns = np.linspace(4e-6, 6e-6, 400)
        peak = self.pads.multipliers(turns, self.pull).max()
        for curve in curves.values():
            # What a step may hide of a peak is 2e-4 of it.
            assert curve.peak.load_multiplier == pytest.approx(peak, rel=3e-4)

    def test_the_branch(self, curves):
        """The joints are sheared by 1e-6 m: at a slope of 3e3 1/m by 3e-3 less."""
        curve = curves[STEPS[0]]
        moved, found = curve.column("control_displacement"), curve.column("load_multiplier")
        turns = np.linspace(5e-5, 3e-3, 200)
        expected = self.pads.multipliers(turns, self.pull)
        place = 0.5 * (1.0 - np.cos(turns)) + np.sin(turns)
        later = (moved > 2e-4) & (moved < 2e-3)
        assert found[later] == pytest.approx(np.interp(moved[later], place, expected), abs=3e-3)

    def test_what_is_released(self):
        """Work of the load and the weight along the whole curve is the bond's fracture energy.

        It is lost to exp(-20).  What the joints store is reckoned with: the toe's point W at the
        end, four points W / 4 at the start, 0.04 and 0.01 J of 2 J.  The glue is soft in shear, so
        that it takes none, and the right pad so stiff that a point loses nothing as it lifts.
        """
        left = replace(self.left, shear_stiffness=SOFT, shear_fracture_energy=1e6)
        right = replace(joint(), shear_stiffness=1e13)
        curve = self.pads.trace(left, right, (1.0, 0.0), 2e-5, max_displacement=6e-3)
        moved, found = curve.column("control_displacement"), curve.column("load_multiplier")
        pads, k = self.pads, 1e11
        points = curve.poses[:, 2]
        work = integral(found * pads.weight, moved)
        work -= pads.weight * (points[-1, 1] - points[0, 1])
        area = 0.5 * pads.pad
        begun = 4.0 * 0.5 * (0.25 * pads.weight) ** 2 / (k * area)
        ended = 0.5 * pads.weight**2 / (k * area)
        assert work + begun - ended == pytest.approx(self.energy * pads.pad, rel=1e-3)


class TestShear:
    """A flat block is pushed off its base: T = (mu(k) W + c(k) A), k what has slid."""

    width, height, friction, residual = 4.0, 0.05, 0.6, 0.4
    stiffness = 1e10
    weight = UNIT_WEIGHT * width * height

    def trace(self, step, **values):
        law = joint(self.friction, self.stiffness, **values)
        model = stack((self.width, self.height), joint=law)
        curve = pushover(model, displacement_step=step, max_displacement=8e-3)
        force = curve.column("load_multiplier") * self.weight
        slid = curve.column("control_displacement") - force / (self.stiffness * self.width)
        return curve, force, slid

    @pytest.mark.parametrize("step", STEPS)
    def test_cohesion_and_friction(self, step):
        cohesion, energy = 2e3, 1.0
        curve, force, slid = self.trace(
            step,
            cohesion=cohesion,
            shear_fracture_energy=energy,
            residual_friction_coefficient=self.residual,
        )
        left = np.exp(-cohesion * slid / energy)
        friction = self.residual + (self.friction - self.residual) * left
        expected = friction * self.weight + cohesion * self.width * left
        # Strengths converge to 1e-6 of the weight; the block leans a hair.
        later = slid > 1e-6
        assert force[later] == pytest.approx(expected[later], rel=1e-5)
        peak = self.friction * self.weight + cohesion * self.width
        assert curve.peak.load_multiplier * self.weight == pytest.approx(peak, rel=3e-4)

    def test_what_is_released(self):
        cohesion, energy = 2e3, 1.0
        _, force, slid = self.trace(
            5e-5,
            cohesion=cohesion,
            shear_fracture_energy=energy,
        )
        later = slid > 0.0
        begun = np.concatenate(([0.0], slid[later]))
        at = self.friction * self.weight + cohesion * self.width
        found = integral(np.concatenate(([at], force[later])), begun)
        found -= self.friction * self.weight * slid[-1]
        assert found == pytest.approx(energy * self.width, rel=1e-3)

    def test_friction_over_a_slip(self):
        length = 5e-4
        _, force, slid = self.trace(
            1e-4, residual_friction_coefficient=self.residual, residual_slip=length
        )
        later = slid > 1e-6
        friction = self.residual + (self.friction - self.residual) * np.exp(-slid / length)
        assert force[later] == pytest.approx(self.weight * friction[later], rel=1e-5)


class TestCrushing:
    """A slender block B x H turns about a toe that is crushed over a = W / (f_c t).

    It turns about the end of that, and the reaction is in its middle, so that the multiplier is

        (x cos + a/2 cos - y sin) / (y cos + x sin + a/2 sin),   x = B/2 - a,  y = H/2.

    A joint has n points with the areas of a trapezium's rule, whose moment is that of the block of
    stress but for h^2 f_c / 8 at most, h = B / (n - 1): the arm is longer by up to h^2 / 8a.
    """

    width, height, crushed, n = 0.5, 2.5, 0.06, 33
    weight = UNIT_WEIGHT * width * height

    def trace(self, strength, points, **options):
        law = joint(1.0, 1e11, compressive_strength=strength)
        model = stack((self.width, self.height), joint=law)
        assembly = replace(model.assembly, points=points)
        options = {"displacement_step": 2e-3, "max_displacement": 0.1, **options}
        return pushover(replace(model, assembly=assembly), **options)

    def expected(self, moved, crushed):
        """At displacements of the upper right corner."""
        x, y, half = 0.5 * self.width - crushed, 0.5 * self.height, 0.5 * crushed
        # The corner is a to the right of the pivot and H above it.
        far = np.hypot(crushed, self.height)
        lean = np.arctan2(crushed, self.height)
        turn = np.arcsin((moved + crushed) / far) - lean
        arm = (x + half) * np.cos(turn) - y * np.sin(turn)
        return arm / (y * np.cos(turn) + (x + half) * np.sin(turn))

    @pytest.mark.parametrize("step", [2e-3, 1e-3, 4e-3])
    def test_the_branch(self, step):
        strength = self.weight / self.crushed
        curve = self.trace(strength, self.n, displacement_step=step)
        slender = self.width / self.height
        error = (self.width / (self.n - 1)) ** 2 / (8.0 * self.crushed) / self.height
        peak = (self.width - self.crushed) / self.height
        # Elastic joints round the peak off by as much as the block leans there: 1e-3.
        assert curve.peak.load_multiplier == pytest.approx(peak, abs=2.0 * error + 1e-3 * slender)
        moved, found = curve.column("control_displacement"), curve.column("load_multiplier")
        later = moved > 2e-2
        branch = self.expected(moved[later], self.crushed)
        # The points' shear adds a moment: what they slide against each other, times the depth.
        assert found[later] == pytest.approx(branch, abs=2.0 * error + 6e-3 * slender)

    def test_a_strong_one_is_dry(self):
        strong, dry = self.trace(1e13, 2), self.trace(np.inf, 2)
        for name in ("control_displacement", "load_multiplier"):
            assert strong.column(name) == pytest.approx(dry.column(name), rel=1e-9, abs=1e-12)

    def test_where_nothing_is_said_a_toe_is_crushed_over_a_part_of_the_joint(self):
        """A contact at each end alone would carry B/H, as if the toe were not crushed at all."""
        crushed = 0.2
        law = joint(1.0, 1e11, compressive_strength=self.weight / crushed)
        model = stack((self.width, self.height), joint=law)
        assert model.assembly.points == 9
        peak = pushover(model, displacement_step=2e-3, max_displacement=0.02).peak.load_multiplier
        exact = (self.width - crushed) / self.height
        above = 2.0 * (self.width / 8.0) ** 2 / (8.0 * crushed) / self.height
        assert exact * (1.0 - 4e-3) <= peak <= exact + above

    def test_points_between_the_ends_change_no_dry_block(self):
        """But by what the soft joint closes at the toe: less than 1e-4 of the width."""
        few, many = self.trace(np.inf, 2), self.trace(np.inf, 9)
        assert many.peak.load_multiplier == pytest.approx(few.peak.load_multiplier, rel=2e-3)
        along, other = (curve.column("control_displacement") for curve in (few, many))
        later = (along > 0.02) & (along <= other[-1])  # both go a step too far, by different ones
        assert along[later][-1] > 0.098
        found = np.interp(along[later], other, many.column("load_multiplier"))
        assert found == pytest.approx(few.column("load_multiplier")[later], abs=1e-4)


@pytest.mark.parametrize("flow", ["associative", "non-associative"])
@pytest.mark.parametrize("crushed", [0.0, 0.02, 0.05, 0.1, 0.2])
def test_limit_analysis_of_a_crushed_toe(flow, crushed):
    """(B - a) / H and up to h^2 / 8a of the arm more, h = B / 32."""
    width, height = 0.5, 1.0
    weight = UNIT_WEIGHT * width * height
    law = joint(0.8, compressive_strength=weight / crushed if crushed else np.inf)
    found = collapse_load(stack((width, height), joint=law), flow=flow)
    above = found.load_multiplier - (width - crushed) / height
    most = 2.0 * (width / 32) ** 2 / (8.0 * crushed) / height if crushed else 0.0
    assert -1e-9 <= above <= most + 1e-9
    assert max(found.duality_gap, found.residual) < 1e-9
    assert max(found.friction_violation, found.dilatancy_violation) < 1e-9


def test_limit_analysis_of_joints_that_their_weight_crushes():
    weak = joint(0.8, compressive_strength=0.9 * UNIT_WEIGHT)
    found = collapse_load(stack((0.5, 1.0), joint=weak))
    assert "does not stand under its own weight" in found.reason


@pytest.mark.parametrize("step", [1e-5, 5e-6, 2e-5])
def test_a_pad_that_is_crushed_softens(step):
    """Pressed down, each pad takes (1 + lambda) W / 2 but for what the right one's points differ.

    A point closes by u and carries C exp(-C k / G_c) per area with k = u - p / k_n.
    """
    pads, strength, energy = OnTwoPads(), 3e5, 60.0
    weak = joint(compressive_strength=strength, compressive_fracture_energy=energy)
    curve = pads.trace(weak, joint(), (0.0, -1.0), step, max_displacement=1.5e-4)
    most = 2.0 * strength * pads.pad / pads.weight - 1.0
    # The crushed points are half the pad's length from its middle, which turns by C / k_n B.
    assert curve.peak.load_multiplier == pytest.approx(most, rel=1e-2)
    crushed = 0
    for found in curve.contacts:
        left = found.block_a == 0
        for closed, pressure in zip(
            -found.gap[left], (found.normal_reaction / found.area)[left], strict=True
        ):
            if closed < strength / 1e11:
                continue
            crushed += 1
            law = brentq(
                lambda p, u=closed: (
                    p - strength * np.exp(-strength / energy * max(u - p / 1e11, 0.0))
                ),
                0.0,
                strength,
            )
            # What strengths converge to: 1e-6 of the weight, over a pad's half.
            assert pressure == pytest.approx(law, abs=4e-6 * pads.weight / (0.5 * pads.pad))
    assert crushed > 10


#: Closure [m] under a pressure [Pa], by stiffness [Pa/m] and the length of the law [m].
CLOSURES = {
    "greatest_closure": lambda p, k, length: p / (k + p / length),
    "logarithmic_closure": lambda p, k, length: length * np.log1p(p / (k * length)),
}


@pytest.mark.parametrize("key", CLOSURES)
@pytest.mark.parametrize("step", [2e-4, 1e-4, 4e-4])
def test_closure_that_is_not_linear(key, step):
    """A block pressed on its base closes by v with (1 + lambda) W / A = k v / (1 - v / v_m), or
    k v_r (exp(v / v_r) - 1).

    No more than rounding apart: the tangent that the law is solved with is renewed until it is
    the law.
    """
    width, height, stiffness, length = 1.0, 0.2, 1e7, 1e-3
    law = joint(0.6, stiffness, **{key: length})
    model = stack((width, height), joint=law, direction=(0.0, -1.0))
    curve = pushover(model, displacement_step=step, max_displacement=6e-4)
    weight = UNIT_WEIGHT * width * height
    pressure = (1.0 + curve.column("load_multiplier")) * weight / width
    closed = CLOSURES[key](pressure, stiffness, length)
    moved = curve.column("control_displacement") + closed[0]
    assert moved == pytest.approx(closed, rel=1e-6)
    assert len(curve.points) > 5


def mortar_wall(**values):
    """Six courses of bricks in mortar, on a base, pushed in its plane."""
    stiffness = Mortar(thickness=0.01, young_modulus=2e7, poisson_ratio=0.2).stiffnesses
    blocks = coursed_wall(
        unit=(0.25, 0.125), courses=["11", "h1h"], repeat=3, unit_weight=18e3, base=True
    )
    law = JointLaw(friction_coefficient=0.65, **stiffness, **values)
    return make_model(blocks, joint=law, thickness=0.12, load_direction=(1.0, 0.0))


#: Of joints in mortar: cohesion and tensile strength [Pa], fracture energies [N/m].
STRENGTHS = {
    "cohesion": 6e3,
    "tensile_strength": 4e3,
    "shear_fracture_energy": 6.0,
    "tensile_fracture_energy": 2.0,
    "residual_friction_coefficient": 0.55,
}


@pytest.mark.slow
class TestMortarWall:
    def peak(self, **options):
        model = mortar_wall(**STRENGTHS)
        return pushover(model, max_displacement=6e-4, **options).peak.load_multiplier

    def test_on_any_step_and_in_both_engines(self):
        peaks = [self.peak(displacement_step=step) for step in STEPS]
        assert np.ptp(peaks) <= 1e-3 * max(peaks)
        # Damped waves of cycles soften joints a little early.
        by_cycles = self.peak(engine="distinct", displacement_step=5e-5)
        assert by_cycles == pytest.approx(peaks[0], rel=1e-2)
        dry = pushover(mortar_wall(), max_displacement=6e-4).peak.load_multiplier
        assert peaks[0] > 1.5 * dry


class TestByCycles:
    """`distinct` beside `equilibrium`, which is held to closed forms above."""

    def agree(self, model, rel, **options):
        peaks = [
            pushover(model, engine=engine, **options).peak.load_multiplier
            for engine in ("equilibrium", "distinct")
        ]
        assert peaks[1] == pytest.approx(peaks[0], rel=rel)

    def test_tension(self):
        """What the cycles' waves soften too early: a quarter of a per cent."""
        case = TestTensionAndBending()
        peaks = [
            case.pads.trace(
                case.left, joint(), (1.0, 0.0), 1e-4, max_displacement=1e-4, engine=engine
            ).peak.load_multiplier
            for engine in ("equilibrium", "distinct")
        ]
        assert peaks[1] == pytest.approx(peaks[0], rel=5e-3)

    def test_shear(self):
        """Every point is on the law; the peak is what the first step past it leaves."""
        cohesion, energy = 2e3, 1.0
        case = TestShear()
        law = joint(
            case.friction,
            case.stiffness,
            cohesion=cohesion,
            shear_fracture_energy=energy,
            residual_friction_coefficient=case.residual,
        )
        model = stack((case.width, case.height), joint=law)
        curve = pushover(model, engine="distinct", displacement_step=2e-4, max_displacement=3e-3)
        force = curve.column("load_multiplier") * case.weight
        slid = curve.column("control_displacement") - force / (case.stiffness * case.width)
        left = np.exp(-cohesion * slid / energy)
        friction = case.residual + (case.friction - case.residual) * left
        expected = friction * case.weight + cohesion * case.width * left
        later = slid > 1e-5
        # Forces balance to 1e-5 of the weight there.
        assert force[later] == pytest.approx(expected[later], rel=1e-4)

    def test_crushing(self):
        case = TestCrushing()
        law = joint(1.0, 1e10, compressive_strength=case.weight / case.crushed)
        model = stack((case.width, case.height), joint=law, points=17)
        self.agree(model, 1e-3, displacement_step=2e-3, max_displacement=0.03)


@pytest.mark.parametrize(
    ("engine", "values", "said"),
    [
        ("nscd", {"cohesion": 1e4, "shear_fracture_energy": 10.0}, "lose their bond"),
        ("nscd", {"residual_friction_coefficient": 0.3, "residual_slip": 1e-3}, "lose friction"),
        ("nscd", {"compressive_strength": 1e6}, "are crushed"),
        ("nscd", {"greatest_closure": 1e-3}, "close hyperbolically"),
        ("distinct", {"greatest_closure": 1e-3}, "close hyperbolically"),
        ("distinct", {"logarithmic_closure": 1e-3}, "close with the logarithm"),
    ],
)
def test_engines_without_them_say_so(engine, values, said):
    model = stack((1.0, 0.2), joint=joint(0.6, 1e9, **values))
    with pytest.raises(EngineError, match=f"{engine} engine has no joints that {said}"):
        pushover(model, engine=engine, max_steps=1)


class TestOpeningWithoutTensileStrength:
    """A block B x H with b = 0.5 H: it overturns at B / H = 2, with any cohesion.

    Slip softens the cohesion.  Opening has no energy to take, and breaks the bond at once: an open
    joint that kept its cohesion would be held by it, and the block with it.
    """

    width, height = 1.0, 0.5

    def model(self, cohesion, friction=3.0, stiffness=1e11):
        law = joint(friction, stiffness, cohesion=cohesion, shear_fracture_energy=100.0)
        return stack((self.width, self.height), joint=law)

    @pytest.mark.parametrize(
        ("engine", "stiffness", "cohesion", "space"),
        [
            ("equilibrium", 1e9, 2e4, False),
            ("equilibrium", 1e9, 1e5, True),
            ("equilibrium", 1e11, 1e5, False),
            ("equilibrium", 1e11, 2e4, True),
            ("distinct", 1e9, 1e5, False),
        ],
    )
    def test_it_overturns(self, engine, stiffness, cohesion, space):
        model = self.model(cohesion, stiffness=stiffness)
        curve = pushover(extruded(model) if space else model, engine=engine, max_displacement=0.1)
        # The compression of the joint shortens the arm: by W / (k B) / B.
        assert curve.peak.load_multiplier == pytest.approx(2.0, rel=1e-3)
        assert max(p.load_multiplier for p in curve.points) < 2.002

    def test_what_stays_shut_keeps_its_cohesion(self):
        """A block that slides: c B / W more than friction, and then less of it."""
        curve = pushover(self.model(4e3, friction=0.3), max_displacement=0.1)
        weight = UNIT_WEIGHT * self.width * self.height
        wanted = 0.3 + 4e3 * self.width / weight
        assert curve.peak.load_multiplier == pytest.approx(wanted, rel=1e-3)
        point = curve.points[-1]
        left = np.exp(-4e3 * point.control_displacement / 100.0)
        assert point.load_multiplier == pytest.approx(0.3 + left * (wanted - 0.3), rel=1e-3)
