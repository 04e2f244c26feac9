"""The energy balance of a curve of `equilibrium`, step by step.

    curve, energy = energy_of(model)

A step goes from one equilibrium to the next with the areas and features that contacts had where it
began.  In it, the work of the loads is stored or dissipated.  With the elastic closure u of a
contact of area A and its shear T,

    stored      1/2 k_n A u^2 + T^2 / (2 k_s A)
    dissipated  |T| times what it slides, |N| times what it is torn open or crushed by.

Where the step has ended, contacts are found anew: in the same place, at the same gap, with the area
that the faces share by now and the shear force T that the contact brings along.  So what is stored
goes from one value to another without any motion,

    interface   1/2 k_n u^2 dA + T^2 / (2 k_s) d(1 / A),

and this is what the balance over several steps has beside work, store and dissipation.  As faces
slide off each other dA < 0: the strip that has come free takes along the energy of its springs,
1/2 k_n u^2 of each area, which is lost.  (Springs that were cut by a sharp edge would push it on
with 1/2 k_n u^2 times its width: u / 2 l of the normal force on a face of length l, which the law
leaves out.)  The shear is a force, and what it stores grows as the same force is carried by less.

The mean of the forces at both ends of a step stands for those in it.  That is exact as long as no
contact changes its state, and else an error of the balance, not of the curve, which goes with the
length of steps: shorter ones tell both apart.

What a dry contact stores in shear as it opens needs no term: its shear never exceeds mu N, so that
it has slid and sprung back to nothing by the time that N is nothing, which is in the slid length.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import drystone as ds
from drystone.common.arrays import Array, IntArray
from drystone.contact.contacts import NONE
from drystone.engines.base import Demand
from drystone.law.columns import DILATION, KN, KS, OPENED, SHEAR, SLID
from drystone.results.curve import CapacityCurve
from drystone.statics.equilibrium import EquilibriumEngine, EquilibriumState


@dataclass(frozen=True)
class Energy:
    """Of a curve, over the work done along it by load and weight on the way to where it ends."""

    error: float  # what is neither stored nor dissipated, of steps along equilibria; sizes added up
    released: float  # the same of jumps, which the structure would move with
    interface: float  # stored where contacts are found anew; negative where faces lose area


@dataclass(frozen=True)
class _Step:
    """What a step did; energies in units of the engine's own frame."""

    old: EquilibriumState
    demand: Demand
    work: float  # less what inertia took
    begun: float  # stored where it began, with the contacts of the step
    ended: float  # stored where it ended, with the same contacts
    lost: float
    found: float  # stored where it ended, with the contacts as they are found there


