"""Capacity and demand of an assessment as a file of its own: SVG, made in a moment."""

from __future__ import annotations

import numpy as np

from drystone.assessment.methods.base import Assessment, LimitState
from drystone.common.language import say, words
from drystone.report.adrs_figure import (
    GRID,
    PERIODS,
    capacity_line,
    capacity_name,
    demands_of,
    height_of,
    mark_of,
    name_of,
    name_with_demand,
)
from drystone.report.document.figures import DASHES, DEMAND
from drystone.report.document.svg import Drawing, Plot

#: Wide and high without the legend [px]; a line of the legend and the title.
WIDE, HIGH, ROW, TITLE = 760.0, 460.0, 17.0, 26.0
#: What the page of a report says in its style sheet.
STYLE = (
    "text{font-family:Arial,Helvetica,sans-serif;fill:#333} .title{font-size:15px;fill:#1a1a1a} "
    ".tick{fill:#5c5c5c;font-size:11px} .grid{stroke:#e6e3dc} "
    ".curve{stroke:#0b3c6f;stroke-width:2.2} .bilinear{stroke:#1a1a1a;stroke-dasharray:5 2} "
    ".ray{stroke:#b9b5ac;stroke-width:.8} .mark{fill:#1a1a1a} .limit{fill:#c1440e} "
    ".down{stroke:#8c8c8c;stroke-dasharray:2 2}"
)


def adrs_file(answer: Assessment, title: str = "") -> str:
    """The picture: capacity, bilinear, demand spectra by damping, rays of period, limit states.

    In the language that is spoken.
    """
    text = words()["plot"]
    d, a = capacity_line(answer)
    states = [s for s in answer.limit_states if s.limit_displacement is not None]
    right = 1.08 * max([float(d.max()), *(s.displacement_demand or 0.0 for s in states)])
    demands = demands_of(answer)
    top = height_of(float(a.max()), demands, right)
    rows = 1 + (answer.bilinear is not None) + len(demands) + len(states)
    above = (TITLE if title else 0.0) + ROW * rows + 14.0
    drawing = Drawing(WIDE, HIGH + above, label=text["adrs"])
    drawing.add("style", STYLE)
    drawing.add("rect", width="100%", height="100%", fill="#fff")
    if title:
        drawing.text(title, 0.5 * WIDE, 19.0, text_anchor="middle", class_="title")
    plot = Plot(
        drawing=drawing,
        x=(0.0, right),
        y=(0.0, top),
        x_label=text["d"],
        y_label=text["a"],
        right=40.0,
        top=above,
    )
    legend = _Legend(drawing, TITLE if title else 6.0)
    _rays(plot, right, top)
    for i, (name, spectrum, damping) in enumerate(demands):
        style = {"stroke": DEMAND[i % 4], "stroke_width": 1.6, "stroke_dasharray": DASHES[i % 4]}
        plot.line(spectrum.sd(GRID, damping), spectrum.sa(GRID, damping), **style)
        legend.line(name, **style)
    if answer.bilinear is not None:
        b = answer.bilinear
        ends = [0.0, b.yield_displacement, b.ultimate_displacement]
        plot.line(ends, [0.0, b.yield_acceleration, b.yield_acceleration], class_="bilinear")
        legend.line(say("picture.bilinear").spoken, class_="bilinear")
    plot.line(d, a, class_="curve")
    legend.line(capacity_name(answer), class_="curve")
    for state in states:
        _state(plot, legend, answer, state)
    return drawing.source()


class _Legend:
    """Lines of a legend, one below the other."""

    def __init__(self, drawing: Drawing, top: float) -> None:
        self.drawing, self.at = drawing, top

    def line(self, name: str, **style: object) -> None:
        """A line and what it is."""
        self.at += ROW
        self.drawing.polyline(np.array([[58.0, self.at - 4.0], [92.0, self.at - 4.0]]), **style)
        self.drawing.text(name, 100.0, self.at, class_="tick")

    def mark(self, name: str) -> None:
        """A limit state and what it asks."""
        self.at += ROW
        corners = np.array([[-5.0, 0.0], [0.0, -5.0], [5.0, 0.0], [0.0, 5.0]])
        self.drawing.polygon(corners + (75.0, self.at - 4.0), class_="mark limit")
        self.drawing.text(name, 100.0, self.at, class_="tick")


def _rays(plot: Plot, right: float, top: float) -> None:
    """Lines of equal period through the origin."""
    for period in PERIODS:
        slope = (2.0 * np.pi / period) ** 2
        end = min(right, top / slope)
        if end < 0.02 * right or slope * end < 0.03 * top:
            continue
        plot.line([0.0, end], [0.0, slope * end], class_="ray")
        x, y = plot.at([end], [slope * end])[0]
        aside = end >= right
        plot.drawing.text(
            say("picture.seconds", period=period).spoken,
            x + (4.0 if aside else 0.0),
            y + (4.0 if aside else -3.0),
            text_anchor="start" if aside else "middle",
            class_="tick",
        )


def _state(plot: Plot, legend: _Legend, answer: Assessment, state: LimitState) -> None:
    """A limit state on the capacity, and what the ground asks of it."""
    limit, height, demand, across = mark_of(answer, state)
    plot.mark(limit, height, state.name, kind="diamond")
    said = name_of(state)
    if demand is not None and across is not None:
        plot.line([demand, demand], [0.0, across], class_="down")
        x, y = plot.at([demand], [across])[0]
        if y >= plot.top:
            plot.drawing.add("circle", cx=x, cy=y, r=4.0, fill="#fff", stroke="#1a1a1a")
        said = name_with_demand(state)
    legend.mark(said)
