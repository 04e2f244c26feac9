"""What is wrong with a study, said all at once, and libraries that are missing."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from drystone.model.construction.errors import ModelError

#: What `pip install 'drystone[study]'` adds, by the name of the module.
EXTRA = ("pyarrow", "pandas", "SALib", "dask", "distributed")


class StudyError(ModelError):
    """A study that cannot be run; one sentence for each problem."""


def needed(name: str) -> Any:
    """A module of the extra; `StudyError` names the command that installs it where it is missing.

    Parameters
    ----------
    name
        Of the module, which may be one inside a package: "pyarrow.parquet".
    """
    package = name.partition(".")[0]
    if find_spec(package) is None:
        raise StudyError([f"{package} is not installed: pip install 'drystone[study]'"])
    return import_module(name)
