"""The capacity curve as a picture: load multiplier against control displacement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array
from drystone.report import canvas
from drystone.report.quantities import MILLIMETRES_BELOW, length_text
from drystone.report.reaction_figure import mark_collapse, plot_reaction
from drystone.results.curve import DYNAMIC, CapacityCurve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Label, control displacement [m], load multiplier.
Reference = tuple[str, Array, Array]
Labelled = Sequence[tuple[str, CapacityCurve]]

#: A peak nearer to the origin than this share of the curve gets a second panel of its own.
STEEP = 0.1
#: Share of the range of multipliers at rest by which points in motion are shown beyond it.
IN_MOTION = 0.5
#: A peak beyond this share of the curve has its words on the left.
LEFTWARDS = 0.5
#: Dynamic points marked on one curve, about: more would run into each other.
MOST_MARKERS = 60
DISPLACEMENT, MULTIPLIER = "control displacement $δ_c$", "load multiplier $λ$ [-]"


@dataclass(frozen=True, kw_only=True)
class Unit:
    """Unit of the displacement axis."""

    name: str
    per_metre: float


METRE, MILLIMETRE = Unit(name="m", per_metre=1.0), Unit(name="mm", per_metre=1e3)


# Long: it is asked for in many ways, which its docstring lists.
def draw_curve(
    curves: CapacityCurve | Labelled,
    path: Path | str,
    *,
    reference: Sequence[Reference] = (),
    limits: Mapping[str, float] | None = None,
    title: str = "",
    format: str = "png",
) -> None:
    """Write ``curve.png``.

    Parameters
    ----------
    curves
        One curve, or several with their labels.
    path
        File to write.
    reference
        Recorded curves to compare with.
    limits
        Multipliers of limit analysis by label, drawn as horizontal lines.
    title
        Above the picture.
    format
        Of the file: "png", "svg" or "pdf".
    """
    labelled = [("", curves)] if isinstance(curves, CapacityCurve) else list(curves)
    labelled = [(label, curve) for label, curve in labelled if curve.points]
    if any(curve.moves_supports for _, curve in labelled):
        _draw_reaction(labelled, path, title, format)
        return
    unit = _unit(labelled, reference)
    furthest = max((_furthest(curve) for _, curve in labelled), default=0.0)
    peak_at = max((curve.capacity.control_displacement for _, curve in labelled), default=0.0)
    cyclic = any(curve.is_cyclic for _, curve in labelled)
    steep = not cyclic and 0.0 < peak_at < STEEP * furthest

    figure = canvas.new_figure(10.0 if steep else 7.5, 5.4)
    if title:
        figure.suptitle(canvas.literal(title), fontsize=12)
    panels = (
        figure.subplots(1, 2, width_ratios=(2.3, 1.0), sharey=True)
        if steep
        else [figure.subplots()]
    )
    plot_curves(panels[0], labelled, unit=unit, reference=reference, limits=limits)
    handles, labels = panels[0].get_legend_handles_labels()
    if steep:
        plot_curves(
            panels[1], labelled, unit=MILLIMETRE, reference=reference, limits=limits, marks=False
        )
        panels[1].set_xlim(0.0, 4.0 * peak_at * MILLIMETRE.per_metre)
        panels[1].set_title("ascending branch and peak", fontsize=9)
        panels[1].set_ylabel("")
    if labels:
        figure.legend(
            handles,
            labels,
            loc="outside lower center",
            ncols=2 if cyclic else 3,
            fontsize=9,
            frameon=False,
        )
    canvas.save(figure, path, format)


def _draw_reaction(labelled: Labelled, path: Path | str, title: str, format: str) -> None:
    figure = canvas.new_figure(7.5, 5.4)
    if title:
        figure.suptitle(canvas.literal(title), fontsize=12)
    axes = figure.subplots()
    plot_reaction(axes, labelled)
    figure.legend(loc="outside lower center", ncols=2, fontsize=9, frameon=False)
    canvas.save(figure, path, format)


def plot_curves(
    axes: Axes,
    curves: Labelled,
    *,
    unit: Unit = METRE,
    reference: Sequence[Reference] = (),
    limits: Mapping[str, float] | None = None,
    marks: bool = True,
    branches: bool = True,
    first: int = 0,
) -> None:
    """Draw labelled curves on given axes.

    A single curve has its peak and end written beside it (``marks``) and its two branches told
    apart (``branches``).  Colours and line styles of several begin with number ``first``.
    """
    cyclic = any(curve.is_cyclic for _, curve in curves)  # loops have neither branches nor an end
    branches = branches and len(curves) == 1 and not cyclic
    marks = marks and not cyclic
    canvas.plain_axes(axes)
    if branches:
        _plot_branches(axes, curves[0][1], unit)
    for i, (label, curve) in enumerate(curves):
        if not branches:
            _plot_whole(axes, label, curve, unit, first + i)
    _plot_dynamic(axes, [curve for _, curve in curves], unit)
    _plot_beside(axes, unit, reference, limits or {})
    if marks and len(curves) == 1:
        _mark_peak(axes, curves[0][1], unit)
        _mark_end(axes, curves[0][1], unit, _of_rest(axes, curves, reference, limits or {}))
    if branches:
        _mark_collapse(axes, curves[0][1], unit)
    axes.set_xlabel(f"{DISPLACEMENT} [{unit.name}]")
    axes.set_ylabel(MULTIPLIER)
    axes.margins(x=0.02, y=0.04)
    left, right = axes.get_xlim()
    bottom, top = _of_rest(axes, curves, reference, limits or {})
    # A curve fills the axes; its marks need a margin above the peak and after the end.
    beside = 0.16 * (right - left) if marks and len(curves) == 1 else 0.0
    above = 0.06 * (top - bottom) if marks and len(curves) == 1 else 0.0
    axes.set_xlim(0.0 if _never_negative(curves, "control_displacement") else left, right + beside)
    axes.set_ylim(0.0 if _never_negative(curves, "load_multiplier") else bottom, top + above)


def _of_rest(
    axes: Axes, curves: Labelled, reference: Sequence[Reference], limits: Mapping[str, float]
) -> tuple[float, float]:
    """The range of multipliers to be shown: what is passed in motion may go far beyond it."""
    at_rest = [_static(curve, METRE)[1] for _, curve in curves]
    values = np.concatenate([[0.0], list(limits.values()), *at_rest, *(y for _, _, y in reference)])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    bottom, top = axes.get_ylim()
    if not high > low:
        return bottom, top
    beyond = IN_MOTION * (high - low)
    return max(bottom, low - beyond), min(top, high + beyond)


def _plot_beside(
    axes: Axes, unit: Unit, reference: Sequence[Reference], limits: Mapping[str, float]
) -> None:
    """Curves of others, and multipliers of limit analysis."""
    for i, (label, x, y) in enumerate(reference):
        grey = ("#6f6f6f", "#a0a0a0", "#404040")[i % 3]
        axes.plot(
            x * unit.per_metre,
            y,
            color=grey,
            linewidth=1.0,
            linestyle=":",
            label=canvas.literal(label),
            zorder=2,
        )
    for i, (label, multiplier) in enumerate(limits.items()):
        style = ("--", "-.", ":")[i % 3]
        axes.axhline(
            multiplier,
            color=canvas.FAINT,
            linewidth=1.0,
            linestyle=style,
            label=f"{label}: {multiplier:.3f}",
            zorder=1,
        )


def _plot_branches(axes: Axes, curve: CapacityCurve, unit: Unit) -> None:
    """One curve: up to the peak, after it, and of what is left if that bears more, in colours."""
    x, y = _static(curve, unit)
    top, first, last = curve.points.index(curve.capacity), curve.first_collapse, len(x) - 1
    if first is not None and curve.rises_after_collapse:
        last = len(curve.until(first).points) - 1
    style: dict[str, Any] = {"linewidth": 2.0, "solid_capstyle": "round", "zorder": 4}
    branches = {
        "ascending branch": (0, top),
        "post-peak branch": (top, last),
        "after a part collapsed": (last, len(x) - 1),
    }
    for (label, (begin, end)), colour in zip(branches.items(), canvas.CURVE_COLOURS, strict=False):
        along = slice(begin, end + 1)
        known = np.isfinite(y[along])
        drawn = bool((known[1:] & known[:-1]).any())  # not where all of it is passed in motion
        if drawn or label == "ascending branch":
            axes.plot(x[along], y[along], color=colour, label=label, **style)


def _plot_whole(axes: Axes, label: str, curve: CapacityCurve, unit: Unit, i: int) -> None:
    """One curve of several: its own colour and line style, its values in the legend."""
    x, y = _static(curve, unit)
    peak = curve.peak
    colour = canvas.CURVE_COLOURS[i % len(canvas.CURVE_COLOURS)]
    style = canvas.CURVE_STYLES[i % len(canvas.CURVE_STYLES)]
    if curve.rises_after_collapse:
        peak = curve.capacity
    name = "capacity" if curve.rises_after_collapse else curve.name_of_peak
    text = f"{canvas.literal(label)}: {name} {peak.load_multiplier:.3f}".removeprefix(": ")
    if curve.is_cyclic:
        lowest = curve.lowest.load_multiplier
        text = f"{canvas.literal(label)}: {lowest:.3f} to {peak.load_multiplier:.3f}"
        text = text.removeprefix(": ")
    if curve.ultimate_displacement is not None:
        where = "collapses" if curve.ends_in_motion else f"at {curve.stop_multiplier:.3g}"
        text += f", {curve.ultimate_displacement:.3g} m {where}"
    axes.plot(
        x,
        y,
        color=colour,
        linestyle=style,
        linewidth=1.0 if curve.is_cyclic else 1.6,
        label=text,
        zorder=4,
    )
    axes.plot(
        peak.control_displacement * unit.per_metre,
        peak.load_multiplier,
        "o",
        color=colour,
        markersize=5,
        zorder=5,
    )


def _plot_dynamic(axes: Axes, curves: Sequence[CapacityCurve], unit: Unit) -> None:
    """Points on the way of a jump: hollow, on a grey dashed line, with their static neighbours."""
    label: str | None = "dynamic: between states at rest"
    for curve in curves:
        dynamic = curve.column("status") == DYNAMIC
        if not dynamic.any():
            continue
        near = dynamic.copy()
        near[1:] |= dynamic[:-1]
        near[:-1] |= dynamic[1:]
        x, y = curve.control_displacement * unit.per_metre, curve.load_multiplier
        axes.plot(
            np.where(near, x, np.nan),
            y,
            color=canvas.FAINT,
            linewidth=1.0,
            linestyle="--",
            zorder=3,
        )
        every = max(1, int(dynamic.sum()) // MOST_MARKERS)
        axes.plot(
            x[dynamic][::every],
            y[dynamic][::every],
            "o",
            markersize=4,
            markerfacecolor="white",
            markeredgecolor=canvas.FAINT,
            linestyle="none",
            label=label,
            zorder=3,
        )
        label = None  # once in the legend


def _mark_peak(axes: Axes, curve: CapacityCurve, unit: Unit) -> None:
    peak, name = curve.peak, curve.name_of_peak
    if curve.rises_after_collapse:
        x = peak.control_displacement * unit.per_metre
        axes.plot(
            x, peak.load_multiplier, "o", color=canvas.FAINT, markerfacecolor="white",
            markersize=6, zorder=6, label=f"{name}: {peak.load_multiplier:.3f}", linestyle="none",
        )  # fmt: skip
        peak, name = curve.capacity, "capacity"
    x = peak.control_displacement * unit.per_metre
    axes.plot(
        x, peak.load_multiplier, "o", color=canvas.INK, markersize=6, zorder=6, label=name,
        linestyle="none",
    )  # fmt: skip
    left = x > LEFTWARDS * _furthest(curve) * unit.per_metre  # else it would leave the axes
    axes.annotate(
        f"{name}  $λ$ = {peak.load_multiplier:.3f}  at  {length_text(peak.control_displacement)}",
        (x, peak.load_multiplier),
        xytext=(-8 if left else 8, 8),
        ha="right" if left else "left",
        textcoords="offset points",
        fontsize=10,
        bbox=canvas.BACKING,
        zorder=7,
    )


def _mark_collapse(axes: Axes, curve: CapacityCurve, unit: Unit) -> None:
    """Where the first part of the structure collapses, unless the curve ends with it."""
    first = curve.first_collapse
    if first is None:
        return
    if not any(point.status != DYNAMIC for point in curve.points[first.step + 1 :]):
        return
    mark_collapse(axes, first.control_displacement * unit.per_metre, first.load_multiplier)


def _mark_end(axes: Axes, curve: CapacityCurve, unit: Unit, shown: tuple[float, float]) -> None:
    """The ultimate displacement, or where and why the curve breaks off before.

    ``shown`` is the range of multipliers that the axes show.  A curve may break off in motion far
    beyond it: a mark out there would squeeze the axes to nothing.
    """
    ultimate, last = curve.ultimate_displacement, curve.points[-1]
    if ultimate is not None and curve.ends_in_motion:
        last = curve.at_rest[-1]
        x, y = ultimate * unit.per_metre, last.load_multiplier
        text, label = f"collapses at\n{length_text(ultimate)}", "ultimate displacement"
        marker, face = "D", canvas.INK
    elif ultimate is not None:
        x, y = ultimate * unit.per_metre, curve.stop_multiplier
        text, label = f"{length_text(ultimate)}\nat $λ$ = {y:.3g}", "ultimate displacement"
        marker, face = "D", canvas.INK
    else:
        x, y = last.control_displacement * unit.per_metre, last.load_multiplier
        text, label = f"ends at\n{length_text(last.control_displacement)}", f"curve {curve.status}"
        y = float(np.clip(y, *shown))
        marker, face = "X", canvas.CURVE_COLOURS[1]
    axes.plot(
        x,
        y,
        marker,
        color=face,
        markersize=6,
        linestyle="none",
        label=label,
        zorder=6,
        clip_on=False,
    )
    if last is curve.capacity:
        return  # what is written at the peak says where that is
    axes.annotate(
        text,
        (x, y),
        xytext=(9, 4),
        textcoords="offset points",
        fontsize=10,
        bbox=canvas.BACKING,
        zorder=7,
    )


def _static(curve: CapacityCurve, unit: Unit) -> tuple[Array, Array]:
    """The curve with its dynamic points taken out, so that the line breaks there."""
    static = curve.column("status") != DYNAMIC
    return curve.control_displacement * unit.per_metre, np.where(
        static, curve.load_multiplier, np.nan
    )


def _furthest(curve: CapacityCurve) -> float:
    return float(np.nanmax(np.abs(curve.control_displacement)))


def _unit(curves: Labelled, reference: Sequence[Reference]) -> Unit:
    reach = [_furthest(curve) for _, curve in curves] + [float(np.max(x)) for _, x, _ in reference]
    return MILLIMETRE if max(reach, default=1.0) < MILLIMETRES_BELOW else METRE


def _never_negative(curves: Labelled, name: str) -> bool:
    """Whether a quantity stays above zero but for noise of a thousandth of its range."""
    values = np.concatenate([curve.column(name) for _, curve in curves]) if curves else np.zeros(1)
    return bool(np.nanmin(values) >= -1e-3 * np.nanmax(np.abs(values)))
