"""The equations of a step with the gradients of gaps and slips held fast, and their factors.

    R(x, l) = G + l F + sum over contacts (r_n grad g + r_t grad s) - M x / h^2 = 0

linear but for the joint law, of which a response is given for every contact; see `law.return_map`
for the tangent, `statics.plane.path` for what borders it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    FIRST,
    PAIR,
    SLOT,
    A,
    B,
    Contacts,
    Pairs,
    Slots,
)
from drystone.geometry import motion
from drystone.law import plane as plane_law
from drystone.law.columns import N_RESPONSE
from drystone.model.loading import Acting
from drystone.statics import step
from drystone.statics.linear import numeric as lu_numeric
from drystone.statics.linear import symbolic as lu_symbolic
from drystone.statics.plane import forces, path
from drystone.statics.plane.forces import Tangent
from drystone.statics.tie_forces import JoinedTies, TieForces

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Changes of contacts that are followed with one factorisation.
CHANGES_PER_MATRIX = 32

#: Smallest pivot of a block, over its largest entry, with which a direction is worth trying.
SINGULAR = 1e-13

#: Changes of a step at which its multiplier is kept.
BENDS = 512


class Pace(Protocol):
    """The displacement c(x) that paces a step."""

    @property
    def body(self) -> int:
        """The one that a spring holds where the matrix may be singular."""
        ...

    def missing(self, x: Array) -> float:
        """What is missing of the increment [m]."""
        ...

    def gradient(self, x: Array) -> Array:
        """The gradient of c, (n, n_dof)."""
        ...


@dataclass(frozen=True, kw_only=True)
class PointPace:
    """The displacement of a point of one body."""

    body: int
    arm: Array  # (dim,) m from the centroid to the point, where the step starts
    axis: Array  # (dim,) direction the displacement is read in
    axes: Array  # (dim, dim) the body's principal axes there, in columns; of space only
    increment: float  # m

    def missing(self, x: Array) -> float:
        """See `Pace.missing`."""
        return self.increment - motion.advance(self.arm, x[self.body], self.axis, self.axes)

    def gradient(self, x: Array) -> Array:
        """See `Pace.gradient`."""
        gradient = np.zeros(x.shape)
        at = self.arm, x[self.body], self.axis, self.axes
        gradient[self.body] = motion.gradient_of_advance(*at)
        return gradient


@dataclass(frozen=True, kw_only=True)
class Loads:
    """What acts on the bodies of an analysis besides contacts; arrays are (n, n_dof)."""

    dead: Array  # N, N m
    pattern: Array  # N, N m, at multiplier one
    mass: Array  # kg, kg m2; zero on fixed bodies
    extent: Array  # (n,) m, by which moments are divided
    fixed: BoolArray  # (n,)
    acting: Acting | None = None  # what they are near a place and a multiplier; None: the same
    ties: TieForces | None = None

    def near(self, pose: Array, multiplier: float) -> tuple[Array, Array]:
        """Dead load and pattern in a pose (n, n_pose), near a multiplier; see `Acting.near`."""
        return self.acting.near(pose, multiplier) if self.acting else (self.dead, self.pattern)

    def of(self, bodies: IntArray, fixed: BoolArray) -> Loads:
        """Those of some bodies, (m,), of which more are ``fixed`` (m,)."""
        return Loads(
            dead=self.dead[bodies],
            pattern=self.pattern[bodies],
            mass=np.where(fixed[:, None], 0.0, self.mass[bodies]),
            extent=self.extent[bodies],
            fixed=fixed,
        )


class LinearStep:
    """Assembles and factorises the equations of the contacts in its table.

    Parameters
    ----------
    loads
        Of all bodies.
    pairs
        Candidate pairs.
    place
        (n, dim) m, where the bodies are, for the order of elimination.
    slots
        Contacts where the table is made.
    tied
        Bodies (n_ties, 2) that ties join; by default those of the loads' ties.
    """

    def __init__(
        self,
        loads: Loads,
        pairs: Pairs,
        place: Array,
        slots: Slots,
        tied: IntArray | None = None,
    ) -> None:
        n, n_dof = loads.mass.shape
        dim = place.shape[1]
        n_pairs, n_slots = pairs.n_pairs, pairs.n_slots
        self.loads, self.pairs, self.place, self.slots = loads, pairs, place, slots
        self.dead, self.pattern = loads.dead, loads.pattern  # near where it was evaluated last
        self.turning: Array | None = None  # (n,) N m, by which moments of loads fall there
        if loads.acting:
            self.dead, self.pattern, self.turning = (
                loads.dead.copy(),
                loads.pattern.copy(),
                np.zeros(n),
            )
        self.given = np.zeros((n, n_dof))  # increments of supports that move
        self.inertia_factor = 0.0  # 1/h^2 [1/s2], times the mass
        self.force = np.zeros((n, n_dof))  # unbalanced
        self.contact_force = np.zeros((n, n_dof))
        self.damping = np.zeros(n)
        self.reaction = np.zeros((n_slots, dim))
        self.branch = np.zeros(n_slots, np.int64)
        self.contacts, self.count = Contacts.empty(n_slots, dim, n_dof), 0
        self.response = np.zeros((n_slots, N_RESPONSE))
        self.geometric = Tangent.zeros(n, n_pairs, n_dof)
        self.bent = False  # whether the geometric stiffness is that of the slots
        if tied is None and loads.ties:
            tied = loads.ties.body
        #: Of ties: where their blocks lie, and where it was evaluated last, their forces and
        #: stiffness.
        self.joined = None if tied is None else JoinedTies.of(tied, pairs.a, pairs.b)
        self.pulls, self.tie_stiffness = np.zeros((0, n_dof)), np.zeros((0, 2 * n_dof, 2 * n_dof))
        joined = self.joined or pairs
        self.tangent = Tangent.zeros(n, len(joined.a), n_dof)
        self.structure = lu_symbolic.analyse(joined.a, joined.b, loads.fixed, place, n_dof)
        self.factors = lu_numeric.allocate(self.structure)
        self.frame = path.Frame(
            load=self.pattern,
            pace=np.zeros((n, n_dof)),
            axis=np.zeros((n, n_dof)),
            columns=np.zeros((3, n, n_dof)),
            changes=np.zeros((CHANGES_PER_MATRIX, n, n_dof)),
            change_of_multiplier=np.zeros(CHANGES_PER_MATRIX),
            row=np.zeros((CHANGES_PER_MATRIX, 1, 2 * n_dof)),
            bodies=np.zeros((CHANGES_PER_MATRIX, 2), np.int64),
            pivot=np.zeros(CHANGES_PER_MATRIX),
            rate=np.zeros((n_slots, dim)),
            turn=np.full(2, np.nan),
            sense=np.ones(1),
            border=np.ones(1),
            sign=np.ones(1),
            bends=np.zeros((BENDS, 2)),
        )

    def move_trial(self, motion: Array) -> None:
        """Trial reactions where the blocks have moved on by ``motion`` (n, n_dof)."""
        forces.move_trial(*self.contacts, self.count, motion)

    def respond(self) -> None:
        """Make the contacts' ``response`` that of the branches they are in."""
        which, _, table = self.contacts
        plane_law.respond(which, table, self.count, self.branch, self.response)

    def linearise(
        self, x: Array, multiplier: float, away: Array, pace: Pace | None, gradient: Array
    ) -> bool:
        """Factorise the tangent at the places and branches last evaluated; False if singular.

        The unbalanced forces, and the ``residual``, are made those at ``x``, which is ``away`` (n,
        n_dof) from there.
        """
        self.respond()
        self.assemble(x, multiplier, away)
        self.damping[:] = 0.0
        return self.factorise(pace, gradient, 0.0)

    def assemble(self, x: Array, multiplier: float, away: Array) -> None:
        """Unbalanced forces, ``residual`` and tangent of the contacts' ``response``."""
        if not self.bent:
            forces.geometric_stiffness(
                self.slots, self.contacts, self.count, self.reaction, self.geometric
            )
            self.bent = True
        forces.assemble(
            self.contacts, self.count, self.pairs, self.response, self.geometric, away,
            self.contact_force, self.tangent,
        )  # fmt: skip
        if self.joined is not None:
            self.joined.clear(self.tangent, self.pairs.n_pairs)
            self.joined.stiffen(self.tangent, self.tie_stiffness)
            self.contact_force += self.pulls
            self.joined.pull_on(self.tie_stiffness, away, self.contact_force)
        dead = self.dead
        if self.turning is not None:
            self.tangent.diagonal[:, 2, 2] += self.turning
            dead = dead.copy()
            dead[:, 2] -= self.turning * away[:, 2]
        self.residual = self._unbalance(x, multiplier, dead)

    def load_near(self, pose: Array, multiplier: float) -> None:
        """Make the loads those near a pose (n, n_pose) and a multiplier, where they change."""
        acting = self.loads.acting
        if acting is None or self.turning is None:
            return
        self.dead[:], self.pattern[:] = acting.near(pose, multiplier)
        stiffness = acting.stiffness(pose, multiplier)
        self.turning[:] = stiffness[:, 0, 0] if stiffness.ndim else 0.0

    def pull(self, pose: Array) -> None:
        """Add the forces of the ties in a pose (n, n_pose) to those of the contacts."""
        ties = self.loads.ties
        if ties is None:
            return
        ties.act(pose)
        self.pulls = np.zeros_like(self.contact_force)
        ties.add_to(self.pulls)
        self.tie_stiffness = ties.stiffness()
        self.contact_force += self.pulls

    def _unbalance(self, x: Array, multiplier: float, dead: Array) -> float:
        c = self.loads
        largest: float = step.unbalance(
            self.contact_force, dead, self.pattern, multiplier, c.mass, x, self.inertia_factor,
            c.extent, c.fixed, self.force,
        )  # fmt: skip
        return largest

    def factorise(self, pace: Pace | None, gradient: Array, least_damping: float) -> bool:
        """Factorise the tangent, with inertia and what paces the step; False if singular.

        ``damping`` (n,) [1/s2] times the mass is added to the inertia, of the matrix alone.  Where
        ``least_damping`` is positive, it is raised by no less for blocks that nothing would hold.
        """
        c, frame = self.loads, self.frame
        frame.axis[:] = 0.0
        body = -1
        frame.border[0] = -1.0
        if pace is not None:
            body = pace.body
            frame.pace[:] = gradient
            frame.axis[body] = gradient[body]
        self.spring = step.stiffen(
            self.tangent.diagonal, c.mass, self.inertia_factor, self.damping, body, frame.axis
        )
        pivot: float = lu_numeric.factorise(
            self.structure, *self.tangent, self.factors, c.mass, self.damping, least_damping
        )
        frame.sign[0] = math.copysign(1.0, pivot) if pivot else 0.0
        return abs(pivot) > SINGULAR

    def direction(self, missing: float, *, paced: bool) -> float:
        """Direction in the frame's first column, for the unbalanced forces and what is missing of
        the pacing displacement [m], by the factors at hand; returns that of the multiplier."""
        frame, columns = self.frame, self.frame.columns
        columns[0] = self.force
        if not paced:
            lu_numeric.solve(self.structure, self.factors, columns[:1])
            return 0.0
        columns[1] = frame.load
        np.multiply(self.spring, frame.axis, out=columns[2])
        lu_numeric.solve(self.structure, self.factors, columns)
        return float(path.border(frame, columns[0], missing))

    @property
    def stable(self) -> bool:
        """Whether the structure would keep the equilibrium that the tangent was made for.

        Known once a direction has been solved for.  A determinant tells: with an even number of
        unstable modes it says yes as well.
        """
        return bool(self.frame.sign[0] * self.frame.border[0] < 0.0)

    def part(self, bodies: BoolArray, rings: int) -> Part:
        """The equations of some bodies (n,) and rings of their neighbours, with what is around them
        fixed: a copy."""
        contacts = self.contacts.of(slice(self.count))
        a, b = contacts.which[:, BODY_A], contacts.which[:, BODY_B]
        free = with_neighbours(bodies, a, b, rings) & ~self.loads.fixed
        rows = np.flatnonzero(free[a] | free[b])
        among = np.unique(np.concatenate((a[rows], b[rows])))
        number = np.zeros(len(free), np.int64)
        number[among] = np.arange(len(among))
        of_pair, of_slot = self.pairs.which, self.pairs.of_slot
        chosen, pair = np.unique(contacts.which[rows, PAIR], return_inverse=True)
        slots = np.flatnonzero(np.isin(of_slot, chosen))
        columns = of_pair[chosen, :FIRST].T
        columns[[A, B]] = number[columns[[A, B]]]
        pairs = Pairs.of(columns, np.bincount(of_slot)[chosen], self.pairs.pose[among])
        joined, tied = self.joined, None
        if joined is not None:
            of_ties, within = joined.within(np.isin(np.arange(len(free)), among))
            tied = number[within]
        step = LinearStep(
            self.loads.of(among, ~free[among]),
            pairs,
            self.place[among],
            Slots._make(field[slots] for field in self.slots),
            tied=tied,
        )
        step.inertia_factor, step.count = self.inertia_factor, len(rows)
        step.dead[:], step.pattern[:] = self.dead[among], self.pattern[among]
        if self.turning is not None:
            step.turning = self.turning[among]
        mine = step.contacts.of(slice(step.count))
        for own, whole in zip(mine, contacts, strict=True):
            own[:] = whole[rows]
        mine.which[:, SLOT] = np.searchsorted(slots, contacts.slot[rows])
        mine.which[:, PAIR] = pair
        mine.which[:, BODY_A], mine.which[:, BODY_B] = number[a[rows]], number[b[rows]]
        step.branch[:], step.reaction[:] = self.branch[slots], self.reaction[slots]
        step.damping[:] = self.damping[among]
        if joined is not None:
            step.pulls = self.pulls[among]
            step.tie_stiffness = joined.halved(self.tie_stiffness, of_ties, within)
        return Part(step=step, bodies=among, rows=rows)


def with_neighbours(bodies: BoolArray, a: IntArray, b: IntArray, rings: int) -> BoolArray:
    """Bodies (n,), and as many rings of their neighbours along pairs ``a``, ``b`` (n_pairs,)."""
    free = bodies.copy()
    for _ in range(rings):
        near = free[a] | free[b]
        free[a[near]] = free[b[near]] = True
    return free


@dataclass(frozen=True, kw_only=True)
class Part:
    """Equations of a part of a structure, and where they come from."""

    step: LinearStep
    bodies: IntArray  # (m,) of the whole
    rows: IntArray  # (count,) of the whole's contacts
