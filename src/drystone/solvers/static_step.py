"""The equations of one step of static equilibrium, on arrays that are made once per pair list.

    R(x, lambda) = G + lambda F + sum over contacts (r_n grad g + r_t grad s) - M x / h^2 = 0

with gaps and gradients in the places at the end of the step; see `kernels.joint` for the reactions
and their tangent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.contact.detection import Detector, Pairs, empty_slots
from drystone.contact.forces import SLIDING
from drystone.kernels import joint, narrow, step
from drystone.kernels.joint import N_HISTORY, Tangent
from drystone.kernels.narrow import Slots
from drystone.solvers.linear import BlockSystem, SingularMatrixError

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Pace:
    """The displacement c(x) that paces a step, of a point of one body, and what is asked of it."""

    body: int
    arm: Array  # (dim,) m from the centroid to the point, where the step starts
    axis: Array  # (dim,) direction the displacement is read in
    increment: float  # m

    def measure(self, x: Array) -> tuple[float, Array]:
        """What is missing of the increment [m], and the gradient of c by the body's motion."""
        ux, uy, w = x[self.body]
        (ax, ay), (dx, dy) = self.arm, self.axis
        s, versine = np.sin(w), 2.0 * np.sin(0.5 * w) ** 2
        turned_x, turned_y = ax * (1.0 - versine) - s * ay, ay * (1.0 - versine) + s * ax
        moved = dx * (ux + turned_x - ax) + dy * (uy + turned_y - ay)
        return self.increment - moved, np.array([dx, dy, dy * turned_x - dx * turned_y])


@dataclass(frozen=True, kw_only=True)
class Constants:
    """What stays the same over an analysis; arrays are (n, n_dof) over all bodies."""

    detector: Detector
    laws: Array  # (n_laws, N_LAW)
    thickness: float  # m
    dead: Array  # N, N m
    pattern: Array  # N, N m, at multiplier one
    mass: Array  # kg, kg m2; zero on fixed bodies
    inverse_mass: Array
    extent: Array  # (n,) m, by which moments are divided
    fixed: BoolArray  # (n,)


