"""Registries: things of one kind by the names that files and users give them.

A thing is one file, and one line in the table of its registry: its name, and where it is found.  It
is imported when it is asked for.  Names that are not in the table are looked for among the entry
points of the registry's group, by which other packages add things of their own.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

T = TypeVar("T")


class RegistryError(ValueError):
    """There is no thing of a name, or it cannot be loaded."""


def outside(group: str) -> dict[str, EntryPoint]:
    """Entry points of other packages in a group, by name; of two with one name the first found."""
    found: dict[str, EntryPoint] = {}
    for entry in _entry_points(tuple(sys.path)).select(group=group):
        found.setdefault(entry.name, entry)
    return found


@lru_cache(maxsize=1)
def _entry_points(path: tuple[str, ...]) -> Any:  # of another class before Python 3.12
    """Those of all packages on a path, which is `sys.path`: files of each are read for them."""
    from importlib.metadata import entry_points  # takes longer than all the rest here

    return entry_points()


@dataclass(frozen=True, kw_only=True, eq=False)
class Registry(Generic[T]):
    """Things of one kind by name: those of this package, then those of others."""

    what: str  # one of them, as in "load pattern"
    group: str  # of entry points of other packages
    ours: Mapping[str, str]  # "module:attribute", or "module", by name

    def names(self) -> tuple[str, ...]:
        """Of all of them; ours stand first and are not replaced."""
        return (*self.ours, *(name for name in self._outside() if name not in self.ours))

    def __contains__(self, name: object) -> bool:
        return name in self.ours or name in self._outside()

    def __getitem__(self, name: str) -> T:
        """That of a name; raises `RegistryError`."""
        if name in self.ours:
            module, _, attribute = self.ours[name].partition(":")
            found: Any = import_module(module)
            return cast(T, getattr(found, attribute) if attribute else found)
        entry = self._outside().get(name)
        if entry is None:
            known = ", ".join(self.names())
            raise RegistryError(f'there is no {self.what} "{name}": take one of {known}')
        try:
            return cast(T, entry.load())
        except (ImportError, AttributeError, TypeError) as error:  # also of a class that is none
            raise RegistryError(
                f'the {self.what} "{name}" ({entry.value}) cannot be loaded: {error}'
            ) from error

    def place(self, name: str) -> str:
        """Where that of a name is found, as "module:attribute"; "" where there is none."""
        entry = self._outside().get(name)
        return self.ours.get(name, "" if entry is None else entry.value)

    def own(self) -> Iterator[tuple[str, T]]:
        """Those of this package with their names."""
        return ((name, self[name]) for name in self.ours)

    def loaded(self) -> Iterator[tuple[str, T]]:
        """All that can be loaded with their names.

        One of another package that cannot is told when it is asked for by its name.
        """
        for name in self.names():
            try:
                yield name, self[name]
            except RegistryError:
                continue

    def _outside(self) -> dict[str, EntryPoint]:
        return outside(self.group)
