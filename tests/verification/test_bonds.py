"""Brittle joints: closed forms of the teeth of the curve, and that they do not hang on the step."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import solids
from builders import PUBLISHED_JOINT, STIFF, UNIT_WEIGHT, RockingBlock, rectangle, stack, with_joint
from drystone.analysis.driver import pushover
from drystone.model.assembly import Block
from drystone.model.builders import make_model, published_wall
from drystone.model.joint_law import JointLaw
from drystone.results.curve import STATIC

#: How near to its strength a bond is where a step ends for it, over strength: 1e-5 and 1e-3.  In
#: both engines multipliers are of the order of the strengths over weights, with what the elastic
#: joints lean: W / (k B^2), below 1e-4.
NEAR = {"equilibrium": 1e-4, "distinct": 2e-3}
ENGINES = list(NEAR)


def glue(cohesion=0.0, tension=0.0, friction=0.3):
    return JointLaw(
        friction_coefficient=friction,
        normal_stiffness=STIFF,
        shear_stiffness=STIFF,
        cohesion=cohesion,
        tensile_strength=tension,
    )


def teeth(curve):
    """Static multipliers from which the curve drops at once, in order."""
    static = [p for p in curve.points if p.status == STATIC]
    return [
        p.load_multiplier
        for p, q in pairwise(static)
        if q.load_multiplier < p.load_multiplier - 1e-2
        and abs(q.control_displacement - p.control_displacement) < 1e-6
    ]


@pytest.mark.parametrize("engine", ENGINES)
class TestOneJointInShear:
    """A flat block B x H glued to its base, which has two points with half of the bond each.

    Both take half of the load.  Tipping takes lambda W H / 2B of pressure from the heel and adds it
    to the toe, so that the heel's bond goes first, at

        lambda W / 2 = mu (W / 2 - lambda W H / 2B) + c A / 2,

    the toe's once it carries all but the heel's friction, lambda = mu + c A / 2W, and then the
    block slides at mu.
    """

    width, height, friction = 1.0, 0.2, 0.3

    def trace(self, engine, over_weight, **options):
        weight = UNIT_WEIGHT * self.width * self.height
        joint = glue(over_weight * weight / self.width, friction=self.friction)
        model = stack((self.width, self.height), joint=joint)
        return pushover(model, engine=engine, **{"max_displacement": 1e-3, **options})

    @pytest.mark.parametrize("over_weight", [0.2, 0.5, 2.0])
    def test_both_teeth_and_what_is_left(self, engine, over_weight):
        curve = self.trace(engine, over_weight)
        slope = self.friction * self.height / self.width
        heel = (self.friction + over_weight) / (1.0 + slope)
        toe = self.friction + 0.5 * over_weight
        assert teeth(curve) == pytest.approx([heel, toe], rel=NEAR[engine])
        assert curve.peak.load_multiplier == pytest.approx(heel, rel=NEAR[engine])
        assert curve.points[-1].load_multiplier == pytest.approx(self.friction, abs=1e-3)

    @pytest.mark.parametrize("step", [2e-6, 2e-5, 2e-4, 2e-3])
    def test_on_any_step(self, engine, step):
        """The joint is sheared by 1e-7 m until then: much less than the longest of these steps."""
        curve = self.trace(engine, 0.5, displacement_step=step, max_displacement=5e-6)
        heel = (self.friction + 0.5) / (1.0 + self.friction * self.height / self.width)
        assert curve.peak.load_multiplier == pytest.approx(heel, rel=NEAR[engine])


@pytest.mark.parametrize("engine", ENGINES)
class TestTwoPointsOfATippingBlock:
    """A slender block B x H: the heel pulls with half of f_t A until

        W / 2 - lambda W H / 2B = -f_t A / 2,    lambda = B / H (1 + f_t A / W),

    and then the block rocks at B / H."""

    width, height = 0.4, 1.0

    @pytest.mark.parametrize("over_weight", [0.1, 1.0])
    def test_the_tip_and_what_is_left(self, engine, over_weight):
        weight = UNIT_WEIGHT * self.width * self.height
        joint = glue(2.0 * weight / self.width, over_weight * weight / self.width, friction=0.8)
        model = stack((self.width, self.height), joint=joint)
        curve = pushover(model, engine=engine, max_displacement=2e-3)
        slender = self.width / self.height
        assert teeth(curve) == pytest.approx([slender * (1.0 + over_weight)], rel=NEAR[engine])
        block, last = RockingBlock(self.width, self.height), curve.points[-1]
        rocking = block.multiplier(block.rotation(last.control_displacement))
        # The toe closes by W / (k_n B / 2) = 2e-6 m, and the joint is sheared by less.
        assert last.load_multiplier == pytest.approx(rocking, abs=5e-5)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("weakest", [1, 2, 3])
def test_the_weakest_of_three_joints_goes_first(engine, weakest):
    """As for one joint, with the weight W and the height H of all that is above it."""
    width, height, friction, n = 1.0, 0.2, 0.3, 3
    names = ["base", "b1", "b2", "b3"]
    weight = UNIT_WEIGHT * width * height
    above = n + 1 - weakest
    joint = glue(10.0 * weight / width, friction=friction)
    weak = glue(0.5 * above * weight / width, friction=friction)
    pair = frozenset(names[weakest - 1 : weakest + 1])
    model = stack(*[(width, height)] * n, joint=joint, joint_between={pair: weak})
    curve = pushover(model, engine=engine, max_displacement=2e-4)
    heel = (friction + 0.5) / (1.0 + friction * above * height / width)
    assert curve.peak.load_multiplier == pytest.approx(heel, rel=NEAR[engine])


class TestABlockThatStandsOut:
    """A cube stands out over the edge of its support, with three points of bond along the rest.

    The back row tears first, and the multiplier drops below zero: dry, the cube would stand with
    next to nothing.  Then it rises to where the middle row, with half of the area A at the distance
    l / 2 from the edge, is at its strength f, and from there on the cube is dry:

        lambda W B / 2 = W (l - B / 2) + f A l / 4.
    """

    width, overhang, unit_weight = 1.0, 0.45, 20e3

    def trace(self, strength, **options):
        rest = self.width - self.overhang
        base = np.array([[-2.0, -0.3], [0.0, -0.3], [0.0, 0.0], [-2.0, 0.0]])
        cube = rectangle(-rest, 0.0, self.width, self.width)
        blocks = [
            Block(id="base", vertices=base, unit_weight=self.unit_weight, support=True),
            Block(id="cube", vertices=cube, unit_weight=self.unit_weight),
        ]
        joint = replace(PUBLISHED_JOINT, friction_coefficient=0.8, normal_stiffness=1e9)
        joint = replace(joint, shear_stiffness=1e9, cohesion=1e5, tensile_strength=strength)
        model = make_model(
            blocks=blocks, joint=joint, load_direction=(1.0, 0.0), points=3, thickness=1.0
        )
        return pushover(model, **options)

    # The last digits of the displacement decided which of these went on.
    @pytest.mark.parametrize("strength", [25e3, 28e3, 32e3, 36e3, 40e3, 44e3])
    @pytest.mark.parametrize("engine", ENGINES)
    def test_a_drop_below_the_stop_value_is_no_end(self, engine, strength):
        curve = self.trace(strength, engine=engine)
        weight, rest = self.unit_weight * self.width**2, self.width - self.overhang
        moment = weight * (rest - 0.5 * self.width) + 0.25 * strength * rest**2
        assert curve.status == "finished"
        assert min(curve.column("load_multiplier")[:4]) < 0.0
        exact = 2.0 * moment / (weight * self.width)
        assert curve.peak.load_multiplier == pytest.approx(exact, rel=5e-3)
        dry = self.trace(0.0).ultimate_displacement
        assert curve.ultimate_displacement == pytest.approx(dry, rel=2e-3)

    @pytest.mark.parametrize("engine", ENGINES)
    def test_in_space(self, engine):
        """`distinct` stopped at the first tooth: it judged a bond at its strength as broken."""
        law = replace(glue(cohesion=1e5, tension=28e3, friction=0.8), normal_stiffness=1e9)
        blocks = [
            solids.box("base", (-2.0, -2.0, -0.3), (0.0, 2.0, 0.0), support=True),
            solids.box("cube", (-0.55, -0.5, 0.0), (0.45, 0.5, 1.0)),
        ]
        joint = replace(law, shear_stiffness=1e9)
        model = solids.model_of(blocks, joint, push=(1.0, 0.0, 0.0), points=9)
        curve = pushover(model, engine=engine, max_displacement=2e-3)
        exact = 2.0 * (solids.UNIT_WEIGHT * 0.05 + 0.25 * 28e3 * 0.55**2) / solids.UNIT_WEIGHT
        assert curve.peak.load_multiplier == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_joint_that_nothing_presses_is_bonded(engine):
    """A block glued to the side of a post, drawn down: a head joint.

    Its weight acts at half its width b from the joint, whose two points are the height h apart: the
    upper one pulls with (1 + lambda) W b / 2h, until f_t A / 2.
    """
    width, height = 0.3, 0.2
    post = Block(
        id="post", vertices=rectangle(-0.5, 0.0, 0.5, 0.6), unit_weight=UNIT_WEIGHT, support=True
    )
    held = Block(id="held", vertices=rectangle(0.0, 0.3, width, height), unit_weight=UNIT_WEIGHT)
    weight = UNIT_WEIGHT * width * height
    strength = 4.0 * weight / height
    model = make_model(
        [post, held], joint=glue(strength, strength), thickness=1.0, load_direction=(0.0, -1.0)
    )
    # Until then it turns by 1e-5 and its corner sinks by 4e-6 m.
    curve = pushover(model, engine=engine, max_displacement=6e-6, max_steps=40)
    pulled = 2.0 / (0.5 * width / height) - 1.0
    assert curve.peak.load_multiplier == pytest.approx(pulled, rel=NEAR[engine])


def cohesive_wall():
    """Wall 1 with joints as soft along as across, and 10 kPa of cohesion."""
    law = replace(PUBLISHED_JOINT, shear_stiffness=1e8, cohesion=10e3)
    return with_joint(published_wall(1), law)


@pytest.mark.slow
class TestCohesiveWall:
    def test_the_peak_does_not_hang_on_the_step(self):
        peaks = [
            pushover(
                cohesive_wall(), displacement_step=step, max_displacement=4e-3
            ).peak.load_multiplier
            for step in (2e-3, 1e-3, 5e-4, 2.5e-4)
        ]
        # Slips are of second order in the step; the order of breaks is not touched by that.
        assert np.ptp(peaks) <= 1e-3 * max(peaks)

    def test_two_engines_agree(self):
        peaks = [
            pushover(cohesive_wall(), engine=engine, max_displacement=4e-3).peak.load_multiplier
            for engine in ENGINES
        ]
        assert peaks[0] == pytest.approx(peaks[1], rel=1e-2)
