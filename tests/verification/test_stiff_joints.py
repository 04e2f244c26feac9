"""Joints so stiff that blocks sink by less than the rounding of their coordinates.

Limit analysis of rigid blocks says which arches stand, and bounds every peak from above.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import problem_of, stack
from drystone.analysis.driver import pushover
from drystone.engines.base import EngineError
from drystone.limit import ASSOCIATIVE, collapse_load
from drystone.model.assembly import Block, Corner
from drystone.model.builders import circular_arch, make_model
from drystone.model.joint_law import JointLaw
from drystone.statics.equilibrium import EquilibriumEngine

#: Weight of the arches' stone [N/m3].
STONE = 20e3


def arch(radius, thickness, embrace, n_voussoirs, stiffness, *, friction=0.7, shear=1.0, corner=0):
    """An arch by its centre line; ``shear`` is the shear stiffness over the normal one."""
    return make_model(
        circular_arch(
            radius=radius,
            thickness=thickness,
            embrace=embrace,
            n_voussoirs=n_voussoirs,
            unit_weight=STONE,
        ),
        joint=JointLaw(
            friction_coefficient=friction,
            normal_stiffness=stiffness,
            shear_stiffness=shear * stiffness,
        ),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        corner=Corner(radius=corner or None),
    )


#: Radius, thickness [m], embrace [degrees] and number of voussoirs.
SEMICIRCLE = 4.0, 0.5, 180.0, 17
SMALL = 0.2, 0.03, 162.0, 16
THICK = 11.0, 2.0, 180.0, 27


@pytest.mark.parametrize("measures", [SEMICIRCLE, SMALL, THICK])
@pytest.mark.parametrize("stiffness", [3e10, 1e11, 1e12])
def test_stiff_arches_stand(measures, stiffness):
    state, report = EquilibriumEngine().start(problem_of(arch(*measures, stiffness)))
    assert report.converged
    assert report.residual < 1e-6  # the coarsest that the engine lets pass; 1e-9 but for rounding
    # What joints close by goes with 1/k: nothing but elastic settlement has moved the blocks.
    soft, _ = EquilibriumEngine().start(problem_of(arch(*measures, 0.1 * stiffness)))
    assert np.abs(state.pose).max() == pytest.approx(0.1 * np.abs(soft.pose).max(), rel=0.01)


def random_arch(rng):
    """Anything from slender to thick and soft to stiff, sharp or rounded; None where it could
    not stand or joints are soft enough to let it snap through."""
    n, embrace, radius = int(rng.integers(5, 41)), rng.uniform(100, 180), 10 ** rng.uniform(-1, 1.3)
    # Couplet and Heyman: a semicircle of t/R below 0.107 falls; flatter ones may be thinner.
    thickness = 0.107 * (embrace / 180) ** 4 * 10 ** rng.uniform(0.02, 0.6) * radius
    edge = min((radius - 0.5 * thickness) * np.radians(embrace) / n, thickness)
    model = arch(
        radius,
        thickness,
        embrace,
        n,
        10 ** rng.uniform(8, 12),
        friction=rng.uniform(0.4, 1.0),
        shear=10 ** rng.uniform(-1, 2),
        corner=float(rng.choice([0.0, 0.0, 0.02, 0.1])) * edge,
    )
    # As many joints as voussoirs close by the thrust's strain: by less than 1e-5 of the thickness
    # they cannot flatten the line of thrust noticeably.
    closing = STONE * radius / model.assembly.joint.normal_stiffness
    return model if n * closing < 1e-5 * thickness else None


@pytest.mark.slow
def test_every_stiff_arch_that_stands_has_its_peak():
    rng = np.random.default_rng(20)
    tried = 0
    while tried < 40:
        model = random_arch(rng)
        limit = collapse_load(model, flow=ASSOCIATIVE).load_multiplier if model else np.nan
        if not limit > 0.02:  # falls, or nearly does
            continue
        tried += 1
        curve = pushover(model)
        assert curve.status == "finished", curve.reason
        assert max(point.residual for point in curve.points) < 1e-6
        # From below, but for the toes of rounded corners, which roll as they turn.
        rolling = 3e-3 if model.assembly.corner.radius else 1e-4
        assert curve.peak.load_multiplier < (1.0 + rolling) * limit


@pytest.mark.parametrize("stiffness", [1e10, 1e11])
def test_default_steps_find_the_early_peak_of_a_stiff_arch(stiffness):
    """To the 2e-4 that a step may hide of it: by steps of a twentieth of what the joints give."""
    model = arch(*SEMICIRCLE, stiffness)
    curve = pushover(model, max_displacement=5e-3)
    fine = pushover(model, displacement_step=2e5 / stiffness, max_displacement=4e6 / stiffness)
    assert curve.peak.load_multiplier == pytest.approx(fine.peak.load_multiplier, rel=2e-4)


def heavy(unit_weight):
    """Two blocks whose lower one slides at mu = 0.4, of a weight that says how stiff joints are."""
    model = stack((0.8, 0.4), (0.8, 0.4), joint=JointLaw(**{
        "friction_coefficient": 0.4, "normal_stiffness": 1e8, "shear_stiffness": 1e11,
    }))  # fmt: skip
    blocks: list[Block] = [replace(b, unit_weight=unit_weight) for b in model.assembly.blocks]
    return make_model(blocks, joint=model.assembly.joint, thickness=1.0, load_direction=(1.0, 0.0))


@pytest.mark.parametrize("unit_weight", [1e-2, 1e-3])
def test_joints_too_stiff_for_the_weight_are_said_so(unit_weight):
    """Rounding of displacements times stiffness comes near to the weight: no point says more."""
    curve = pushover(heavy(unit_weight))
    assert curve.status == "stopped"
    assert "too stiff for the blocks' weight" in curve.reason
    assert max(point.residual for point in curve.points) < 1e-6
    assert curve.peak.load_multiplier == pytest.approx(0.4, rel=1e-3)  # all that is needed to slide


def test_an_arch_with_next_to_rigid_joints_is_refused_or_right():
    try:
        curve = pushover(arch(*SEMICIRCLE, 1e20))
    except EngineError as error:
        assert "too stiff" in str(error)
        return
    assert "too stiff" in curve.reason and curve.status == "stopped"
    assert max(point.residual for point in curve.points) < 1e-6
