"""Random walls whose joints have bonds that soften, are crushed, or both.

    wall = bonded_wall(seed, dimension)

Numbers are those of brickwork in weak mortar: strengths of tens of kPa, fracture energies a few
times the least that a bond of that strength and stiffness may have.
"""

from __future__ import annotations

import numpy as np

import drystone as ds
from drystone.model.builders import panel

KINDS = ("softening", "crushing", "both")


def bonded_law(rng: np.random.Generator, kind: str, pressure: float) -> ds.JointLaw:
    """Stiffness 1e9 to 1e10 Pa/m, friction 0.6 to 0.8, strengths by the ``kind``: those in
    compression some times the ``pressure`` [Pa] under the wall, so that toes are crushed."""
    friction, stiffness = rng.uniform(0.6, 0.8), 10.0 ** rng.uniform(9.0, 10.0)
    values = {}
    if kind != "crushing":
        tension = rng.uniform(20e3, 80e3)
        cohesion = tension * rng.uniform(1.4, 2.0)
        values |= {
            "tensile_strength": tension,
            "cohesion": cohesion,
            "tensile_fracture_energy": rng.uniform(4.0, 10.0) * tension**2 / stiffness,
            "shear_fracture_energy": rng.uniform(4.0, 8.0) * cohesion**2 / (0.4 * stiffness),
            "residual_friction_coefficient": friction * rng.uniform(0.75, 1.0),
        }
    if kind != "softening":
        strength = pressure * rng.uniform(4.0, 12.0)
        values["compressive_strength"] = strength
        if rng.uniform() < 0.5:
            least = strength**2 / stiffness
            values["compressive_fracture_energy"] = rng.uniform(3.0, 8.0) * least
    return ds.JointLaw(
        friction_coefficient=friction,
        normal_stiffness=stiffness,
        shear_stiffness=0.4 * stiffness,
        **values,
    )


def bonded_wall(seed: int, dimension: int = 2) -> ds.Model:
    """A panel on a base, with a window in half of them, pushed in its plane; in space half of them
    out of it.  The kind of joints goes with the seed."""
    rng = np.random.default_rng(seed)
    unit = rng.uniform(0.3, 0.5), rng.uniform(0.15, 0.25)
    few = dimension == 3
    n_long, n_high = int(rng.integers(3, 5 if few else 7)), int(rng.integers(4, 6 if few else 10))
    thickness = rng.uniform(0.2, 0.4)
    openings = []
    if n_long >= 4 and n_high >= 5 and rng.uniform() < 0.7:
        openings = [{"at": 1.5 * unit[0], "width": unit[0], "height": 2 * unit[1], "sill": unit[1]}]
    size = {"length": n_long * unit[0], "height": n_high * unit[1], "unit": unit}
    weight = rng.uniform(16e3, 22e3)
    law = bonded_law(rng, KINDS[seed % 3], weight * size["height"])
    deep = {"thickness": thickness} if few else {}
    blocks = panel(**size, unit_weight=weight, openings=openings, **deep)
    length, low = size["length"], -0.2
    if few:
        base = ds.Block(
            id="base",
            vertices=np.array(
                [
                    [x, y, z]
                    for x in (-0.3, length + 0.3)
                    for y in (-0.3, thickness + 0.3)
                    for z in (low, 0.0)
                ]
            ),
            unit_weight=weight,
            support=True,
        )
        out = rng.uniform() < 0.5
        direction = (0.0, 1.0, 0.0) if out else (1.0, 0.0, 0.0)
    else:
        ends = [(-0.3, low), (length + 0.3, low), (length + 0.3, 0.0), (-0.3, 0.0)]
        base = ds.Block(id="base", vertices=np.array(ends), unit_weight=weight, support=True)
        direction = (1.0, 0.0)
    return ds.make_model(
        [base, *blocks],
        joint=law,
        load_direction=direction,
        points=9 if few else int(rng.integers(3, 7)),
        analysis=ds.Analysis(options={"max_displacement": 0.05 * size["height"]}),
        **({} if few else {"thickness": thickness}),
    )
