"""What the work of the loads became in the real motion of the distinct element engine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.dynamics import explicit
from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.state import DistinctState
from drystone.dynamics.distinct.workspace import Workspace
from drystone.law.columns import KN, KS


@dataclass(frozen=True, kw_only=True)
class Energy:
    """What the work of the loads since the start became, in J."""

    kinetic: float
    elastic: float
    friction: float
    damping: float
    search: float
    load_work: float

    @property
    def defect(self) -> float:
        """What the books miss: an error of the time integration."""
        return self.load_work - (
            self.kinetic + self.elastic + self.friction + self.damping + self.search
        )


def energy_of(engine: DistinctEngine, state: DistinctState) -> Energy:
    """The books of energy at a state that came of real motion, with masses unscaled.

    Velocities are half a time step behind the pose: one cycle more, on a copy, gives those at half
    a step after it, and the shear of the joints in it.
    """
    work = Workspace(engine.settings, state, real_masses=True)
    before = work.motion.velocity.copy()
    work.cycle_once()
    k = slice(0, work.n_contacts)
    reaction, law = work.contacts.reaction[k], work.contacts.law[k]
    stiffness = law[:, [KN] + [KS] * (reaction.shape[1] - 1)]
    velocity = 0.5 * (before + work.motion.velocity)
    return Energy(
        kinetic=0.5 * float(np.sum(work.acting.mass * velocity**2)),
        elastic=0.5 * float(np.sum(reaction**2 / stiffness)),
        friction=state.friction_work + float(work.meter[explicit.FRICTION_WORK]),
        damping=state.damping_work + 0.5 * float(work.meter[explicit.DAMPING_WORK]),
        search=state.search_work,
        load_work=state.load_work,
    )
