"""Macro-blocks: blocks that move as one rigid body.

Codes sum over the rigid bodies of a mechanism, not over bricks: a wall that is cut into n courses
which move as one has a participating mass of 4/3 of the uncut wall's where its courses are taken
one by one.  Blocks at rest are no part of the mechanism, and would make it look small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.assessment.mechanism.field import VelocityField
from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry import motion
from drystone.geometry.links import components
from drystone.model.assembly import Assembly

#: Velocities, over the control point's, that differ by less are the same, and below which blocks
#: are at rest.
SAME = 0.05
#: Share of a body's mass up to which members that hardly move along the load belong to it: its
#: foot, about which it turns.  The parts of a body that turns about its end are slower than `SAME`
#: in half its mass where its centroid is just that slow.
FOOT = 0.4
#: The label of blocks that are at rest.
AT_REST = -1


def find_macro_blocks(
    assembly: Assembly,
    field: VelocityField,
    direction: Array,
    *,
    departed: BoolArray | None = None,
    tolerance: float = SAME,
) -> IntArray:
    """Which body each block belongs to, (n,): 0, 1, ... in the order of their first blocks.

    Blocks belong together that touch as designed, directly or through others, and whose points all
    move as one rigid body within the tolerance.  Blocks at rest, supports among them, are -1.

    Parameters
    ----------
    field
        Over the velocity of the control point.
    direction
        Of the load, (dim,): blocks are at rest that hardly move along it.
    departed
        Blocks that have left the structure, (n,).
    tolerance
        Over the velocity of the control point.
    """
    out = assembly.fixed if departed is None else assembly.fixed | departed
    bodies = _Bodies.of(assembly, field)
    moving = (bodies.fastest > tolerance) & ~out
    labels = np.full(assembly.n_bodies, AT_REST, dtype=np.int64)
    labels[moving] = np.flatnonzero(moving)
    pairs = _touching(assembly)
    pairs = pairs[moving[pairs].all(axis=1)]
    if len(pairs):
        apart = bodies.difference(pairs)
        order = np.argsort(apart, kind="stable")
        pairs = pairs[order[apart[order] < tolerance]]
        group = components(assembly.n_bodies, *pairs.T)
        labels[moving] = np.unique(group, return_index=True)[1][group][moving]  # first blocks
        for label in np.unique(labels[moving]):
            members = np.flatnonzero(labels == label)
            if bodies.deviation(members) >= tolerance:  # bent, link by link
                labels[members] = _split(bodies, members, pairs, tolerance)
    _put_to_rest(labels, np.abs(field.along(direction)) < tolerance, assembly.weight)
    return _in_order(labels)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Bodies:
    """What the search asks about blocks and sets of blocks."""

    field: VelocityField
    radius: Array  # (n,) m, farthest point from the centroid
    mass: Array  # (n,) kg
    inertia: Array  # (n, 1, 1) or (n, 3, 3) kg m2, about axes of the world as designed

    @classmethod
    def of(cls, assembly: Assembly, field: VelocityField) -> _Bodies:
        shapes = assembly.packed
        owner = np.repeat(shapes.body, np.diff(shapes.offset))
        radius = np.zeros(assembly.n_bodies)
        reach = np.linalg.norm(shapes.vertices - assembly.centroid[owner], axis=1)
        np.maximum.at(radius, owner, reach)
        moments = motion.rotations(assembly.mass)
        inertia = motion.inertia_about_the_world(moments, assembly.axes)
        return cls(field=field, radius=radius, mass=assembly.mass[:, 0], inertia=inertia)

    @property
    def fastest(self) -> Array:
        """Bound of the velocity of any point of each block, (n,)."""
        return np.linalg.norm(self.field.velocity, axis=1) + self.radius * np.linalg.norm(
            self.field.spin, axis=1
        )

    def difference(self, pairs: IntArray) -> Array:
        """By how much velocities of points of two blocks differ at most, were they one, (k,)."""
        i, j = pairs.T
        middle = 0.5 * (self.field.place[i] + self.field.place[j])
        slide = self.field.at(middle, i) - self.field.at(middle, j)
        turn = np.linalg.norm(self.field.spin[i] - self.field.spin[j], axis=1)
        return np.asarray(
            np.linalg.norm(slide, axis=1) + turn * np.maximum(self.radius[i], self.radius[j])
        )

    def deviation(self, members: IntArray) -> float:
        """Largest difference between the blocks' velocities and those of the one rigid body that
        has their momentum and moment of momentum."""
        place, velocity, spin = (
            values[members] for values in (self.field.place, self.field.velocity, self.field.spin)
        )
        mass = self.mass[members]
        centre, mean = (mass @ values / mass.sum() for values in (place, velocity))
        arm = place - centre
        turning = np.einsum("nij,nj->ni", self.inertia[members], spin)
        momentum = (motion.moments(arm, mass[:, None] * (velocity - mean)) + turning).sum(axis=0)
        inertia = (self.inertia[members] + mass[:, None, None] * motion.orbits(arm)).sum(axis=0)
        common = np.linalg.solve(inertia, momentum)
        off = velocity - mean - motion.across(np.broadcast_to(common, spin.shape), arm)
        turned = np.linalg.norm(spin - common, axis=1) * self.radius[members]
        return float((np.linalg.norm(off, axis=1) + turned).max())


def _touching(assembly: Assembly) -> IntArray:
    """Pairs of blocks with a joint between them as designed, (k, 2)."""
    joints = assembly.interfaces
    pairs = np.column_stack((joints.block_a, joints.block_b)).astype(np.int64)
    return np.unique(pairs.reshape(-1, 2), axis=0)


def _split(bodies: _Bodies, members: IntArray, pairs: IntArray, tolerance: float) -> IntArray:
    """Labels of ``members`` (k,): joined from the closest on, as long as they are rigid as one."""
    label = {int(i): int(i) for i in members}
    groups = {i: [i] for i in label}
    for i, j in pairs.tolist():  # from the least difference on
        if i not in label or label[i] == label[j]:
            continue
        kept, lost = sorted((label[i], label[j]))
        both = groups[kept] + groups[lost]
        if bodies.deviation(np.array(both)) < tolerance:
            groups[kept] = both
            for member in groups.pop(lost):
                label[member] = kept
    return np.array([label[int(i)] for i in members], dtype=np.int64)


def _put_to_rest(labels: IntArray, slow: BoolArray, weight: Array) -> None:
    """Take slow blocks out of their bodies but for the foot of one that turns about it."""
    moving = labels >= 0
    body = labels[moving]
    whole = np.bincount(body, weights=weight[moving], minlength=len(labels))
    foot = np.bincount(body, weights=np.where(slow, weight, 0.0)[moving], minlength=len(labels))
    labels[moving & slow & (foot[labels] > FOOT * whole[labels])] = AT_REST


def _in_order(labels: IntArray) -> IntArray:
    """The same bodies, counted from 0 in the order of their first blocks."""
    known, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    number = np.empty(len(known), dtype=np.int64)
    bodies = np.argsort(np.where(known < 0, -1, first), kind="stable")
    number[bodies] = np.arange(len(known)) - int((known < 0).any())
    return np.asarray(number[inverse], np.int64)
