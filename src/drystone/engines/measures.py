"""What every engine reports of a step, computed in one place from poses, forces and contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import ACCELERATION_LIMIT, ACROSS_THE_LOAD, LEAST_LOAD, NAMED_MOTION
from drystone.contact import measures as kernels
from drystone.contact.contacts import Slots
from drystone.engines.base import Problem, StepReport
from drystone.law.certificate import Certificate
from drystone.law.columns import DILATION
from drystone.model.assembly import GRAVITY
from drystone.model.loading import Acting, dead_words


@dataclass(frozen=True, kw_only=True)
class StepOutcome:
    """A solved step, in arrays over all bodies and slots."""

    multiplier: float  # applied
    pose: Array  # (n, n_dof) at the end
    increment: Array  # (n, n_dof) m, rad
    acceleration: Array  # (n, n_dof) m/s2, rad/s2
    velocity: Array  # (n, n_dof) m/s, rad/s, at the end
    contact_force: Array  # (n, n_dof) N, N m, of all contacts, on fixed bodies too
    slots: Slots  # contacts in the poses at the end
    status: IntArray  # (n_slots,)
    certificate: Certificate
    motion: float  # m, of the fastest block
    n_iterations: int
    support_motion: float = 0.0  # m or rad, by which supports have moved
    #: J, by how much the work of friction changes with the load, at multiplier one, with the
    #: inertia forces as a load, and with what ``turned`` is of; zeros of engines without inertia.
    friction: Sequence[float] = (0.0, 0.0, 0.0)
    #: J, work of what forces change by as they turn with the bodies, from where the step found its
    #: balance to its end; zero where both are one.
    turned: float = 0.0


@dataclass(frozen=True, kw_only=True)
class LoadArrays:
    """Loads and masses of a problem as arrays, (n, n_dof); zero on what is fixed.

    Those of the design and of multiplier zero, or of where they were asked for, see `near`.
    """

    dead: Array  # N, N m
    pattern: Array  # N, N m, by which the load grows with the multiplier
    mass: Array  # kg, kg m2
    total: float  # N, sum of the pattern along that
    along: Array  # (dim,) that it leads along; zeros where its sum is none
    fixed: BoolArray  # (n,) supports, and blocks that have left
    acting: Acting  # what they are arrays of

    @classmethod
    def of(
        cls,
        problem: Problem,
        departed: BoolArray | None = None,
        stage: int | None = None,
    ) -> LoadArrays:
        """Those of a problem, without the blocks that are ``departed`` (n,); of the dead loads
        those up to a ``stage``."""
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
        """The same in a pose (n, n_pose), near a multiplier; see `Acting.near`."""
        if self.acting.steady:
            return self
        dead, pattern = self.acting.near(pose, multiplier)
        if self.acting.tilted is None or not self.along.any():
            return replace(self, dead=dead, pattern=pattern)
        total = float((pattern[:, : len(self.along)] @ self.along).sum())
        return replace(self, dead=dead, pattern=pattern, total=total)

    def scaled(self, share: float, before: LoadArrays | None) -> LoadArrays:
        """With a share of the dead load, or of its change from what it was ``before``."""
        if before is None:
            return replace(self, dead=share * self.dead, acting=self.acting.scaled(share))
        dead = (1.0 - share) * before.dead + share * self.dead
        return replace(self, dead=dead, acting=self.acting.after(before.acting, share))


def not_crushed(slots: Slots, history: Array) -> Slots:
    """Contacts with gaps less what has crushed them, which is no penetration.

    ``history`` (n_slots, N_HISTORY or more), see `law.columns`.
    """
    slots = slots.copied()
    slots.gap[:] -= np.minimum(history[:, DILATION], 0.0)
    return slots


def report(problem: Problem, loads: LoadArrays, outcome: StepOutcome) -> StepReport:
    """The figures of a converged step; see `CurvePoint` for their meaning.

    ``loads`` are those near where it ended.
    """
    assembly, multiplier, slots = problem.assembly, outcome.multiplier, outcome.slots
    mass = np.where(assembly.restrained, 0.0, loads.mass) if assembly.on_rollers else loads.mass
    carried, inertia, fastest, kinetic, work, push, strokes, resistance, free = kernels.sum_blocks(
        outcome.increment, outcome.acceleration, outcome.velocity, outcome.contact_force,
        outcome.certificate.touched, loads.dead, loads.pattern, mass, loads.fixed,
        loads.along, multiplier,
    )  # fmt: skip
    if assembly.on_rollers:  # what seems to be their inertia is what rollers carry
        borne = np.where(assembly.restrained, loads.mass * outcome.acceleration, 0.0)
        carried += float((borne[:, : len(loads.along)] @ loads.along).sum())
    counts = np.zeros(3, np.int64)
    penetration = kernels.count_contacts(slots, outcome.status, counts)
    n_open, n_sticking, n_sliding = counts.tolist()  # OPEN, STICKING, SLIDING
    # By how much the applied multiplier exceeds the static one, from the step's virtual work: on
    # its own motion x the structure would rest under lambda_s with F.x lambda_s = F.x lambda -
    # x.M a.  Blocks without a contact obey this whatever the multiplier, and say nothing of it.
    # Without motion along the load there is nothing to tell the two multipliers apart.
    # At rest the load is F (lambda - lambda_s) less, and M a more, than it was in the step.  With
    # it friction changes by its work r_F of one F and r_a of M a, so that
    # (F.x + r_F) (lambda - lambda_s) = x.M a + r_a.  Where r_F takes all of F.x, joints jam.
    # Forces that turn with the bodies by R up to the step's end are so much more of a load there.
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
        # A load on nothing but blocks in flight is borne by nothing.
        dynamic=fastest > ACCELERATION_LIMIT * GRAVITY or (strokes == 0.0 and free > 0.0),
    )


def _friction_of(outcome: StepOutcome, push: float, least: float) -> Sequence[float]:
    """The work of friction of a step, see `StepOutcome.friction`; zeros where joints jam."""
    of_load = outcome.friction[0]
    jams = (push + of_load) * push <= 0.0 or abs(push + of_load) <= least
    return (0.0, 0.0, 0.0) if jams else outcome.friction


def _carried(reaction: float, loads: LoadArrays, multiplier: float, excess: float) -> float:
    """The multiplier that supports carry.

    Of a pattern without a resultant they tell nothing: virtual work says what is carried, and of a
    structure from rest never more than it is pushed with.
    """
    return reaction / loads.total if loads.along.any() else multiplier - max(excess, 0.0)


def unstable_sentence(problem: Problem, motion: Array, stage: int | None = None) -> str:
    """Which blocks move under what acts in a stage, or in all, the farthest first."""
    ids, weight = problem.assembly.ids, dead_words(problem.dead_loads, stage)
    if not motion.any():
        return f"no equilibrium under the structure's {weight} was found"
    order = np.argsort(-motion, kind="stable")
    moving = [i for i in order if motion[i] > NAMED_MOTION * motion[order[0]]]
    named = ", ".join(f'"{ids[i]}" ({1000 * motion[i]:.0f} mm)' for i in moving[:5])
    more = f" and {len(moving) - 5} more" if len(moving) > 5 else ""
    return f"the structure does not stand under its {weight}: {named}{more} keep moving"
