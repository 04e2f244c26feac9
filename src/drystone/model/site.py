"""What a model file says under [site] and [assessment], as it says it: plain and frozen.

Units are those of the file: ground accelerations in g, damping in percent.  What the records mean
is for `drystone.assessment`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

#: Limit states that may have a ground motion of their own: those of NTC 2018 and of EN 1998-3.
LIMIT_STATES = ("SLO", "SLD", "SLV", "SLC", "DL", "SD", "NC")

#: Keys that name files, in tables of either record.
FILE = "file"


@dataclass(frozen=True, kw_only=True)
class Site:
    """[site]: what the ground does."""

    code: str  # "ntc2018", "ec8" or "csv"
    values: Mapping[str, Any] = field(default_factory=dict)  # keys of the code that are given
    states: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # [site.SLD], ...
    floor: Mapping[str, Any] = field(default_factory=dict)  # [site.floor]
    folder: str = ""  # from where paths of files go

    def as_dict(self) -> dict[str, Any]:
        """The table of a model file; paths of files become whole."""
        data = {"code": self.code, **self.values}
        data |= {name: dict(values) for name, values in self.states.items()}
        if self.floor:
            data["floor"] = dict(self.floor)
        return _whole(data, self.folder)


@dataclass(frozen=True, kw_only=True)
class AssessmentInput:
    """[assessment]: what the engineer decides."""

    values: Mapping[str, Any] = field(default_factory=dict)  # keys that are given
    folder: str = ""  # from where paths of files go

    def as_dict(self) -> dict[str, Any]:
        """The table of a model file; paths of files become whole."""
        return _whole(dict(self.values), self.folder)


def _whole(data: dict[str, Any], folder: str) -> dict[str, Any]:
    def whole(key: str, value: Any) -> Any:
        if isinstance(value, Mapping):
            return {k: whole(k, v) for k, v in value.items()}
        if isinstance(value, list | tuple):
            return [whole("", item) for item in value]
        return str((Path(folder) / value).resolve()) if key == FILE else value

    return {key: whole(key, value) for key, value in data.items()}
