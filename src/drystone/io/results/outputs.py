"""Files that stand in a folder of results once an analysis has ended, by name: one file each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drystone.common.keys import Key
from drystone.common.registry import Registry

if TYPE_CHECKING:
    from drystone.io.results.results_reader import ResultsReader
    from drystone.limit.beside import Beside
    from drystone.model.model import Model
    from drystone.results.curve import CapacityCurve


@dataclass(frozen=True, kw_only=True, eq=False)
class Finished:
    """An analysis that has ended, for what is written of it."""

    folder: Path
    model: Model
    curve: CapacityCurve
    summary: dict[str, Any]  # what ``summary.json`` holds
    beside: Beside  # limit analysis
    formats: tuple[str, ...]  # of pictures
    mechanism_displacement: float | None  # m, that was asked for
    results: ResultsReader | None  # poses and contacts of the points; None for what is short


@dataclass(frozen=True, kw_only=True)
class Output:
    """What writes files into a folder of results.

    ``write`` takes the analysis, and what its [[output]] says by key.  A short one is written
    first, whole or not at all, even where the disk is too full for ``results.h5``.  What a process
    ``aside`` may write is made of what `Finished` has, which is sent there, and of nothing else
    that this process knows.
    """

    files: tuple[str, ...]  # names in the folder that it may write, which the next run removes
    write: Callable[[Finished, Mapping[str, Any]], None]
    short: bool = False
    aside: bool = False
    keys: tuple[Key, ...] = ()  # of [[output]]


#: Ours are written of every analysis, in this order; others where [[output]] asks for them.
OUTPUTS: Registry[Output] = Registry(
    what="output",
    group="drystone.outputs",
    ours={
        "curve": "drystone.io.results.csv:CURVE_OUTPUT",
        "ties": "drystone.io.results.csv:TIES_OUTPUT",
        "summary": "drystone.io.results.summary:SUMMARY_OUTPUT",
        "curve_figure": "drystone.report.folder.pictures:CURVE_OUTPUT",
        "mechanism_figure": "drystone.report.folder.pictures:MECHANISM_OUTPUT",
        "paraview": "drystone.io.results.paraview:SERIES_OUTPUT",
    },
)


def written_of(model: Model) -> list[tuple[Output, Mapping[str, Any]]]:
    """What is written of a model's analysis, ours first, with the keys that are given."""
    ours: list[tuple[Output, Mapping[str, Any]]] = [(output, {}) for _, output in OUTPUTS.own()]
    return ours + [(OUTPUTS[name], keys) for name, keys in model.analysis.outputs]


def file_names() -> list[str]:
    """Of all files that outputs may write, those of other packages too."""
    return [name for _, output in OUTPUTS.loaded() for name in output.files]
