"""What a picture of a mechanism shows, in either dimension: states, what moves, what has left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.contact.forces import ContactForces
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.motion import moved_points
from drystone.model.assembly import Assembly
from drystone.model.loading import DeadLoad
from drystone.model.monitor import ControlPoint
from drystone.model.ties import Tie
from drystone.report.load_arrows import dead_arrows
from drystone.results.shapes import LEAST, MovingShapes, compliance, moving_blocks

RESTING, MOVING, SUPPORT = "#f3f1ec", "#d9b676", "#c9c9c9"
OPEN_JOINT, SLID_JOINT = "#c8102e", "#00558c"
#: Of rigid bodies, Okabe and Ito's, told apart by colour-blind readers.
BODIES = ("#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
#: A joint has opened or slid when it did by this share of the largest displacement, or by more than
#: what counts as rest.
VISIBLE = 0.02
#: The picture holds all that is drawn where it was designed, and what has moved beyond that by up
#: to this share of the structure's size.  Around it there is a rim, over the same.
MARGIN, RIM = 0.6, 0.04


class Followed(Protocol):
    """Designed joints that are followed as their blocks move, in either dimension."""

    @property
    def designed(self) -> Interfaces:
        """As designed."""
        ...

    def opening_and_slip(self, pose: Array, since: Array | None = None) -> tuple[Array, Array]:
        """Largest opening and slip of each since the poses ``since``, (k,) each [m]."""
        ...


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """What one picture shows."""

    assembly: Assembly
    pose: Array  # (n, n_pose), where the blocks are
    initial: Array | None = None  # (n, n_pose), where the load began; None: as designed
    # (n,) blocks that have left: designed outlines, dashed
    departed: BoolArray | None = None
    contacts: ContactForces | None = None  # of that state: those under load are drawn
    load_direction: Array | None = None  # (dim,) unit vector, of the load's arrow
    control_point: ControlPoint | None = None  # marked where it is now
    magnification: float = 1.0  # of the displacements since then; without contacts if not 1
    ties: tuple[Tie, ...] = ()
    tie_branch: IntArray | None = None  # (n_ties,) what they do, see `ties.STATES`
    dead_loads: tuple[DeadLoad, ...] = ()  # drawn as arrows
    linear: bool = False  # the pose is a velocity field (n, n_dof), see `motion.moved_points`
    #: (n,) the rigid body that each block is of, negative at rest: they give the colours, in place
    #: of what moves.
    bodies: IntArray | None = None

    def colours(self, drawn: Drawn) -> list[str]:
        """Of all blocks, (n,)."""
        if self.bodies is None:
            by_block = [MOVING if moving else RESTING for moving in drawn.moving]
        else:
            by_block = [RESTING if k < 0 else BODIES[k % len(BODIES)] for k in self.bodies.tolist()]
        fixed = self.assembly.fixed.tolist()
        return [SUPPORT if held else own for held, own in zip(fixed, by_block, strict=True)]


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawn:
    """A mechanism as it is drawn: magnified, and with blocks told apart."""

    shapes: MovingShapes
    pose: Array  # (n, n_pose), or (n, n_dof) of a velocity field
    initial: Array  # likewise
    moving: BoolArray  # (n,)
    departed: BoolArray  # (n,)
    visible: float  # m, from which on a joint counts as open or slid
    ties: Array  # (n_ties, 2, dim) m, both ends of each
    loads: Array  # (m, 2, dim) m, tails and tips of the arrows of dead loads
    designed: Array  # (k, dim) m, vertices and ends of ties as designed

    @classmethod
    def of(cls, mechanism: Mechanism) -> Drawn:
        """What there is to draw of it."""
        assembly, initial, departed = mechanism.assembly, mechanism.initial, mechanism.departed
        shapes = MovingShapes.of(assembly, linear=mechanism.linear)
        if initial is None:
            initial = assembly.no_motion() if mechanism.linear else assembly.design_pose()
        if departed is None:
            departed = np.zeros(assembly.n_bodies, np.bool_)
        present = np.where(departed[:, None], initial, mechanism.pose)
        if mechanism.linear:
            pose = initial + (present - initial) * mechanism.magnification
        else:
            increment = assembly.difference(present, initial) * mechanism.magnification
            pose = assembly.moved(initial, increment)
        displacement = shapes.displacement(pose, initial)
        compliant = compliance(shapes, mechanism.initial, assembly.fixed)
        compliant *= mechanism.magnification
        ties, linear = mechanism.ties, shapes.linear
        ends = np.array([[end.point for end in (t.start, t.end)] for t in ties], float)
        ends = ends.reshape(-1, assembly.dimension)
        both = [end for t in ties for end in (t.start, t.end)]
        owner = np.array([end.row(assembly) for end in both], np.int64)
        moved = moved_points(ends, owner, shapes.centroid, pose, linear=linear)
        on_ground = np.array([end.block is None for end in both], np.bool_)
        moved[on_ground] = ends[on_ground]
        loads = mechanism.dead_loads
        _, arrows = dead_arrows(assembly, loads, pose, present=~departed, linear=linear)
        return cls(
            shapes=shapes,
            pose=pose,
            initial=initial,
            moving=moving_blocks(displacement, assembly.fixed, compliant),
            departed=departed,
            visible=min(VISIBLE * float(displacement.max(initial=0.0)), compliant),
            ties=moved.reshape(len(ties), 2, assembly.dimension),
            loads=arrows,
            designed=np.vstack((shapes.vertices, ends)),
        )

    def changed(self, joints: Followed) -> tuple[BoolArray, BoolArray]:
        """Which joints have opened, and which of the others have slid, (k,) each; none of blocks
        that have left."""
        opening, slip = joints.opening_and_slip(self.pose, self.initial)
        there = ~(self.departed[joints.designed.block_a] | self.departed[joints.designed.block_b])
        opened = there & (opening > self.visible)
        return opened, there & (slip > self.visible) & ~opened

    def path_of(self, control_point: ControlPoint) -> Array:
        """Where the control point was as designed, and where it is, (2, dim) [m]."""
        start, shapes = np.asarray(control_point.point), self.shapes
        block = np.array([control_point.block])
        (end,) = moved_points(start[None], block, shapes.centroid, self.pose, linear=shapes.linear)
        return np.array([start, end])

    def extent(self, seen: Callable[[Array], Array] = np.asarray) -> tuple[Array, Array]:
        """Lower left and upper right corner of the picture, (2,) each [m].

        All that is drawn is in it: blocks and supports, ties to both ends, arrows of loads.  What
        has moved away from the structure by more than `MARGIN` is not.  ``seen`` takes places (k,
        dim) to the picture.
        """
        shapes = self.shapes
        designed = seen(self.designed)[:, :2]
        dim = self.designed.shape[1]
        moved = [shapes.moved(self.pose), self.ties.reshape(-1, dim), self.loads.reshape(-1, dim)]
        now = seen(np.vstack(moved))[:, :2]
        lower, upper = designed.min(axis=0), designed.max(axis=0)
        outline = designed[: len(shapes.vertices)]
        size = float(np.ptp(outline, axis=0).max())
        low = np.maximum(np.minimum(lower, now.min(axis=0)), lower - MARGIN * size)
        high = np.minimum(np.maximum(upper, now.max(axis=0)), upper + MARGIN * size)
        return low - RIM * size, high + RIM * size


def readable_magnification(assembly: Assembly, pose: Array, initial: Array | None = None) -> float:
    """1, or a round factor where the displacements are too small to be seen in a picture."""
    shapes = MovingShapes.of(assembly)
    displacement = shapes.displacement(pose, initial)
    share = float(displacement.max()) / shapes.size()
    if share < LEAST or share >= 0.02:
        return 1.0
    wanted = 0.05 / share
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted))
