"""Names of blocks in pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.space.solid import face_planes
from drystone.model.assembly import Assembly
from drystone.report import canvas
from drystone.report.camera import Camera

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Sizes of letters, and the share of a letter's height that it is wide [points].
LEAST, MOST, WIDE = 2.5, 9.0, 0.62
#: Points to an inch.
POINTS = 72.0
#: Nearness over the size of everything by which what is in front hides what is behind.
BEHIND = 1e-6


def plot_names(axes: Axes, assembly: Assembly, camera: Camera | None) -> None:
    """Write the name of each block on it, as large as fits: in the plane on its centre, in space on
    its largest face that is seen; solids that are not seen have none."""
    low, high = axes.get_xlim()
    across = axes.get_window_extent().width / axes.figure.dpi  # inches
    per_metre = POINTS * across / (high - low)
    if camera is None:
        places = {
            i: (assembly.centroid[i], np.ptp(block.vertices, axis=0))
            for i, block in enumerate(assembly.blocks)
        }
    else:
        places = _seen(assembly, camera)
    for i, (place, size) in places.items():
        name = canvas.literal(assembly.ids[i])
        wide, up = size * per_metre
        letters = float(np.clip(min(0.9 * wide / (WIDE * len(name)), 0.7 * up), LEAST, MOST))
        style: dict[str, Any] = {"ha": "center", "va": "center"}
        x, y = place.tolist()
        axes.text(x, y, name, fontsize=letters, zorder=7, clip_on=True, **style)


def _seen(assembly: Assembly, camera: Camera) -> dict[int, tuple[Array, Array]]:
    """Of the blocks that are seen, the middle of the largest face whose middle nothing hides, and
    how far that face goes across and up, in the picture [m]."""
    from matplotlib.path import Path

    owner, outlines, normals = [], [], []
    for i, figure in enumerate(assembly.figures):
        for part, seam in zip(figure.parts, figure.seams, strict=True):
            normal, _ = face_planes(part.vertices, part.faces)
            for k in np.flatnonzero((normal @ camera.towards > BEHIND) & ~seam).tolist():
                owner.append(i)
                outlines.append(part.vertices[list(part.faces[k])])
                normals.append(normal[k])
    middles = np.array([outline.mean(axis=0) for outline in outlines]).reshape(-1, 3)
    flat = [camera.seen(outline)[:, :2] for outline in outlines]
    size = float(np.ptp(np.vstack([block.vertices for block in assembly.blocks]), axis=0).max())
    hidden = np.zeros(len(middles), bool)
    there = camera.seen(middles)[:, :2]
    for outline, shape, normal in zip(outlines, flat, normals, strict=True):
        nearer = (outline[0] - middles) @ normal / (normal @ camera.towards) > BEHIND * size
        hidden |= nearer & Path(shape).contains_points(there)
    found: dict[int, tuple[float, Array, Array]] = {}
    for k in np.flatnonzero(~hidden).tolist():
        x, y = flat[k].T
        area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
        if area > found.get(owner[k], (0.0,))[0]:
            found[owner[k]] = area, there[k], np.ptp(flat[k], axis=0)
    return {i: (place, extent) for i, (_, place, extent) in found.items()}
