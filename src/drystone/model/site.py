"""What a model file says under [site] and [assessment], as it says it: plain and frozen.

Units are those of the file: ground accelerations in g, damping in percent.  What the records mean
is for `drystone.assessment`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drystone.common.registry import Registry
from drystone.model.construction.contents import Held, file_named

if TYPE_CHECKING:
    from drystone.assessment.methods.base import MethodFile

#: Limit states that may have a ground motion of their own: those of NTC 2018 and of EN 1998-3.
LIMIT_STATES = ("SLO", "SLD", "SLV", "SLC", "DL", "SD", "NC")

#: Methods of assessment, a file each: a module as `drystone.assessment.methods.base.MethodFile`
#: says.  They stand above models, which only know their names.
METHODS: Registry[MethodFile] = Registry(
    what="method",
    group="drystone.methods",
    ours={
        "ntc2018-local": "drystone.assessment.methods.ntc2018_local",
        "ntc2009-local": "drystone.assessment.methods.ntc2009_local",
        "ntc2018-global": "drystone.assessment.methods.ntc2018_global",
        "ec8-n2": "drystone.assessment.methods.ec8_n2",
        "en1998-3-2025-rocking": "drystone.assessment.methods.en1998_3_2025_rocking",
        "asce41": "drystone.assessment.methods.asce41",
        "rocking": "drystone.assessment.methods.rocking",
    },
)

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
    files: Mapping[str, str] | None = None  # texts by name: no file is read

    def file(self, name: str) -> Path | Held:
        """The file of a name in the table."""
        return file_named(name, self.folder, self.files)

    def as_dict(self) -> dict[str, Any]:
        """The table of a model file; paths of files become whole, but for those of results."""
        data = {"code": self.code, **self.values}
        data |= {name: dict(values) for name, values in self.states.items()}
        if self.floor:
            data["floor"] = dict(self.floor)
        return data if self.files is not None else _whole(data, self.folder)


@dataclass(frozen=True, kw_only=True)
class AssessmentInput:
    """[assessment]: what the engineer decides."""

    values: Mapping[str, Any] = field(default_factory=dict)  # keys that are given
    folder: str = ""  # from where paths of files go
    files: Mapping[str, str] | None = None  # as of `Site`

    def file(self, name: str) -> Path | Held:
        """The file of a name in the table."""
        return file_named(name, self.folder, self.files)

    def as_dict(self) -> dict[str, Any]:
        """The table of a model file; paths of files become whole, but for those of results."""
        values = dict(self.values)
        return values if self.files is not None else _whole(values, self.folder)


def _whole(data: dict[str, Any], folder: str) -> dict[str, Any]:
    def whole(key: str, value: Any) -> Any:
        if isinstance(value, Mapping):
            return {k: whole(k, v) for k, v in value.items()}
        if isinstance(value, list | tuple):
            return [whole("", item) for item in value]
        return str((Path(folder) / value).resolve()) if key == FILE else value

    return {key: whole(key, value) for key, value in data.items()}


def known_states() -> tuple[str, ...]:
    """Limit states of all methods, those without a ground motion of their own last."""
    found = dict.fromkeys(LIMIT_STATES)
    methods = [method for _, method in METHODS.loaded()]
    found |= dict.fromkeys(name for method in methods for name in method.STATES)
    found |= dict.fromkeys(name for method in methods for name in method.MORE_STATES)
    return tuple(found)
