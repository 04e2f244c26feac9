"""From a model file to a model."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from drystone.common.ranges import too_many
from drystone.engines import BUILT_IN, engine_names
from drystone.geometry import GeometryError
from drystone.io.modelfile.assessing import assessment_of, outside_problems, site_of
from drystone.io.modelfile.builds import BuildSection
from drystone.io.modelfile.groups import grouped
from drystone.io.modelfile.histories import history_in
from drystone.io.modelfile.holding import with_holders
from drystone.io.modelfile.imports import Imports, imports_of
from drystone.io.modelfile.loads import dead_loads_of, pattern_of
from drystone.io.modelfile.parse import parse
from drystone.io.modelfile.schema import (
    AnalysisSection,
    ExceptionSection,
    ModelSection,
    OutputSection,
)
from drystone.io.modelfile.sentences import place_of, sentences
from drystone.io.modelfile.shapes import ShapeError, shape_of, shape_problems
from drystone.io.modelfile.tying import settlement_of, ties_of
from drystone.model.assembly import GRAVITY, Block, Corner
from drystone.model.builders.placing import placed
from drystone.model.builders.wall import coursed_wall, unequal_courses
from drystone.model.construction.checks import law_problems
from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError
from drystone.model.construction.model import make_model
from drystone.model.construction.words import quoted, suggestion
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model

#: What is counted before any work on it, by the tables that it is listed in.
COUNTED = {
    "block": "blocks",
    "build": "blocks",
    "tie": "ties",
    "spring": "ties",
    "dead_load": "dead loads",
}
_LAW_KEYS = tuple(JointLaw.__dataclass_fields__)


def read_model(
    path: str | PathLike[str],
    *,
    need_stiffness: bool = True,
    need_engine: bool = True,
) -> Model:
    """Read a model file, TOML or JSON.

    Parameters
    ----------
    path
        Of the file; JSON if it ends in .json or begins with a brace.
    need_stiffness
        Whether joints must have stiffnesses. Limit analysis needs none.
    need_engine
        Whether the engine that [analysis] names must exist, in drystone or in another package.

    Raises
    ------
    ModelError
        The message has a sentence on everything that is wrong. Each names the file and the place.
    """
    path = Path(path)
    try:
        contents = read_bytes(path, "the model file")
        data = parse(contents, is_json=path.suffix.lower() == ".json")
        return _model(
            data,
            need_stiffness=need_stiffness,
            need_engine=need_engine,
            title=path.stem,
            source=str(path),
            sha256=hashlib.sha256(contents).hexdigest(),
        )
    except ModelError as error:
        raise ModelError(f"{path}: {problem}" for problem in error.problems) from None


def model_from_text(
    text: str,
    *,
    source: str | None,
    sha256: str,
    need_engine: bool = True,
    files: Mapping[str, str] | None = None,
) -> Model:
    """A model from the text of a file that was read before, such as results hold.

    Parameters
    ----------
    source, sha256
        Path of the file and digest of its bytes; without a path it is a model made in Python.
    need_engine
        As of `read_model`.
    files
        Texts of the files that it names, by their names, where no file is to be read.

    Raises
    ------
    ModelError
        The text is no model of this version.
    """
    return _model(
        parse(text.encode(), is_json=False),
        need_stiffness=False,
        need_engine=need_engine,
        title=Path(source).stem if source else "",
        source=source,
        sha256=sha256,
        files=files,
    )


def model_from_data(
    data: dict[str, Any],
    *,
    source: str | None,
    sha256: str,
    need_stiffness: bool = True,
    files: Mapping[str, str] | None = None,
    reshaped: Callable[[list[Block]], list[Block]] | None = None,
) -> Model:
    """A model from nested dicts and lists with the keys of a model file.

    Parameters
    ----------
    source, sha256
        Path of the file that they come from, and digest of what they hold.
    need_stiffness
        As of `read_model`.
    files
        As of `model_from_text`.
    reshaped
        Gives other blocks in place of those of the file, which may be fewer.

    Raises
    ------
    ModelError
        With a sentence on everything that was found wrong.
    """
    return _model(
        data,
        need_stiffness=need_stiffness,
        need_engine=True,
        title=Path(source).stem if source else "",
        source=source,
        sha256=sha256,
        files=files,
        reshaped=reshaped,
    )


# Long: one section of the file after another.
def _model(
    data: dict[str, Any],
    *,
    need_stiffness: bool,
    need_engine: bool,
    title: str,
    source: str | None,
    sha256: str,
    files: Mapping[str, str] | None = None,
    reshaped: Callable[[list[Block]], list[Block]] | None = None,
) -> Model:
    section = checked(data)
    folder, problems = str(Path(source).parent) if source else "", list[str]()
    if files is None:
        problems += outside_problems(section.site, section.assessment, Path(folder))
    elif section.imports:
        raise ModelError(["import: results hold no drawings"])
    blocks, places, imports = blocks_of(section, data, source, problems)
    if reshaped is not None and not problems:
        blocks = reshaped(blocks)
        places = [f"block {quoted(block.id)}" for block in blocks]
    control_block, control_point = section.control.block, section.control.point
    if imports.control and control_block is None and control_point is None:
        control_block, control_point = imports.control
    joint, between = _laws(section, blocks, need_stiffness, problems)
    section = with_holders(section, blocks, problems)
    history, of_history = history_in(section.control, folder, problems, files)
    engine = section.analysis.engine
    if need_engine and engine not in BUILT_IN and engine not in (known := engine_names()):
        problems.append(
            f"analysis.engine: there is no engine {quoted(engine)}: {suggestion(engine, known)}"
        )
    if problems:
        raise ModelError(problems)
    if digests := (*imports.digests, *of_history):
        sha256 = hashlib.sha256("".join((sha256, *digests)).encode()).hexdigest()
    return _made(
        blocks,
        imports.notes,
        joint=joint,
        joint_between=between,
        corner=corner_of(section),
        thickness=section.thickness,
        points=section.contact.points if section.contact else None,
        load=pattern_of(section.load, section.dimension) if section.load else None,
        settlement=settlement_of(section.settlement, section.dimension),
        dead_loads=dead_loads_of(section.dead_load, section.dimension),
        ties=ties_of(section.tie, section.spring),
        control_block=control_block,
        control_point=control_point,
        control_direction=section.control.direction,
        history=history,
        analysis=_analysis(section.analysis, section.output),
        title=title if section.title is None else section.title,
        source=source,
        sha256=sha256,
        place=lambda i: places[i],
        drawing_tolerance=section.drawing_tolerance,
        notes=_notes(section),
        mended=imports.mended,
        site=site_of(section.site, folder, files),
        assessment=assessment_of(section.assessment, folder, files),
    )


def _made(blocks: list[Block], of_imports: list[str], notes: list[str], **given: Any) -> Model:
    """The model of blocks; where none of them can move, what drawings left out is told as well."""
    try:
        return make_model(blocks, notes=[*notes, *of_imports], **given)
    except ModelError as error:
        told = of_imports if all(block.support for block in blocks) else []
        raise ModelError([*error.problems, *told]) from None


def corner_of(section: ModelSection) -> Corner:
    """How corners are treated."""
    return Corner(radius=section.corner.radius or None, chamfer=section.corner.chamfer or None)


def _analysis(section: AnalysisSection, outputs: Sequence[OutputSection]) -> Analysis:
    return Analysis(
        engine=section.engine,
        strategy=section.strategy,
        stop_multiplier=section.stop_multiplier,
        ground=section.ground,
        falling=section.falling,
        event_share=section.event_share,
        max_penetration=section.max_penetration,
        options=section.options,
        outputs=tuple((output.kind, output.given) for output in outputs),
    )


def checked(data: dict[str, Any]) -> ModelSection:
    """The file's keys, types and ranges, and which shapes its blocks have."""
    given = data.get("dimension")
    for key, what in COUNTED.items():
        listed = data.get(key)
        if isinstance(listed, list) and (wrong := too_many(what, len(listed))):
            raise ModelError([f"{key}: the model {wrong}"])
    dimension = given if given in (2, 3) and not isinstance(given, bool) else None
    problems = shape_problems(data, dimension)
    try:
        section = ModelSection.model_validate(data, context={"dimension": dimension})
    except ValidationError as error:
        problems = sentences(error, data) + problems
    if problems:
        raise ModelError(problems)
    return section


