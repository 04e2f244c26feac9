"""Names in sentences: printed, listed, counted, and those that were meant by unknown names."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeVar

LONGEST = 60  # letters of a text shown in a sentence
MOST = 12  # names listed in one
FEW = 5  # names of what a sentence is about

Value = TypeVar("Value")


def printable(text: str) -> str:
    """Text with escapes in place of what would steer a terminal, as ``\\x1b``."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def quoted(text: str) -> str:
    """Text in double quotes, on one line and not too long."""
    short = text if len(text) <= LONGEST else text[:LONGEST] + "..."
    return printable(json.dumps(short, ensure_ascii=False))


def suggestion(name: str, known: Sequence[str]) -> str:
    """End of a sentence on an unknown name: the nearest known one, or the first few."""
    close = nearest(name, known)
    if close is not None:
        return f"did you mean {quoted(close)}?"
    if len(known) == 1:
        return f"only {quoted(known[0])} is known"
    return "known are " + ", ".join(map(quoted, known[:MOST])) + ", ..." * (len(known) > MOST)


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name that is most like another, if any is."""
    found = get_close_matches(name, known, n=1, cutoff=0.5)
    return found[0] if found else None


def in_any_case(name: str, known: Iterable[str]) -> str | None:
    """The known name that is the same but for the case of its letters; the exact one goes before
    others."""
    same = [one for one in known if one.casefold() == name.casefold()]
    return name if name in same else next(iter(same), None)


def number_of(n: int, name: str) -> str:
    """So many of them: 1 block, 2 blocks."""
    return f"{n} {name}" if n == 1 else f"{n} {name}s"


def listed(names: Sequence[str]) -> str:
    """The first few names in quotes, and how many more there are."""
    shown = ", ".join(map(quoted, names[:FEW]))
    return shown + (f" and {len(names) - FEW} more" if len(names) > FEW else "")


def there_is_no(what: str, name: str, known: Iterable[str]) -> str:
    """Sentence on a name that no ``what`` goes by: the one that was meant, and what there is."""
    names = [str(one) for one in known]
    if not names:
        return f"there is no {what} {quoted(name)}, and no other"
    close = nearest(name, names)
    meant = f"did you mean {quoted(close)}? " if close is not None else ""
    return f"there is no {what} {quoted(name)}: {meant}there {_are(names)}"


def _are(names: Sequence[str]) -> str:
    return f"{'is' if len(names) == 1 else 'are'} {listed(names)}"


class UnknownNameError(KeyError):
    """A name that nothing goes by; its text says what there is."""

    def __str__(self) -> str:
        return str(self.args[0])


class Named(dict[str, Value]):
    """What goes by names; an unknown one is answered with those there are."""

    def __init__(self, what: str, items: Mapping[str, Any]) -> None:
        super().__init__(items)
        self.what = what  # that the names are of, in one word

    def __missing__(self, name: object) -> Value:
        raise UnknownNameError(there_is_no(self.what, str(name), self))

    def __reduce__(self) -> Any:
        return Named, (self.what, dict(self))
