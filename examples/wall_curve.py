"""The capacity curve of a wall in Python: read a model, trace its curve, look at the results.

Run it with ``python examples/wall_curve.py``; it writes two pictures to ``out/wall_curve``.
"""

from pathlib import Path

import drystone as ds

WALL = Path(__file__).with_name("wall1.toml")


def wall_curve(engine: str | None = None) -> ds.CapacityCurve:
    """Curve of wall 1; the engine is by default the one that the model file names."""
    model = ds.read_model(WALL)
    return ds.pushover(model, engine=engine)  # keeps poses and contacts


def main() -> None:
    from drystone.report import Mechanism, draw_curve, draw_mechanism

    model = ds.read_model(WALL)
    curve = wall_curve()
    peak = curve.peak
    print(f"{model.title}: {curve.status}, {curve.reason}")
    print(f"peak multiplier {peak.load_multiplier:.4f} at {peak.control_displacement:.4f} m")
    print(f"ultimate displacement {curve.ultimate_displacement:.3f} m")
    print(f"largest residual {curve.residual.max():.1e} of the heaviest block's weight")

    folder = Path("out/wall_curve")
    folder.mkdir(parents=True, exist_ok=True)
    draw_curve(curve, folder / "curve.png", title=model.title)
    row = curve.nearest(0.2)
    mechanism = Mechanism(
        assembly=model.assembly,
        pose=curve.poses[row],
        contacts=curve.contacts[row],
        load_direction=model.load_along,
        control_point=model.control_point,
    )
    title = f"{model.title} at {curve.points[row].control_displacement:.3f} m"
    draw_mechanism(mechanism, folder / "mechanism.png", title=title)


if __name__ == "__main__":
    main()