class StaticStep:
    """Evaluates and linearises the equations of steps over one list of pairs."""

    def __init__(self, constants: Constants, pairs: Pairs) -> None:
        n, n_dof = constants.mass.shape
        n_pairs = len(pairs.a)
        n_slots = 2 * n_pairs
        self.constants, self.pairs = constants, pairs
        self.system = BlockSystem(pairs.a, pairs.b, constants.fixed, n_dof)
        self.slots = empty_slots(n_pairs)  # contacts in the present places
        self.known = empty_slots(n_pairs)  # contacts by the features that the step follows
        self.found = empty_slots(n_pairs)  # contacts as they are found where the step ends
        self.source = np.arange(n_slots)
        self.force = np.zeros((n, n_dof))  # unbalanced
        self.contact_force = np.zeros((n, n_dof))
        self.reaction = np.zeros((n_slots, 2))
        self.status = np.zeros(n_slots, np.int64)
        self.excess = np.zeros(n_slots)
        self.state = np.zeros((n_slots, N_HISTORY))
        self.start_slip = np.zeros((n_slots, 6))
        self.start_length = np.zeros(n_slots)
        self.nobody = np.zeros(n_slots, np.bool_)
        self.tangent = Tangent(
            diagonal=np.zeros((n, n_dof, n_dof)),
            upper=np.zeros((n_pairs, n_dof, n_dof)),
            lower=np.zeros((n_pairs, n_dof, n_dof)),
        )
        self._diagonal = np.zeros((n, n_dof, n_dof))
        self._right = np.zeros((self.system.size, 2), order="F")
        self._right[:, 1] = self.system.gather(constants.pattern)

    def begin(self, pose: Array, slots: Slots, history: Array, h: float, guess: Array) -> None:
        """Start a step of size ``h`` [s] from rest in ``pose``, with its contacts and history.

        Slips are linear in the increments, by their gradients half way to the ``guess`` of these:
        of second order in the step, without straining the stiff shear springs of blocks that
        are held at several points and turn together.
        """
        self.pose, self.before, self.history = pose, slots, history
        self.weight = 1.0 / h**2
        self.start_length[:] = np.where(slots.kind != narrow.NONE, slots.length, 0.0)
        self.follow(slots)
        half = self.slots
        self.constants.detector.follow(self.pairs, pose + 0.5 * guess, self.known, half)
        joint.slip_gradients(
            half.kind, half.normal, half.arm_a, half.arm_b, half.roll, half.ratio,
            self.start_slip,
        )  # fmt: skip

    def follow(self, slots: Slots) -> None:
        """Take over the features of these contacts, and whose history each goes on with."""
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs
        before = self.before
        narrow.carry_history(before.kind, before.feature, before.edges, self.known, self.source)

    def evaluate(self, x: Array, multiplier: float, held: BoolArray | None = None) -> None:
        """Forces, merit, residual and tangent at the increments ``x`` (n, n_dof).

        Contacts that are ``held`` (n_slots,) stick whatever their cone says.
        """
        c, pairs = self.constants, self.pairs
        c.detector.follow(pairs, self.pose + x, self.known, self.slots)
        self.contact_force[:] = 0.0
        for block in self.tangent:
            block[:] = 0.0
        joint.joint_forces(
            self.slots, pairs.a, pairs.b, pairs.law, c.laws, c.thickness, self.start_length,
            self.start_slip, self.history, self.source, x,
            self.nobody if held is None else held, self.contact_force, self.reaction,
            self.status, self.excess, self.state, self.tangent, True,
        )  # fmt: skip
        #: Norm of the unbalanced forces weighted with the inverse masses, which the iteration
        #: lowers, and the largest of them [N].
        self.merit, self.residual = step.unbalance(
            self.contact_force, c.dead, c.pattern, multiplier, c.mass, c.inverse_mass, x,
            self.weight, c.extent, c.fixed, self.force,
        )  # fmt: skip

    def sense(self) -> Array:
        """+1 and -1 for contacts that slide one way and the other, else 0, (n_slots,)."""
        return np.where(self.status == SLIDING, np.sign(self.reaction[:, 1]), 0.0)

    def direction(
        self, pace: Pace | None, x: Array, lag: float, gradient: Array, damping: float
    ) -> tuple[Array, float]:
        """Newton direction of increments and multiplier from where `evaluate` last was.

        With a spring along the pacing displacement added to the matrix,

            (K + k c c^T) y_1 = R + k c lag,    (K + k c c^T) y_2 = F,

        the bordered equations have the same solution, and the matrix is regular at the peak,
        where K is not.  ``damping`` [1/s2] adds to the inertia of the iteration only.

        Raises `SingularMatrixError`.
        """
        c, system = self.constants, self.system
        self._diagonal[:] = self.tangent.diagonal
        body = pace.body if pace else -1
        spring = step.stiffen(self._diagonal, c.mass, self.weight + damping, body, gradient)
        solve = system.factor(self.tangent._replace(diagonal=self._diagonal))
        first = np.zeros_like(x)
        if pace is None:
            system.scatter(solve(system.gather(self.force)), first)
            return first, 0.0
        self.force[body] += spring * lag * gradient
        self._right[:, 0] = system.gather(self.force)
        self.force[body] -= spring * lag * gradient
        y = solve(self._right)
        system.scatter(y[:, 0], first)
        second = np.zeros_like(x)
        system.scatter(y[:, 1], second)
        along = float(gradient @ second[body])
        if along == 0.0 or not np.isfinite(along):
            raise SingularMatrixError
        change = (lag - float(gradient @ first[body])) / along
        return first + change * second, change

    def find(self, x: Array) -> None:
        """Find the contacts anew where the blocks are now, into ``found``."""
        self.constants.detector.fill(self.pairs, self.pose + x, self.found)
