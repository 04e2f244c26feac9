"""Blocks that are no model yet: where they touch, and in red where they overlap or do not meet."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.missed import Missed
from drystone.geometry.plane.trim import common
from drystone.io.modelfile.sketch import Sketch
from drystone.model.construction.words import millimetres
from drystone.report import canvas
from drystone.report.camera import Camera
from drystone.report.mechanism import RESTING, SUPPORT
from drystone.report.model_figure import MISSING, camera_before, plot_joints
from drystone.report.names import plot_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Width and largest height of a picture [inches].
WIDTH, HIGHEST = 9.0, 12.0
#: Overlaps that are told in words, the deepest first.
TOLD = 12


def draw_sketch(sketch: Sketch, path: Path | str, *, names: bool = False) -> None:
    """Write a picture of blocks; its format is that of the ending, see `model_figure.ENDINGS`.

    With ``names``, blocks are named.
    """
    assembly = sketch.assembly
    figure = canvas.new_figure(WIDTH, WIDTH)
    axes = figure.subplots()
    along = np.eye(assembly.dimension)[0]
    camera = _camera(sketch, along)
    _plot_blocks(axes, sketch, camera)
    vertices = np.vstack([block.vertices for block in assembly.blocks])
    seen = vertices if camera is None else camera.seen(vertices)[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    margin = 0.04 * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    if assembly.n_blocks:
        plot_joints(axes, assembly, along)
    ratio = float((high[1] - low[1] + 2.0 * margin) / (high[0] - low[0] + 2.0 * margin))
    figure.set_size_inches(WIDTH, float(np.clip(WIDTH * ratio + 1.2, 3.5, HIGHEST)))
    if names:
        plot_names(axes, assembly, camera)
    told = _plot_overlaps(axes, sketch, camera)
    if camera is None:
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
    missed = len(Missed.of(assembly).size) if assembly.n_blocks else 0
    words = [f"blocks: {assembly.n_blocks}, supports: {assembly.n_supports}"]
    words += [f"overlaps: {told} (red)"] if told else []
    words += [f"faces near each other without a joint: {missed} (red)"] if missed else []
    axes.set_title(canvas.literal(sketch.title) + "\n" + "; ".join(words), fontsize=10)
    canvas.save(figure, path, Path(path).suffix.lower().lstrip(".") or "png")


def _camera(sketch: Sketch, along: Array) -> Camera | None:
    """As in pictures of models; of supports alone before all of them."""
    assembly = sketch.assembly
    if assembly.dimension == 2 or assembly.n_blocks:
        return camera_before(assembly, along)
    return Camera.before(np.ptp(np.vstack([b.vertices for b in assembly.blocks]), axis=0), along)


def _plot_blocks(axes: Axes, sketch: Sketch, camera: Camera | None) -> None:
    """The blocks of the plane, filled; edges of solids are drawn with their joints."""
    from matplotlib.collections import PolyCollection

    assembly = sketch.assembly
    axes.set_aspect("equal")
    if camera is not None:
        return
    parts = [
        (part.vertices, SUPPORT if fixed else RESTING)
        for figure, fixed in zip(assembly.figures, assembly.fixed, strict=True)
        for part in figure.parts
    ]
    axes.add_collection(
        PolyCollection([v for v, _ in parts], facecolors=[c for _, c in parts], zorder=0),
        autolim=False,
    )


def _plot_overlaps(axes: Axes, sketch: Sketch, camera: Camera | None) -> int:
    """Overlaps in red, each in a ring, the deepest in words; how many there are."""
    from matplotlib.collections import LineCollection, PolyCollection

    assembly = sketch.assembly
    p, q, depth = sketch.overlaps
    if not len(p):
        return 0
    packed = assembly.packed
    parts = [part for figure in assembly.figures for part in figure.parts]
    order = np.argsort(-depth, kind="stable")
    style: dict[str, Any] = {"zorder": 8}
    middles = []
    for k in order.tolist():
        one, other = parts[p[k]], parts[q[k]]
        if camera is None:
            shared = common(one.vertices, other.vertices)
            place = one.vertices.mean(axis=0) if shared is None else shared.mean(axis=0)
            if shared is not None:
                axes.add_collection(
                    PolyCollection([shared], facecolors=MISSING, edgecolors=MISSING, **style),
                    autolim=False,
                )
        else:
            for part in (one, other):
                flat = camera.seen(part.vertices)[:, :2]
                axes.add_collection(
                    LineCollection(
                        [flat[[*f, f[0]]] for f in part.faces],
                        colors=MISSING,
                        linewidths=0.8,
                        **style,
                    ),
                    autolim=False,
                )
            both = np.vstack((one.vertices, other.vertices))
            place = camera.seen(both.mean(axis=0)[None])[0, :2]
        middles.append(place)
    axes.plot(
        *np.array(middles).T, "o", ms=14, mfc="none", mec=MISSING, mew=1.3, zorder=9, clip_on=False
    )
    middle = sum(axes.get_xlim()) / 2.0
    for place, k in zip(middles[:TOLD], order[:TOLD].tolist(), strict=False):
        a, b = (assembly.ids[packed.body[row[k]]] for row in (p, q))
        text = canvas.literal(f"{a} | {b}: {millimetres(float(depth[k]))}")
        axes.annotate(
            text,
            place,
            xytext=(-9.0 if place[0] > middle else 9.0, 9.0),
            textcoords="offset points",
            ha="right" if place[0] > middle else "left",
            fontsize=7,
            color=MISSING,
            zorder=10,
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8},
        )
    return len(p)
