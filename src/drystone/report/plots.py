"""Pictures on axes of one's own, for notebooks and scripts: curves, a model, a mechanism."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from drystone.common.arrays import Array
from drystone.contact.forces import ContactForces
from drystone.model.model import Model
from drystone.report import curve_figure, mechanism_figure
from drystone.report.directions_figure import Traced, plot_around, plot_directions
from drystone.report.mechanism import Mechanism, readable_magnification
from drystone.report.reaction_figure import plot_reaction
from drystone.results.curve import CapacityCurve

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

    from drystone.analysis.directions import Polar


def plot_curve(
    curve: CapacityCurve,
    ax: Axes | None = None,
    *,
    label: str = "",
    limits: Mapping[str, float] | None = None,
) -> Axes:
    """Draw a curve, load multiplier against control displacement [m]; of supports that move their
    reaction [N, N m] against their motion [m, degrees].

    Parameters
    ----------
    curve
        Of at least one point.
    ax
        Axes to draw on; those of a new figure by default.
    label
        For one curve among several on the same axes: each then has a colour of its own, its peak
        and end in the legend instead of beside it.
    limits
        Multipliers of limit analysis by label, drawn as horizontal lines.
    """
    ax = _axes(ax, (7.0, 4.5))
    if curve.moves_supports:
        plot_reaction(ax, [(label, curve)])
        ax.legend(fontsize=9, edgecolor="none", facecolor="white", framealpha=0.85)
        return ax
    ax.autoscale(True)  # an earlier curve has set the limits
    curve_figure.plot_curves(
        ax,
        [(label, curve)],
        limits=limits,
        marks=not label,
        branches=not label,
        first=sum(_is_curve(line) for line in ax.get_lines()),
    )
    ax.legend(fontsize=9, edgecolor="none", facecolor="white", framealpha=0.85)
    return ax


def plot_mechanism(
    model: Model,
    pose: Array,
    ax: Axes | None = None,
    *,
    initial: Array | None = None,
    contacts: ContactForces | None = None,
    magnification: float | None = None,
) -> Axes:
    """Draw the blocks where they are: joints that opened in red, those that slid in blue.

    Parameters
    ----------
    model
        What was analysed.
    pose
        Of one point, (n, n_pose), as in ``curve.poses[k]``.
    ax
        Axes to draw on; those of a new figure by default.
    initial
        Where the load began, as in ``curve.poses[0]``: what moves has moved since.
    contacts
        Of the same point, as in ``curve.contacts[k]``: those under load are drawn, in the plane.
    magnification
        Of the displacements; by default 1, or what makes small ones visible.
    """
    pose = np.asarray(pose, dtype=np.float64)
    wanted = model.assembly.design_pose().shape
    if pose.shape != wanted:
        raise ValueError(
            f"the pose of one point has the shape {wanted}, this one has {pose.shape}: "
            "take one of the curve's, as in curve.poses[-1]"
        )
    if magnification is None:
        magnification = readable_magnification(model.assembly, pose, initial)
    ax = _axes(ax, (7.0, 6.0))
    mechanism_figure.plot_mechanism(
        ax,
        Mechanism(
            assembly=model.assembly,
            pose=pose,
            initial=initial,
            contacts=contacts,
            load_direction=model.load_shown,
            control_point=model.control_point,
            ties=model.ties,
            dead_loads=model.dead_loads,
            magnification=magnification,
        ),
    )
    if magnification != 1.0:
        ax.set_title(f"displacements magnified {magnification:g} times", fontsize=9)
    return ax


def plot_model(model: Model, ax: Axes | None = None) -> Axes:
    """Draw a model as designed: blocks, supports, the load's direction, the control point."""
    return plot_mechanism(model, model.assembly.design_pose(), ax)


def plot_polar(polar: Polar, ax: Axes | None = None) -> Axes:
    """Draw what a structure bears by direction before a part of it collapses.

    Parameters
    ----------
    polar
        At least one of its curves has a point.
    ax
        Axes to draw on; those of a new figure by default. They must be polar where there are more
        than two directions; of two directions the curves are drawn.
    """
    traced = [
        Traced.of(angle, curve)
        for angle, curve in zip(polar.angles, polar.curves, strict=True)
        if curve is not None and curve.points
    ]
    if len(polar.angles) <= 2:
        ax = _axes(ax, (7.0, 4.5))
        plot_directions(ax, traced)
        return ax
    ax = _axes(ax, (5.5, 5.5), projection="polar")
    if ax.name != "polar":
        raise ValueError("directions all around need polar axes: subplots(projection='polar')")
    plot_around(ax, traced)
    return ax


def _is_curve(line: Line2D) -> bool:
    """Whether a line on the axes is a curve with a label of its own, not its marks."""
    return not str(line.get_label()).startswith("_") and line.get_linestyle() != "None"


def _axes(ax: Axes | None, size: tuple[float, float], projection: str | None = None) -> Axes:
    """The given axes, or those of a new figure that a notebook shows."""
    if ax is not None:
        return ax
    from matplotlib import pyplot

    kind = {"projection": projection}
    return pyplot.subplots(figsize=size, layout="constrained", subplot_kw=kind)[1]
