"""``curve.csv``: the capacity curve, one line per point."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from drystone.curve import COLUMNS, CapacityCurve
from drystone.export.folder import whole_file

#: The columns that readers rely on come first; the others follow in the order of `CurvePoint`.
LEADING = (
    "step",
    "control_displacement",
    "load_multiplier",
    "applied_multiplier",
    "carried_multiplier",
    "residual",
)
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


def _plain(value: Any) -> Any:
    """A number of numpy as Python's own, which is written in the digits that give it back."""
    return value.item() if hasattr(value, "item") else value
