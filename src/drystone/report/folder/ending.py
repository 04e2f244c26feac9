"""The files that stand in a folder once its analysis has ended, beside ``results.h5``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drystone.common.aside import answer
from drystone.io.results.names import RESULTS
from drystone.io.results.outputs import Finished, Output, written_of
from drystone.io.results.results_reader import ResultsReader
from drystone.io.results.summary import plain, summarise
from drystone.report.folder.aside import drawing

if TYPE_CHECKING:
    from drystone.common.aside import Aside
    from drystone.limit.beside import Beside
    from drystone.model.model import Model
    from drystone.results.curve import CapacityCurve


def finished(
    folder: Path,
    model: Model,
    curve: CapacityCurve,
    beside: Beside,
    *,
    formats: Sequence[str] = (),
    mechanism_displacement: float | None = None,
) -> Finished:
    """An analysis that has ended, with its summary; ``formats`` of pictures beside PNG."""
    summary = summarise(curve, model) | {
        "associative_multiplier": beside.associative,
        "non_associative_multiplier": beside.non_associative,
        "collapse_range": plain(beside.collapse_range),
        "upper_bound": plain(beside.upper_bound),
    }
    return Finished(
        folder=folder,
        model=model,
        curve=curve,
        summary=summary,
        beside=beside,
        formats=tuple(dict.fromkeys(("png", *formats))),
        mechanism_displacement=mechanism_displacement,
        results=None,
    )


def write_short(done: Finished) -> None:
    """Tables and summary, which may find space where ``results.h5`` found none."""
    for output, keys in written_of(done.model):
        if output.short:
            output.write(done, keys)


def write_long(done: Finished, aside: Aside | None = None) -> None:
    """Pictures and series, of the points that ``results.h5`` has; pictures by a process ``aside``,
    if there is one."""
    with ResultsReader(done.folder / RESULTS) as results:
        curve = replace(done.curve, points=done.curve.points[: results.n_points])
        done = replace(done, curve=curve, results=results)
        written = [each for each in written_of(done.model) if not each[0].short]
        if aside is None:
            _write(written, done)
            return
        pictures = [each for each in written if each[0].aside]
        drawn = drawing(aside, done)
        try:
            _write([each for each in written if not each[0].aside], done)
            if not answer(drawn, lambda: False):
                _write(pictures, done)
        except BaseException:
            aside.interrupt()
            raise


def _write(written: Sequence[tuple[Output, Mapping[str, Any]]], done: Finished) -> None:
    for output, keys in written:
        output.write(done, keys)
