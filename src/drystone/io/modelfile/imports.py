"""[[import]]: blocks from files of other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from drystone.common.names import in_any_case
from drystone.geometry import GeometryError
from drystone.geometry.mended import Mended
from drystone.io.drawings.settings import ImportSettings
from drystone.io.modelfile.schema import ImportSection, ModelSection
from drystone.io.modelfile.sentences import place_of
from drystone.model.assembly import Block
from drystone.model.construction.contents import within
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted, suggestion


@dataclass
class Imports:
    """Blocks of all files that a model imports."""

    blocks: list[Block] = field(default_factory=list)
    places: list[str] = field(default_factory=list)  # of each block, for messages
    mended: list[Mended] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    digests: list[str] = field(default_factory=list)  # of what was read, file by file
    control: tuple[str, list[float]] | None = None  # block and point [m], where a file has one


def imports_of(
    section: ModelSection,
    unit_weights: Mapping[str, float],
    source: str | None,
    problems: list[str],
) -> Imports:
    """Read what the tables [[import]] name; what is wrong is added to ``problems``.

    Parameters
    ----------
    unit_weights
        Of the materials by their names [N/m3].
    source
        Path of the model file, from whose folder files are named.
    """
    found = Imports()
    if not section.imports:
        return found
    from drystone.io.drawings.blocks import (
        imported,  # brings much along that most models do without
    )

    for i, table in enumerate(section.imports):
        place = place_of(("import", i), {})
        try:
            made = imported(
                _settings(table, within(Path(source or "").parent, table.file)),
                partial(_material, table, unit_weights),
                section.dimension,
            )
        except ModelError as error:
            problems.extend(f"{place} {problem}" for problem in error.problems)
            continue
        found.blocks += made.blocks
        found.places += [f"{place} block {quoted(block.id)}" for block in made.blocks]
        found.mended += made.mended
        found.notes += made.notes
        found.digests.append(made.sha256)
        if made.control is not None:
            found.control = nearest(made.blocks, made.control), list(made.control)
    return found


def _settings(table: ImportSection, file: Path) -> ImportSettings:
    return ImportSettings(
        file=file,
        format=table.format,
        unit=table.unit,
        up=table.up,
        material=table.material,
        support=tuple(table.support),
        support_below=table.support_below,
        tolerance=table.tolerance,
        bent_faces=table.bent_faces,
        overlap=table.overlap,
        name=table.name,
        group=table.group,
        origin=tuple(table.origin or ()),
        rotation=table.rotation or (),
    )


def _material(
    table: ImportSection, unit_weights: Mapping[str, float], layer: str
) -> tuple[str, float]:
    """The material that a layer is named after, in letters of any case, else that of the table,
    else the only one."""
    known = list(unit_weights)
    name = in_any_case(layer, known) or table.material
    if name is None:
        if len(known) > 1:
            of = f" of layer {quoted(layer)}" if layer else ""
            raise ModelError(
                [f"material{of} is missing: with several materials, name one of them here"]
            )
        name = known[0]
    if name not in unit_weights:
        raise ModelError(
            [f"material: there is no material {quoted(name)}: {suggestion(name, known)}"]
        )
    return name, unit_weights[name]


def nearest(blocks: Sequence[Block], point: Sequence[float]) -> str:
    """The movable block that a point is in, or nearest to."""
    place = np.array(point)
    away = {}
    for block in blocks:
        if not block.support:
            try:
                away[block.id] = block.figure().distance(place)
            except GeometryError:  # said where the model is put together
                continue
    return min(away, key=lambda name: away[name]) if away else blocks[0].id
