"""Two piers with an anchor and dead loads, for tests of what is told and drawn of these."""

from __future__ import annotations

import numpy as np

import drystone as ds
from drystone.model.ties import Tie, TieEnd

FAR = np.array([-3.0, 1.5])  # where the anchor is fixed to the ground, far outside of the blocks


def piers(**more) -> ds.Model:
    """Two blocks of 0.5 m x 2 m on a wide base: a roof on one, an anchor at the other."""

    def block(name, x, y, width, height, **kind):
        corners = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
        return ds.Block(id=name, vertices=np.array(corners), unit_weight=2e4, **kind)

    return ds.make_model(
        [
            block("base", -1.0, -0.5, 6.0, 0.5, support=True),
            block("left", 0.0, 0.0, 0.5, 2.0),
            block("right", 2.0, 0.0, 0.5, 2.0),
        ],
        joint=ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        dead_loads=(
            ds.SurchargeLoad(block="right", weight=4e4, point="top", mass=False, name="roof"),
            ds.ForceLoad(
                block="left", point=np.array([0.5, 1.0]), force=np.array([-4e3, 0.0]), mass=False
            ),
        ),
        ties=(
            Tie(
                name="anchor",
                start=TieEnd(block="left", point=np.array([0.0, 1.5])),
                end=TieEnd(point=FAR),
                stiffness=1e7,
                yield_force=1e3,
                compression=False,
            ),
        ),
        **more,
    )
