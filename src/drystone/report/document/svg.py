"""Drawings as SVG text: sharp on paper, made in a moment."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drystone.common.language import number

Array = NDArray[np.float64]

#: Size of letters [px].
LETTERS = 12


@dataclass
class Drawing:
    """A picture of so many pixels; y goes down."""

    width: float
    height: float
    label: str = ""  # what is on it, for those who do not see it
    parts: list[str] = field(default_factory=list)

    def add(self, name: str, text: str = "", **attributes: Any) -> None:
        """An element; underscores of attribute names are hyphens."""
        given = "".join(
            f' {key.rstrip("_").replace("_", "-")}="{escape(_value(value))}"'
            for key, value in attributes.items()
            if value is not None
        )
        self.parts.append(
            f"<{name}{given}>{escape(text)}</{name}>" if text else f"<{name}{given}/>"
        )

    def polygon(self, points: Array, **attributes: Any) -> None:
        """A closed outline of points (n, 2)."""
        self.add("polygon", points=_points(points), **attributes)

    def polyline(self, points: Array, **attributes: Any) -> None:
        """A line through points (n, 2); it breaks where one is not a number."""
        whole = np.asarray(np.isfinite(points).all(axis=1))
        for run in np.split(np.arange(len(points)), np.flatnonzero(np.diff(whole)) + 1):
            if len(run) > 1 and whole[run[0]]:
                self.add("polyline", points=_points(points[run]), fill="none", **attributes)

    def text(self, words: str, x: float, y: float, **attributes: Any) -> None:
        """Words at a place."""
        self.add("text", words, x=x, y=y, **attributes)

    def source(self) -> str:
        """The whole element."""
        inner = "".join(self.parts)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width:g} {self.height:g}" '
            f'role="img" aria-label="{escape(self.label)}" font-size="{LETTERS}">{inner}</svg>'
        )


def _value(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def _points(points: Array) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in points.tolist())


@dataclass(kw_only=True)
class Plot:
    """Axes with round numbers on a drawing, for lines and marks in the values' own units."""

    drawing: Drawing
    x: tuple[float, float]  # from, to
    y: tuple[float, float]
    x_label: str
    y_label: str
    left: float = 58.0
    right: float = 16.0
    top: float = 14.0
    bottom: float = 44.0

    def __post_init__(self) -> None:
        """The axes themselves."""
        d, low, high = self.drawing, self.drawing.height - self.bottom, self.top
        for value in ticks(*self.x, max(3, int(d.width / 95))):
            x = float(self.at([value], [0.0])[0, 0])
            d.add("line", x1=x, x2=x, y1=high, y2=low, class_="grid")
            d.text(number(value, "g"), x, low + 16.0, text_anchor="middle", class_="tick")
        for value in ticks(*self.y, max(3, int(d.height / 50))):
            y = float(self.at([0.0], [value])[0, 1])
            d.add("line", x1=self.left, x2=d.width - self.right, y1=y, y2=y, class_="grid")
            d.text(number(value, "g"), self.left - 7.0, y + 4.0, text_anchor="end", class_="tick")
        middle = 0.5 * (self.left + d.width - self.right)
        d.text(self.x_label, middle, d.height - 8.0, text_anchor="middle")
        turned = f"translate(14 {0.5 * (low + high):g}) rotate(-90)"
        d.text(self.y_label, 0.0, 0.0, text_anchor="middle", transform=turned)

    def at(self, x: Sequence[float] | Array, y: Sequence[float] | Array) -> Array:
        """Places (n, 2) of values."""
        d = self.drawing
        across = (np.asarray(x, float) - self.x[0]) / (self.x[1] - self.x[0])
        up = (np.asarray(y, float) - self.y[0]) / (self.y[1] - self.y[0])
        wide, high = d.width - self.left - self.right, d.height - self.top - self.bottom
        return np.column_stack((self.left + wide * across, d.height - self.bottom - high * up))

    def line(self, x: Sequence[float] | Array, y: Sequence[float] | Array, **style: Any) -> None:
        """A line through values; what is beyond the axes is cut off."""
        places = self.at(x, y)
        low, high = self.top - 1.0, self.drawing.height - self.bottom + 1.0
        inside = (places[:, 1] >= low) & (places[:, 1] <= high)
        inside &= places[:, 0] <= self.drawing.width - self.right + 1.0
        self.drawing.polyline(np.where(inside[:, None], places, np.nan), **style)

    def mark(self, x: float, y: float, words: str, *, kind: str = "circle") -> None:
        """A mark with words beside it, on the side where there is room."""
        px, py = self.at([x], [y])[0]
        if kind == "circle":
            self.drawing.add("circle", cx=px, cy=py, r=4.0, class_="mark")
        else:
            corners = np.array([[-5.0, 0.0], [0.0, -5.0], [5.0, 0.0], [0.0, 5.0]])
            self.drawing.polygon(corners + (px, py), class_="mark limit")
        right = px > 0.72 * self.drawing.width
        self.drawing.text(
            words,
            px + (-8.0 if right else 8.0),
            py - 7.0,
            text_anchor="end" if right else "start",
            class_="name",
        )


def ticks(low: float, high: float, count: int) -> list[float]:
    """Round values from low to high, about so many."""
    rough = (high - low) / count
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(s * power for s in (1.0, 2.0, 5.0, 10.0) if s * power >= rough * (1.0 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [n * step for n in range(first, last + 1)]
