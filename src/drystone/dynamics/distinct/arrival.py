"""The end of cycles as a state and its report: at rest, in real motion, and within a relaxation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drystone.common.arrays import Array
from drystone.common.tolerances import NOISE, TIES_NEARER
from drystone.contact.contacts import BODY_A, BODY_B, CRUSH, SHIFT, SLOT
from drystone.contact.rows import OF_GAP
from drystone.dynamics import explicit
from drystone.dynamics.distinct.state import DistinctState
from drystone.dynamics.distinct.workspace import Workspace
from drystone.engines.base import StepPath, StepReport
from drystone.engines.measures import StepOutcome, not_crushed, report
from drystone.law.certificate import Forces, JudgedContacts, certify
from drystone.law.residual import add_contact_forces


def at_rest(state: DistinctState, work: Workspace) -> tuple[DistinctState, StepReport]:
    """The state in which all forces balance and the blocks have been stopped, and its report."""
    work.unpack()
    still = np.zeros_like(state.velocity)
    contacts, contact_force = _judged(work)
    loads = work.now
    load = loads.dead + work.multiplier * loads.pattern
    forces = Forces(contact=contact_force, load=load, inertia=still)
    new, figures = _arrive(state, work, contacts, forces, work.motion.force, still)
    # The small unbalanced forces do not count as accelerations, because the blocks are at rest.
    return new, replace(
        figures,
        static_multiplier=work.multiplier,
        inertia_ratio=0.0,
        path=StepPath(dynamic_states=tuple(work.dynamic_states)),
        dynamic=False,
    )


def in_real_motion(
    state: DistinctState, work: Workspace, n_cycles: int
) -> tuple[DistinctState, StepReport]:
    """The state in motion, and its report.  Reactions of supports and unbalanced forces are means
    over the last ``n_cycles``, because a wall vibrates."""
    work.unpack()
    motion, loads = work.motion, work.now
    load = loads.dead + work.multiplier * loads.pattern
    unbalanced = motion.mean / n_cycles
    forces = Forces(contact=unbalanced - load, load=load, inertia=motion.opposed / n_cycles)
    contacts, _ = _judged(work)
    return _arrive(state, work, contacts, forces, unbalanced, motion.velocity)


def on_the_way(work: Workspace) -> tuple[DistinctState, StepReport]:
    """A copy of the state after a cycle of a relaxation, and its report.

    The unbalanced forces of the cycle are inertia and damping.  As masses are scaled, velocities
    and kinetic energies have no meaning.  The multiplier is a mean since the last such state,
    because impacts disturb that of one cycle.
    """
    work.unpack()
    motion, loads, still = work.motion, work.now, np.zeros_like(work.motion.velocity)
    contacts, _ = _judged(work, work.gaps_before())
    load = loads.dead + work.multiplier * loads.pattern
    forces = Forces(contact=motion.force - load, load=load, inertia=motion.force)
    new, figures = _arrive(work.state, work, contacts, forces, motion.force, still)
    since = work.prepared.assembly.difference(motion.pose, work.noted)
    moved = work.prepared.detector.farthest(np.where(work.lost[:, None], 0.0, since))
    arrays = ("pose", "searched", "history", "reaction", "status")
    own = {name: getattr(new, name).copy() for name in arrays}
    new = replace(new, slots=new.slots.copied(), **own)
    multiplier = float(np.mean(work.on_the_way))
    return new, replace(figures, static_multiplier=multiplier, motion=moved, dynamic=True)


def failed(reason: str, work: Workspace, *, runs_away: bool = False) -> StepReport:
    """The report of a step that failed."""
    return StepReport(
        converged=False,
        reason=reason,
        n_iterations=work.n_cycles,
        path=StepPath(dynamic_states=tuple(work.dynamic_states)),
        dynamic=runs_away,
    )


def _judged(work: Workspace, gaps: Array | None = None) -> tuple[JudgedContacts, Array]:
    """Contacts with the reactions of the last cycle, and their forces on the bodies (n, n_dof).

    The gaps are those at the beginning of the cycle.  They are ``gaps`` (n_slots,) [m] if given;
    otherwise they are calculated from the present ones to first order in the motion of the cycle.
    The shear contains all slip.
    """
    prepared, slots, pairs = work.prepared, work.slots, work.pairs
    velocity = work.motion.velocity
    contacts = prepared.detector.pack(pairs, work.motion.pose, slots, prepared.laws)
    k, a, b = (contacts.which[:, i] for i in (SLOT, BODY_A, BODY_B))
    force = np.zeros_like(velocity)
    history, reaction = work.history[k], work.reaction[k]
    add_contact_forces(contacts, reaction, force)
    work.ties.rotate(work.motion.pose)
    work.ties.add_to(force)
    moved = work.dt * np.column_stack((velocity[a], velocity[b]))
    gap = slots.gap[k] - np.sum(contacts.rows[:, OF_GAP] * moved, axis=1)
    if gaps is not None:
        gap = gaps[k]
    if prepared.strengths.any:
        prepared.strengths.fill(pairs.law_of_slot[k], history, gap, slots.size[k], contacts.table)
        contacts.table[:, SHIFT : CRUSH + 1] *= prepared.assembly.thickness
    lighter = np.minimum(prepared.movable_weight[a], prepared.movable_weight[b])
    judged = JudgedContacts.with_history(
        contacts, gap, history, reaction, reaction[:, 1:],
        slack=NOISE * work.settings.tolerance * lighter,  # at rest
    )  # fmt: skip
    return judged, force


def _margin(work: Workspace, contacts: JudgedContacts, ties_margin: Array) -> Array:
    """Margins of the bonds, listed by slots, and of the ties, (n_slots + n_ties,)."""
    margin = np.full(len(work.slots.kind), np.inf)
    if work.prepared.brittle:
        used = contacts.contacts.slot
        law = work.pairs.law_of_slot[used]
        margin[used] = work.prepared.bond_margins(contacts, law)
    return np.concatenate((margin, TIES_NEARER * ties_margin))


def _arrive(
    state: DistinctState,
    work: Workspace,
    contacts: JudgedContacts,
    forces: Forces,
    unbalanced: Array,
    velocity: Array,
) -> tuple[DistinctState, StepReport]:
    """The state at the end of the cycles, and its report."""
    prepared, meter, pose, acting = state.prepared, work.meter, work.motion.pose, work.now
    assembly = prepared.assembly
    ties = work.ties.ended(yields=not work.real_masses, aged=work.real_masses)
    margin = _margin(work, contacts, work.ties.ended(yields=not work.real_masses).margin)
    acceleration = np.where(acting.fixed[:, None], 0.0, unbalanced / assembly.mass)
    increment = assembly.difference(pose, state.pose)
    new = DistinctState(
        prepared=prepared,
        stage=state.stage,
        pose=pose,
        velocity=velocity,
        multiplier=work.multiplier,
        pairs=work.pairs,
        slots=work.slots,
        searched=work.searched,
        history=work.history,
        reaction=work.reaction,
        status=work.status,
        increment=np.where(work.lost[:, None], 0.0, increment),
        margin=margin,
        due=np.zeros(0, np.int64),
        departed=work.lost,
        ties=ties,
        support_motion=state.support_motion,
        friction_work=state.friction_work + float(meter[explicit.FRICTION_WORK]),
        damping_work=state.damping_work + float(meter[explicit.DAMPING_WORK]),
        load_work=state.load_work + float(meter[explicit.LOAD_WORK]),
        search_work=state.search_work + work.search_work,
    )
    certificate = certify(contacts, forces, prepared.extent, acting.fixed)
    outcome = StepOutcome(
        multiplier=work.multiplier,
        pose=pose,
        increment=increment,
        acceleration=acceleration,
        velocity=velocity,
        contact_force=forces.contact,
        slots=not_crushed(work.slots, work.history) if prepared.strengths.any else work.slots,
        status=work.status,
        certificate=work.ties.marked(certificate),
        motion=prepared.detector.farthest(increment),
        n_iterations=work.n_cycles,
        support_motion=state.support_motion,
    )
    figures = report(prepared.problem, acting, outcome)
    return new, replace(figures, lost_shear=work.lost_shear / assembly.heaviest_weight)
