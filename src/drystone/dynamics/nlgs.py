"""Non-linear Gauss-Seidel with an active-set accelerator, up to a given residual of the equations.

The stiffer the joints are relative to the inertia of the blocks, the more slowly sweeps converge.
So, after a few sweeps, Newton's method on the velocities of the blocks is tried, with the branches
of the joint law that the sweeps have found: open, sticking, sliding in either direction.  Its
result is used if it lowers the residual.  Otherwise the sweeps continue from where they were, so
that the accelerator can only help.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from types import ModuleType

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import (
    BRANCHES_FIXED,
    LEAST_NEWTON,
    SOFT_PENALTY,
    STIFF_PENALTY,
    STIFFER_PENALTY,
    STIFFEST_PENALTY,
    TINY,
)
from drystone.contact.contacts import STIFF_N, STIFF_T
from drystone.contact.rows import contact_velocities, dof_of
from drystone.dynamics import sweeps as kernels
from drystone.dynamics.plane import sweeps as plane
from drystone.dynamics.space import sweeps as space
from drystone.dynamics.sweeps import ContactProblem
from drystone.engines.tie_forces import TieImpulses
from drystone.law.branches import BACKWARD, FORWARD
from drystone.law.residual import unbalanced_force
from drystone.law.violation import joint_law_violation
from drystone.linear.block_system import BlockSystem, SingularMatrixError


@dataclass(frozen=True, kw_only=True)
class NlgsSettings:
    """When to stop, and how sweeps and accelerator alternate."""

    tolerance: float  # N, on the residual
    max_sweeps: int = 6000
    max_sweeps_in_space: int = 300  # if the interior-point method has failed, shorten the step
    first_sweeps: int = 20  # before the accelerator is first tried
    corrections: int = 15  # of the branches, each with a linear solution
    # Penalty stiffness of sticking contacts, used one after another; over the stiffest joint or, in
    # short steps, the largest mass at a contact.  If Newton's method does not converge, a softer
    # series is tried, which tolerates wrong branches.  Stiff ones are needed for forces that depend
    # on a very small slip.
    penalties: tuple[tuple[float, ...], ...] = (
        (STIFF_PENALTY,) * 4 + (STIFFER_PENALTY,) * 2 + (STIFFEST_PENALTY,) * 2,
        (SOFT_PENALTY,) * 12,
        (1.0,) * 12,
    )


@dataclass(frozen=True, kw_only=True)
class NlgsResult:
    """Impulses and velocities, with their residual."""

    impulse: Array  # (n_contacts, dim) N s
    velocity: Array  # (n, n_dof) m/s, rad/s
    residual: float  # N
    n_sweeps: int
    n_corrections: int


#: A method to improve known impulses: it yields impulses and velocities, trial after trial.
Attempt = Callable[[Array], Iterator[tuple[Array, Array]]]

#: Largest number of corrections of a trial that is given up soon.
AT_ONCE = 6

#: How often Newton's method is tried from iterates of the interior-point method.
MOST_TRIED = 4


def form_of(dof: tuple[int, ...]) -> ModuleType:
    """The module of the dimension: `plane.sweeps` or `space.sweeps`."""
    return plane if len(dof) == 3 else space


def natural_map(problem: ContactProblem, dim: int, h: float) -> Array:
    """Delassus blocks (n_contacts, dim, dim) [1/kg] of contacts.

    The table of the contacts gets the shear stiffness of the natural map: the force that would move
    a contact by its slip in a step of ``h`` [s], over the slip.
    """
    blocks = np.zeros((len(problem.gap), dim, dim))
    kernels.delassus_blocks(dof_of(problem.inverse_mass), problem, blocks)
    easiest = np.einsum("kii->ki", blocks)[:, 1:].max(axis=1, initial=TINY)
    problem.contacts.table[:, STIFF_T] = 1.0 / (easiest * h * h)
    return blocks


def solve(
    problem: ContactProblem,
    system: BlockSystem,
    extent: Array,
    free_velocity: Array,
    impulse: Array,
    guess: Array,
    h: float,
    settings: NlgsSettings,
    ties: TieImpulses | None = None,
) -> NlgsResult:
    """Contact impulses of one implicit step.

    Parameters
    ----------
    problem
        Contacts of the step, of the pairs of ``system``.  Their table gets the shear stiffness of
        the natural map, see `natural_map`.
    extent
        (n,) m, by which moments are divided.
    free_velocity
        Velocities without contacts at the end of the step, (n, n_dof).
    impulse
        Impulses to begin with, (n_contacts, dim) [N s].
    guess
        First velocities for the accelerator, (n, n_dof), for instance those of a similar step.
    h
        Time step [s].
    """
    n, dim = impulse.shape
    blocks = natural_map(problem, dim, h)
    step = _Step(problem, system, extent, free_velocity, h, ties)
    accelerator = _Accelerator(problem, system, free_velocity, h, settings, ties)
    before, impulse = impulse, impulse.copy()
    velocity = step.velocity_of(impulse)
    order, n_sweeps, chunk = np.arange(n), 0, settings.first_sweeps
    residual = step.residual(impulse, velocity)
    most = settings.max_sweeps
    if accelerator.form.WITHIN is not None:
        most = min(most, settings.max_sweeps_in_space)
    while residual > settings.tolerance and n_sweeps < most:
        chunk = min(chunk, most - n_sweeps)
        velocity = step.velocity_of(impulse)
        accelerator.form.sweep(step.dof, problem, blocks, h, order, chunk, impulse, velocity)
        n_sweeps += chunk
        velocity = step.velocity_of(impulse)  # calculated anew, without accumulated rounding
        residual = step.residual(impulse, velocity)
        if residual <= settings.tolerance:
            break
        tries = accelerator.tries(before, guess if n_sweeps == chunk else None, impulse, velocity)
        known = impulse, velocity, residual
        impulse, velocity, residual = step.best(tries, known, settings.tolerance)
        chunk *= 2
    return NlgsResult(
        impulse=impulse,
        velocity=velocity,
        residual=residual,
        n_sweeps=n_sweeps,
        n_corrections=accelerator.n_solved,
    )


def friction_work(
    problem: ContactProblem,
    system: BlockSystem,
    solved: NlgsResult,
    loads: Sequence[Array],
    h: float,
    ties: TieImpulses | None = None,
) -> list[float]:
    """Changes of the work of friction in a step by each of several additional loads [J].

    A load that presses a sliding joint raises its friction.  Under an additional load F, with the
    branches of the step, velocities v and impulses p change by

        M dv = h F + H^T dp,        dp_n = -k_n h^2 dv_n,        dp_t = (p_t / p_n) dp_n,

    the last in contacts that slide.  So the work of their friction, on the motion h u of the step,
    changes by dp_t . u.

    Parameters
    ----------
    loads
        The loads, (n, n_dof) [N, N m] each.
    """
    settings = NlgsSettings(tolerance=0.0)  # nothing is iterated
    accelerator = _Accelerator(problem, system, np.zeros_like(solved.velocity), h, settings, ties)
    try:
        changes, slides = accelerator.under(loads, solved.impulse, solved.velocity)
    except SingularMatrixError:
        return [0.0] * len(loads)
    moved, grown = np.zeros_like(solved.impulse), np.zeros_like(solved.impulse)
    contact_velocities(accelerator.dof, problem.contacts, solved.velocity, moved)
    along = np.einsum("ki,ki->k", solved.impulse[slides, 1:], moved[slides, 1:])
    stiffness = h * h * problem.contacts.table[slides, STIFF_N]
    found = []
    for change in changes:
        contact_velocities(accelerator.dof, problem.contacts, change, grown)
        pressed = -stiffness * grown[slides, 0]
        found.append(float(along / solved.impulse[slides, 0] @ pressed))
    return found


class _Step:
    """The equations of a step: the velocities that follow from impulses, and the residual."""

    def __init__(self, problem, system, extent, free_velocity, h, ties) -> None:
        self.dof = dof_of(system.mass)
        self.problem, self.mass, self.extent = problem, system.mass, extent
        self.free_velocity, self.h, self.fixed = free_velocity, h, system.mass[:, 0] == 0.0
        self.nothing = np.zeros(len(problem.gap))
        self.defect = np.zeros_like(free_velocity)
        self.ties, self.pulled = ties, np.zeros_like(free_velocity)
        self.pull_with_ties(self.pulled)

    def pull_with_ties(self, velocity: Array) -> None:
        """Set the impulses of the ties to those at velocities (n, n_dof), for the next sweeps."""
        if self.ties:
            self.ties.act(velocity)
            self.pulled = np.zeros_like(velocity)
            self.ties.add_to(self.pulled)
            self.pulled *= self.problem.inverse_mass

    def velocity_of(self, impulse: Array) -> Array:
        """Velocities (n, n_dof) that follow from impulses (n_contacts, dim)."""
        velocity: Array = self.free_velocity + self.pulled
        kernels.apply_impulses(self.dof, self.problem, impulse, velocity)
        return velocity

    def best(
        self, tries: Iterable[Attempt], known: tuple[Array, Array, float], enough: float
    ) -> tuple[Array, Array, float]:
        """Impulses, velocities and residual of the first trial whose residual is at most ``enough``
        [N]; otherwise of the best trial, ``known`` included.  Each attempt begins with the best
        impulses so far.

        Velocities are kept with their impulses.  If they were calculated from the impulses, the
        rounding of an impulse would be amplified by the joint's stiffness over the mass.
        """
        for impulse, velocity in (trial for attempt in tries for trial in attempt(known[0])):
            residual = self.residual(impulse, velocity)
            if residual < known[2]:
                known = impulse.copy(), velocity.copy(), residual
                if residual <= enough:
                    break
        self.pull_with_ties(known[1])
        return known

    def residual(self, impulse: Array, velocity: Array) -> float:
        """The largest unbalanced force, or violation of the joint law if that is larger [N]."""
        problem, h, relative = self.problem, self.h, np.zeros_like(impulse)
        kernels.momentum_defect(
            self.dof, problem, self.mass, self.free_velocity, velocity, impulse, self.defect
        )
        if self.ties:
            self.ties.act(velocity)
            self.ties.add_to(self.defect)
        unbalanced = unbalanced_force(
            self.defect / h, np.zeros_like(self.defect), self.extent, self.fixed
        )
        contact_velocities(self.dof, problem.contacts, velocity, relative)
        reaction = impulse / h
        normal, tangential, _ = joint_law_violation(
            problem.contacts.table, problem.gap + h * relative[:, 0], h * relative[:, 1:], reaction,
            reaction[:, 1:], self.nothing, self.nothing,
        )  # fmt: skip
        return max(float(unbalanced), float(normal), float(tangential))


class _Accelerator:
    """Newton's method on the velocities, from the result of the sweeps.

    A stiff spring about the present tangential impulse represents sticking (a penalty).  Once the
    branches of the law no longer change, the spring is centred on the new impulse.  This is
    repeated until sticking contacts do not slip.
    """

    def __init__(self, problem, system, free_velocity, h, settings, ties) -> None:
        self.ties = ties
        self.dof = dof_of(system.mass)
        self.problem, self.system = problem, system
        self.mass, self.free_velocity, self.h = system.mass, free_velocity, h
        self.corrections, self.penalties = settings.corrections, settings.penalties
        # In short steps inertia is stiffer than joints: a softer penalty would have no effect.
        stiffness = problem.contacts.table[:, (STIFF_N, STIFF_T)]
        self.stiffest = h * h * stiffness.max(initial=0.0)
        self.penalty = 0.0  # kg
        # Momentum defect at which the branches count as fixed, from the tolerance on forces.
        lightest = np.sqrt(problem.inverse_mass.max(initial=0.0))
        self.enough = BRANCHES_FIXED * settings.tolerance * h * lightest
        self.defect = np.zeros_like(free_velocity)
        self.form = form_of(self.dof)
        self.slip = np.zeros((len(problem.gap), self.form.N_SLIP))  # see `space.sweeps`
        self.n_solved = 0

    def tries(
        self, before: Array, guess: Array | None, impulse: Array, velocity: Array
    ) -> Iterator[Attempt]:
        """The attempts to be made, one after another.

        Parameters
        ----------
        before, guess
            Impulses and velocities of a similar step; no velocities if they have been tried.
        impulse, velocity
            Result of the sweeps.
        """
        if self.form.WITHIN is not None:
            if guess is not None:
                yield partial(self.at_once, velocity=self.predicted(before, guess))
            begin, moving = (impulse, velocity) if guess is None else (before, guess)
            yield lambda known: self.from_within(begin, moving, known)
            if guess is None:
                return
        elif guess is not None:
            yield partial(self.trials, velocity=self.predicted(before, guess))
        for start in [velocity] if guess is None else [guess, velocity]:
            yield partial(self.trials, velocity=start)

    def at_once(self, impulse: Array, velocity: Array) -> Iterator[tuple[Array, Array]]:
        """`trials` that are given up soon, for steps in which next to nothing has changed."""
        return self._moves(impulse.copy(), velocity.copy(), self.penalties[0], AT_ONCE)

    def from_within(
        self, impulse: Array, velocity: Array, known: Array
    ) -> Iterator[tuple[Array, Array]]:
        """`trials` from iterates of the interior-point method, see `space.interior`.

        The penalty springs are first centred on ``impulse``.  The size of ``known`` impulses scales
        the barrier.
        """
        pressed = known[known[:, 0] > 0.0, 0]
        if len(pressed) == 0:
            return
        self.penalty = SOFT_PENALTY * self.stiffest
        centre = impulse[:, 1:].copy()
        search = self.form.WITHIN(
            self.problem, self.system, self.free_velocity, self.h, self.penalty, centre, self.ties
        )
        search.start(velocity, float(pressed.mean()))
        tried = 0
        for near in search.steps():
            self.n_solved += 1
            if not near:
                continue
            if tried == MOST_TRIED:
                return
            tried += 1
            self.penalty = SOFT_PENALTY * self.stiffest
            found, moved = impulse.copy(), search.velocity.copy()
            if self._newton(centre, moved, found, np.zeros(len(found), np.int64), AT_ONCE):
                yield found, moved
                yield from self._moves(found, moved, self.penalties[0])
                return

    def trials(self, impulse: Array, velocity: Array) -> Iterator[tuple[Array, Array]]:
        """Yield impulses and velocities each time before the springs are moved; the arrays are
        reused."""
        for penalties in self.penalties:
            found = False
            for trial in self._moves(impulse.copy(), velocity.copy(), penalties):
                found = True
                yield trial
            if found:
                return

    def predicted(self, impulse: Array, velocity: Array) -> Array:
        """Velocities (n, n_dof) in the branches of the impulses of a similar step.

        In stiff joints, the curvature of a step's motion is enough to open closed joints, or to
        press them many times as much.  So the velocities of the last step belong to other branches
        than its impulses.
        """
        piece, centre = np.zeros(len(impulse), np.int64), impulse[:, 1:].copy()
        self.form.branches(self.problem, impulse, piece)
        self.penalty = self.penalties[0][0] * self.stiffest
        found = np.zeros_like(impulse)
        self.form.branch_law(
            self.dof, self.problem, self.h, self.penalty, centre, piece, velocity, found, self.slip
        )
        self._defect(velocity, found)
        try:
            return velocity + self._direction(piece)
        except SingularMatrixError:
            return velocity

    def under(
        self, loads: Sequence[Array], impulse: Array, velocity: Array
    ) -> tuple[list[Array], BoolArray]:
        """Changes of the velocities, (n, n_dof) each, under additional ``loads``, (n, n_dof) [N,
        N m] each, in the branches of the impulses; and which contacts slide, (n_contacts,).

        The changes are zero if no contact slides.  Raises `SingularMatrixError`.
        """
        piece, found = np.zeros(len(impulse), np.int64), np.zeros_like(impulse)
        self.form.branches(self.problem, impulse, piece)
        slides = (piece == FORWARD) | (piece == BACKWARD)
        if not slides.any():
            return [np.zeros_like(load) for load in loads], slides
        self.penalty = STIFFEST_PENALTY * self.stiffest
        self.form.branch_law(  # for the directions of slip
            self.dof, self.problem, self.h, self.penalty, impulse[:, 1:].copy(), piece, velocity,
            found, self.slip,
        )  # fmt: skip
        if self.ties:
            self.ties.act(velocity)
        self._fill_tangent(piece)
        self.system.factorise()
        given = [np.where(self.mass == 0.0, 0.0, self.h * load) for load in loads]
        return [self.system.solve_again(momenta) for momenta in given], slides

    def _moves(
        self, impulse: Array, velocity: Array, penalties: Iterable[float], most: int | None = None
    ) -> Iterator[tuple[Array, Array]]:
        piece = np.zeros(len(impulse), np.int64)
        for penalty in penalties:
            self.penalty = penalty * self.stiffest
            centre = impulse[:, 1:].copy()
            if not self._newton(centre, velocity, impulse, piece, most):
                return
            yield impulse, velocity

    def _law(self, centre, stuck, velocity, impulse, piece) -> float:
        self.form.penalty_law(
            self.dof, self.problem, self.h, self.penalty, centre, stuck, velocity, impulse, piece,
            self.slip,
        )  # fmt: skip
        return self._defect(velocity, impulse)

    def _defect(self, velocity: Array, impulse: Array) -> float:
        norm: float = kernels.momentum_defect(
            self.dof, self.problem, self.mass, self.free_velocity, velocity, impulse, self.defect
        )
        if self.ties is None:
            return norm
        self.ties.act(velocity)
        self.ties.add_to(self.defect)
        self.defect[self.mass == 0.0] = 0.0
        return float(np.sqrt(np.sum(self.defect**2 * self.problem.inverse_mass)))

    def _fill_tangent(self, piece: IntArray) -> None:
        tangent = self.system.begin()
        self.form.penalty_law_tangent(
            self.dof, self.problem, self.h, self.penalty, piece, self.slip, *tangent
        )
        if self.ties:
            self.ties.stiffen(tangent)

    def _direction(self, piece: IntArray) -> Array:
        self._fill_tangent(piece)
        direction: Array = self.system.solve(self.defect)
        self.n_solved += 1
        return direction

    def _newton(
        self,
        centre: Array,
        velocity: Array,
        impulse: Array,
        piece: IntArray,
        most: int | None = None,
    ) -> bool:
        """Solve for the velocities in place, with at most ``most`` corrections (None: those of the
        settings); False if this does not converge."""
        none = np.zeros(len(centre), np.bool_)
        merit = self._law(centre, none, velocity, impulse, piece)
        for _ in range(self.corrections if most is None else most):
            if merit <= self.enough:
                return True
            base, was, turned = velocity.copy(), piece.copy(), self.slip.copy()
            stuck = none.copy()
            try:
                direction = self._direction(piece)
                velocity[:] = base + direction
                trial = self._law(centre, none, velocity, impulse, piece)
                # A contact that reverses its sliding passes the narrow range in which it sticks.
                # Let it stick, and try again.
                for _ in range(8):
                    if trial <= merit:
                        break
                    sense = self.form.sense(was, turned) * self.form.sense(piece, self.slip)
                    skipped = (sense.sum(axis=1) < 0) & ~stuck
                    if not skipped.any():
                        break
                    stuck |= skipped
                    self._law(centre, stuck, base, impulse, piece)
                    direction = self._direction(piece)
                    velocity[:] = base + direction
                    trial = self._law(centre, none, velocity, impulse, piece)
            except SingularMatrixError:
                return False
            length = 1.0
            while not trial <= merit and length > LEAST_NEWTON:
                length *= 0.5
                velocity[:] = base + length * direction
                trial = self._law(centre, none, velocity, impulse, piece)
            merit = trial
        good: bool = merit <= self.enough
        return good
