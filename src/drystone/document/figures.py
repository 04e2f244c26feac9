"""Pictures of the report: the curve, the structure in a state, demand and capacity."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import GRAVITY
from drystone.assessment.spectra.base import Spectrum
from drystone.curve import DYNAMIC, CapacityCurve
from drystone.document.svg import Drawing, Plot
from drystone.language import number, spoken
from drystone.report import Mechanism, draw_mechanism
from drystone.report.joints import Joints
from drystone.report.mechanism import OPEN_JOINT, SLID_JOINT, Drawn
from drystone.viewer import Mark

Array = NDArray[np.float64]

#: Colours of bodies, Okabe and Ito's, told apart by colour-blind readers; at rest, support.
BODIES = ("#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
RESTING, MOVING, SUPPORT = "#e9e5dc", "#d9b676", "#c0c0c0"
DEMAND = ("#c1440e", "#2a7f62", "#7a4b9a", "#8a6d00")
DASHES = ("7 3", "2 3", "7 3 2 3", "10 4")
#: Wide and high at most [px].
WIDE, HIGH = 640.0, 420.0
#: The picture reaches this share of the structure's size beyond its designed outline, no further.
MARGIN = 0.6
#: Periods [s] whose rays are drawn.
RAYS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0)


def curve_svg(
    curves: Sequence[tuple[str, CapacityCurve]], marks: Sequence[Mark], words: Mapping[str, str]
) -> str:
    """The first curve with its marks, and others beside it, dashed; empty without a point."""
    shown = [(name, curve) for name, curve in curves if curve.points]
    if not shown:
        return ""
    x = np.concatenate([curve.control_displacement for _, curve in shown])
    y = np.concatenate([_static(curve) for _, curve in shown])
    drawing = Drawing(WIDE, 360.0, label=words["curve"])
    far, high = max(float(x.max()), 1e-9), max(float(np.nanmax(y)), 1e-9)
    plot = Plot(
        drawing=drawing,
        x=(min(0.0, float(x.min())), 1.02 * far),
        y=(min(0.0, float(np.nanmin(y))), 1.12 * high),
        x_label=words["displacement"],
        y_label=words["multiplier"],
    )
    for i, (name, curve) in enumerate(shown):
        if (curve.column("status") == DYNAMIC).any():
            plot.line(curve.control_displacement, curve.load_multiplier, class_="jump")
        style = "curve" if i == 0 else "curve other"
        plot.line(curve.control_displacement, _static(curve), class_=style)
        if len(shown) > 1:
            row = int(np.nanargmax(_static(curve)))
            place = plot.at([curve.control_displacement[row]], [_static(curve)[row]])[0]
            drawing.text(name, place[0] + 60.0, place[1] + 14.0 + 16.0 * i, class_="tick")
    for mark in marks:
        kind = "circle" if mark.kind == "peak" else "diamond"
        plot.mark(mark.control_displacement, mark.load_multiplier, spoken(mark.name), kind=kind)
    return drawing.source()


def _static(curve: CapacityCurve) -> Array:
    return np.where(curve.column("status") == DYNAMIC, np.nan, curve.load_multiplier)


def state_picture(mechanism: Mechanism, labels: Sequence[int] | None, label: str) -> str:
    """The structure in a state, as markup: drawn here in the plane, as PNG in space."""
    if mechanism.assembly.dimension == 2:
        return _plane_svg(mechanism, labels, label)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "state.png"
        draw_mechanism(mechanism, path)
        data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f'<img alt="{escape(label)}" src="data:image/png;base64,{data}">'


def _plane_svg(mechanism: Mechanism, labels: Sequence[int] | None, label: str) -> str:
    drawn = Drawn.of(mechanism)
    assembly, shapes = mechanism.assembly, drawn.shapes
    moved = shapes.moved(drawn.pose)
    low, high = _box(shapes.vertices, moved)
    sides = high - low
    scale = min(WIDE / sides[0], HIGH / sides[1])
    drawing = Drawing(float(scale * sides[0]), float(scale * sides[1]), label=label)

    def seen(points: Array) -> Array:
        return np.column_stack(((points[:, 0] - low[0]), (high[1] - points[:, 1]))) * scale

    line = float(np.clip(14.0 / np.sqrt(assembly.n_bodies), 0.3, 1.1))
    bodies = labels if labels is not None and len(labels) == assembly.n_bodies else None
    designed, now = shapes.split(shapes.vertices), shapes.split(moved)
    for s, i in enumerate(shapes.body.tolist()):
        if drawn.moving[i] or drawn.gone[i]:
            drawing.polygon(seen(designed[s]), class_="designed")
    for s, i in enumerate(shapes.body.tolist()):
        if not drawn.gone[i]:
            fill = _fill(assembly.fixed[i], drawn.moving[i], None if bodies is None else bodies[i])
            drawing.polygon(seen(now[s]), fill=fill, stroke="#222", stroke_width=line)
    if drawn.visible > 0.0:
        joints = Joints.of(assembly)
        opening, slip = joints.opening_and_slip(drawn.pose, drawn.settled)
        face_a, face_b = joints.faces(drawn.pose)
        there = ~(drawn.gone[joints.designed.block_a] | drawn.gone[joints.designed.block_b])
        opened = (opening > drawn.visible) & there
        for ends in np.concatenate((face_a[opened], face_b[opened])):
            drawing.polyline(seen(ends), stroke=OPEN_JOINT, stroke_width=2.0 * line)
        for ends in face_a[(slip > drawn.visible) & ~opened & there]:
            drawing.polyline(
                seen(ends), stroke=SLID_JOINT, stroke_width=2.4 * line, stroke_dasharray="4 2"
            )
    if mechanism.control_point is not None:
        path = seen(drawn.path_of(mechanism.control_point))
        drawing.polyline(path, class_="designed")
        drawing.add("circle", cx=path[1, 0], cy=path[1, 1], r=4.0, class_="control")
    return drawing.source()


def _fill(fixed: bool, moving: bool, label: int | None) -> str:
    if fixed:
        return SUPPORT
    if label is not None:
        return RESTING if label < 0 else BODIES[label % len(BODIES)]
    return MOVING if moving else RESTING


def _box(designed: Array, moved: Array) -> tuple[Array, Array]:
    lower, upper = designed.min(axis=0), designed.max(axis=0)
    size = float((upper - lower).max())
    low = np.maximum(np.minimum(lower, moved.min(axis=0)), lower - MARGIN * size) - 0.03 * size
    high = np.minimum(np.maximum(upper, moved.max(axis=0)), upper + MARGIN * size) + 0.03 * size
    return low, high


def spectra_svg(spectra: Mapping[str, tuple[Spectrum, float]], words: Mapping[str, str]) -> str:
    """Elastic spectra over the period, by name with their damping."""
    period = np.concatenate((np.linspace(0.0, 1.0, 101), np.linspace(1.02, 4.0, 150)))
    values = {
        name: spectrum.sa(period, damping) / GRAVITY
        for name, (spectrum, damping) in spectra.items()
    }
    drawing = Drawing(WIDE, 300.0, label=words["spectrum"])
    top = 1.1 * max(float(v.max()) for v in values.values())
    plot = Plot(
        drawing=drawing, x=(0.0, 4.0), y=(0.0, top), x_label=words["period"], y_label=words["sa"]
    )
    for i, (name, ordinate) in enumerate(values.items()):
        _demand(plot, i, period, ordinate, _of_damping(name, spectra[name][1]))
    return drawing.source()


def adrs_svg(
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
    drawing = Drawing(WIDE, 400.0, label=words["adrs"])
    plot = Plot(drawing=drawing, x=(0.0, far), y=(0.0, top), x_label=words["d"], y_label=words["a"])
    for seconds in RAYS:
        slope = (2.0 * np.pi / seconds) ** 2
        end = min(far, top / slope)
        plot.line([0.0, end], [0.0, slope * end], class_="ray")
        if end > 0.12 * far:
            x, y = plot.at([end], [slope * end])[0]
            anchor = "end" if end >= far * 0.999 else "middle"
            drawing.text(
                f"{number(seconds, 'g')} s", x - 2.0, y + 12.0, text_anchor=anchor, class_="tick"
            )
    for i, (name, (spectrum, damping)) in enumerate(spectra.items()):
        sd, sa = spectrum.sd(period, damping), spectrum.sa(period, damping)
        _demand(plot, i, sd, sa, _of_damping(name, damping))
    plot.line(d, a, class_="curve")
    for name, (x, y) in states.items():
        plot.mark(x, y, name, kind="diamond")
    return drawing.source()


def _of_damping(name: str, damping: float) -> str:
    """A spectrum in a legend; damping is a ratio."""
    return f"{name}, ξ = {number(100.0 * damping, 'g')} %"


def _demand(plot: Plot, i: int, x: Array, y: Array, words: str) -> None:
    """One spectrum with a line of the legend."""
    style = {"stroke": DEMAND[i % 4], "stroke_width": 1.6, "stroke_dasharray": DASHES[i % 4]}
    plot.line(x, y, **style)
    drawing = plot.drawing
    right, at = drawing.width - plot.right - 8.0, plot.top + 12.0 + 17.0 * i
    drawing.polyline(np.array([[right - 34.0, at], [right, at]]), **style)
    drawing.text(words, right - 40.0, at + 4.0, text_anchor="end", class_="tick")
