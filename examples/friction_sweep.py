"""One model with several friction coefficients, and a curve for each.

A wall of high friction rocks.  A wall of low friction slides, and its peak lies at or below its
friction coefficient, because nothing on a horizontal joint carries more than that.
"""

from pathlib import Path

import drystone as ds

WALL = Path(__file__).with_name("wall1.toml")
FRICTION = (0.2, 0.3, 0.4, 0.5, 0.65, 0.8)


def sweep(engine: str | None = None) -> dict[float, ds.CapacityCurve]:
    """The curve of the wall for each friction coefficient, up to a displacement of 3 cm."""
    model = ds.read_model(WALL).with_analysis(max_displacement=0.03)
    return {
        friction: ds.pushover(model.with_joint(friction_coefficient=friction), engine=engine)
        for friction in FRICTION
    }


if __name__ == "__main__":
    for friction, curve in sweep().items():
        print(f"friction {friction:<5} peak {curve.peak.load_multiplier:.4f}")
