"""Contacts and the model of a ``results.h5``, read when they are asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import overload

from drystone.contact.forces import ContactForces
from drystone.io.modelfile.read import model_from_text
from drystone.io.results.names import RESULTS
from drystone.io.results.results_reader import ResultsReader
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model


class StoredContacts(Sequence[ContactForces]):
    """Contact forces of a ``results.h5``, one point at a time: together they may be gigabytes."""

    def __init__(self, path: Path, rows: range) -> None:
        self._path, self._rows = path, rows

    def within(self, folder: Path) -> bool:
        """Whether they are those of that folder of results."""
        return self._path.resolve() == (folder / RESULTS).resolve()

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, k: int) -> ContactForces: ...
    @overload
    def __getitem__(self, k: slice) -> StoredContacts: ...
    def __getitem__(self, k: int | slice) -> ContactForces | StoredContacts:
        rows = self._rows[k]  # raises IndexError, counts from the end
        if isinstance(rows, range):
            return StoredContacts(self._path, rows)
        with ResultsReader(self._path) as file:
            return file.contacts(rows)


def model_of(stored: ResultsReader) -> Model | None:
    """The model that a file describes; None where this version cannot read it."""
    try:
        return model_from_text(
            stored.attribute("model"),
            source=stored.attribute("model_source") or None,
            sha256=stored.attribute("model_sha256"),
            need_engine=False,
            files=stored.files(),
        )
    except ModelError:
        return None
