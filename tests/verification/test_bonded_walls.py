"""Random walls whose joints soften, are crushed, or both: traced whole, with their energy.

They run to the stop multiplier or to the displacement that was asked for.  Along equilibria the
work of the loads is stored or dissipated; the mean of the forces at both ends of a step stands for
those in it.  That is within a thousandth where most of the work is done by bonds.  Elsewhere walls
rise over a few steps, in each of which contacts begin to slide and to be crushed: these are gone
through in eight parts.
"""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from bonded_walls import KINDS, bonded_wall
from builders import rectangle
from drystone.assembly import JointLaw
from drystone.contact.strengths import Strengths
from drystone.kernels.law import H_CRUSH, H_MU, H_ROOM
from joint_energy import energy_of

#: Dimension and seed; those of FEW take less than 2 s each.
FEW = [(2, 0), (2, 1), (2, 3), (2, 4), (3, 1), (3, 2), (3, 3)]
MANY = [(2, 2), *((2, seed) for seed in range(5, 12)), (3, 0), *((3, seed) for seed in range(4, 8))]


def is_whole(curve):
    """Whether it goes to where it was to end."""
    ends = ("the control displacement reached", "the load multiplier fell below", "collapsed")
    return curve.status == "finished" and any(end in curve.reason for end in ends)


def check(dimension, seed):
    parts = 8 if KINDS[seed % 3] == "crushing" else 1
    curve, energy = energy_of(bonded_wall(seed, dimension), parts=parts)
    assert is_whole(curve), curve.reason
    assert energy.error < 1e-3
    return curve


@pytest.mark.parametrize(("dimension", "seed"), FEW)
def test_traced_whole_with_its_energy(dimension, seed):
    assert len(check(dimension, seed).points) < 300


@pytest.mark.slow  # up to a minute each in space, else some 6 s
@pytest.mark.parametrize(("dimension", "seed"), MANY)
def test_many_traced_whole(dimension, seed):
    check(dimension, seed)


def test_contacts_made_on_the_way_are_crushed_and_have_residual_friction():
    law = JointLaw(
        friction_coefficient=0.7,
        normal_stiffness=1e9,
        shear_stiffness=4e8,
        cohesion=8e4,
        shear_fracture_energy=100.0,
        residual_friction_coefficient=0.5,
        compressive_strength=2e6,
    )
    block = ds.Block(id="b", vertices=rectangle(0.0, 0.0, 1.0, 1.0), unit_weight=2e4)
    base = ds.Block(id="a", vertices=rectangle(-1.0, -1.0, 3.0, 1.0), unit_weight=2e4, support=True)
    model = ds.make_model([base, block], joint=law, thickness=1.0, load_direction=(1.0, 0.0))
    fresh = Strengths(model.assembly).fresh
    assert np.allclose(fresh[:, H_CRUSH], 2e6)
    assert np.allclose(fresh[:, H_MU], 0.5)
    assert np.allclose(fresh[:, H_ROOM], 0.0)
