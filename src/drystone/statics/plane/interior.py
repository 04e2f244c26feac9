"""The branches of many contacts at once: one linear step solved from its interior.

See `statics.plane.interior_kernels` for the equations.  A predictor with no barrier at all tells
how low the next barrier can be; the corrector that goes there uses the same factors and the second
order of the predictor (Mehrotra 1992).  The number of iterations hardly depends on that of the
contacts or of their changes.

Friction is non-associative: as the barrier falls, the equilibrium it belongs to may come to an end
or lose its stability, as blocks do that hang by little.  From there on inertia holds such bodies
back, as much as it takes to make every direction one that the structure would take by itself, and
the barrier waits until they have come to rest.  So blocks slide and fall to where they find hold.
While they are few, they do so apart from the rest: it costs the whole next to nothing.

What says that a body hangs is a pivot that is negative.  The tangent of friction is unsymmetric,
and bodies may stand of which that is so: those that do not come to rest while they are held, but do
by Newton's method, where no mode grows, are held no more.

The unknowns approach the solution as near as tells the branches; `statics.plane.piecewise` does
the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.contact.contacts import BODY_A, BODY_B, STIFF_N
from drystone.geometry.motion import translations
from drystone.law import interior as interior_law
from drystone.law.interior import N_CHANGE, N_INNER
from drystone.statics.linear import numeric as lu_numeric
from drystone.statics.linear_step import LinearStep, Pace
from drystone.statics.plane import interior_kernels as kernel
from drystone.statics.plane import path

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class InteriorSettings:
    """Numbers of the iterations.

    Energies are those of a contact over what the weight of a mean block stores in one, forces over
    that weight.  Damping is in 1/s2 of the structure's own frame, in which gravity over the
    smallest block's size is 56 of them: what it holds back gains no speed on the way.
    """

    #: Energy of the first barrier: contacts then start as if each carried a block.
    start: float = 1.0
    #: More of it, over the work of a block's weight along the increment: a long step may leave no
    #: contact as it was.
    reach: float = 0.05
    #: Energy from which on the branches may be told, and at which they are where there is no
    #: lower one to be had: far below what any contact but an idle one stores.
    enough: float = 1e-11
    surely: float = 1e-13
    #: Energy below which only contacts that carry next to nothing could still tell.
    least: float = 1e-18
    #: Energy, and largest unbalanced force, at which so few branches are still wrong that Newton's
    #: method mends them in less than the interior would take to tell them.
    early: float = 1e-8
    early_residual: float = 1e-2
    #: Largest unbalanced force with which branches are told.
    residual: float = 1e-6
    #: Iterations before the step counts as lost; most take 25 to 60.
    max_iterations: int = 120
    #: Share of the way to the end of the first factor that is left, at most.
    margin: float = 0.01
    #: Share of a direction under which there is no way on: at once, or for the third time in a row.
    shortest: float = 0.03
    short: float = 0.1
    patience: int = 3
    #: Times that there was no way on before the step counts as lost.
    max_stalls: int = 10
    #: Times in a row that one body is held back before all are.
    alone: int = 2
    #: Barrier over the present one at which contacts that are at their ends begin anew.
    raised: float = 30.0
    #: Damping [1/s2], times the mass, where there is first no way on, and above which more of it
    #: would not help.
    damping: float = 1e4
    most_damping: float = 1e5
    #: Factors of it while a direction is unstable, and after one that was good.
    more: float = 4.0
    less: float = 0.25
    #: Damping [1/s2] below which there is none.
    least_damping: float = 3.0
    #: Share of the bodies up to which loose ones come to rest apart from the others, with how many
    #: rings of neighbours (few leave the next ones out of balance), in how many iterations.
    few_loose: float = 0.1
    rings: int = 8
    max_rest: int = 100
    #: Iterations in which they stand without being held, where they do.
    max_free: int = 6
    #: Times that they did not before the step counts as lost: they fall.
    max_unrested: int = 3
    #: Unbalanced force over that of the energy, above which the barrier waits for the bodies held.
    hold: float = 0.3


class InteriorPoint:
    """Solves linear steps of one `LinearStep`; holds their arrays."""

    def __init__(self, step: LinearStep, settings: InteriorSettings | None = None) -> None:
        self.step = step
        self.settings = settings or InteriorSettings()
        n_slots = step.pairs.n_slots
        self.inner = np.zeros((n_slots, N_INNER))
        self.change = np.zeros((n_slots, N_CHANGE))
        self.offset = np.zeros_like(step.reaction)
        #: Of this descent: times that loose bodies did not come to rest, and bodies (n,) that stand
        #: though their pivots say that they do not.
        self.unrested, self.standing = 0, np.zeros(len(step.damping), np.bool_)
        dead = np.abs(translations(step.loads.dead)[~step.loads.fixed]).max(axis=1)
        self.block_weight = float(dead.mean())

    def descent(
        self,
        x: Array,
        multiplier: float,
        geometry: Array,
        pace: Pace | None,
        gradient: Array,
    ) -> Descent:
        """The way from ``x``, moved on in place, to where the branches tell.

        Parameters
        ----------
        x
            (n, n_dof) increments, to which the trial reactions of the step belong.
        multiplier
            There.
        geometry
            (n, n_dof) where the step was evaluated last.
        pace
            None where the multiplier is given.
        gradient
            (n, n_dof) of the pacing displacement.
        """
        return Descent(self, x, multiplier, geometry, pace, gradient)

    def _assemble(self, x: Array, multiplier: float, geometry: Array) -> float:
        """Unbalanced forces and tangent at ``x``; returns the mean energy [J]."""
        step = self.step
        energy: float = interior_law.respond_within(
            step.contacts, step.count, step.branch, self.inner, step.response
        )
        step.assemble(x, multiplier, x - geometry)
        return energy

    def _move(self, x: Array, length: float) -> None:
        """Go along the direction, ``x`` in place; bodies are let go where it was good.

        What made a pivot positive may be far more than holds a body: where it is the last of many
        that are unstable together, it takes what all of them lack.
        """
        step, settings = self.step, self.settings
        if length > 0.9:
            np.minimum(step.damping, settings.most_damping, out=step.damping)
            step.damping *= settings.less
            step.damping[step.damping < settings.least_damping] = 0.0
        x += length * step.frame.columns[0]
        kernel.move(step.contacts, step.count, self.inner, self.change, length)

    def _hold(self, bodies: int | slice) -> None:
        """Hold bodies more."""
        damping, settings = self.step.damping, self.settings
        damping[bodies] = np.maximum(settings.more * damping[bodies], settings.damping)

    def _faster(self, contact: int) -> int:
        """Of a contact's bodies, the one that moves more along the direction."""
        step = self.step
        bodies: list[int] = step.contacts.which[contact, (BODY_A, BODY_B)].tolist()
        return max(bodies, key=lambda i: np.abs(translations(step.frame.columns[0, i])).max())

    def _restless(self, unrest: float) -> bool:
        """Whether a body that is held is unbalanced by more than ``unrest`` [N]."""
        held = self.step.damping > 0.0
        return bool(np.abs(translations(self.step.force)[held]).max(initial=0.0) > unrest)

    def _rest(
        self, x: Array, multiplier: float, geometry: Array, energy: float, unrest: float
    ) -> bool:
        """Bring the bodies that are held, and those around, to rest at a barrier.

        They take many small steps, which would cost as much as those of the whole.  Returns whether
        there are such bodies, and few; `unrested` counts how often they did not come to rest.
        """
        step, settings = self.step, self.settings
        loose = step.damping > 0.0
        if not 0 < loose.sum() <= settings.few_loose * len(loose):
            return False
        part = step.part(loose, settings.rings)
        within = InteriorPoint(part.step, settings)
        n = len(part.rows)
        within.inner[:n] = self.inner[part.rows]
        moved = x[part.bodies]
        at = moved, multiplier, geometry[part.bodies], energy, unrest
        if not within._come_to_rest(*at):
            stand = within._stand(*at)
            self.standing |= loose & stand
            self.unrested += not stand
        self.inner[part.rows] = within.inner[:n]
        step.contacts.table[part.rows] = part.step.contacts.table[:n]
        step.damping[part.bodies] = part.step.damping
        x[part.bodies] = moved
        return True

    def _come_to_rest(
        self, x: Array, multiplier: float, geometry: Array, energy: float, unrest: float
    ) -> bool:
        step, settings = self.step, self.settings
        columns = step.frame.columns[:1]
        for _ in range(settings.max_rest):
            self._assemble(x, multiplier, geometry)
            if step.residual <= 0.1 * unrest:
                return True
            if not step.factorise(None, columns[0], settings.least_damping):
                return False
            _, room, limiting, _, _ = self._direction(columns, 0.0, None, energy, second=False)
            length = min(1.0, (1.0 - settings.margin) * room)
            if length > settings.shortest:
                self._move(x, length)
                continue
            body = self._faster(limiting)
            if step.damping[body] >= settings.most_damping:
                return False
            self._hold(body)
        return False

    def _stand(
        self, x: Array, multiplier: float, geometry: Array, energy: float, unrest: float
    ) -> bool:
        """Bring the bodies to rest by Newton's method, which holds none; whether they stand there.

        Friction makes the tangent unsymmetric: bodies stand of which not all pivots are positive.
        What these need to be so is far more than they have of stiffness, so that bodies which are
        held as much hardly move.
        """
        step, settings = self.step, self.settings
        columns = step.frame.columns[:1]
        arrays = x, self.inner, step.contacts.table, step.damping
        before = [array.copy() for array in arrays]
        for _ in range(settings.max_free):
            self._assemble(x, multiplier, geometry)
            if not self._keeps():
                break
            if step.residual <= 0.1 * unrest:
                return True
            _, room, _, _, _ = self._direction(columns, 0.0, None, energy, second=False)
            length = min(1.0, (1.0 - settings.margin) * room)
            if length <= settings.shortest:
                break
            self._move(x, length)
        for array, was in zip(arrays, before, strict=True):
            array[:] = was
        return False

    def _keeps(self) -> bool:
        """Whether the bodies would keep where they are: without damping, no real mode grows.

        The determinant changes its sign at every damping that holds just one mode more.  Leaves the
        factors those without damping.
        """
        step, settings = self.step, self.settings
        diagonal, nothing = step.tangent.diagonal.copy(), step.frame.columns[0]
        damping = settings.most_damping
        while True:
            step.tangent.diagonal[:] = diagonal
            step.damping[:] = damping
            if not step.factorise(None, nothing, 0.0) or not step.stable:
                return False
            if damping == 0.0:
                return True
            damping = damping * settings.less if damping > settings.least_damping else 0.0

    def factorise(self, pace: Pace | None, gradient: Array) -> bool:
        """Factorise the tangent with what holds loose bodies, but those that stand by themselves.

        False if it is singular.
        """
        step, least = self.step, self.settings.least_damping
        if not self.standing.any():
            return step.factorise(pace, gradient, least)
        diagonal = step.tangent.diagonal.copy()
        if not step.factorise(pace, gradient, least):
            return False
        if (step.damping[~self.standing] > 0.0).any():
            return True
        step.tangent.diagonal[:] = diagonal
        step.damping[:] = 0.0
        return step.factorise(pace, gradient, 0.0)

    def _told(self, x: Array, multiplier: float, geometry: Array, tolerance: float) -> bool:
        """Choose the branches; whether they leave nothing unbalanced."""
        step = self.step
        interior_law.choose(step.contacts, step.count, self.inner, step.branch)
        step.respond()
        step.assemble(x, multiplier, x - geometry)
        if step.residual <= tolerance:
            return True
        self._assemble(x, multiplier, geometry)
        return False

    def _direction(
        self, columns: Array, missing: float, pace: Pace | None, barrier: float, *, second: bool
    ) -> tuple[float, float, int, float, float]:
        """Fill the first column and the changes.

        Further columns, where there are any, are solved for as well.  Returns by how much the
        multiplier changes, the room, the contact that ends it, and how the energy changes on the
        way, to first and second order, see `statics.plane.interior_kernels.changes`.
        """
        step = self.step
        every = step.contacts, step.count, step.branch, self.inner
        columns[0] = step.force
        kernel.offset(*every, barrier, second, self.change, step.response, self.offset, columns[0])
        lu_numeric.solve(step.structure, step.factors, columns)
        by_direction = path.border(step.frame, columns[0], missing) if pace else 0.0
        room, limiting, by_way, by_square = kernel.changes(
            *every, barrier, second, step.response, self.offset, columns[0], self.change
        )
        if not math.isfinite(by_direction):
            room = 0.0
        return by_direction, room, limiting, by_way, by_square