def blocks_of(
    section: ModelSection, data: dict[str, Any], source: str | None, problems: list[str]
) -> tuple[list[Block], list[str], Imports]:
    """All blocks with their groups, the place of each for messages, and what was imported; what is
    wrong is added to ``problems``."""
    blocks, places = _blocks(section, data, problems)
    imports = imports_of(section, _unit_weights(section), source, problems)
    blocks = grouped([*blocks, *imports.blocks], section.group, problems)
    return blocks, [*places, *imports.places], imports


def _blocks(
    section: ModelSection, data: dict[str, Any], problems: list[str]
) -> tuple[list[Block], list[str]]:
    """Blocks of [wall], of [[build]] and of [[block]], and the place of each in the file."""
    unit_weights = _unit_weights(section)
    material_of = partial(_material, list(unit_weights), problems)
    blocks, places = [], []
    if section.wall:
        wall = section.wall
        material = material_of(wall.material, "wall.material")
        blocks = coursed_wall(
            unit=wall.unit,
            courses=wall.courses,
            repeat=wall.repeat,
            base=wall.base,
            origin=wall.origin,
            unit_weight=unit_weights[material],
            material=material,
        )
        places = [f"wall block {quoted(block.id)}" for block in blocks]
    for i, build in enumerate(section.build):
        place = place_of(("build", i), data)
        material = material_of(build.material, f"{place} material")
        made = built(section.build, i, unit_weights[material], material, place, problems)
        places += [f"{place} block {quoted(block.id)}" for block in made]
        blocks += made
    for i, block in enumerate(section.block):
        place = place_of(("block", i), data)
        material = material_of(block.material, f"{place} material")
        try:
            shape = shape_of(block)
        except ShapeError as error:
            problems.append(f"{place} {error.key}: {error}")
            continue
        places.append(place)
        blocks.append(
            Block(
                id=block.id,
                unit_weight=unit_weights[material],
                material=material,
                support=block.support,
                held=tuple(block.held),
                groups=tuple(dict.fromkeys(block.groups)),
                **shape,
            )
        )
    return blocks, places


