"""Figures for the engineer: the capacity curve, the mechanism, the benchmark's pages."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drystone.report.benchmark_figure import draw_benchmark_wall
    from drystone.report.curve_figure import draw_curve
    from drystone.report.mechanism import Mechanism
    from drystone.report.mechanism_figure import draw_mechanism
    from drystone.report.plots import plot_curve, plot_mechanism, plot_model

#: Where the names are.  A run imports a folder's writer, and leaves drawing to another process.
_PLACES = {
    "Mechanism": "mechanism",
    "draw_benchmark_wall": "benchmark_figure",
    "draw_curve": "curve_figure",
    "draw_mechanism": "mechanism_figure",
    "plot_curve": "plots",
    "plot_mechanism": "plots",
    "plot_model": "plots",
}

__all__ = [
    "Mechanism",
    "draw_benchmark_wall",
    "draw_curve",
    "draw_mechanism",
    "plot_curve",
    "plot_mechanism",
    "plot_model",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
