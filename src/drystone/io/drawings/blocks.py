"""From a drawing to blocks: units, axes, mending, place, materials and supports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry import GeometryError
from drystone.geometry.figure import Figure
from drystone.geometry.mended import Mended
from drystone.geometry.space.mend import DrawnSolid, mended_solids
from drystone.geometry.space.meshes import Mesh, is_flat, shortest_edge
from drystone.geometry.space.solid import Faces
from drystone.geometry.space.trim import trimmed
from drystone.io.drawings.drawing import SUPPORT_LAYERS, UNITS, Drawing, Shape
from drystone.io.drawings.formats import read_drawing
from drystone.io.drawings.outlines import mended_outlines
from drystone.io.drawings.patterns import expression
from drystone.io.drawings.placing import placed, turned_up
from drystone.io.drawings.settings import ImportSettings
from drystone.model.assembly import Block
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import listed, millimetres, quoted, suggestion

#: Thickness given to a support that is drawn as a flat outline, over its shortest edge.
PLATE = 0.1


@dataclass(frozen=True, kw_only=True)
class Imported:
    """Blocks of a file, and what was done to them."""

    blocks: tuple[Block, ...]
    mended: tuple[Mended, ...]
    notes: tuple[str, ...]  # sentences on all of it
    control: tuple[float, ...] | None  # m, the control point where the file has one
    sha256: str = ""  # of the file's contents, and of those beside it that were read


#: Name and unit weight [N/m3] of the material for a layer.
MaterialOf = Callable[[str], tuple[str, float]]


def imported(
    settings: ImportSettings, material_of: MaterialOf, dimension: int | None = None
) -> Imported:
    """Read a file and make blocks of it.

    Parameters
    ----------
    material_of
        Of a layer, which may have no name; raises `ModelError` where there is none.
    dimension
        Of the model; that of the drawing where nothing is said.

    Raises
    ------
    ModelError
        The file cannot be read, lacks what is not given, or holds what is no block; the sentences
        name the file.
    """
    name = settings.file.name
    try:
        drawing = read_drawing(settings.file, settings.format, dimension)
        if dimension is not None and drawing.dimension != dimension:
            raise ModelError(
                [f"holds blocks of {drawing.dimension} dimensions, the model has {dimension}"]
            )
        return blocks_of(drawing, settings, material_of)
    except ModelError as error:
        raise ModelError(f"{quoted(name)}: {problem}" for problem in error.problems) from None


def blocks_of(drawing: Drawing, settings: ImportSettings, material_of: MaterialOf) -> Imported:
    """Make blocks of what was drawn; the arguments are those of `imported`.

    Raises
    ------
    ModelError
        A shape is no block, or the settings name what is not there.
    """
    notes = list(drawing.notes)
    scale = UNITS[_unit(settings, drawing, notes)]
    up = _up(settings, drawing, notes)
    shapes = [
        replace(shape, vertices=turned_up(scale * shape.vertices, up)) for shape in drawing.shapes
    ]
    shapes = _supports(shapes, settings)
    if settings.rotation and (held := [shape.name for shape in shapes if shape.held]):
        raise ModelError(
            [f"rotation: rollers stay along the axes, and turn with {listed(held)}: take it out"]
        )
    try:
        if drawing.dimension == 3:
            made, records = _solids(shapes, settings)
        else:
            made, records = mended_outlines(shapes, settings.tolerance, settings.overlap)
    except GeometryError as error:
        raise ModelError([str(error)]) from None
    prefix = f"{settings.name}/" if settings.name else ""
    blocks = []
    for block in made:
        material, weight = material_of(block.material)
        groups = (*block.groups, *((settings.group,) if settings.group else ()))
        vertices = placed(block.vertices, settings.origin, settings.rotation)
        block = replace(
            block.with_vertices(vertices),
            id=prefix + block.id,
            material=material,
            unit_weight=weight,
            groups=tuple(dict.fromkeys(groups)),
        )
        height = settings.support_below
        if height is not None and float(vertices[:, -1].min()) < height:
            block = replace(block, support=True)
        blocks.append(block)
    records = [replace(record, block=prefix + record.block) for record in records]
    _check_supports(blocks, settings.support_below)
    control = None
    if drawing.control is not None:
        point = turned_up(scale * np.array([drawing.control]), up)
        control = tuple(placed(point, settings.origin, settings.rotation)[0].tolist())
        notes.append("the control point is that of the file")
    file = quoted(settings.file.name)
    return Imported(
        blocks=tuple(blocks),
        mended=tuple(records),
        notes=tuple(f"import {file}: {note}" for note in (*notes, *sentences(records))),
        control=control,
        sha256=drawing.sha256,
    )


def _check_supports(blocks: Sequence[Block], below: float | None) -> None:
    """Raise `ModelError` where none reaches below the height that makes supports [m]."""
    if below is not None and not any(block.support for block in blocks):
        lowest = min(float(block.vertices[:, -1].min()) for block in blocks)
        raise ModelError(
            [f"support_below: no block reaches below {below:g} m, the lowest is at {lowest:.6g} m"]
        )


def sentences(records: Sequence[Mended]) -> list[str]:
    """One sentence for each kind of change, on all blocks that had it."""
    kinds: dict[str, list[Mended]] = {}
    for record in records:
        kinds.setdefault(record.what, []).append(record)
    found = []
    for what, own in kinds.items():
        names = list(dict.fromkeys(record.block for record in own))
        many = "1 block" if len(names) == 1 else f"{len(names)} blocks"
        most = max(record.how_much for record in own)
        by = f" (by up to {millimetres(most)})" if most else ""
        more = sum(record.volume for record in own)
        if more:
            word = "more" if more > 0.0 else "less"
            by += f" (together {abs(more):.4g} m3 {word} than {own[0].than})"
        found.append(f"{many} {what}{by}: {listed(names)}")
    return found


def _unit(settings: ImportSettings, drawing: Drawing, notes: list[str]) -> str:
    if settings.unit is None:
        if drawing.unit not in UNITS:
            raise ModelError(
                [
                    f"unit is missing, and the file says {drawing.unit or 'none'}: give "
                    '"m", "cm", "mm", "in" or "ft"'
                ]
            )
        return drawing.unit
    if drawing.unit is not None and drawing.unit != settings.unit:
        notes.append(f"says {drawing.unit}, and was read in {settings.unit} as given")
    return settings.unit


def _up(settings: ImportSettings, drawing: Drawing, notes: list[str]) -> str:
    if drawing.dimension == 2:
        if settings.up is not None:
            raise ModelError(["up: is for models in space only: take it out"])
        return ""
    if settings.up is None:
        if drawing.up is None:
            raise ModelError(
                ['up is missing, and the format has none: give the axis that points up, "z" or "y"']
            )
        return drawing.up
    if settings.up == "y":
        notes.append("y pointed up, and was turned to z")
    return settings.up


def _supports(shapes: Sequence[Shape], settings: ImportSettings) -> list[Shape]:
    """The shapes with those marked as supports that names say."""
    marked = {i for i, shape in enumerate(shapes) if shape.support}
    marked |= {i for i, shape in enumerate(shapes) if shape.layer.lower() in SUPPORT_LAYERS}
    prefix = f"{settings.name}/" if settings.name else ""
    for pattern in settings.support:
        fits = expression(pattern).fullmatch
        found = {
            i
            for i, shape in enumerate(shapes)
            if any(map(fits, (shape.name, prefix + shape.name, shape.layer, *shape.groups)))
        }
        if not found:
            called = [*(shape.layer for shape in shapes), *(shape.name for shape in shapes)]
            known = [name for name in dict.fromkeys(called) if name]
            raise ModelError(
                [
                    f"support: there is no block, group or layer {quoted(pattern)}: "
                    f"{suggestion(pattern, known)}"
                ]
            )
        marked |= found
    return [
        replace(shape, support=True, held=()) if i in marked and not shape.support else shape
        for i, shape in enumerate(shapes)
    ]


def _groups(shape: Shape) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for name in (shape.layer, *shape.groups) if name))


def _solids(shapes: Sequence[Shape], settings: ImportSettings) -> tuple[list[Block], list[Mended]]:
    records: list[Mended] = []
    middle = np.vstack([shape.vertices for shape in shapes]).mean(axis=0)
    drawn = []
    for shape in shapes:
        vertices, faces = shape.vertices, shape.faces
        if shape.support and len(faces) == 1 and is_flat(Mesh(vertices, faces), 1e-6):
            vertices, faces, thickness = _plate(vertices, faces[0], middle)
            records.append(
                Mended(
                    block=shape.name,
                    what="had a flat outline that was given a thickness",
                    how_much=thickness,
                )
            )
        drawn.append(
            DrawnSolid(name=shape.name, vertices=vertices, faces=faces, support=shape.support)
        )
    solids, more = mended_solids(drawn, settings.tolerance, settings.bent_faces, settings.overlap)
    blocks = [
        Block(
            id=solid.name,
            vertices=solid.vertices,
            faces=solid.faces,
            unit_weight=1.0,
            material=shapes[solid.source].layer,
            support=shapes[solid.source].support,
            held=shapes[solid.source].held,
            groups=_groups(shapes[solid.source]),
        )
        for solid in solids
    ]
    blocks, cut = _trimmed(blocks, settings)
    return blocks, [*records, *more, *cut]


def _plate(vertices: Array, face: tuple[int, ...], middle: Array) -> tuple[Array, Faces, float]:
    """A flat outline made a prism, away from the middle of everything."""
    outline = vertices[list(face)]
    around = np.cross(outline, np.roll(outline, -1, axis=0)).sum(axis=0)
    normal = around / np.sqrt(around @ around)
    if (middle - outline[0]) @ normal > 0.0:
        normal = -normal
    edges = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    thickness = PLATE * float(edges.min())
    n = len(face)
    sides = tuple((i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n))
    faces = (tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n)), *sides)
    if around @ normal < 0.0:
        faces = tuple(loop[::-1] for loop in faces)
    return np.vstack((outline, outline + thickness * normal)), faces, thickness


def _trimmed(blocks: list[Block], settings: ImportSettings) -> tuple[list[Block], list[Mended]]:
    """Blocks without overlaps that the settings allow for."""
    figures: list[Figure] = []
    for block in blocks:
        try:
            figures.append(block.figure())
        except GeometryError as error:
            raise GeometryError(f'"{block.id}": {error}') from None
    allowed = [
        max(settings.overlap, settings.tolerance * shortest_edge(Mesh(b.vertices, b.faces)))
        for b in blocks
    ]
    parts, cut = trimmed(
        [figure.parts for figure in figures], allowed, [block.support for block in blocks]
    )
    records = []
    for i, depth in sorted(cut.items()):
        block = blocks[i]
        kept = parts[i]
        if len(kept) == 1:
            blocks[i] = replace(block, vertices=kept[0].vertices, faces=kept[0].faces)
        else:
            blocks[i] = replace(
                block, vertices=np.vstack([p.vertices for p in kept]), faces=(), parts=tuple(kept)
            )
        records.append(
            Mended(
                block=block.id,
                what="had overlaps with neighbours that were cut off",
                how_much=depth,
            )
        )
    return blocks, records
