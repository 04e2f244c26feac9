"""The senses of a load that an assessment looks at: traced, or read from folders of results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drystone.cli.outcome import INTERRUPTED, fail
from drystone.common.language import said_end, said_status, say
from drystone.io.results.names import RESULTS
from drystone.io.results.senses import FORWARD, OPPOSITE, OPPOSITE_FOLDER

if TYPE_CHECKING:
    from drystone.assessment.verdict import Verdict
    from drystone.model.model import Model
    from drystone.results.curve import CapacityCurve

#: Figures of a capacity that stand in files also where there is no verdict; the last one by d*.
FIGURES = (
    "activation_multiplier",
    "participating_mass_ratio",
    "participating_mass",
    "participation_factor",
    "activation_acceleration",
    "collapse_displacement",
)


@dataclass(frozen=True, kw_only=True)
class Sense:
    """A curve in one sense of the load, and the verdict on it."""

    name: str
    model: Model
    folder: Path
    curve: CapacityCurve | None  # in this sense
    verdict: Verdict | None
    traced: CapacityCurve | None = None  # of a cyclic one both senses
    sha256: str = ""  # digest of what was traced, as in the folder
    problem: str | None = None  # why there is no verdict
    warnings: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """What a file holds of it."""
        if self.verdict is not None:
            return {"status": "assessed", **self.verdict.as_dict()}
        data: dict[str, Any] = {"status": "no verdict", "reason": self.problem}
        if self.curve is not None:
            data |= _partial(self.curve, self.model)
        return data


@dataclass(frozen=True, kw_only=True)
class Tracing:
    """How a model file is traced, and what is told meanwhile."""

    source: Path  # the model file, or a folder that needs no tracing
    out: Path | None
    engine: str | None
    one_sense: bool
    quiet: bool
    as_json: bool
    resume: bool = False  # go on with what the folder holds


def traced(ask: Tracing, amended: Callable[[Model], Model]) -> list[Sense]:
    """The senses of a model file, which are traced, or of a folder of results.

    What is asked for is looked at before anything is traced.  Errors of the input are raised; a
    curve that does not go far enough for a verdict is told in its `Sense`.
    """
    if ask.source.is_dir():
        if ask.resume:
            from drystone.io.results.folder import OutputError

            raise OutputError(
                f"--resume: {ask.source} is a folder: name the model file, and the folder by --out"
            )
        return _with_cautions(_said_if_one(_of_folder(ask, amended)))
    return _with_cautions(_said_if_one(_of_model(ask, amended)))


def _of_model(ask: Tracing, amended: Callable[[Model], Model]) -> list[Sense]:
    """The senses of a model file, traced."""
    source = ask.source
    from drystone.assessment.request import check_request, request_of
    from drystone.io.modelfile import read_model

    model = amended(read_model(source))
    check_request(request_of(model.site, model.assessment))  # better known before the work
    folder = ask.out or Path(f"{source.stem}-results")
    first = _traced_one(FORWARD, model, folder, ask)
    if not _both(ask, model):
        return [first]
    if first.traced is not None and first.traced.is_cyclic:
        return [first, _judged_against(model, first.traced, folder, first.sha256)]
    # Of the model that was traced: its control point may have been moved.
    return [first, _traced_opposite(model, folder / OPPOSITE_FOLDER, ask, part_of=first.sha256)]


def _both(ask: Tracing, model: Model) -> bool:
    """Whether both senses are asked for."""
    asked = True if model.assessment is None else model.assessment.values.get("opposite", True)
    return bool(asked) and not ask.one_sense


def _judged_against(model: Model, curve: CapacityCurve, folder: Path, sha256: str) -> Sense:
    """The verdict on the envelope of a cyclic curve against the load."""
    from drystone.assessment.verdict import turned
    from drystone.model.construction.errors import ModelError

    try:
        turned(model)
    except (ModelError, ValueError) as error:  # of a pattern of one sense the last
        return _refused(model, folder, error)
    return _judged(OPPOSITE, model, curve, folder, sha256, against=True)


def _said_if_one(senses: list[Sense]) -> list[Sense]:
    """The same; where one alone has a verdict it says so before all else."""
    known = [sense for sense in senses if sense.verdict is not None]
    if len(known) != 1:
        return senses
    from drystone.assessment.verdict import of_one_sense

    only = known[0]
    assert only.verdict is not None
    why = next((sense.problem for sense in senses if sense.problem), "")
    said = replace(only, verdict=of_one_sense(only.verdict, only.name, why))
    return [said if sense is only else sense for sense in senses]


def _with_cautions(senses: list[Sense]) -> list[Sense]:
    """The same; the verdict of the sense that governs says what goes with that of another."""
    from drystone.assessment.verdict import sense_words

    governing = worst(senses)
    cautious = [s for s in senses if s.verdict is not None and s.verdict.assessment.caution]
    if governing.verdict is None or governing.verdict.assessment.caution or not cautious:
        return senses
    other = cautious[0]
    assert other.verdict is not None
    said = say(
        "verdict.caution_of",
        sense=sense_words(other.name),
        caution=other.verdict.assessment.caution,
    )
    answer = replace(governing.verdict.assessment, caution=said)
    told = replace(governing, verdict=replace(governing.verdict, assessment=answer))
    return [told if sense is governing else sense for sense in senses]


def worst(senses: Sequence[Sense]) -> Sense:
    """The sense that governs: one that fails before those that hold, then by the safety index.

    One without a verdict never does.
    """
    from drystone.assessment.verdict import severity

    known = [(severity(sense.verdict), sense) for sense in senses if sense.verdict is not None]
    return min(known, key=lambda one: one[0])[1] if known else senses[0]


def _of_folder(ask: Tracing, amended: Callable[[Model], Model]) -> list[Sense]:
    """The senses of a folder of results."""
    from drystone.report.folder.results import Results, check_opposite, load_results

    source, out = ask.source, ask.out

    def judged(results: Results, name: str) -> Sense:
        if results.model is None:
            from drystone.io.results.folder import OutputError

            raise OutputError(
                f"{results.path}: the model in it cannot be read by this version: trace it again, "
                "or assess the model file"
            )
        model = amended(results.model)
        return _judged(name, model, results.curve, out or source, results.sha256)

    forward = load_results(source)
    senses = [judged(forward, FORWARD)]
    if (source / OPPOSITE_FOLDER).is_dir():
        opposite = load_results(source / OPPOSITE_FOLDER)
        check_opposite(opposite, forward)
        senses.append(judged(opposite, OPPOSITE))
    elif forward.curve.is_cyclic and _both(ask, senses[0].model):
        senses.append(
            _judged_against(senses[0].model, forward.curve, out or source, forward.sha256)
        )
    return senses


def _traced_one(name: str, model: Model, folder: Path, ask: Tracing, *, part_of: str = "") -> Sense:
    """A model traced into a folder, and judged; ``part_of`` as of `ResultsDirectory`."""
    from drystone.analysis.driver import pushover
    from drystone.cli.compiler import compiling
    from drystone.common.progress import progress_for
    from drystone.io.results.folder import check_apart, check_writable
    from drystone.limit import limits_beside, on_what_moves
    from drystone.model.model import STOP
    from drystone.report.folder.directory import ResultsDirectory, files_of

    if ask.resume and (folder / RESULTS).is_file():
        return _resumed(name, model, folder, ask, part_of=part_of)
    check_writable(folder)
    check_apart(ask.source, files_of(folder))
    stop = model.analysis.stop_multiplier
    engine = ask.engine or model.analysis.engine
    with compiling(engine, model.assembly.dimension, quiet=ask.quiet):
        beside = limits_beside(model)
        model = on_what_moves(model, beside)
        with (
            ResultsDirectory(folder, beside=beside, part_of=part_of) as results,
            progress_for(f"{ask.source.stem}, {name}", stop, quiet=ask.quiet) as progress,
        ):
            curve = pushover(
                model,
                engine=ask.engine,
                recorder=results,
                progress=progress,
                keep_poses=True,
                default_falling=STOP,  # beyond the collapse of a part nothing is assessed
            )
    _fail_if_interrupted(curve, folder, ask)
    return _judged(name, model, curve, folder, model.sha256)


def _resumed(name: str, model: Model, folder: Path, ask: Tracing, *, part_of: str) -> Sense:
    """The sense whose run in a folder stopped, or is complete."""
    from drystone.cli.compiler import compiling
    from drystone.common.progress import progress_for
    from drystone.io.results.folder import OutputError
    from drystone.limit import limits_beside, on_what_moves
    from drystone.model.model import STOP
    from drystone.report.folder.directory import ResultsDirectory
    from drystone.report.folder.results import load_results
    from drystone.report.folder.resume import go_on

    with ResultsDirectory(folder) as results:
        kept = results.take_up()
        results.beside = limits_beside(model)
        model = on_what_moves(model, results.beside)
        if (kept.model.sha256, kept.part_of) != (model.sha256, part_of):
            raise OutputError(
                f"{folder} holds the run of another model than {ask.source}: leave out --resume, "
                "or choose another folder with --out"
            )
        if ask.engine not in (None, kept.engine):
            raise OutputError(f"--engine: the run in {folder} is by {kept.engine}: leave it out")
        traced = replace(kept.model, site=model.site, assessment=model.assessment)
        if not kept.complete:
            stop = model.analysis.stop_multiplier
            with (
                compiling(kept.engine, model.assembly.dimension, quiet=ask.quiet),
                progress_for(f"{ask.source.stem}, {name}", stop, quiet=ask.quiet) as progress,
            ):
                curve = go_on(kept, kept.model, results, progress=progress, default_falling=STOP)
            _fail_if_interrupted(curve, folder, ask)
    return _judged(name, traced, load_results(folder).curve, folder, model.sha256)


def _fail_if_interrupted(curve: CapacityCurve, folder: Path, ask: Tracing) -> None:
    """End the command where somebody interrupted it."""
    if curve.status == "interrupted":
        problem = f"interrupted: what was reached is kept in {folder}; --resume goes on from here"
        fail(INTERRUPTED, [problem], as_json=ask.as_json, status="interrupted")


def _traced_opposite(model: Model, folder: Path, ask: Tracing, *, part_of: str) -> Sense:
    """The model under the load turned round; where it cannot be traced, why.  ``part_of`` as of
    `ResultsDirectory`."""
    from drystone.analysis.directions import towards
    from drystone.engines.base import EngineError
    from drystone.model.construction.errors import ModelError

    turned = model
    try:
        turned = replace(
            towards(model, 180.0),
            title=f"{model.title}, {OPPOSITE}" if model.title else OPPOSITE,
        )
        return _traced_one(OPPOSITE, turned, folder, ask, part_of=part_of)
    except (EngineError, ModelError, ValueError) as error:  # of a pattern of one sense the last
        return _refused(turned, folder, error)


def _refused(model: Model, folder: Path, error: Exception) -> Sense:
    """The opposite sense where it has no curve, with why."""
    from drystone.assessment.verdict import sense_words

    problem = say("refused.no_curve", sense=sense_words(OPPOSITE), why=str(error))
    return Sense(
        name=OPPOSITE,
        model=model,
        folder=folder,
        curve=None,
        verdict=None,
        problem=problem,
        warnings=(problem,),
    )


def _judged(
    name: str,
    model: Model,
    curve: CapacityCurve,
    folder: Path,
    sha256: str,
    *,
    against: bool = False,
) -> Sense:
    """The verdict on a curve, or why there is none: its own fault, for that of the input is
    raised along the load; ``against`` as of `verdict_on`."""
    from drystone.assessment.errors import AssessmentError, UnfinishedError
    from drystone.assessment.request import check_request, request_of
    from drystone.assessment.verdict import in_one_sense, sense_words, verdict_on

    request = request_of(model.site, model.assessment)
    try:
        verdict = verdict_on(curve, model, request, against=against)
    except AssessmentError as error:
        check_request(request)  # a key that is missing is told whatever the curve lacks
        if name == FORWARD and not isinstance(error, UnfinishedError):
            raise
        problem = say("verdict.no_verdict", sense=sense_words(name), why=error.said)
        outward, model = in_one_sense(curve, model, against=against)
        return Sense(
            name=name,
            model=model,
            folder=folder,
            curve=outward,
            verdict=None,
            traced=curve,
            sha256=sha256,
            problem=problem,
            warnings=() if name == FORWARD else (problem,),
        )
    warnings: tuple[str, ...] = ()
    if curve.status != "finished":
        known = {"status": said_status(curve.status), "reason": said_end(curve.reason)}
        warnings = (say("refused.incomplete", **known),)
    return Sense(
        name=name,
        model=model,
        folder=folder,
        curve=curve,
        verdict=verdict,
        traced=curve,
        sha256=sha256,
        warnings=warnings,
    )


def _partial(curve: CapacityCurve, model: Model) -> dict[str, Any]:
    """What a curve without a verdict shows all the same."""
    from drystone.assessment.errors import AssessmentError
    from drystone.assessment.mechanism import reduced

    values = {} if model.assessment is None else model.assessment.values
    keys: dict[str, Any] = {
        "method": values.get("method"),
        "reading": values.get("reading", "base_shear"),
        **dict.fromkeys(FIGURES),
        "safety_index": None,
        "satisfied": None,
        "limit_states": {},
    }
    try:
        found = reduced(curve, model, grouping=values.get("grouping", "macro_blocks"))
    except AssessmentError:
        return keys
    capacity = found.capacities[keys["reading"]]
    return keys | {
        **{name: getattr(capacity, name) for name in FIGURES[:-1]},
        "collapse_displacement": capacity.spectral_collapse_displacement,
        "spectral_displacement": capacity.spectral_displacement.tolist(),
        "spectral_acceleration": capacity.spectral_acceleration.tolist(),
        "mechanism": found.as_dict(),
    }
