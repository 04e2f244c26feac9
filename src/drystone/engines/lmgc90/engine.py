"""LMGC90 as the pushover sees it.

LMGC90 takes the step of `engines.nscd` with its own contact detection and Gauss-Seidel solver.
Three things are done on this side.  Corners: LMGC90 has no rounded polygons, so that a radius
becomes a chamfer with legs of that length, which has its contact points at the same places.
Certificates: LMGC90 reports no residual of the joint law, so that it is computed here from the
reactions and velocities that come back.  And contacts that LMGC90 has lost, which it says nothing
of: supports must carry the weight before any load is applied, and penetration is found with our
own detection, step by step.

LMGC90 holds one state, the last.  A step can be taken again from where it started; older states
cannot be gone back to.
"""

from __future__ import annotations

import importlib.util
import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly, Corner
from drystone.contact.certificate import Forces, JudgedContacts, certify
from drystone.contact.detection import Detector
from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.engines.base import Demand, EngineError, Problem, StepReport, UnstableError
from drystone.engines.lmgc90.messages import Outcome, Ready, Setup, Step
from drystone.engines.lmgc90.process import Process
from drystone.engines.measures import (
    LoadArrays,
    StepOutcome,
    report,
    unstable_sentence,
)
from drystone.geometry import motion, polygon
from drystone.kernels.contacts import (
    BODY_A,
    BODY_B,
    FRICTION,
    STIFF_N,
    VERTEX_B,
    Contacts,
    Slots,
)
from drystone.kernels.nlgs import ContactProblem
from drystone.kernels.rows import slot_rows
from drystone.solvers.nlgs import natural_map

Array = NDArray[np.float64]

MISSING = (
    "LMGC90 is not installed. On Linux with Python 3.11: pip install --no-deps compas-lmgc90; "
    "elsewhere build LMGC90 with its Python package pylmgc90. The engines equilibrium, nscd and "
    "distinct need neither"
)
#: Modules of ours that drive LMGC90, by the module of LMGC90 that each needs, the better first.
DRIVERS = {"pylmgc90": "chipy", "compas_lmgc90": "wheel"}
#: What the supports may carry less or more than the weight, before any load.
BALANCE = 1e-3


@dataclass(frozen=True, kw_only=True)
class Lmgc90Settings:
    """Numerical settings."""

    tolerance: float = 5e-6  # of Gauss-Seidel, in LMGC90's norm "QM/16"; looser ones creep
    sweeps_per_check: int = 50
    max_sweeps: int = 25_000  # in one step
    theta: float = 1.0  # of the theta method; 1 is the step of `engines.nscd`
    settling_time_step: float = 0.05  # s
    longest_time_step: float = 0.05  # s; a longer one that is asked for is cut to it
    max_motion: float = 0.5  # share of the detection reach a block may move in one step
    max_penetration: float = 0.05  # share of the smallest block's extent


@dataclass(frozen=True, kw_only=True)
class Lmgc90State:
    """What came of the step that LMGC90 made last, or of the one before that."""

    number: int  # which of its steps
    pose: Array  # (n, n_dof) m, rad
    velocity: Array  # (n, n_dof) m/s, rad/s
    outcome: Outcome | None


