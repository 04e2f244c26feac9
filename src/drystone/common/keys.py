"""Keys of files, declared beside what reads them: a load pattern, a method, a builder.

The model file's check is made of these declarations (`io.modelfile.declared`), so that whoever adds
a thing of a kind declares its keys in its own file.  Keys that are the parameters of a function are
declared by the annotations of these (`keys_of`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from inspect import Parameter, signature
from typing import Any, get_args, get_type_hints

from drystone.common.ranges import Range


@dataclass(frozen=True)
class Number:
    """A number in a range, in the unit of the range."""

    range: Range


@dataclass(frozen=True)
class Whole:
    """A whole number, both ends allowed."""

    least: int = 0
    most: int = 10_000


@dataclass(frozen=True)
class Flag:
    """True or false."""


@dataclass(frozen=True)
class Text:
    """Any text."""


@dataclass(frozen=True)
class Choice:
    """One of some texts, or of some whole numbers."""

    among: tuple[str, ...] | tuple[int, ...]


@dataclass(frozen=True)
class Direction:
    """As many numbers as the file has coordinates, not all zero; read as a unit vector."""


@dataclass(frozen=True)
class Vector:
    """As many numbers of a range as the file has coordinates."""

    range: Range


@dataclass(frozen=True)
class BlockPoint:
    """A point of a block: a name, or a place [m]."""


@dataclass(frozen=True)
class Several:
    """A list of values of one type; None: as long as one likes."""

    of: Type
    least: int | None = None
    most: int | None = None


@dataclass(frozen=True)
class ByState:
    """A table of values of one type by limit state."""

    of: Type


@dataclass(frozen=True)
class Tables:
    """A list of tables, each with these keys."""

    keys: tuple[Key, ...]


Type = (
    Number | Whole | Flag | Text | Choice | Direction | Vector | BlockPoint | Several | ByState
    | Tables
)  # fmt: skip


class _Needed:
    def __repr__(self) -> str:
        return "NEEDED"


#: The default of a key that has none.
NEEDED = _Needed()


class _OfSpace:
    def __repr__(self) -> str:
        return "OF_SPACE"


#: Beside the type in a parameter's annotation: a key that models in space need, and none in the
#: plane has.
OF_SPACE = _OfSpace()


@dataclass(frozen=True, kw_only=True)
class Key:
    """A key of a table."""

    name: str
    type: Type
    default: Any = NEEDED
    says: str = ""  # what a message adds where it is missing
    of_space: bool = False  # whether models of the plane do not have it


def keys_of(function: Callable[..., object]) -> tuple[Key, ...]:
    """Keys that are parameters of a function, or fields of a record, with their defaults.

    An annotation declares one, as in ``length: Annotated[float, Number(...), "in m"]``: its type,
    what a message adds where the key is missing, and `OF_SPACE` where it is of space.  Of two texts
    the later one counts.  A parameter without a type of keys is none.
    """
    hints = get_type_hints(function, include_extras=True)
    found = []
    for name, parameter in signature(function).parameters.items():
        hint = hints[name]  # of ``T | None`` what is declared of T
        told = [x for part in (hint, *get_args(hint)) for x in getattr(part, "__metadata__", ())]
        types = [x for x in told if isinstance(x, Type)]
        if not types:
            continue
        of_space = OF_SPACE in told
        needed = of_space or parameter.default is Parameter.empty
        found.append(
            Key(
                name=name,
                type=types[0],
                default=NEEDED if needed else parameter.default,
                says=next((x for x in reversed(told) if isinstance(x, str)), ""),
                of_space=of_space,
            )
        )
    return tuple(found)
