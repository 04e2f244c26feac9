"""``drystone assess``: limit states and verdict from a curve, by [site] and [assessment]."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drystone.cli.options import AsJson, Language, Quiet
from drystone.cli.outcome import DONE, UNFINISHED, emit, fail, outcome, tell
from drystone.cli.senses import Sense, Tracing, traced, worst
from drystone.common.language import speaking

if TYPE_CHECKING:
    from drystone.assessment.verdict import Verdict
    from drystone.model.model import Model

Source = Annotated[
    Path,
    typer.Argument(
        metavar="MODEL|DIR", help="Model file, or a folder of results.", show_default=False
    ),
]


class Picture(StrEnum):
    """Formats of the picture beside SVG, which need more time."""

    png = "png"
    pdf = "pdf"


def _text(name: str, what: str, metavar: str = "NAME") -> Any:
    return typer.Option(name, metavar=metavar, help=what, show_default=False)


def _number(name: str, what: str) -> Any:
    return typer.Option(name, metavar="X", help=what, show_default=False)


# Many: the keys of two tables of the model file, each an option.
def assess(
    source: Source,
    method: Annotated[str | None, _text("--method", "Method, for instance ntc2018-local.")] = None,
    reading: Annotated[str | None, _text("--reading", "base_shear, energy or literal_ec8.")] = None,
    grouping: Annotated[
        str | None, _text("--grouping", "Bodies of the mechanism: macro_blocks or blocks.")
    ] = None,
    confidence_factor: Annotated[
        float | None, _number("--confidence-factor", "Confidence factor FC.")
    ] = None,
    code: Annotated[str | None, _text("--code", "Spectrum: ntc2018, ec8 or csv.")] = None,
    ag: Annotated[float | None, _number("--ag", "Ground acceleration on rock [g].")] = None,
    F0: Annotated[float | None, _number("--F0", "ntc2018: amplification F0.")] = None,
    TC_star: Annotated[
        float | None, _number("--TC-star", "ntc2018: corner period TC* [s].")
    ] = None,
    soil: Annotated[str | None, _text("--soil", "ntc2018: A to E.")] = None,
    topography: Annotated[str | None, _text("--topography", "ntc2018: T1 to T4.")] = None,
    spectrum_type: Annotated[int | None, _number("--type", "ec8: 1 or 2.")] = None,
    ground: Annotated[str | None, _text("--ground", "ec8: A to E.")] = None,
    importance: Annotated[
        str | None, _text("--importance", "ec8: class I to IV, or the factor.")
    ] = None,
    spectrum: Annotated[
        Path | None, _text("--spectrum", "csv: table with the header T,Se.", "FILE")
    ] = None,
    unit: Annotated[str | None, _text("--unit", "csv: g or m/s2.")] = None,
    damping: Annotated[float | None, _number("--damping", "csv: damping of the table [%].")] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Any key of [site] or [assessment], for instance site.SLD.ag=0.07; may be "
            "repeated.",
            show_default=False,
        ),
    ] = None,
    model_file: Annotated[
        Path | None,
        _text("--model", "Take [site] and [assessment] from this model file.", "FILE"),
    ] = None,
    language: Annotated[
        Language | None,
        typer.Option("--language", help="Language of sentences and pictures.", show_default=False),
    ] = None,
    engine: Annotated[
        str | None, _text("--engine", "For a MODEL: engine. [default: what the model says]")
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", help="For a MODEL: continue both senses from what the folder holds."
        ),
    ] = False,
    one_sense: Annotated[
        bool, typer.Option("--one-sense", help="For a MODEL: do not push in the opposite sense.")
    ] = False,
    out: Annotated[
        Path | None,
        _text("--out", "Folder to write. [default: DIR, or MODEL-results]", "DIR"),
    ] = None,
    figures: Annotated[
        list[Picture] | None,
        typer.Option(
            "--figures",
            help="The picture in this format as well as in SVG; may be repeated.",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Compute limit states and a verdict from a curve, by the model's [site] and [assessment].

    A MODEL is pushed first, along its load and against it. The worse sense governs.
    """
    given = {
        "site": {
            "code": code,
            "ag": ag,
            "F0": F0,
            "TC_star": TC_star,
            "soil": soil,
            "topography": topography,
            "type": spectrum_type,
            "ground": ground,
            "importance": _factor(importance),
            "file": None if spectrum is None else str(spectrum.resolve()),
            "unit": unit,
            "damping": damping,
        },
        "assessment": {
            "method": method,
            "reading": reading,
            "grouping": grouping,
            "confidence_factor": confidence_factor,
            "language": None if language is None else language.value,
        },
    }
    with outcome(as_json=as_json):
        overlay = _with_settings(given, settings or [])
        ask = Tracing(
            source=source,
            out=out,
            engine=engine,
            one_sense=one_sense,
            resume=resume,
            quiet=quiet or as_json,
            as_json=as_json,
        )
        senses = traced(ask, lambda model: _loaded(with_tables(model, overlay, model_file)))
        formats = tuple(picture.value for picture in figures or ())
        with speaking(language_of(senses[0].model)):
            _conclude(senses, formats, as_json=as_json)
    raise typer.Exit(DONE)


def _loaded(model: Model) -> Model:
    """The model, if it has a load; raises `AssessmentError`."""
    from drystone.assessment.request import check_load

    check_load(model)
    return model


