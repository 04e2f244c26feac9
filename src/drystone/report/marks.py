"""Marks on pictures of structures, the same in both dimensions: control point, load."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.model.ties import BROKEN, ELASTIC, SLACK, YIELDING
from drystone.report import canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Colour, line and label of ties by what they do.
TIES = {
    SLACK: ("#1b7f79", ":", "slack tie"),
    ELASTIC: ("#1b7f79", "-", "elastic tie"),
    YIELDING: ("#e07b00", "-", "yielding tie"),
    BROKEN: ("#8a8a8a", "--", "broken tie"),
}


def plot_control_point(axes: Axes, path: Array) -> None:
    """Its way since the design, dotted, and where it is now; ``path`` (2, 2)."""
    axes.plot(*path.T, color=canvas.INK, linewidth=1.0, linestyle=":", zorder=7)
    axes.plot(
        *path[1],
        "o",
        markersize=8,
        markerfacecolor="white",
        markeredgecolor=canvas.INK,
        markeredgewidth=1.6,
        linestyle="none",
        label="control point",
        zorder=8,
    )


def plot_ties(axes: Axes, lines: Array, branch: IntArray | None) -> None:
    """Ties as lines (n_ties, 2, 2), told apart by what they do, where that is known."""
    known = np.full(len(lines), ELASTIC) if branch is None else branch
    for state in np.unique(known).tolist():
        colour, style, label = TIES[state]
        first, *rest = lines[known == state]
        for line, name in ((first, "tie" if branch is None else label), *((x, None) for x in rest)):
            axes.plot(
                *line.T,
                color=colour,
                linestyle=style,
                linewidth=2.0,
                marker="s",
                markersize=3.5,
                label=name,
                zorder=6.5,
            )


def plot_load(axes: Axes, tail: Any, tip: Any) -> None:
    """The arrow of the load pattern, from ``tail`` (2,) to ``tip`` (2,)."""
    axes.annotate(
        "",
        xy=tip,
        xytext=tail,
        arrowprops={
            "arrowstyle": "-|>,head_width=0.35,head_length=0.7",
            "linewidth": 2.2,
            "color": canvas.INK,
        },
        zorder=9,
    )
    axes.annotate(
        r"$λ\,W_i$", tail, xytext=(0, 7), textcoords="offset points", fontsize=11, zorder=9
    )
