"""What a model holds, for someone who wants to know before running it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry.missed import Missed
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.model.assembly import Assembly
from drystone.model.construction.words import FEW, listed, millimetres, quoted
from drystone.model.loading import ModalPattern, masses_of
from drystone.model.mistaken_units import unit_doubts
from drystone.model.model import Model
from drystone.model.ties import Bars

#: Keys of [analysis] that say nothing where supports move.
OF_A_LOAD = (
    "balance_tolerance",
    "increment",
    "max_displacement",
    "overshoot",
    "patience",
    "time_step",
)


@dataclass(frozen=True, kw_only=True)
class VibrationMode:
    """A mode of the blocks on their elastic joints."""

    number: int
    """Counted from 1, in the order of frequencies."""
    period: float
    """In s."""
    participation: float
    """Mass along the load's direction over that of all blocks."""

    @classmethod
    def of(cls, model: Model) -> VibrationMode | None:
        """That of a model's load, if it is one in proportion to a mode."""
        load, assembly = model.load, model.assembly
        if not isinstance(load, ModalPattern):
            return None
        mode = load.mode(assembly, masses_of(assembly, model.dead_loads, model.ties))
        return cls(number=mode.number, period=mode.period, participation=mode.participation)


@dataclass(frozen=True, kw_only=True)
class Inspection:
    """Counts and measures of a model as designed."""

    title: str
    dimension: int
    n_blocks: int
    """Movable blocks."""
    n_supports: int
    """Blocks that never move."""
    n_joints: int
    """Pairs of blocks, not both supports, with edges that lie on each other at rest."""
    n_contacts: int
    """Contact points at rest: two to each straight part of a joint in two dimensions, in three as
    many to each plane part as [contact] says."""
    joint_area: float
    """Of all joints but those between supports [m2]."""
    volume: float
    """Of the movable blocks [m3]."""
    weight: float
    """Of the movable blocks [N]: what the supports carry at rest."""
    lower: tuple[float, ...]
    """Lowest corner of the box around the movable blocks [m]."""
    upper: tuple[float, ...]
    """Its highest corner [m]."""
    load: str
    """The pattern that the multiplier scales, in words."""
    n_ties: int
    """Ties and springs."""
    dead_load: tuple[float, ...]
    """Sum of what acts beside the blocks' weight [N]."""
    mode: VibrationMode | None
    """Of a load in proportion to a mode of vibration."""
    control_block: str
    control_point: tuple[float, ...]
    """On the block as designed [m]."""
    warnings: tuple[str, ...]
    """Sentences on what is allowed but worth knowing."""
    problems: tuple[str, ...]
    """Those of them on what is hardly meant, with the mend."""


def inspect(model: Model) -> Inspection:
    """Count the blocks, joints and contacts of a model, and say what is worth knowing."""
    assembly = model.assembly
    packed = assembly.packed
    p, q = packed.near_pairs()
    keep = ~(assembly.fixed[packed.body[p]] & assembly.fixed[packed.body[q]])
    p, q = p[keep], q[keep]
    movable = ~assembly.fixed
    parts = movable[packed.body]
    problems = (*model.notes, *doubts(model, packed, p, q))
    return Inspection(
        title=model.title,
        dimension=assembly.dimension,
        n_blocks=assembly.n_blocks,
        n_supports=assembly.n_supports,
        n_joints=joint_count(assembly),
        n_contacts=contact_count(assembly),
        joint_area=float(assembly.interfaces.size[_loose(assembly)].sum()) * assembly.thickness,
        volume=float(assembly.volume[movable].sum()),
        weight=float(assembly.weight[movable].sum()),
        lower=_place(packed.lower[parts].min(axis=0)),
        upper=_place(packed.upper[parts].max(axis=0)),
        load=model.load.words,
        n_ties=len(model.ties),
        dead_load=_place(_dead_load(model)),
        mode=VibrationMode.of(model),
        control_block=assembly.blocks[model.control_point.block].id,
        control_point=_place(model.control_point.point),
        warnings=(*_law_notes(assembly), *problems),
        problems=problems,
    )


def joint_count(assembly: Assembly) -> int:
    """Pairs of blocks with joints between them, but for supports."""
    joints, loose = assembly.interfaces, _loose(assembly)
    # Once each: a joint may have several plane parts, as that of a block in a notch of another.
    return len(set(zip(joints.block_a[loose], joints.block_b[loose], strict=True)))


def contact_count(assembly: Assembly) -> int:
    """Contact points at rest, but for those between supports."""
    return assembly.points * int(_loose(assembly).sum())


def _loose(assembly: Assembly) -> BoolArray:
    """Which interfaces are not between supports, (n_interfaces,)."""
    joints = assembly.interfaces
    return ~(assembly.fixed[joints.block_a] & assembly.fixed[joints.block_b])


