"""Arrows of loads: dead loads, in any state, and patterns that are not of mass alone, as designed.

An arrow ends where the line of action of what a load puts on a block first meets that block.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry.motion import across, moved_points
from drystone.model.assembly import Assembly
from drystone.model.loading import Acting, DeadForces, DeadLoad
from drystone.model.model import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Colours of dead loads and of patterns; the longest arrow over the structure's size.
DEAD, PATTERN = "#7a4b9a", "#2a7f62"
LENGTH = 0.14
#: Forces below this share of the largest are not drawn; the shortest arrow over the longest.
SLIGHT, SHORTEST = 1e-3, 0.3


def arrows_of(
    assembly: Assembly,
    loads: Sequence[DeadForces],
    pose: Array | None = None,
    *,
    present: BoolArray | None = None,
    linear: bool = False,
) -> tuple[IntArray, Array]:
    """Arrows, one for each load on each of its blocks: the blocks' rows (m,), tails and tips (m, 2,
    dim) [m].

    Parameters
    ----------
    pose
        Where the blocks are, (n, n_pose); as designed, where nothing is said.  Arrows go with
        them, and keep their direction.
    present
        Blocks that are drawn, (n,); all, where nothing is said.
    linear
        See `motion.moved_points`.
    """
    most = max((float(np.linalg.norm(load.force, axis=1).max()) for load in loads), default=0.0)
    free = np.vstack([block.vertices for block in assembly.blocks if not block.support])
    longest = LENGTH * float(np.ptp(free, axis=0).max())
    found, on = [np.zeros((0, 2, assembly.dimension))], [np.zeros(0, np.int64)]
    for load in loads:
        size = np.linalg.norm(load.force, axis=1)
        drawn = (size > SLIGHT * most) & (True if present is None else present)
        rows = np.flatnonzero(drawn)
        ways = load.force[rows] / size[rows, None]
        tips = acting_points(assembly, load)[rows]
        begins = [
            assembly.figures[i].entry(tip, way)
            for i, tip, way in zip(rows, tips, ways, strict=True)
        ]
        tips += np.array(begins).reshape(-1, 1) * ways
        if pose is not None:
            tips = moved_points(tips, rows, assembly.centroid, pose, linear=linear)
        lengths = longest * np.maximum(size[rows] / most, SHORTEST)
        on.append(rows)
        found.append(np.stack((tips - lengths[:, None] * ways, tips), axis=1))
    return np.concatenate(on), np.concatenate(found)


def dead_arrows(
    assembly: Assembly,
    loads: Sequence[DeadLoad],
    pose: Array | None = None,
    *,
    present: BoolArray | None = None,
    linear: bool = False,
) -> tuple[IntArray, Array]:
    """Those of dead loads, see `arrows_of`."""
    forces = [load.forces(assembly) for load in loads]
    return arrows_of(assembly, forces, pose, present=present, linear=linear)


def pattern_arrows(model: Model) -> Array:
    """What the pattern puts on every block at multiplier one, (m, 2, dim) [m].

    The pattern `mass` without other masses is told by its direction alone, and has none.
    """
    if model.load.name == "mass":
        return np.zeros((0, 2, model.assembly.dimension))
    pattern = Acting.of(model.assembly, model.load, model.dead_loads, model.ties).pattern
    return arrows_of(model.assembly, [pattern])[1]


def plot_arrows(
    axes: Axes, arrows: Array, seen: Callable[[Array], Array], colour: str, label: str
) -> None:
    """Draw arrows (m, 2, dim); ``seen`` takes places (n, dim) to the picture."""
    if not len(arrows):
        return
    tail, tip = seen(arrows[:, 0])[:, :2], seen(arrows[:, 1])[:, :2]
    axes.quiver(
        *tail.T, *(tip - tail).T, angles="xy", scale_units="xy", scale=1.0, color=colour,
        width=0.004, label=label, zorder=8,
    )  # fmt: skip


def acting_points(assembly: Assembly, loads: DeadForces) -> Array:
    """Points (n, dim) [m] at which the sum of forces has the same moment, nearest the centroid."""
    force, moment = loads.force, loads.moments()
    square = np.maximum((force**2).sum(axis=1, keepdims=True), 1e-300)
    arm = -across(moment, force) / square
    return np.asarray(assembly.centroid + arm)
