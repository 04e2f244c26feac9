"""Pictures of the report: the curve, the structure in a state, demand and capacity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from drystone.assessment.spectra.base import Spectrum
from drystone.common.arrays import Array
from drystone.common.language import number, spoken
from drystone.model.assembly import GRAVITY
from drystone.model.ties import ELASTIC
from drystone.report import Mechanism, canvas
from drystone.report.adrs_figure import plot_demand, plot_rays
from drystone.report.load_arrows import DEAD
from drystone.report.marks import TIES
from drystone.report.mechanism import MOVING, OPEN_JOINT, RESTING, SLID_JOINT, SUPPORT, Drawn
from drystone.report.mechanism_figure import mechanism_element
from drystone.report.quantities import Quantities
from drystone.report.viewer import Mark
from drystone.results.curve import DYNAMIC, CapacityCurve

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Width of the page's text [inches], so that letters keep their size.
WIDE = 6.7
LIMIT = "#c1440e"
#: A mark beyond this share of the axes has its name on its left.
LEFTWARDS = 0.72
#: Lines in a legend by the line styles of pictures.
BORDERS = {"-": "solid", "--": "dashed", ":": "dotted"}


def curve_picture(
    curves: Sequence[tuple[str, CapacityCurve]], marks: Sequence[Mark], words: Mapping[str, str]
) -> str:
    """The first curve with its marks, and others beside it, dashed; empty without a point."""
    shown = [(name, curve) for name, curve in curves if curve.points]
    if not shown:
        return ""
    first = shown[0][1]
    quantities = Quantities.of(first)
    figure = canvas.new_figure(WIDE, 3.6)
    axes = figure.subplots()
    canvas.plain_axes(axes)
    low, high, far = 0.0, 0.0, (0.0, 1e-9)
    for i, (name, curve) in enumerate(shown):
        x, y = quantities.x(curve), quantities.y(curve)
        static = np.where(curve.column("status") == DYNAMIC, np.nan, y)
        if np.isnan(static).any():
            axes.plot(x, y, color=canvas.FAINT, linewidth=0.8, linestyle="--")
        axes.plot(
            x,
            static,
            color=canvas.CURVE_COLOURS[i],
            linestyle=canvas.CURVE_STYLES[i],
            linewidth=1.8,
            label=canvas.literal(name),
        )
        low, high = min(low, float(np.nanmin(static))), max(high, float(np.nanmax(static)))
        far = min(far[0], float(x.min())), max(far[1], float(x.max()))
    axes.set_xlim(far[0], far[1] + 0.03 * (far[1] - far[0]))
    margin = 0.12 * ((high - low) or 1e-9)  # for a name above the peak
    axes.set_ylim(low - (0.5 * margin if first.is_cyclic else 0.0), high + margin)
    if quantities.moves_supports:
        axes.set_xlabel(words["motion"].format(unit=quantities.motion_unit))
        axes.set_ylabel(words["reaction"].format(unit=quantities.force_unit))
    else:
        axes.set_xlabel(words["displacement"])
        axes.set_ylabel(words["multiplier"])
    for mark in marks:
        at, high = mark.control_displacement, mark.load_multiplier
        if quantities.moves_supports:
            row = first.nearest(at)
            at, high = float(quantities.x(first)[row]), float(quantities.y(first)[row])
        # What happens is told in sentences: as words in the picture it would leave the axes.
        name = words["event"] if mark.kind == "event" else spoken(mark.name)
        _mark(axes, at, high, name, limit=mark.kind not in ("peak", "rest"))
    if len(shown) > 1:
        axes.legend(fontsize=9, frameon=False, loc="best")
    return canvas.element(
        figure, words["supports" if quantities.moves_supports else "curve"], "svg"
    )


def _mark(axes: Axes, x: float, y: float, name: str, *, limit: bool) -> None:
    """A mark with its name beside it, on the side that is free."""
    axes.plot(
        x,
        y,
        "D" if limit else "o",
        color=LIMIT if limit else canvas.INK,
        markersize=5.5,
        clip_on=False,
        zorder=6,
    )
    low, high = axes.get_xlim()
    left = x - low > LEFTWARDS * (high - low)
    axes.annotate(
        canvas.literal(name),
        (x, y),
        xytext=(-6 if left else 6, 5),
        ha="right" if left else "left",
        textcoords="offset points",
        fontsize=9,
        bbox={**canvas.BACKING, "boxstyle": "round,pad=0.05", "alpha": 0.7},
        zorder=7,
    )


def state_picture(mechanism: Mechanism, label: str) -> str:
    """The structure in a state, as an element of a page."""
    return mechanism_element(mechanism, label)


def _states(mechanism: Mechanism) -> list[int]:
    """What every tie does; elastic where that is not known."""
    if mechanism.tie_branch is None:
        return [ELASTIC] * len(mechanism.ties)
    return [int(state) for state in mechanism.tie_branch]


def legend(mechanisms: Sequence[Mechanism]) -> list[tuple[str, str]]:
    """What the pictures of states show, each a sign as markup and the key of its words."""
    drawn = [Drawn.of(mechanism) for mechanism in mechanisms]
    fixed = mechanisms[0].assembly.fixed
    moved = any((d.moving | d.departed).any() for d in drawn)
    rest = any((~d.moving & ~d.departed & ~fixed).any() for d in drawn)
    signs = [("designed", _box("none", "dashed #a8a8a8"))] * moved
    signs += [("rest", _box(RESTING))] * rest
    if mechanisms[0].bodies is None:
        signs += [("moving", _box(MOVING))] * moved
    signs.append(("support", _box(SUPPORT)))
    if moved:
        signs += [("open", _line(OPEN_JOINT, "-")), ("slid", _line(SLID_JOINT, "--"))]
    for state in sorted({state for mechanism in mechanisms for state in _states(mechanism)}):
        colour, style, name = TIES[state]
        signs.append((name.replace(" ", "_"), _line(colour, style)))
    if any(len(d.loads) for d in drawn):
        signs.append(("dead_load", f'<i class="sign arrow" style="color: {DEAD}">→</i>'))
    if mechanisms[0].control_point is not None:
        signs.append(("control", '<i class="sign ring"></i>'))
    return [(sign, key) for key, sign in signs]


def _box(fill: str, border: str = "solid #555555") -> str:
    return f'<i class="sign box" style="background: {fill}; border: 1px {border}"></i>'


def _line(colour: str, style: str) -> str:
    border = f"3px {BORDERS[style]} {colour}"
    return f'<i class="sign line" style="border-top: {border}"></i>'


def spectra_picture(spectra: Mapping[str, tuple[Spectrum, float]], words: Mapping[str, str]) -> str:
    """Elastic spectra over the period, by name with their damping."""
    period = np.concatenate((np.linspace(0.0, 1.0, 101), np.linspace(1.02, 4.0, 150)))
    figure = canvas.new_figure(WIDE, 3.2)
    axes = figure.subplots()
    canvas.plain_axes(axes)
    for i, (name, (spectrum, damping)) in enumerate(spectra.items()):
        ordinate = spectrum.sa(period, damping) / GRAVITY
        plot_demand(axes, i, period, ordinate, _of_damping(name, damping))
    axes.set_xlim(0.0, 4.0)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(words["period"])
    axes.set_ylabel(words["sa"])
    axes.legend(fontsize=9, frameon=False, loc="upper right")
    return canvas.element(figure, words["spectrum"], "svg")


def adrs_picture(
    capacity: tuple[Array, Array],
    spectra: Mapping[str, tuple[Spectrum, float]],
    states: Mapping[str, tuple[float, float]],
    words: Mapping[str, str],
) -> str:
    """Capacity (d*, a*) [m, m/s2], demand by state, limit states (d*, a*), rays of period."""
    d, a = capacity
    far = 1.1 * max([float(d.max()), *(x for x, _ in states.values()), 1e-9])
    period = np.concatenate(([0.0], np.geomspace(0.02, 20.0, 500)))
    top = 1.15 * max([float(a.max()), *(y for _, y in states.values()), 1e-9])
    for spectrum, damping in spectra.values():
        top = max(top, min(1.1 * float(spectrum.sa(period, damping).max()), 2.0 * top))
    figure = canvas.new_figure(WIDE, 4.2)
    axes = figure.subplots()
    canvas.plain_axes(axes)
    axes.set_xlim(0.0, far)
    axes.set_ylim(0.0, top)
    plot_rays(axes, far, top)
    for i, (name, (spectrum, damping)) in enumerate(spectra.items()):
        label = _of_damping(name, damping)
        plot_demand(axes, i, spectrum.sd(period, damping), spectrum.sa(period, damping), label)
    axes.plot(d, a, color=canvas.CURVE_COLOURS[0], linewidth=2.0, zorder=5)
    for name, (x, y) in states.items():
        _mark(axes, x, y, name, limit=True)
    axes.set_xlabel(words["d"])
    axes.set_ylabel(words["a"])
    if spectra:
        figure.legend(loc="outside lower center", ncols=3, fontsize=9, frameon=False)
    return canvas.element(figure, words["adrs"], "svg")


def _of_damping(name: str, damping: float) -> str:
    """A spectrum in a legend; damping is a ratio."""
    return f"{canvas.literal(name)}, ξ = {number(100.0 * damping, 'g')} %"