class Lmgc90Engine:
    """See the module's text.

    Parameters
    ----------
    settings
        Numerical settings.
    driver
        "wheel" or "chipy"; by default by what is installed.
    """

    name = "lmgc90"
    prescribes_displacement = False
    #: LMGC90 stops by the change between its iterations, and has been seen to leave a thirtieth.
    residual_limit = 0.1
    notes: tuple[str, ...] = ()  # what of the model LMGC90 does not represent

    def __init__(self, settings: Lmgc90Settings | None = None, driver: str | None = None) -> None:
        self.settings = settings or Lmgc90Settings()
        self.driver = driver or installed_driver()
        self.program = "LMGC90"
        self._process: Process | None = None

    def preferences(self, assembly: Assembly) -> dict[str, float]:
        """See `Engine`."""
        return {"time_step": self.settings.longest_time_step}

    def start(self, problem: Problem) -> tuple[Lmgc90State, StepReport]:
        """Start LMGC90 and settle under the dead load.

        Raises
        ------
        EngineError
            The model has what LMGC90 has not, or LMGC90 has stopped, or lost contacts.
        UnstableError
            The structure does not stand.
        """
        assembly = problem.assembly
        self.notes = check(assembly)
        self.problem = problem
        self.sharp = without_radius(assembly)
        self.detector = Detector(self.sharp)
        self.reference = np.array(
            [polygon.mass_properties(self.sharp.shapes.of(i)).centroid + assembly.centroid[i]
             for i in range(assembly.n_bodies)]
        )  # fmt: skip
        mass = np.where(assembly.fixed[:, None], 0.0, self._mass())
        self.loads = replace(LoadArrays.of(problem), mass=mass)
        self.extent = np.maximum(self.detector.extent, 1e-12)
        self.friction = assembly.joint.friction_coefficient
        self._numbers = itertools.count(1)
        self._latest = self._accepted = 0
        rest = assembly.rest_pose()
        self._pairs = self.detector.pairs(rest)
        self.close()
        self._process = Process(self.driver)
        ready = self._process.ask(self._setup(rest))
        assert isinstance(ready, Ready)
        self.program = ready.program
        state = Lmgc90State(number=0, pose=rest, velocity=np.zeros_like(rest), outcome=None)
        try:
            return self._settle(state)
        except BaseException:
            self.close()
            raise

    def _mass(self) -> Array:
        """Masses as LMGC90 has them, of outlines with their corners taken off, (n, 3)."""
        assembly = self.problem.assembly
        mass = assembly.mass.copy()
        for i in range(assembly.n_bodies):
            properties = polygon.mass_properties(self.sharp.shapes.of(i))
            mass[i, 2] = mass[i, 0] * properties.polar_moment / properties.area
        return mass

    def _setup(self, rest: Array) -> Setup:
        assembly, s = self.problem.assembly, self.settings
        polygons = tuple(
            self.sharp.shapes.of(i) + assembly.centroid[i] for i in range(assembly.n_bodies)
        )
        area = np.array([abs(polygon.signed_area(outline)) for outline in polygons])
        slots = self.detector.find(self._pairs, rest)
        stiffness = np.array([law.normal_stiffness for law in assembly.laws], dtype=float)
        joints: dict[tuple[int, int], float] = {}
        for k in np.flatnonzero(slots.kind).tolist():
            a, b, _, _, law, _ = self._pairs.which[self._pairs.of_slot[k]].tolist()
            share = stiffness[law] * slots.size[k] * assembly.thickness
            key = (min(a, b), max(a, b))
            joints[key] = joints.get(key, 0.0) + float(share)
        return Setup(
            polygons=polygons,
            density=assembly.mass[:, 0] / (area * assembly.thickness),
            fixed=assembly.fixed,
            thickness=assembly.thickness,
            friction=self.friction,
            joints=joints,
            spare_stiffness=float(stiffness[0]) * assembly.smallest_extent * assembly.thickness,
            reach=self.detector.reach,
            theta=s.theta,
            tolerance=s.tolerance,
            sweeps_per_check=s.sweeps_per_check,
            max_sweeps=s.max_sweeps,
            time_step=s.settling_time_step,
        )

    def _settle(self, state: Lmgc90State) -> tuple[Lmgc90State, StepReport]:
        """Steps from rest until nothing moves and the supports carry the weight."""
        assembly, h = self.problem.assembly, self.settings.settling_time_step
        limit = assembly.smallest_extent
        weight = float(assembly.weight[~assembly.fixed].sum())
        outcome = StepReport(converged=False)
        carried = 0.0
        for _ in range(300):
            new, outcome = self.step(state, Demand(multiplier=0.0, time_step=h))
            if not outcome.converged:
                h *= 0.5
                if h < 1e-3 * self.settings.settling_time_step:
                    raise EngineError(f"LMGC90 does not settle under the weight: {outcome.reason}")
                continue
            state = new
            assert state.outcome is not None
            carried = -float(state.outcome.contact_force[assembly.fixed, 1].sum()) / weight
            if outcome.motion < 1e-2 * max(outcome.penetration, 1e-9):
                break
            if self.detector.farthest(state.pose) > limit:
                break
        if abs(carried - 1.0) > BALANCE:
            moved = self.detector.motion(state.pose)
            raise UnstableError(
                f"LMGC90's supports carry {carried:.4f} of the weight, so that it has lost "
                f"contacts, or {unstable_sentence(assembly.ids, moved)}"
            )
        return state, outcome

    def step(self, state: Lmgc90State, demand: Demand) -> tuple[Lmgc90State, StepReport]:
        """One implicit step; see `Engine.step`."""
        if demand.multiplier is None or not demand.time_step > 0.0:
            raise ValueError("the lmgc90 engine steps under a multiplier, with a time step")
        if self._process is None:
            raise EngineError("the lmgc90 engine has been closed: start it again")
        if state.number not in (self._latest, self._accepted):
            raise EngineError("LMGC90 holds its last state only: it cannot go back further")
        h = min(demand.time_step, self.settings.longest_time_step)
        accept = state.number != self._accepted
        load = self.loads.dead + demand.multiplier * self.loads.pattern
        outcome = self._process.ask(
            Step(
                accept=accept,
                force=self._about_reference(load, state.pose),
                time_step=h,
                stop_blocks=demand.stop_blocks,
            )
        )
        assert isinstance(outcome, Outcome)
        outcome = lower_first(outcome)
        self._accepted = state.number
        self._latest = next(self._numbers)
        if not outcome.converged:
            return state, StepReport(
                converged=False,
                reason=f"LMGC90's Gauss-Seidel did not converge in {outcome.n_sweeps} sweeps",
                n_iterations=outcome.n_sweeps,
            )
        before = np.zeros_like(state.velocity) if demand.stop_blocks else state.velocity
        new = Lmgc90State(
            number=self._latest,
            pose=self._from_reference(outcome.pose),
            velocity=outcome.velocity,
            outcome=outcome,
        )
        return self._judge(state, new, before, load, demand.multiplier, h)

    def _judge(
        self,
        state: Lmgc90State,
        new: Lmgc90State,
        before: Array,
        load: Array,
        multiplier: float,
        h: float,
    ) -> tuple[Lmgc90State, StepReport]:
        """Everything that is reported of a step, and whether it can stand."""
        outcome = new.outcome
        assert outcome is not None
        assembly = self.problem.assembly
        increment = self.problem.assembly.difference(new.pose, state.pose)
        farthest = self.detector.farthest(increment)
        if farthest > self.settings.max_motion * self.detector.reach:
            reason = "a block moves too far in one step"
            return state, StepReport(
                converged=False, reason=reason, motion=farthest, n_iterations=outcome.n_sweeps
            )
        slots = self._slots(new.pose)
        acceleration = (outcome.velocity - before) / h
        certificate = certify(
            self._judged(state, outcome, h),
            Forces(
                contact=outcome.contact_force,
                load=self._about_reference(load, state.pose),
                inertia=self.loads.mass * acceleration,
            ),
            self.extent,
            assembly.fixed,
        )
        found = report(
            self.problem,
            self.loads,
            StepOutcome(
                multiplier=multiplier,
                pose=new.pose,
                increment=increment,
                acceleration=acceleration,
                velocity=outcome.velocity,
                contact_force=outcome.contact_force,
                slots=slots,
                status=np.zeros(len(slots.kind), np.int64),
                certificate=certificate,
                motion=farthest,
                n_iterations=outcome.n_sweeps,
            ),
        )
        if found.penetration > self.settings.max_penetration * assembly.smallest_extent:
            overlap = f"{1e3 * found.penetration:.1f} mm"
            reason = f"blocks overlap by {overlap}: LMGC90 has lost a contact"
            return state, replace(found, converged=False, reason=reason)
        status = self._status(outcome)
        return new, replace(
            found,
            n_open=int(np.count_nonzero(status == OPEN)),
            n_sticking=int(np.count_nonzero(status == STICKING)),
            n_sliding=int(np.count_nonzero(status == SLIDING)),
        )

    def _slots(self, pose: Array) -> Slots:
        """All contacts in the given poses, those that LMGC90 has missed included."""
        if self.detector.outdated(self._pairs, pose):
            self._pairs = self.detector.pairs(pose)
        return self.detector.find(self._pairs, pose)

    def _judged(self, state: Lmgc90State, outcome: Outcome, h: float) -> JudgedContacts:
        """LMGC90's own contacts, with its gaps: those that it has missed cannot be judged here."""
        n, a, b = len(outcome.body_a), outcome.body_a, outcome.body_b
        contacts = Contacts.empty(n, 2, state.pose.shape[1])
        contacts.which[:, BODY_A], contacts.which[:, BODY_B] = a, b
        centre = motion.places(self.reference, self._to_reference(state.pose))
        slots = Slots.empty(n, 2)
        slots.kind[:], slots.normal[:] = VERTEX_B, outcome.normal
        slots.arm_a[:], slots.arm_b[:] = (outcome.position - centre[i] for i in (a, b))
        slot_rows(slots, contacts.rows)
        contacts.table[:, STIFF_N] = outcome.stiffness
        contacts.table[:, FRICTION] = self.friction
        with np.errstate(divide="ignore"):
            inverse = np.where(self.loads.mass > 0.0, 1.0 / self.loads.mass, 0.0)
        natural_map(ContactProblem(contacts, outcome.gap, inverse), 2, h)
        return JudgedContacts.of_impulses(
            contacts, outcome.gap, outcome.velocity, outcome.reaction, h
        )

    def _status(self, outcome: Outcome) -> NDArray[np.int64]:
        """Open, sticking or sliding, as far as the solver's tolerance tells them apart."""
        normal, shear = outcome.reaction.T
        status = np.where(np.abs(shear) >= (1.0 - 1e-3) * self.friction * normal, SLIDING, STICKING)
        status[normal <= 0.0] = OPEN
        return status.astype(np.int64)

    def contacts(self, state: Lmgc90State) -> ContactForces:
        """Contact points and reactions of a state, where LMGC90 has them."""
        outcome = state.outcome
        if outcome is None:
            raise EngineError("LMGC90 has made no step yet")
        laws = self.problem.assembly.laws
        index = self.problem.assembly.law_index(outcome.body_a, outcome.body_b)
        per_area = np.array([law.normal_stiffness for law in laws], dtype=float)[index]
        return ContactForces(
            block_a=outcome.body_a,
            block_b=outcome.body_b,
            position=outcome.position,
            normal=outcome.normal,
            gap=outcome.gap,
            area=outcome.stiffness / per_area,
            normal_reaction=outcome.reaction[:, 0],
            tangential_reaction=outcome.reaction[:, 1:],
            status=self._status(outcome),
        )

    def close(self) -> None:
        """End LMGC90's process."""
        if self._process is not None:
            self._process.close()
            self._process = None

    def _offset(self, pose: Array) -> Array:
        """From our centroids to LMGC90's reference points in the given poses, (n, 2) [m]."""
        return motion.turned(self.reference - self.problem.assembly.centroid, pose)

    def _to_reference(self, pose: Array) -> Array:
        """Poses of our centroids as poses of LMGC90's reference points."""
        moved = pose.copy()
        motion.translations(moved)[:] += self._offset(pose) - self._offset(np.zeros_like(pose))
        return moved

    def _from_reference(self, pose: Array) -> Array:
        """The other way round."""
        moved = pose.copy()
        motion.translations(moved)[:] -= self._offset(pose) - self._offset(np.zeros_like(pose))
        return moved

    def _about_reference(self, force: Array, pose: Array) -> Array:
        """Forces at our centroids with their moments about LMGC90's reference points."""
        shifted = force.copy()
        shifted[:, 2] -= motion.moments(self._offset(pose), force)[:, 0]
        return shifted


