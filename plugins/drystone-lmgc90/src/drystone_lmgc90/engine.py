"""LMGC90 as the pushover sees it.

LMGC90 takes the step of `dynamics.nscd` with its own contact detection and Gauss-Seidel solver.
Three things are done on this side.  Corners: LMGC90 has no rounded shapes, so that a radius
becomes a chamfer with legs of that length, which has its contact points at the same places.
Certificates: LMGC90 reports no residual of the joint law, so that it is computed here from the
reactions and velocities that it returns.  And contacts that LMGC90 has lost, which it says nothing
of: supports must carry the weight before any load is applied, and penetration is found with our
own detection, step by step.

LMGC90 holds one state, the last.  A step can be taken again from where it started; older states
cannot be restored.
"""

from __future__ import annotations

import importlib.util
import itertools
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.contact.contacts import BODY_A, BODY_B, FRICTION, STIFF_N, Contacts, Pairs, Slots
from drystone.contact.detection import Detector
from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.dynamics.nlgs import natural_map
from drystone.dynamics.sweeps import ContactProblem
from drystone.engines.base import (
    Capabilities,
    Demand,
    Engine,
    EngineError,
    PreferredSteps,
    Problem,
    StepReport,
    UnstableError,
)
from drystone.engines.measures import LoadArrays, StepOutcome, report, unstable_sentence
from drystone.engines.refusal import refuse
from drystone.geometry import motion
from drystone.geometry.cores import SolidCore
from drystone.geometry.figure import Figure
from drystone.law.certificate import Forces, JudgedContacts, certify
from drystone.model.assembly import GRAVITY, Assembly, Corner
from drystone_lmgc90.messages import Outcome, Ready, Setup, Step
from drystone_lmgc90.process import Process

MISSING = (
    "LMGC90 is not installed. On Linux with Python 3.11: pip install --no-deps compas-lmgc90; "
    "elsewhere build LMGC90 with its Python package pylmgc90. The engines equilibrium, nscd and "
    "distinct need neither"
)
#: Modules of ours that drive LMGC90, by the module of LMGC90 that each needs, the better first.
DRIVERS = {"pylmgc90": "chipy", "compas_lmgc90": "wheel"}
#: Modules that run in LMGC90's process, by driver and dimension.
MODULES = {("chipy", 2): "chipy", ("wheel", 2): "prisms", ("wheel", 3): "wheel"}
#: What the supports may carry less or more than the weight, before any load.
BALANCE = 1e-3


@dataclass(frozen=True, kw_only=True)
class Lmgc90Settings:
    """Numerical settings."""

    tolerance: float = 5e-6  # of Gauss-Seidel, in LMGC90's norm "QM/16"; looser ones creep
    sweeps_per_check: int = 50
    max_sweeps: int = 25_000  # in one step
    #: Sweeps after which contacts in space are taken in another order, by chance: in LMGC90's own,
    #: a façade of 1000 points takes thirty times as many.
    scramble: int = 1
    #: In space, largest stiffness of a contact over a block's mass / h2: the time step is cut to
    #: that.  Gauss-Seidel ends by impulses, and gaps are as much less well known.
    stiffest: float = 1e3
    theta: float = 1.0  # of the theta method; 1 is the step of `dynamics.nscd`
    dead_load_time_step: float = 0.05  # s
    longest_time_step: float = 0.05  # s; a longer one that is asked for is cut to it
    max_motion: float = 0.5  # share of the detection reach a block may move in one step
    max_penetration: float = 0.05  # share of the smallest block's extent


