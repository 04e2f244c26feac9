"""Each engine of ours on one block, which every stage of its kernels can follow interpreted."""

from __future__ import annotations

import pytest

import drystone as ds
from builders import stack
from interpreted import fewer

pytestmark = pytest.mark.kernels


@pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
def test_a_block_slides_at_its_friction(engine):
    model = stack((0.4, 0.2))
    # Interpreted, the many cycles of the explicit engine are those of one step.
    n = fewer(100, 1) if engine == "distinct" else 100
    curve = ds.pushover(model, engine=engine, max_displacement=2e-3, max_steps=n)
    friction = model.assembly.joint.friction_coefficient
    # 1e-6 is what engines promise of a static point; the lever arm of 0.1 m overturns nothing.
    assert curve.peak.load_multiplier == pytest.approx(friction, rel=1e-6)
