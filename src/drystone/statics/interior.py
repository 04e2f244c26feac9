"""An interior-point method for a static step from one equilibrium to the next.

The barrier smooths the joint law (`law.cones`).  With a large barrier every contact sticks, slides
and opens a little.  As the barrier is reduced, each contact comes to one state.  Gaps and gradients
are computed anew in every iteration.  A predictor without a barrier shows by how much the barrier
can be reduced; its second-order terms are used if it leads far.

If the direction of a slip changes, the iterations would stop at the boundary of the friction cone.
So contacts may leave their cones within a neighbourhood of the central path.  They are then
projected back, centred on the trial reactions at their new place.

Every few iterations, and at the end, Newton's method on the joint law itself is tried.  It is exact
if all contacts are in the branches of the solution.  If contacts change their state as the tangent
of the curve predicts, or not at all, Newton's method alone leads from one equilibrium to the next.
"""

from __future__ import annotations

import math

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array
from drystone.contact.contacts import INTACT, STIFF_N
from drystone.geometry.motion import rotations, translations
from drystone.law import central_path, cones
from drystone.statics.static_step import StaticStep

#: Largest number of iterations in a full search; the same if a shorter step may be tried instead;
#: iterations within which the energy must halve.
MAX_ITERATIONS, FEW_ITERATIONS, PATIENCE = 120, 60, 40

#: Iterations between two trials of Newton's method; its largest number of iterations in such a
#: trial; the same at the start of a step.
NEWTON_EVERY, NEWTON_ITERATIONS, WARM_ITERATIONS = 16, 6, 12

#: Iterations in a row without progress after which contacts are centred anew; and how often they
#: are.
STALLED, RECENTRED = 4, 4

#: Iterations within which Newton's method must have reduced the unbalanced force: between
#: iterations of the interior-point method, and at the start of a step.  The last number: iterations
#: of the interior-point method after which Newton's method is tried again, once the branches can be
#: told.
NEWTON_PATIENCE, WARM_PATIENCE, AGAIN = 2, 4, 4


