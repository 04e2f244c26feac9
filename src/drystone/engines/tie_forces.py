"""Ties in the equations of implicit steps: their forces on the bodies, and their stiffness.

The elongation of a tie has the gradient **h** by the motions of its two bodies.  The tie exerts the
force -N **h** on them.  Its stiffness, the derivative of minus this force, is

    k h h^T + (N / l) (J^T J - h h^T) + turning

with the tangent stiffness k, the force N and the length l of the tie, and the derivative **J** of
the vector between its two points by the motions of the bodies.  The second part comes from the
rotation of the tie, the third part from the rotation of the arms.  Yielding counts over the whole
step, as in `model.tie_kernels` with the plastic elongation at the start of the step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.law.certificate import Certificate
from drystone.linear.symbolic import Tangent
from drystone.model import tie_kernels as kernel
from drystone.model.assembly import Assembly
from drystone.model.loading.dead_forces import principal_axes
from drystone.model.ties import BROKEN, Bars, TieState


class TieForces:
    """Ties of a structure in a step, without those of bodies that have ``departed`` (n,)."""

    def __init__(self, bars: Bars, assembly: Assembly, departed: BoolArray) -> None:
        self.bars, self.assembly = bars, assembly
        self.there = ~departed[bars.body].any(axis=1)
        #: Arrays that kernels read and change.
        self.arrays = bars.at_rest(assembly)
        self.body, self.value, self.now = self.arrays
        self.axes = np.ascontiguousarray(assembly.axes)

    def begin(self, state: TieState) -> None:
        """Begin a step from a state of the ties."""
        self.before = state
        self.value[:, kernel.PLASTIC] = state.plastic
        self.value[:, kernel.ACTIVE] = self.there & (state.branch != BROKEN)

    def lose(self, departed: BoolArray) -> None:
        """Take out the ties of bodies that have ``departed`` (n,)."""
        self.there = ~departed[self.body].any(axis=1)
        self.value[~self.there, kernel.ACTIVE] = 0.0

    def act(self, pose: Array) -> None:
        """Evaluate the ties in poses (n, n_pose)."""
        kernel.locate(self.body, self.value, pose, self.now)
        self.rotate(pose)

    def rotate(self, pose: Array) -> None:
        """Use the principal axes in poses (n, n_pose), about which moments are counted."""
        if len(self.body) and self.assembly.dimension == 3:
            self.axes = np.ascontiguousarray(principal_axes(self.assembly, pose))

    def add_to(self, force: Array) -> None:
        """Add the forces on the bodies to an array (n, n_dof)."""
        kernel.add_forces(self.body, self.now, self.axes, force)

    def _points(self) -> Array:
        """J, (n_ties, dim, 2 n_dof): derivative of the vector from a's point to b's by the motions
        of the bodies."""
        dim, m = self.assembly.dimension, len(self.body)
        sides = []
        for side, first in ((0, kernel.NOW_A), (1, kernel.NOW_B)):
            arm = self.now[:, first : first + 3]
            straight = np.broadcast_to(np.eye(dim), (m, dim, dim))
            if dim == 2:
                rotation = np.stack((-arm[:, 1], arm[:, 0]), axis=1)[:, :, None]
            else:
                axes = self.axes[self.body[:, side]]
                rotation = np.cross(axes, arm[:, :, None], axis=1)
            sides.append(np.concatenate((straight, rotation), axis=2))
        return np.concatenate((-sides[0], sides[1]), axis=2)

    def gradient(self) -> Array:
        """h, (n_ties, 2 n_dof): gradient of the elongations by the motions of the bodies."""
        dim = self.assembly.dimension
        along = self.now[:, kernel.ALONG : kernel.ALONG + dim]
        return np.asarray(np.einsum("kd,kdi->ki", along, self._points()))

    def stiffness(self) -> Array:
        """Stiffness, the derivative of minus the forces, (n_ties, 2 n_dof, 2 n_dof)."""
        dim, now = self.assembly.dimension, self.now
        points = self._points()
        along = now[:, kernel.ALONG : kernel.ALONG + dim]
        h = np.einsum("kd,kdi->ki", along, points)
        outer = h[:, :, None] * h[:, None, :]
        found = now[:, kernel.TANGENT, None, None] * outer
        across = np.einsum("kdi,kdj->kij", points, points) - outer
        found += (now[:, kernel.FORCE] / now[:, kernel.DISTANCE])[:, None, None] * across
        n_dof = self.assembly.n_dof
        for side, first, sign in ((0, kernel.NOW_A, 1.0), (1, kernel.NOW_B, -1.0)):
            arm, at = now[:, first : first + dim], side * n_dof
            pulled = sign * now[:, kernel.FORCE, None] * along
            if dim == 2:
                found[:, at + 2, at + 2] += np.einsum("kd,kd->k", arm, pulled)
                continue
            axes = self.axes[self.body[:, side]]
            tensor = arm[:, :, None] * pulled[:, None, :]
            world = np.einsum("kii->k", tensor)[:, None, None] * np.eye(3) - tensor
            turned = np.einsum("kpi,kpq,kqj->kij", axes, world, axes)
            found[:, at + 3 : at + 6, at + 3 : at + 6] += turned
        return np.asarray(found)

    def marked(self, certificate: Certificate) -> Certificate:
        """A certificate in which bodies on which a tie pulls count as touched."""
        touched = certificate.touched.copy()
        touched[self.body[self.now[:, kernel.FORCE] != 0.0]] = True
        return certificate._replace(touched=touched)

    def ended(self, *, yields: bool = True, aged: bool = False) -> TieState:
        """The state of the ties at the end of a step, in the last poses; see `Bars.ended`."""
        return self.bars.ended(self.before, self.value, self.now, yields=yields, aged=aged)

    def add_twice(self, blocks: Array) -> None:
        """Add twice the stiffness along each tie to the blocks (n, n_dof, n_dof) of its bodies, as
        if all were taut."""
        n_dof, gradient = self.assembly.n_dof, self.gradient()
        whole = self.value[:, kernel.STIFFNESS] * self.value[:, kernel.ACTIVE]
        for side in range(2):
            h = gradient[:, side * n_dof : side * n_dof + n_dof]
            outer = 2.0 * whole[:, None, None] * h[:, :, None] * h[:, None, :]
            np.add.at(blocks, self.body[:, side], outer)


class TieImpulses:
    """Ties in an implicit step of ``h`` [s] of contact dynamics.

    Their directions are those at the start of the step, their forces those at its end.  ``a`` and
    ``b`` (n_pairs,) are the bodies of the contacts' pairs.
    """

    def __init__(self, ties: TieForces, a: IntArray, b: IntArray, h: float) -> None:
        self.ties, self.h, self.joined = ties, h, JoinedTies.of(ties.body, a, b)
        self.start = ties.now[:, kernel.ELONGATION].copy()
        self.gradient = ties.gradient()

    def act(self, velocity: Array) -> None:
        """Evaluate the forces of the ties for velocities (n, n_dof) at the end of the step."""
        ties = self.ties
        both = velocity[ties.body].reshape(len(ties.body), -1)
        rate = np.einsum("ki,ki->k", self.gradient, both)
        ties.now[:, kernel.ELONGATION] = self.start + self.h * rate
        for k in range(len(ties.body)):
            kernel.pull(ties.value, ties.now, k)

    def add_to(self, momenta: Array) -> None:
        """Add the impulses of the ties to the momenta (n, n_dof) of the bodies [N s, N m s]."""
        ties, nd = self.ties, momenta.shape[1]
        impulse = -self.h * ties.now[:, kernel.FORCE, None] * self.gradient
        np.add.at(momenta, ties.body[:, 0], impulse[:, :nd])
        np.add.at(momenta, ties.body[:, 1], impulse[:, nd:])

    def stiffen(self, tangent: Tangent) -> None:
        """Add the derivatives of minus the impulses by the velocities [kg] to ``tangent``."""
        h = self.gradient
        found = (
            self.h**2
            * self.ties.now[:, kernel.TANGENT, None, None]
            * (h[:, :, None] * h[:, None, :])
        )
        self.joined.stiffen(tangent, found)


@dataclass(frozen=True, kw_only=True)
class JoinedTies:
    """The places of the stiffness of ties in a matrix of bodies and pairs.

    Two bodies that no contact joins make a new pair, behind the pairs of the contacts.
    """

    body: IntArray  # (n_ties, 2)
    a: IntArray  # (n_pairs,) first bodies of all pairs, those of contacts first
    b: IntArray  # (n_pairs,) second bodies
    pair: IntArray  # (n_ties,) pair of each tie
    turned: BoolArray  # (n_ties,) whether the tie's first body is the pair's second
    apart: BoolArray  # (n_ties,) whether its two ends are on different bodies

    @classmethod
    def of(cls, body: IntArray, a: IntArray, b: IntArray) -> JoinedTies:
        """Find the pairs of ties between bodies ``body`` (n_ties, 2), beside the pairs of contacts
        with bodies ``a`` and ``b``."""
        known: dict[tuple[int, int], int] = {}
        first, last = a.tolist(), b.tolist()
        wanted = {tuple(sorted(one)) for one in body.tolist()}
        for p, pair in enumerate(zip(first, last, strict=True)):
            if tuple(sorted(pair)) in wanted:
                known.setdefault((min(pair), max(pair)), p)
        pairs, turned = [], []
        for i, j in body.tolist():
            key = (min(i, j), max(i, j))
            if key not in known and i != j:
                known[key] = len(first)
                first.append(i)
                last.append(j)
            p = known.get(key, -1)
            pairs.append(p)
            turned.append(p >= 0 and first[p] != i)
        return cls(
            body=body,
            a=np.array(first, np.int64),
            b=np.array(last, np.int64),
            pair=np.array(pairs, np.int64),
            turned=np.array(turned, np.bool_),
            apart=body[:, 0] != body[:, 1],
        )

    def clear(self, tangent: Tangent, n_pairs: int) -> None:
        """Set the blocks of the pairs behind the ``n_pairs`` of the contacts to zero."""
        tangent.upper[n_pairs:] = 0.0
        tangent.lower[n_pairs:] = 0.0

    def stiffen(self, tangent: Tangent, found: Array) -> None:
        """Add the stiffness ``found`` (n_ties, 2 n_dof, 2 n_dof) of the ties to ``tangent``."""
        nd = tangent.diagonal.shape[1]
        np.add.at(tangent.diagonal, self.body[:, 0], found[:, :nd, :nd])
        np.add.at(tangent.diagonal, self.body[:, 1], found[:, nd:, nd:])
        forth, back = found[:, :nd, nd:], found[:, nd:, :nd]
        swap = self.turned[:, None, None]
        kept = self.apart
        np.add.at(tangent.upper, self.pair[kept], np.where(swap, back, forth)[kept])
        np.add.at(tangent.lower, self.pair[kept], np.where(swap, forth, back)[kept])
