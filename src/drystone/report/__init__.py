"""Figures for the engineer: the capacity curve, the mechanism, the benchmark's pages."""

from __future__ import annotations

from drystone.report.benchmark_figure import draw_benchmark_wall
from drystone.report.curve_figure import draw_curve
from drystone.report.mechanism import Mechanism
from drystone.report.mechanism_figure import draw_mechanism
from drystone.report.plots import plot_curve, plot_mechanism, plot_model

__all__ = [
    "Mechanism",
    "draw_benchmark_wall",
    "draw_curve",
    "draw_mechanism",
    "plot_curve",
    "plot_mechanism",
    "plot_model",
]
