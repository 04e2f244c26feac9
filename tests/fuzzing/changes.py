"""Changes of sound files: of bytes and lines, and of nested tables by what the schema knows."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from random import Random
from typing import Any, get_args

from drystone.io.modelfile.declared import sections_in
from drystone.io.modelfile.keys import Section
from drystone.io.modelfile.schema import ModelSection

from . import sound

Place = tuple[str | int, ...]

#: In place of any value of a table.
ODD = (
    *(0, -1, 1, 2, 3, 5, 0.1, 1e-300, 1e-12, -1e-9, 1e-6, 1e3, 10_000, 10**9, 1e6, 1e9, 1e15, 1e30),
    *(1e200, 1e308, 10**18, 10**400, float("nan"), float("inf"), -float("inf"), -0.0, True, False),
    *("", "0.1", "nan", "1,5", "$a_$", "\x1b[31m", "a\0b", "../x", "x" * 300, "*" * 40, "b*?" * 60),
    *("=1+1", "<b>", "\u202e", "é" * 50, "1" * 5000, None),
    *([], [1.0], [[0, 0]], [[0.0, 0.0, 0.0]] * 4, [1e308, -1e308], {}, {"a": 1}, [{}], [[[[1]]]]),
)
#: Factors of a number: units mistaken, and values at the rim.
FACTORS = (-1.0, 0.0, 1e-9, 1e-6, 1e-3, 1e-2, 0.5, 1.0 + 1e-9, 2.0, 10.0, 1e2, 1e3, 1e6, 1e9)
#: In place of a number of a text.
NUMBERS = (
    *(
        "0",
        "-1",
        "1",
        "2",
        "nan",
        "inf",
        "-inf",
        "1e308",
        "-1e30",
        "1e-300",
        "999999999",
        "",
        "abc",
    ),
    *("1,5", "\0", "4294967295", "-2147483648", "1000000000000", "1" * 400, "0x10", "1e9", "1_000"),
)
#: Anywhere in a file of bytes.
PIECES = (
    *(b"\0", b"\xff", b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\x7f\xf0\0\0\0\0\0\0", b"\r", b"\n\n"),
    *(
        b'"',
        b"'",
        b"[",
        b"]" * 50,
        b"[" * 200,
        b"{" * 200,
        b"[[" * 2000,
        b"#",
        b"=",
        b"\\",
        b"\x1b[",
    ),
    *(b"\xef\xbb\xbf", b"\xed\xa0\x80", b"(" * 3000, b"a." * 3000, b"0" * 5000, b"\x1a", b"\x80"),
)


# --- bytes ------------------------------------------------------------------------------------


def changed_bytes(contents: bytes, draw: Random) -> bytes:
    """One to four changes."""
    for _ in range(draw.choice((1, 1, 1, 2, 3, 4))):
        contents = draw.choice(_OF_BYTES)(contents, draw)
    return contents


def _bit(data: bytes, draw: Random) -> bytes:
    k = draw.randrange(len(data) or 1)
    return data[:k] + bytes([(data[k] if data else 0) ^ (1 << draw.randrange(8))]) + data[k + 1 :]


def _piece(data: bytes, draw: Random) -> bytes:
    k = draw.randrange(len(data) + 1)
    return data[:k] + draw.choice(PIECES) + data[k + draw.choice((0, 0, 1, 4)) :]


def _torn(data: bytes, draw: Random) -> bytes:
    return data[: draw.randrange(len(data) + 1)]


def _piece_out(data: bytes, draw: Random) -> bytes:
    k = draw.randrange(len(data) + 1)
    return data[:k] + data[k + draw.randrange(1, 200) :]


def _piece_again(data: bytes, draw: Random) -> bytes:
    k, n = draw.randrange(len(data) + 1), draw.randrange(1, 200)
    return data[: k + n] + data[k : k + n] * draw.choice((1, 1, 2, 50)) + data[k + n :]


def _number(data: bytes, draw: Random) -> bytes:
    """A number becomes another one, or something odd."""
    places = list(re.finditer(rb"-?\d+(\.\d*)?([eE][-+]?\d+)?", data))
    if not places:
        return _bit(data, draw)
    place = draw.choice(places)
    text = place[0].decode()
    value = float(text)
    new = draw.choice((*NUMBERS, text + "7", repr(1.001 * value), repr(-value), repr(1e3 * value)))
    return data[: place.start()] + new.encode() + data[place.end() :]


def _lines(change: Callable[[list[bytes], Random], None]) -> Callable[[bytes, Random], bytes]:
    def changed(data: bytes, draw: Random) -> bytes:
        lines = data.split(b"\n")
        change(lines, draw)
        return b"\n".join(lines)

    return changed


def _line_out(lines: list[bytes], draw: Random) -> None:
    del lines[draw.randrange(len(lines))]


def _line_twice(lines: list[bytes], draw: Random) -> None:
    k = draw.randrange(len(lines))
    lines[k:k] = [lines[k]] * draw.choice((1, 1, 2, 300))


def _lines_swapped(lines: list[bytes], draw: Random) -> None:
    i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]


def _line_longer(lines: list[bytes], draw: Random) -> None:
    k = draw.randrange(len(lines))
    words = lines[k].split(b" ")
    lines[k] = b" ".join(words + [draw.choice(words)] * draw.choice((1, 5, 2000)))


_OF_BYTES = (
    *(_bit, _piece, _torn, _piece_out, _piece_again, _number, _number, _number, _number),
    *map(_lines, (_line_out, _line_twice, _lines_swapped, _line_longer)),
)


# --- tables -----------------------------------------------------------------------------------


def changed_tables(data: Any, draw: Random) -> Any:
    """Nested tables with one to four changes."""
    data = copy.deepcopy(data)
    # Of most that are broken nothing is left to run: of a good part numbers alone are others.
    kinds = _OF_TABLES if draw.random() < 0.6 else _MILD
    for _ in range(draw.choice((1, 1, 2, 3, 4))):
        draw.choice(kinds)(data, draw)
    return data


def places(data: Any, place: Place = ()) -> Iterator[Place]:
    """Of everything in nested tables and lists."""
    pairs = data.items() if isinstance(data, dict) else enumerate(data)
    for key, value in pairs:
        yield (*place, key)
        if isinstance(value, dict | list):
            yield from places(value, (*place, key))


def _at(data: Any, place: Place) -> Any:
    for key in place:
        data = data[key]
    return data


def _any(
    data: Any, draw: Random, fits: Callable[[Any], bool] = lambda _: True
) -> tuple[Any, Any] | None:
    """What holds a value that fits, and its key; shallow ones as often as the many coordinates."""
    found: dict[int, list[Place]] = {}
    for place in places(data):
        if fits(_at(data, place)):
            found.setdefault(len(place), []).append(place)
    if not found:
        return None
    place = draw.choice(found[draw.choice(sorted(found))])
    return _at(data, place[:-1]), place[-1]


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) < 1e300


def _odd_value(data: Any, draw: Random) -> None:
    if found := _any(data, draw, lambda value: not isinstance(value, dict)):
        holder, key = found
        holder[key] = copy.deepcopy(draw.choice(ODD))


def _other_number(data: Any, draw: Random) -> None:
    if found := _any(data, draw, _is_number):
        holder, key = found
        value = float(holder[key]) * draw.choice(FACTORS)
        keeps = isinstance(holder[key], int) and abs(value) < 1e15 and draw.random() < 0.8
        holder[key] = int(value) if keeps else value


def _nudged(data: Any, draw: Random) -> None:
    """A number by as little as rounding, or by as much as the block."""
    if found := _any(data, draw, lambda value: type(value) is float and abs(value) < 1e300):
        holder, key = found
        holder[key] += draw.choice((-1, 1)) * 10.0 ** draw.uniform(-16, 0)


def _key_out(data: Any, draw: Random) -> None:
    if found := _any(data, draw):
        holder, key = found
        del holder[key]


def _key_renamed(data: Any, draw: Random) -> None:
    found = _any(data, draw)
    if found and isinstance(found[0], dict):
        holder, key = found
        holder[draw.choice((key + "x", key.upper(), "", "a.b", "__class__"))] = holder.pop(key)


def _entry_twice(data: Any, draw: Random) -> None:
    if found := _any(data, draw, lambda value: isinstance(value, list) and len(value) > 0):
        holder, key = found
        entries = holder[key]
        k = draw.randrange(len(entries))
        entries[k:k] = copy.deepcopy([entries[k]]) * draw.choice((1, 1, 1, 3, 40))


def _shuffled(data: Any, draw: Random) -> None:
    if found := _any(data, draw, lambda value: isinstance(value, list) and len(value) > 1):
        draw.shuffle(found[0][found[1]])


def _nested(data: Any, draw: Random) -> None:
    """A value inside of many lists or tables."""
    if found := _any(data, draw):
        holder, key = found
        value = holder[key]
        for _ in range(draw.choice((1, 2, 30, 60, 150))):
            value = [value] if draw.random() < 0.5 else {"a": value}
        holder[key] = value


def _key_of_schema(data: Any, draw: Random) -> None:
    """A key that the schema has, with a value that it has elsewhere, or an odd one."""
    tables = [(path, table) for path, table in _tables(data) if path in _schema()]
    if not tables:
        return
    path, table = draw.choice(tables)
    key = draw.choice(_schema()[path])
    known = _known().get(key)
    value = draw.choice(known) if known and draw.random() < 0.75 else draw.choice(ODD)
    table[key] = copy.deepcopy(value)


def _swapped(data: Any, draw: Random) -> None:
    """Two values change places."""
    one, other = _any(data, draw), _any(data, draw)
    if one and other:
        first, second = one[0][one[1]], other[0][other[1]]
        # Neither may come to lie in itself.
        one[0][one[1]], other[0][other[1]] = copy.deepcopy(second), copy.deepcopy(first)


_OF_TABLES = (
    *(_odd_value, _odd_value, _other_number, _other_number, _nudged, _key_out, _key_renamed),
    *(_entry_twice, _shuffled, _nested, _key_of_schema, _key_of_schema, _key_of_schema, _swapped),
)
_MILD = (_other_number, _other_number, _nudged, _nudged, _shuffled, _key_of_schema)


def _tables(data: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Tables with the keys that lead to them, places in lists left out."""
    if isinstance(data, dict):
        yield path, data
        for key, value in data.items():
            yield from _tables(value, (*path, str(key)))
    elif isinstance(data, list):
        for value in data:
            yield from _tables(value, path)


@cache
def _schema() -> dict[tuple[str, ...], tuple[str, ...]]:
    """Keys of every table of a model file, by the keys that lead to it."""
    found: dict[tuple[str, ...], tuple[str, ...]] = {}

    def walk(section: type[Section], path: tuple[str, ...]) -> None:
        for one in sections_in(section):
            keys = one.keys()
            found[path] = tuple(dict.fromkeys((*found.get(path, ()), *keys)))
            for key, field in keys.items():
                for inner in _sections(field.annotation):
                    walk(inner, (*path, key))

    walk(ModelSection, ())
    return found


def _sections(annotation: Any) -> Iterator[type[Section]]:
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation
    for inner in get_args(annotation):
        yield from _sections(inner)


@cache
def _known() -> dict[str, list[Any]]:
    """Values that sound models have, by their keys."""
    found: dict[str, list[Any]] = {}
    for data in sound.models():
        for _, table in _tables(data):
            for key, value in table.items():
                if value not in found.setdefault(key, []):
                    found[key].append(value)
    return found


def changed_json(contents: bytes, draw: Random) -> bytes:
    """Valid JSON with values changed."""
    return json.dumps(changed_tables(json.loads(contents), draw)).encode("utf-8", "replace")
