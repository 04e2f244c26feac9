"""A model before it is run: blocks and supports, load and control point, every joint found.

Beside the blocks stand the joints alone, coloured by their areas, and in red the faces that lie
near each other without one: a joint missed by a tolerance is seen at a glance.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.names import number_of
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.missed import Missed
from drystone.model.assembly import Assembly
from drystone.model.model import Model
from drystone.report import canvas
from drystone.report.camera import Camera
from drystone.report.load_arrows import PATTERN, pattern_arrows, plot_arrows
from drystone.report.mechanism import Mechanism
from drystone.report.mechanism_figure import plot_mechanism
from drystone.report.names import plot_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Endings of the pictures that can be written.
ENDINGS = (".png", ".svg", ".pdf")
COLOURS, MISSING, EDGES = "viridis", "#d7191c", "#9a9a9a"
#: Areas that differ by more than this factor have a logarithmic scale.
WIDELY = 10.0
#: Width of a picture [inches].
WIDTH = 7.0


def draw_model(model: Model, path: Path | str, *, title: str = "", names: bool = False) -> None:
    """Write a picture of a model as designed; its format is that of the ending, see `ENDINGS`.

    With ``names``, blocks are named.
    """
    assembly = model.assembly
    figure = canvas.new_figure(2.0 * WIDTH, WIDTH)
    left, right = figure.subplots(1, 2)
    plot_mechanism(
        left,
        Mechanism(
            assembly=assembly,
            pose=assembly.design_pose(),
            load_direction=model.load_shown,
            control_point=model.control_point,
            ties=model.ties,
            dead_loads=model.dead_loads,
        ),
    )
    camera = camera_before(assembly, model.load_shown)
    seen = camera.seen if camera else np.asarray
    plot_arrows(left, pattern_arrows(model), seen, PATTERN, f'pattern "{model.load.name}"')
    if names:
        plot_names(left, assembly, camera)
    shown = plot_joints(right, assembly, model.load_shown)
    right.set_xlim(left.get_xlim())
    right.set_ylim(left.get_ylim())
    joints, missed = assembly.interfaces, Missed.of(assembly)
    if shown is not None:
        unit = "m2" if assembly.dimension == 3 else "m2, length times thickness"
        figure.colorbar(shown, ax=right, label=f"area of a joint [{unit}]", shrink=0.7)
    area = float(joints.size.sum()) * assembly.thickness
    words = f"{len(joints.size)} joint faces, {area:.4g} m2 in all"
    if len(missed.size):
        words += f"; {len(missed.size)} pairs of faces near each other without one (red)"
    right.set_title(words, fontsize=10)
    supports = number_of(assembly.n_supports, "support")
    left.set_title(f"{assembly.n_blocks} blocks, {supports}", fontsize=10)
    if title:
        figure.suptitle(canvas.literal(title), fontsize=12)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9, frameon=False)
    (low, high), (bottom, top) = left.get_xlim(), left.get_ylim()
    height = WIDTH * (top - bottom) / (high - low) + 1.6
    figure.set_size_inches(2.0 * WIDTH, float(np.clip(height, 3.5, 12.0)))
    canvas.save(figure, path, Path(path).suffix.lower().lstrip(".") or "png")


def plot_joints(axes: Axes, assembly: Assembly, direction: Array | None) -> Any:
    """Draw all joints on axes, those behind first; what tells their colours, None without joints.

    ``direction`` (dim,) is that of the load, if any, which the camera looks at in space.
    """
    camera = camera_before(assembly, direction)
    if camera is not None:
        axes.set_axis_off()
    axes.set_aspect("equal")
    _plot_edges(axes, assembly, camera)
    shown = _plot_faces(axes, assembly, camera)
    _plot_missed(axes, Missed.of(assembly).joints, camera)
    return shown


def camera_before(assembly: Assembly, direction: Array | None) -> Camera | None:
    """That of all pictures of a structure in space."""
    if assembly.dimension == 2:
        return None
    free = [block.vertices for block in assembly.blocks if not block.support]
    return Camera.before(np.ptp(np.vstack(free), axis=0), direction)


def _plot_edges(axes: Axes, assembly: Assembly, camera: Camera | None) -> None:
    """Edges of all blocks, thin, behind the joints."""
    from matplotlib.collections import LineCollection

    width = float(np.clip(8.0 / np.sqrt(assembly.n_bodies), 0.1, 0.6))
    lines = []
    for figure, fixed in zip(assembly.figures, assembly.fixed, strict=True):
        for part in figure.parts:
            if camera is None:
                lines.append(np.vstack((part.vertices, part.vertices[:1])))
            elif not fixed:
                flat = camera.seen(part.vertices)[:, :2]
                lines += [flat[[*face, face[0]]] for face in part.faces]
    axes.add_collection(
        LineCollection(lines, colors=EDGES, linewidths=width, zorder=1), autolim=False
    )


def _plot_faces(axes: Axes, assembly: Assembly, camera: Camera | None) -> Any:
    """The joints, coloured by their areas."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import LogNorm

    joints = assembly.interfaces
    outlines = np.split(joints.corners, joints.offset[1:-1])
    if not len(joints.size):
        return None
    area = joints.size * assembly.thickness
    shown: Any
    if camera is None:
        width = float(np.clip(3.0 * np.sqrt(60.0 / assembly.n_bodies), 0.8, 3.0))
        shown = LineCollection(outlines, cmap=COLOURS, linewidths=width, zorder=3)
    else:
        places = [camera.seen(outline) for outline in outlines]
        order = np.argsort([place[:, 2].mean() for place in places])
        flat = [places[k][:, :2] for k in order]
        area = area[order]
        shown = PolyCollection(
            flat, cmap=COLOURS, alpha=0.75, edgecolors="white", linewidths=0.2, zorder=3
        )
    if area.max() > WIDELY * area.min():
        shown.set_norm(LogNorm(area.min(), area.max()))
    shown.set_array(area)
    axes.add_collection(shown, autolim=False)
    return shown


def _plot_missed(axes: Axes, joints: Interfaces, camera: Camera | None) -> None:
    """Faces that lie near each other without a joint."""
    from matplotlib.collections import LineCollection

    if not len(joints.size):
        return
    outlines = np.split(joints.corners, joints.offset[1:-1])
    if camera is not None:
        outlines = [camera.seen(np.vstack((o, o[:1])))[:, :2] for o in outlines]
    axes.add_collection(
        LineCollection(outlines, colors=MISSING, linewidths=2.5, zorder=6, label="no joint"),
        autolim=False,
    )
