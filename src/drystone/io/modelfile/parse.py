"""The bytes of a model file as nested dicts and lists, or a sentence on why not."""

from __future__ import annotations

import json
import re
import tomllib
from collections import Counter
from typing import Any

from drystone.common.ranges import too_many
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted

NESTED = "is nested too deeply to be a model: check its brackets"
#: Tables and lists inside each other that no model has.
DEEPEST = 32

#: Text and comments of TOML, in which dots mean nothing.
_NO_KEYS = re.compile(
    r'''"""(?:[^"\\]|\\.|"(?!""))*+"""|'{3}(?:[^']|'(?!''))*+'{3}'''
    r"""|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|\#[^\n]*+""",
    re.DOTALL,
)
#: A key of too many parts: tables inside each other, for each of which the parser takes memory.
_LONG_KEY = re.compile(rf"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+){{{DEEPEST}}}")
#: A number with a decimal comma, as the value of a key.
_COMMA = re.compile(r"""^\s*[\w."'-]+\s*[=:]\s*([-+]?\d+),(\d+)""")

#: A decimal point, and the digits before and after it.
_POINT = re.compile(r"(?<![\w.])(\d*+)\.(\d*+)(?!\.)")


def parse(contents: bytes, *, is_json: bool) -> dict[str, Any]:
    """TOML or JSON, told apart by ``is_json`` or by the opening brace that no TOML file has."""
    try:
        text = contents.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError(
            [f"is not text (byte {error.start + 1} is not UTF-8): give a TOML or JSON file"]
        ) from None
    if wrong := too_many("values", sum(contents.count(mark) for mark in (b",", b"[", b"{", b"="))):
        raise ModelError([wrong])
    if not text.strip():
        raise ModelError(["is empty: write a model into it, the examples show how"])
    try:
        if is_json or text.lstrip().startswith("{"):
            data = _json(text)
        elif _LONG_KEY.search(_NO_KEYS.sub("text", text)):
            raise ModelError(["has a key of too many parts: no key has more than three"])
        else:
            data = tomllib.loads(text)
    except json.JSONDecodeError as error:
        hint = _of_number(_line(text, error.lineno), error.colno)
        raise ModelError(
            [f"line {error.lineno}, column {error.colno}: not valid JSON: {error.msg}{hint}"]
        ) from None
    except tomllib.TOMLDecodeError as error:
        raise ModelError([_torn_toml(str(error), text)]) from None
    except RecursionError:
        raise ModelError([NESTED]) from None
    except ValueError:  # Python declines to read whole numbers of more than 4300 digits
        raise ModelError(["holds a whole number of thousands of digits: shorten it"]) from None
    _check_nesting(data)
    if not isinstance(data, dict):
        raise ModelError(['must hold a table of keys, as { "dimension": 2, ... }'])
    return data


def _json(text: str) -> Any:
    def table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        keys = dict(pairs)
        if len(keys) < len(pairs):
            twice, _ = Counter(name for name, _ in pairs).most_common(1)[0]
            raise ModelError([f"key {quoted(twice)} is given twice in one table: take one out"])
        return keys

    data = json.loads(text, object_pairs_hook=table)
    if re.search(r"\\u[dD][89a-fA-F]", text):  # half a character could not even be printed
        try:
            json.dumps(data, ensure_ascii=False).encode()
        except UnicodeEncodeError:
            raise ModelError(["holds half a character, as \\ud800 without its mate"]) from None
    return data


def _check_nesting(data: Any) -> None:
    """Raise `ModelError` for tables deeper or wider than any of a model; without recursion."""
    level = [data]
    for _ in range(DEEPEST + 1):
        holders = [item for item in level if isinstance(item, dict | list)]
        if not holders:
            return
        most = max((len(item) for item in holders if isinstance(item, dict)), default=0)
        if wrong := too_many("keys", most):
            raise ModelError([f"a table {wrong}"])
        level = [
            item
            for holder in holders
            for item in (holder.values() if isinstance(holder, dict) else holder)
        ]
    raise ModelError([NESTED])


def _torn_toml(message: str, text: str) -> str:
    """The parser's message with its place in front."""
    match = re.fullmatch(r"(.*) \(at (line \d+, column \d+|end of document)\)", message, re.DOTALL)
    if not match:
        return f"not valid TOML: {message}"
    what, where = match.groups()
    hint = ""
    if where[:4] == "line":
        line, column = (int(word) for word in re.findall(r"\d+", where))
        hint = _of_number(_line(text, line), column)
    if where == "end of document":
        lines = text.rstrip("\n").split("\n")
        where = f"line {len(lines)}, column {len(lines[-1]) + 1} (end of the file)"
    return f"{where}: not valid TOML: {what}{hint}".replace("\n", " ")


def _line(text: str, number: int) -> str:
    """A line of a text, counted from 1; nothing beyond its end."""
    return "".join(text.split("\n")[number - 1 : number])


def _of_number(line: str, column: int) -> str:
    """End of a sentence where a line has a number as TOML does not write it, else nothing."""
    found = _COMMA.search(line)
    if found:
        whole, decimals = found.groups()
        return f": write decimals with a point, as in {whole}.{decimals}"
    for number in _POINT.finditer(line):
        whole, decimals = number.groups()
        if number.start() <= column <= number.end() + 1 and bool(whole) != bool(decimals):
            return f": write digits before and after the point, as in {whole or 0}.{decimals or 0}"
    return ""