@dataclass(frozen=True, kw_only=True, eq=False)
class Lmgc90Prepared:
    """A problem with the blocks as LMGC90 has them: forces and motions are about their centroids
    and axes."""

    problem: Problem
    detector: Detector  # of blocks with chamfers in place of rounded corners
    theirs: Assembly
    offset: Array  # (n, dim) m, from our centroids to theirs
    loads: tuple[LoadArrays, ...]  # up to each stage
    longest_time_step: float  # s

    @classmethod
    def of(cls, problem: Problem, longest_time_step: float) -> Lmgc90Prepared:
        """That of a problem which LMGC90 can solve."""
        assembly = problem.assembly
        sharp = without_radius(assembly)
        theirs = without_corners(sharp)
        mass = np.where(assembly.fixed[:, None], 0.0, theirs.mass)
        stages = [LoadArrays.of(problem, stage=stage) for stage in problem.stages]
        return cls(
            problem=problem,
            detector=Detector(sharp),
            theirs=theirs,
            offset=theirs.centroid - assembly.centroid,
            loads=tuple(replace(loads, mass=mass) for loads in stages),
            longest_time_step=longest_time_step,
        )

    @property
    def same(self) -> bool:
        """Whether their blocks are ours."""
        return self.theirs is self.problem.assembly

    @property
    def friction(self) -> float:
        """Of all joints."""
        return self.problem.assembly.joint.friction_coefficient

    @cached_property
    def extent(self) -> Array:
        """Of each block about its centroid [m], (n,), and never zero."""
        return np.maximum(self.detector.extent, 1e-12)


@dataclass(frozen=True, kw_only=True)
class Lmgc90State:
    """What came of the step that LMGC90 made last, or of the one before that."""

    prepared: Lmgc90Prepared
    stage: int  # of the dead loads: row of `Lmgc90Prepared.loads`
    number: int  # which of its steps
    pose: Array  # (n, n_pose) m, rad
    velocity: Array  # (n, n_dof) m/s, rad/s, of the blocks as LMGC90 has them
    outcome: Outcome | None


