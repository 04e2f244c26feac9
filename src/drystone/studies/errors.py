"""What is wrong with a study, said all at once, and libraries that are missing."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from drystone.model.construction.errors import ModelError


class StudyError(ModelError):
    """A study that cannot be run; one sentence for each problem."""


def required(*names: str) -> None:
    """See that packages of the extra are there, without loading them; raises as `needed` does."""
    for name in names:
        if find_spec(name) is None:
            raise StudyError([f"{name} is not installed: pip install 'drystone[study]'"])


def needed(name: str) -> Any:
    """A module of the extra; `StudyError` names the command that installs it where it is missing.

    Parameters
    ----------
    name
        Of the module, which may be one inside a package: "pyarrow.parquet".
    """
    required(name.partition(".")[0])
    return import_module(name)
