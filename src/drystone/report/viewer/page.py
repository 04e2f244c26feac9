"""One page of everything: markup, style, modules and the results, nothing from outside.

The modules stay as they are written, with imports and exports, for their own tests.  Here they are
joined: each becomes a function that returns what it exports.  Only the few forms of import and
export that they use are known; others are an error, not a page that does not work.
"""

from __future__ import annotations

import html
import json
import re
from functools import cache
from importlib import resources
from pathlib import Path

from drystone.common.names import number_of
from drystone.io.results.folder import whole_file
from drystone.io.results.summary import plain
from drystone.report.viewer.contents import Contents

#: In the order of what they import.
MODULES = (
    "rotation.js",
    "codec.js",
    "format.js",
    "data.js",
    "colours.js",
    "section.js",
    "camera.js",
    "picking.js",
    "ribbons.js",
    "overlays.js",
    "painting.js",
    "curve.js",
    "timeline.js",
    "keyboard.js",
    "gestures.js",
    "panel.js",
    "raster.js",
    "flat.js",
    "gl.js",
    "scene.js",
    "main.js",
)

_IMPORT = re.compile(r"^import \{(?P<names>[^}]*)\} from \"\./(?P<file>[\w.]+)\";.*$", re.M)
_EXPORT = re.compile(r"^export (?P<kind>async function|function|class|const) (?P<name>\w+)", re.M)


def page(contents: Contents) -> str:
    """The whole page as text."""
    header = contents.header
    dimension = int(header["dimension"])
    values = {
        "version": html.escape(str(header["version"])),
        "title": html.escape(str(header["title"]) or "drystone"),
        "style": asset("viewer.css"),
        "dimension": str(dimension),
        "still": "" if header["curve"] else " still",
        "facts": html.escape(facts(header)),
        "about": html.escape(about(header)),
        "header": as_script(json.dumps(plain({**header, "streams": contents.pack.table}))),
        "streams": contents.pack.text(),
        "script": script(),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], asset("viewer.html"))


def write_page(contents: Contents, path: Path) -> None:
    """Write it, whole or not at all."""
    with whole_file(path) as draft:
        draft.write_text(page(contents), encoding="utf-8")


def facts(header: dict[str, object]) -> str:
    """What stands beside the title."""
    blocks = header["blocks"]
    assert isinstance(blocks, dict)
    supports = sum(bool(fixed) for fixed in blocks["support"])
    count = len(blocks["name"]) - supports
    words = [f"{number_of(count, 'block')}, {number_of(supports, 'support')}"]
    if header["curve"]:
        words.append(f"engine {header['engine']}")
    words.append(str(header["status"]))
    return " · ".join(words)


def about(header: dict[str, object]) -> str:
    """Where it comes from."""
    return (
        f"drystone {header['version']}, model {str(header['model_sha256'])[:12]}; "
        f"{header['reason']}"
    )


def as_script(text: str) -> str:
    """JSON that stands in a script element: nothing in it ends the element."""
    return text.replace("<", "\\u003c")


@cache
def asset(name: str) -> str:
    """A file of the viewer."""
    return (resources.files("drystone.report.viewer") / "assets" / name).read_text(encoding="utf-8")


@cache
def script() -> str:
    """All modules in one; raises `ValueError` for a form of import or export that is not known."""
    joined = "\n".join(_as_function(name, asset(name)) for name in MODULES)
    if "</script" in joined.lower():
        raise ValueError("a module of the viewer would end its script element")
    return joined


def _as_function(name: str, text: str) -> str:
    exported = [found["name"] for found in _EXPORT.finditer(text)]
    text = _EXPORT.sub(r"\g<kind> \g<name>", text)
    text = _IMPORT.sub(_destructured, text)
    if unknown := re.search(r"^(?:import|export)\b.*$", text, re.M):
        raise ValueError(f"{name}: {unknown[0]}")
    members = ", ".join(exported)
    return f"const {_variable(name)} = (() => {{\n{text}\nreturn {{ {members} }};\n}})();"


def _destructured(found: re.Match[str]) -> str:
    module = _variable(found["file"])
    names = re.sub(r"(\w+) as (\w+)", r"\1: \2", " ".join(found["names"].split()))
    return f"const {{ {names} }} = {module};"


def _variable(file: str) -> str:
    return "$" + file.split(".")[0]
