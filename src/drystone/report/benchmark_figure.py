"""One page per benchmark wall, as in the paper's Figs. 3 to 5: curves left, mechanisms right."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from drystone.report import canvas
from drystone.report.curve_figure import Labelled, Reference, plot_curves
from drystone.report.mechanism import Mechanism
from drystone.report.mechanism_figure import plot_mechanism


def draw_benchmark_wall(
    curves: Labelled,
    mechanisms: Sequence[tuple[str, Mechanism]],
    path: Path | str,
    *,
    title: str,
    reference: Sequence[Reference] = (),
) -> None:
    """Write one page.

    Parameters
    ----------
    curves
        Curves of all engines with their labels.
    mechanisms
        A caption and a mechanism for each engine.
    path
        PNG file to write.
    title
        Above the page.
    reference
        Recorded curves to compare with.
    """
    columns = 1 if len(mechanisms) < 2 else 2
    rows = max(1, -(-len(mechanisms) // columns))
    figure = canvas.new_figure(6.5 + 4.0 * columns, 5.0 + 2.5 * (rows - 1))
    figure.suptitle(canvas.literal(title), fontsize=12)
    halves = figure.subfigures(1, 2, squeeze=False, width_ratios=(6.5, 4.0 * columns))
    left, right = halves[0]

    axes = left.subplots()
    labelled = [(label, curve) for label, curve in curves if curve.points]
    plot_curves(axes, labelled, reference=reference, marks=False, branches=False)
    left.legend(loc="outside lower center", ncols=2, fontsize=9, frameon=False)

    panels = right.subplots(rows, columns, squeeze=False).ravel()
    handle_of: dict[str, Any] = {}
    for axes, (caption, mechanism) in zip(panels, mechanisms, strict=False):
        plot_mechanism(axes, mechanism)
        axes.set_title(caption, fontsize=10)
        handles, labels = axes.get_legend_handles_labels()
        handle_of.update(zip(labels, handles, strict=True))
    for axes in panels[len(mechanisms) :]:
        axes.set_axis_off()
    if handle_of:
        right.legend(
            handle_of.values(),
            handle_of.keys(),
            loc="outside lower center",
            ncols=2 + columns,
            fontsize=9,
            frameon=False,
        )
    canvas.save(figure, path)
