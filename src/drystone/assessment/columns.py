"""Two columns of numbers, as spectra and records of ground motion are given."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError
from drystone.common.arrays import Array
from drystone.common.ranges import RANGES, problem, too_many
from drystone.model.assembly import GRAVITY
from drystone.model.construction.contents import Held, read_bytes
from drystone.model.construction.errors import ModelError

#: Accelerations of a file in m/s2 by the unit that is said.
UNITS = {"g": GRAVITY, "m/s2": 1.0}


def unit_of(unit: str, name: str) -> float:
    """What accelerations of a file are multiplied by [m/s2]; ``name`` is for errors."""
    if unit not in UNITS:
        raise AssessmentError(f'{name}: the unit "{unit}" is not known; say "g" or "m/s2"')
    return UNITS[unit]


def checked_columns(
    first: ArrayLike, second: ArrayLike, name: str, what: str
) -> tuple[Array, Array]:
    """Two columns (n,), (n,), n at least two, the first of which grows [s].

    Parameters
    ----------
    name
        Of the whole, for errors.
    what
        The first column is, as "period" or "time".
    """
    t = np.ascontiguousarray(first, dtype=np.float64)
    a = np.ascontiguousarray(second, dtype=np.float64)
    if t.ndim != 1 or t.shape != a.shape or len(t) < 2:
        raise AssessmentError(f"{name}: two points or more, a {what} and a value each")
    wrong = ~(np.isfinite(t) & np.isfinite(a))
    if wrong.any():
        raise AssessmentError(
            f"{name}: point {int(np.argmax(wrong)) + 1} is not finite; remove or mend it"
        )
    if (np.diff(t) <= 0.0).any():
        i = int(np.argmax(np.diff(t) <= 0.0))
        raise AssessmentError(
            f"{name}: {what}s do not grow, {t[i + 1]:g} s comes after {t[i]:g} s; sort them and "
            "keep each once"
        )
    return t, a


def read_columns(
    path: str | Path | Held, header: tuple[str, str], name: str
) -> tuple[Array, Array]:
    """Two columns (n,), (n,) of numbers from a CSV file with a header; ``name`` is for errors.

    Errors say where a file is no such table, never what stands there: a model of somebody else may
    name any file of whoever runs it.
    """
    try:
        text = read_bytes(path if isinstance(path, Held) else Path(path), "the table").decode(
            "utf-8-sig"
        )
        rows = [
            (number, [cell.strip() for cell in row])
            for number, row in enumerate(csv.reader(text.splitlines()), start=1)
            if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
        ]
    except ModelError as error:
        raise AssessmentError(f"{name} cannot be read: {error}") from None
    except (UnicodeDecodeError, csv.Error):
        raise AssessmentError(f"{name}: is no table of text: write it as CSV in UTF-8") from None
    if not rows or tuple(rows[0][1]) != header:
        begins = f"line {rows[0][0]} is not its header" if rows else "is empty, without a header"
        raise AssessmentError(
            f'{name}: {begins}: begin with the line "{",".join(header)}", commas between columns '
            "and points in numbers"
        )
    if wrong := too_many("rows", len(rows) - 1):
        raise AssessmentError(f"{name} {wrong}")
    values = []
    for number, row in rows[1:]:
        if len(row) != len(header):
            raise AssessmentError(
                f"{name}, line {number}: has {len(row)} columns, and the header 2: commas stand "
                "between columns, points in numbers"
            )
        try:
            first, second = (float(cell) for cell in row)
        except ValueError:
            raise AssessmentError(f"{name}, line {number}: is not two numbers: mend it") from None
        if problem("column_time", first) or problem("column_value", second):
            most = RANGES["column_value"].most
            raise AssessmentError(
                f"{name}, line {number}: is not finite, or beyond {most:g}: mend it"
            )
        values.append((first, second))
    if len(values) < 2:
        raise AssessmentError(f"{name} has {len(values)} points; two or more are needed")
    columns = np.array(values, dtype=np.float64)
    return np.ascontiguousarray(columns[:, 0]), np.ascontiguousarray(columns[:, 1])
