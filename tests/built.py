"""What builders made, measured: volume, joints, surface, overlaps; each independent of builders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.geometry.space import solid
from drystone.model.assembly import Assembly, Block
from drystone.model.construction.checks import OVERLAPPING
from drystone.model.joint_law import JointLaw
from touching import brute_overlap, planes

LAW = JointLaw(friction_coefficient=0.65, normal_stiffness=1e9, shear_stiffness=1e9)


def assembled(blocks: Sequence[Block]) -> Assembly:
    """The blocks as an assembly of thickness 1; ids are told apart, nothing overlaps."""
    assembly = Assembly.build(blocks, joint=LAW)
    assert len(set(assembly.ids)) == len(blocks)
    packed = assembly.packed
    p, q = packed.near_pairs()
    depth = packed.overlap_depths(p, q)
    assert not np.any(depth > OVERLAPPING * packed.pair_size(p, q))
    return assembly


def joint_area(assembly: Assembly) -> float:
    """Of all joints found [m2], in the plane their length [m]."""
    return float(assembly.interfaces.size.sum())


def surface(assembly: Assembly) -> float:
    """Of all blocks [m2], in the plane their perimeters [m]; seams of parts are none of it."""
    total = 0.0
    for block, figure in zip(assembly.blocks, assembly.figures, strict=True):
        if assembly.dimension == 2:
            p = block.vertices
            total += float(np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1).sum())
        elif not block.parts:
            vertices, faces = block.vertices, block.faces or figure.parts[0].faces
            total += float(solid.face_areas(vertices, faces).sum())
        else:
            for part, seam in zip(figure.parts, figure.seams, strict=True):
                total += float(solid.face_areas(part.vertices, part.faces)[~seam].sum())
    return total


def exposed(assembly: Assembly) -> float:
    """Surface that no joint covers [m2]: each joint covers two blocks."""
    return surface(assembly) - 2.0 * joint_area(assembly)


def brute_joints(assembly: Assembly) -> float:
    """Area [m2] where faces of two blocks lie on each other, from all pairs of faces."""
    faces = [
        (i, part.vertices[list(face)], normal)
        for i, figure in enumerate(assembly.figures)
        for part in figure.parts
        for face, normal in zip(part.faces, planes(part.vertices, part.faces)[0], strict=True)
    ]
    total = 0.0
    for k, (i, p, n) in enumerate(faces):
        for j, q, m in faces[:k]:
            # Places are of the order of 1 m, so that planes 1e-7 m apart are two.
            if i == j or n @ m > -1.0 + 1e-9 or abs((q[0] - p[0]) @ n) > 1e-7:
                continue
            low, high = p.min(axis=0), p.max(axis=0)
            if np.any(q.max(axis=0) < low - 1e-9) or np.any(q.min(axis=0) > high + 1e-9):
                continue
            axes = solid.plane_axes(n)
            area, _ = brute_overlap((p - p[0]) @ axes, ((q - p[0]) @ axes)[::-1])
            total += area
    return total
