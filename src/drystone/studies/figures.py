"""Figures of a study: bands of curves, effects, indices, scatter, fragility, convergence."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.language import number
from drystone.io.results.folder import in_a_sentence, whole_file
from drystone.report import canvas
from drystone.studies.study import Study
from drystone.studies.tables import column_names, read_samples, some_curves
from drystone.studies.words import in_figure, of_column, of_sentence

#: Curves that bands are made of, and those that are drawn one by one.
MOST_CURVES, DRAWN = 4000, 60
#: Least width of an axis of effects, over the mean: what hardly changes is not drawn as a change.
LEAST_SPAN = 0.01
#: Samples that a scatter shows.
MOST_POINTS = 4000
_BLUE, _RED, _GREEN = canvas.CURVE_COLOURS[:3]
#: What tells red from blue in print without colours.
_HATCH = "////"
#: Lines of several curves, likewise.
_STYLES = ("-", "--", "-.", ":")
#: Letters of a line of a title.
_LINE = 72


def draw_all(
    title: str, folder: Path, found: Mapping[str, Any], into: Path | None = None
) -> list[str]:
    """Write all figures that a study has, in the language that is spoken; their names.

    Parameters
    ----------
    folder
        Of the study, whose tables are drawn.
    into
        Where the figures are written, by default there.
    """
    drawn: list[str] = []
    to = into or folder

    def draw(name: str, make: Callable[[], Any]) -> None:
        figure = make()
        if figure is None:
            (to / name).unlink(missing_ok=True)
            return
        with whole_file(to / name) as draft:
            canvas.save(figure, draft)
        drawn.append(name)

    def files() -> None:
        draw("bands.png", lambda: bands(folder, title))
        draw("tornado.png", lambda: tornado(found, title))
        draw("indices.png", lambda: indices(found, title))
        draw("scatter.png", lambda: scatter(folder, title))
        draw("fragility.png", lambda: fragility(folder, found, title))
        draw("convergence.png", lambda: convergence(found, title))

    in_a_sentence(files)
    return drawn


def bands_of(displacement: Array, multiplier: Array, points: int = 400) -> tuple[Array, Array]:
    """Places (points,) [m] and multipliers at 5, 50 and 95 % of curves, (3, points).

    Beyond its end a curve carries nothing.

    Parameters
    ----------
    displacement, multiplier
        (n, m): curves at m points each.
    """
    end = float(np.quantile(displacement.max(axis=1), 0.98))
    at = end * (np.arange(points) / (points - 1)) ** 2
    rows = np.empty((len(displacement), points))
    for row, d, m in zip(rows, displacement, multiplier, strict=True):
        onward = np.maximum.accumulate(d)
        last = np.append(np.flatnonzero(np.diff(onward) > 0.0), len(d) - 1)
        row[:] = np.interp(at, onward[last], m[last], right=0.0)
    return at, np.quantile(rows, [0.05, 0.5, 0.95], axis=0)


def bands(folder: Path, title: str) -> Any:
    """Median and 5 to 95 % of the curves, with some of them."""
    displacement, multiplier, _ = some_curves(folder, MOST_CURVES)
    if not len(displacement):
        return None
    figure = canvas.new_figure(7.5, 4.8)
    axes = figure.add_subplot()
    every = max(1, len(displacement) // DRAWN)
    for d, m in zip(displacement[::every], multiplier[::every], strict=True):
        axes.plot(d, m, color=canvas.FAINT, lw=0.4, alpha=0.5)
    if len(displacement) > 2:
        at, (low, middle, high) = bands_of(displacement, multiplier)
        of = in_figure("median_of", n=len(displacement))
        axes.fill_between(at, low, high, color=_BLUE, alpha=0.22, lw=0, label=in_figure("within"))
        axes.plot(at, middle, color=_BLUE, lw=1.8, label=of)
        axes.set_xlim(0.0, at[-1])
        axes.legend(fontsize=9, frameon=False)
    axes.set_ylim(bottom=min(0.0, float(np.quantile(multiplier, 0.01))))
    moved = "least_reaction" in column_names(folder)
    axes.set_xlabel(of_column("largest_motion") if moved else in_figure("displacement"))
    axes.set_ylabel(in_figure("reaction" if moved else "multiplier"))
    _titled(axes, title)
    return figure


def tornado(found: Mapping[str, Any], title: str) -> Any:
    """How far each output lies where a parameter is low and where it is high."""
    told = {name: own for name, own in found["effects"].items() if own}
    if not told:
        return None
    rows = max(map(len, told.values()))
    shown = list(told.items())[:4]
    figure = canvas.new_figure(7.5, (1.0 + 0.45 * rows) * len(shown) + 0.4)
    for k, (name, own) in enumerate(shown, start=1):
        axes = figure.add_subplot(len(shown), 1, k)
        canvas.plain_axes(axes)  # before its ticks get names
        ordered = sorted(own.items(), key=lambda item: abs(item[1]["high"] - item[1]["low"]))
        middle = found["columns"][name]["mean"]
        for y, (_, one) in enumerate(ordered):
            # On one side of the mean, one bar would hide the other: they share the row.
            shared = (one["low"] >= middle) == (one["high"] >= middle)
            for key, colour, off in (("low", _BLUE, 0.15), ("high", _RED, -0.15)):
                at = y + off if shared else y
                axes.barh(
                    at,
                    one[key] - middle,
                    left=middle,
                    height=0.3 if shared else 0.6,
                    color=colour,
                    hatch=_HATCH if key == "high" else None,
                    edgecolor="white",
                    lw=0,
                )
                right = one[key] >= middle
                axes.annotate(
                    number(one[f"{key}_value"]), (one[key], at), fontsize=7.5, va="center",
                    ha="left" if right else "right", xytext=(3 if right else -3, 0),
                    textcoords="offset points",
                )  # fmt: skip
        axes.axvline(middle, color=canvas.INK, lw=0.8)
        axes.set_yticks(range(len(ordered)), [canvas.literal(label) for label, _ in ordered])
        axes.margins(x=0.12)
        low, high = axes.get_xlim()
        if high - low < (least := LEAST_SPAN * abs(middle)):
            axes.set_xlim(middle - 0.5 * least, middle + 0.5 * least)
        axes.set_xlabel(in_figure("mean_of", column=of_column(name)), fontsize=9)
    about = in_figure("tenths")
    figure.suptitle(f"{_title(title)}\n{about}", fontsize=10)
    return figure


def indices(found: Mapping[str, Any], title: str) -> Any:
    """Sobol or Morris indices with their intervals."""
    told = {name: own for name, own in (found.get("indices") or {}).items() if own}
    if not told:
        return None
    shown = list(told.items())[:4]
    figure = canvas.new_figure(7.5, 2.6 * len(shown) + 0.4)
    for k, (name, own) in enumerate(shown, start=1):
        axes = figure.add_subplot(len(shown), 1, k)
        canvas.plain_axes(axes)  # before its ticks get names
        names = list(own["parameters"])
        rows = list(own["parameters"].values())
        place = np.arange(len(names), dtype=float)
        sobol = "first" in rows[0]
        keys = ("first", "total") if sobol else ("mu_star",)
        for offset, (key, colour) in enumerate(zip(keys, (_BLUE, _RED), strict=False)):
            values = [row[key] for row in rows]
            errors = [row[f"{key}_confidence"] for row in rows]
            label = {"first": "first_order", "total": "total", "mu_star": "mean_effect"}[key]
            axes.bar(place + 0.36 * offset, values, width=0.34, color=colour,
                     label=in_figure(label), hatch=_HATCH if offset else None,
                     edgecolor="white", lw=0,
                     yerr=errors, error_kw={"lw": 1.0, "capsize": 3})  # fmt: skip
        if not sobol:
            axes.plot(
                place, [row["sigma"] for row in rows], "D", color=_RED, label=in_figure("deviation")
            )
        axes.set_xticks(place + (0.18 if sobol else 0.0), list(map(canvas.literal, names)))
        what = in_figure("index" if sobol else "effect")
        axes.set_ylabel(f"{what}:\n{of_column(name)}", fontsize=9)
        axes.legend(fontsize=8, frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    figure.suptitle(f"{_title(title)}\n{in_figure('bars')}", fontsize=11)
    return figure


def scatter(folder: Path, title: str) -> Any:
    """Peak and ultimate displacement of the samples."""
    try:
        frame = read_samples(folder, ["peak_multiplier", "ultimate_displacement"])
    except (OSError, ValueError, KeyError):
        return None
    frame = frame.dropna()
    if len(frame) < 3:
        return None
    frame = frame.iloc[:: max(1, len(frame) // MOST_POINTS)]
    figure = canvas.new_figure(6.2, 4.8)
    axes = figure.add_subplot()
    axes.plot(frame["ultimate_displacement"], frame["peak_multiplier"], "o", ms=3,
              color=_BLUE, alpha=0.8 if len(frame) < 400 else 0.35, mew=0)  # fmt: skip
    axes.set_xlabel(of_column("ultimate_displacement"))
    axes.set_ylabel(of_column("peak_multiplier"))
    _titled(axes, title)
    return figure


def fragility(folder: Path, found: Mapping[str, Any], title: str) -> Any:
    """Fragility curves with their intervals, and what they are fitted to."""
    from scipy.stats import norm

    told = [one for one in found["fragility"] if one.get("median") is not None]
    if not told:
        return None
    figure = canvas.new_figure(7.0, 4.8)
    axes = figure.add_subplot()
    for one, colour, style in zip(told, canvas.CURVE_COLOURS, cycle(_STYLES), strict=False):
        median, beta = one["median"], one["beta"]
        at = np.geomspace(median * np.exp(-3.2 * beta), median * np.exp(3.2 * beta), 300)
        label = in_figure("fitted", name=one["name"], median=median, beta=beta)
        axes.plot(at, norm.cdf(np.log(at / median) / beta), style, color=colour, lw=1.6,
                  label=canvas.literal(label))  # fmt: skip
        edges = [
            norm.cdf(np.log(at / m) / b)
            for m in one["median_confidence"]
            for b in one["beta_confidence"]
        ]
        axes.fill_between(at, np.min(edges, axis=0), np.max(edges, axis=0), color=colour,
                          alpha=0.15, lw=0)  # fmt: skip
        if one["method"] == "capacity":
            values = np.sort(read_samples(folder, one["columns"]).to_numpy(dtype=float).ravel())
            values = values[np.isfinite(values) & (values > 0.0)]
            share = (np.arange(len(values)) + 0.5) / len(values)
            every = max(1, len(values) // 300)
            axes.plot(values[::every], share[::every], ".", color=colour, ms=3)
        for level, n, k in one.get("stripes", []):
            axes.plot([level], [k / n], "o", color=colour, ms=5)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlim(left=0.0)
    axes.set_xlabel(
        ", ".join(of_column(name) for name in dict.fromkeys(o["columns"][0] for o in told))
    )
    axes.set_ylabel(in_figure("probability"))
    axes.legend(fontsize=8.5, frameon=False)
    _titled(axes, title)
    return figure


def convergence(found: Mapping[str, Any], title: str) -> Any:
    """Mean with its standard error and quantiles, for more and more samples."""
    told = [(name, own) for name, own in found["convergence"].items() if own][:4]
    if not told:
        return None
    figure = canvas.new_figure(7.5, 2.4 * len(told) + 0.4)
    for k, (name, own) in enumerate(told, start=1):
        axes = figure.add_subplot(len(told), 1, k)
        n, mean, error = (np.array(own[key], float) for key in ("n", "mean", "error"))
        axes.fill_between(n, mean - 1.96 * error, mean + 1.96 * error, color=_BLUE, alpha=0.25,
                          lw=0, label=in_figure("mean_interval"))  # fmt: skip
        axes.plot(n, mean, color=_BLUE, lw=1.5, label=in_figure("mean"))
        for key, style in (("p05", "--"), ("median", "-."), ("p95", "--")):
            label = {"p05": in_figure("ends"), "median": in_figure("median")}.get(key)
            axes.plot(n, own[key], style, color=canvas.INK, lw=1.0, label=label)
        axes.set_xscale("log")
        canvas.speak_ticks(axes)
        for set_format in (axes.xaxis.set_major_formatter, axes.xaxis.set_minor_formatter):
            set_format("{x:.0f}")
        axes.set_ylabel(of_column(name), fontsize=9)
        if k == len(told):
            axes.set_xlabel(in_figure("samples"))
        if k == 1:
            axes.legend(
                fontsize=8, frameon=False, ncols=4, loc="lower left", bbox_to_anchor=(0.0, 1.0)
            )
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(visible=True, color="#dddddd", linewidth=0.6)
        axes.tick_params(labelsize=9)
    figure.suptitle(_title(title), fontsize=11)
    return figure


def target(aim: Mapping[str, Any], name: str, found: Mapping[str, Any], folder: Path) -> None:
    """Runs of a search, and the value that was looked for: ``target.png``.

    Parameters
    ----------
    aim
        Keys of [target].
    name
        Of its parameter.
    found
        What the search says.
    """
    figure = canvas.new_figure(6.6, 4.4)
    axes = figure.add_subplot()
    if found["curve"]:
        x, y = np.array(found["curve"], dtype=float).T
        axes.plot(x, y, "o", color=_BLUE, ms=4, label=in_figure("runs"))
        a, b = found.get("jump_at") or (np.inf, np.inf)
        for side in (x <= a, x >= b):
            axes.plot(x[side], y[side], color=_BLUE, lw=1.0)
        if np.isfinite(a):
            axes.axvline(0.5 * (a + b), color=canvas.INK, lw=0.8, ls=":", label=in_figure("jump"))
    axes.axhline(aim["value"], color=_RED, lw=1.0, ls="--", label=in_figure("sought"))
    if found["value"] is not None:
        axes.plot(
            [found["value"]],
            [found["reached"]],
            "D",
            color=_RED,
            ms=7,
            mfc="none",
            mew=1.5,
            label=in_figure("answer"),
        )
    axes.set_xlabel(canvas.literal(name))
    axes.set_ylabel(of_column(aim["output"]))
    axes.legend(fontsize=9, frameon=False)
    _titled(axes, of_sentence(found) or "")
    with whole_file(folder / "target.png") as draft:
        canvas.save(figure, draft)


def target_map(asked: Study, grid: tuple[Array, Array, Array], folder: Path) -> None:
    """An output over two parameters, with the line where it has its value: ``target.png``.

    Parameters
    ----------
    grid
        Values of both parameters and of the output, (n, m) each; NaN where a run has none.
    """
    assert asked.target is not None
    x, y, z = grid
    figure = canvas.new_figure(6.8, 5.0)
    axes = figure.add_subplot()
    filled = axes.contourf(x, y, np.ma.masked_invalid(z), levels=14, cmap="viridis")
    figure.colorbar(filled, label=of_column(asked.target["output"]))
    value = asked.target["value"]
    if np.nanmin(z) < value < np.nanmax(z):
        line = axes.contour(
            x, y, np.ma.masked_invalid(z), levels=[value], colors="white", linewidths=2.0
        )
        axes.clabel(line, fmt=number(value, "g"), fontsize=9)
    axes.plot(x.ravel(), y.ravel(), ".", color="white", ms=2.5, alpha=0.7)
    axes.set_xlabel(canvas.literal(asked.task.names[0]))
    axes.set_ylabel(canvas.literal(asked.task.names[1]))
    axes.set_title(_title(asked.title), fontsize=11)
    with whole_file(folder / "target.png") as draft:
        canvas.save(figure, draft)


def _title(text: str) -> str:
    """A title in lines that fit."""
    return "\n".join(map(canvas.literal, textwrap.wrap(text, _LINE)))


def _titled(axes: Any, title: str) -> None:
    axes.set_title(_title(title), fontsize=11)
    canvas.plain_axes(axes)
