"""Collapse by limit analysis: model x flow -> multiplier, mechanism, contact forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array
from drystone.common.tolerances import UPRIGHT
from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.geometry.motion import moved_points
from drystone.limit import associative as bounds
from drystone.limit.cones import least_normal
from drystone.limit.crushing import n_points
from drystone.limit.edges import Edges
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.flows import ASSOCIATIVE, FLOWS, NON_ASSOCIATIVE
from drystone.limit.joints import ContactPoints, contact_points
from drystone.limit.non_associative import (
    NonAssociativeSettings,
    Paths,
    State,
    flow_tangent,
    follow_paths,
    lower_bound,
    strength_violation,
)
from drystone.limit.program import OPTIMAL, UNBOUNDED, Answer
from drystone.model.assembly import Assembly, crushes
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern, dead_words, stages_of
from drystone.model.model import Model

#: Forces below this share of the heaviest weight count as zero.
NO_FORCE = 1e-7
#: Blocks slower than this share of the fastest count as at rest in a mechanism.
AT_REST = 1e-6
#: The same for a fall under the dead load, which is found to 1e-8 at best, and less precisely where
#: it is just beginning.
FALLING = 1e-3
#: Default number of paths to non-associative states, for small and for large structures; and the
#: number of blocks from which a structure is large, by the dimension.  It also is from
#: `FEW_FROM_POINTS` contact points on, which joints that may be crushed have many of: with 8,700
#: points in space eight paths take 50 s, with 36,000 six minutes.
MANY, FEW, FEW_FROM, FEW_FROM_POINTS = 8, 1, {2: 200, 3: 50}, 5000
#: Relative difference of multipliers below which a sentence counts them as equal.
DIFFERENT = 1e-4
#: Relative difference below which two states have the same multiplier: the accuracy in space.
SAME_STATE = 3e-7
#: Largest number of solutions for a rotated load; and the relative change of the multiplier below
#: which it has converged: its accuracy, which for non-associative ones in space is some 3e-7.
TILTS, SAME_TILT = 60, {ASSOCIATIVE: 1e-9, NON_ASSOCIATIVE: 1e-6}
#: Factor by which the ground is turned farther if strengths grow as fast.
FARTHER = 10.0
#: Blocks named in a sentence.
MOST_NAMES = 8


@dataclass(frozen=True, kw_only=True, repr=False)
class Collapse:
    """Result of limit analysis.

    ``status`` is "finished", "bracketed" (no collapse state was found, but all states lie within
    ``collapse_range``), "unstable" (the structure does not stand under its own weight),
    "locked" (no multiple of the load brings it down) or "failed"; ``reason`` says it in a
    sentence.
    """

    flow: str
    load_multiplier: float
    """Collapse multiplier; the lowest of several states; nan if the status is bracketed, unstable
    or failed, inf if it is locked."""
    collapse_range: tuple[float, float]
    """Lowest and highest multiplier of all collapse states that were found.  If the status is
    bracketed, bounds between which all collapse states lie."""
    upper_bound: float
    """Upper bound of the multiplier of any structure of these blocks in its designed shape.  It is
    the associative multiplier; if blocks meet at corners (`limit.edges`), with all that these can
    carry.  It is inf if friction may carry any multiple."""
    status: str
    reason: str
    velocities: Array
    """Mechanism, (n, n_dof) [m, rad]: rates of motion, in space with rotations about the axes of
    the world; the fastest vertex has 1."""
    contacts: ContactForces | None
    """Contact forces at collapse; None if there is no collapse state."""
    moving: tuple[str, ...]
    """Blocks that move in the mechanism."""
    duality_gap: float
    """Difference of the multipliers by the power of the mechanism and by the forces, over the
    latter, or over 1 if that is larger."""
    residual: float
    """Largest unbalanced force or moment on a block, over the heaviest weight (times its size)."""
    friction_violation: float
    """Largest excess over the joint law, over the heaviest weight."""
    dilatancy_violation: float
    """Largest deviation from the flow rule, over the velocity of the fastest contact: closing of a
    contact, or opening of a contact that carries force."""
    n_iterations: int
    """Non-associative: programs and factorisations of all paths; associative: iterations of the one
    program."""
    tie_forces: Array | None = None
    """Forces of ties at collapse, (n_ties,) [N], tension positive; None if there are no ties."""
    n_paths: int = 1
    """Paths that ended in a certified collapse state."""

    def __repr__(self) -> str:
        low, high = (f"{one:.4f}" for one in self.collapse_range)
        between = f" ({low} to {high})" if high != low else ""
        return (
            f"<Collapse {self.flow}: multiplier {self.load_multiplier:.4f}{between}, "
            f"{len(self.moving)} blocks move, status {self.status}>"
        )

    def _repr_html_(self) -> str:
        """A small table, for notebooks; `plot_mechanism` draws the mechanism on the model."""
        from drystone.report.notebook import table

        low, high = self.collapse_range
        facts = {
            "flow": self.flow,
            "multiplier": f"{self.load_multiplier:.4f}",
            "range": f"{low:.4f} to {high:.4f}",
            "blocks that move": ", ".join(self.moving) or "none",
            "status": self.status,
            "reason": self.reason,
        }
        return table(facts)


def collapse_load(
    model: Model,
    *,
    flow: str = NON_ASSOCIATIVE,
    settings: NonAssociativeSettings | None = None,
) -> Collapse:
    """Collapse multiplier and mechanism of a model by limit analysis of rigid blocks.

    Parameters
    ----------
    model
        Its joints need no stiffness.
    flow
        "non-associative": joints slide with their own dilatancy angle, usually 0.
        "associative": joints slide with a dilatancy angle that equals the friction angle, which
        gives an upper bound.
    settings
        Settings of the non-associative scheme.  The default is eight paths, but one path from 200
        blocks on, in space from 50 on, because a path then takes seconds.

    Raises
    ------
    ValueError
        There is no flow rule of this name.
    """
    if flow not in FLOWS:
        raise ValueError(f'there is no flow "{flow}": take {" or ".join(FLOWS)}')
    (result,) = collapse_loads(model, flows=(flow,), settings=settings)
    return result


def collapse_loads(
    model: Model,
    *,
    flows: Sequence[str] = FLOWS,
    settings: NonAssociativeSettings | None = None,
) -> tuple[Collapse, ...]:
    """`collapse_load` for several flow rules at once, which share a part of the calculation."""
    edges = Edges.of(model.assembly)
    equilibrium = _balance(model, contact_points(model.assembly, edges=edges))
    if model.settlement is not None:
        return tuple(_without(equilibrium, flow, "failed", NO_LOAD) for flow in flows)
    most = None
    if edges.corner.any():
        points = contact_points(model.assembly, edges=edges, corners=True)
        most = bound_with(model, points)
    return _of_flows(model, equilibrium, flows, settings, most)


def uncrushed(model: Model) -> Collapse:
    """The associative collapse as if no joint could be crushed: a program of few points."""
    points = contact_points(model.assembly)
    points = replace(points, crushing=np.full(points.n_contacts, np.inf))
    return _of_flows(model, _balance(model, points), (ASSOCIATIVE,), None, None)[0]


def bound_with(model: Model, points: ContactPoints) -> float:
    """The associative multiplier with other contact points than those of the joints.  It is inf if
    they carry any multiple of the load, nan if the structure does not stand on them."""
    (found,) = _of_flows(model, _balance(model, points), (ASSOCIATIVE,), None, None)
    return found.load_multiplier


def _balance(model: Model, points: ContactPoints) -> Equilibrium:
    loads = model.load, model.dead_loads, model.ties
    return Equilibrium.of(model.assembly, *loads, points=points)


def _of_flows(
    model: Model,
    equilibrium: Equilibrium,
    flows: Sequence[str],
    settings: NonAssociativeSettings | None,
    most: float | None,
) -> tuple[Collapse, ...]:
    """Results for several flow rules; ``most`` is the upper bound if it is not the associative
    multiplier, else None."""
    bonds = equilibrium.cohesion.any() or equilibrium.tension.any()
    if model.load.turns_gravity and (bonds or equilibrium.untilted is not None):
        return tuple(_tilted(equilibrium, flow, settings, most) for flow in flows)
    return _collapses(equilibrium, flows, settings, most)


def _tilted(
    equilibrium: Equilibrium,
    flow: str,
    settings: NonAssociativeSettings | None,
    most: float | None,
) -> Collapse:
    """Collapse under a load that rotates, and decreases by the cosine of the angle.

    Relative to this load, strengths and loads that do not decrease grow with the angle.  Friction
    alone does not.  The angle of collapse is found by the secant method.
    """
    angle, before, same = 0.0, None, SAME_TILT[flow]  # the tangent of the angle
    beside = equilibrium.untilted
    for _ in range(TILTS):
        growth = float(np.hypot(1.0, angle))
        stronger = replace(
            equilibrium,
            dead=equilibrium.dead + (0.0 if beside is None else (growth - 1.0) * beside),
            cohesion=equilibrium.cohesion * growth,
            tension=equilibrium.tension * growth,
        )
        (found,) = _collapses(stronger, (flow,), settings, most)
        multiplier = found.load_multiplier
        if not np.isfinite(multiplier) or abs(multiplier - angle) <= same * abs(multiplier):
            return found
        if angle > UPRIGHT:
            return _without(equilibrium, flow, "locked", STANDS_UPRIGHT)
        slope = 0.0 if before is None else (multiplier - before[1]) / (angle - before[0])
        before = angle, multiplier
        if slope < 1.0:
            angle += (multiplier - angle) / (1.0 - slope)
        else:
            angle = FARTHER * multiplier
    return _without(equilibrium, flow, "failed", NO_TILT)


def _collapses(
    equilibrium: Equilibrium,
    flows: Sequence[str],
    settings: NonAssociativeSettings | None,
    most: float | None,
) -> tuple[Collapse, ...]:
    assembly = equilibrium.assembly
    dead = bounds.dead_load_factor(equilibrium)
    if dead.status != OPTIMAL:
        return tuple(_without(equilibrium, flow, "failed", NOT_SOLVED) for flow in flows)
    if dead.factor < 1.0 - bounds.WHOLE:
        falling = bounds.fall(equilibrium)
        return tuple(_unstable(equilibrium, flow, falling) for flow in flows)
    answer = bounds.collapse(equilibrium)
    if answer.status == OPTIMAL and equilibrium.loads_what_never_yields(answer.forces):
        answer = replace(answer, status=UNBOUNDED, factor=np.inf)
    settings = settings or NonAssociativeSettings(n_paths=default_paths(assembly))
    upper = answer.factor if most is None else max(answer.factor, most)
    results = []
    for flow in flows:
        if flow == ASSOCIATIVE:
            results.append(_associative(equilibrium, answer, upper))
        else:
            start = answer.forces[:, 0] if answer.status == OPTIMAL else None
            paths = follow_paths(
                equilibrium,
                associative=start,
                resting=dead.forces[:, 0],
                settings=settings,
            )
            limited = [
                state
                for state in paths.states
                if not equilibrium.loads_what_never_yields(state.forces)
            ]
            more = len(paths.states) - len(limited)
            paths = replace(paths, states=tuple(limited), n_unbounded=paths.n_unbounded + more)
            results.append(_non_associative(equilibrium, paths, settings, answer.factor, upper))
    return tuple(results)


def default_paths(assembly: Assembly) -> int:
    """Default number of paths of the non-associative scheme."""
    large = assembly.n_blocks >= FEW_FROM[assembly.dimension]
    return FEW if large or n_points(assembly) >= FEW_FROM_POINTS else MANY


NOT_SOLVED = "the program could not be solved: are blocks or strengths of extreme sizes?"
NO_LOAD = "supports move in this model, and no load grows: give a [load]"
LOCKED = (
    "no finite multiplier: friction, or what has no limit of strength, can carry any multiple of "
    "the load in this direction"
)
STANDS_UPRIGHT = (
    "no finite multiplier: bonds, ties or loads without mass hold the structure on a ground turned "
    "upright"
)
NO_TILT = f"no angle of the ground was found at which it collapses, in {TILTS} solutions"


def stands(assembly: Assembly) -> bool:
    """Whether the blocks stand under their own weight (associative joints)."""
    sideways = MassPattern(direction=np.eye(assembly.dimension)[0])
    return bounds.stands(Equilibrium.of(assembly, sideways))


@dataclass(frozen=True, kw_only=True)
class AtRest:
    """Whether a structure stands under its own weight."""

    falls: str | None
    """A sentence if it falls, else None."""
    reaction: float | None
    """Reaction of the supports, upwards [N], by forces that fulfil the joint law; None if it
    falls."""


def at_rest(model: Model) -> AtRest:
    """Whether a structure stands under its own weight and its dead loads, stage by stage: the
    reaction of the supports in the last stage, or why it falls."""
    for stage in stages_of(model.dead_loads):
        loads = tuple(load for load in model.dead_loads if load.stage <= stage)
        equilibrium = Equilibrium.of(model.assembly, model.load, loads, model.ties)
        answer = bounds.dead_load_factor(equilibrium)
        if not bounds.is_whole(answer):
            under = dead_words(model.dead_loads, stage)
            fallen = _unstable(equilibrium, ASSOCIATIVE, bounds.fall(equilibrium), under)
            return AtRest(falls=fallen.reason, reaction=None)
    fixed, points = model.assembly.fixed, equilibrium.points
    onto = fixed[points.block_a].astype(float) - fixed[points.block_b]  # of the movable block
    upward = np.einsum("kj,kji,i->k", answer.forces, points.frame, model.assembly.up)
    return AtRest(falls=None, reaction=float(onto @ upward) * equilibrium.force)


def is_locked(model: Model) -> bool:
    """Whether no multiple of the load makes the structure collapse.

    This is checked before a pushover analysis, which would only press blocks into each other.  Most
    structures are not locked because they can move as one body that friction cannot stop, which is
    checked first.  A structure is locked if friction alone can carry the load pattern, and if, in
    addition, normal forces can carry it without friction, or no path of the non-associative scheme
    finds a collapse state.  Dilatancy that ends does not lock a structure.
    """
    model = _past_dilatancy(model)
    equilibrium = Equilibrium.of(model.assembly, model.load, model.dead_loads, model.ties)
    if bounds.slides_away(equilibrium, model.load_along):
        return False
    if not bounds.is_locked(equilibrium):
        return False
    if bounds.is_locked(equilibrium, friction=False):
        return True
    few = NonAssociativeSettings(n_paths=FEW)
    return collapse_load(model, settings=few).status == "locked"


def _past_dilatancy(model: Model) -> Model:
    """The model without the dilatancy of joints whose dilatancy ends."""

    def past(law: JointLaw) -> JointLaw:
        ends = law.dilatancy_angle > 0.0 and law.dilatancy_end < np.inf
        return replace(law, dilatancy_angle=0.0, dilatancy_end=np.inf) if ends else law

    assembly = model.assembly
    laws = {pair: past(law) for pair, law in assembly.joint_between.items()}
    joint = past(assembly.joint)
    if joint is assembly.joint and all(law is assembly.joint_between[k] for k, law in laws.items()):
        return model
    return replace(model, assembly=replace(assembly, joint=joint, joint_between=laws))


def _associative(equilibrium: Equilibrium, answer: Answer, bound: float) -> Collapse:
    if answer.status != OPTIMAL:
        if answer.status == UNBOUNDED:
            return _without(equilibrium, ASSOCIATIVE, "locked", LOCKED)
        return _without(equilibrium, ASSOCIATIVE, "failed", NOT_SOLVED)
    friction = equilibrium.points.friction
    upper = bounds.upper_bound(equilibrium, answer.velocity)
    velocities = _normalised(equilibrium, answer.velocity)
    moving = _moving(equilibrium.assembly, velocities)
    return Collapse(
        flow=ASSOCIATIVE,
        load_multiplier=answer.factor,
        collapse_range=(answer.factor, answer.factor),
        upper_bound=bound,
        status="finished",
        reason=f"a mechanism of {_blocks(len(moving))} forms{_at_corners(answer.factor, bound)}",
        velocities=velocities,
        contacts=_contacts(equilibrium, answer.forces, answer.velocity),
        tie_forces=equilibrium.tie_forces(answer.forces),
        moving=moving,
        duality_gap=_relative(upper - answer.factor, answer.factor),
        residual=equilibrium.residual(answer.forces, answer.factor),
        friction_violation=strength_violation(equilibrium, answer.forces),
        dilatancy_violation=bounds.flow_violation(equilibrium, answer.velocity, friction),
        n_iterations=answer.n_iterations,
    )


def _at_corners(multiplier: float, bound: float) -> str:
    """The clause on an upper bound that differs from the associative multiplier."""
    if bound == np.inf:
        return "; load carried between blocks that meet at a corner may keep it at any multiplier"
    if not _differ(multiplier, bound):
        return ""
    return f"; load carried between blocks that meet at a corner may keep it up to {bound:.5g}"


def _non_associative(
    equilibrium: Equilibrium,
    paths: Paths,
    settings: NonAssociativeSettings,
    associative: float,
    upper: float,
) -> Collapse:
    """The result of all ``paths``.  ``associative`` is the multiplier with the same joints,
    ``upper`` the upper bound for any structure of these blocks."""
    if not paths.states:
        # If friction can carry any multiple, multipliers of paths may grow without end.
        if associative == np.inf or paths.n_unbounded:
            return _without(equilibrium, NON_ASSOCIATIVE, "locked", LOCKED)
        if not np.isfinite(associative):
            return _without(equilibrium, NON_ASSOCIATIVE, "failed", NOT_SOLVED)
        low = lower_bound(equilibrium, flow_tangent(equilibrium, settings.alpha))
        reason = (
            f"no collapse state was found; there is none below {low:.5g} (joints with as much "
            f"friction as dilatancy) and none above {associative:.5g} (associative): try more "
            "paths"
        )
        without = _without(equilibrium, NON_ASSOCIATIVE, "bracketed", reason)
        return replace(without, collapse_range=(low, associative), upper_bound=upper)
    tangent = flow_tangent(equilibrium, settings.alpha)
    state = _lowest(equilibrium, paths.states, tangent)
    highest = max(state.multiplier, *(one.highest for one in paths.states))  # but for rounding
    velocities = _normalised(equilibrium, state.velocity)
    moving = _moving(equilibrium.assembly, velocities)
    reason = f"a mechanism of {_blocks(len(moving))} forms"
    if _differ(state.multiplier, highest):
        reason += (
            f"; the multiplier is not unique: collapse states from {state.multiplier:.5g} to "
            f"{highest:.5g} were found"
        )
    if upper < np.inf and _differ(state.multiplier, upper):
        what = "associative, across corners" if _differ(associative, upper) else "associative"
        reason += f"; loaded from rest it may carry more, but at most {upper:.5g} ({what})"
    return Collapse(
        flow=NON_ASSOCIATIVE,
        load_multiplier=state.multiplier,
        collapse_range=(state.multiplier, highest),
        upper_bound=upper,
        status="finished",
        reason=reason,
        velocities=velocities,
        contacts=_contacts(equilibrium, state.forces, state.velocity),
        tie_forces=equilibrium.tie_forces(state.forces),
        moving=moving,
        duality_gap=_relative(_unbalanced_power(equilibrium, state), state.multiplier),
        residual=equilibrium.residual(state.forces, state.multiplier),
        friction_violation=strength_violation(equilibrium, state.forces),
        dilatancy_violation=_flow_deviation(equilibrium, state, tangent),
        n_iterations=paths.n_iterations,
        n_paths=len(paths.states),
    )


def _lowest(equilibrium: Equilibrium, states: Sequence[State], tangent: Array) -> State:
    """The state with the lowest multiplier; among equal ones, that with the least deviation from
    the flow rule.

    Mechanisms of the curves in `coulomb_path` deviate by their remaining smoothing, those of
    programs by rounding.
    """
    lowest = min(state.multiplier for state in states)
    same = [s for s in states if s.multiplier <= lowest + SAME_STATE * abs(lowest)]
    return min(same, key=lambda state: _flow_deviation(equilibrium, state, tangent))


def _unbalanced_power(equilibrium: Equilibrium, state: State) -> float:
    """Multiplier by the power of the state's contact forces, less the state's multiplier."""
    contact = float(np.sum(state.forces * equilibrium.relative(state.velocity)))
    dead = float(equilibrium.dead @ state.velocity)
    live = float(equilibrium.live @ state.velocity)
    return -(contact + dead) / live - state.multiplier


def _flow_deviation(equilibrium: Equilibrium, state: State, tangent: Array) -> float:
    """Largest deviation of a state from the flow rule ``tangent`` (n_contacts,).

    For contacts that close too much, it is the velocity over that of the fastest contact.  For
    contacts that open, it is the smaller of two numbers, of which one is zero in an exact state:
    the opening over the fastest contact, and the force above the least normal force over the
    heaviest weight.
    """
    relative = equilibrium.relative(state.velocity)
    largest = float(np.abs(relative).max(initial=0.0))
    if largest == 0.0:
        return 0.0
    off = (relative[:, 0] - tangent * equilibrium.slip(relative)) / largest
    force = state.forces[:, 0] - least_normal(equilibrium)
    return float(np.where(off > 0.0, np.minimum(off, np.abs(force)), -off).max(initial=0.0))


def _unstable(
    equilibrium: Equilibrium, flow: str, velocity: Array, under: str = "own weight"
) -> Collapse:
    velocities = _normalised(equilibrium, velocity)
    moving = _moving(equilibrium.assembly, velocities, FALLING)
    reason = (
        f"does not stand under its {under}: {_named(moving)} would move before any load; "
        f"support it, widen the joints or raise their {_strengths(equilibrium.assembly)}"
    )
    return _without(equilibrium, flow, "unstable", reason, velocities, moving)


def _strengths(assembly: Assembly) -> str:
    """The strengths of which joints may have too little."""
    return "friction or compressive strength" if crushes(assembly.laws) else "friction"


def _without(
    equilibrium: Equilibrium,
    flow: str,
    status: str,
    reason: str,
    velocities: Array | None = None,
    moving: tuple[str, ...] = (),
) -> Collapse:
    """A result without a multiplier."""
    value = np.inf if status == "locked" else np.nan
    return Collapse(
        flow=flow,
        load_multiplier=value,
        collapse_range=(value, value),
        upper_bound=value,
        status=status,
        reason=reason,
        velocities=equilibrium.assembly.no_motion() if velocities is None else velocities,
        contacts=None,
        moving=moving,
        duality_gap=np.nan,
        residual=np.nan,
        friction_violation=np.nan,
        dilatancy_violation=np.nan,
        n_iterations=0,
        n_paths=0,
    )


def _normalised(equilibrium: Equilibrium, velocity: Array) -> Array:
    """Velocities of all blocks, scaled so that the fastest vertex has one."""
    velocities = equilibrium.block_velocities(velocity)
    fastest = float(_speeds(equilibrium.assembly, velocities).max(initial=0.0))
    return velocities / fastest if fastest > 0.0 else velocities


def _speeds(assembly: Assembly, velocities: Array) -> Array:
    """Speed of the fastest vertex of each block, (n,)."""
    counts = np.array([len(block.vertices) for block in assembly.blocks])
    owner = np.repeat(np.arange(assembly.n_bodies), counts)
    arm = np.vstack([block.vertices for block in assembly.blocks]) - assembly.centroid[owner]
    moved = moved_points(arm, owner, np.zeros_like(assembly.centroid), velocities, linear=True)
    speeds = np.linalg.norm(moved - arm, axis=1)
    return np.asarray(np.maximum.reduceat(speeds, np.cumsum(counts) - counts))


def _moving(assembly: Assembly, velocities: Array, slowest: float = AT_REST) -> tuple[str, ...]:
    speeds = _speeds(assembly, velocities)
    return tuple(assembly.ids[i] for i in np.flatnonzero(speeds > slowest))


def _contacts(equilibrium: Equilibrium, forces: Array, velocity: Array) -> ContactForces:
    """Contact forces in newtons, with the status of each contact in the mechanism."""
    points, n = equilibrium.points, equilibrium.n_joined
    relative = equilibrium.relative(velocity)[:n]
    largest = float(np.abs(relative).max(initial=0.0))
    sliding = equilibrium.slip(relative) > AT_REST * largest
    forces = forces[:n]
    none = np.linalg.norm(forces, axis=1) <= NO_FORCE
    return ContactForces(
        block_a=points.block_a[:n],
        block_b=points.block_b[:n],
        position=points.position[:n],
        normal=points.frame[:n, 0],
        gap=np.zeros(n),
        area=points.area[:n],
        normal_reaction=forces[:, 0] * equilibrium.force,
        tangential_reaction=forces[:, 1:] * equilibrium.force,
        tangent=points.frame[:n, 1],
        status=np.where(none, OPEN, np.where(sliding, SLIDING, STICKING)),
    )


def _differ(low: float, high: float) -> bool:
    """Whether two multipliers differ enough to be printed as two."""
    return high - low > DIFFERENT * max(abs(low), 1e-3)


def _relative(difference: float, value: float) -> float:
    return abs(difference) / max(abs(value), 1.0)


def _blocks(count: int) -> str:
    return "1 block" if count == 1 else f"{count} blocks"


def _named(ids: tuple[str, ...]) -> str:
    shown = ", ".join(f'"{name}"' for name in ids[:MOST_NAMES])
    more = f" and {len(ids) - MOST_NAMES} more" if len(ids) > MOST_NAMES else ""
    return f"{'block' if len(ids) == 1 else 'blocks'} {shown}{more}" if ids else "some block"
