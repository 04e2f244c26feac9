"""Marks on pictures of structures, the same in both dimensions: control point, load."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drystone.report import canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]


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
