"""DXF by ezdxf: closed polylines as blocks of the plane; faces and meshes as blocks of space.

What lies on a layer is named after it.  Blocks that were written by `write` keep their names,
materials and groups in extended data of their entities.
"""

from __future__ import annotations

import io
import json
import logging
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import chain
from typing import Any

import numpy as np

from drystone.common.ranges import too_many
from drystone.common.tolerances import SAME_POINT
from drystone.io.drawings.drawing import (
    CONTROL_LAYERS,
    MOST,
    SUPPORT_LAYERS,
    Drawing,
    Shape,
    check_counts,
    check_faces,
    shapes_of_mesh,
    tidy_name,
)
from drystone.io.drawings.format import Format
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import printable, quoted

APPLICATION = "DRYSTONE"
MISSING = "DXF needs ezdxf, which is not installed: pip install drystone[dxf]"
#: Unit of the drawing by its number in the header ($INSUNITS).
_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
#: What files begin with: a group code on a line of its own, or the mark of binary ones.
_BEGINNING = re.compile(rb"(\xef\xbb\xbf)?\s*\d+[ \t]*[\r\n]|AutoCAD Binary DXF")
#: Largest distance of an arc from the chords that it is drawn with, over its radius.
ARC = 1e-3
#: Entities inside of each other's definitions that no drawing has.
DEEPEST = 8
#: What is said of an outline that the plane would show foreshortened.
TILTED = "does not lie in the plane of x and y"
#: What entities begin with that may be edges of a block.
LOOSE = ("open ", "LINE ", "ARC ")
#: Texts and the like say nothing of blocks.
_SILENT = {
    "TEXT", "MTEXT", "DIMENSION", "LEADER", "MULTILEADER", "HATCH", "VIEWPORT", "ATTDEF", "ATTRIB",
    "IMAGE", "XLINE", "RAY", "WIPEOUT", "TOLERANCE",
}  # fmt: skip


def read(contents: bytes, dimension: int | None = None) -> Drawing:
    """The blocks of a file; raises `ModelError`.

    Parameters
    ----------
    dimension
        2 or 3; where nothing is said 3 if there is any face or mesh.
    """
    document, guesses = _document(contents)
    outlines: list[Shape] = []
    meshes: list[Shape] = []
    loose: dict[str, list[np.ndarray]] = {}
    points: list[tuple[str, tuple[float, ...]]] = []
    others: dict[str, int] = {}
    n_vertices = 0
    hidden = _hidden(document)
    for entity, drawn_on in _entities(document.modelspace(), hidden):
        kind, layer = entity.dxftype(), tidy_name(drawn_on)
        how, unseen = hidden.get(drawn_on.lower()), _is_invisible(entity)
        if (how or unseen) and kind not in _SILENT:
            what = f"{'invisible ' * unseen}{kind} on layer {quoted(layer)}"
            what += f", which is {how}" if how else ""
            others[what] = others.get(what, 0) + 1
        elif kind == "POINT":
            points.append((layer, tuple(entity.dxf.location)))
        elif kind == "3DFACE":
            loose.setdefault(layer, []).append(np.array([tuple(v) for v in entity.wcs_vertices()]))
        elif found := _meshes(entity, kind):
            for mesh in found:
                meshes += _named(entity, layer, *mesh)
        elif (outline := _outline(entity, kind)) is not None and _is_level(outline):
            n_vertices += len(outline)
            check_counts(n_vertices, 0)
            outlines.append(_marked(entity, layer, len(outlines) + 1, outline[:, :2]))
        elif kind not in _SILENT:
            what = f"{'open ' * (outline is None and _is_open(entity, kind))}{kind}"
            what += f" on layer {quoted(layer)}" + f", which {TILTED}" * (outline is not None)
            others[what] = others.get(what, 0) + 1
    for layer, faces in loose.items():
        meshes += _components(layer, faces)
    if dimension is None:
        dimension = 3 if meshes else 2
    (shapes, up), (unused, what) = (outlines, ""), (meshes, "faces and meshes")
    if dimension == 3:
        (shapes, up), (unused, what) = (meshes, "z"), (outlines, "closed polylines")
    if unused:
        others[f"{what}, as the model has {dimension} dimensions"] = len(unused)
    if not shapes:
        raise ModelError([_nothing(dimension, others, _on_sheets(document))])
    on_control = [place for layer, place in points if layer.lower() in CONTROL_LAYERS]
    if len(on_control) > 1:
        raise ModelError([f"has {len(on_control)} points on its layer for the control point: one"])
    return Drawing(
        shapes=tuple(shapes),
        unit=_unit(int(document.header.get("$INSUNITS", 0) or 0)),
        up=up,
        control=on_control[0][:dimension] if on_control else None,
        notes=(*guesses, *(f"{n} left out: {what}" for what, n in sorted(others.items()))),
    )


