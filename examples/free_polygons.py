"""A model put together in Python from free convex polygons: a battered pier in three stones.

The joints rise towards the toe, so that the stones do not slide on each other and the pier turns
over its toe in one piece.  With the pier's centroid at (x, y) and its toe at (t, 0), moments about
the toe give the multiplier at which a rigid pier with sharp corners begins to turn:

    lambda W y = W (t - x).

Elastic joints give way a little under the toe, so that the peak lies a little below.
"""

import numpy as np

import drystone as ds
from drystone.geometry.plane.polygon import mass_properties

UNIT_WEIGHT = 22e3  # N/m3
THICKNESS = 0.5  # m
OUTLINE = np.array([[0.0, 0.0], [0.7, 0.0], [0.5, 1.5], [0.1, 1.5]])  # m, of the whole pier
STONES = {
    "lower": [[0.0, 0.0], [0.7, 0.0], [0.62, 0.6], [0.03, 0.45]],
    "middle": [[0.03, 0.45], [0.62, 0.6], [0.56, 1.05], [0.06, 0.9]],
    "upper": [[0.06, 0.9], [0.56, 1.05], [0.5, 1.5], [0.1, 1.5]],
}  # m


def rigid_multiplier() -> float:
    """Multiplier at which the rigid pier begins to turn over its toe."""
    x, y = mass_properties(OUTLINE).centroid
    toe = OUTLINE[1, 0]
    return float((toe - x) / y)


def pier(normal_stiffness: float = 1e10) -> ds.Model:
    """The pier on a fixed foot, pushed to the right."""
    foot = ds.Block(
        id="foot",
        vertices=np.array([[-0.5, -0.3], [1.2, -0.3], [1.2, 0.0], [-0.5, 0.0]]),
        unit_weight=UNIT_WEIGHT,
        support=True,
    )
    stones = [
        ds.Block(id=name, vertices=np.array(vertices), unit_weight=UNIT_WEIGHT)
        for name, vertices in STONES.items()
    ]
    return ds.make_model(
        [foot, *stones],
        joint=ds.JointLaw(
            friction_coefficient=0.8,
            normal_stiffness=normal_stiffness,  # Pa/m
            shear_stiffness=normal_stiffness,
        ),
        corner=ds.Corner(),  # sharp
        thickness=THICKNESS,
        load_direction=(1.0, 0.0),
        control_block="upper",
        control_point="top right",
        title="Pier",
    )


def main(engine: str | None = None) -> float:
    """Peak multiplier of the pier."""
    curve = ds.pushover(pier(), engine=engine)
    return curve.peak.load_multiplier


if __name__ == "__main__":
    print(f"rigid pier  {rigid_multiplier():.4f}")
    print(f"peak        {main():.4f}")
