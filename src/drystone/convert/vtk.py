"""VTK: the blocks' outlines as polygons, with what they are made of; for ParaView and the like.

The legacy format (``.vtk``) is text, the XML format (``.vtu``) is that of the results.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drystone.convert.common import Written, materials, number
from drystone.export import vtu
from drystone.model import Model

NOTES = (
    "VTK holds the blocks' outlines, supports, materials and weights: joints, corners, load and "
    "analysis are left out",
)


def write(model: Model, name: str = "") -> Written:
    """The model's geometry, in the XML format where the file's name ends so."""
    assembly = model.assembly
    outlines = [block.vertices for block in assembly.blocks]
    data = {
        "block": np.arange(assembly.n_bodies),
        "is_support": assembly.fixed.astype(np.int64),
        "material": np.array(materials(assembly).of_block, dtype=np.int64),
        "weight": assembly.weight,
    }
    if name.lower().endswith(".vtu"):
        return Written(text=_xml(outlines, data), notes=NOTES)
    return Written(text=_legacy(model.title, outlines, data), notes=NOTES)


def _legacy(
    title: str, outlines: list[NDArray[np.float64]], data: Mapping[str, NDArray[Any]]
) -> str:
    points = np.vstack(outlines)
    count = [len(outline) for outline in outlines]
    start = np.cumsum([0, *count])
    one_line = " ".join(title.split()).encode("ascii", "replace").decode()[:200]
    lines = [
        "# vtk DataFile Version 3.0",
        one_line or "drystone",
        "ASCII",
        "DATASET POLYDATA",
        f"POINTS {len(points)} double",
        *(f"{number(x)} {number(y)} 0.0" for x, y in points),
        f"POLYGONS {len(outlines)} {len(points) + len(outlines)}",
        *(
            " ".join(map(str, [n, *range(first, first + n)]))
            for n, first in zip(count, start, strict=False)
        ),
        f"CELL_DATA {len(outlines)}",
    ]
    for key, values in data.items():
        kind = "double" if values.dtype.kind == "f" else "int"
        lines += [f"SCALARS {key} {kind} 1", "LOOKUP_TABLE default", *map(repr, values.tolist())]
    return "\n".join(lines) + "\n"


def _xml(outlines: list[NDArray[np.float64]], data: Mapping[str, NDArray[Any]]) -> str:
    points = np.vstack(outlines)
    ends = np.cumsum([len(outline) for outline in outlines]).astype(np.int64)
    return vtu.vtu_text(
        points=points,
        n_cells=len(outlines),
        cells=vtu.cells(np.arange(len(points)), ends, vtu.POLYGON),
        cell_data=[vtu.data_array(key, values) for key, values in data.items()],
    )
