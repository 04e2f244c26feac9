"""Joints in space that soften and are crushed, by cycles, against closed forms.

One block on a base, whose joint has the same state at all its points; what joints have become is
read off forces and displacements.  Cycles end at 1e-5 of the weight.

A block that is pulled off would tear its joint from one side: springs at its corners, stiffer than
the joint is as it softens, keep it level.  What they carry is known.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import test_joint_laws as plane_laws
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from test_joint_laws import joint

import drystone as ds
import solids
from builders import stack
from drystone.model.joint_law import JointLaw

B, D, H = 0.8, 0.5, 0.1  # m
AREA, STIFFNESS = B * D, 1e10
WEIGHT = solids.UNIT_WEIGHT * AREA * H


def guides(stiffness):
    """Upright springs above the corners of the block."""
    return [
        ds.spring(
            start=ds.TieEnd(block="b", point=np.array([x, y, H])),
            end=ds.TieEnd(point=np.array([x, y, H + 1.0])),
            stiffness=stiffness,
            name=f"{x} {y}",
        )
        for x in (0.0, B)
        for y in (0.0, D)
    ]


def pushed(direction, step, most, guide=None, engine="distinct", **values):
    """Displacement along the push since the joint had no load, and what the joint holds against
    it [N]."""
    law = JointLaw(
        **{"friction_coefficient": 0.6, "normal_stiffness": STIFFNESS, "shear_stiffness": STIFFNESS}
        | values
    )
    along = np.array(direction, float)
    blocks = [
        solids.box("base", (-1, -1, -0.2), (2, 2, 0), support=True),
        solids.box("b", (0, 0, 0), (B, D, H)),
    ]
    point = (0.5 * B, 0.5 * D, 0.5 * H)
    model = solids.model_of(blocks, law, push=along, control="b", point=point)
    if guide:
        model = model.with_ties(guides(guide))
    curve = ds.pushover(
        model,
        engine=engine,
        displacement_step=step,
        max_displacement=most,
        stop_multiplier=1e-3,
    )
    assert curve.status == "finished"
    moved = curve.column("control_displacement")
    force = curve.column("load_multiplier") * WEIGHT
    down = -along[2] / np.linalg.norm(along)
    if guide:
        force = force - down * curve.ties.force.sum(axis=1)
    stiffness = STIFFNESS * AREA + (4.0 * guide if guide else 0.0)
    return moved + down * WEIGHT / stiffness, force + down * WEIGHT


def fallen(strength, energy, moved):
    """Stress of a joint that is drawn by a displacement and softens: f exp(-f k / G)."""
    if STIFFNESS * moved <= strength:
        return STIFFNESS * moved
    beyond = brentq(
        lambda k: k + strength * np.exp(-strength * k / energy) / STIFFNESS - moved, 0.0, moved
    )
    return strength * np.exp(-strength * beyond / energy)


class TestPulledOff:
    strength, energy = 2e4, 1.0

    def test_stress_at_every_opening_and_energy(self):
        moved, force = pushed(
            (0, 0, 1), 1e-5, 6e-4, 1e8,
            cohesion=1e5, tensile_strength=self.strength,
            tensile_fracture_energy=self.energy, shear_fracture_energy=10.0,
        )  # fmt: skip
        expected = AREA * np.array([fallen(self.strength, self.energy, u) for u in moved])
        assert len(moved) > 20
        assert force == pytest.approx(expected, abs=1e-3 * AREA * self.strength)
        # Up to the strength the joint is elastic; what is left is exp(-12).
        at = self.strength / STIFFNESS
        x = np.append(at, moved[moved > at])
        y = np.append(AREA * self.strength, force[moved > at])
        work = float(PchipInterpolator(x, y).integrate(x[0], x[-1])) + 0.5 * y[0] * at
        assert work == pytest.approx(self.energy * AREA, rel=1e-3)

    def test_brittle_bonds_do_not_soften(self):
        _, force = pushed((0, 0, 1), 1e-5, 1e-4, cohesion=1e5, tensile_strength=self.strength)
        assert force.max() == pytest.approx(AREA * self.strength, rel=2e-3)
        assert force.min() < 1e-3 * AREA * self.strength


@pytest.mark.parametrize("angle", [0.0, 30.0, 110.0])
class TestPushedOff:
    """T = mu(k) W + c(k) A along any direction in the joint, k what has slid."""

    def slid(self, angle, **values):
        turn = np.radians(angle)
        moved, force = pushed((np.cos(turn), np.sin(turn), 0.0), 1e-4, 2e-3, **values)
        return moved - force / (STIFFNESS * AREA), force

    def test_cohesion_and_friction(self, angle):
        cohesion, energy, last = 2e3, 0.5, 0.4
        slid, force = self.slid(
            angle,
            cohesion=cohesion,
            shear_fracture_energy=energy,
            residual_friction_coefficient=last,
        )
        left = np.exp(-cohesion * slid / energy)
        expected = (last + (0.6 - last) * left) * WEIGHT + cohesion * AREA * left
        later = slid > 1e-5
        assert later.sum() > 10
        assert force[later] == pytest.approx(expected[later], rel=1e-4)

    def test_friction_over_a_slip(self, angle):
        length, last = 3e-4, 0.35
        slid, force = self.slid(angle, residual_friction_coefficient=last, residual_slip=length)
        expected = WEIGHT * (last + (0.6 - last) * np.exp(-slid / length))
        later = slid > 1e-5
        assert later.sum() > 10
        assert force[later] == pytest.approx(expected[later], rel=1e-4)


class TestPressed:
    strength = 5e4

    # In cycles a corner may be crushed a little more than another, and stays so.
    @pytest.mark.parametrize(("engine", "bound"), [("distinct", 1e-4), ("equilibrium", 1e-8)])
    def test_it_yields(self, engine, bound):
        moved, force = pushed(
            (0, 0, -1), 1e-6, 2e-5, engine=engine, compressive_strength=self.strength
        )
        expected = AREA * np.minimum(STIFFNESS * moved, self.strength)
        assert force == pytest.approx(expected, rel=bound, abs=bound * WEIGHT)
        assert force[-1] == pytest.approx(AREA * self.strength, rel=bound)

    def test_it_softens(self):
        energy = 20.0
        moved, force = pushed(
            (0, 0, -1), 1e-5, 5e-4, 1e8,
            compressive_strength=self.strength, compressive_fracture_energy=energy,
        )  # fmt: skip
        expected = AREA * np.array([fallen(self.strength, energy, u) for u in moved])
        assert len(moved) > 20
        assert force == pytest.approx(expected, abs=1e-3 * AREA * self.strength)


def test_a_pad_torn_off_in_bending():
    """The plane's pads made solid; damped waves soften joints a little early."""
    case = plane_laws.TestTensionAndBending()
    pads = case.pads
    plane = pads.model(case.left, joint(), (1.0, 0.0))
    curve = ds.pushover(
        ds.extruded(plane),
        engine="distinct",
        displacement_step=1e-4,
        max_displacement=1e-4,
        stop_multiplier=1e-3,
    )
    peak = pads.multipliers(np.linspace(4e-6, 6e-6, 400), case.pull).max()
    assert curve.peak.load_multiplier == pytest.approx(peak, rel=5e-3)


