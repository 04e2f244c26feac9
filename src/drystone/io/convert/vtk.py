"""VTK: the blocks' outlines as polygons, with what they are made of; for ParaView and the like.

In space they are the faces of the blocks' convex parts in the legacy format (``.vtk``), which is
text, and polyhedra in the XML format (``.vtu``), which is that of the results.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, IntArray
from drystone.geometry.motion import in_space
from drystone.io.convert.common import Written, materials, number
from drystone.io.results import vtu
from drystone.model.model import Model
from drystone.results.shapes import MovingShapes

NOTES = (
    "VTK holds the blocks' shapes, supports, materials and weights: joints, corners, load and "
    "analysis are left out",
)


def write(model: Model, name: str = "") -> Written:
    """The model's geometry, in the XML format where the file's name ends so."""
    assembly = model.assembly
    data = {
        "block": np.arange(assembly.n_bodies),
        "is_support": assembly.fixed.astype(np.int64),
        "material": np.array(materials(assembly).of_block, dtype=np.int64),
        "weight": assembly.weight,
    }
    shapes = MovingShapes.of(assembly)
    points = in_space(shapes.vertices)
    xml = name.lower().endswith(".vtu")
    if assembly.dimension == 3:
        solids = assembly.polyhedra
        faces = (solids.rows, solids.face_offset, solids.part_faces)
        if xml:
            return _xml(points, vtu.polyhedra(solids.offset, *faces), shapes.body, data)
        body = np.repeat(solids.body, np.diff(solids.part_faces))
        rows, ends = solids.rows, solids.face_offset
    else:
        body, rows, ends = shapes.body, np.arange(len(points)), shapes.offset
        if xml:
            return _xml(points, vtu.cells(rows, ends[1:], vtu.POLYGON), body, data)
    polygons = [rows[i:j].tolist() for i, j in pairwise(ends)]
    of_polygon = {key: values[body] for key, values in data.items()}
    return Written(text=_legacy(model.title, points, polygons, of_polygon), notes=NOTES)


def _legacy(
    title: str,
    points: Array,
    polygons: list[list[int]],
    data: Mapping[str, NDArray[Any]],
) -> str:
    one_line = " ".join(title.split()).encode("ascii", "replace").decode()[:200]
    lines = [
        "# vtk DataFile Version 3.0",
        one_line or "drystone",
        "ASCII",
        "DATASET POLYDATA",
        f"POINTS {len(points)} double",
        *(" ".join(map(number, point)) for point in points),
        f"POLYGONS {len(polygons)} {sum(map(len, polygons)) + len(polygons)}",
        *(" ".join(map(str, [len(rows), *rows])) for rows in polygons),
        f"CELL_DATA {len(polygons)}",
    ]
    for key, values in data.items():
        kind = "double" if values.dtype.kind == "f" else "int"
        lines += [f"SCALARS {key} {kind} 1", "LOOKUP_TABLE default", *map(repr, values.tolist())]
    return "\n".join(lines) + "\n"


def _xml(
    points: Array,
    cells: str,
    body: IntArray,
    data: Mapping[str, NDArray[Any]],
) -> Written:
    text = vtu.vtu_text(
        points=points,
        n_cells=len(body),
        cells=cells,
        cell_data=[vtu.data_array(key, values[body]) for key, values in data.items()],
    )
    return Written(text=text, notes=NOTES)
