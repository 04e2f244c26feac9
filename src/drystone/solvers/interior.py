"""The branches of many contacts at once: one linear step solved from its interior.

See `kernels.interior` for the equations.  A predictor with no barrier at all tells how low the next
barrier can be; the corrector that goes there uses the same factors and the second order of the
predictor (Mehrotra 1992).  The number of iterations hardly depends on that of the contacts or of
their changes.  The unknowns approach the solution as near as tells the branches, no nearer.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.kernels import block_lu, interior, joint, path
from drystone.solvers.static_step import Pace, StaticStep

Array = NDArray[np.float64]
TRACE=False
TRACE2=False
MOST=float(os.environ.get('MOST','3e3'))
RAISE=float(os.environ.get('RAISE','30'))
HOLD=float(os.environ.get('HOLD','1e-1'))
LESS=float(os.environ.get('LESS','0.25'))
LOW=float(os.environ.get('LOW','0.3'))
import os
START=float(os.environ.get('START','1'))
DAMP=int(os.environ.get('DAMP','1'))


@dataclass(frozen=True, kw_only=True)
class InteriorSettings:
    """When to stop; energies are over the energy that a mean block's weight stores in a contact."""

    target: float = 1e-22  # energy of a contact at which branches are told
    enough: float = 1e-11  # at which they are told where no lower one can be reached
    residual: float = 1e-6  # largest unbalanced force then, over a mean block's weight
    max_iterations: int = int(os.environ.get('MAXIT','100'))
    margin: float = 0.01  # share of the way to the first factor's end that is left
    shortest: float = 0.03  # share of a direction under which there is no way on, at once
    short: float = 0.1  # or so many times in a row
    patience: int = 3
    damping: float = 1e3  # 1/s2, times the mass, where there is no way on
    max_stalls: int = int(os.environ.get('MAXST','10'))


class InteriorPoint:
    """Solves linear steps of one `StaticStep`; holds their arrays."""

    def __init__(self, step: StaticStep, settings: InteriorSettings | None = None) -> None:
        self.step = step
        self.settings = settings or InteriorSettings()
        n_slots = len(step.used)
        self.inner = np.zeros((n_slots, interior.N_INNER))
        self.change = np.zeros((n_slots, interior.N_CHANGE))
        self.offset = np.zeros((n_slots, 2))
        dead = np.abs(step.constants.dead[~step.constants.fixed, :-1]).max(axis=1)
        self.weight = float(dead.mean())

    def solve(
        self, x: Array, multiplier: float, geometry: Array, pace: Pace | None, gradient: Array,
        tolerance: float,
    ) -> tuple[bool, float]:
        """Go from ``x``, moved on in place, to where the branches tell, and choose them.

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

        Returns
        -------
        Whether the branches could be told, and the multiplier.
        """
        step, settings, paced = self.step, self.settings, pace is not None
        every = step.table, step.count, step.used
        lag = pace.measure(geometry)[0] if pace else 0.0
        stiffness = float(step.table[: step.count, joint.STIFF_N].mean())
        unit = self.weight**2 / stiffness
        missing = lag - float(np.vdot(gradient, x - geometry)) if pace else 0.0
        barrier = START * (unit + 0.5 * self.weight * abs(missing))
        interior.centre(*every, step.branch, barrier, self.inner)
        columns = step.frame.columns if pace else step.frame.columns[:1]
        stalls, short, damping, needed, near = 0, 0, 0.0, settings.damping, False
        for count in range(settings.max_iterations):
            away = x - geometry
            energy = interior.respond(*every, step.branch, self.inner, step.response)
            step.assemble(x, multiplier, away)
            missing = lag - float(np.vdot(gradient, away)) if pace else 0.0
            balanced = step.residual <= settings.residual * self.weight
            near = balanced and energy <= settings.enough * unit
            if near and self._told(x, multiplier, away, tolerance):
                return True, multiplier
            if not step.factorise(pace, gradient, damping):
                return False, multiplier
            if pace:
                columns[1], columns[2] = step.frame.load, step.spring * step.frame.axis
            hold = damping and step.residual > HOLD * math.sqrt(stiffness * energy)
            by_direction, room, by_way, by_square = self._direction(
                columns, missing, energy if hold else 0.0, paced=paced, second=False
            )
            unstable = paced and not step.stable
            if not hold and not unstable:
                way = min(1.0, room)
                least = max(energy + way * (by_way + way * by_square), 0.0)
                barrier = min(max((least / energy) ** 3, 1e-3), 0.8) * energy
                by_direction, room, _, _ = self._direction(
                    columns[:1], missing, barrier, paced=paced, second=True
                )
            length = min(1.0, (1.0 - min(settings.margin, math.sqrt(energy / unit))) * room)
            if TRACE: print(f"      {count} res {step.residual:.1e} en {energy:.1e} damp {damping:.0e} len {length:.3f} dx {np.abs(columns[0]).max():.1e} {'-' if unstable else '+'} {'h' if hold else ''}")
            if unstable:
                damping = max(4.0 * damping, needed)
                short = 0
                continue
            short = short + 1 if length < settings.short else 0
            if not length > settings.shortest or short == settings.patience:
                if near and energy < 1e-13 * unit:
                    return True, multiplier
                if stalls == settings.max_stalls:
                    if TRACE2: print('   stalls', count, near, damping, energy)
                    return near, multiplier
                stalls, short = stalls + 1, 0
                if near or damping >= MOST:
                    barrier = RAISE * max(energy, barrier)
                    interior.centre(*every, step.branch, barrier, self.inner)
                    damping = min(damping, settings.damping)
                else:
                    damping = max(4.0 * damping, needed)
                continue
            if damping:
                needed = max(damping, settings.damping)
                if length > 0.9:
                    damping *= LESS
                    if damping < 1.0:
                        damping = 0.0
            x += length * columns[0]
            multiplier += length * by_direction
            interior.move(step.table, step.count, self.inner, self.change, length)
        if TRACE2: print('   max its', count, near, damping, energy)
        return near, multiplier

    def _told(self, x: Array, multiplier: float, away: Array, tolerance: float) -> bool:
        """Choose the branches; whether they leave nothing unbalanced."""
        step = self.step
        every = step.table, step.count, step.used
        interior.choose(*every, self.inner, step.branch)
        joint.respond(*every, step.branch, step.response)
        step.assemble(x, multiplier, away)
        if step.residual <= tolerance:
            return True
        interior.respond(*every, step.branch, self.inner, step.response)
        step.assemble(x, multiplier, away)
        return False

    def _direction(
        self, columns: Array, missing: float, barrier: float, *, paced: bool, second: bool
    ) -> tuple[float, float, float, float]:
        """Fill the first column and the changes; by how much the multiplier changes, the
        room, and how the energy changes on the way, see `kernels.interior.changes`.

        Further columns, where there are any, are solved for as well.
        """
        step = self.step
        pairs = step.pairs
        every = step.table, step.count, step.used, pairs.a, pairs.b, step.branch, self.inner
        columns[0] = step.force
        interior.offset(
            *every, barrier, second, self.change, step.response, self.offset, columns[0]
        )  # fmt: skip
        block_lu.solve(step.structure, step.factors, columns)
        by_direction = path.border(step.frame, columns[0], missing) if paced else 0.0
        room, by_way, by_square = interior.changes(
            *every, barrier, second, step.response, self.offset, columns[0], self.change
        )  # fmt: skip
        return by_direction, room if math.isfinite(by_direction) else 0.0, by_way, by_square
