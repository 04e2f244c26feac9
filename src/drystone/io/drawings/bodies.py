"""LMGC90's BODIES.DAT: rigid bodies with polygons (POLYG) or polyhedra (POLYR).

The file has no units of its own; those of LMGC90's gravity, metres, are taken.  Vertices are given
from the body's node, of solids along their axes of inertia; where these point, and where bodies
stand, is in DOF.INI beside it.  What is held of which bodies is in DRV_DOF.DAT.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from drystone.io.drawings.drawing import (
    MOST,
    Drawing,
    Shape,
    check_counts,
    number,
    text_of,
    tidy_name,
    whole,
)
from drystone.io.drawings.format import Format
from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError

#: File in which held bodies are named, beside that of the bodies.
DRIVEN = "DRV_DOF.DAT"
#: File in which places and axes of bodies are, likewise.
STATE = "DOF.INI"
_STATE = re.compile(r"([Xabg])\((\d)\)\s*=\s*([-+.\dEeDd]+)")
#: By how much axes may be off a right-handed frame: files have eight digits.
SQUARE = 1e-5
#: Names of what rollers hold, by the numbers of components; those of space turn about three axes.
_MOTIONS = {
    "RBDY2": {1: "x", 2: "y", 3: "turn"},
    "RBDY3": {1: "x", 2: "y", 3: "z", 4: "turn", 5: "turn", 6: "turn"},
}
_FIGURE = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?")
_VALUE = re.compile(r"([A-Za-z_]+\d?)\s*=\s*([-+.\dEeDdNnIiAaFf]+)")


def read(contents: bytes, beside: Path | None = None) -> Drawing:
    """The blocks of a file; raises `ModelError`.

    Parameters
    ----------
    beside
        Path of the file, where DRV_DOF.DAT may tell the supports and rollers.
    """
    text = text_of(contents)
    check_counts(text.count("coo1"), text.count("ver1"))
    held, states = _held(beside), _states(beside)
    shapes: list[Shape] = []
    left_out: set[str] = set()
    unturned = False
    for start, lines in _bodies(text):
        kind, index = _body_name(lines[0], start)
        state = states.get((kind, index))
        made = _shapes(lines, start, kind, index, state or {}, left_out)
        unturned |= state is None and _has_inertia(lines)
        own = held.get((kind, index), ())
        support = set(own) == set(_MOTIONS[kind].values())
        for k, (vertices, faces, color) in enumerate(made, 1):
            name = f"{kind.lower()}{index}" + (f"/{k}" if len(made) > 1 else "")
            shapes.append(
                Shape(
                    name=name,
                    vertices=vertices,
                    faces=faces,
                    layer=_behaviour(lines),
                    groups=(color,) if color else (),
                    support=support,
                    held=() if support else own,
                )
            )
    if not shapes:
        raise ModelError(["holds no polygons (POLYG) or polyhedra (POLYR) of rigid bodies"])
    widths = {shape.vertices.shape[1] for shape in shapes}
    if len(widths) > 1:
        raise ModelError(["holds bodies of the plane and of space: give them in two files"])
    notes = tuple(
        f"contactors {what} were left out: only POLYG and POLYR are blocks"
        for what in sorted(left_out)
    )
    if unturned:
        notes += (
            f"there is no {STATE} beside it that says how bodies are turned: their axes are taken "
            "for those of the world",
        )
    return Drawing(shapes=tuple(shapes), unit="m", up="z" if widths == {3} else "", notes=notes)


def _bodies(text: str) -> Iterator[tuple[int, list[str]]]:
    """Lines of each body, and where they begin; a body ends with dollar signs."""
    lines: list[str] = []
    start = 0
    for row, line in enumerate(text.splitlines(), 1):
        if line.strip().lower().startswith(("$bdyty", "$bodies")):
            lines, start = [], row + 1
        elif line.strip().startswith("$$$") and lines:
            yield start, lines
            lines = []
        elif start and line.strip() and not line.lstrip().startswith("!"):
            lines.append(line)
    if lines:
        raise ModelError([f"line {start}: the body that begins here has no end: the file is torn"])


def _body_name(line: str, row: int) -> tuple[str, int]:
    words = line.split()
    if len(words) < 2 or words[0] not in ("RBDY2", "RBDY3", "MAILx"):
        raise ModelError([f"line {row}: there should be RBDY2 or RBDY3 and a number"])
    if words[0] == "MAILx":
        raise ModelError([f"line {row}: meshed bodies (MAILx) are no blocks: export rigid ones"])
    return words[0], whole(words[1], f"line {row}")


def _behaviour(lines: list[str]) -> str:
    for line in lines:
        found = re.search(r"\bbehav\s+(\S+)", line)
        if found:
            return tidy_name(found[1])
    return ""


_Made = tuple[np.ndarray, tuple[tuple[int, ...], ...], str]


def _has_inertia(lines: list[str]) -> bool:
    """Whether a body's moments of inertia are given: its vertices are along its axes of inertia."""
    values = [dict(_VALUE.findall(line)).get("I1", "0") for line in lines]
    return any(value.strip("+-.0EeDd") for value in values)


