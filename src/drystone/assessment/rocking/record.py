"""Records of ground motion."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.spectra.table import UNITS, read_columns

Array = NDArray[np.float64]

HEADER = ("t", "a")


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """Acceleration of the ground against time, straight between points, zero outside."""

    time: Array  # (n,) s
    acceleration: Array  # (n,) m/s2
    name: str = "record"

    def __post_init__(self) -> None:
        t = np.ascontiguousarray(self.time, dtype=np.float64)
        a = np.ascontiguousarray(self.acceleration, dtype=np.float64)
        if t.ndim != 1 or t.shape != a.shape or len(t) < 2:
            raise AssessmentError(f"{self.name}: two points or more, a time and a value each")
        wrong = ~(np.isfinite(t) & np.isfinite(a))
        if wrong.any():
            raise AssessmentError(
                f"{self.name}: point {int(np.argmax(wrong)) + 1} is not finite; remove or mend it"
            )
        if (np.diff(t) <= 0.0).any():
            i = int(np.argmax(np.diff(t) <= 0.0))
            raise AssessmentError(
                f"{self.name}: times do not grow, {t[i + 1]:g} s comes after {t[i]:g} s; sort them"
            )
        object.__setattr__(self, "time", t)
        object.__setattr__(self, "acceleration", a)

    @property
    def peak_acceleration(self) -> float:
        """PGA [m/s2]."""
        return float(np.max(np.abs(self.acceleration)))

    @property
    def peak_velocity(self) -> float:
        """PGV [m/s], of the acceleration as it is, without a correction of the base line."""
        steps = 0.5 * (self.acceleration[1:] + self.acceleration[:-1]) * np.diff(self.time)
        return float(np.max(np.abs(np.cumsum(steps))))

    def scaled(self, factor: float) -> Record:
        """The record times a factor; below zero turns it round."""
        return replace(self, acceleration=self.acceleration * factor)


def read_record(path: str | Path, *, unit: str) -> Record:
    """The record in a CSV file with the header ``t,a``, times in s.

    Parameters
    ----------
    unit
        Of the accelerations: "g" or "m/s2".

    Raises
    ------
    AssessmentError
        Where the file is missing or is no record: names the line and what would mend it.
    """
    name = f'record "{Path(path).name}"'
    if unit not in UNITS:
        raise AssessmentError(f'{name}: the unit "{unit}" is not known; say "g" or "m/s2"')
    time, value = read_columns(path, HEADER, name)
    record = Record(time=time, acceleration=value * UNITS[unit], name=name)
    positive(record.peak_acceleration, f"{name}: the largest acceleration")
    return record
