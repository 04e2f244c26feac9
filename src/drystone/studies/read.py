"""From a study file to a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from drystone.common.arrays import Array
from drystone.common.names import quoted, suggestion
from drystone.engines import BUILT_IN, engine_names
from drystone.io.modelfile.parse import parse
from drystone.io.modelfile.sentences import sentences
from drystone.model.construction.contents import is_outside, read_bytes
from drystone.model.construction.describe import model_to_dict
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model
from drystone.studies import paths
from drystone.studies.designs import count, sharing
from drystone.studies.distributions import (
    Choices,
    DistributionError,
    Law,
    Uniform,
    continuous,
)
from drystone.studies.errors import StudyError
from drystone.studies.schema import MOST_SAMPLES, ParameterSection, StudySection, VariedSection
from drystone.studies.study import ABOUT, COLUMNS, REACTIONS, Imperfection, Parameter, Study, Task


def read_study(
    source: str | PathLike[str] | Mapping[str, Any],
    *,
    model: str | PathLike[str] | None = None,
    function: str | None = None,
    files: Mapping[str, str] | None = None,
) -> Study:
    """Read a study: a file, TOML or JSON, or its keys as a dict.

    A study of somebody else may name any file of whoever runs it: a file names a model and a
    function of its own folder and below alone.

    Parameters
    ----------
    source
        ``model`` of a dict may be a `Model`, too.
    model, function
        In place of those that the study names, and from anywhere.
    files
        Texts of the files that the model names, by their names, where no file is to be read.

    Raises
    ------
    StudyError
        With a sentence on everything that was found wrong; each names the file and the place.
    """
    path = None
    try:
        if isinstance(source, Mapping):
            data = dict(source)
        else:
            path = Path(source)
            contents = read_bytes(path, "the study file")
            data = parse(contents, is_json=path.suffix.lower() == ".json")
        told = {"model": model if model is None else str(model), "function": function}
        told = {key: value for key, value in told.items() if value is not None}
        if told:
            data = {key: data[key] for key in data if key not in ("model", "function")} | told
        return _study(data, path, files, held=path is not None and not told)
    except ModelError as error:
        before = f"{path}: " if path is not None else ""
        raise StudyError(f"{before}{problem}" for problem in error.problems) from None


def _study(
    data: dict[str, Any], path: Path | None, files: Mapping[str, str] | None, *, held: bool
) -> Study:
    """A study of its keys; ``held`` to the folder of its file."""
    if isinstance(data.get("model"), Model):
        data = {**data, "model": model_to_dict(data["model"])}
    try:
        section = StudySection.model_validate(data)
    except ValidationError as error:
        raise StudyError(sentences(error, data, StudySection)) from None
    folder = path.parent if path is not None else Path()
    problems: list[str] = []
    document, model_source = _model(section, folder, problems, held=held)
    module = _module(section.function, folder, problems) if held and section.function else None
    varied: Sequence[VariedSection] = section.target.parameter if section.target else ()
    place = "target.parameter" if section.target else "parameter"
    varied = varied or section.parameter
    parameters = _parameters(varied, document, place, problems)
    laws = _laws(section, problems)
    correlation = _correlation(section, parameters, problems)
    design = section.design or ("lhs" if section.samples else "grid")
    steps = tuple(parameter.steps for parameter in section.parameter)
    _check_design(section, design, laws, steps, problems)
    _check_engine(section, problems)
    if problems:
        raise StudyError(problems)
    task = Task(
        model=document,
        function=section.function,
        folder=str(folder),
        source=model_source,
        module=module,
        files=files,
        parameters=tuple(parameters),
        outputs=tuple(dict.fromkeys(section.outputs)),
        seed=section.seed,
        shared=() if section.target else sharing(design, len(parameters), section.second_order),
        engine=section.engine,
        strategy=section.strategy,
        points=section.points,
        timeout=section.timeout,
        imperfection=_imperfection(section),
    )
    return Study(
        title=section.title or (path.stem if path is not None else "study"),
        design=design,
        n=section.samples or 1,
        task=task,
        laws=tuple(laws),
        steps=steps,
        levels=section.levels,
        second_order=section.second_order,
        correlation=correlation,
        fragility=tuple(one.model_dump() for one in section.fragility),
        target=section.target.model_dump() if section.target else None,
        given=data,
        source=path,
    )


def _model(
    section: StudySection, folder: Path, problems: list[str], *, held: bool
) -> tuple[dict[str, Any] | None, str | None]:
    """The model file as a dict, and where it stands; what is wrong is added to ``problems``."""
    if section.model is None or isinstance(section.model, dict):
        return section.model, None
    path = folder / section.model if held else Path(section.model)
    if held and is_outside(folder, section.model):
        problems.append(
            f"model: {quoted(section.model)} lies outside of the study file's folder, and a study "
            "names files in its own folder and below alone: copy it there, or name it in the "
            "command, --model FILE"
        )
        return None, None
    try:
        contents = read_bytes(path, "the model file")
        return parse(contents, is_json=path.suffix.lower() == ".json"), str(path)
    except ModelError as error:
        problems += [f"model: {quoted(section.model)} {problem}" for problem in error.problems]
        return None, str(path)


def _module(function: str, folder: Path, problems: list[str]) -> str | None:
    """The file of a function's module in the folder of its study."""
    name = function.partition(":")[0].replace(".", "/") + ".py"
    path = folder / name
    if is_outside(folder, name) or not path.is_file():
        problems.append(
            f"function: there is no {quoted(name)} in the study file's folder, and a study names "
            "functions of its own folder and below alone: put it there, or name the function in "
            "the command, --function MODULE:NAME"
        )
        return None
    return str(path)


