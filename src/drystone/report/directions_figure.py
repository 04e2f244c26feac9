"""Curves of several directions in one picture, and the peaks around the structure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drystone.report import canvas
from drystone.report.curve_figure import DISPLACEMENT, MULTIPLIER


@dataclass(frozen=True, kw_only=True)
class Traced:
    """A curve and where it leads."""

    angle: float  # degrees, from the first direction
    curve: Sequence[tuple[float, float]]  # control displacement [m] and load multiplier


def draw_directions(traced: Sequence[Traced], path: Path | str, *, title: str = "") -> None:
    """Write the picture: peaks around the structure where there are more than two directions, and
    all curves.

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
    colours = _colours([one.angle for one in traced])
    if around:
        figure.add_gridspec(1, 2)
        polar = figure.add_subplot(1, 2, 1, projection="polar")
        angle = np.radians([one.angle for one in traced])
        peak = np.array([max(multiplier for _, multiplier in one.curve) for one in traced])
        polar.plot(np.append(angle, angle[0]), np.append(peak, peak[0]), color=canvas.INK, lw=1.2)
        for a, p, colour in zip(angle, peak, colours, strict=True):
            polar.plot([a], [p], "o", color=colour, ms=5)
        polar.set_ylim(0.0, 1.1 * max(float(peak.max()), 1e-12))
        polar.set_title("peak multiplier by direction", fontsize=10)
        polar.tick_params(labelsize=8)
    axes = figure.add_subplot(1, 2 if around else 1, 2 if around else 1)
    for one, colour in zip(traced, colours, strict=True):
        x, y = np.array(one.curve, float).T
        axes.plot(x, y, color=colour, lw=1.2, label=f"{one.angle:g}°")
    axes.set_xlabel(f"{DISPLACEMENT} [m]")
    axes.set_ylabel(MULTIPLIER)
    axes.axhline(0.0, color=canvas.FAINT, lw=0.8)
    axes.legend(fontsize=8, frameon=False, ncols=1 + len(traced) // 13)
    canvas.plain_axes(axes)
    canvas.save(figure, path)


def _colours(angles: Sequence[float]) -> list[str | tuple[float, float, float]]:
    """Two that differ most, else around a circle, so that opposite directions differ most."""
    if len(angles) <= 2:
        return list(canvas.CURVE_COLOURS[: len(angles)])
    from matplotlib.colors import hsv_to_rgb

    rows = [hsv_to_rgb((angle % 360.0 / 360.0, 0.75, 0.75)) for angle in angles]
    return [(float(r), float(g), float(b)) for r, g, b in rows]
