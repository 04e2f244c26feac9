"""``curve.csv``: the capacity curve, one line per point; ``ties.csv``: one per point and tie."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drystone.io.results.folder import whole_file
from drystone.io.results.names import CURVE, TIES
from drystone.io.results.outputs import Finished, Output
from drystone.model.construction.words import in_a_cell
from drystone.results.curve import COLUMNS, CapacityCurve
from drystone.results.forces import TieRecord

#: The columns that readers rely on come first; the others follow in the order of `CurvePoint`.
LEADING = (
    "step",
    "control_displacement",
    "load_multiplier",
    "applied_multiplier",
    "carried_multiplier",
    "residual",
)
TIE_HEADER = ("step", "control_displacement", "tie", "force", "elongation", "state")
HEADER = LEADING + tuple(name for name in COLUMNS if name not in LEADING)


def write_curve(curve: CapacityCurve, path: Path | str) -> None:
    """Write every field of every point, SI units; numbers are read back to the last bit."""
    with (
        whole_file(Path(path)) as draft,
        draft.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADER)
        for point in curve.points:
            writer.writerow([_plain(getattr(point, name)) for name in HEADER])


def write_ties(curve: CapacityCurve, ties: TieRecord, path: Path | str) -> None:
    """Write force [N], elongation [m] and state of every tie at every point."""
    with (
        whole_file(Path(path)) as draft,
        draft.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(TIE_HEADER)
        for k, point in enumerate(curve.points):
            for i, name in enumerate(ties.names):
                values = ties.force[k, i], ties.elongation[k, i]
                about = point.step, point.control_displacement, in_a_cell(name)
                row = *about, *values, ties.state(k, i)
                writer.writerow([_plain(value) for value in row])


def _write_ties(done: Finished, keys: Mapping[str, Any]) -> None:
    if done.curve.ties is not None:
        write_ties(done.curve, done.curve.ties, done.folder / TIES)


CURVE_OUTPUT = Output(
    files=(CURVE,),
    write=lambda done, keys: write_curve(done.curve, done.folder / CURVE),
    short=True,
)
TIES_OUTPUT = Output(files=(TIES,), write=_write_ties, short=True)


def _plain(value: Any) -> Any:
    """A number of numpy as Python's own, which is written in the digits that give it back."""
    return value.item() if hasattr(value, "item") else value
