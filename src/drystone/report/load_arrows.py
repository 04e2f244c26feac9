"""Arrows of loads on a model as designed: dead loads, and patterns that are not of mass alone."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from operator import add
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from drystone.loading import Acting, DeadForces
from drystone.model import Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

#: Colours of dead loads and of patterns; the longest arrow over the structure's size.
DEAD, PATTERN = "#7a4b9a", "#2a7f62"
LENGTH = 0.14
#: Forces below this share of the largest are not drawn.
SLIGHT = 1e-3


def plot_load_arrows(axes: Axes, model: Model, seen: Callable[[Array], Array]) -> None:
    """Draw the sum of dead loads on every block, and what the pattern puts on it at multiplier one.

    Arrows end where the sum acts.  The pattern `mass` without other masses is told by its direction
    alone.  ``seen`` takes places (n, dim) to the picture.
    """
    assembly = model.assembly
    if model.dead_loads:
        loads = reduce(add, (load.forces(assembly) for load in model.dead_loads))
        _plot(axes, model, loads, seen, DEAD, "dead loads")
    if model.load.name != "mass":
        pattern = Acting.of(assembly, model.load, model.dead_loads).pattern
        _plot(axes, model, pattern, seen, PATTERN, f'pattern "{model.load.name}"')


def _plot(
    axes: Axes,
    model: Model,
    loads: DeadForces,
    seen: Callable[[Array], Array],
    colour: str,
    label: str,
) -> None:
    size = np.linalg.norm(loads.force, axis=1)
    rows = np.flatnonzero(size > SLIGHT * size.max(initial=0.0))
    if not len(rows):
        return
    tips = acting_points(model, loads)[rows]
    vertices = np.vstack([block.vertices for block in model.assembly.blocks if not block.support])
    longest = LENGTH * float(np.ptp(vertices, axis=0).max())
    ways = longest * loads.force[rows] / size.max()
    tail, tip = seen(tips - ways), seen(tips)
    way = tip - tail
    axes.quiver(
        *tail[:, :2].T, *way[:, :2].T, angles="xy", scale_units="xy", scale=1.0, color=colour,
        width=0.004, label=label, zorder=8,
    )  # fmt: skip


def acting_points(model: Model, loads: DeadForces) -> Array:
    """Points (n, dim) [m] at which the sum of forces has the same moment, nearest the centroid."""
    force, moment = loads.force, loads.moments()
    square = np.maximum((force**2).sum(axis=1, keepdims=True), 1e-300)
    if force.shape[1] == 2:
        arm = moment * np.column_stack((force[:, 1], -force[:, 0])) / square
    else:
        arm = np.cross(force, moment) / square
    return np.asarray(model.assembly.centroid + arm)
