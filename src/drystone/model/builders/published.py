"""The three walls of the benchmark, and what has been published about them.

Dry-joint panels of Baggio & Trovalusci (1998) and Ferris & Tin-Loi (2001), with the corners and
stiffnesses of Bouckaert, Godio & de Almeida (2022): *A strategy for generating pushover curves of
block assemblies including post-peak branch using the discrete element method*, 3rd European
Conference on Earthquake Engineering and Seismology, Bucharest.
"""

from __future__ import annotations

from dataclasses import dataclass

from drystone.model.assembly import Corner
from drystone.model.builders.wall import coursed_wall
from drystone.model.construction.model import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model

UNIT = (0.4, 0.175)  # m, length and height of a whole unit
THICKNESS = 1.0  # m
UNIT_WEIGHT = 10e3  # N/m3
CORNER_RADIUS = 0.02  # m
JOINT = JointLaw(
    friction_coefficient=0.65,
    normal_stiffness=1e8,  # Pa/m
    shear_stiffness=1e11,  # Pa/m
    dilatancy_angle=0.0,
)


@dataclass(frozen=True, kw_only=True)
class PublishedWall:
    """One wall: how it is laid and the results of others."""

    courses: tuple[str, ...]  # bottom to top, see `coursed_wall`
    repeat: int
    n_blocks: int
    n_joints: int
    associative_multiplier: float
    """Collapse multiplier with associative flow and sharp corners, by the linear program of
    Ferris & Tin-Loi (2001)."""
    peak_gilbert: float
    """Collapse multiplier of non-associative limit analysis, Gilbert et al. (2006)."""
    peak_lmgc90: float
    """Peak multiplier with LMGC90, Bouckaert et al. (2022), Table 1."""
    peak_udec: float
    """Peak multiplier with UDEC, Bouckaert et al. (2022), Table 1."""
    ultimate_displacement_lmgc90: float
    """Control displacement [m] at the multiplier 0.01 with LMGC90, as above."""


PUBLISHED_WALLS = {
    1: PublishedWall(
        courses=("h1111h", "11111"),
        repeat=3,
        n_blocks=33,
        n_joints=83,
        associative_multiplier=0.64286,
        peak_gilbert=0.643,
        peak_lmgc90=0.579,
        peak_udec=0.574,
        ultimate_displacement_lmgc90=0.449,
    ),
    2: PublishedWall(
        courses=("h1111h", "11111"),
        repeat=5,
        n_blocks=55,
        n_joints=141,
        associative_multiplier=0.58000,
        peak_gilbert=0.564,
        peak_lmgc90=0.512,
        peak_udec=0.497,
        ultimate_displacement_lmgc90=0.556,
    ),
    3: PublishedWall(
        courses=(
            *("1111", "h111h", "1111"),
            *("h1.1h", "1h.h1", "h1.1h", "1h.h1", "h1.1h"),
            *("1111", "h111h", "1111"),
        ),
        repeat=1,
        n_blocks=46,
        n_joints=102,
        associative_multiplier=0.40369,
        peak_gilbert=0.356,
        peak_lmgc90=0.331,
        peak_udec=0.323,
        ultimate_displacement_lmgc90=0.591,
    ),
}


def published_wall(number: int, *, analysis: Analysis | None = None) -> Model:
    """Model of wall 1, 2 or 3 as Bouckaert et al. (2022) analysed it.

    The load acts to the right in proportion to weight. The control displacement is the horizontal
    displacement of the upper right corner of the upper right block.

    Raises
    ------
    ValueError
        There is no wall of that number.
    """
    if number not in PUBLISHED_WALLS:
        raise ValueError(f"there is no wall {number}: the published ones are 1, 2 and 3")
    wall = PUBLISHED_WALLS[number]
    blocks = coursed_wall(
        unit=UNIT,
        courses=wall.courses,
        repeat=wall.repeat,
        base=True,
        unit_weight=UNIT_WEIGHT,
        material="stone",
    )
    return make_model(
        blocks,
        joint=JOINT,
        corner=Corner(radius=CORNER_RADIUS),
        thickness=THICKNESS,
        load_direction=(1.0, 0.0),
        analysis=analysis,
        title=f"Wall {number} of Bouckaert, Godio & de Almeida (2022)",
    )
