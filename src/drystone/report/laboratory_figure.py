"""Walls of laboratories: measured beside computed curves, in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drystone.common.language import say
from drystone.report import canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from drystone.laboratory.comparison import Compared

#: Panels beside each other.
COLUMNS = 3
MEASURED, COMPUTED, BAND = "#1a1a1a", canvas.CURVE_COLOURS[1], "#f0b090"


def draw_laboratory(walls: Sequence[Compared], path: Path | str, *, title: str) -> None:
    """Write one picture with a panel a wall."""
    rows = -(-len(walls) // COLUMNS)
    columns = min(COLUMNS, len(walls))
    figure = canvas.new_figure(4.2 * columns, 3.0 * rows + 0.9)
    figure.suptitle(canvas.literal(title), fontsize=12)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, wall in zip(panels, walls, strict=False):
        plot_wall(axes, wall)
    for axes in panels[len(walls) :]:
        axes.set_axis_off()
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=9, frameon=False)
    canvas.save(figure, path)


def plot_wall(axes: Axes, compared: Compared) -> None:
    """Force against displacement at its height, of one wall."""
    canvas.plain_axes(axes)
    x, y = compared.measured
    curve = compared.computed
    cyclic = compared.wall.cyclic
    if len(compared.variants) > 1:
        at, least, greatest = compared.band()
        label = _word("band")
        axes.fill_between(
            1e3 * at,
            1e-3 * least,
            1e-3 * greatest,
            color=BAND,
            linewidth=0.0,
            label=label,
            zorder=2,
        )
    width = 0.7 if cyclic else 1.4
    axes.plot(1e3 * x, 1e-3 * y, color=MEASURED, linewidth=width, label=_word("measured"), zorder=3)
    axes.plot(
        1e3 * curve.displacement,
        1e-3 * curve.force,
        color=COMPUTED,
        linewidth=1.2 if cyclic else 1.6,
        linestyle="--",
        label=_word("computed"),
        zorder=4,
    )
    axes.set_title(f"{compared.wall.name} ({compared.wall.failure})", fontsize=10)
    axes.set_xlabel(_word("displacement"), fontsize=9)
    axes.set_ylabel(_word("force"), fontsize=9)
    axes.tick_params(labelsize=8)


def _word(key: str) -> str:
    """A word, in the language that is spoken."""
    return say(f"laboratory.{key}").spoken