def lower_first(outcome: Outcome) -> Outcome:
    """The same contacts with the block of the lower row as a, as our own detection has them.

    Seen from the other block both normal and reaction change sign, so that the components stay.
    """
    turned = outcome.body_a > outcome.body_b
    return replace(
        outcome,
        body_a=np.where(turned, outcome.body_b, outcome.body_a),
        body_b=np.where(turned, outcome.body_a, outcome.body_b),
        normal=np.where(turned[:, None], -outcome.normal, outcome.normal),
    )


def installed_driver() -> str:
    """The driver for the LMGC90 that is installed; raises `EngineError` where there is none."""
    for module, driver in DRIVERS.items():
        if importlib.util.find_spec(module) is not None:
            return driver
    raise EngineError(MISSING)


def check(assembly: Assembly) -> tuple[str, ...]:
    """What LMGC90 leaves out of an assembly; raises `EngineError` for what it cannot do."""
    for law in assembly.laws:
        if law.normal_stiffness is None:
            raise EngineError("[joint] normal_stiffness is missing: the lmgc90 engine needs it")
        if law.dilatancy_angle or law.cohesion or law.tensile_strength:
            raise EngineError(
                "the lmgc90 engine has no dilatancy, cohesion or tensile strength: set them to "
                "zero, or take the equilibrium or the distinct engine"
            )
    if len({law.friction_coefficient for law in assembly.laws}) > 1:
        raise EngineError(
            "the lmgc90 engine has one friction coefficient for all joints: give the joints the "
            "same one, or take the equilibrium, the nscd or the distinct engine"
        )
    if len(assembly.shapes.body) > assembly.n_bodies:
        raise EngineError(
            "the lmgc90 engine has blocks of one convex part each: take the equilibrium, the nscd "
            "or the distinct engine"
        )
    notes = []
    if any(law.shear_stiffness is not None for law in assembly.laws):
        notes.append("LMGC90 left the joints' shear stiffness out: its joints are rigid in shear")
    if assembly.corner.radius:
        notes.append("LMGC90 had the corners chamfered instead of rounded")
    return tuple(notes)


def without_radius(assembly: Assembly) -> Assembly:
    """The same blocks with chamfers for rounded corners, their legs as long as the radius."""
    if not assembly.corner.radius:
        return assembly
    return Assembly.build(
        assembly.blocks,
        joint=assembly.joint,
        corner=Corner(chamfer=assembly.corner.radius),
        thickness=assembly.thickness,
        joint_between=assembly.joint_between,
    )
