"""Blocks that slide over the flush joint of two others: they carry friction and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

import drystone as ds
from drystone.model.assembly import Block
from drystone.model.builders import extruded, make_model
from drystone.model.joint_law import JointLaw

FRICTION = 0.6

#: What a peak may be off: 1e-4 of a block's weight may be left on faces that were followed, at the
#: end of each step, and steps of `nscd` end with some inertia.
OFF = {"equilibrium": 1e-3, "distinct": 5e-3, "nscd": 2e-2}


def slab(name, low, high, **more):
    (x0, y0), (x1, y1) = low, high
    vertices = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    return Block(id=name, vertices=vertices, unit_weight=20e3, **more)


def block_on_two(joint_at, stiffness, *, loose):
    """A block of 0.4 x 0.15 m, whose front is ``joint_at`` [m] short of where two below it meet.

    Where these are ``loose``, they stand on a base by twice the friction that the block has.
    """
    low, high = ((-1.0, -0.2), (0.0, 0.0)), ((0.0, -0.2), (1.0, 0.0))
    ground = [slab("base", (-1.5, -0.5), (1.5, -0.2), support=True)] if loose else []
    law = JointLaw(
        friction_coefficient=FRICTION, normal_stiffness=stiffness, shear_stiffness=stiffness
    )
    rough = replace(law, friction_coefficient=2.0 * FRICTION)
    below = [slab(n, *ends, support=not loose) for n, ends in (("left", low), ("right", high))]
    block = slab("block", (-0.4 - joint_at, 0.0), (-joint_at, 0.15))
    return make_model(
        [*ground, *below, block],
        joint=law,
        joint_between={frozenset(("base", name)): rough for name in ("left", "right") if loose},
        thickness=0.4,
        load_direction=(1.0, 0.0),
        control_block="block",
    )


def traced(model, space, engine="equilibrium"):
    model = extruded(model) if space else model
    return ds.pushover(model, engine=engine, max_displacement=0.05, progress=False)


@pytest.mark.parametrize("engine", OFF)
@pytest.mark.parametrize("joint_at", [0.0, 1e-4, 1e-3, 0.02])
@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_a_block_slides_over_a_flush_joint(engine, joint_at, space):
    """In space its front caught on the side of the next block, over which it would turn at 2.67:
    1.18 to 2.62; and where the joint is right below, 0.608, in the plane 0.605."""
    model = block_on_two(joint_at, 1e10, loose=False)
    curve = traced(model, space, engine)
    assert curve.peak.load_multiplier == pytest.approx(FRICTION, rel=OFF[engine])


@pytest.mark.parametrize("step", [1e-3, 5e-4])
@pytest.mark.parametrize("joint_at", [1e-3, 0.02])
def test_so_it_does_wherever_a_step_ends_beyond_the_joint(joint_at, step):
    """Soft joints: with some steps it carried up to 0.6087, on the side of the block beyond."""
    model = extruded(block_on_two(joint_at, 1e9, loose=False))
    options = {"max_displacement": joint_at + 0.004, "displacement_step": step}
    curve = ds.pushover(model, engine="equilibrium", **options)
    assert curve.peak.load_multiplier == pytest.approx(FRICTION, rel=OFF["equilibrium"])


@pytest.mark.parametrize("stiffness", [1e9, 1e11])
@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_so_it_does_where_both_below_are_loose(stiffness, space):
    model = block_on_two(0.0, stiffness, loose=True)
    curve = traced(model, space)
    assert curve.peak.load_multiplier == pytest.approx(FRICTION, rel=3e-3)
