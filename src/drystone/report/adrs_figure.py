"""Capacity and demand in one picture: spectral acceleration against spectral displacement."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.assessment.methods.base import Assessment, LimitState
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum
from drystone.common.arrays import Array
from drystone.common.language import Saying, say
from drystone.report import canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Periods [s] whose rays are drawn where they fit.
PERIODS = (0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0)
#: Periods [s] at which demand spectra are drawn.
GRID = np.concatenate((np.linspace(0.0, 0.6, 121), np.geomspace(0.605, 12.0, 400)))
#: Markers of limit states, in their order.
MARKERS = ("o", "s", "D", "^", "v")
SMALL = 8.5
#: Letters of a label from which on the legend has one column.
LONG_LABEL = 48


def draw_adrs(
    answer: Assessment, path: Path | str, *, title: str = "", format: str = "png"
) -> None:
    """Write the picture: capacity, bilinear, demand spectra by damping, rays of period, states.

    Parameters
    ----------
    answer
        Of a method; one that uses no spectra is drawn without demand.
    path
        File to write.
    title
        Above the picture.
    format
        Of the file: "png", "svg" or "pdf".
    """
    figure = canvas.new_figure(8.0, 5.6)
    if title:
        figure.suptitle(canvas.literal(title), fontsize=12)
    axes = figure.subplots()
    plot_adrs(axes, answer)
    handles, labels = axes.get_legend_handles_labels()
    columns = 2 if max(map(len, labels)) <= LONG_LABEL else 1
    figure.set_size_inches(8.0, 4.6 + 0.22 * math.ceil(len(labels) / columns))
    figure.legend(
        handles, labels, loc="outside lower center", ncols=columns, fontsize=SMALL, frameon=False
    )
    canvas.save(figure, path, format)


def plot_adrs(axes: Axes, answer: Assessment) -> None:
    """Draw it on given axes, in m and m/s2."""
    canvas.plain_axes(axes)
    d, a = capacity_line(answer)
    axes.plot(
        d, a, color=canvas.CURVE_COLOURS[0], linewidth=2.2, label=capacity_name(answer), zorder=5
    )
    if answer.bilinear is not None:
        b = answer.bilinear
        axes.plot(
            [0.0, b.yield_displacement, b.ultimate_displacement],
            [0.0, b.yield_acceleration, b.yield_acceleration],
            color=canvas.INK,
            linestyle=(0, (5, 2)),
            linewidth=1.3,
            label=say("picture.bilinear").spoken,
            zorder=4,
        )
    states = [s for s in answer.limit_states if s.limit_displacement is not None]
    right = 1.08 * max([float(d.max()), *(s.displacement_demand or 0.0 for s in states)])
    demands = demands_of(answer)
    top = height_of(float(a.max()), demands, right)
    for i, (label, spectrum, damping) in enumerate(demands):
        plot_demand(axes, i, spectrum.sd(GRID, damping), spectrum.sa(GRID, damping), label)
    axes.set_xlim(0.0, right)
    axes.set_ylim(0.0, top)
    plot_rays(axes, right, top)
    for i, state in enumerate(states):
        _mark(axes, answer, state, MARKERS[i % len(MARKERS)])
    axes.set_xlabel(say("picture.d").spoken)
    axes.set_ylabel(say("picture.a").spoken)


def capacity_line(answer: Assessment) -> tuple[Array, Array]:
    """The curve with its collapse as last point, over the confidence factor."""
    capacity = answer.capacity
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    end = capacity.spectral_collapse_displacement
    if end is not None:
        before = d < end
        d, a = np.append(d[before], end), np.append(a[before], 0.0)
    return d, a / (answer.confidence_factor or 1.0)


def capacity_name(answer: Assessment) -> str:
    """The name of the capacity, in the language that is spoken."""
    factor = answer.confidence_factor
    over = say("verdict.nothing")
    if factor and factor != 1.0:
        over = say("screen.over_factor", factor=factor)
    return say("picture.capacity", reading=answer.capacity.reading, over=over).spoken


def verdict_on(state: LimitState) -> Saying:
    """Whether a limit state holds, in a word; of one that no verdict rests on, that."""
    if not state.verified:
        return say("picture.no_part")
    keys = {True: "picture.holds", False: "picture.fails", None: "picture.unverified"}
    return say(keys[state.satisfied])


def name_of(state: LimitState) -> str:
    """A limit state and its limit, in the language that is spoken."""
    known = {"state": state.name, "limit": state.limit_displacement, "answer": verdict_on(state)}
    return say("picture.limit", **known).spoken


def name_with_demand(state: LimitState) -> str:
    """A limit state, its limit and its demand, in the language that is spoken."""
    return say(
        "picture.limit_and_demand",
        state=state.name,
        limit=state.limit_displacement,
        answer=verdict_on(state),
        demand=state.displacement_demand,
        period=state.limit_period,
    ).spoken


def demands_of(answer: Assessment) -> list[tuple[str, Spectrum, float]]:
    """Demand spectra with their labels: one for each ground motion and damping."""
    found: dict[tuple[int, float], tuple[list[str], Spectrum]] = {}
    for state in answer.limit_states:
        spectrum = answer.spectra.get(state.name)
        if spectrum is not None:
            damping = REFERENCE_DAMPING if state.damping is None else state.damping
            names, _ = found.setdefault((id(spectrum), damping), ([], spectrum))
            names.append(state.name)
    return [
        (
            say("picture.demand", states=names, percent=100.0 * damping).spoken,
            spectrum,
            damping,
        )
        for (_, damping), (names, spectrum) in found.items()
    ]


def height_of(highest: float, demands: list[tuple[str, Spectrum, float]], right: float) -> float:
    """Height of the axes [m/s2]: all of the capacity, and of the demand what fits beside it."""
    plateaus = [
        float(spectrum.sa(GRID, damping)[spectrum.sd(GRID, damping) <= right].max(initial=0.0))
        for _, spectrum, damping in demands
    ]
    return 1.12 * max(highest, min(max(plateaus, default=0.0), 2.0 * highest))


def plot_demand(axes: Axes, i: int, x: Array, y: Array, label: str) -> None:
    """A spectrum, the i-th of a picture, in a colour and a line that no capacity has."""
    k = 1 + i % (len(canvas.CURVE_COLOURS) - 1)
    colour, style = canvas.CURVE_COLOURS[k], canvas.CURVE_STYLES[k]
    axes.plot(x, y, color=colour, linestyle=style, linewidth=1.4, label=label, zorder=3)


def plot_rays(axes: Axes, right: float, top: float) -> None:
    """Lines of equal period through the origin, named where they leave the picture."""
    for period in PERIODS:
        slope = (2.0 * np.pi / period) ** 2
        x = min(right, top / slope)
        if x < 0.02 * right or slope * x < 0.03 * top:
            continue
        axes.plot([0.0, x], [0.0, slope * x], color="#bbbbbb", linewidth=0.7, zorder=1)
        leaves_above = x < right
        axes.annotate(
            say("picture.seconds", period=period).spoken,
            (x, slope * x),
            xytext=(0, 2) if leaves_above else (3, 0),
            textcoords="offset points",
            ha="center" if leaves_above else "left",
            va="bottom" if leaves_above else "center",
            fontsize=8,
            color="#777777",
            annotation_clip=False,
        )


def mark_of(
    answer: Assessment, state: LimitState
) -> tuple[float, float, float | None, float | None]:
    """Limit (d*, a*) and demand (d*, a*) of a limit state [m, m/s2]; None without a demand."""
    limit = state.limit_displacement
    assert limit is not None
    height = state.limit_acceleration
    if height is None:
        height = float(np.interp(limit, *capacity_line(answer)))
    demand = state.displacement_demand
    if demand is None or not state.limit_period:
        return limit, height, None, None
    if answer.bilinear is None:
        return limit, height, demand, demand * (2.0 * np.pi / state.limit_period) ** 2
    # Inelastic: no point of the elastic spectrum.
    return limit, height, demand, float(answer.bilinear.at(demand))


def _mark(axes: Axes, answer: Assessment, state: LimitState, marker: str) -> None:
    """A limit state on the capacity, and what the ground asks of it."""
    limit, height, demand, across = mark_of(answer, state)
    style: dict[str, Any] = {"linestyle": "none", "markersize": 7, "zorder": 6, "clip_on": False}
    axes.plot(
        limit,
        height,
        marker,
        color=canvas.INK,
        label=name_of(state),
        **style,
    )
    axes.annotate(
        state.name,
        (limit, height),
        xytext=(6, 6),
        textcoords="offset points",
        fontsize=9,
        zorder=7,
    )
    if demand is not None and across is not None:
        across = min(across, axes.get_ylim()[1])  # of what lies above the picture, the place
        axes.plot(
            [demand, demand],
            [0.0, across],
            color=canvas.FAINT,
            linewidth=0.9,
            linestyle=":",
            zorder=2,
        )
        axes.plot(
            demand,
            across,
            marker,
            markerfacecolor="white",
            markeredgecolor=canvas.INK,
            label=name_with_demand(state),
            **style,
        )
