"""Curves of several directions in one picture, and what the structure bears all around."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.report import canvas
from drystone.report.curve_figure import DISPLACEMENT, MULTIPLIER
from drystone.results.curve import STATIC

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from drystone.results.curve import CapacityCurve


Colour = str | tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Traced:
    """A curve and where it leads."""

    angle: float  # degrees, from the first direction
    curve: Sequence[tuple[float, float]]  # control displacement [m] and multiplier, at rest
    capacity: tuple[float, float]  # likewise, of the highest point before a part collapses
    rises_after_collapse: bool  # whether what is left then bears more

    @classmethod
    def of(cls, angle: float, curve: CapacityCurve) -> Traced:
        """Of a curve that has a point."""
        most = curve.capacity
        return cls(
            angle=angle,
            curve=at_rest(curve),
            capacity=(most.control_displacement, most.load_multiplier),
            rises_after_collapse=curve.rises_after_collapse,
        )


def at_rest(curve: CapacityCurve) -> list[tuple[float, float]]:
    """Control displacement [m] and load multiplier of the points at rest."""
    resting = (point for point in curve.points if point.status == STATIC)
    return [(point.control_displacement, point.load_multiplier) for point in resting]


def draw_directions(traced: Sequence[Traced], path: Path | str, *, title: str = "") -> None:
    """Write the picture: what the structure bears all around where there are more than two
    directions, and all curves.

    Parameters
    ----------
    traced
        At least one curve, of at least one point.
    path
        PNG file to write.
    title
        Above the picture.
    """
    around = len(traced) > 2
    figure = canvas.new_figure(11.0 if around else 7.5, 5.4)
    if title:
        figure.suptitle(canvas.literal(title), fontsize=12)
    if around:
        figure.add_gridspec(1, 2)
        plot_around(figure.add_subplot(1, 2, 1, projection="polar"), traced)
    plot_directions(figure.add_subplot(1, 2 if around else 1, 2 if around else 1), traced)
    canvas.save(figure, path)


def plot_around(polar: Axes, traced: Sequence[Traced]) -> None:
    """Draw the multiplier before a part collapses by direction, on polar axes."""
    angle = np.radians([one.angle for one in traced])
    most = np.array([one.capacity[1] for one in traced])
    polar.plot(np.append(angle, angle[0]), np.append(most, most[0]), color=canvas.INK, lw=1.2)
    for one, a, m, colour in zip(traced, angle, most, _colours(traced), strict=True):
        polar.plot([a], [m], **_mark(one, colour), ms=5)
    polar.set_ylim(0.0, 1.1 * max(float(most.max()), 1e-12))
    collapses = any(one.rises_after_collapse for one in traced)
    what = "multiplier before a part collapses" if collapses else "peak multiplier"
    polar.set_title(f"{what}, by direction", fontsize=10)
    polar.tick_params(labelsize=8)


def plot_directions(axes: Axes, traced: Sequence[Traced]) -> None:
    """Draw all curves; a ring marks where a part collapses that what is left outlasts."""
    for one, colour in zip(traced, _colours(traced), strict=True):
        x, y = np.array(one.curve, float).T
        axes.plot(x, y, color=colour, lw=1.2, label=f"{one.angle:g}°")
        if one.rises_after_collapse:
            axes.plot(*one.capacity, **_mark(one, colour), ms=5, zorder=5)
    if any(one.rises_after_collapse for one in traced):
        axes.plot([], [], "o", color=canvas.INK, mfc="white", label="before a part collapses", ms=5)
    axes.set_xlabel(f"{DISPLACEMENT} [m]")
    axes.set_ylabel(MULTIPLIER)
    axes.axhline(0.0, color=canvas.FAINT, lw=0.8)
    axes.legend(fontsize=8, frameon=False, ncols=1 + len(traced) // 13)
    canvas.plain_axes(axes)


def _mark(one: Traced, colour: Colour) -> dict[str, Any]:
    """A dot in the colour of the direction; a ring where a part collapses there."""
    ring = {"mfc": "white"} if one.rises_after_collapse else {}
    return {"color": colour, "marker": "o", "ls": "none", **ring}


def _colours(traced: Sequence[Traced]) -> list[Colour]:
    """Two that differ most, else around a circle, so that opposite directions differ most."""
    if len(traced) <= 2:
        return list(canvas.CURVE_COLOURS[: len(traced)])
    from matplotlib.colors import hsv_to_rgb

    rows = [hsv_to_rgb((one.angle % 360.0 / 360.0, 0.75, 0.75)) for one in traced]
    return [(float(r), float(g), float(b)) for r, g, b in rows]
