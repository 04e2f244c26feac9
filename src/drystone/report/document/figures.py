"""Pictures of the report: the curve, the structure in a state, demand and capacity."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drystone.assessment.spectra.base import Spectrum
from drystone.common.language import number, spoken
from drystone.model.assembly import GRAVITY
from drystone.model.ties import ELASTIC
from drystone.report import Mechanism, draw_mechanism
from drystone.report.document.svg import Drawing, Plot
from drystone.report.joints import Joints
from drystone.report.load_arrows import DEAD
from drystone.report.marks import TIES
from drystone.report.mechanism import OPEN_JOINT, SLID_JOINT, Drawn
from drystone.report.quantities import Quantities
from drystone.report.viewer import Mark
from drystone.results.curve import DYNAMIC, CapacityCurve

Array = NDArray[np.float64]

#: Colours of bodies, Okabe and Ito's, told apart by colour-blind readers; at rest, support.
BODIES = ("#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
RESTING, MOVING, SUPPORT = "#e9e5dc", "#d9b676", "#c0c0c0"
DEMAND = ("#c1440e", "#2a7f62", "#7a4b9a", "#8a6d00")
DASHES = ("7 3", "2 3", "7 3 2 3", "10 4")
#: Wide and high at most [px].
WIDE, HIGH = 640.0, 420.0
#: Width of a picture in space [inches]: half a page, so that its letters are not made smaller.
HALF_PAGE = 3.6
#: Dashes of lines in SVG, by the line styles of other pictures.
LINES = {"-": None, "--": "6 3", ":": "2 3"}
#: Periods [s] whose rays are drawn.
RAYS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0)


def curve_svg(
    curves: Sequence[tuple[str, CapacityCurve]], marks: Sequence[Mark], words: Mapping[str, str]
) -> str:
    """The first curve with its marks, and others beside it, dashed; empty without a point."""
    shown = [(name, curve) for name, curve in curves if curve.points]
    if not shown:
        return ""
    quantities = Quantities.of(shown[0][1])
    values = [(name, quantities.x(curve), *_both(curve, quantities)) for name, curve in shown]
    x = np.concatenate([x for _, x, _, _ in values])
    y = np.concatenate([static for _, _, _, static in values])
    drawing = Drawing(WIDE, 340.0, label=words["settling" if quantities.settles else "curve"])
    low, high = min(0.0, float(np.nanmin(y))), max(float(np.nanmax(y)), 0.0)
    high += 0.12 * ((high - low) or 1e-9)
    if quantities.settles:
        x_label = words["motion"].format(unit=quantities.motion_unit)
        y_label = words["reaction"].format(unit=quantities.force_unit)
    else:
        x_label, y_label = words["displacement"], words["multiplier"]
    plot = Plot(
        drawing=drawing,
        x=(min(0.0, float(x.min())), 1.02 * max(float(x.max()), 1e-9)),
        y=(low, high),
        x_label=x_label,
        y_label=y_label,
        left=70.0 if quantities.settles else 58.0,
    )
    for i, (name, along, whole, static) in enumerate(values):
        if np.isnan(static).any():
            plot.line(along, whole, class_="jump")
        plot.line(along, static, class_="curve" if i == 0 else "curve other")
        if len(shown) > 1:
            row = int(np.nanargmax(static))
            place = plot.at([along[row]], [static[row]])[0]
            drawing.text(name, place[0] + 60.0, place[1] + 14.0 + 16.0 * i, class_="tick")
    first = shown[0][1]
    for mark in marks:
        kind = "circle" if mark.kind in ("peak", "rest") else "diamond"
        x_mark, y_mark = mark.control_displacement, mark.load_multiplier
        if quantities.settles:
            row = first.nearest(mark.control_displacement)
            x_mark, y_mark = float(quantities.x(first)[row]), float(quantities.y(first)[row])
        # What happens is told in sentences: as words in the picture it would leave the axes.
        name = words["event"] if mark.kind == "event" else spoken(mark.name)
        plot.mark(x_mark, y_mark, name, kind=kind)
    return drawing.source()


def _both(curve: CapacityCurve, quantities: Quantities) -> tuple[Array, Array]:
    """Ordinates of all points, and those at rest alone, others NaN."""
    whole = quantities.y(curve)
    return whole, np.where(curve.column("status") == DYNAMIC, np.nan, whole)


def state_picture(mechanism: Mechanism, labels: Sequence[int] | None, label: str) -> str:
    """The structure in a state, as markup: drawn here in the plane, as PNG in space."""
    if mechanism.assembly.dimension == 2:
        return _plane_svg(mechanism, labels, label)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "state.png"
        draw_mechanism(mechanism, path, width=HALF_PAGE, plain=True)
        data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f'<img alt="{escape(label)}" src="data:image/png;base64,{data}">'


def _plane_svg(mechanism: Mechanism, labels: Sequence[int] | None, label: str) -> str:
    drawn = Drawn.of(mechanism)
    assembly, shapes = mechanism.assembly, drawn.shapes
    moved = shapes.moved(drawn.pose)
    low, high = drawn.extent()
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
    for ends, state in zip(drawn.ties, _states(mechanism), strict=True):
        colour, style, _ = TIES[state]
        drawing.polyline(seen(ends), stroke=colour, stroke_width=2.0, stroke_dasharray=LINES[style])
        for x, y in seen(ends).tolist():
            drawing.add("rect", x=x - 2.5, y=y - 2.5, width=5.0, height=5.0, fill=colour)
    for ends in drawn.loads:
        _arrow(drawing, seen(ends))
    if mechanism.control_point is not None:
        path = seen(drawn.path_of(mechanism.control_point))
        drawing.polyline(path, class_="designed")
        drawing.add("circle", cx=path[1, 0], cy=path[1, 1], r=4.0, class_="control")
    return drawing.source()


def _states(mechanism: Mechanism) -> list[int]:
    """What every tie does; elastic where that is not known."""
    if mechanism.tie_branch is None:
        return [ELASTIC] * len(mechanism.ties)
    return [int(state) for state in mechanism.tie_branch]


def _arrow(drawing: Drawing, ends: Array) -> None:
    """The arrow of a dead load, from tail to tip (2, 2)."""
    tail, tip = ends
    way = (tip - tail) / max(float(np.linalg.norm(tip - tail)), 1e-9)
    neck, aside = tip - 8.0 * way, 3.5 * np.array([-way[1], way[0]])
    drawing.polyline(np.array([tail, neck]), stroke=DEAD, stroke_width=2.2)
    drawing.polygon(np.array([tip, neck + aside, neck - aside]), fill=DEAD)


def legend(mechanisms: Sequence[Mechanism], coloured: bool) -> list[tuple[str, str]]:
    """What the pictures of states show, each a sign as markup and the key of its words."""
    drawn = [Drawn.of(mechanism) for mechanism in mechanisms]
    fixed = mechanisms[0].assembly.fixed
    moved = any((d.moving | d.gone).any() for d in drawn)
    rest = any((~d.moving & ~d.gone & ~fixed).any() for d in drawn)
    signs = [("designed", _box_sign("none", dashed=True))] * moved
    signs += [("rest", _box_sign(RESTING))] * rest
    if not coloured:
        signs += [("moving", _box_sign(MOVING))] * moved
    signs.append(("support", _box_sign(SUPPORT)))
    if moved:
        signs += [("open", _line_sign(OPEN_JOINT, "-")), ("slid", _line_sign(SLID_JOINT, "--"))]
    for state in sorted({state for mechanism in mechanisms for state in _states(mechanism)}):
        colour, style, name = TIES[state]
        signs.append((name.replace(" ", "_"), _line_sign(colour, style)))
    if any(len(d.loads) for d in drawn):
        signs.append(("dead_load", _arrow_sign()))
    if mechanisms[0].control_point is not None:
        signs.append(("control", _ring_sign()))
    return [(sign, key) for key, sign in signs]


def _sign() -> Drawing:
    return Drawing(26.0, 14.0)


def _box_sign(fill: str, *, dashed: bool = False) -> str:
    drawing = _sign()
    style = {"stroke": "#9a9a9a", "stroke_dasharray": "4 3"} if dashed else {"stroke": "#222"}
    drawing.add("rect", x=1.0, y=1.0, width=24.0, height=12.0, fill=fill, **style)
    return drawing.source()


def _line_sign(colour: str, style: str) -> str:
    drawing = _sign()
    line = np.array([[0.0, 7.0], [26.0, 7.0]])
    drawing.polyline(line, stroke=colour, stroke_width=2.4, stroke_dasharray=LINES[style])
    return drawing.source()


def _arrow_sign() -> str:
    drawing = _sign()
    _arrow(drawing, np.array([[1.0, 7.0], [25.0, 7.0]]))
    return drawing.source()


def _ring_sign() -> str:
    drawing = _sign()
    drawing.add("circle", cx=13.0, cy=7.0, r=4.0, class_="control")
    return drawing.source()


def _fill(fixed: bool, moving: bool, label: int | None) -> str:
    if fixed:
        return SUPPORT
    if label is not None:
        return RESTING if label < 0 else BODIES[label % len(BODIES)]
    return MOVING if moving else RESTING


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