def test_a_crushed_toe():
    """Four points across, in space as in the plane: their areas along the depth add up to its."""
    case = plane_laws.TestCrushing()
    law = joint(1.0, 1e10, compressive_strength=case.weight / 0.2)
    plane = stack((case.width, case.height), joint=law)
    few = replace(plane, assembly=replace(plane.assembly, points=4))
    options = {"engine": "distinct", "displacement_step": 2e-3, "max_displacement": 0.03}
    one = ds.pushover(few, **options)
    other = ds.pushover(ds.extruded(plane, points=16), **options)
    assert other.peak.load_multiplier == pytest.approx(one.peak.load_multiplier, rel=1e-3)
    assert other.peak.load_multiplier < 0.99 * (case.width / case.height)


@pytest.mark.slow
def test_a_wall_in_mortar():
    """In its plane it does in space what it does there: waves soften joints alike."""
    plane = plane_laws.mortar_wall(**plane_laws.STRENGTHS)
    options = {"engine": "distinct", "displacement_step": 5e-5, "max_displacement": 3.5e-4}
    one, other = ds.pushover(plane, **options), ds.pushover(ds.extruded(plane), **options)
    assert one.peak.load_multiplier > 0.8  # 0.53 dry
    assert other.peak.load_multiplier == pytest.approx(one.peak.load_multiplier, rel=1e-3)


def test_hyperbolic_closure_is_refused():
    law = joint(0.6, 1e9, greatest_closure=1e-3)
    with pytest.raises(ds.EngineError, match="close hyperbolically in space"):
        ds.pushover(ds.extruded(stack((1.0, 0.2), joint=law)), engine="distinct", max_steps=1)
