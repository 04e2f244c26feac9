"""Two columns of numbers, as spectra and records of ground motion are given."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drystone.assembly import GRAVITY
from drystone.assessment.errors import AssessmentError

Array = NDArray[np.float64]

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


def read_columns(path: str | Path, header: tuple[str, str], name: str) -> tuple[Array, Array]:
    """Two columns (n,), (n,) of numbers from a CSV file with a header; ``name`` is for errors."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise AssessmentError(f"{name} cannot be read: {error}") from error
    rows = [
        (number, [cell.strip() for cell in row])
        for number, row in enumerate(csv.reader(text.splitlines()), start=1)
        if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    if not rows or tuple(rows[0][1]) != header:
        found = ",".join(rows[0][1]) if rows else "nothing"
        raise AssessmentError(
            f'{name}: the first line is "{found}"; write the header "{",".join(header)}", commas '
            "between columns and points in numbers"
        )
    values = []
    for number, row in rows[1:]:
        try:
            first, second = (float(cell) for cell in row)
        except ValueError:
            raise AssessmentError(
                f'{name}, line {number}: "{",".join(row)}" is not two numbers'
            ) from None
        values.append((first, second))
    if len(values) < 2:
        raise AssessmentError(f"{name} has {len(values)} points; two or more are needed")
    columns = np.array(values, dtype=np.float64)
    return np.ascontiguousarray(columns[:, 0]), np.ascontiguousarray(columns[:, 1])