def _unit_weights(section: ModelSection) -> dict[str, float]:
    """Of the materials by their names [N/m3]."""
    return {
        name: (material.density or 0.0) * GRAVITY
        if material.unit_weight is None
        else material.unit_weight
        for name, material in section.material.items()
    }


def _material(known: list[str], problems: list[str], name: str | None, place: str) -> str:
    """The material of a name, or the only one; what is wrong is added to ``problems``."""
    if name is None:
        if len(known) > 1:
            problems.append(f"{place} is missing: with several materials, name one of them")
        return known[0]
    if name not in known:
        problems.append(f"{place}: there is no material {quoted(name)}: {suggestion(name, known)}")
        return known[0]
    return name


def built(
    tables: Sequence[BuildSection], i: int, unit_weight: float, material: str, place: str,
    problems: list[str],
) -> list[Block]:  # fmt: skip
    """The blocks of a [[build]] in their place; what is wrong with it is added to ``problems``."""
    table = tables[i]
    names = [other.name or other.kind for other in tables]
    name = names[i]
    if name in names[:i]:
        first = names.index(name) + 1
        problems.append(
            f"{place} name: {quoted(name)} is taken by build[{first}]: give it a name of its own"
        )
        return []
    try:
        return placed(
            table.blocks(unit_weight, material),
            name=name,
            group=table.group or "",
            prefix=len(tables) > 1,
            origin=table.origin,
            rotation=table.rotation,
            base=table.base,
        )
    except ModelError as error:
        problems += [f"{place} {problem}" for problem in error.problems]
    except GeometryError as error:
        problems.append(f"{place}: {error}")
    return []