class Lmgc90Engine(Engine[Lmgc90State]):
    """See the module's text.

    Parameters
    ----------
    settings
        Numerical settings.
    driver
        "wheel" or "chipy"; by default by what is installed.
    """

    name = "lmgc90"
    # LMGC90 stops by the change between its iterations, and has been seen to leave a thirtieth.
    capabilities = Capabilities(residual_limit=0.1)

    def __init__(self, settings: Lmgc90Settings | None = None, driver: str | None = None) -> None:
        self.settings = settings or Lmgc90Settings()
        self.driver = driver or installed_driver()
        self.program = "LMGC90"
        #: LMGC90's process, and which of its steps it has made last and was told to keep.
        self._process: Process | None = None
        self._numbers = itertools.count(1)
        self._latest = self._accepted = 0
        self._pairs: Pairs | None = None  # of the last detection

    def preferred_steps(self, assembly: Assembly) -> PreferredSteps:
        """See `Engine.preferred_steps`."""
        return PreferredSteps(time_step=self._longest(assembly))

    def _longest(self, assembly: Assembly) -> float:
        """Longest time step [s]."""
        s = self.settings
        if assembly.dimension == 2:
            return s.longest_time_step
        # A point holds a quarter of a joint, whose area is about that of a face.
        area = assembly.volume[~assembly.fixed] ** (2.0 / 3.0)
        stiffness = max(law.normal_stiffness or 0.0 for law in assembly.laws) * area / 4.0
        slowest = np.sqrt(s.stiffest * assembly.mass[~assembly.fixed, 0] / stiffness)
        return float(min(s.longest_time_step, slowest.min()))

    def start(self, problem: Problem) -> tuple[Lmgc90State, StepReport]:
        """Start LMGC90 and find the equilibrium under the dead load.

        Raises
        ------
        EngineError
            The model has what LMGC90 has not, or LMGC90 has stopped, or lost contacts.
        UnstableError
            The structure does not stand.
        """
        assembly = problem.assembly
        refuse(problem, self)
        self.notes = check(assembly)
        prepared = Lmgc90Prepared.of(problem, self._longest(assembly))
        rest = assembly.design_pose()
        self._numbers = itertools.count(1)
        self._latest = self._accepted = 0
        self._pairs = prepared.detector.pairs(rest)
        self.close()
        self._process = Process(module_of(self.driver, assembly.dimension))
        ready = self._process.ask(self._setup(prepared))
        assert isinstance(ready, Ready)
        self.program = ready.program
        state = Lmgc90State(
            prepared=prepared,
            stage=0,
            number=0,
            pose=rest,
            velocity=assembly.no_motion(),
            outcome=None,
        )
        try:
            state, report = self._apply_dead_load(state)
            for stage in range(1, len(prepared.loads)):
                state, report = self._apply_dead_load(replace(state, stage=stage))
            return state, report
        except BaseException:
            self.close()
            raise

    def _setup(self, prepared: Lmgc90Prepared) -> Setup:
        assembly, theirs, s = prepared.problem.assembly, prepared.theirs, self.settings
        assert self._pairs is not None
        slots = prepared.detector.find(self._pairs, assembly.design_pose())
        stiffness = np.array([law.normal_stiffness for law in assembly.laws], dtype=float)
        joints: dict[tuple[int, int], float] = {}
        for k in np.flatnonzero(slots.kind).tolist():
            a, b, _, _, law, _ = self._pairs.which[self._pairs.of_slot[k]].tolist()
            share = stiffness[law] * slots.size[k] * assembly.thickness
            key = (min(a, b), max(a, b))
            joints[key] = joints.get(key, 0.0) + float(share)
        return Setup(
            shapes=tuple(figure.parts[0] for figure in theirs.figures),
            axes=theirs.axes,
            density=theirs.weight / (GRAVITY * theirs.volume),
            fixed=assembly.fixed,
            thickness=assembly.thickness,
            friction=prepared.friction,
            joints=joints,
            spare_stiffness=float(stiffness[0]) * self._small_area(prepared),
            reach=prepared.detector.reach,
            theta=s.theta,
            tolerance=s.tolerance,
            sweeps_per_check=s.sweeps_per_check,
            max_sweeps=s.max_sweeps,
            scramble=s.scramble if assembly.dimension == 3 else 0,
            time_step=s.dead_load_time_step,
        )

    def _apply_dead_load(self, state: Lmgc90State) -> tuple[Lmgc90State, StepReport]:
        """Steps from rest until nothing moves and the supports carry the weight."""
        assembly = state.prepared.problem.assembly
        longest = h = min(self.settings.dead_load_time_step, state.prepared.longest_time_step)
        limit = assembly.smallest_extent
        weight = -float(
            (motion.translations(state.prepared.loads[state.stage].dead) @ assembly.up).sum()
        )
        outcome = StepReport(converged=False)
        carried = 0.0
        for k in range(300):
            new, outcome = self.step(state, Demand(multiplier=0.0, time_step=h))
            if not outcome.converged:
                h *= 0.5
                if h < 1e-3 * longest:
                    raise EngineError(
                        f"LMGC90 finds no equilibrium under the weight: {outcome.reason}"
                    )
                continue
            state = new
            assert state.outcome is not None
            held = motion.translations(state.outcome.contact_force)[assembly.fixed]
            carried = -float((held @ assembly.up).sum()) / weight
            # Solved to a tolerance only, blocks that rest still tremble.
            still = 1e-2 if k < 20 else 1e-1
            at_rest = outcome.motion < still * max(outcome.penetration, 1e-9)
            if at_rest and abs(carried - 1.0) <= BALANCE:
                break
            if state.prepared.detector.travelled(state.pose).max() > limit:
                break
        if abs(carried - 1.0) > BALANCE:
            moved = state.prepared.detector.travelled(state.pose)
            raise UnstableError(
                f"LMGC90's supports carry {carried:.4f} of the weight, so that it has lost "
                f"contacts, or {unstable_sentence(state.prepared.problem, moved)}"
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
        h = min(demand.time_step, state.prepared.longest_time_step)
        accept = state.number != self._accepted
        loads = self._loads(state, demand.multiplier)
        outcome = self._process.ask(
            Step(
                accept=accept,
                force=loads.dead + demand.multiplier * loads.pattern,
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
            prepared=state.prepared,
            stage=state.stage,
            number=self._latest,
            pose=self._our_pose(state.prepared, outcome.pose),
            velocity=outcome.velocity,
            outcome=outcome,
        )
        return self._judge(state, new, before, loads, demand.multiplier, h)

    def _judge(
        self,
        state: Lmgc90State,
        new: Lmgc90State,
        before: Array,
        loads: LoadArrays,
        multiplier: float,
        h: float,
    ) -> tuple[Lmgc90State, StepReport]:
        """Everything that is reported of a step, and whether it can stand."""
        outcome = new.outcome
        assert outcome is not None
        assembly = state.prepared.problem.assembly
        increment = state.prepared.theirs.difference(outcome.pose, self._their_pose(state))
        farthest = state.prepared.detector.farthest(increment)
        if farthest > self.settings.max_motion * state.prepared.detector.reach:
            reason = "a block moves too far in one step"
            return state, StepReport(
                converged=False, reason=reason, motion=farthest, n_iterations=outcome.n_sweeps
            )
        slots = self._slots(state.prepared, new.pose)
        acceleration = (outcome.velocity - before) / h
        certificate = certify(
            self._judged(state, outcome, h),
            Forces(
                contact=outcome.contact_force,
                load=loads.dead + multiplier * loads.pattern,
                inertia=loads.mass * acceleration,
            ),
            state.prepared.extent,
            assembly.fixed,
        )
        found = report(
            state.prepared.problem,
            loads,
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
        status = self._status(state.prepared, outcome)
        return new, replace(
            found,
            n_open=int(np.count_nonzero(status == OPEN)),
            n_sticking=int(np.count_nonzero(status == STICKING)),
            n_sliding=int(np.count_nonzero(status == SLIDING)),
        )

    def _slots(self, prepared: Lmgc90Prepared, pose: Array) -> Slots:
        """All contacts in the given poses, those that LMGC90 has missed included."""
        if self._pairs is None or prepared.detector.outdated(self._pairs.pose, pose):
            self._pairs = prepared.detector.pairs(pose)
        return prepared.detector.find(self._pairs, pose)

    def _judged(self, state: Lmgc90State, outcome: Outcome, h: float) -> JudgedContacts:
        """LMGC90's own contacts, with its gaps: those that it has missed cannot be judged here."""
        theirs, mass = state.prepared.theirs, state.prepared.loads[state.stage].mass
        contacts = Contacts.empty(len(outcome.body_a), theirs.dimension, theirs.n_dof)
        contacts.which[:, BODY_A], contacts.which[:, BODY_B] = outcome.body_a, outcome.body_b
        contacts.rows[:] = self._rows(state.prepared, outcome, self._their_pose(state))
        contacts.table[:, STIFF_N] = outcome.stiffness
        contacts.table[:, FRICTION] = state.prepared.friction
        with np.errstate(divide="ignore"):
            inverse = np.where(mass > 0.0, 1.0 / mass, 0.0)
        natural_map(ContactProblem(contacts, outcome.gap, inverse), theirs.dimension, h)
        return JudgedContacts.of_impulses(
            contacts, outcome.gap, outcome.velocity, outcome.reaction, h
        )

    def _rows(self, prepared: Lmgc90Prepared, outcome: Outcome, pose: Array) -> Array:
        """Gradients of gaps and slips by the motions of both bodies; see `contact.plane.rows`."""
        dim, n_dof = prepared.theirs.dimension, prepared.theirs.n_dof
        along = np.concatenate((outcome.normal[:, None], tangents_of(outcome)), axis=1)
        centre = motion.places(prepared.theirs.centroid, pose)
        of_both = np.empty((len(along), dim, 2, n_dof))
        for side, (body, sign) in enumerate(((outcome.body_a, -1.0), (outcome.body_b, 1.0))):
            arm = outcome.position - centre[body]
            for k in range(dim):
                gradient = of_both[:, k, side]
                motion.translations(gradient)[:] = sign * along[:, k]
                moment = self._about_axes(prepared, motion.moments(arm, along[:, k]), pose, body)
                motion.rotations(gradient)[:] = sign * moment
        rows = of_both.reshape(len(along), dim, 2 * n_dof)
        return np.concatenate((rows, rows[:, 1:]), axis=1)  # slip is measured by its own gradient

    def _about_axes(
        self, prepared: Lmgc90Prepared, moment: Array, pose: Array, body: IntArray
    ) -> Array:
        """Moments (k, 1 or 3) in the world about the axes of bodies (k,) in the poses."""
        if moment.shape[1] == 1:
            return moment
        axes = [motion.rotated(prepared.theirs.axes[body, :, i], pose[body]) for i in range(3)]
        return np.stack([np.sum(axis * moment, axis=1) for axis in axes], axis=1)

    def _status(self, prepared: Lmgc90Prepared, outcome: Outcome) -> IntArray:
        """Open, sticking or sliding, as far as the solver's tolerance tells them apart."""
        normal, shear = outcome.reaction[:, 0], np.linalg.norm(outcome.reaction[:, 1:], axis=1)
        status = np.where(shear >= (1.0 - 1e-3) * prepared.friction * normal, SLIDING, STICKING)
        status[normal <= 0.0] = OPEN
        return status.astype(np.int64)

    def contacts(self, state: Lmgc90State) -> ContactForces:
        """Contact points and reactions of a state, where LMGC90 has them."""
        outcome = state.outcome
        if outcome is None:
            raise EngineError("LMGC90 has made no step yet")
        laws = state.prepared.problem.assembly.laws
        index = state.prepared.problem.assembly.law_index(outcome.body_a, outcome.body_b)
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
            tangent=outcome.tangent,
            status=self._status(state.prepared, outcome),
        )

    def close(self) -> None:
        """End LMGC90's process."""
        if self._process is not None:
            self._process.close()
            self._process = None

    @staticmethod
    def _small_area(prepared: Lmgc90Prepared) -> float:
        """Area [m2] that joints are taken to have where none is designed."""
        assembly = prepared.problem.assembly
        across = assembly.thickness if assembly.dimension == 2 else assembly.smallest_extent
        return assembly.smallest_extent * across

    def _their_pose(self, state: Lmgc90State) -> Array:
        """Poses of the blocks as LMGC90 has them."""
        return state.prepared.theirs.design_pose() if state.outcome is None else state.outcome.pose

    def _our_pose(self, prepared: Lmgc90Prepared, theirs: Array) -> Array:
        """Poses of our centroids, which the corners may have moved, from those of LMGC90's."""
        pose = theirs.copy()
        motion.translations(pose)[:] -= motion.rotated(prepared.offset, theirs) - prepared.offset
        return pose

    def _loads(self, state: Lmgc90State, multiplier: float) -> LoadArrays:
        """Loads about the centroids and axes of the blocks as LMGC90 has them."""
        loads = state.prepared.loads[state.stage].near(state.pose, multiplier)
        if state.prepared.same:
            return loads
        dead, pattern = (
            self._about_theirs(state.prepared, force, state.pose)
            for force in (loads.dead, loads.pattern)
        )
        return replace(loads, dead=dead, pattern=pattern)

    def _about_theirs(self, prepared: Lmgc90Prepared, force: Array, pose: Array) -> Array:
        shifted = force.copy()
        arm, every = motion.rotated(prepared.offset, pose), np.arange(len(force))
        moment = motion.moments(arm, motion.translations(force))
        own = motion.rotations(force)
        if force.shape[1] == 6:
            change = np.einsum("nki,nkj->nij", prepared.theirs.axes, prepared.problem.assembly.axes)
            own = np.einsum("nij,nj->ni", change, own)
        motion.rotations(shifted)[:] = own - self._about_axes(prepared, moment, pose, every)
        return shifted


def tangents_of(outcome: Outcome) -> Array:
    """Along which tangential reactions are counted, (n_contacts, dim - 1, dim)."""
    normal = outcome.normal
    if normal.shape[1] == 2:
        return np.column_stack((normal[:, 1], -normal[:, 0]))[:, None]
    return np.stack((outcome.tangent, np.cross(normal, outcome.tangent)), axis=1)


def lower_first(outcome: Outcome) -> Outcome:
    """The same contacts with the block of the lower row as a, as our own detection has them.

    Seen from the other block normal, first tangent and reaction change sign, so that the components
    along these stay; that along the second tangent, their cross product, does not.
    """
    turned = outcome.body_a > outcome.body_b
    reaction = outcome.reaction.copy()
    reaction[turned, 2:] *= -1.0
    return replace(
        outcome,
        body_a=np.where(turned, outcome.body_b, outcome.body_a),
        body_b=np.where(turned, outcome.body_a, outcome.body_b),
        normal=np.where(turned[:, None], -outcome.normal, outcome.normal),
        tangent=np.where(turned[:, None], -outcome.tangent, outcome.tangent),
        reaction=reaction,
    )


def installed_driver() -> str:
    """The driver for the LMGC90 that is installed; raises `EngineError` where there is none."""
    for module, driver in DRIVERS.items():
        if importlib.util.find_spec(module) is not None:
            return driver
    raise EngineError(MISSING)


def module_of(driver: str, dimension: int) -> str:
    """What runs in LMGC90's process; the full LMGC90 leaves space to the wheel."""
    if (driver, dimension) in MODULES:
        return MODULES[driver, dimension]
    if importlib.util.find_spec("compas_lmgc90") is None:
        raise EngineError(
            "the lmgc90 engine drives pylmgc90 in the plane only; models of three dimensions need "
            "the wheel: pip install --no-deps compas-lmgc90 (Linux, Python 3.11)"
        )
    return MODULES["wheel", dimension]


def check(assembly: Assembly) -> tuple[str, ...]:
    """What LMGC90 leaves out of an assembly; raises `EngineError` for what it cannot do."""
    for law in assembly.laws:
        if law.normal_stiffness is None:
            raise EngineError("[joint] normal_stiffness is missing: the lmgc90 engine needs it")
    if len({law.friction_coefficient for law in assembly.laws}) > 1:
        raise EngineError(
            "the lmgc90 engine has one friction coefficient for all joints: give the joints the "
            "same one, or take the equilibrium, the nscd or the distinct engine"
        )
    several = np.flatnonzero(np.diff(assembly.shapes.body) == 0)
    if len(several):
        name = assembly.ids[int(assembly.shapes.body[several[0]])]
        raise EngineError(
            f'block "{name}" is of several convex parts, the lmgc90 engine has blocks of one each: '
            "take the equilibrium, the nscd or the distinct engine"
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
    return replace(assembly, corner=Corner(chamfer=assembly.corner.radius))


def without_corners(assembly: Assembly) -> Assembly:
    """Blocks of what chamfers leave, as heavy as the whole ones; the same where there are none."""
    corner = assembly.corner
    if not corner.chamfer:
        return assembly
    blocks = []
    for block, figure, weight in zip(
        assembly.blocks, assembly.figures, assembly.weight, strict=True
    ):
        core = corner.cores(figure)[0]
        faces = core.faces if isinstance(core, SolidCore) else ()
        volume = Figure.of(core.vertices, faces).volume * assembly.thickness
        blocks.append(
            replace(block, vertices=core.vertices, faces=faces, unit_weight=weight / volume)
        )
    return replace(assembly, blocks=tuple(blocks), corner=Corner())
