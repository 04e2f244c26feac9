"""Random structures with brittle bonds: each of their points at rest is balanced."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import drystone as ds
from random_kinds import KINDS
from true_ends import unbalanced


def bonded(kind, seed):
    """A random structure whose tensile strength is a share of the stress of its own height."""
    model, rng = KINDS[kind](seed), np.random.default_rng(seed)
    assembly = model.assembly
    weight = max(block.unit_weight for block in assembly.blocks)
    top = max(float((block.vertices @ assembly.up).max()) for block in assembly.blocks)
    tension = weight * top * float(rng.uniform(0.1, 1.0))
    cohesion = tension * max(
        1.2 * assembly.joint.friction_coefficient, float(rng.uniform(0.8, 1.6))
    )
    analysis = replace(model.analysis, options={"max_displacement": 0.2 * top})
    return replace(model.with_joint(tensile_strength=tension, cohesion=cohesion), analysis=analysis)


@pytest.mark.parametrize(
    ("kind", "seed"),
    [("plateband", 2002), ("plateband-plane", 2002), ("arches", 2004), ("opening-plane", 2004)],
)
def test_no_bond_bears_more_than_its_strength(kind, seed):
    curve = ds.pushover(bonded(kind, seed), engine="equilibrium")
    assert not unbalanced(curve)
    assert curve.status == "finished"
