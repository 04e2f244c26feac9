"""Shapes of a mechanism along its curve, and how much mass takes part in each.

Three shapes are in use: the initial mechanism, which codes keep all along the curve and count on
the undeformed structure; the secant, u(d_C)/d_C; the tangent, du/dd_C.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from drystone.assessment.capacity import Participation, participation
from drystone.assessment.errors import AssessmentError, UnfinishedError
from drystone.assessment.mechanism.bodies import AT_REST, SAME, find_macro_blocks
from drystone.assessment.mechanism.field import VelocityField, chord, less
from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import said_end, said_status, say
from drystone.common.tolerances import ROUNDING
from drystone.geometry import motion
from drystone.model.assembly import GRAVITY, Assembly
from drystone.model.loading.base import masses_of
from drystone.model.model import Model
from drystone.results.curve import FINISHED, PASSED, STATIC, CapacityCurve

#: Points over which a tangent is taken: single increments may be of a size with their errors.
POINTS = 6
#: Share of a peak down to which the multiplier falls where its mechanism has formed: a strength is
#: exhausted by convention where a fifth of it is lost (EC8-3, NTC 2018 7.8.2.2).
FORMED = 0.8
#: Secant stiffness over the first one from which on joints count as closed: in a mechanism that has
#: formed it is smaller by orders of magnitude.
STILL_STIFF = 0.5
#: Points after the peak that the initial mechanism is read from at least, where there are as many.
FEWEST = 3
#: Motion of a block in a jump, over the smallest block, after which the mechanism is read there.
FAR = 0.01
#: Velocity of the control point, over that of the fastest block, with which it takes no part.
HARDLY = 0.01
#: Share of the peak up to which displacements are those of joints that are closed.
ELASTIC = 0.2
#: Points of a course along the curve, about.
MOST = 60


@dataclass(frozen=True, kw_only=True, eq=False)
class MechanismShape:
    """The mechanism at a place of the curve: who moves, with whom, and how fast."""

    field: VelocityField  # over the velocity of the control point
    labels: IntArray  # (n,) macro-block of each block, -1 at rest
    delta: Array  # (n,) shape: velocity along the load
    mass: Array  # (n,) kg
    bodies: Participation  # of macro-blocks
    blocks: Participation  # of moving blocks, one by one
    kinetic_ratio: float  # c, of the whole structure, rotations included
    torsion: float  # velocity of the fastest point by rotation out of the plane of the load
    clause: str  # how it was read off, the end of a sentence

    @property
    def n_bodies(self) -> int:
        """Macro-blocks."""
        return int(self.labels.max(initial=AT_REST)) + 1

    @property
    def n_moving(self) -> int:
        """Blocks that are part of a macro-block."""
        return int((self.labels >= 0).sum())

    @property
    def twists(self) -> bool:
        """Whether blocks turn out of the plane of the load more than counts as none."""
        return self.torsion > SAME


@dataclass(frozen=True, kw_only=True, eq=False)
class Course:
    """Participation along the curve; NaN where the tangent of a point is none.

    Every array is (n,), one entry for each row of the curve that was looked at.
    """

    row: IntArray
    control_displacement: Array  # m
    load_multiplier: Array
    participation_factor: Array  # Gamma, tangent, macro-blocks
    participating_mass_ratio: Array  # e*, tangent, macro-blocks
    participating_mass: Array  # kg, M*, tangent, macro-blocks
    mechanism_mass: Array  # kg, M
    n_bodies: IntArray
    participating_mass_ratio_of_blocks: Array  # e*, tangent, moving blocks one by one
    secant_mass_ratio: Array  # e*, secant, all blocks
    secant_factor: Array  # Gamma, secant
    kinetic_ratio: Array  # c


def initial_shape(curve: CapacityCurve, model: Model) -> MechanismShape:
    """The mechanism just past the peak, on the undeformed structure.

    It is read off between the peak and the point where a hundredth of it is lost; what joints gain
    and lose by their stiffness as the load changes is taken out, at the rate of the first points.

    Raises
    ------
    AssessmentError
        The curve has no poses, has not reached its peak, or the control point stands still in the
        mechanism.
    """
    poses = _poses(curve)
    assembly, control = model.assembly, model.control_point
    top, end, how = _past_the_peak(curve, assembly)
    field = chord(assembly, poses[top], poses[end])
    rate, x = _elastic_row(curve, top), curve.load_multiplier
    if rate is not None and curve.points[end].status == STATIC:
        share = (x[end] - x[top]) / (x[rate] - x[0])
        field = less(field, chord(assembly, poses[0], poses[rate]), share)
    over = field.carried_to(assembly.centroid).over(control, control.point, still=HARDLY)
    if over is None:
        raise AssessmentError(say("refused.control_still"))
    return _shape(curve, model, over, row=top, how=how)


def tangent_shape(curve: CapacityCurve, model: Model, row: int) -> MechanismShape:
    """The mechanism at a point of the curve, from the way that led there; raises as above."""
    poses = _poses(curve)
    assembly, control = model.assembly, model.control_point
    first, last = _around(curve, row)
    field = chord(assembly, poses[first], poses[last])
    moves = [
        assembly.displacement_at(control.block, control.point, poses[k]) for k in (first, last)
    ]
    over = field.over(control, control.point + 0.5 * (moves[0] + moves[1]))
    if over is None:
        raise AssessmentError(
            f"the control point stands still at {curve.points[row].control_displacement:.4g} m"
        )
    how = say("mechanism.tangent", place=curve.points[row].control_displacement)
    return _shape(curve, model, over, row=row, how=how, turned=poses[row])


def secant_participation(curve: CapacityCurve, model: Model, row: int) -> Participation:
    """Participation of all blocks by their displacements since the load began."""
    poses = _poses(curve)
    present = _present(curve, model, row)
    first, last = (_Masses.of(model, pose) for pose in poses[[0, row]])
    moved = motion.translations(poses[row] - poses[0]) + last.centre - first.centre
    d = curve.points[row].control_displacement - curve.points[0].control_displacement
    if not d > 0.0:
        raise AssessmentError("there is no secant where nothing has moved yet")
    return participation(last.mass[present], (moved @ model.load_along)[present] / d)


def course_of(curve: CapacityCurve, model: Model, rows: Sequence[int] | None = None) -> Course:
    """Participation along the curve, by default at about sixty points at rest of its length."""
    rows = _spread(curve) if rows is None else list(rows)
    table = [_entry(curve, model, row) for row in rows]
    columns = np.array(table, dtype=np.float64).reshape(len(rows), 9).T
    return Course(
        row=np.array(rows, dtype=np.int64),
        control_displacement=curve.control_displacement[rows],
        load_multiplier=curve.load_multiplier[rows],
        participation_factor=columns[0],
        participating_mass_ratio=columns[1],
        participating_mass=columns[2],
        mechanism_mass=columns[3],
        n_bodies=columns[4].astype(np.int64),
        participating_mass_ratio_of_blocks=columns[5],
        kinetic_ratio=columns[6],
        secant_mass_ratio=columns[7],
        secant_factor=columns[8],
    )


def _entry(curve: CapacityCurve, model: Model, row: int) -> list[float]:
    """A row of `course_of`."""
    none = [np.nan] * 4 + [0.0] + [np.nan] * 2
    try:
        shape = tangent_shape(curve, model, row)
        bodies = shape.bodies
        tangent = [
            bodies.factor,
            bodies.mass_ratio,
            bodies.mass,
            bodies.mechanism_mass,
            float(shape.n_bodies),
            shape.blocks.mass_ratio,
            shape.kinetic_ratio,
        ]
    except AssessmentError:
        tangent = none
    try:
        secant = secant_participation(curve, model, row)
        return [*tangent, secant.mass_ratio, secant.factor]
    except AssessmentError:
        return [*tangent, np.nan, np.nan]


def _shape(
    curve: CapacityCurve,
    model: Model,
    field: VelocityField,
    *,
    row: int,
    how: str,
    turned: Array | None = None,
) -> MechanismShape:
    """What there is to know of a field; ``turned`` are poses that the blocks' axes have, if any."""
    assembly, direction = model.assembly, model.load_along
    present = _present(curve, model, row)
    labels = find_macro_blocks(assembly, field, direction, departed=~present)
    if not (labels >= 0).any():
        raise AssessmentError(say("refused.none_moves"))
    masses = _Masses.of(model, turned)
    mass, delta = masses.mass, masses.velocity(field) @ direction
    moving = labels >= 0
    whole = np.bincount(labels[moving], weights=mass[moving])
    mean = np.bincount(labels[moving], weights=(mass * delta)[moving]) / whole
    kinetic = masses.kinetic(model, field, turned)
    of_moving = float(kinetic[moving].sum())
    # c = (sum m v_s)^2/(sum m sum (m |v|^2 + w J w)) of all blocks that may move.
    momentum, of_all = float(mass[present] @ delta[present]), float(kinetic[present].sum())
    ratio = momentum**2 / (float(mass[present].sum()) * of_all)
    return MechanismShape(
        field=field,
        labels=labels,
        delta=delta,
        mass=mass,
        bodies=participation(whole, mean, of_moving),
        blocks=participation(mass[moving], delta[moving], of_moving),
        kinetic_ratio=ratio,
        torsion=_torsion(assembly, field, direction, moving),
        clause=how,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Masses:
    """Masses of the blocks with what they carry; zero of supports."""

    mass: Array  # (n,) kg, of both together
    centre: Array  # (n, dim) m, their common centre, from the block's centroid
    carried_at: Array  # (n, dim) m, where what it carries lies, likewise
    reduced: Array  # (n,) kg, m1 m2/(m1 + m2): with its arm squared their inertia about `centre`

    @classmethod
    def of(cls, model: Model, pose: Array | None = None) -> _Masses:
        """As designed, or in poses (n, n_pose)."""
        assembly = model.assembly
        masses = masses_of(assembly, tuple(model.dead_loads))
        mass, carried = masses.weights(assembly) / GRAVITY, masses.together
        if carried is None:
            nowhere = np.zeros_like(assembly.centroid)
            return cls(mass=mass, centre=nowhere, carried_at=nowhere, reduced=np.zeros_like(mass))
        weight = np.where(assembly.fixed, 0.0, carried.weight)
        share = np.divide(weight / GRAVITY, mass, out=np.zeros_like(mass), where=mass > 0.0)
        arm = carried.arm if pose is None else motion.rotated(carried.arm, pose)
        reduced = share * assembly.mass[:, 0]
        return cls(mass=mass, centre=share[:, None] * arm, carried_at=arm, reduced=reduced)

    def velocity(self, field: VelocityField) -> Array:
        """Of the common centres in a field of the centroids, (n, dim)."""
        return field.carried_to(field.place + self.centre).velocity

    def kinetic(self, model: Model, field: VelocityField, pose: Array | None) -> Array:
        """m |v|^2 + w J w of each block with what it carries, (n,) [kg]."""
        axes, spin = model.assembly.axes, field.spin
        if pose is not None:
            n_axes = axes.shape[2]
            axes = np.stack([motion.rotated(axes[:, :, k], pose) for k in range(n_axes)], axis=2)
        straight = self.mass[:, None] * self.velocity(field) ** 2
        straight += self.reduced[:, None] * motion.across(spin, self.carried_at) ** 2
        turning = motion.rotations(model.assembly.mass) * motion.about_own_axes(spin, axes) ** 2
        return np.asarray(straight.sum(axis=1) + turning.sum(axis=1))


def _torsion(
    assembly: Assembly, field: VelocityField, direction: Array, moving: BoolArray
) -> float:
    """Velocity of the fastest point by rotations about other axes than that across the load."""
    for axis in motion.across_both(assembly.up, direction):
        length = float(np.linalg.norm(axis))
        axis = axis / length if length > 0.0 else axis
        out = field.spin - np.outer(field.spin @ axis, axis)
        shapes = assembly.packed
        owner = np.repeat(shapes.body, np.diff(shapes.offset))
        arm = shapes.vertices - field.place[owner]
        speed = np.linalg.norm(motion.across(out[owner], arm), axis=1)
        return float(speed[moving[owner]].max(initial=0.0))
    return 0.0


def _present(curve: CapacityCurve, model: Model, row: int) -> BoolArray:
    """Blocks that may move and are still part of the structure, (n,)."""
    departed = curve.departed(model.assembly.ids, curve.points[row].step)
    return ~(model.assembly.fixed | departed)


def activation_row(curve: CapacityCurve) -> int:
    """The peak at which the first mechanism forms, by its row.

    It is the curve's peak, or one before it from which the multiplier falls to `FORMED` of it, as
    where a wall rocks before it leans on another one.  Where a tie or a bond breaks while joints
    are still closed, no mechanism forms: the fall counts from what is borne without it.
    """
    top, before, falls_from = 0, 0, -math.inf
    for row, point in enumerate(curve.points):
        if point.status != STATIC:
            continue
        bears = point.load_multiplier
        if bears > curve.points[top].load_multiplier:
            top = row
        falls_from = max(falls_from, bears)
        if falls_from > 0.0 and bears < FORMED * falls_from:
            if not _breaks_while_closed(curve, before, row):
                break
            falls_from = bears
        before = row
    return top


def _breaks_while_closed(curve: CapacityCurve, before: int, row: int) -> bool:
    """Whether strength is lost at one displacement between two rows, where the structure is still
    about as stiff as at first."""
    d, x = curve.control_displacement, curve.load_multiplier
    if row - before > 1 or abs(d[row] - d[before]) > ROUNDING * float(np.abs(d).max()):
        return False
    first = next((k for k in range(row) if d[k] > 0.0 and x[k] > 0.0), row)
    return bool(d[before] > 0.0 and x[before] * d[first] >= STILL_STIFF * x[first] * d[before])


def _far_in_motion(curve: CapacityCurve, assembly: Assembly, top: int) -> int:
    """The row after a peak, in motion, by which a block has moved so far that what joints give does
    not count; the last one of the motion where none has."""
    poses, least = _poses(curve), FAR * assembly.smallest_extent
    row = top + 1
    while row + 1 < len(curve.points) and curve.points[row].status != STATIC:
        moved = motion.translations(poses[row]) - motion.translations(poses[top])
        if np.abs(moved).max() >= least:
            break
        row += 1
    return row


def _past_the_peak(curve: CapacityCurve, assembly: Assembly) -> tuple[int, int, str]:
    """Two rows between which the mechanism is read, and how to say so."""
    top = activation_row(curve)
    x = curve.load_multiplier
    run = next(_branches(curve, top), None)
    if run:
        fallen = [k for k in run[FEWEST:] if x[k] <= PASSED * x[run[0]]]
        end = fallen[0] if fallen else run[-1]
        return run[0], end, say("mechanism.past_peak")
    if not curve.peak_passed and curve.status != FINISHED:
        known = {"status": said_status(curve.status), "reason": said_end(curve.reason)}
        raise UnfinishedError(say("refused.before_peak", **known))
    if top + 1 < len(curve.points):
        return top, _far_in_motion(curve, assembly, top), say("mechanism.jump")
    before = [k for k in _run(curve, top) if k < top]
    if not before:
        raise UnfinishedError(say("refused.one_point"))
    return before[-FEWEST:][0], top, say("mechanism.before_last")


def _branches(curve: CapacityCurve, top: int) -> Iterator[list[int]]:
    """Rows of the unbroken branches past the peak that are long enough to read a mechanism from;
    where none is, those of two points."""
    for fewest in (FEWEST, 1):
        row = top
        while row < len(curve.points):
            run = [k for k in _run(curve, row) if k >= row]
            if len(run) > fewest and curve.points[row].status == STATIC:
                yield run
            row = run[-1] + 1


def _around(curve: CapacityCurve, row: int) -> tuple[int, int]:
    """The rows whose chord is the tangent at a row: behind it, or ahead where nothing is behind.

    A state at rest amid jumps has no branch of its own: there it is the way over the jumps.
    """
    run = _run(curve, row)
    behind = [k for k in run if k <= row][-POINTS - 1 :]
    if len(behind) > 1:
        return behind[0], row
    ahead = [k for k in run if k >= row][: POINTS + 1]
    if len(ahead) > 1:
        return row, ahead[-1]
    rest = [k for k in range(row + 1) if curve.points[k].status == STATIC or k == row]
    return rest[-POINTS - 1 :][0], row


def _run(curve: CapacityCurve, row: int) -> list[int]:
    """Rows of the states at rest around a row that no jump divides."""
    points = curve.points

    def linked(k: int) -> bool:
        return (
            points[k].status == STATIC and points[k - 1].status == STATIC and not points[k].jumped
        )

    first = last = row
    while first > 0 and linked(first):
        first -= 1
    while last + 1 < len(points) and linked(last + 1):
        last += 1
    return list(range(first, last + 1))


def _elastic_row(curve: CapacityCurve, top: int) -> int | None:
    """A row from which displacements by closed joints can be read; None where there is none."""
    x = curve.load_multiplier
    low = [
        k
        for k in range(1, top)
        if x[0] < x[k] <= ELASTIC * x[top] and curve.points[k].status == STATIC
    ]
    return low[-1] if low else None


def _spread(curve: CapacityCurve) -> list[int]:
    """Rows of states at rest, evenly along the control displacement, ends and peak included."""
    rows = [k for k, p in enumerate(curve.points) if p.status == STATIC and k > 0]
    if len(rows) <= MOST:
        return rows
    d = curve.control_displacement[rows]
    wanted = np.linspace(d.min(), d.max(), MOST)
    chosen = {rows[int(np.argmin(np.abs(d - place)))] for place in wanted}
    return sorted(chosen | {activation_row(curve), rows[-1]})


def _poses(curve: CapacityCurve) -> Array:
    if len(curve.points) < 2:
        known = {"status": said_status(curve.status), "reason": said_end(curve.reason)}
        raise UnfinishedError(say("refused.points", n=len(curve.points), **known))
    if curve.poses is None:
        raise UnfinishedError(
            "the curve has no poses, by which blocks that move as one are told: trace it with "
            "keep_poses=True, or read its folder of results"
        )
    return curve.poses
