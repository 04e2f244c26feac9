"""A pinnacle upon a monolith that is 200 and 2500 times as heavy, against its closed forms.

Forces on a block are measured by its own weight.  Measured by the monolith's, an unbalanced force
on the pinnacle, or one that its bond releases, could be as large as the weight of the pinnacle.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from builders import STIFF, UNIT_WEIGHT, stack
from drystone.analysis.driver import pushover
from drystone.model.joint_law import JointLaw

MONOLITH = 5.0  # m, its width and height
#: Width B and height H of pinnacles [m], 5e-3 and 4e-4 of the monolith.
PINNACLES = [(0.2, 0.6), (0.05, 0.2)]
#: What elastic joints lean by where the peak is, and the residual of `distinct` over the weight.
BOUND = 5e-3
ENGINES = ["equilibrium", "distinct"]


def pushed(size, joint, engine):
    """The peak of a pinnacle, the control block, that is pushed with all that it stands on."""
    model = stack((MONOLITH, MONOLITH), size, joint=joint)
    return pushover(model, engine=engine).peak.load_multiplier


def glued(tension=0.0):
    """Joints that do not slide; the tensile strength is in Pa."""
    joint = JointLaw(friction_coefficient=0.9, normal_stiffness=STIFF, shear_stiffness=STIFF)
    return replace(joint, tensile_strength=tension, cohesion=1e2 * tension)


@pytest.mark.parametrize("size", PINNACLES)
@pytest.mark.parametrize("engine", ENGINES)
def test_it_rocks_under_its_own_weight(size, engine):
    width, height = size
    assert pushed(size, glued(), engine) == pytest.approx(width / height, rel=BOUND)


@pytest.mark.parametrize("size", PINNACLES)
@pytest.mark.parametrize("engine", ENGINES)
def test_its_bond_is_one_of_its_own(size, engine):
    """The bond at the heel, f_t B/2, is lost at lambda W H/2 = (W/2 + f_t B/2) B."""
    width, height = size
    weight = UNIT_WEIGHT * width * height
    tension = 0.8 * weight / width
    expected = 1.8 * width / height
    assert pushed(size, glued(tension), engine) == pytest.approx(expected, rel=BOUND)