def _parameters(
    varied: Sequence[VariedSection],
    document: dict[str, Any] | None,
    place: str,
    problems: list[str],
) -> list[Parameter]:
    found: list[Parameter] = []
    for i, one in enumerate(varied, start=1):
        texts = [one.path] if isinstance(one.path, str) else one.path
        here = f"{place}[{i}] path: {quoted(texts[0])}"
        keys: list[paths.Keys] = []
        for text in texts:
            try:
                if document is not None:
                    keys.append(paths.check(text, document))
            except paths.PathError as error:
                problems.append(f"{place}[{i}] path: {quoted(text)} {error}")
        if one.apply != "set" and document is not None:
            for text, where in zip(texts, keys, strict=False):
                if not paths.is_numeric(paths.value_at(document, where)):
                    problems.append(
                        f"{place}[{i}] path: {quoted(text)} holds no number in the model file that "
                        f'apply = "{one.apply}" could change: give it there'
                    )
        name = one.name or texts[0]
        taken = [*ABOUT, *REACTIONS, *(column for names in COLUMNS.values() for column in names)]
        if name in taken or any(name == other.name for other in found):
            problems.append(f"{here}: the name {quoted(name)} is taken: give it another name")
        found.append(Parameter(name=name, paths=tuple(keys), apply=one.apply))
    return found


def _laws(section: StudySection, problems: list[str]) -> list[Law]:
    laws: list[Law] = []
    for i, one in enumerate(section.parameter, start=1):
        try:
            laws.append(_law(one))
        except DistributionError as error:
            place = "distribution" if one.range is None else "range"
            problems.append(f"parameter[{i}] {place}: {error}")
            laws.append(Choices(values=(0.0,)))
    return laws


def _law(one: ParameterSection) -> Law:
    if one.values is not None:
        return Choices(values=tuple(one.values))
    if one.range is not None:
        return Uniform(low=one.range[0], high=one.range[1], whole=one.whole)
    return continuous(
        one.distribution or "",
        mean=one.mean,
        std=one.std,
        shapes=one.shapes,
        bounds=one.bounds,
    )


def _correlation(
    section: StudySection, parameters: Sequence[Parameter], problems: list[str]
) -> Array | None:
    """The matrix of correlations; None where there are none."""
    if not section.correlation:
        return None
    names = [parameter.name for parameter in parameters]
    matrix = np.eye(len(names))
    for i, one in enumerate(section.correlation, start=1):
        unknown = [name for name in one.between if name not in names]
        if unknown:
            problems.append(
                f"correlation[{i}] between: there is no parameter {quoted(unknown[0])}: "
                f"{suggestion(unknown[0], names)}"
            )
            continue
        a, b = (names.index(name) for name in one.between)
        matrix[a, b] = matrix[b, a] = one.value
    if np.linalg.eigvalsh(matrix).min() <= 1e-12:
        problems.append(
            "correlation: no parameters are correlated like this (the matrix is not positive "
            "definite): take smaller values"
        )
    if section.design in ("grid", "saltelli", "morris"):
        problems.append(
            f'correlation: design = "{section.design}" takes parameters as independent: choose '
            '"lhs", "sobol" or "random"'
        )
    return matrix


def _check_design(
    section: StudySection,
    design: str,
    laws: Sequence[Law],
    steps: Sequence[int | None],
    problems: list[str],
) -> None:
    if section.target is not None:
        return
    if not section.parameter and section.imperfection is None:
        problems.append("parameter is missing: add [[parameter]] with its path and its values")
    if design == "grid":
        if section.samples is not None:
            problems.append(
                'samples: design = "grid" has as many as its values: give steps of [[parameter]]'
            )
        most = count(design, 1, laws, steps, False)
        if most > MOST_SAMPLES:
            problems.append(f"design: the grid has {most:,} samples: take fewer steps")
        return
    if section.samples is None:
        problems.append(f'samples is missing: design = "{design}" needs it, as in samples = 1024')
    elif design in ("sobol", "saltelli") and section.samples & (section.samples - 1):
        below = 1 << (section.samples.bit_length() - 1)
        problems.append(
            f'samples: design = "{design}" is balanced for powers of 2 alone: take {below} or '
            f"{2 * below}"
        )
    if design == "morris" and section.levels % 2:
        problems.append(f"levels: must be even, it is {section.levels}")


def _check_engine(section: StudySection, problems: list[str]) -> None:
    engine = section.engine
    if engine is not None and engine not in BUILT_IN and engine not in (known := engine_names()):
        problems.append(f"engine: there is no engine {quoted(engine)}: {suggestion(engine, known)}")


def _imperfection(section: StudySection) -> Imperfection | None:
    if section.imperfection is None:
        return None
    given = section.imperfection.model_dump()
    return Imperfection(**{**given, "blocks": tuple(given["blocks"])})
