"""Why a curve lies above the associative multiplier: four causes, which are checked at its point.

Limit analysis bounds what rigid blocks carry at rest in their designed shape, by the joints that
they have there.  Before or at the point

1. a part has moved by itself: an event, and the multiplier is that of what stands afterwards;
2. blocks are in motion, as with `nscd`, and the multiplier follows from the motion of the step.  On
   the mechanism of limit analysis, the contact forces carry no more than the bound (see `against`);
   at rest they would carry the same multiplier on any mechanism;
3. blocks without a common joint carry each other: at corners where they meet (see `edges`), or
   because they have moved together.  Limit analysis with these contacts then gives as much;
4. otherwise blocks have moved, and with them the places of joints and weights.
"""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import IntArray
from drystone.contact.forces import ContactForces
from drystone.geometry.motion import angles_of, rotation_vectors, translations
from drystone.limit.against import carried_against
from drystone.limit.beside import exceeds
from drystone.limit.collapse import ASSOCIATIVE, NO_FORCE, bound_with, collapse_load
from drystone.limit.crushing import spread
from drystone.limit.edges import Edges
from drystone.limit.joints import ContactPoints, contact_points, joined, points_at
from drystone.model.model import Model
from drystone.results.curve import CapacityCurve, CurvePoint
from drystone.results.events import COLLAPSES, EventKind

#: Blocks that turn by t change a multiplier of sliding by (1 + mu^2) t, the slope of tan, and those
#: that move by u over blocks of size s change arms by u / s.  An excess beyond so many times that
#: has no such cause; nor has one beyond so many times what of a load is not carried, in motion.
FAR_OFF = 10.0
#: Pairs of blocks named in a sentence.
FEW = 3


def why_above(curve: CapacityCurve, model: Model, bound: float) -> str | None:
    """A sentence where the capacity of a curve lies above the bound, with its cause."""
    point = curve.capacity
    if not exceeds(point.load_multiplier, bound):
        return None
    return (
        f"the {'capacity' if curve.rises_after_collapse else curve.name_of_peak} of "
        f"{_digits(point.load_multiplier, bound)} lies above the associative collapse multiplier "
        f"{_digits(bound, point.load_multiplier)} of the structure as designed, "
        f"{_cause(curve, model, point, bound)}"
    )


def _digits(value: float, other: float) -> str:
    """As many digits as tell two numbers apart, four at least."""
    for digits in range(4, 9):
        if f"{value:.{digits}f}" != f"{other:.{digits}f}":
            break
    return f"{round(value, digits) + 0.0:.{digits}f}"


def _cause(curve: CapacityCurve, model: Model, point: CurvePoint, bound: float) -> str:
    before = [
        event
        for event in curve.events
        if event.step < point.step
        and (event.kind in COLLAPSES or event.kind is EventKind.LOSS_OF_EQUILIBRIUM)
    ]
    if before:
        return f"because {before[0].what} before it ({before[0].place}): what is left bears it"
    if curve.contacts is None:
        return (
            "because blocks have moved until then, or carry where they share no joint: contacts "
            "were not kept, which would tell"
        )
    contacts = curve.contacts[point.step]
    pose = None if curve.poses is None else curve.poses[point.step]
    mechanism = collapse_load(model, flow=ASSOCIATIVE).velocities
    carried = carried_against(model, mechanism, contacts, pose)
    if carried is not None and not exceeds(carried, bound) and _moves(point, bound):
        return (
            f"because it is read off a motion: {point.applied_multiplier:.4f} is applied there, "
            f"{100.0 * point.inertia_ratio:.2g} % of which is inertia, and on the mechanism of "
            f"limit analysis contacts carry {_digits(carried, point.load_multiplier)}"
        )
    at_corners, others = _beyond_joints(contacts, model)
    beyond = np.concatenate((at_corners, others))
    if len(beyond):
        designed = contact_points(model.assembly)
        reached = bound_with(model, joined(designed, _points(contacts, beyond, model)))
        causes = []
        if len(at_corners):
            causes.append(f"{_pairs(contacts, at_corners, model)} across a corner")
        if len(others):
            causes.append(
                f"{_pairs(contacts, others, model)} that did not touch, apart by up to "
                f"{_apart(contacts, others, model):.2g} m as designed"
            )
        carries = f"because load is carried between {' and between '.join(causes)}"
        if not exceeds(point.load_multiplier, reached):
            return f"{carries}: with these contacts limit analysis gives {reached:.4f}"
        bound = max(bound, reached)
        return f"{carries}, and {_motion(curve, model, point, bound)}"
    return f"because {_motion(curve, model, point, bound)}"


