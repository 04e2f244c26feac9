"""The energy balance of dry and crushed joints, in steps taken in parts; see `joint_energy`.

The smallest case is a block that slides off the edge of its base.  Of its length b, l lies on the
base, and the resultant of weight W and load mu W presses at r = b/2 + mu H/2 from the rear corner.
The two points of the joint, of area l/2 each, carry N = W (1 - r/l) and W r/l.  As l shrinks, the
springs that come free take along, per unit of the way,

    sum of 1/2 k_n (N / (k_n l/2))^2 / 2 = W^2 / k_n  (2 r^2 - 2 r l + l^2) / l^4,

whose integral is W^2/k_n [-2 r^2 / 3 l^3 + r / l^2 - 1 / l].  The shear of points that slide, mu N,
stores as much more, times mu^2 k_n / k_s, as it is kept while the area shrinks.
"""

from __future__ import annotations

from itertools import pairwise

import pytest

import drystone as ds
from bonded_walls import bonded_wall
from builders import rectangle
from joint_energy import energy_of

LENGTH, HEIGHT, WEIGHT, MU = 1.0, 0.2, 2e4, 0.5  # m, m, N/m3, -


def sliding_off(normal_stiffness, shear_stiffness):
    base = ds.Block(
        id="base", vertices=rectangle(-2.0, -1.0, 2.0, 1.0), unit_weight=WEIGHT, support=True
    )
    block = ds.Block(id="b", vertices=rectangle(-LENGTH, 0.0, LENGTH, HEIGHT), unit_weight=WEIGHT)
    joint = ds.JointLaw(
        friction_coefficient=MU,
        normal_stiffness=normal_stiffness,
        shear_stiffness=shear_stiffness,
    )
    return ds.make_model(
        [base, block],
        joint=joint,
        thickness=1.0,
        load_direction=(1.0, 0.0),
        analysis=ds.Analysis(options={"max_displacement": 0.3}),
    )


@pytest.mark.parametrize("ratio", [1.0, 4.0])
def test_what_a_shrinking_joint_releases(ratio):
    kn = 1e8
    curve, energy = energy_of(sliding_off(kn, ratio * kn), parts=4)
    far, weight = curve.points[-1].control_displacement, WEIGHT * LENGTH * HEIGHT

    def released(length):
        r = 0.5 * LENGTH + 0.5 * MU * HEIGHT
        return -2.0 * r**2 / (3.0 * length**3) + r / length**2 - 1.0 / length

    whole = weight**2 / kn * (released(LENGTH) - released(LENGTH - far))
    expected = -(1.0 - MU**2 / ratio) * whole / (MU * weight * far)
    # Areas are those where a step begins: of first order in the 0.4 % of the length it goes.
    assert energy.interface == pytest.approx(expected, rel=2e-3)
    assert energy.error < 3e-2 * abs(energy.interface)


def test_the_error_of_the_balance_is_that_of_its_quadrature():
    """A wall that is crushed under a toe: steps in 1, 2, 4, 8 parts leave less and less.

    The curve may bend by more within a step than by default, so that there is an error to see.
    """
    errors = [
        energy_of(bonded_wall(19), parts=parts, bend_share=0.03)[1].error for parts in (1, 2, 4, 8)
    ]
    assert errors[0] > 1e-3
    for coarse, fine in pairwise(errors):
        assert fine < 0.5 * coarse  # of second order where no contact changes, of first elsewhere
