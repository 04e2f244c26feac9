"""The curve of supports that move: their reaction against their motion.

Its marks have their values in the legend, so that none is written over another.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from drystone.report import canvas
from drystone.report.quantities import Quantities
from drystone.results.curve import DYNAMIC, CapacityCurve, CurvePoint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Colour of the mark where a part collapses; dark in print.
COLLAPSE = "#b2182b"


def mark_collapse(axes: Axes, displacement: float, value: float) -> None:
    """Mark where a part of the structure collapses first, in the units of the axes."""
    axes.plot(
        displacement,
        value,
        "v",
        color=COLLAPSE,
        markersize=7,
        linestyle="none",
        label="a part collapses",
        zorder=8,
    )


def marked_points(curve: CapacityCurve) -> list[tuple[tuple[str, ...], CurvePoint]]:
    """First, least, greatest and last reaction of the points at rest; each point once, with all
    its names."""
    chosen = curve.marked_reactions
    names: dict[int, list[str]] = {}
    for name, point in chosen.items():
        names.setdefault(point.step, []).append(name)
    by_step = {point.step: point for point in chosen.values()}
    return [(tuple(name), by_step[step]) for step, name in names.items()]


def plot_reaction(axes: Axes, curves: Sequence[tuple[str, CapacityCurve]]) -> None:
    """Draw labelled curves whose supports all go by lengths, or all by angles."""
    canvas.plain_axes(axes)
    quantities = Quantities.of(curves[0][1])
    for i, (label, curve) in enumerate(curves):
        x, y = quantities.x(curve), quantities.y(curve)
        static = curve.column("status") != DYNAMIC
        axes.plot(
            x,
            np.where(static, y, np.nan),
            color=canvas.CURVE_COLOURS[i % len(canvas.CURVE_COLOURS)],
            linestyle=canvas.CURVE_STYLES[i % len(canvas.CURVE_STYLES)],
            linewidth=2.0,
            label=canvas.literal(label) or quantities.force,
            zorder=4,
        )
        if not static.all():
            axes.plot(
                x[~static], y[~static], "o", markersize=4, markerfacecolor="white",
                markeredgecolor=canvas.FAINT, label="dynamic: between states at rest", zorder=3,
            )  # fmt: skip
        if len(curves) == 1:
            _mark(axes, curve, quantities)
    axes.set_xlabel(f"{quantities.motion} [{quantities.motion_unit}]")
    axes.set_ylabel(f"{quantities.force} [{quantities.force_unit}]")
    axes.margins(x=0.03, y=0.06)


def _mark(axes: Axes, curve: CapacityCurve, quantities: Quantities) -> None:
    for (names, point), marker in zip(marked_points(curve), "osDX", strict=False):
        at = quantities.motion_text(point.control_displacement)
        axes.plot(
            quantities.per_unit * point.control_displacement,
            point.reaction,
            marker,
            color=canvas.INK,
            markersize=6,
            linestyle="none",
            label=f"{' and '.join(names)}: {quantities.force_text(point)} at {at}",
            zorder=6,
        )
    first = curve.first_collapse
    if first is not None:
        displacement = quantities.per_unit * first.control_displacement
        mark_collapse(axes, displacement, curve.points[first.step].reaction)
