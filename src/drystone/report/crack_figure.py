"""Crack maps of tested walls beside what was computed: open joints, drawn as in the map."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.language import say
from drystone.geometry.motion import moved_points
from drystone.laboratory.models import BEAM, model_of
from drystone.report import canvas
from drystone.report.joints import Joints

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from drystone.laboratory.comparison import Compared
    from drystone.laboratory.walls import Wall
    from drystone.model.assembly import Assembly


#: Panels of a row: two walls, each with its map.
PAIRS = 2
#: Opening, or slip, of a joint that is drawn [m]: the width of a line in these pictures.
SEEN = 1e-3
#: Around a wall [m].
MARGIN = 0.02
CRACK, CRUSHED, STONE = "#cc1111", "#e0b000", "#777777"


def draw_cracks(walls: Sequence[Compared], path: Path | str, *, title: str) -> None:
    """Write one picture: of each wall that has one its crack map, and the computed wall beside."""
    drawn = [wall for wall in walls if wall.crack_map is not None]
    rows = -(-len(drawn) // PAIRS)
    columns = min(PAIRS, len(drawn))
    figure = canvas.new_figure(6.4 * columns, 3.1 * rows + 0.5)
    figure.suptitle(canvas.literal(title), fontsize=12)
    panels = figure.subplots(rows, 2 * columns, squeeze=False).reshape(-1, 2)
    for (left, right), wall in zip(panels, drawn, strict=False):
        _plot_map(left, wall)
        plot_cracks(right, wall)
    for pair in panels[len(drawn) :]:
        for axes in pair:
            axes.set_axis_off()
    canvas.save(figure, path)


def _plot_map(axes: Axes, compared: Compared) -> None:
    from matplotlib.image import imread

    assert compared.crack_map is not None
    axes.imshow(imread(io.BytesIO(compared.crack_map), format="png"))
    axes.set_title(say("laboratory.crack_map", wall=compared.wall.name).spoken, fontsize=9)
    axes.set_axis_off()


def plot_cracks(axes: Axes, compared: Compared) -> None:
    """The wall at the end of the test, as large as it moved, pushed as in its map.

    Open joints are filled, slid ones are lines, and joints that crush are marked beside.
    """
    from matplotlib.collections import PolyCollection

    state = compared.at_the_end
    assert state is not None
    displacement, pose = state
    wall, assembly = compared.wall, model_of(compared.wall).assembly
    stones = [
        moved_points(block.vertices, np.full(len(block.vertices), row), assembly.centroid, pose)
        for row, block in enumerate(assembly.blocks)
        if not block.support and block.id != BEAM
    ]
    drawn = [_as_in_map(wall, stone) for stone in stones]
    axes.add_collection(
        PolyCollection(drawn, facecolors="white", edgecolors=STONE, linewidths=0.5, zorder=2)
    )
    _plot_joints(axes, wall, assembly, pose)
    corners = np.vstack(drawn)
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes.set_xlim(low[0] - MARGIN, high[0] + MARGIN)
    axes.set_ylim(low[1] - MARGIN, high[1] + MARGIN)
    axes.set_aspect("equal")
    axes.set_axis_off()
    known = {"wall": wall.name, "drift": wall.drift(displacement)}
    axes.set_title(say("laboratory.crack_computed", **known).spoken, fontsize=9)


def _as_in_map(wall: Wall, points: Array) -> Array:
    """Points (..., 2) as the map shows them, which may be of the other side of the wall."""
    if not wall.map_pushed_left:
        return points
    return np.stack((wall.length - points[..., 0], points[..., 1]), axis=-1)


def _plot_joints(axes: Axes, wall: Wall, assembly: Assembly, pose: Array) -> None:
    from matplotlib.collections import LineCollection, PolyCollection

    joints, law = Joints.of(assembly), assembly.joint
    a, b = joints.faces(pose)
    opening, slip = joints.opening_and_slip(pose)
    gaping = opening > SEEN
    slid = ~gaping & (slip > SEEN)
    assert law.normal_stiffness is not None
    crushed = joints.closing(pose) > law.compressive_strength / law.normal_stiffness
    gap = _as_in_map(wall, np.concatenate((a, b[:, ::-1]), axis=1))
    middle = _as_in_map(wall, 0.5 * (a + b))
    hatched: dict[str, Any] = {
        "facecolors": "none",
        "edgecolors": CRACK,
        "hatch": "//////",
        "linewidths": 0.6,
    }
    axes.add_collection(PolyCollection(list(gap[gaping]), zorder=3, **hatched))
    axes.add_collection(LineCollection(list(middle[slid]), colors=CRACK, linewidths=1.0, zorder=4))
    axes.add_collection(
        LineCollection(list(middle[crushed]), colors=CRUSHED, linewidths=4.0, zorder=1)
    )
