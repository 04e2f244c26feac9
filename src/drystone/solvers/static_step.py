"""The equations of one step of static equilibrium, on arrays that are made once per pair list.

    R(x, l) = G + l F + sum over contacts (r_n grad g + r_t grad s) - M x / h^2 = 0

with gaps and gradients in the places at the end of the step; see `kernels.joint` for the reactions
and their tangent, `kernels.path` for how the linear equations are solved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drystone.contact.detection import Detector, Pairs, empty_slots
from drystone.contact.forces import OPEN, SLIDING, STICKING
from drystone.kernels import block_lu, joint, narrow, path, step
from drystone.kernels.joint import N_HISTORY, N_TABLE, Tangent
from drystone.kernels.narrow import Slots

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Changes of contacts that are followed with one factorisation.
CHANGES_PER_MATRIX = 32

#: Smallest pivot of a block, over its largest entry, with which a direction is worth trying.
SINGULAR = 1e-13

#: Changes of a step at which its multiplier is kept.
BENDS = 512

#: What the branches of the joint law are called in results.
STATUS_OF = np.array([OPEN, STICKING, SLIDING, SLIDING, STICKING])


class Pace(Protocol):
    """The displacement c(x) that paces a step."""

    @property
    def body(self) -> int:
        """The one that a spring holds where the matrix may be singular."""
        ...

    def measure(self, x: Array) -> tuple[float, Array]:
        """What is missing of the increment [m], and the gradient of c, (n, n_dof)."""
        ...


@dataclass(frozen=True, kw_only=True)
class PointPace:
    """The displacement of a point of one body."""

    body: int
    arm: Array  # (dim,) m from the centroid to the point, where the step starts
    axis: Array  # (dim,) direction the displacement is read in
    increment: float  # m

    def measure(self, x: Array) -> tuple[float, Array]:
        """See `Pace.measure`."""
        ux, uy, w = x[self.body]
        (ax, ay), (dx, dy) = self.arm, self.axis
        s, versine = np.sin(w), 2.0 * np.sin(0.5 * w) ** 2
        turned_x, turned_y = ax * (1.0 - versine) - s * ay, ay * (1.0 - versine) + s * ax
        moved = dx * (ux + turned_x - ax) + dy * (uy + turned_y - ay)
        gradient = np.zeros_like(x)
        gradient[self.body] = dx, dy, dy * turned_x - dx * turned_y
        return self.increment - moved, gradient


@dataclass(frozen=True, kw_only=True)
class Constants:
    """What stays the same over an analysis; arrays are (n, n_dof) over all bodies."""

    detector: Detector
    laws: Array  # (n_laws, N_LAW)
    thickness: float  # m
    dead: Array  # N, N m
    pattern: Array  # N, N m, at multiplier one
    mass: Array  # kg, kg m2; zero on fixed bodies
    extent: Array  # (n,) m, by which moments are divided
    fixed: BoolArray  # (n,)


class StaticStep:
    """Evaluates and linearises the equations of steps over one list of pairs."""

    def __init__(self, constants: Constants, pairs: Pairs) -> None:
        n, n_dof = constants.mass.shape
        n_pairs = len(pairs.a)
        n_slots = 2 * n_pairs
        self.constants, self.pairs = constants, pairs
        self.slots = empty_slots(n_pairs)  # contacts in the present places
        self.known = empty_slots(n_pairs)  # contacts by the features that the step follows
        self.found = empty_slots(n_pairs)  # contacts as they are found where the step ends
        self.source = np.arange(n_slots)
        self.force = np.zeros((n, n_dof))  # unbalanced
        self.contact_force = np.zeros((n, n_dof))
        self.damping = np.zeros(n)
        self.reaction = np.zeros((n_slots, 2))
        self.branch = np.zeros(n_slots, np.int64)
        self.memory = np.zeros((n_slots, N_HISTORY))
        self.state = np.zeros((n_slots, N_HISTORY))
        self.start_slip = np.zeros((n_slots, 2 * n_dof))
        self.start_length = np.zeros(n_slots)
        self.closed = np.zeros(n_slots, np.bool_)
        self.table = np.zeros((n_slots, N_TABLE))
        self.response = np.zeros((n_slots, joint.N_RESPONSE))
        self.used = np.zeros(n_slots, np.int64)
        self.count = 0
        self.tangent = Tangent(
            diagonal=np.zeros((n, n_dof, n_dof)),
            upper=np.zeros((n_pairs, n_dof, n_dof)),
            lower=np.zeros((n_pairs, n_dof, n_dof)),
        )
        place = constants.detector.bodies.centroid + pairs.pose[:, :-1]
        self.structure = block_lu.analyse(pairs.a, pairs.b, constants.fixed, place, n_dof)
        self.factors = block_lu.allocate(self.structure)
        self.frame = path.Frame(
            load=constants.pattern,
            pace=np.zeros((n, n_dof)),
            axis=np.zeros((n, n_dof)),
            columns=np.zeros((3, n, n_dof)),
            changes=np.zeros((CHANGES_PER_MATRIX, n, n_dof)),
            change_of_multiplier=np.zeros(CHANGES_PER_MATRIX),
            row=np.zeros((CHANGES_PER_MATRIX, 2 * n_dof)),
            bodies=np.zeros((CHANGES_PER_MATRIX, 2), np.int64),
            pivot=np.zeros(CHANGES_PER_MATRIX),
            rate=np.zeros((n_slots, 2)),
            turn=np.full(2, np.nan),
            sense=np.ones(1),
            border=np.ones(1),
            sign=np.ones(1),
            bends=np.zeros((BENDS, 2)),
        )

    def begin(
        self,
        pose: Array,
        slots: Slots,
        history: Array,
        branch: IntArray,
        h: float,
        guess: Array,
    ) -> None:
        """Start a step of size ``h`` [s] from rest in ``pose``, with its contacts and their past.

        Slips are linear in the increments, by their gradients half way to the ``guess`` of these:
        of second order in the step, without straining the stiff shear springs of blocks that
        are held at several points and turn together.
        """
        self.pose = pose
        self.weight = 1.0 / h**2
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs
        self.memory[:] = history
        self.closed[:] = branch != OPEN
        self.start_length[:] = np.where(slots.kind != narrow.NONE, slots.length, 0.0)
        half = self.slots
        self.constants.detector.follow(self.pairs, pose + 0.5 * guess, self.known, half)
        joint.slip_gradients(half, self.start_slip)

    def follow(self, slots: Slots) -> None:
        """Go on with the features of these contacts; each brings along what its forerunner had."""
        known, source = self.known, self.source
        narrow.carry_history(known.kind, known.feature, known.edges, slots, source)
        new = source < 0
        for array in (self.memory, self.closed, self.start_length, self.start_slip, self.branch):
            array[:] = array[source]
            array[new] = 0
        self.memory[new, joint.BROKEN] = 1.0  # blocks that come to touch later are not bonded
        for mine, theirs in zip(known, slots, strict=True):
            mine[:] = theirs

    def evaluate(self, x: Array, multiplier: float) -> None:
        """Reactions, unbalanced forces and ``residual`` [N] at the increments ``x`` (n, n_dof)."""
        c, pairs = self.constants, self.pairs
        c.detector.follow(pairs, self.pose + x, self.known, self.slots)
        self.count = joint.joint_forces(
            self.slots, pairs.a, pairs.b, pairs.law, c.laws, c.thickness, self.start_length,
            self.start_slip, self.closed, self.memory, x, self.contact_force, self.table, self.used,
            self.branch, self.reaction, self.state,
        )  # fmt: skip
        self.residual = self._unbalance(x, multiplier)

    def _unbalance(self, x: Array, multiplier: float) -> float:
        c = self.constants
        return step.unbalance(
            self.contact_force, c.dead, c.pattern, multiplier, c.mass, x, self.weight, c.extent,
            c.fixed, self.force,
        )  # fmt: skip

    def move_trial(self, motion: Array) -> None:
        """Trial reactions where the blocks have moved on by ``motion`` (n, n_dof)."""
        joint.move_trial(self.table, self.count, self.used, self.pairs.a, self.pairs.b, motion)

    def linearise(
        self, x: Array, multiplier: float, away: Array, pace: Pace | None, gradient: Array
    ) -> bool:
        """Factorise the tangent at the places and branches last evaluated; False if singular.

        The unbalanced forces, and the ``residual``, are made those at ``x``, which is ``away`` (n,
        n_dof) from there.
        """
        joint.respond(self.table, self.count, self.used, self.branch, self.response)
        self.assemble(x, multiplier, away)
        self.damping[:] = 0.0
        return self.factorise(pace, gradient, 0.0)

    def assemble(self, x: Array, multiplier: float, away: Array) -> None:
        """Unbalanced forces, ``residual`` and tangent of the contacts' ``response``."""
        joint.assemble(
            self.slots, self.table, self.count, self.used, self.pairs.a, self.pairs.b,
            self.response, self.reaction, away, self.contact_force, self.tangent,
        )  # fmt: skip
        self.residual = self._unbalance(x, multiplier)

    def factorise(self, pace: Pace | None, gradient: Array, least_damping: float) -> bool:
        """Factorise the tangent, with inertia and what paces the step; False if singular.

        ``damping`` (n,) [1/s2] times the mass is added to the inertia, of the matrix alone.  Where
        ``least_damping`` is positive, it is raised by no less for blocks that nothing would hold.
        """
        c, frame = self.constants, self.frame
        frame.axis[:] = 0.0
        body = -1
        frame.border[0] = -1.0
        if pace is not None:
            body = pace.body
            frame.pace[:] = gradient
            frame.axis[body] = gradient[body]
        self.spring = step.stiffen(
            self.tangent.diagonal, c.mass, self.weight, self.damping, body, frame.axis
        )
        pivot = block_lu.factorise(
            self.structure, *self.tangent, self.factors, c.mass, self.damping, least_damping
        )
        frame.sign[0] = np.sign(pivot)
        return abs(pivot) > SINGULAR

    def advance(
        self,
        x: Array,
        multiplier: float,
        lag: float,
        left: float,
        changes: int,
        *,
        paced: bool,
        whole: bool,
        patience: int,
        worth: int,
        leap: bool,
    ) -> tuple[int, float, float, int]:
        """Follow the path from ``x``, which moves on in place; see `kernels.path.follow_path`."""
        return path.follow_path(
            self.structure, self.factors, self.frame, paced, whole, self.table, self.count,
            self.used, self.pairs.a, self.pairs.b, self.branch, self.force, lag,
            self.spring, x, multiplier, left, changes, patience, worth, leap,
        )  # fmt: skip

    @property
    def stable(self) -> bool:
        """Whether the structure would keep the equilibrium that the tangent was made for.

        Known once a direction has been solved for.  A determinant tells: with an even number of
        unstable modes it says yes as well.
        """
        return bool(self.frame.sign[0] * self.frame.border[0] < 0.0)

    def bends(self, changes: int) -> Array:
        """Share of the step and multiplier at the changes of the path followed last, (n, 2)."""
        return self.frame.bends[: min(changes, BENDS)]

    def remember(self) -> None:
        """Make sliding that has ended on the path part of the step's history."""
        joint.remember(self.table, self.count, self.used, self.branch, self.memory)

    def status(self) -> IntArray:
        """Status of every slot, (n_slots,)."""
        return STATUS_OF[self.branch]

    def find(self, x: Array) -> None:
        """Find the contacts anew where the blocks are now, into ``found``."""
        self.constants.detector.fill(self.pairs, self.pose + x, self.found)