def _shapes(
    lines: list[str],
    start: int,
    kind: str,
    index: int,
    state: dict[str, float],
    left_out: set[str],
) -> list[_Made]:
    """Vertices, faces and color of each contactor of a body."""
    place = f"body {kind} {index} (line {start})"
    section = ""
    node: dict[str, float] = {}
    contactors: list[tuple[str, list[tuple[str, str]]]] = []
    for line in lines[1:]:
        text = line.strip()
        if text.startswith("$"):
            section = text[1:6].lower()
        elif section == "nodty":
            node |= {key: number(value, place) for key, value in _VALUE.findall(line)}
        elif section == "tacty":
            words = text.split()
            if re.match(r"[A-Z]{4}[A-Zx]\b", text):
                contactors.append((words[0], []))
                color = re.search(r"\bcolor\s+(\S+)", line)
                contactors[-1][1].append(("color", color[1] if color else ""))
            if contactors:
                contactors[-1][1].extend(_VALUE.findall(line))
    found = []
    for contactor, values in contactors:
        if contactor not in ("POLYG", "POLYR"):
            left_out.add(contactor)
            continue
        found.append(_placed(contactor, values, node, state, place))
    return found


def _placed(
    contactor: str,
    values: list[tuple[str, str]],
    node: dict[str, float],
    state: dict[str, float],
    place: str,
) -> _Made:
    """A contactor where its body is."""
    width = 2 if contactor == "POLYG" else 3
    # The third coordinate goes by another name in some files.
    values = [("coo3" if key == "coor" else key, value) for key, value in values]
    named = dict(values)
    axes = [[number(v, place) for k, v in values if k == f"coo{n}"] for n in range(1, width + 1)]
    count = whole(named.get("nb_vertex", str(len(axes[0]))), place)
    if count > MOST or any(len(axis) != count for axis in axes):
        raise ModelError([f"{place}: says {count} vertices and has not as many: the file is torn"])
    vertices = np.array(axes).T.reshape(-1, width)
    rows = [[whole(v, place) for k, v in values if k == f"ver{n}"] for n in (1, 2, 3)]
    if len({len(row) for row in rows}) > 1:
        raise ModelError([f"{place}: a face needs three vertices: the file is torn"])
    faces = tuple(zip(*((i - 1 for i in row) for row in rows), strict=True))
    if any(not 0 <= i < count for face in faces for i in face):
        raise ModelError([f"{place}: a face names a vertex that is not there: the file is torn"])
    origin = np.array(
        [node.get(f"coo{n}", 0.0) + state.get(f"X{n}", 0.0) for n in range(1, width + 1)]
    )
    if width == 2:
        angle = node.get("coo3", 0.0) + state.get("X3", 0.0)
        c, s = np.cos(angle), np.sin(angle)
        vertices = vertices @ np.array([[c, s], [-s, c]])
    elif any(node.get(f"coo{n}") for n in (4, 5, 6)):
        raise ModelError([f"{place}: is turned (coo4 to coo6): give bodies as they were designed"])
    elif "a1" in state:
        frame = np.array([[state.get(f"{key}{n}", 0.0) for n in (1, 2, 3)] for key in "abg"])
        if np.abs(frame @ frame.T - np.eye(3)).max() > SQUARE or np.linalg.det(frame) < 0.0:
            raise ModelError([f"{place}: its axes in {STATE} are no right-handed frame"])
        vertices = vertices @ frame
    return vertices + origin, faces, tidy_name(named.get("color", ""))


def _states(beside: Path | None) -> dict[tuple[str, int], dict[str, float]]:
    """Displacements and axes of bodies from DOF.INI: of (kind, number), "X1", ..., "a1", ..."""
    path = beside.with_name(STATE) if beside else None
    if path is None or not path.is_file():
        return {}
    found: dict[tuple[str, int], dict[str, float]] = {}
    own: dict[str, float] = {}
    for row, line in enumerate(_lines(path), 1):
        words = line.split()
        if len(words) >= 2 and words[0] in ("RBDY2", "RBDY3") and words[1].isdigit():
            own = found.setdefault((words[0], int(words[1])), {})
        for key, n, value in _STATE.findall(line):
            # Of several times the first one is that of the design.
            own.setdefault(key + n, number(value, f"{STATE} line {row}"))
    return found


def _lines(path: Path) -> list[str]:
    """Of a file beside the drawing."""
    return text_of(read_bytes(path, "the file")).splitlines()


def _held(beside: Path | None) -> dict[tuple[str, int], tuple[str, ...]]:
    """What of their motion is held of bodies (kind, number), from DRV_DOF.DAT."""
    path = beside.with_name(DRIVEN) if beside else None
    if path is None or not path.is_file():
        return {}
    held: dict[tuple[str, int], set[int]] = {}
    own: set[int] = set()
    for row, line in enumerate(_lines(path), 1):
        words = line.split()
        place = f"{DRIVEN} line {row}"
        if len(words) >= 2 and words[0] in _MOTIONS and words[1].isdigit():
            own = held.setdefault((words[0], int(words[1])), set())
        elif words[:1] == ["vlocy"] and len(words) > 1:
            own.add(whole(words[1], place))
            # Its velocity is (CT + AMP cos(OMEGA t + PHI)) times a ramp, or in a file of its own.
            values = _FIGURE.findall(" ".join(words[2:]))
            if not values or any(number(value, place) for value in values[:2]):
                raise ModelError(
                    [f"{place}: a body is driven at a speed: hold it there with zeros"]
                )
    return {body: _motions(*body, components) for body, components in held.items()}


def _motions(kind: str, index: int, components: set[int]) -> tuple[str, ...]:
    """What rollers call components of a body's motion, numbered from 1."""
    known = _MOTIONS[kind]
    names = tuple(dict.fromkeys(known[n] for n in sorted(components & set(known))))
    if "turn" in names and not {n for n, name in known.items() if name == "turn"} <= components:
        raise ModelError(
            [f"{DRIVEN}: {kind} {index} may turn about some axes alone: hold all or none of these"]
        )
    return names


FORMAT = Format(
    name="bodies",
    endings=(".dat",),
    read=lambda data, path, _: read(data, path),
    beside=(DRIVEN, STATE),
)
