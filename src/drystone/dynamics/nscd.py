"""Non-smooth contact dynamics: LMGC90's formulation.

One implicit Moreau-Jean step of size h from velocity v_0,

    M (v - v_0) = h (G + lambda F) + H^T p,        q <- q + h v,

with the dead load G, the load pattern F, the impulses p of the contacts, and the contact mapping H
at the start of the step.  Contact is unilateral, on an elastic joint,

    p_n / h = -k_n (g + h u_n) if this is positive, else 0,        u = H v,

with Coulomb friction on the sliding velocity u_t, without shear stiffness or dilatancy.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import say
from drystone.common.records import changed
from drystone.common.tolerances import (
    AT_REST_MOTION,
    DEAD_LOAD_TIME_STEP,
    LEAST_CLOSURE,
    LEAST_TIME_STEP,
    NSCD_RESIDUAL,
    NSCD_TOLERANCE,
)
from drystone.contact.contacts import Contacts, Pairs, Slots
from drystone.contact.forces import ActedContacts, ContactForces
from drystone.contact.histories import Histories, handed_on
from drystone.dynamics import nlgs
from drystone.dynamics.nlgs import NlgsResult, NlgsSettings
from drystone.dynamics.sweeps import ContactProblem
from drystone.engines.base import (
    TOO_FAR,
    Capabilities,
    Demand,
    Engine,
    Problem,
    StepReport,
    UnstableError,
)
from drystone.engines.departure import departing
from drystone.engines.measures import LoadArrays, StepOutcome, report, unstable_sentence
from drystone.engines.prepared import Prepared
from drystone.engines.tie_forces import JoinedTies, TieForces, TieImpulses
from drystone.geometry.motion import places, spun_by_impulses, spun_on
from drystone.law.certificate import Forces, JudgedContacts, certify
from drystone.law.residual import add_contact_forces
from drystone.law.status import status_of
from drystone.linear.block_system import BlockSystem
from drystone.model.ties import TieState


@dataclass(frozen=True, kw_only=True)
class NscdSettings:
    """Numerical settings."""

    tolerance: float = NSCD_TOLERANCE  # residual over the heaviest weight, -
    max_sweeps: int = 6000  # of Gauss-Seidel in one step
    max_motion: float = 0.5  # motion of a block in one step over the margin of contact detection
    dead_load_time_step: float = DEAD_LOAD_TIME_STEP  # s, the first one


@dataclass(frozen=True, kw_only=True)
class NscdState:
    """Poses, velocities, and the reactions with which the next step starts."""

    prepared: Prepared
    stage: int  # of the dead loads, see `Problem.stages`
    pose: Array  # (n, n_pose) m, rad
    velocity: Array  # (n, n_dof) m/s, rad/s
    increment: Array  # (n, n_dof) m, rad, of the last step
    pairs: Pairs
    slots: Slots  # contacts in `pose`
    reaction: Array  # (n_slots, dim) N
    status: IntArray  # (n_slots,)
    departed: BoolArray  # (n,) blocks that have left
    ties: TieState
    support_motion: float = 0.0  # m or rad, by which supports have moved
    acted: ActedContacts | None = None  # along normals and tangents at the start of the last step


@dataclass(frozen=True, kw_only=True, eq=False)
class System:
    """Loads, masses and linear system of the blocks that have not left, in one stage of the dead
    loads."""

    prepared: Prepared
    stage: int
    pairs: Pairs
    loads: LoadArrays
    inverse_mass: Array  # (n, n_dof) 1/kg, 1/(kg m2)
    ties: TieForces | None
    matrix: BlockSystem

    @classmethod
    def of(cls, state: NscdState) -> System:
        """Make the system that fits a state."""
        prepared, pairs = state.prepared, state.pairs
        assembly, bars = prepared.assembly, prepared.bars
        loads = LoadArrays.of(prepared.problem, state.departed, state.stage)
        ties = TieForces(bars, assembly, state.departed) if bars.n_ties else None
        joined = JoinedTies.of(ties.body, pairs.a, pairs.b) if ties else pairs
        place = places(assembly.centroid, pairs.pose)
        return cls(
            prepared=prepared,
            stage=state.stage,
            pairs=pairs,
            loads=loads,
            inverse_mass=np.where(loads.fixed[:, None], 0.0, 1.0 / assembly.inertia),
            ties=ties,
            matrix=BlockSystem(joined.a, joined.b, loads.mass, loads.fixed, place),
        )

    def fits(self, state: NscdState) -> bool:
        """Whether it is the system of a state."""
        same = self.prepared is state.prepared and self.stage == state.stage
        return same and self.pairs is state.pairs


class NscdEngine(Engine[NscdState]):
    """The engine of the module's text."""

    name = "nscd"
    capabilities = Capabilities(
        rollers=True,
        ties=True,
        moves_supports=True,
        in_own_frame=True,
        keeps_states=True,
        resumes=True,
        residual_limit=NSCD_RESIDUAL,  # the tolerance of a step, plus the rounding of its poses
    )

    def __init__(self, settings: NscdSettings | None = None) -> None:
        self.settings = settings or NscdSettings()
        #: The system of the last step, which the next step uses again if it fits its state.
        self.last: System | None = None

    def derived(self, problem: Problem) -> tuple[Prepared]:
        """See `Engine.derived`."""
        return (Prepared.of(problem, self, shear=False),)

    def start(self, problem: Problem) -> tuple[NscdState, StepReport]:
        """Find the equilibrium under the dead load; raises `UnstableError`, or `EngineError` for a
        joint law that this formulation does not have."""
        (prepared,) = self.derived(problem)
        assembly, detector = prepared.assembly, prepared.detector
        pose = assembly.design_pose()
        pairs = detector.pairs(pose)
        slots = detector.find(pairs, pose)
        state = NscdState(
            prepared=prepared,
            stage=problem.stages[0],
            pose=pose,
            velocity=assembly.no_motion(),
            increment=assembly.no_motion(),
            pairs=pairs,
            slots=slots,
            reaction=np.zeros_like(slots.normal),
            status=np.zeros(len(slots.kind), np.int64),
            departed=np.zeros(assembly.n_bodies, np.bool_),
            ties=prepared.bars.first(),
        )
        state, outcome = self._apply_dead_load(state)
        for stage in problem.stages[1:]:
            state, outcome = self._apply_dead_load(replace(state, stage=stage))
        return state, outcome

    def _apply_dead_load(self, state: NscdState) -> tuple[NscdState, StepReport]:
        h, limit = self.settings.dead_load_time_step, state.prepared.assembly.smallest_extent
        outcome = StepReport(converged=False)
        for _ in range(500):
            new, outcome = self.step(state, Demand(multiplier=0.0, time_step=h))
            if not outcome.converged:
                h *= 0.5
                if h < LEAST_TIME_STEP * self.settings.dead_load_time_step:
                    break
                continue
            state = new
            # At rest: a step from rest moves the blocks by far less than joints close.
            if outcome.motion < AT_REST_MOTION * max(outcome.penetration, LEAST_CLOSURE):
                return state, outcome
            if state.departed.any() or state.prepared.detector.travelled(state.pose).max() > limit:
                break
        motion = state.prepared.detector.travelled(state.pose)
        raise UnstableError(
            unstable_sentence(
                state.prepared.problem, state.prepared.problem.length * motion, state.stage
            )
        )

    def step(self, state: NscdState, demand: Demand) -> tuple[NscdState, StepReport]:
        """One implicit step; see `Engine.step`."""
        new, outcome = self._step(state, demand)
        if outcome.converged:
            outcome = changed(outcome, late=max(0.0, -new.ties.margin.min(initial=np.inf)))
        if outcome.converged and outcome.dynamic and demand.multiplier is not None:
            prepared = new.prepared
            left = departing(
                prepared.problem, prepared.detector, self._system_of(new).loads, new.pose,
                demand.multiplier, new.pairs, new.slots, new.reaction,
                prepared.bars.whole(new.ties),
            )  # fmt: skip
            new = self._paired(new, new.departed | left) if left.any() else new
        return new, outcome

    def _step(self, state: NscdState, demand: Demand) -> tuple[NscdState, StepReport]:
        if demand.settlement is not None:
            demand = replace(demand, multiplier=0.0)
        if demand.multiplier is None or not demand.time_step > 0.0:
            raise ValueError("the nscd engine steps under a multiplier, with a time step")
        state = self._refresh(state)
        own = self._system_of(state)
        h, problem = demand.time_step, self._contact_problem(own, state)
        before = np.zeros_like(state.velocity) if demand.stop_blocks else state.velocity
        before = spun_on(before, state.increment, state.prepared.assembly.mass, h)
        given, guess = self._given(state, demand.settlement or 0.0) / h, state.increment / h
        before = np.where(np.any(given, axis=1, keepdims=True), given, before)
        guess[own.loads.fixed] = given[own.loads.fixed]
        loads = own.loads.near(state.pose, demand.multiplier)
        load = loads.dead + demand.multiplier * loads.pattern
        scale = state.prepared.assembly.heaviest_weight
        tolerance = self.settings.tolerance * scale
        ties = self._ties(own, state, h)
        solved = nlgs.solve(
            problem, own.matrix, state.prepared.extent,
            before + h * own.inverse_mass * load,
            state.reaction[problem.contacts.slot] * h, guess, h,
            NlgsSettings(tolerance=tolerance, max_sweeps=self.settings.max_sweeps), ties,
        )  # fmt: skip
        motion, reason = state.prepared.detector.farthest(h * solved.velocity), ""
        if solved.residual > tolerance:
            share = solved.residual / scale
            reason = say("end.sweeps", residual=float(share), n=solved.n_sweeps)
        elif motion > self.settings.max_motion * state.prepared.detector.margin:
            reason = TOO_FAR
        if reason:
            return state, StepReport(
                converged=False,
                reason=reason,
                motion=motion,
                dynamic=reason == TOO_FAR,
                n_iterations=solved.n_sweeps + solved.n_corrections,
            )
        return self._accept(own, state, problem, solved, before, load, motion, demand, ties)

    def _given(self, state: NscdState, amount: float) -> Array:
        """Prescribed increments (n, n_dof) of supports that move on by an ``amount`` [m or rad]."""
        assembly, settlement = state.prepared.assembly, state.prepared.problem.settlement
        if settlement is None or not amount:
            return assembly.no_motion()
        return settlement.increment(assembly, state.pose, state.support_motion + amount)

    def _ties(self, own: System, state: NscdState, h: float) -> TieImpulses | None:
        """The ties at the start of a step of ``h`` [s]; None if there are none."""
        if own.ties is None:
            return None
        own.ties.begin(state.prepared.bars.torn(state.ties))
        own.ties.act(state.pose)
        return TieImpulses(own.ties, state.pairs.a, state.pairs.b, h)

    def _contact_problem(self, own: System, state: NscdState) -> ContactProblem:
        """The contacts at the start of a step, as a problem for the solver."""
        contacts = state.prepared.detector.pack(
            state.pairs, state.pose, state.slots, state.prepared.laws
        )
        return ContactProblem(contacts, state.slots.gap[contacts.slot], own.inverse_mass)

    def _accept(
        self,
        own: System,
        state: NscdState,
        problem: ContactProblem,
        solved: NlgsResult,
        before: Array,
        load: Array,
        motion: float,
        demand: Demand,
        ties: TieImpulses | None,
    ) -> tuple[NscdState, StepReport]:
        """The state to which a step has led, from velocities ``before`` (n, n_dof); its report."""
        assert demand.multiplier is not None
        loads = own.loads.near(state.pose, demand.multiplier)
        h, chosen = demand.time_step, problem.contacts.slot
        increment = h * solved.velocity
        pose = state.prepared.assembly.moved(state.pose, increment)
        velocity = spun_by_impulses(solved.velocity, before, state.prepared.assembly.mass, h)
        new, reaction = self._arrive(state, pose, velocity, chosen, solved.impulse / h)
        force, there = np.zeros_like(increment), np.zeros_like(increment)
        add_contact_forces(problem.contacts, reaction[chosen], force)
        add_contact_forces(self._acted(new), reaction[chosen], there)
        if ties and own.ties:
            self._pull(own.ties, ties, solved.velocity, pose, force, there)
            new = replace(new, ties=own.ties.ended(yields=False))  # yielding is solved for
        acceleration = (solved.velocity - before) / h
        inertia = loads.mass * acceleration
        certificate = certify(
            JudgedContacts.of_impulses(
                problem.contacts, problem.gap, solved.velocity, reaction[chosen], h
            ),
            Forces(contact=force, load=load, inertia=inertia),
            state.prepared.extent,
            loads.fixed,
        )
        certificate = own.ties.marked(certificate) if own.ties else certificate
        at_end = own.loads.near(pose, demand.multiplier)
        turned = there - force + at_end.dead + demand.multiplier * at_end.pattern - load
        turned[loads.fixed | ~certificate.touched] = 0.0
        outcome = StepOutcome(
            multiplier=demand.multiplier,
            friction=nlgs.friction_work(
                problem, own.matrix, solved, (loads.pattern, inertia, turned), h, ties
            ),
            turned=float((turned * increment).sum()),
            pose=pose,
            increment=increment,
            acceleration=acceleration,
            velocity=solved.velocity,
            contact_force=force,
            slots=new.slots,
            status=new.status,
            certificate=certificate,
            motion=motion,
            n_iterations=solved.n_sweeps + solved.n_corrections,
            support_motion=state.support_motion + (demand.settlement or 0.0),
        )
        new = replace(new, support_motion=outcome.support_motion)
        return new, report(state.prepared.problem, loads, outcome)

    def _pull(
        self,
        ties: TieForces,
        impulses: TieImpulses,
        velocity: Array,
        pose: Array,
        force: Array,
        there: Array,
    ) -> None:
        """Add the forces of ties as the step was solved to ``force``, and those in the poses at its
        end to ``there``, (n, n_dof) each."""
        impulses.act(velocity)
        pulled = np.zeros_like(force)
        impulses.add_to(pulled)
        force += pulled / impulses.h
        ties.act(pose)
        ties.add_to(there)

    def _refresh(self, state: NscdState) -> NscdState:
        """The state with new pairs, if the blocks have moved far."""
        if state.prepared.detector.outdated(state.pairs.pose, state.pose):
            state = self._paired(state, state.departed)
        return state

    def _system_of(self, state: NscdState) -> System:
        """The linear system that fits a state: that of the last step, or a new one."""
        if self.last is None or not self.last.fits(state):
            self.last = System.of(state)
        return self.last

    def _paired(self, state: NscdState, departed: BoolArray) -> NscdState:
        """The state with new pairs, without the blocks that are ``departed``."""
        pairs = state.prepared.detector.pairs(state.pose, departed)
        detector = state.prepared.detector
        past = self._past(state.slots, state.reaction)
        past = handed_on(detector.narrow, past, pairs, former=state.pairs)
        slots = detector.find(pairs, state.pose, past.slots)
        reaction = handed_on(detector.narrow, past, pairs, slots).reaction
        return replace(
            state,
            velocity=np.where(departed[:, None], 0.0, state.velocity),
            increment=np.where(departed[:, None], 0.0, state.increment),
            pairs=pairs,
            slots=slots,
            reaction=reaction,
            status=self._status(state.prepared, pairs, reaction),
            departed=departed,
        )

    def _arrive(
        self, state: NscdState, pose: Array, velocity: Array, chosen: IntArray, found: Array
    ) -> tuple[NscdState, Array]:
        """The state at the end of a step, with contacts found anew that inherit their reactions.

        Returns the state, and the reactions of the step listed by the slots at its start.
        """
        reaction = np.zeros_like(state.reaction)
        reaction[chosen] = found
        followed = Slots.empty(len(reaction), state.slots.dim)
        state.prepared.detector.follow(state.pairs, pose, state.slots, followed)
        followed.frame[:] = state.slots.frame
        slots = state.prepared.detector.find(state.pairs, pose, state.slots)
        # Tangents at the start of the step are near enough, because these reactions are only the
        # start of the next step's iteration.
        past, narrow = self._past(state.slots, reaction), state.prepared.detector.narrow
        carried = handed_on(narrow, past, state.pairs, slots).reaction
        new = NscdState(
            prepared=state.prepared,
            stage=state.stage,
            pose=pose,
            velocity=velocity,
            increment=state.prepared.assembly.difference(pose, state.pose),
            pairs=state.pairs,
            slots=slots,
            reaction=carried,
            status=self._status(state.prepared, state.pairs, carried),
            departed=state.departed,
            ties=state.ties,
            acted=ActedContacts(
                pairs=state.pairs,
                slots=followed,
                reaction=reaction,
                status=self._status(state.prepared, state.pairs, reaction),
            ),
        )
        return new, reaction

    def _acted(self, state: NscdState) -> Contacts:
        """The contacts of the step, in the poses at its end."""
        these = state.acted
        assert these is not None
        return state.prepared.detector.pack(
            these.pairs, state.pose, these.slots, state.prepared.laws
        )

    def _past(self, slots: Slots, reaction: Array) -> Histories:
        """Contacts with reactions (n_slots, dim) [N]; this engine keeps no other history."""
        n = len(reaction)
        return Histories.own(slots, np.zeros((n, 0)), reaction, np.zeros(n, np.int64))

    def _status(self, prepared: Prepared, pairs: Pairs, reaction: Array) -> IntArray:
        """Status (n_slots,) of contacts with these reactions."""
        status = np.empty(len(reaction), np.int64)
        status_of(pairs, prepared.laws, reaction, status)
        return status

    def departed(self, state: NscdState) -> BoolArray:
        """Blocks (n,) that have left."""
        return state.departed

    def ties_of(self, state: NscdState) -> TieState:
        """The ties of a state, with their forces."""
        return state.ties

    def contacts(self, state: NscdState) -> ContactForces:
        """Contact points and reactions of a state: those which balance the loads."""
        these = state.acted or state
        return state.prepared.detector.forces(
            these.pairs, state.pose, these.slots, these.reaction, these.status
        )
