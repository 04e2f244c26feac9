"""Directives for the reference pages, which the program itself fills in.

``{model-keys}`` writes a table for each section of a model file from the classes that check it;
``{commands}`` writes usage, arguments and options of every command from its parameters.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from enum import Enum
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from docutils import nodes
from pydantic import PlainValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from typer.models import ArgumentInfo

from drystone.cli import app
from drystone.common.ranges import Range
from drystone.io.modelfile.declared import Chosen, sections_in
from drystone.io.modelfile.keys import Section
from drystone.io.modelfile.schema import ModelSection

WORDS = {float: "number", int: "whole number", str: "text", bool: "`true` or `false`"}
#: Types whose check has no range: what they are, by the name of the check.
CHECKED = {"point_of": "a point", "point_or_name": "a point", "rotation_of": "one angle or three"}


# ---- keys of model files ----------------------------------------------------------------------


def parts_of(annotation: Any, metadata: Iterable[Any] = ()) -> tuple[Any, list[Any]]:
    """A type without what stands beside it, and that; ``None`` beside a type is left out."""
    metadata = list(metadata)
    while True:
        if hasattr(annotation, "__metadata__"):
            metadata += annotation.__metadata__
            annotation = annotation.__origin__
            continue
        if get_origin(annotation) in (Union, UnionType):
            left = [part for part in get_args(annotation) if part is not NoneType]
            if len(left) == 1:
                annotation = left[0]
                continue
        return annotation, metadata


def range_of(metadata: Iterable[Any]) -> Range | None:
    """The range that a check was made with."""
    for entry in metadata:
        if isinstance(entry, PlainValidator):
            found = inspect.getclosurevars(entry.func).nonlocals.get("range_")
            if found is not None:
                return found
    return None


def said(range_: Range) -> str:
    """A range as a person writes it."""
    least, most = range_.least, range_.most
    if 0.0 < least < 1e-5 and most >= 1e5:
        text = "above 0"
    elif least <= -1e6 or most >= 1e5:
        text = "any" if least < 0 else "0 or more" if least == 0 else f"at least {least:g}"
    else:
        text = f"{least:g} to {most:g}"
    unit = f" [{range_.unit}]" if range_.unit else ""
    return f"{text}{unit}".replace("m3", "m³").replace("m2", "m²")


def within(metadata: Iterable[Any]) -> str:
    """The bounds that stand beside a type, as a person writes them."""
    entries = [own for m in metadata for own in (m.metadata if isinstance(m, FieldInfo) else [m])]
    words = {"gt": "above", "ge": "at least", "lt": "less than", "le": "at most"}
    bounds = {
        name: value
        for entry in entries
        for name in words
        if (value := getattr(entry, name, None)) is not None
    }
    if bounds.get("le", 0.0) >= 1e5:
        del bounds["le"]  # what nobody reaches
    if bounds.keys() == {"ge", "le"}:
        return f"{bounds['ge']:g} to {bounds['le']:g}"
    return ", ".join(f"{words[name]} {value:g}" for name, value in bounds.items())


def type_of(annotation: Any, metadata: Iterable[Any] = ()) -> tuple[str, str]:
    """What a key takes, and which values."""
    annotation, metadata = parts_of(annotation, metadata)
    for entry in metadata:
        if isinstance(entry, PlainValidator) and entry.func.__name__ in CHECKED:
            return CHECKED[entry.func.__name__], ""
    found = range_of(metadata)
    if found is not None:
        return "number", said(found)
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return "one of", ", ".join(f"`{value!r}`".replace("'", '"') for value in inside)
    if origin is list:
        kind, values = type_of(inside[0])
        return ("list of tables" if kind == "table" else f"list of: {kind}"), values
    if origin is dict:
        kind, values = type_of(inside[1])
        return ("tables by name" if kind == "table" else f"by name: {kind}"), values
    if inspect.isclass(annotation) and issubclass(annotation, Section):
        return "table", ""
    if annotation in (float, int):
        return WORDS[annotation], within(metadata)
    return WORDS.get(annotation, "value"), ""


def default_of(field: FieldInfo) -> str:
    if field.default is PydanticUndefined and field.default_factory is None:
        return "required"
    default = field.default
    if default is None or default is PydanticUndefined or isinstance(default, Section):
        return ""
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    if default in ([], {}, ()):
        return ""
    return f"`{default!r}`".replace("'", '"')


def inner(annotation: Any) -> Iterator[type[Section]]:
    """Sections that a type is made of."""
    if inspect.isclass(annotation) and issubclass(annotation, Section):
        yield annotation
    for part in get_args(annotation):
        yield from inner(part)


def heading(annotation: Any, path: str) -> str:
    annotation, _ = parts_of(annotation)
    if get_origin(annotation) is list:
        return f"`[[{path}]]`"
    if get_origin(annotation) is dict:
        return f"`[{path}.NAME]`"
    return f"`[{path}]`"


def table(section: type[Section], without: Iterable[str] = ()) -> list[str]:
    rows = ["| key | takes | values | default |", "|---|---|---|---|"]
    for key, field in section.keys().items():
        if key not in without:
            kind, values = type_of(field.annotation, field.metadata)
            rows.append(f"| `{key}` | {kind} | {values} | {default_of(field)} |")
    return [*rows, ""] if len(rows) > 2 else ["No keys of its own.", ""]


def named(section: type[Section]) -> Iterator[tuple[str, type[Section]]]:
    """Sections whose keys a section has: one for each name of its chooser, if it has one."""
    if issubclass(section, Chosen) and not section.extended:
        yield from section.variants().items()
    else:
        yield from (("", one) for one in sections_in(section))


def keys_page() -> str:
    """Markdown with a table for every section of a model file."""
    lines: list[str] = []

    def write(section: type[Section], title: str, path: str) -> None:
        own = [one for one in sections_in(section)]
        lines.extend(["", f"## {title}", ""])
        if issubclass(section, Chosen) and not section.extended:
            common = set(section.keys())
            lines.extend(table(section))
            for name, one in section.variants().items():
                if set(one.keys()) - common:
                    lines.extend(["", f'### {section.chooser} = `"{name}"`', ""])
                    lines.extend(table(one, without=common))
        else:
            lines.extend(table(own[0]))
        seen: set[tuple[str, ...]] = set()
        for name, one in named(section):
            for key, field in one.keys().items():
                for found in inner(field.annotation):
                    same = (key, *found.keys())
                    if found is section or same in seen:
                        continue
                    below = f"{path}.{key}" if path else key
                    title = heading(field.annotation, below)
                    if any(other[0] == key for other in seen):  # of another kind
                        title += f' of {section.chooser} = `"{name}"`'
                    seen.add(same)
                    by_name = title.startswith(f"`[{below}.NAME]")
                    write(found, title, f"{below}.NAME" if by_name else below)

    write(ModelSection, "Top level", "")
    return "\n".join(lines)


# ---- commands ---------------------------------------------------------------------------------


def parameters_of(command: Any) -> Iterator[tuple[str, Any, Any]]:
    """Name, type and typer's record of every parameter of a command."""
    for name, hint in get_type_hints(command, include_extras=True).items():
        if hasattr(hint, "__metadata__"):
            annotation, metadata = parts_of(hint)
            yield name, annotation, metadata[-1]


