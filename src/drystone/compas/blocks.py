"""Blocks of a `BlockModel`: their meshes, materials and supports."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.errors import ModelError
from drystone.io.drawings.blocks import Imported, blocks_of
from drystone.io.drawings.drawing import Drawing, Shape
from drystone.io.drawings.settings import TOLERANCE, ImportSettings

#: Group that every block is in, so that loads can name all of them.
EVERY = "blocks"


def name_of(node: int) -> str:
    """Id of the block at a node of the graph."""
    return str(node)


def elements(model: Any) -> list[Any]:
    """The blocks of a `BlockModel`, supports included, in its own order.

    A `Group` has no shape of its own: it moves its blocks, and their meshes in model coordinates
    have that motion.

    Raises `ModelError` where an element is neither, by name.
    """
    from compas_dem.elements import Block
    from compas_model.elements import Group

    found = [one for one in model.elements() if not isinstance(one, Group)]
    if wrong := [one for one in found if not isinstance(one, Block)]:
        raise ModelError(
            f'element {one.graphnode}, "{one.name}": is a {type(one).__name__}, and drystone '
            "solves blocks: add it as Block.from_mesh(mesh) of compas_dem"
            for one in wrong
        )
    return found


def imported_blocks(
    model: Any, gravity: float, *, density: float | None = None, tolerance: float = TOLERANCE
) -> Imported:
    """Blocks of drystone, each with its graph node as id.

    Parameters
    ----------
    model
        A `BlockModel`.
    gravity
        Acceleration [m/s2] that makes weights of densities.
    density
        Of blocks without a material [kg/m3].
    tolerance
        Of the import of solids: the largest distance by which vertices are moved, over the
        shortest edge of their block.

    Raises
    ------
    ModelError
        An element is no block, or a block has no density, or its mesh is no solid.
    """
    blocks = elements(model)
    if not blocks:
        raise ModelError(["BlockModel: has no blocks: add some before it is solved"])
    materials, layers = _materials(blocks, density)
    shapes = [
        Shape(
            name=name_of(block.graphnode),
            vertices=vertices,
            faces=faces,
            layer=layer,
            groups=(EVERY,),
            support=bool(block.is_support),
        )
        for block, layer in zip(blocks, layers, strict=True)
        for vertices, faces in [_mesh(block)]
    ]
    settings = ImportSettings(file=Path("BlockModel"), tolerance=tolerance)
    drawing = Drawing(shapes=tuple(shapes), unit="m", up="z")
    made = blocks_of(drawing, settings, lambda layer: (layer, gravity * materials[layer]))
    names = [block.id for block in made.blocks]
    if wrong := [shape.name for shape in shapes if shape.name not in names]:
        raise ModelError(
            f'block "{name}": its mesh is several solids: make each a block of its own'
            for name in wrong
        )
    return made


def _mesh(block: Any) -> tuple[np.ndarray, tuple[tuple[int, ...], ...]]:
    """Vertices (n, 3) [m] and faces of a block in model coordinates."""
    vertices, faces = block.modelgeometry.to_vertices_and_faces()
    return np.array(vertices, np.float64), tuple(tuple(map(int, face)) for face in faces)


def _materials(blocks: Iterable[Any], density: float | None) -> tuple[dict[str, float], list[str]]:
    """Density [kg/m3] of every material by name, and the name that each block has."""
    densities: dict[str, float] = {}
    names, missing = [], []
    for block in blocks:
        own = block.material
        found = density if own is None else own.density
        if found is None:
            missing.append(
                f'block "{block.graphnode}": has no density: model.assign_material(...) gives it '
                "a material, or density=... of solve all that have none"
            )
            continue
        plain = "" if own is None else str(own.name or type(own).__name__)
        name, k = plain, 1
        while densities.get(name, found) != found:
            k += 1
            name = f"{plain} ({k})"
        densities[name] = float(found)
        names.append(name)
    if missing:
        raise ModelError(missing)
    return densities, names
