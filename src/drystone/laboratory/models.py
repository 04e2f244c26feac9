"""Models of walls that were tested: courses, a beam on top, the jack's force, the push."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.laboratory.walls import Wall, series
from drystone.model.assembly import Block
from drystone.model.builders.stones import rectangle
from drystone.model.builders.wall import coursed_wall
from drystone.model.construction.model import make_model
from drystone.model.history import history_of
from drystone.model.joint_law import JointLaw
from drystone.model.loading import DeadLoad, ForceLoad, ForcesPattern, PointForce
from drystone.model.model import Analysis, Model

#: The horizontal force at multiplier one [N]: multipliers are then forces in kN.
UNIT_FORCE = 1e3
BEAM = "beam"

#: Shear over normal stiffness of joints: 1 / (2 (1 + nu)) of an isotropic layer with nu = 0.2.  The
#: reports are silent: a wall is also computed with a fifth of it, and with both equal.
SHEAR_SHARE = 1.0 / 2.4
SHEAR_SHARES = (0.2 * SHEAR_SHARE, 1.0)

#: Contact points of a joint: the fewest of 2, 4, 8, ... with which peaks, and forces at 1, 2 and
#: 3 % drift, of all walls that were pushed one way are within `CONVERGED` of those with twice as
#: many.  With 4 they are up to 3.9 % off, with 8 up to 0.7 %.  No measured value is part of this.
POINTS = 8
CONVERGED = 0.01


# Long by its arguments, each with its words.
def model_of(
    wall: Wall,
    *,
    friction: float | None = None,
    shear_share: float = SHEAR_SHARE,
    history: Sequence[float] | None = None,
    farthest: float | None = None,
    points: int = POINTS,
    level: bool = False,
) -> Model:
    """The model of a wall.

    Units are rigid, in running bond on a fixed base; joints have the stiffness that the wall's
    modulus says.  A beam of the units' weight lies on them, to twice the height of the load above
    the wall, as heavy as they are.  The jack's force stays vertical and goes with the middle of the
    beam's top.

    Parameters
    ----------
    friction
        In place of the series' own.
    shear_share
        Shear over normal stiffness of joints.
    history
        Control displacements [m] to reach one after another.
    farthest
        Control displacement [m] where a curve that goes one way ends.
    points
        Contact points of a joint, each of which crushes at the strength of masonry.
    level
        Whether the beam is kept from turning, and goes up and down freely.
    """
    said = series()["series"][wall.series]
    n = round(wall.height / wall.unit_height)
    courses = [said["courses"][k % 2] for k in range(n)]
    blocks = coursed_wall(
        unit=(wall.unit_length, wall.unit_height),
        courses=courses,
        base=True,
        unit_weight=wall.unit_weight,
        material="stone",
    )
    top = 2.0 * wall.load_height - wall.height
    blocks.append(
        Block(
            id=BEAM,
            vertices=rectangle(0.0, wall.height, wall.length, top),
            unit_weight=wall.unit_weight,
            material="stone",
            held=("turn",) if level else (),
        )
    )
    middle = np.array([0.5 * wall.length, top])
    at_load = np.array([0.5 * wall.length, wall.load_height])
    jack: DeadLoad = ForceLoad(  # type: ignore[assignment]  # frozen, and never set
        name="jack",
        mass=False,
        block=BEAM,
        point=middle,
        force=np.array([0.0, -wall.vertical_force]),
    )
    stiffness = wall.joint_stiffness
    options = {} if farthest is None or history is not None else {"max_displacement": farthest}
    return make_model(
        blocks,
        joint=JointLaw(
            friction_coefficient=said["friction"] if friction is None else friction,
            normal_stiffness=stiffness,
            shear_stiffness=shear_share * stiffness,
            compressive_strength=wall.strength,
        ),
        thickness=wall.thickness,
        points=points,
        load=ForcesPattern(
            entries=(PointForce(block=BEAM, point=at_load, force=np.array([UNIT_FORCE, 0.0])),)
        ),
        dead_loads=[jack],
        control_block=BEAM,
        control_point=at_load.tolist(),
        history=history_of(history, None, 1),
        analysis=Analysis(options=options),
        title=f"{wall.name}, {wall.reference}",
    )