class Descent:
    """The iterations of one solution, from the first barrier down to none."""

    def __init__(
        self,
        interior: InteriorPoint,
        x: Array,
        multiplier: float,
        geometry: Array,
        pace: Pace | None,
        gradient: Array,
    ) -> None:
        step = interior.step
        self.interior, self.step, self.settings = interior, step, interior.settings
        self.x, self.multiplier, self.geometry = x, multiplier, geometry
        self.pace, self.gradient = pace, gradient
        self.iterations = interior.unrested = 0
        interior.standing[:] = False
        self.near = self.sure = False  # whether the energy is so low that the branches may tell
        if step.count == 0:
            return
        self.stiffness = float(step.contacts.table[: step.count, STIFF_N].mean())
        self.unit = interior.block_weight**2 / self.stiffness  # J
        self.lag = pace.missing(geometry) if pace else 0.0
        self.columns = step.frame.columns if pace else step.frame.columns[:1]
        self.stalls, self.stuck, self.short = 0, 0, 0
        reach = self.settings.reach * interior.block_weight * abs(self._missing())
        self._centre(self.settings.start * self.unit + reach)
        step.damping[:] = 0.0

    def run(self, tolerance: float, *, early: bool = False) -> bool:
        """Go on until the branches tell, and choose them; whether they could be told.

        Parameters
        ----------
        tolerance
            Largest unbalanced force [N] with which the branches are surely those of the solution.
        early
            Stop where most branches tell, if no body is held there.
        """
        interior, step, settings = self.interior, self.step, self.settings
        if step.count == 0:
            return True
        while self.iterations < settings.max_iterations:
            energy = interior._assemble(self.x, self.multiplier, self.geometry)
            if early and self._tell_early(energy):
                return True
            self.iterations += 1
            weight = interior.block_weight
            calm = step.residual <= settings.residual * weight
            self.near = calm and energy <= settings.enough * self.unit
            self.sure = self.near and energy <= settings.surely * self.unit
            if self.near and interior._told(self.x, self.multiplier, self.geometry, tolerance):
                return True
            if self.near and energy <= settings.least * self.unit:
                return True
            unrest = settings.hold * math.sqrt(self.stiffness * energy)
            at = self.x, self.multiplier, self.geometry
            if interior._restless(unrest) and interior._rest(*at, energy, unrest):
                if self.pace and interior.unrested == settings.max_unrested:
                    return False
                interior._assemble(*at)
            if not interior.factorise(self.pace, self.gradient):
                return False
            if not self._descend(energy, unrest):
                break
        return self.near

    def _tell_early(self, energy: float) -> bool:
        """Choose the branches where Newton's method may know the rest."""
        step, settings = self.step, self.settings
        if energy > settings.early * self.unit or step.damping.any():
            return False
        if step.residual > settings.early_residual * self.interior.block_weight:
            return False
        interior_law.choose(step.contacts, step.count, self.interior.inner, step.branch)
        return True

    def _missing(self) -> float:
        """What is missing of the pacing displacement [m], where the unknowns are."""
        if not self.pace:
            return 0.0
        return self.lag - float(np.vdot(self.gradient, self.x - self.geometry))

    def _centre(self, barrier: float) -> None:
        self.barrier = barrier
        step = self.step
        interior_law.centre(step.contacts, step.count, step.branch, barrier, self.interior.inner)

    def _descend(self, energy: float, unrest: float) -> bool:
        """Predictor and corrector with the present factors; whether there is a way on."""
        interior, step, settings = self.interior, self.step, self.settings
        columns, missing = self.columns, self._missing()
        if self.pace:
            columns[1], columns[2] = step.frame.load, step.spring * step.frame.axis
        wait = interior._restless(unrest)
        by_direction, room, limiting, by_way, by_square = interior._direction(
            columns, missing, self.pace, energy if wait else 0.0, second=False
        )
        if not step.stable:
            interior._hold(slice(None))
            self.short = 0
            return True
        if self.sure and room <= settings.shortest:
            return False
        if not wait:
            way = min(1.0, room)
            least = max(energy + way * (by_way + way * by_square), 0.0)
            share = (least / energy) ** 3 if energy > 0.0 else 0.0  # bonds have none
            self.barrier = min(max(share, 1e-3), 0.8) * energy
            by_direction, room, limiting, _, _ = interior._direction(
                columns[:1], missing, self.pace, self.barrier, second=True
            )
        margin = min(settings.margin, math.sqrt(max(energy / self.unit, 1e-16)))
        length = min(1.0, (1.0 - margin) * room)
        self.short = self.short + 1 if length < settings.short else 0
        if not length > settings.shortest or self.short == settings.patience:
            return self._stall(limiting, energy)
        self.stuck = 0
        interior._move(self.x, length)
        self.multiplier += length * by_direction
        return True

    def _stall(self, limiting: int, energy: float) -> bool:
        """Hold back what leaves no way on, or begin anew; False after too many times."""
        interior, settings, damping = self.interior, self.settings, self.step.damping
        if self.stalls == settings.max_stalls or self.sure:
            return False
        self.stalls, self.stuck, self.short = self.stalls + 1, self.stuck + 1, 0
        body = interior._faster(limiting)
        if self.near or damping[body] >= settings.most_damping:
            self._centre(settings.raised * max(energy, self.barrier))
            np.minimum(damping, settings.damping, out=damping)
        else:
            interior._hold(body if self.stuck <= settings.alone else slice(None))
        return True
