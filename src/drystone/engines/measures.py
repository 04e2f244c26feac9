"""The report of a step, calculated for all engines in one place from poses, forces and contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import Saying, say
from drystone.common.tolerances import ACCELERATION_LIMIT, ACROSS_THE_LOAD, LEAST_LOAD, NAMED_MOTION
from drystone.contact import measures as kernels
from drystone.contact.contacts import Slots
from drystone.engines.base import Problem, StepReport
from drystone.law.certificate import Certificate
from drystone.law.columns import DILATION
from drystone.model.assembly import GRAVITY
from drystone.model.loading import Acting, dead_words

#: Blocks that a message names, at most.
NAMED = 5


@dataclass(frozen=True, kw_only=True)
class StepOutcome:
    """A solved step, in arrays over all bodies and slots."""

    multiplier: float  # applied
    pose: Array  # (n, n_pose) m, rad, at the end
    increment: Array  # (n, n_dof) m, rad
    acceleration: Array  # (n, n_dof) m/s2, rad/s2
    velocity: Array  # (n, n_dof) m/s, rad/s, at the end
    contact_force: Array  # (n, n_dof) N, N m, of all contacts, on fixed bodies too
    slots: Slots  # contacts in the poses at the end
    status: IntArray  # (n_slots,) see `contact.forces`
    certificate: Certificate
    motion: float  # m, of the block that moved farthest
    n_iterations: int
    support_motion: float = 0.0  # m or rad, by which supports have moved
    #: Changes of the work of friction [J] by three additional loads: the load pattern at multiplier
    #: one; the inertia forces; and the changes of forces that ``turned`` refers to.  Zeros for
    #: engines without inertia.
    friction: Sequence[float] = (0.0, 0.0, 0.0)
    #: Forces turn with the bodies, from where the step balanced them to its end.  This is the work
    #: of their changes [J]; zero if the step balances forces at its end.
    turned: float = 0.0


@dataclass(frozen=True, kw_only=True)
class LoadArrays:
    """Loads and masses of a problem as arrays, (n, n_dof) unless said otherwise.

    They are those in the design at multiplier zero, or in another pose, see `near`.
    """

    dead: Array  # N, N m, dead load
    pattern: Array  # N, N m, load pattern: derivative of the load by the multiplier
    mass: Array  # kg, kg m2; zero for fixed blocks
    total: float  # N, sum of the load pattern in the direction ``along``
    along: Array  # (dim,) direction of the sum of the load pattern; zeros if the sum is zero
    fixed: BoolArray  # (n,) supports, and blocks that have left
    acting: Acting  # the loads that these arrays represent

    @classmethod
    def of(
        cls,
        problem: Problem,
        departed: BoolArray | None = None,
        stage: int | None = None,
    ) -> LoadArrays:
        """The loads of a problem, without blocks that are ``departed`` (n,), with the dead loads up
        to a ``stage`` (None: all)."""
        assembly = problem.assembly
        fixed = assembly.fixed if departed is None else assembly.fixed | departed
        acting = Acting.of(
            assembly,
            problem.load,
            problem.dead_loads,
            problem.ties,
            stage=stage,
            departed=departed,
        )
        dead, pattern = acting.near(assembly.design_pose(), 0.0)
        return cls(
            dead=dead,
            pattern=pattern,
            mass=np.where(fixed[:, None], 0.0, assembly.inertia),
            total=acting.total,
            along=acting.along,
            fixed=fixed,
            acting=acting,
        )

    def near(self, pose: Array, multiplier: float) -> LoadArrays:
        """The loads in a pose (n, n_pose), linearised at a multiplier; see `Acting.near`."""
        if self.acting.steady:
            return self
        dead, pattern = self.acting.near(pose, multiplier)
        if self.acting.tilted is None or not self.along.any():
            return replace(self, dead=dead, pattern=pattern)
        total = float((pattern[:, : len(self.along)] @ self.along).sum())
        return replace(self, dead=dead, pattern=pattern, total=total)

    def scaled(self, share: float, before: LoadArrays | None) -> LoadArrays:
        """The loads with a share of the dead load, or of its change from the loads ``before``."""
        if before is None:
            return replace(self, dead=share * self.dead, acting=self.acting.scaled(share))
        dead = (1.0 - share) * before.dead + share * self.dead
        return replace(self, dead=dead, acting=self.acting.after(before.acting, share))


def not_crushed(slots: Slots, history: Array) -> Slots:
    """A copy of the slots whose gaps do not contain closure by crushing, which is no penetration.

    ``history`` (n_slots, N_HISTORY or more), see `law.columns`.
    """
    slots = slots.copied()
    slots.gap[:] -= np.minimum(history[:, DILATION], 0.0)
    return slots


def report(problem: Problem, loads: LoadArrays, outcome: StepOutcome) -> StepReport:
    """The report of a converged step; see `CurvePoint` for the meaning of its figures.

    ``loads`` are those in the poses at the end of the step.
    """
    assembly, multiplier, slots = problem.assembly, outcome.multiplier, outcome.slots
    mass = np.where(assembly.restrained, 0.0, loads.mass) if assembly.on_rollers else loads.mass
    carried, inertia, fastest, kinetic, work, push, strokes, resistance, free = kernels.sum_blocks(
        outcome.increment, outcome.acceleration, outcome.velocity, outcome.contact_force,
        outcome.certificate.touched, loads.dead, loads.pattern, mass, loads.fixed,
        loads.along, multiplier,
    )  # fmt: skip
    if assembly.on_rollers:  # the inertia of restrained motions is the reaction of the rollers
        borne = np.where(assembly.restrained, loads.mass * outcome.acceleration, 0.0)
        carried += float((borne[:, : len(loads.along)] @ loads.along).sum())
    counts = np.zeros(3, np.int64)
    penetration = kernels.count_contacts(slots, outcome.status, counts)
    n_open, n_sticking, n_sliding = counts.tolist()  # OPEN, STICKING, SLIDING
    # Virtual work on the step's own motion x gives the static multiplier lambda_s from the applied
    # one, lambda: F.x lambda_s = F.x lambda - x.M a, with the load pattern F.
    # Blocks without a contact fulfil this at any multiplier, so they are left out.  Without motion
    # along the load, the two multipliers cannot be told apart.
    # At rest, the load is smaller by F (lambda - lambda_s), and larger by M a, than in the step.
    # Friction changes with it: its work by r_F for a load F, by r_a for a load M a.  So
    # (F.x + r_F) (lambda - lambda_s) = x.M a + r_a.  If r_F cancels F.x, joints jam.
    # Forces that turn with the bodies have changed at the step's end, as if by a further load.
    least = ACROSS_THE_LOAD * strokes
    of_load, of_inertia, of_turned = _friction_of(outcome, push, least)
    push, resistance, turned = push + of_load, resistance + of_inertia, outcome.turned + of_turned
    tells = abs(push) > least
    excess = resistance / push if tells else 0.0
    fall = turned / push if tells else 0.0
    settlement, reaction = problem.settlement, 0.0
    applied = max(abs(multiplier), LEAST_LOAD) if settlement is None else 1.0  # of the weight
    reached = problem.control_point.displacement(assembly, outcome.pose)
    if settlement is not None:
        reached = outcome.support_motion
        reaction = settlement.reaction(assembly, outcome.pose, outcome.contact_force)
    return StepReport(
        converged=True,
        applied_multiplier=multiplier,
        carried_multiplier=_carried(carried, loads, multiplier, excess),
        multiplier_at_start=multiplier - excess,
        static_multiplier=multiplier - excess - fall,
        control_displacement=reached,
        reaction=reaction,
        residual=outcome.certificate.residual / assembly.heaviest_weight,
        penetration=penetration,
        friction_violation=outcome.certificate.cone / assembly.heaviest_weight,
        energy_ratio=kinetic / work if work > 0.0 else 0.0,
        inertia_ratio=inertia / (applied * loads.total),
        acceleration=fastest / GRAVITY,
        n_open=n_open,
        n_sticking=n_sticking,
        n_sliding=n_sliding,
        motion=outcome.motion,
        n_iterations=outcome.n_iterations,
        # It also ends in motion if the load acts only on blocks without a contact.
        dynamic=fastest > ACCELERATION_LIMIT * GRAVITY or (strokes == 0.0 and free > 0.0),
    )


def _friction_of(outcome: StepOutcome, push: float, least: float) -> Sequence[float]:
    """The changes of the work of friction, see `StepOutcome.friction`; zeros if joints jam."""
    of_load = outcome.friction[0]
    jams = (push + of_load) * push <= 0.0 or abs(push + of_load) <= least
    return (0.0, 0.0, 0.0) if jams else outcome.friction


def _carried(reaction: float, loads: LoadArrays, multiplier: float, excess: float) -> float:
    """The carried multiplier.

    If the load pattern has no resultant, the reaction of the supports tells nothing.  Then the
    multiplier follows from virtual work; it never exceeds the applied one, because the structure
    starts from rest.
    """
    return reaction / loads.total if loads.along.any() else multiplier - max(excess, 0.0)


def unstable_sentence(problem: Problem, motion: Array, stage: int | None = None) -> Saying:
    """The message that blocks move under the dead loads of a stage, or of all; it names the blocks
    that move farthest.  ``motion`` (n,) [m]."""
    ids, weight = problem.assembly.ids, dead_words(problem.dead_loads, stage)
    if not motion.any():
        return say("end.none_found", weight=weight)
    order = np.argsort(-motion, kind="stable")
    moving = [i for i in order if motion[i] > NAMED_MOTION * motion[order[0]]]
    named = ", ".join(f'"{ids[i]}" ({1000 * motion[i]:.0f} mm)' for i in moving[:NAMED])
    if len(moving) > NAMED:
        more = len(moving) - NAMED
        return say("end.does_not_stand_more", weight=weight, blocks=named, n=more)
    key = "end.does_not_stand_one" if len(moving) == 1 else "end.does_not_stand"
    return say(key, weight=weight, blocks=named)
