"""What models, curves and folders of results show of themselves in a notebook."""

from __future__ import annotations

import io
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drystone.model.model import Model
    from drystone.report.folder.results import Results
    from drystone.results.curve import CapacityCurve

#: Size of a curve's picture [inches], and height of the viewer [pixels].
PICTURE, HEIGHT = (5.5, 3.4), 480


def table(facts: Mapping[str, str]) -> str:
    """A small table of names and values."""
    rows = (f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in facts.items())
    return f"<table>{''.join(rows)}</table>"


def curve_picture(curve: CapacityCurve) -> str:
    """A curve as an image in a page; no figure is left open."""
    from matplotlib.figure import Figure

    from drystone.report.plots import plot_curve

    figure = Figure(figsize=PICTURE, layout="constrained")
    plot_curve(curve, figure.subplots())
    text = io.StringIO()
    figure.savefig(text, format="svg")
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def model_viewer(model: Model) -> str:
    """The viewer with a model as designed."""
    from drystone.report.viewer.contents import contents_of_model
    from drystone.report.viewer.page import page

    return inline(page(contents_of_model(model)))


def results_viewer(results: Results) -> str:
    """The viewer with a structure that moves along its curve."""
    from drystone.report.viewer.contents import contents_of_folder
    from drystone.report.viewer.page import page

    return inline(page(contents_of_folder(results)))


def inline(page: str) -> str:
    """A whole page within another, which it cannot touch."""
    return (
        f'<iframe srcdoc="{escape(page)}" sandbox="allow-scripts" width="100%" height="{HEIGHT}" '
        'style="border: 1px solid #ccc"></iframe>'
    )
