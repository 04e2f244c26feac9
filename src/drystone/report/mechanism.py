"""What a picture of a mechanism shows, in either dimension: states, what moves, what has left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.contact.forces import ContactForces
from drystone.geometry.motion import moved_points
from drystone.monitor import ControlPoint
from drystone.report.shapes import MovingShapes, moving_blocks
from drystone.ties import Tie

Array = NDArray[np.float64]

RESTING, MOVING, SUPPORT = "#f3f1ec", "#d9b676", "#c9c9c9"
OPEN_JOINT, SLID_JOINT = "#c8102e", "#00558c"
#: A joint has opened or slid when it did by this share of the largest displacement.
VISIBLE = 0.02
#: Displacements below this share of the structure's size are those of settling: not magnified.
NOTHING = 1e-5
#: The picture reaches this share of the structure's size beyond its designed outline, no further.
MARGIN = 0.6


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """What one picture shows."""

    assembly: Assembly
    pose: Array  # (n, n_pose), where the blocks are
    settled: Array | None = None  # (n, n_pose), where the load began; None: as designed
    gone: NDArray[np.bool_] | None = None  # (n,) blocks that have left: designed outlines, dashed
    contacts: ContactForces | None = None  # of that state: those under load are drawn
    load_direction: Array | None = None  # (dim,) unit vector, of the load's arrow
    control_point: ControlPoint | None = None  # marked where it is now
    magnification: float = 1.0  # of the displacements since settled; without contacts if not 1
    ties: tuple[Tie, ...] = ()
    tie_branch: NDArray[np.int64] | None = None  # (n_ties,) what they do, see `ties.STATES`
    linear: bool = False  # the pose is a velocity field (n, n_dof), see `motion.moved_points`


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawn:
    """A mechanism as it is drawn: magnified, and with blocks told apart."""

    shapes: MovingShapes
    pose: Array  # (n, n_pose), or (n, n_dof) of a velocity field
    settled: Array  # likewise
    moving: NDArray[np.bool_]  # (n,)
    gone: NDArray[np.bool_]  # (n,)
    visible: float  # m, from which on a joint counts as open or slid

    @classmethod
    def of(cls, mechanism: Mechanism) -> Drawn:
        """What there is to draw of it."""
        assembly, settled, gone = mechanism.assembly, mechanism.settled, mechanism.gone
        shapes = MovingShapes.of(assembly, linear=mechanism.linear)
        if settled is None:
            settled = assembly.no_motion() if mechanism.linear else assembly.rest_pose()
        if gone is None:
            gone = np.zeros(assembly.n_bodies, np.bool_)
        present = np.where(gone[:, None], settled, mechanism.pose)
        if mechanism.linear:
            pose = settled + (present - settled) * mechanism.magnification
        else:
            increment = assembly.difference(present, settled) * mechanism.magnification
            pose = assembly.moved(settled, increment)
        displacement = shapes.displacement(pose, settled)
        return cls(
            shapes=shapes,
            pose=pose,
            settled=settled,
            moving=moving_blocks(displacement, assembly.fixed),
            gone=gone,
            visible=VISIBLE * float(displacement.max(initial=0.0)),
        )

    def path_of(self, control_point: ControlPoint) -> Array:
        """Where the control point was as designed, and where it is, (2, dim) [m]."""
        start, shapes = np.asarray(control_point.point), self.shapes
        block = np.array([control_point.block])
        (end,) = moved_points(start[None], block, shapes.centroid, self.pose, linear=shapes.linear)
        return np.array([start, end])

    def tie_lines(self, assembly: Assembly, ties: Sequence[Tie]) -> Array:
        """Both ends of every tie where they are, (n_ties, 2, dim) [m]."""
        ends = [(end.row(assembly), end) for tie in ties for end in (tie.start, tie.end)]
        points = np.array([end.point for _, end in ends], float)
        owner, shapes = np.array([row for row, _ in ends]), self.shapes
        moved = moved_points(points, owner, shapes.centroid, self.pose, linear=shapes.linear)
        return moved.reshape(len(ties), 2, -1)


def readable_magnification(assembly: Assembly, pose: Array, settled: Array | None = None) -> float:
    """1, or a round factor where the displacements are too small to be seen in a picture."""
    shapes = MovingShapes.of(assembly)
    displacement = shapes.displacement(pose, settled)
    share = float(displacement.max()) / shapes.size()
    if share < NOTHING or share >= 0.02:
        return 1.0
    wanted = 0.05 / share
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted))