def _document(contents: bytes) -> tuple[Any, list[str]]:
    """The document, and sentences on what of a damaged one had to be guessed."""
    try:
        import ezdxf
        from ezdxf import recover
    except ImportError:
        raise ModelError([MISSING]) from None
    if not _BEGINNING.match(contents):  # and nothing of a file that is another's is quoted
        raise ModelError(
            ["is no DXF file: its first line is no group code, nor is it a binary one"]
        )
    check_counts(contents.count(b"VERTEX"), contents.count(b"3DFACE"))
    with _overheard() as told:
        try:
            document, auditor = recover.read(io.BytesIO(contents))
        except (ezdxf.DXFError, OSError) as error:
            raise ModelError([f"is no DXF file that can be read: {_line(error)}"]) from None
        except Exception as error:  # a torn file takes the parser anywhere
            raise ModelError([f"is a torn DXF file: {_line(error)}"]) from None
    if auditor.has_errors:
        raise ModelError(
            [f"is a damaged DXF file: {_line(auditor.errors[0].message)}: save it anew"]
        )
    return document, [f"is damaged, and was read with a guess: {_line(text)}" for text in told]


@contextmanager
def _overheard() -> Iterator[list[str]]:
    """What ezdxf warns of: numbers that it mends, lines that it leaves out."""
    told: list[str] = []

    class Listener(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            told.append(record.getMessage())

    logger, listener = logging.getLogger("ezdxf"), Listener(logging.WARNING)
    passed_on = logger.propagate
    logger.addHandler(listener)
    logger.propagate = False
    try:
        yield told
    finally:
        logger.removeHandler(listener)
        logger.propagate = passed_on


def _line(error: object) -> str:
    """What ezdxf says, on one line and without letters of the file that would steer a terminal."""
    return printable(" ".join(str(error).split())[:200]) or type(error).__name__


def _hidden(document: Any) -> dict[str, str]:
    """Layers that a drawing does not show, small letters, and why: nothing of them is taken."""
    return {
        layer.dxf.name.lower(): "frozen" if layer.is_frozen() else "switched off"
        for layer in document.layers
        if layer.is_frozen() or layer.is_off()
    }


def _is_invisible(entity: Any) -> bool:
    """Whether the drawing has it and does not show it (group code 60)."""
    return bool(entity.dxf.get("invisible", 0))


def _entities(layout: Any, hidden: dict[str, str]) -> Iterator[tuple[Any, str]]:
    """Entities of a layout, those that its references stand for, and the layer of each.

    What a definition holds on layer 0 is on the layer of the reference.  A reference that is
    invisible, or on a frozen layer, is given as it is.  Raises `ModelError` where references are
    without end, or entities are more than are read.
    """
    count = 0
    waiting: list[tuple[Iterator[Any], str]] = [(iter(layout), "0")]
    while waiting:
        entities, outer = waiting[-1]
        entity = next(entities, None)
        if entity is None:
            waiting.pop()
            continue
        is_reference = entity.dxftype() == "INSERT"
        count += max(int(entity.mcount), 1) if is_reference else 1
        if wrong := too_many("entities", count):
            raise ModelError([wrong])
        layer = str(entity.dxf.get("layer", "0"))
        layer = outer if layer == "0" else layer
        unseen = _is_invisible(entity) or hidden.get(layer.lower()) == "frozen"
        if not is_reference or unseen:
            yield entity, layer
            continue
        if len(waiting) > DEEPEST:
            raise ModelError(["has blocks inside of each other without end"])
        ones = entity.multi_insert() if entity.mcount > 1 else (entity,)
        inside = chain.from_iterable(one.virtual_entities() for one in ones)
        waiting.append((inside, layer))


def _unit(code: int) -> str | None:
    """The unit of the header, as ezdxf calls it where it is none of ours; None if there is none."""
    if code in _UNITS or code <= 0:
        return _UNITS.get(code)
    from ezdxf import units

    return str(units.unit_name(code))


def _nothing(dimension: int, others: dict[str, int], on_sheets: int) -> str:
    wanted = "closed polylines" if dimension == 2 else "3D faces, polyface meshes or meshes"
    found = ", ".join(f"{n} {what}" for what, n in sorted(others.items())[:3])
    solid = " (solids: export them as meshes)" * any("3DSOLID" in what for what in others)
    loose = " (join them to closed polylines)" * (
        wanted == "closed polylines" and any(what.startswith(LOOSE) for what in others)
    )
    tilted = " (turn the drawing into that plane)" * any(what.endswith(TILTED) for what in others)
    sheets = f"; {on_sheets} entities lie in paper space, which is not read" * (on_sheets > 0)
    return (
        f"holds no {wanted}" + (f", only {found}{solid}{loose}{tilted}" if found else "") + sheets
    )


def _on_sheets(document: Any) -> int:
    """How many entities lie in paper space, viewports and texts not counted."""
    layouts = (layout for layout in document.layouts if layout.is_any_paperspace)
    return sum(entity.dxftype() not in _SILENT for layout in layouts for entity in layout)


# --- the plane --------------------------------------------------------------------------------


def _outline(entity: Any, kind: str) -> np.ndarray | None:
    """Vertices (n, 3) of a closed polyline, arcs in chords; None of anything else.

    Heights that polylines of the plane have (their elevations) are left out.
    """
    if kind == "LWPOLYLINE":
        rows = [(x, y, bulge) for x, y, bulge in entity.get_points("xyb")]
    elif kind == "POLYLINE" and entity.is_2d_polyline:
        rows = [(*tuple(v.dxf.location)[:2], v.dxf.get("bulge", 0.0)) for v in entity.vertices]
    elif kind == "POLYLINE" and entity.is_3d_polyline:
        places = [tuple(v.dxf.location) for v in entity.vertices]
        return _ring(np.array(places, dtype=np.float64).reshape(-1, 3), entity.is_closed)
    else:
        return None
    ring = _ring(np.array(rows, dtype=np.float64).reshape(-1, 3), not _is_open(entity, kind), 2)
    if ring is None:
        return None
    points: list[tuple[float, float]] = []
    rows = ring.tolist()
    for (x, y, bulge), (u, v, _) in zip(rows, rows[1:] + rows[:1], strict=True):
        points += [(x, y), *_chords((x, y), (u, v), bulge)]
    placed = entity.ocs().points_to_wcs((x, y, 0.0) for x, y in points)
    vertices = np.array([tuple(point) for point in placed])
    return vertices if len(vertices) > 2 else None


def _ring(rows: np.ndarray, closed: bool, dimension: int = 3) -> np.ndarray | None:
    """Rows (n, 3) of a closed line without a last one that repeats the first; None if it is open.

    The first ``dimension`` columns are places.
    """
    places = rows[:, :dimension]
    if not np.isfinite(places).all():
        raise ModelError(["every coordinate must be a finite number: the file is torn"])
    if len(rows) > 3:
        size = float(np.ptp(places, axis=0).max())
        if float(np.linalg.norm(places[0] - places[-1])) <= SAME_POINT * size:
            return rows[:-1]
    return rows if closed and len(rows) > 1 else None


def _is_level(vertices: np.ndarray) -> bool:
    """Whether an outline (n, 3) lies in a plane of x and y."""
    sides = np.ptp(vertices, axis=0)
    return bool(sides[2] <= SAME_POINT * sides.max())


def _is_open(entity: Any, kind: str) -> bool:
    """Whether a polyline, which may be meant as an outline, lacks its last edge."""
    if kind == "LWPOLYLINE":
        return not entity.closed
    line = kind == "POLYLINE" and (entity.is_2d_polyline or entity.is_3d_polyline)
    return line and not entity.is_closed


def _chords(
    start: Sequence[float], end: Sequence[float], bulge: float
) -> list[tuple[float, float]]:
    """Points between the ends of an arc; ``bulge`` is the tangent of a quarter of its angle."""
    if not np.isfinite(bulge) or abs(bulge) < 1e-9:
        return []
    angle = 4.0 * np.arctan(bulge)
    n = int(np.ceil(abs(angle) / (2.0 * np.arccos(1.0 - ARC))))
    chord = complex(end[0] - start[0], end[1] - start[1])
    centre = complex(*start[:2]) + chord * complex(0.5, 0.25 * (1.0 / bulge - bulge))
    arm = complex(*start[:2]) - centre
    turned = [centre + arm * np.exp(1j * angle * k / n) for k in range(1, n)]
    return [(float(p.real), float(p.imag)) for p in turned]


# --- space ------------------------------------------------------------------------------------


_Mesh = tuple[np.ndarray, list[tuple[int, ...]]]


def _meshes(entity: Any, kind: str) -> list[_Mesh]:
    """Vertices and faces of a mesh, or of the bodies of a solid with flat faces."""
    if kind == "MESH":
        return [_mesh(entity)]
    if kind == "POLYLINE" and (entity.is_poly_face_mesh or entity.is_polygon_mesh):
        from ezdxf.render import MeshBuilder

        return [_mesh(MeshBuilder.from_polyface(entity))]
    if kind in ("3DSOLID", "BODY"):
        from ezdxf.acis import api as acis

        try:
            return [
                _mesh(built)
                for body in acis.load_dxf(entity)
                for built in acis.mesh_from_body(body)
            ]
        except Exception:  # curved faces, or a version that ezdxf does not know: left out, and said
            return []
    return []


def _mesh(built: Any) -> _Mesh:
    vertices = np.array([tuple(v) for v in built.vertices], dtype=np.float64).reshape(-1, 3)
    faces = [tuple(map(int, face)) for face in built.faces]
    check_faces(len(vertices), faces, "a mesh: ")
    return vertices, [face for face in faces if len(face) > 2]


def _components(layer: str, faces: Sequence[np.ndarray]) -> list[Shape]:
    """The connected surfaces of 3D faces of one layer."""
    if sum(map(len, faces)) > MOST:
        raise ModelError(["has more faces than any drawing of blocks"])
    first = np.cumsum([0, *(len(face) for face in faces)]).tolist()
    loops = [tuple(range(a, a + len(face))) for a, face in zip(first, faces, strict=False)]
    shapes = shapes_of_mesh(np.vstack(faces), loops, layer=layer)
    return [_renamed(shape, f"{layer}/{k}") for k, shape in enumerate(shapes, 1)]


def _renamed(shape: Shape, name: str) -> Shape:
    return Shape(
        name=name,
        vertices=shape.vertices,
        faces=shape.faces,
        layer=shape.layer,
        groups=shape.groups,
        support=shape.layer.lower() in SUPPORT_LAYERS,
    )


def _named(
    entity: Any, layer: str, vertices: np.ndarray, faces: list[tuple[int, ...]]
) -> list[Shape]:
    """A mesh as one shape, or as many as it has connected surfaces."""
    known = _extended(entity)
    if known:
        return [_known(known, layer, vertices, tuple(faces))]
    shapes = shapes_of_mesh(vertices, faces, layer=layer)
    handle = entity.dxf.get("handle") or "mesh"
    return [
        _renamed(shape, f"{layer}/{handle}" + (f"/{k}" if len(shapes) > 1 else ""))
        for k, shape in enumerate(shapes, 1)
    ]


def _marked(entity: Any, layer: str, k: int, vertices: np.ndarray) -> Shape:
    known = _extended(entity)
    if known:
        return _known(known, layer, vertices, ())
    return _renamed(Shape(name="", vertices=vertices, layer=layer), f"{layer}/{k}")


def _known(
    known: dict[str, Any], layer: str, vertices: np.ndarray, faces: tuple[tuple[int, ...], ...]
) -> Shape:
    """A shape that `write` wrote; it may have been moved to another layer since."""
    groups = known.get("groups")
    material = tidy_name(known.get("material", layer))
    support = known.get("support") is True
    written_on = "support" if support else tidy_name(_layer(material))
    if layer.lower() != written_on.lower():
        support = layer.lower() in SUPPORT_LAYERS
        material = material if support else layer
    return Shape(
        name=tidy_name(known.get("id")) or layer,
        vertices=vertices,
        faces=faces,
        layer=material,
        groups=tuple(map(tidy_name, groups)) if isinstance(groups, list) else (),
        support=support,
    )


def _extended(entity: Any) -> dict[str, Any]:
    """What `write` put beside an entity; nothing where another program drew it."""
    try:
        tags = entity.get_xdata(APPLICATION) if entity.has_xdata(APPLICATION) else ()
        known = json.loads("".join(str(tag.value) for tag in tags if tag.code == 1000) or "{}")
    except (ValueError, AttributeError):
        return {}
    return known if isinstance(known, dict) and known.get("id") else {}


def write(shapes: Sequence[Shape], title: str, control: Sequence[float] | None = None) -> str:
    """The text of a file: polylines or meshes on layers by their materials, in metres.

    Raises `ModelError` where ezdxf is not installed.
    """
    try:
        import ezdxf
    except ImportError:
        raise ModelError(
            ["dxf: needs ezdxf, which is not installed: pip install drystone[dxf]"]
        ) from None
    document = ezdxf.new("R2010", units=6)
    document.appids.add(APPLICATION)
    space = document.modelspace()
    for shape in shapes:
        layer = "support" if shape.support else _layer(shape.layer)
        if shape.faces:
            entity: Any = space.add_mesh(dxfattribs={"layer": layer})
            with entity.edit_data() as data:
                data.vertices = [tuple(row) for row in shape.vertices.tolist()]
                data.faces = [tuple(face) for face in shape.faces]
        else:
            entity = space.add_lwpolyline(
                [tuple(row) for row in shape.vertices.tolist()],
                close=True,
                dxfattribs={"layer": layer},
            )
        known = {
            "id": shape.name,
            "material": shape.layer,
            "groups": list(shape.groups),
            "support": bool(shape.support),
        }
        text = json.dumps(known)
        tags = [(1000, text[k : k + 240]) for k in range(0, len(text), 240)]
        entity.set_xdata(APPLICATION, tags)
    if control is not None:
        place = (*map(float, control), 0.0)[:3]
        space.add_point(place, dxfattribs={"layer": "control"})
    stream = io.StringIO()
    document.header["$PROJECTNAME"] = tidy_name(title)
    document.write(stream)
    return stream.getvalue()


def _layer(name: str) -> str:
    """A layer's name without letters that DXF forbids."""
    return "".join("_" if c in '<>/\\":;?*|=`,' else c for c in name) or "0"


FORMAT = Format(
    name="dxf",
    endings=(".dxf",),
    read=lambda data, _, dimension: read(data, dimension),
    write=write,
    in_plane=True,
)
