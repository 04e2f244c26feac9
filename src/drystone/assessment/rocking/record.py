"""Records of ground motion."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from drystone.assessment.columns import checked_columns, read_columns, unit_of
from drystone.assessment.errors import positive
from drystone.common.arrays import Array
from drystone.model.construction.contents import Held, name_of

HEADER = ("t", "a")


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """Acceleration of the ground against time, straight between points, zero outside."""

    time: Array  # (n,) s
    acceleration: Array  # (n,) m/s2
    name: str = "record"

    def __post_init__(self) -> None:
        t, a = checked_columns(self.time, self.acceleration, self.name, "time")
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


def read_record(path: str | Path | Held, *, unit: str) -> Record:
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
    name = f'record "{name_of(path)}"'
    factor = unit_of(unit, name)
    time, value = read_columns(path, HEADER, name)
    record = Record(time=time, acceleration=value * factor, name=name)
    positive(record.peak_acceleration, f"{name}: the largest acceleration")
    return record