def _dead_load(model: Model) -> Array:
    """Sum of the dead loads beside the blocks' weight, (dim,) [N]."""
    loads = [load.forces(model.assembly).force.sum(axis=0) for load in model.dead_loads]
    return np.sum(loads, axis=0) if loads else np.zeros(model.assembly.dimension)


def _place(point: Array) -> tuple[float, ...]:
    return tuple(map(float, point))


def doubts(model: Model, packed: Outlines | Polyhedra, p: IntArray, q: IntArray) -> list[str]:
    """Sentences on what is hardly meant; ``p`` and ``q`` are parts that lie near each other."""
    assembly = model.assembly
    return [
        *_floating(model, packed, p, q),
        *_missed(assembly),
        *unit_doubts(model),
        *_unused(model),
    ]


def _unused(model: Model) -> list[str]:
    """Settings of a load where supports move."""
    if model.settlement is None:
        return []
    given = [name for name in OF_A_LOAD if name in model.analysis.options]
    if model.analysis.strategy == "published":
        given.append("strategy")
    return [
        f"analysis: {name} has no effect, because supports move: [settlement] says how far"
        for name in given
    ]


def _law_notes(assembly: Assembly) -> list[str]:
    warnings = []
    if all(law.dilatancy_angle == 0.0 for law in assembly.laws):
        warnings.append("joint: the dilatancy angle is zero: joints slide without opening")
    if not assembly.corner.radius and not assembly.corner.chamfer:
        warnings.append(
            "corner: the corners are sharp: with friction and no dilatancy the collapse "
            "multiplier may depend on the path"
        )
    if assembly.bonds_at_corners:
        many = assembly.kind.points_if_crushed
        warnings.append(
            f"contact: with {assembly.points} points a joint, a bond in bending may carry three "
            f"times what it does if its edge cracks first: compare with [contact] points = {many}"
        )
    if assembly.joint.normal_stiffness is None or assembly.joint.shear_stiffness is None:
        warnings.append("joint: without stiffnesses only limit analysis can be done")
    return warnings


def _connected(n: int, a: IntArray, b: IntArray) -> IntArray:
    """Lowest row that links ``a[k]`` to ``b[k]`` lead to from each of n rows, (n,)."""
    lowest = np.arange(n)
    while True:  # each round at least halves the way to it
        before, least = lowest.copy(), np.minimum(lowest[a], lowest[b])
        np.minimum.at(lowest, lowest[a], least)
        np.minimum.at(lowest, lowest[b], least)
        lowest = lowest[lowest]
        if np.array_equal(lowest, before):
            return lowest


def _floating(model: Model, packed: Outlines | Polyhedra, p: IntArray, q: IntArray) -> list[str]:
    """Blocks that no chain of touching or tied blocks connects to a support, supports that bear
    nothing."""
    assembly, touching = model.assembly, packed.touching(p, q)
    moving = model.settlement.rows(assembly) if model.settlement else None
    ends = Bars.of(assembly, model.ties, moving).body
    a = np.concatenate((packed.body[p[touching]], ends[:, 0]))
    b = np.concatenate((packed.body[q[touching]], ends[:, 1]))
    n = assembly.n_bodies
    group = _connected(n, a, b)
    borne = np.isin(group, group[assembly.fixed])
    warnings = []
    if not borne.all():
        loose = [assembly.ids[i] for i in np.flatnonzero(~borne)]
        warnings.append(f"block: no support is under {listed(loose)}: they will fall")
    idle = np.flatnonzero(assembly.fixed & ~np.isin(np.arange(n), np.concatenate((a, b))))
    if len(idle):
        names = listed([assembly.ids[i] for i in idle])
        warnings.append(f"block: nothing touches the support {names}: take it out, or move it")
    return warnings


def _missed(assembly: Assembly) -> list[str]:
    """Faces that lie near each other without a joint: the first few, and how many more."""
    found = Missed.of(assembly)
    rows = np.argsort(-found.gap, kind="stable")
    unit = assembly.kind.joint_unit
    pairs: dict[tuple[str, str], str] = {}
    for k in rows.tolist():
        a, b = (assembly.ids[block[k]] for block in (found.joints.block_a, found.joints.block_b))
        pairs.setdefault(
            (a, b),
            f"block: {quoted(a)} and {quoted(b)} have faces {millimetres(found.gap[k])} apart over "
            f"{found.size[k]:.3g} {unit}, and no joint: move them together, or farther apart",
        )
    told = list(pairs.values())[:FEW]
    if len(pairs) > FEW:
        told.append(f"block: {len(pairs) - FEW} more pairs have faces near each other and no joint")
    return told