class _Watched(EquilibriumEngine):
    """Keeps what every accepted step has done, and which state it came from."""

    def __init__(self) -> None:
        super().__init__()
        self.steps: dict[int, tuple[EquilibriumState, _Step]] = {}
        self.made_of: dict[int, tuple[EquilibriumState, EquilibriumState]] = {}

    def _accept(self, own, state, solved, h, demand):
        self.prepared, self.equations, self.constants = (
            state.prepared,
            own,
            own.loaded,
        )
        origin, area = self.equations.origin.copy(), self._area_of_step()
        new, report = super()._accept(own, state, solved, h, demand)
        reaction, history = self._of_step(new)
        law = state.pairs.law_of_slot
        before = _at(state.history, origin)
        loads, x = self.constants.loads, new.last_increment
        force = loads.dead + 0.5 * (new.multiplier + state.multiplier) * loads.pattern
        inertia = float(np.vdot(loads.mass * x, x)) / h**2
        mean = 0.5 * (reaction + _at(state.reaction, origin))
        step = _Step(
            old=state,
            demand=demand,
            work=float(np.vdot(force, x)) - inertia,
            begun=self._found(state),
            ended=self._stored(law, area, reaction[:, 0] / self._stiff(law, area), history),
            lost=float(np.sum(_lost(mean, history - before))),
            found=self._found(new),
        )
        self.steps[id(new)] = new, step
        return new, report

    def _area_of_step(self) -> Array:
        """Areas of the slots that the step was solved with: those of where it began, and of
        contacts that were made in it."""
        return self._area(self.equations.known)

    def _of_step(self, new: EquilibriumState) -> tuple[Array, Array]:
        """Reactions and history of the slots that the step was solved with."""
        return new.acted.reaction, self.equations.finish()

    def step(self, state, demand):
        new, report = super().step(state, demand)
        if report.converged:
            self.reached = new
        return new, report

    def _drop_departed(self, state):
        return self._made(super()._drop_departed(state), state)

    def _refresh(self, state):
        return self._made(super()._refresh(state), state)

    def _made(self, new, state):
        if new is not state:
            self.made_of[id(new)] = new, state
        return new

    def taken(self) -> list[_Step]:
        """The steps that led to the last state, the first one last."""
        steps, last = [], self._last_to(self.reached)
        while last is not None:
            steps.append(last)
            last = self._last_to(last.old)
        return steps

    def _last_to(self, state: EquilibriumState) -> _Step | None:
        """The step that led to a state, whose pairs may have been found anew since."""
        while id(state) not in self.steps:
            if id(state) not in self.made_of:
                return None
            state = self.made_of[id(state)][1]
        return self.steps[id(state)][1]

    def again(self, step: _Step, parts: int) -> list[_Step]:
        """The same step in equal parts; whole where one of them finds no equilibrium."""
        share = replace(step.demand, increment=step.demand.increment / parts)
        state, taken = step.old, []
        for _ in range(parts):
            state, report = super().step(state, share)
            if not report.converged or report.dynamic:
                return [step]
            taken.append(self._last_to(state))
        return taken

    def _area(self, slots) -> Array:
        return np.where(slots.kind != NONE, slots.size, 0.0) * self.prepared.assembly.thickness

    def _stiff(self, law: IntArray, area: Array, column: int = KN) -> Array:
        """Stiffness [N/m]; infinite where there is no contact."""
        return self.prepared.laws[law, column] * np.where(area > 0.0, area, np.inf)

    def _stored(self, law: IntArray, area: Array, closed: Array, history: Array) -> float:
        """Of contacts that are closed elastically (n_slots,) [m], with the shear they have."""
        shear = np.sum(history[:, SHEAR:] ** 2, axis=1) / self._stiff(law, area, KS)
        return 0.5 * float(np.sum(self.prepared.laws[law, KN] * area * closed**2) + np.sum(shear))

    def _found(self, state: EquilibriumState) -> float:
        """Of the contacts of a state as they are found there: what the next step begins with."""
        law, area, normal = state.pairs.law_of_slot, self._area(state.slots), state.reaction[:, 0]
        gap = np.where(area > 0.0, state.slots.gap, np.inf)
        pressed = np.maximum(state.history[:, DILATION] - gap, 0.0)
        closed = np.where(normal < 0.0, normal / self._stiff(law, area), pressed)
        return self._stored(law, area, closed, state.history)


def energy_of(model: ds.Model, *, parts: int = 1, **options) -> tuple[CapacityCurve, Energy]:
    """The curve of `equilibrium`, and its energy balance.

    Each step along equilibria is taken again in so many equal ``parts``, and their balances
    are added up: the forces in it are then known as often.
    """
    engine = _Watched()
    curve = ds.pushover(model, engine=engine, **options)
    total = error = released = interface = 0.0
    for step in engine.taken():
        jumps = step.demand.time_step > 0.0 or step.demand.over_fold
        for part in [step] if jumps or parts == 1 else engine.again(step, parts):
            off = abs(part.work - (part.ended - part.begun) - part.lost)
            total += abs(part.work)
            interface += part.found - part.ended
            released, error = (released + off, error) if jumps else (released, error + off)
    return curve, Energy(error / total, released / total, interface / total)


def _at(values: Array, origin: IntArray) -> Array:
    """Rows by the slots where the step began; nothing of those that were made in it."""
    return np.where((origin >= 0)[:, None], values[np.maximum(origin, 0)], 0.0)


def _lost(mean: Array, change: Array) -> Array:
    """What contacts have dissipated, by the mean of their reactions and what their history grew
    by."""
    torn = np.maximum(-mean[:, 0] * change[:, OPENED], 0.0)
    crushed = -mean[:, 0] * np.minimum(change[:, DILATION], 0.0)
    shear = np.sqrt(np.sum(mean[:, 1:] ** 2, axis=1))
    return torn + crushed + shear * np.maximum(change[:, SLID], 0.0)