def _notes(section: ModelSection) -> list[str]:
    """Sentences on what the file allows but hardly means."""
    uneven = unequal_courses(section.wall.courses) if section.wall else None
    return [f"wall.{uneven}"] if uneven else []


def _laws(
    section: ModelSection, blocks: Sequence[Block], need_stiffness: bool, problems: list[str]
) -> tuple[JointLaw, dict[frozenset[str], JointLaw]]:
    """The law of every joint, and the exceptions by pair."""
    given = _given(section.joint)
    values: dict[str, Any] = {"normal_stiffness": None, "shear_stiffness": None, **given}
    joint = JointLaw(**values)
    if need_stiffness:
        problems.extend(
            f"joint: {key} is missing: add it in Pa/m, a stiffness per area, as in {key} = 1e8"
            for key in ("normal_stiffness", "shear_stiffness")
            if getattr(joint, key) is None
        )
    ids = {block.id for block in blocks}
    groups = frozenset(name for block in blocks for name in block.groups)
    in_use = ids | groups | {block.material for block in blocks}
    between: dict[frozenset[str], JointLaw] = {}
    for key, exception in section.joint.between.items():
        place = place_of(("joint", "between", key), {})
        try:
            names = pair_named(key, ids, set(section.material), groups)
        except ModelError as error:
            problems.extend(f"{place}: {problem}" for problem in error.problems)
            continue
        if names in between:
            problems.append(f"{place}: this pair has a law already: take one of the two out")
        law = JointLaw(**{**vars(joint), **_given(exception)})
        problems.extend(f"{place}.{problem}" for problem in law_problems(law))
        between[names] = law
    # A file may hold the laws of materials that this wall is not made of.
    return joint, {names: law for names, law in between.items() if names <= in_use}


def _given(section: ExceptionSection) -> dict[str, float]:
    values = {key: getattr(section, key) for key in _LAW_KEYS}
    given = {key: float(value) for key, value in values.items() if value is not None}
    return given | section.mortar.stiffnesses() if section.mortar else given


def pair_named(
    key: str, ids: set[str], materials: set[str], groups: frozenset[str] = frozenset()
) -> frozenset[str]:
    """The two blocks or groups, or the two materials, that ``key`` names with a space between.

    Names may hold spaces themselves, as long as only one way of reading the key makes sense.
    """
    words = key.split(" ")
    readings = [(" ".join(words[:k]), " ".join(words[k:])) for k in range(1, len(words))]
    fitting = {
        frozenset(names)
        for names in readings
        if (names[0] != names[1] and ids.issuperset(names))
        or (not groups.isdisjoint(names) and groups.union(ids).issuperset(names))
        or materials.issuperset(names)
    }
    if len(fitting) == 1:
        return fitting.pop()
    if fitting:
        raise ModelError(["can be read as more than one pair: rename one of them without spaces"])
    if len(readings) != 1:
        raise ModelError(['must name two blocks, groups or materials that exist, as in "a b"'])
    known = sorted(materials) + sorted(groups) + sorted(ids)
    unknown = [name for name in dict.fromkeys(readings[0]) if name not in known]
    if unknown:
        what = "block, group or material" if groups else "block or material"
        raise ModelError(
            f"there is no {what} {quoted(name)}: {suggestion(name, known)}" for name in unknown
        )
    if readings[0][0] == readings[0][1]:
        raise ModelError(["names the same block twice: name the two blocks that meet"])
    raise ModelError(
        ["names a block or a group and a material: name two blocks or groups, or two materials"]
    )
