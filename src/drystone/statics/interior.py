"""A static step from the last equilibrium to the next, through the interior of the joint law.

In the interior of the law (`law.cones`) every contact is a little of everything; as the barrier
falls it becomes what it is.  Gaps and gradients are renewed in every iteration.  A predictor
without a barrier tells how low the next one can be; its second order counts where it gets far.
Slips that turn would stall a straight way: pairs may leave their cones where they can be put back,
centred on the trial reactions of their new place.  Now and then, and at the end, Newton's method on
the joint law itself is tried, which is exact where the branches are those of the solution.

Where little changes, Newton's method alone goes from one equilibrium to the next.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.contact.contacts import HELD, STIFF_N
from drystone.geometry.motion import rotations, translations
from drystone.law import cones
from drystone.statics.constants import Accuracy
from drystone.statics.static_step import StaticStep

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class InteriorSettings:
    """Numbers of the iterations in space.

    Energies are those of a contact over what the weight of a mean block stores in one, forces over
    that weight.
    """

    #: First barrier of the first attempt, and of the second, which takes no second order.
    low: float = 1e-3
    high: float = 1.0
    #: More of the former, over the square of what is unbalanced where it begins, and at most: with
    #: less, contacts that are far from what they will be cut the way to nothing.
    unbalanced: float = 0.003
    most_unbalanced: float = 3.0
    #: More of the latter, over the work of a block's weight along the increment.
    reach: float = 0.05
    #: Iterations of either, and in how many its energy must halve.
    max_iterations: int = 120
    max_slow_iterations: int = 200
    patience: int = 40
    #: Of the former where a shorter step may be tried instead.
    few_iterations: int = 60
    #: Length of iterations that is no way on, how many of them in a row there may be, and how often
    #: contacts are then centred anew for what is unbalanced where the step has come to; the least
    #: barrier there.
    short: float = 0.2
    stalled: int = 4
    recentred: int = 4
    recentred_barrier: float = 1e-3
    #: Leeway of the predictor, over the barrier that it sets out from, and of the step, over the
    #: one that it goes to: by what normal reactions may leave their cones, and what may turn; see
    #: `law.cones`.
    predictor_leeway: float = 0.1
    leeway: float = 1.0
    turning_leeway: float = 10.0
    #: Part of the predictor from which on its second order counts.
    far_enough: float = 0.5
    #: Energy and unbalanced force at which the branches may be told, and energy below which there
    #: is nothing more to be found.
    enough: float = 1e-10
    residual: float = 1e-6
    least: float = 1e-24
    #: Iterations after which Newton's method is tried, where the unbalanced force is no more than
    #: that; how many of its own it has, and by how much it must gain in how many.
    probe: int = 16
    calm: float = 0.05
    probe_iterations: int = 6
    probe_gain: float = 10.0
    probe_patience: int = 2
    #: Iterations after which it is tried again, where the branches may be told.
    again: int = 4
    #: Of Newton's method from the last step: iterations, and by how much it must gain in how many.
    warm_iterations: int = 12
    warm_gain: float = 30.0
    warm_patience: int = 4
    #: Farthest rotation in an iteration [rad].
    turn: float = 0.2
    #: Damping [1/s2], times the mass, where there are unstable directions; factors of more and
    #: less.
    damping: float = 10.0
    most_damping: float = 1e9
    more: float = 4.0
    less: float = 0.25
    #: Damping that says that something has lost its hold: where a shorter step may be tried, it is.
    lost: float = 3e3
    #: By how much at least bodies are held that nothing holds, in the second attempt.
    least_damping: float = 3.0


@dataclass(frozen=True, kw_only=True)
class Attempt:
    """One way to begin."""

    barrier: float  # over the energy of a mean block's weight
    by_residual: bool = False  # more of it where much is unbalanced
    by_increment: bool = False  # more of it for a long step
    second: bool = True
    iterations: int = 60
    least_damping: float = 0.0  # see `lu_numeric.factorise`
    soon: bool = False  # whether it is given up where something has lost its hold


class InteriorPoint:
    """Finds where a step of one `StaticStep` ends; state is all the step's."""

    def __init__(self, step: StaticStep, accuracy: Accuracy, settings: InteriorSettings) -> None:
        self.step, self.accuracy, self.settings = step, accuracy, settings
        dead = np.linalg.norm(translations(step.loads.dead)[~step.loads.fixed], axis=1)
        self.block_weight = float(dead.mean())
        self.iterations = 0

    # Newton's method.

    def newton(self, iterations: int, *, patience: int = 100, gain: float = 1.0) -> bool:
        """Iterate on the joint law itself; whether that ends in an equilibrium.

        It is given up where the unbalanced force has not come down by ``gain`` in ``patience``.
        """
        step, accuracy = self.step, self.accuracy
        first = best = math.inf
        for k in range(iterations + 1):
            step.respond()
            residual = step.balance(step.reaction)
            if step.balanced(accuracy):
                return True
            if not residual < math.inf:
                return False
            first = residual if k == 0 else first
            best = min(best, residual)
            if k == iterations or (k >= patience and best * gain > first):
                return False
            if not self._newton_step(step.missing):
                return False
        return False

    def _newton_step(self, missing: float) -> bool:
        step = self.step
        step.damping[:] = 0.0
        self.iterations += 1
        if not step.factorise(step.reaction, 0.0):
            return False
        columns = step.frame.columns
        columns[0] = step.force
        by_multiplier = step.solve(missing)
        length = self._turning(1.0)
        if not math.isfinite(by_multiplier) or not length > 0.0:
            return False
        step.multiplier += length * by_multiplier
        step.move(columns[0], length)
        return True

    def _turning(self, length: float) -> float:
        """That much of the direction, or as much as no body turns too far in."""
        most = float(np.abs(rotations(self.step.frame.columns[0])).max())
        if not most < math.inf:
            return 0.0
        return min(length, self.settings.turn / most) if most > 0.0 else length

    # The interior.

    def interior(self, attempt: Attempt) -> bool:
        """Go down from a barrier; whether that ends in an equilibrium."""
        step, settings = self.step, self.settings
        n = step.n
        joint, inner = step.table[:n], step.inner[:n]
        free = joint[:, HELD] == 0.0
        if not free.any():
            return self.newton(settings.warm_iterations)
        unit = self.block_weight**2 / float(joint[free, STIFF_N].mean())  # J
        step.damping[:] = 0.0
        self._centre(attempt, attempt.barrier, unit)
        again, least, since, stalled, recentred = 0, math.inf, 0, 0, 0
        for k in range(1, attempt.iterations + 1):
            energy = cones.scale(joint, inner, step.scaling[:n])
            residual = step.balance(step.inside)
            if not math.isfinite(energy + residual):
                return False
            if energy <= 0.5 * least:
                least, since = energy, k
            elif k - since > settings.patience:
                return False
            near = residual <= settings.residual * self.block_weight
            told = energy <= settings.enough * unit
            if told and near and self._solved():
                return True
            due = k % settings.probe == 0 or (told and k >= again)
            if due and residual <= settings.calm * self.block_weight and self._probe():
                return True
            again = k + settings.again if due and told else again
            held = float(step.damping.max())
            if attempt.soon and (held >= settings.lost or (told and held > 0.0)):
                return False
            if near and energy <= settings.least * unit:
                return False
            if attempt.by_residual and not near and stalled >= settings.stalled:
                if recentred == settings.recentred:
                    return False
                self._centre(attempt, settings.recentred_barrier, unit)
                energy = cones.scale(joint, inner, step.scaling[:n])
                step.balance(step.inside)
                step.damping[:] = 0.0
                stalled, recentred, least, since = 0, recentred + 1, math.inf, k
            length = self._descend(attempt, energy)
            if not length >= 0.0:
                return False
            stalled = stalled + 1 if length < settings.short else 0
        return False

    def _centre(self, attempt: Attempt, barrier: float, unit: float) -> None:
        """Begin from where the step is, with a barrier over the energy ``unit`` [J]."""
        step, settings, n = self.step, self.settings, self.step.n
        barrier *= unit
        if attempt.by_residual:
            step.respond()
            unbalanced = step.balance(step.reaction) / self.block_weight
            most = min(settings.unbalanced * unbalanced**2, settings.most_unbalanced)
            barrier = max(barrier, most * unit)
        if attempt.by_increment:
            barrier += settings.reach * self.block_weight * abs(step.missing)
        cones.centre_contacts(step.table[:n], barrier, True, step.trial[:n], step.inner[:n])

    def _solved(self) -> bool:
        """Whether the joint law itself leaves nothing unbalanced here; else all is as before."""
        if self.newton(0):
            return True
        self.step.balance(self.step.inside)
        return False

    def _probe(self) -> bool:
        """Whether Newton's method finds the solution from here; else all is as before."""
        step = self.step
        place, damping = step.place, step.damping.copy()
        s = self.settings
        if self.newton(s.probe_iterations, patience=s.probe_patience, gain=s.probe_gain):
            return True
        step.come_back(place)
        step.damping[:] = damping
        step.balance(step.inside)
        return False

    def _descend(self, attempt: Attempt, energy: float) -> float:
        """Predictor and corrector with one factorisation; how far along they went, at most 1, or
        not a number where there is no way on."""
        step, settings, n = self.step, self.settings, self.step.n
        joint, inner, change = step.table[:n], step.inner[:n], step.change[:n]
        step.respond_within()
        self.iterations += 1
        if not step.factorise(step.inside, attempt.least_damping):
            return math.nan
        missing = step.missing
        by_multiplier = self._direction(0.0, missing, second=False)
        if step.pace is not None and not step.stable:
            step.damping[:] = np.maximum(settings.more * step.damping, settings.damping)
            return 1.0 if step.damping[0] < settings.most_damping else math.nan
        ahead = settings.predictor_leeway * energy
        far = self._length(ahead, ahead)
        reachable = cones.energy_at(joint, far, inner, change)
        share = min(max((reachable / energy) ** 3, 1e-3), 0.8) if energy > 0.0 else 0.0
        second = attempt.second and far >= settings.far_enough
        by_multiplier = self._direction(share * energy, missing, second=second)
        ahead = share * energy
        far = self._length(settings.leeway * ahead, settings.turning_leeway * ahead)
        far = self._turning(far)
        if not math.isfinite(by_multiplier) or not far > 0.0:
            return math.nan
        if far > 0.9:
            step.damping *= settings.less
            step.damping[step.damping < 3.0] = 0.0
        inner += far * change
        step.multiplier += far * by_multiplier
        step.move(step.frame.columns[0], far)
        left = (1.0 - far) * energy + far * share * energy
        cones.centre_contacts(joint, left, False, step.trial[:n], inner)
        return far

    def _direction(self, barrier: float, missing: float, *, second: bool) -> float:
        """Fill the first column and the changes; returns that of the multiplier."""
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
        step.frame.columns[0] = step.force
        by_multiplier = step.solve(missing)
        rates = step.contact_rates()[:n]
        step.by_contacts(go)
        return by_multiplier

    def _length(self, leeway: float, turning: float) -> float:
        """How far all may go: contacts may leave their cones where they can be put back."""
        step, n = self.step, self.step.n
        joint, inner, change = step.table[:n], step.inner[:n], step.change[:n]
        far, least = cones.length(joint, inner, change, leeway)
        while far > least and cones.turns_too_far(joint, far, inner, change, turning):
            far *= 0.8
        return float(max(far, least))
