"""Names of blocks in pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.assembly import Assembly
from drystone.report import canvas
from drystone.report.camera import Camera

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Sizes of letters, and the share of a letter's height that it is wide [points].
LEAST, MOST, WIDE = 2.5, 9.0, 0.62
#: Points to an inch.
POINTS = 72.0


def plot_names(axes: Axes, assembly: Assembly, camera: Camera | None) -> None:
    """Write the name of each block on its centre, as large as fits on it; those of solids in the
    order of their distance, the nearest last."""
    low, high = axes.get_xlim()
    across = axes.get_window_extent().width / axes.figure.dpi  # inches
    per_metre = POINTS * across / (high - low)
    places = assembly.centroid if camera is None else camera.seen(assembly.centroid)
    order = np.arange(assembly.n_bodies) if camera is None else np.argsort(places[:, 2])
    for i in order.tolist():
        name = canvas.literal(assembly.ids[i])
        vertices = assembly.blocks[i].vertices
        seen = vertices if camera is None else camera.seen(vertices)
        wide, up = np.ptp(seen[:, :2], axis=0) * per_metre
        size = float(np.clip(min(0.9 * wide / (WIDE * len(name)), 0.7 * up), LEAST, MOST))
        x, y = places[i, :2].tolist()
        style: dict[str, Any] = {"ha": "center", "va": "center"}
        axes.text(x, y, name, fontsize=size, zorder=7, clip_on=True, **style)
