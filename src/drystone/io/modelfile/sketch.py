"""Blocks of a file that is no model yet: a drawing, or a model file that does not say all.

Geometry alone is taken from it: which blocks there are, where they touch and where they overlap.
What stands in for materials, joints and loads is seen by nobody.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drystone.common.arrays import Array, IntArray
from drystone.geometry.dimension import dimension_of
from drystone.geometry.mended import Mended
from drystone.io.drawings.settings import ImportSettings
from drystone.io.modelfile.parse import parse
from drystone.io.modelfile.read import blocks_of, checked, corner_of
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.construction.checks import CLOSING, OVERLAPPING, layout_problems
from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError
from drystone.model.construction.fit import DRAWING_TOLERANCE
from drystone.model.construction.model import assembly_of
from drystone.model.joint_law import JointLaw

#: Material of blocks that say none; of a weight that nobody sees.
STONE = {"unit_weight": 1.0}
LAW = JointLaw(friction_coefficient=0.0, normal_stiffness=None, shear_stiffness=None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sketch:
    """Blocks and joints, without what they weigh and bear."""

    title: str
    assembly: Assembly
    missing: tuple[str, ...]  # tables and keys that a model needs, and the file has not
    problems: tuple[str, ...]  # sentences on what keeps it from being a model beside that
    notes: tuple[str, ...]
    mended: tuple[Mended, ...]

    @property
    def overlaps(self) -> tuple[IntArray, IntArray, Array]:
        """Convex parts that overlap, by their rows in `Assembly.packed`, and how deep [m]."""
        packed = self.assembly.packed
        p, q = packed.near_pairs()
        depth = packed.overlap_depths(p, q)
        deep = depth > OVERLAPPING * packed.pair_size(p, q)
        return p[deep], q[deep], depth[deep]

    @classmethod
    def of(
        cls,
        blocks: Sequence[Block],
        *,
        title: str,
        places: Sequence[str],
        missing: Sequence[str] = (),
        corner: Corner | None = None,
        drawing_tolerance: float = DRAWING_TOLERANCE,
        closing: str = CLOSING,
        notes: Sequence[str] = (),
        mended: Sequence[Mended] = (),
    ) -> Sketch:
        """That of blocks; raises `ModelError` where one of them is none."""
        assembly, amended = assembly_of(
            blocks,
            LAW,
            {},
            corner=corner or Corner(),
            thickness=dimension_of(blocks[0].dimension).thickness(1.0) if blocks else None,
            points=None,
            drawing_tolerance=drawing_tolerance,
            place=lambda i: places[i],
        )
        supports = () if assembly.fixed.any() else ("a support",)
        problems = layout_problems(assembly, lambda i: places[i], closing)
        if supports:
            problems = [one for one in problems if "no block is a support" not in one]
        if assembly.n_blocks == 0:  # a drawing may have left the others out
            problems += notes
        return cls(
            title=title,
            assembly=assembly,
            missing=(*missing, *supports),
            problems=tuple(problems),
            notes=(*notes, *amended),
            mended=tuple(mended),
        )


def sketch_of_model(path: Path) -> Sketch:
    """The blocks of a model file, whatever else it says; raises `ModelError`."""
    try:
        contents = read_bytes(path, "the model file")
        data = parse(contents, is_json=path.suffix.lower() == ".json")
        filled, missing = _filled(data)
        section = checked(filled)
        problems: list[str] = []
        blocks, places, imports = blocks_of(section, filled, str(path), problems)
        if problems:
            raise ModelError(problems)
        return Sketch.of(
            blocks,
            title=path.stem if section.title is None else section.title,
            places=places,
            missing=missing,
            corner=corner_of(section),
            drawing_tolerance=section.drawing_tolerance,
            notes=imports.notes,
            mended=imports.mended,
        )
    except ModelError as error:
        raise ModelError(f"{path}: {problem}" for problem in error.problems) from None


def sketch_of_drawing(settings: ImportSettings) -> Sketch:
    """The blocks of a drawing; raises `ModelError`."""
    from drystone.io.drawings.blocks import (
        imported,  # brings much along that most models do without
    )

    made = imported(settings, lambda layer: (layer or "stone", 1.0))
    thickness = dimension_of(made.blocks[0].dimension).thickness(1.0)
    return Sketch.of(
        made.blocks,
        title=settings.file.stem,
        places=[f'import[1] block "{block.id}"' for block in made.blocks],
        missing=(*(() if thickness is None else ("thickness",)), "[material]", "[joint]", "[load]"),
        notes=made.notes,
        mended=made.mended,
    )


def _filled(data: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """A file's keys with what it needs and has not, and which these are."""
    filled, missing = deepcopy(data), []
    space = data.get("dimension") == 3
    if not space and "thickness" not in data:
        filled["thickness"] = 1.0
        missing.append("thickness")
    if "material" not in data:
        named = _materials(filled)
        filled["material"] = {name: STONE for name in named}
        missing.append("[material]")
    if "joint" not in data:
        filled["joint"] = {"friction_coefficient": 0.0}
        missing.append("[joint]")
    if "load" not in data and "settlement" not in data:
        filled["load"] = {"pattern": "mass", "direction": [1.0, 0.0, 0.0] if space else [1.0, 0.0]}
        missing.append("[load]")
    return filled, missing


def _materials(data: dict[str, Any]) -> list[str]:
    """Names of materials that the tables of a file give; tables without one get the first."""
    wall = data.get("wall")
    tables = [wall] if isinstance(wall, dict) else []
    for key in ("block", "build", "import"):
        listed = data.get(key)
        tables += [one for one in listed if isinstance(one, dict)] if listed else []
    given = [one["material"] for one in tables if isinstance(one.get("material"), str)]
    names = list(dict.fromkeys(given)) or ["stone"]
    for one in tables:
        one.setdefault("material", names[0])
    return names