def with_tables(model: Model, overlay: Mapping[str, Any], model_file: Path | None) -> Model:
    """The model with the tables of another file, and with what the command line says over them."""
    from dataclasses import replace

    from drystone.io.modelfile.assessing import tables_of

    site, assessment = model.site, model.assessment
    if model_file is not None:
        from drystone.io.modelfile import read_model

        other = read_model(model_file, need_stiffness=False)
        site, assessment = other.site or site, other.assessment or assessment
    if not overlay:
        return replace(model, site=site, assessment=assessment)
    data: dict[str, Any] = {}
    over = overlay.get("site", {})
    if site is not None and over.get("code", site.code) == site.code:
        data["site"] = site.as_dict()
    if assessment is not None:
        data["assessment"] = assessment.as_dict()
    new_site, new_assessment = tables_of(_merged(data, overlay))
    if site is not None and site.files is not None and new_site is not None:
        new_site = replace(new_site, files={**site.files, **_texts(overlay)})
    if assessment is not None and assessment.files is not None and new_assessment is not None:
        new_assessment = replace(new_assessment, files={**assessment.files, **_texts(overlay)})
    return replace(model, site=new_site, assessment=new_assessment)


def _texts(overlay: Mapping[str, Any]) -> dict[str, str]:
    """Texts of the files that the command line names; raises `ModelError`."""
    from drystone.io.modelfile import ModelError
    from drystone.io.modelfile.named import files_named
    from drystone.model.construction.contents import read_bytes

    found = {}
    for name in files_named(overlay):
        try:
            found[name] = read_bytes(Path(name), "the table").decode("utf-8")
        except ModelError as error:
            raise ModelError(f"{name} {problem}" for problem in error.problems) from None
        except UnicodeDecodeError:
            raise ModelError([f"{name} is no table of text: write it as CSV in UTF-8"]) from None
    return found


def _with_settings(
    given: Mapping[str, Mapping[str, Any]], settings: Sequence[str]
) -> dict[str, Any]:
    """Tables of what the command line says."""
    from drystone.io.modelfile import ModelError

    tables: dict[str, Any] = {}
    for table, keys in given.items():
        said = {key: value for key, value in keys.items() if value is not None}
        if said:
            tables[table] = said
    for setting in settings:
        left, equals, text = setting.partition("=")
        path = left.strip().split(".")
        if not equals or path[0] not in ("site", "assessment") or len(path) < 2:
            raise ModelError(
                [f"--set: {setting}: write it as site.KEY=VALUE or assessment.KEY=VALUE"]
            )
        inner: Any = text.strip()
        with suppress(tomllib.TOMLDecodeError):  # else a word without quotes
            inner = tomllib.loads(f"value = {text}")["value"]
        for name in reversed(path):
            inner = {name: inner}
        tables = _merged(tables, inner)
    return tables


def _merged(data: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Tables with others over them, key by key."""
    merged = dict(data)
    for key, value in over.items():
        both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping)
        merged[key] = _merged(merged[key], value) if both else value
    return merged


def _factor(importance: str | None) -> str | float | None:
    """A class, or the factor in figures."""
    try:
        return None if importance is None else float(importance)
    except ValueError:
        return importance


def _conclude(senses: Sequence[Sense], formats: Sequence[str], *, as_json: bool) -> None:
    """Write files, tell what was found, and end with status 3 where there is no verdict.

    In the language that is spoken.
    """
    from drystone.common.language import spoken
    from drystone.report.folder.assessment import write_assessment, written

    first, governing = senses[0], worst(senses)
    found = {sense.name: sense.as_dict() for sense in senses}
    result = {
        "title": first.model.title,
        **found[governing.name],
        "governing_sense": governing.name,
        "senses": {name: _without_curves(data) for name, data in found.items()},
        "model_sha256": first.sha256,
        "site": None if first.model.site is None else first.model.site.as_dict(),
        "assessment": (
            None if first.model.assessment is None else first.model.assessment.as_dict()
        ),
        "directory": str(first.folder),
    }
    tell([f"warning: {spoken(note)}" for sense in senses for note in sense.warnings])
    pictures: dict[str, Callable[[Path], None]] = {}
    if governing.verdict is not None:
        pictures = _pictures(governing.verdict, first.model.title, formats)
    result = written(result)
    write_assessment(first.folder, result, pictures)
    if governing.verdict is None:
        problems = [spoken(first.problem or "there is no verdict")]
        fail(UNFINISHED, problems, as_json=as_json, extra=result)
    if as_json:
        emit(result)
    else:
        from drystone.cli.assess_report import report

        typer.echo(report(senses, governing, first.folder, tuple(pictures)))


def language_of(model: Model | None) -> str:
    """The language that a model asks for in [assessment]; English else."""
    asked = None if model is None else model.assessment
    return "en" if asked is None else str(asked.values.get("language", "en"))


def _pictures(
    verdict: Verdict, title: str, formats: Sequence[str]
) -> dict[str, Callable[[Path], None]]:
    """What draws capacity and demand, by file names."""
    from drystone.report.adrs_figure import draw_adrs

    return {
        f"adrs.{name}": partial(draw_adrs, verdict.assessment, title=title, format=name)
        for name in ("svg", *formats)
    }


def _without_curves(data: Mapping[str, Any]) -> dict[str, Any]:
    """What a sense says, but for what is long."""
    long = ("mechanism", "spectral_displacement", "spectral_acceleration")
    return {key: value for key, value in data.items() if key not in long}