def option(name: str, annotation: Any, info: Any) -> str:
    """An option as it is typed."""
    flag = annotation is bool
    # What stands first in the record is a name, too, where it looks like one.
    names = [n for n in (info.default, *(info.param_decls or ())) if str(n).startswith("-")]
    names = names or [f"--{name}".replace("_", "-")]
    if get_origin(annotation) is list:
        annotation = get_args(annotation)[0]
    value = info.metavar or ""
    if not value and inspect.isclass(annotation) and issubclass(annotation, Enum):
        value = " or ".join(f"`{choice.value}`" for choice in annotation)
    elif not value and not flag:
        value = "PATH" if annotation is Path else name.upper()
    shown = ", ".join(f"`{word}`" for word in names)
    return (shown if flag else f"{shown} {value}").replace("|", "\\|")


def commands_page() -> str:
    """Markdown with usage, arguments and options of every command."""
    lines: list[str] = []
    for registered in app.registered_commands:
        command = registered.callback
        assert command is not None
        found = list(parameters_of(command))
        arguments = [(n, i) for n, _, i in found if isinstance(i, ArgumentInfo)]
        usage = " ".join(info.metavar or name.upper() for name, info in arguments)
        name = registered.name or command.__name__
        lines += ["", f"## drystone {name}", "", f"    drystone {name} {usage} [OPTIONS]", ""]
        lines += [inspect.getdoc(command) or "", ""]
        lines += ["| argument or option | meaning |", "|---|---|"]
        for own, annotation, info in found:
            text = " ".join((info.help or "").split()).replace("|", "\\|")
            if isinstance(info, ArgumentInfo):
                named = (info.metavar or own.upper()).replace("|", "\\|")
                lines.append(f"| {named} | {text} |")
            else:
                lines.append(f"| {option(own, annotation, info)} | {text} |")
        lines.append("")
    return "\n".join(lines)


class ModelKeys(SphinxDirective):
    """``{model-keys}``: every section of a model file with its keys."""

    def run(self) -> list[nodes.Node]:
        return self.parse_text_to_nodes(keys_page(), allow_section_headings=True)


class Commands(SphinxDirective):
    """``{commands}``: every command with its arguments and options."""

    def run(self) -> list[nodes.Node]:
        return self.parse_text_to_nodes(commands_page(), allow_section_headings=True)


def plain_bars(
    app_: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    """Docstrings write |x| for a length, which reStructuredText takes for a substitution."""
    lines[:] = [line.replace("|", "\\|") for line in lines]


def setup(sphinx: Sphinx) -> dict[str, Any]:
    sphinx.add_directive("model-keys", ModelKeys)
    sphinx.add_directive("commands", Commands)
    sphinx.connect("autodoc-process-docstring", plain_bars)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
