"""What a model holds, for someone who wants to know before running it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from drystone.assembly import Assembly
from drystone.builders.neighbours import TOUCHING, Array, IntArray, Outlines
from drystone.model import Model


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
    """Contact points at rest, two to a joint in two dimensions."""
    weight: float
    """Of the movable blocks [N]."""
    lower: tuple[float, float]
    """Lower left corner of the box around the movable blocks [m]."""
    upper: tuple[float, float]
    """Its upper right corner [m]."""
    control_block: str
    control_point: tuple[float, float]
    """On the block as designed [m]."""
    warnings: tuple[str, ...]
    """Sentences on what is allowed but worth knowing."""


def inspect(model: Model) -> Inspection:
    """Count the blocks, joints and contacts of a model, and say what is worth knowing."""
    assembly = model.assembly
    outlines = Outlines.of(assembly)
    a, b = outlines.near_pairs()
    keep = ~(assembly.fixed[a] & assembly.fixed[b])
    a, b = a[keep], b[keep]
    n_joints = int(np.count_nonzero(outlines.shared_lengths(a, b)))
    movable = ~assembly.fixed
    x, y = model.control_point.point
    return Inspection(
        title=model.title,
        dimension=assembly.dimension,
        n_blocks=assembly.n_blocks,
        n_supports=assembly.n_supports,
        n_joints=n_joints,
        n_contacts=2 * n_joints,
        weight=float(assembly.weight[movable].sum()),
        lower=_pair(outlines.lower[movable].min(axis=0)),
        upper=_pair(outlines.upper[movable].max(axis=0)),
        control_block=assembly.blocks[model.control_point.block].id,
        control_point=(float(x), float(y)),
        warnings=tuple(_warnings(model, outlines, a, b)),
    )


def _pair(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _warnings(model: Model, outlines: Outlines, a: IntArray, b: IntArray) -> list[str]:
    """Sentences; ``a`` and ``b`` are the pairs of blocks that lie near each other."""
    assembly = model.assembly
    return [
        *_law_warnings(assembly),
        *_floating(assembly, outlines, a, b),
        *_unit_warnings(assembly, outlines),
    ]


def _law_warnings(assembly: Assembly) -> list[str]:
    warnings = []
    if all(law.dilatancy_angle == 0.0 for law in assembly.laws):
        warnings.append("joint: the dilatancy angle is zero: joints slide without opening")
    if not assembly.corner.radius and not assembly.corner.chamfer:
        warnings.append(
            "corner: the corners are sharp: with friction and no dilatancy the collapse "
            "multiplier may depend on the path"
        )
    if assembly.joint.normal_stiffness is None or assembly.joint.shear_stiffness is None:
        warnings.append("joint: without stiffnesses only limit analysis can be done")
    return warnings


def _floating(assembly: Assembly, outlines: Outlines, a: IntArray, b: IntArray) -> list[str]:
    """Blocks that no chain of touching blocks connects to a support, supports that bear nothing."""
    touching = outlines.overlap_depths(a, b) >= -TOUCHING * outlines.pair_size(a, b)
    a, b = a[touching], b[touching]
    n = assembly.n_bodies
    links = coo_array((np.ones(len(a)), (a, b)), shape=(n, n))
    _, group = connected_components(links, directed=False)
    borne = np.isin(group, group[assembly.fixed])
    warnings = []
    if not borne.all():
        loose = [assembly.ids[i] for i in np.flatnonzero(~borne)]
        warnings.append(f"block: no support is under {_listed(loose)}: they will fall")
    idle = np.flatnonzero(assembly.fixed & ~np.isin(np.arange(n), np.concatenate((a, b))))
    if len(idle):
        names = _listed([assembly.ids[i] for i in idle])
        warnings.append(f"block: nothing touches the support {names}")
    return warnings


def _unit_warnings(assembly: Assembly, outlines: Outlines) -> list[str]:
    """Values so far from masonry that a unit may have been mistaken."""
    warnings = []
    largest = float(outlines.size[~assembly.fixed].max())
    if largest > 50.0:
        warnings.append(f"block: the largest is {largest:g} m long: are the coordinates in metres?")
    lightest = min(block.unit_weight for block in assembly.blocks if not block.support)
    if lightest < 1e3:
        warnings.append(f"material: {lightest:g} N/m3 is light for masonry: is it in N/m3?")
    return warnings


def _listed(names: list[str]) -> str:
    shown = ", ".join(f'"{name}"' for name in names[:5])
    return shown + (f" and {len(names) - 5} more" if len(names) > 5 else "")