def _moves(point: CurvePoint, bound: float) -> bool:
    """Whether motion may be why a point lies above the bound: what of its load is not carried."""
    applied, multiplier = point.applied_multiplier, point.load_multiplier
    uncarried = abs(applied - multiplier) + point.inertia_ratio * abs(applied)
    return FAR_OFF * uncarried >= multiplier - bound


def _beyond_joints(contacts: ContactForces, model: Model) -> tuple[IntArray, IntArray]:
    """Rows of contacts that carry where limit analysis has no joint: of blocks that meet at a
    corner as designed, and of blocks that do not touch."""
    assembly = model.assembly
    n = assembly.n_bodies
    designed, edges = contact_points(assembly), Edges.of(assembly)
    carrying = contacts.normal_reaction > NO_FORCE * assembly.heaviest_weight
    pair = _key(contacts.block_a, contacts.block_b, n)
    joined_pair = np.isin(pair, _key(designed.block_a, designed.block_b, n))
    beyond = carrying & ~joined_pair
    corner = np.isin(pair, _key(edges.block_a, edges.block_b, n))
    return np.flatnonzero(beyond & corner), np.flatnonzero(beyond & ~corner)


def _key(a: IntArray, b: IntArray, n: int) -> IntArray:
    """One number for a pair of blocks, in either order."""
    return np.asarray(np.minimum(a, b) * n + np.maximum(a, b))


def _points(contacts: ContactForces, rows: IntArray, model: Model) -> ContactPoints:
    """Contacts of the curve as points of limit analysis, where they are then."""
    return points_at(
        model.assembly,
        blocks=(contacts.block_a[rows], contacts.block_b[rows]),
        position=contacts.position[rows],
        normal=contacts.normal[rows],
        tangent=contacts.tangents[rows, 0],
        area=contacts.area[rows],
        joint=np.full(len(rows), -1),
    )


def _pairs(contacts: ContactForces, rows: IntArray, model: Model) -> str:
    """The pairs of blocks of some contacts, those that carry most first."""
    ids = model.assembly.ids
    force: dict[tuple[str, str], float] = {}
    for i in rows:
        pair = (ids[contacts.block_a[i]], ids[contacts.block_b[i]])
        force[pair] = force.get(pair, 0.0) + contacts.normal_reaction[i]
    first = sorted(force, key=lambda pair: -force[pair])[:FEW]
    named = ", ".join(f'"{a}" and "{b}"' for a, b in first)
    if len(force) == 1:
        return f"the blocks {named}"
    more = ", ..." if len(force) > FEW else ""
    return f"{len(force)} pairs of blocks ({named}{more})"


def _apart(contacts: ContactForces, rows: IntArray, model: Model) -> float:
    """Largest gap as designed of the pairs of blocks of some contacts [m]."""
    packed, gaps = model.assembly.packed, []
    for a, b in set(zip(contacts.block_a[rows], contacts.block_b[rows], strict=True)):
        p, q = (np.flatnonzero(packed.body == block) for block in (a, b))
        p, q = np.repeat(p, len(q)), np.tile(q, len(p))
        gaps.append(-float(packed.overlap_depths(p, q).max()))
    return max(gaps)


def _motion(curve: CapacityCurve, model: Model, point: CurvePoint, bound: float) -> str:
    """How far blocks have moved and rotated from their design, as a clause."""
    if curve.poses is None:
        far = point.control_displacement
        return f"blocks have moved until then, the control point by {far:.3g} m"
    pose = curve.poses[point.step]
    far = float(np.linalg.norm(translations(pose), axis=1).max())
    turn = float(angles_of(rotation_vectors(pose)).max())
    text = (
        f"blocks have moved by up to {far:.3g} m and rotated by up to {turn:.2g} until then "
        f"(joints are pressed by up to {point.penetration:.2g} m)"
    )
    assembly = model.assembly
    friction = max(law.friction_coefficient for law in assembly.laws)
    change = (1.0 + friction**2) * turn + far / assembly.smallest_extent
    if point.load_multiplier - bound > FAR_OFF * change * max(1.0, abs(bound)):
        text = f"{text}, which is too little to be the cause: doubt this point"
    designed = contact_points(assembly)
    joint = spread(designed).joint
    many = int(np.bincount(joint[joint >= 0]).max(initial=0))
    if assembly.points < many and np.isfinite(designed.crushing).any():
        text += (
            f"; joints that are crushed have {assembly.points} contact points, where limit "
            f"analysis has {many}: see [contact] points"
        )
    return text
