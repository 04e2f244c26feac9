"""Rounded, chamfered and sharp corners: what they do to the peak of a wall.

Taking a corner off moves the contact at the end of a joint inwards, by the radius or the leg of
the chamfer, and shortens every overturning arm by as much.  A rounded and a chamfered corner of
the same size therefore give nearly the same peak, and sharp corners a higher one.
"""

import drystone as ds
from drystone.model.builders import published

SIZE = 0.02  # m
CORNERS = {
    "rounded": ds.Corner(radius=SIZE),
    "chamfered": ds.Corner(chamfer=SIZE),
    "sharp": ds.Corner(),
}


def wall(corner: ds.Corner) -> ds.Model:
    """Wall 1 of the published benchmark with the given corners."""
    courses = published.PUBLISHED_WALLS[1].courses
    blocks = ds.wall(
        unit=published.UNIT,
        courses=courses,
        repeat=3,
        base=True,
        unit_weight=published.UNIT_WEIGHT,
    )
    return ds.make_model(
        blocks,
        joint=published.JOINT,
        corner=corner,
        thickness=published.THICKNESS,
        load_direction=(1.0, 0.0),
    )


def peaks(engine: str | None = None) -> dict[str, float]:
    """Peak multiplier for each kind of corner."""
    return {
        # The peak is reached within 2 cm; the rest of the branch is not needed here.
        name: ds.pushover(wall(corner), engine=engine, max_displacement=0.03).peak.load_multiplier
        for name, corner in CORNERS.items()
    }


if __name__ == "__main__":
    for name, peak in peaks().items():
        print(f"{name:<10} {peak:.4f}")
