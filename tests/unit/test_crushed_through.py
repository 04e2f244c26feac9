"""Blocks that go through joints which are crushed: how that ends a curve, what contacts inherit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import rectangle
from drystone.analysis.plausible import Plausibility
from drystone.contact.contacts import Slots
from drystone.contact.detection import Detector
from drystone.contact.histories import Histories, handed_on
from drystone.engines.base import EngineError, StepReport
from drystone.law.columns import DILATION, N_HISTORY
from drystone.law.strengths import Strengths
from drystone.model.assembly import Block
from drystone.model.builders import make_model
from drystone.model.joint_law import JointLaw

pytestmark = pytest.mark.kernels

DRY = JointLaw(friction_coefficient=0.65, normal_stiffness=1e9, shear_stiffness=4e8)
CRUSHED = replace(DRY, compressive_strength=1e6, compressive_fracture_energy=2e3)


def pier(joint):
    """A block of 0.4 x 1 m on a base."""
    blocks = [
        Block(id="base", vertices=rectangle(-1, -1, 2.4, 1), unit_weight=2e4, support=True),
        Block(id="pier", vertices=rectangle(0, 0, 0.4, 1.0), unit_weight=2e4),
    ]
    return make_model(blocks, joint=joint, thickness=1.0, load_direction=(1.0, 0.0))


def sunk(model, depth):
    """The pair of the pier and its base, its contacts and their detector, ``depth`` [m] into each
    other."""
    detector = Detector(model.assembly)
    pose = model.assembly.design_pose()
    pose[model.assembly.index("pier"), 1] = -depth
    pairs = detector.pairs(pose)
    return detector, pose, pairs, detector.find(pairs, pose)


def told(model, depth, *, dynamic):
    """What ends an analysis with the pier ``depth`` [m] in its base."""
    detector, pose, pairs, slots = sunk(model, depth)
    n = len(slots.kind)
    found = detector.forces(pairs, pose, slots, np.zeros((n, 2)), np.zeros(n, np.int64))
    report = StepReport(converged=True, penetration=depth, dynamic=dynamic)
    return Plausibility(model).falls_through(report, lambda: found), report, found


def test_a_block_that_falls_through_a_crushed_joint_is_a_collapse():
    """Half of the block that moves, 0.2 m, may be passed in motion."""
    how, _, _ = told(pier(CRUSHED), 0.21, dynamic=True)
    assert how == 'a block falls through the joint between "base" and "pier", which is crushed'
    assert told(pier(CRUSHED), 0.19, dynamic=True)[0] is None


@pytest.mark.parametrize(("joint", "dynamic"), [(DRY, True), (CRUSHED, False)])
def test_what_is_dry_or_at_rest_is_none(joint, dynamic):
    model = pier(joint)
    how, report, found = told(model, 0.21, dynamic=dynamic)
    assert how is None
    with pytest.raises(EngineError, match="are pressed"):
        Plausibility(model).check(report, 0.1, lambda: found)


def test_a_new_contact_is_crushed_by_what_its_joint_cannot_bear():
    """It bears 1e6 Pa / 1e9 Pa/m = 1 mm; a contact that goes on keeps its own history."""
    model = pier(CRUSHED)
    detector, _, pairs, slots = sunk(model, 0.01)
    n, bears = len(slots.kind), Strengths(model.assembly).bears
    nothing = np.zeros((n, N_HISTORY)), np.zeros((n, 2)), np.zeros(n, np.int64)
    new = Histories.own(Slots.empty(n, 2), *nothing)
    heirs = handed_on(detector.narrow, new, pairs, slots, bears=bears)
    assert heirs.history[:, DILATION] == pytest.approx(0.001 - 0.01, rel=1e-9)
    goes_on = Histories.own(slots, *nothing)
    heirs = handed_on(detector.narrow, goes_on, pairs, slots, bears=bears)
    assert np.all(heirs.history[:, DILATION] == 0.0)
    assert Strengths(pier(DRY).assembly).bears is None