class InteriorPoint:
    """Finds where a step of one `StaticStep` ends.  All its variables are those of the step, but
    for the count of iterations."""

    def __init__(self, step: StaticStep) -> None:
        self.step = step
        dead = np.linalg.norm(translations(step.loads.dead)[~step.loads.fixed], axis=1)
        self.block_weight = float(dead.mean())
        self.iterations = 0

    # Newton's method.

    def newton(self, iterations: int, *, patience: int = 100, gain: float = 1.0) -> bool:
        """Iterate on the joint law itself; whether that ends in an equilibrium.

        The iteration is given up if ``patience`` iterations have not reduced the unbalanced force
        by the factor ``gain``.
        """
        step = self.step
        first = best = math.inf
        for k in range(iterations + 1):
            step.respond()
            residual = step.balance(step.reaction)
            if step.balanced():
                return True
            if not residual < math.inf:
                return False
            first = residual if k == 0 else first
            best = min(best, residual)
            if k == iterations or (k >= patience and best * gain > first):
                return False
            if not self._newton_step():
                return False
        return False

    def newton_along(self, guess: Array, tangent_motion: Array, multiplier: float) -> bool:
        """Newton's method from a ``guess``; whether that leads to an equilibrium.

        The first branch of each contact is the one to which the motion along the tangent leads.
        The branches at the guess would say nothing, because the error of the guess strains a stiff
        joint by more than the joint carries.  Along the tangent, the trial reactions are exact to
        first order.  Guess and motion are increments (n, n_dof).
        """
        step, n = self.step, self.step.n
        step.restart(np.zeros_like(guess), multiplier)
        step.follow(tangent_motion)
        step.respond()
        trial, reaction = step.trial[:n].copy(), step.reaction[:n].copy()
        response, branch = step.response[:n].copy(), step.branch[:n].copy()
        step.restart(guess, multiplier)
        step.respond()
        if not np.array_equal(step.branch[:n], branch):
            off = step.trial[:n] - trial
            step.reaction[:n] = reaction + np.einsum("kij,kj->ki", response, off)
            step.response[:n] = response
            step.balance(step.reaction)
            if not self._newton_step():
                return False
        return self.newton_from_start()

    def newton_from_start(self) -> bool:
        """Newton's method at the start of a step; whether that ends in an equilibrium."""
        most = WARM_ITERATIONS
        return self.newton(most, patience=WARM_PATIENCE, gain=tolerances.WARM_GAIN)

    def _newton_step(self) -> bool:
        """One iteration of Newton's method with the present responses; False if the stiffness is
        singular."""
        step = self.step
        self.iterations += 1
        by_multiplier, length = step.aim(), self._limit_rotation(1.0)
        if not math.isfinite(by_multiplier) or not length > 0.0:
            return False
        step.multiplier += length * by_multiplier
        step.move(step.bordered.columns[0], length)
        return True

    def _limit_rotation(self, length: float) -> float:
        """The ``length`` to go along the direction, shortened so that no body rotates too far."""
        most = float(np.abs(rotations(self.step.bordered.columns[0])).max())
        if not most < math.inf:
            return 0.0
        return min(length, tolerances.FARTHEST_ROTATION / most) if most > 0.0 else length

    # The interior.

    def interior(self, iterations: int, *, soon: bool = False, least_damping: float = 0.0) -> bool:
        """Reduce the barrier to zero; whether that ends in an equilibrium.

        Parameters
        ----------
        iterations
            Largest number of them.
        soon
            Whether to give up if a part is unsupported.
        least_damping
            [1/s2], see `StaticStep.factorise`.
        """
        step = self.step
        n = step.n
        joint, inner = step.table[:n], step.inner[:n]
        free = joint[:, INTACT] == 0.0
        if not free.any():
            return self.newton(WARM_ITERATIONS)
        unit = self.block_weight**2 / float(joint[free, STIFF_N].mean())  # J
        step.damping[:] = 0.0
        self._centre(tolerances.FIRST_BARRIER, unit)
        again, least, since, stalled, recentred = 0, math.inf, 0, 0, 0
        for k in range(1, iterations + 1):
            energy = cones.scale(joint, inner, step.scaling[:n])
            residual = step.balance(step.inside)
            if not math.isfinite(energy + residual):
                return False
            if energy <= 0.5 * least:
                least, since = energy, k
            elif k - since > PATIENCE:
                return False
            told = energy <= tolerances.TELLS * unit
            due = k % NEWTON_EVERY == 0 or (told and k >= again)
            if (
                due
                and residual <= tolerances.NEWTON_RESIDUAL * self.block_weight
                and self._try_newton(told)
            ):
                return True
            again = k + AGAIN if due and told else again
            damped = float(step.damping.max())
            if soon and (damped >= tolerances.LOST_SUPPORT or (told and damped > 0.0)):
                return False
            if stalled >= STALLED:
                if recentred == RECENTRED:
                    return False
                self._centre(tolerances.RECENTRED_BARRIER, unit)
                energy = cones.scale(joint, inner, step.scaling[:n])
                step.balance(step.inside)
                step.damping[:] = 0.0
                stalled, recentred, least, since = 0, recentred + 1, math.inf, k
            length = self._descend(least_damping, energy)
            if not length >= 0.0:
                return False
            stalled = stalled + 1 if length < tolerances.NO_PROGRESS else 0
        return False

    def _centre(self, barrier: float, unit: float) -> None:
        """Centre the contacts where the step is, with a ``barrier`` in units of the energy ``unit``
        [J], or more if much is unbalanced."""
        step, n = self.step, self.step.n
        step.respond()
        unbalanced = step.balance(step.reaction) / self.block_weight
        most = min(tolerances.BY_UNBALANCED * unbalanced**2, tolerances.MOST_BARRIER)
        barrier = max(barrier, most) * unit
        cones.centre_contacts(step.table[:n], barrier, True, step.trial[:n], step.inner[:n])

    def _try_newton(self, told: bool) -> bool:
        """Whether Newton's method finds the solution from here; if not, the step is left as it was.

        If the branches of contacts can be ``told``, a few of them still change, and the unbalanced
        force rises meanwhile.  So Newton's method then has all its iterations.
        """
        step = self.step
        x, multiplier, damping = step.x.copy(), step.multiplier, step.damping.copy()
        patience = NEWTON_ITERATIONS if told else NEWTON_PATIENCE
        if self.newton(NEWTON_ITERATIONS, patience=patience, gain=tolerances.NEWTON_GAIN):
            return True
        step.restart(x, multiplier)
        step.damping[:] = damping
        step.balance(step.inside)
        return False

    def _descend(self, least_damping: float, energy: float) -> float:
        """Predictor and corrector with one factorisation.

        ``energy`` [J] is that of one contact.  Returns the length of the corrector that was taken,
        at most 1, or NaN if there is none.
        """
        step, n = self.step, self.step.n
        joint, inner, change = step.table[:n], step.inner[:n], step.change[:n]
        cones.responses(step.scaling[:n], step.response[:n])
        self.iterations += 1
        if not step.factorise(step.inside, least_damping):
            return math.nan
        missing = step.missing
        by_multiplier = self._direction(0.0, missing, second=False)
        if step.prescribed is not None and not step.stable:
            step.damping[:] = np.maximum(tolerances.MORE_DAMPING * step.damping, tolerances.DAMPING)
            return 1.0 if step.damping[0] < tolerances.MOST_DAMPING else math.nan
        ahead = tolerances.PREDICTOR_RADIUS * energy
        far = central_path.step_length(joint, inner, change, ahead, ahead)
        share = central_path.reduction(joint, inner, change, far, energy)
        second = far >= tolerances.FAR_ENOUGH
        by_multiplier = self._direction(share * energy, missing, second=second)
        ahead = share * energy
        far = central_path.step_length(joint, inner, change, ahead, tolerances.SLIP_RADIUS * ahead)
        far = self._limit_rotation(far)
        if not math.isfinite(by_multiplier) or not far > 0.0:
            return math.nan
        if far > tolerances.GOOD_LENGTH:
            step.damping *= tolerances.LESS_DAMPING
            step.damping[step.damping < tolerances.LEAST_DAMPING] = 0.0
        inner += far * change
        step.multiplier += far * by_multiplier
        step.move(step.bordered.columns[0], far)
        left = (1.0 - far) * energy + far * share * energy
        cones.centre_contacts(joint, left, False, step.trial[:n], inner)
        return far

    def _direction(self, barrier: float, missing: float, *, second: bool) -> float:
        """Fill the first column with the direction of the bodies, and `change` with the changes of
        the contacts' variables; returns the change of the multiplier.

        ``barrier`` [J] is the one aimed at; ``missing`` [m] is the prescribed displacement along
        the direction.
        """
        step, n = self.step, self.step.n
        joint, inner, change = step.table[:n], step.inner[:n], step.change[:n]
        scaling, trial, reaction = step.scaling[:n], step.trial[:n], step.reaction[:n]

        def aim(c: slice) -> None:
            cones.aim(
                joint[c], barrier, second, trial[c], inner[c], change[c], scaling[c], reaction[c]
            )

        def go(c: slice) -> None:
            cones.changes(joint[c], barrier, second, rates[c], inner[c], scaling[c], change[c])

        step.by_contacts(aim)
        step.balance(step.reaction)
        step.bordered.columns[0] = step.force
        by_multiplier = step.solve(missing)
        step.rates(step.bordered.columns[0])
        rates = step.by_motion[:n]
        step.by_contacts(go)
        return by_multiplier
