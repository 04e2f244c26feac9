"""One sample, from its values to its row; and many of them, as a worker is given them."""

from __future__ import annotations

import copy
import hashlib
import json
import math
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.language import say
from drystone.common.version import package_version
from drystone.io.results.summary import plain
from drystone.model.construction.errors import ModelError
from drystone.studies import paths
from drystone.studies.study import COLUMNS, REACTIONS, Task

#: Status of a sample without a result.
FAILED = "failed"


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What came of a sample."""

    row: Mapping[str, Any]
    curve: Array | None = None  # (2, points): control displacement [m], load multiplier
    model: str | None = None  # JSON of the model file, of a sample that failed


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """What came of several samples, and how long they took."""

    outcomes: tuple[Outcome, ...]
    seconds: float


#: One analysis at a time in a process, whoever calls: clusters call from several threads.
_ALONE = threading.Lock()


def compute_chunk(task: Task, samples: Sequence[int], values: Sequence[Sequence[Any]]) -> Chunk:
    """Outcomes of samples with their values, in their order.  Called in the processes of workers.

    Never raises for what is wrong with a sample: its row tells.
    """
    begun = time.perf_counter()
    with _ALONE:
        outcomes = tuple(
            compute(task, sample, own) for sample, own in zip(samples, values, strict=True)
        )
    return Chunk(outcomes=outcomes, seconds=time.perf_counter() - begun)


def prepare(task: Task) -> None:
    """Load what samples need, before there are any."""
    if task.function is not None:
        _function(task.function, task.folder, task.module)
        return
    for name in ("analysis.driver", "limit", "assessment.verdict", "io.modelfile.read"):
        import_module(f"drystone.{name}")


def compute(task: Task, sample: int, values: Sequence[Any]) -> Outcome:
    """The outcome of a sample.

    Parameters
    ----------
    values
        Of the parameters, in their order.
    """
    begun = time.perf_counter()
    row = begun_row(task, sample, values)
    seed = row["seed"]
    document: dict[str, Any] | None = None
    curve, found, digest = None, dict[str, Any](), ""
    try:
        if task.function is not None:
            function = _function(task.function, task.folder, task.module)
            told = function(_named(task, values, seed))
            found = {"status": "finished", "reason": "", **plain(dict(told))}
        else:
            document = document_of(task, values)
            digest = digest_of(document)
            found, curve = _analysed(task, document, seed, digest)
    except Exception as error:  # whatever it is: the study goes on, and the row tells
        found = {"status": FAILED, "reason": reason_of(error)}
    row |= {"status": found.pop("status"), "reason": str(found.pop("reason"))}
    names = () if task.function else [name for kind in task.outputs for name in COLUMNS[kind]]
    row |= dict.fromkeys(names) | found
    row |= {
        "seconds": time.perf_counter() - begun,
        "version": package_version(),
        "digest": digest,
    }
    failed = row["status"] == FAILED and document is not None
    return Outcome(row=row, curve=curve, model=_as_text(document) if failed else None)


def begun_row(task: Task, sample: int, values: Sequence[Any]) -> dict[str, Any]:
    """The row of a sample with its seed and values, before anything has come of it."""
    own = {name: _cell(value) for name, value in zip(task.names, values, strict=True)}
    return {"sample": sample, "seed": task.seed_at(sample), **own}


def document_of(task: Task, values: Sequence[Any]) -> dict[str, Any]:
    """The model file of a sample, without what is drawn by its seed.

    Raises
    ------
    ModelError
        A parameter leads to nothing.
    """
    document: dict[str, Any] = copy.deepcopy(dict(task.model or {}))
    for parameter, value in zip(task.parameters, values, strict=True):
        for keys in parameter.paths:
            try:
                paths.put(
                    document,
                    keys,
                    lambda old, how=parameter.apply, new=value: paths.changed(old, how, new),
                )
            except paths.PathError as error:
                raise ModelError([f'parameter "{parameter.name}" {error}']) from None
    return document


def model_of(task: Task, document: dict[str, Any], seed: int, digest: str) -> Any:
    """The model of a sample, imperfect where the study says so; raises `ModelError`."""
    from drystone.io.modelfile.read import model_from_data
    from drystone.model.assembly import Corner
    from drystone.studies.imperfections import imperfect

    reshape = None
    if task.imperfection is not None:
        digest = hashlib.sha256(f"{digest} {seed}".encode()).hexdigest()
        corner = Corner(**document.get("corner", {})) if task.imperfection.vertices else Corner()
        reshape = partial(imperfect, what=task.imperfection, seed=seed, corner=corner)
    return model_from_data(
        document,
        source=task.source,
        sha256=digest,
        need_stiffness=task.outputs != ("limit",),
        files=task.files,
        reshaped=reshape,
    )


def digest_of(document: Mapping[str, Any]) -> str:
    """SHA-256 of a model file as canonical JSON."""
    return hashlib.sha256(_as_text(document).encode()).hexdigest()


def reason_of(error: Exception) -> str:
    """Why a sample failed, in one line."""
    from drystone.assessment.errors import AssessmentError
    from drystone.engines.base import EngineError

    if isinstance(error, ModelError):
        return "; ".join(error.problems)
    if isinstance(error, EngineError | AssessmentError):
        return str(error)
    return f"{type(error).__name__}: {error}"


def _analysed(
    task: Task, document: dict[str, Any], seed: int, digest: str
) -> tuple[dict[str, Any], Array | None]:
    """What the outputs tell, and the curve."""
    model = model_of(task, document, seed, digest)
    found: dict[str, Any] = {"status": "finished", "reason": ""}
    traced = None
    if task.outputs != ("limit",):
        curve = _traced(task, model)
        found |= {"status": curve.status, "reason": curve.reason}
        found |= _of_supports(curve, model) if curve.moves_supports else _of_curve(curve)
        traced = resampled(curve.control_displacement, curve.load_multiplier, task.points)
        if _assesses(task):
            judged = _judged(task, model, curve)
            found["reason"] = "; ".join(filter(None, (found["reason"], judged.pop("why"))))
            found |= judged
    if "limit" in task.outputs:
        limits = _of_limits(model)
        if not limits.pop("status") and traced is None:
            found["status"] = FAILED
        found["reason"] = "; ".join(filter(None, (found["reason"], limits.pop("why"))))
        found |= limits
    return found, traced


def _traced(task: Task, model: Any) -> Any:
    """The curve, as `drystone run` traces it; one that takes too long is stopped."""
    from drystone.analysis.driver import pushover
    from drystone.model.model import REMOVE, STOP

    assesses = _assesses(task)
    return pushover(
        model,
        engine=task.engine,
        strategy=task.strategy,
        threads=1,
        progress=_watch(task.timeout) if task.timeout is not None else False,
        keep_poses=assesses,
        keep_contacts=False,
        default_falling=STOP if assesses else REMOVE,
    )


def _assesses(task: Task) -> bool:
    return "assess" in task.outputs or "senses" in task.outputs


def _watch(seconds: float) -> Callable[[Any], None]:
    from drystone.results.curve import RecorderError

    end = time.perf_counter() + seconds

    def watch(point: Any) -> None:
        if time.perf_counter() > end:
            raise RecorderError(say("end.timeout", seconds=seconds))

    return watch


def _of_curve(curve: Any) -> dict[str, Any]:
    peak, capacity = curve.peak, curve.capacity
    return {
        "peak_multiplier": peak.load_multiplier,
        "peak_displacement": peak.control_displacement,
        "peak_passed": curve.peak_passed,
        "ultimate_displacement": curve.ultimate_displacement,
        "capacity_multiplier": capacity.load_multiplier,
        "capacity_displacement": capacity.control_displacement,
        **_of_points(curve),
    }


def _of_supports(curve: Any, model: Any) -> dict[str, Any]:
    """Where supports move, the curve is their reaction: it has no peak."""
    from drystone.io.results.summary import support_figures

    told = support_figures(curve, model)
    return {**{name: told[name] for name in REACTIONS}, **_of_points(curve)}


def _of_points(curve: Any) -> dict[str, Any]:
    return {
        "max_residual": _largest(curve.residual),
        "max_penetration": _largest(curve.column("penetration")),
        "n_points": len(curve.points),
        "certified": _is_certified(curve),
    }


def _is_certified(curve: Any) -> bool:
    """Whether a curve is complete, and every point at rest within what its engine keeps."""
    from drystone.engines import make_engine
    from drystone.results.curve import FINISHED, STATIC

    limit = make_engine(curve.engine).capabilities.residual_limit
    rest = [point.residual for point in curve.points if point.status == STATIC]
    return bool(
        curve.status == FINISHED and (limit is None or all(residual <= limit for residual in rest))
    )


def _judged(task: Task, model: Any, curve: Any) -> dict[str, Any]:
    """What an assessment tells; where there is no verdict, ``why`` says the reason: the curve, and
    what limit analysis finds, are those of the sample all the same."""
    from drystone.assessment.errors import AssessmentError

    try:
        verdict = curve.assess(model)
    except AssessmentError as error:
        return {"why": say("end.no_verdict", why=reason_of(error))}
    found = {"why": "", **_of_verdict(verdict)}
    return found | _of_senses(task, model, verdict) if "senses" in task.outputs else found


def _of_verdict(verdict: Any) -> dict[str, Any]:
    assessment = verdict.assessment
    found: dict[str, Any] = {
        "safety_index": verdict.safety_index,
        "satisfied": verdict.satisfied,
        "activation_multiplier": assessment.capacity.activation_multiplier,
        "activation_acceleration": assessment.activation_acceleration,
    }
    for state in verdict.limit_states:
        for name in ("ground_acceleration_capacity", "displacement_demand", "limit_displacement"):
            found[f"{name}_{state.name}"] = getattr(state, name)
        found[f"safety_index_{state.name}"] = state.safety_index
    return plain(found)


def _of_senses(task: Task, model: Any, along: Any) -> dict[str, Any]:
    """What an assessment tells of the load turned round, and which sense governs.

    Where there is no verdict on it, none governs, and ``why`` says the reason.

    Parameters
    ----------
    along
        Verdict on the sense that the load has.
    """
    from drystone.analysis.directions import towards
    from drystone.assessment.errors import AssessmentError
    from drystone.assessment.verdict import severity
    from drystone.engines.base import EngineError
    from drystone.io.results.senses import FORWARD, OPPOSITE

    try:
        turned = towards(model, 180.0)
        curve = _traced(task, turned)
        against = curve.assess(turned)
    except (AssessmentError, EngineError, ModelError, ValueError) as error:
        return {"why": say("end.opposite", how=reason_of(error))}
    own = {
        "peak_multiplier": curve.peak.load_multiplier,
        "capacity_multiplier": curve.capacity.load_multiplier,
        **_of_verdict(against),
    }
    opposite_governs = severity(against) < severity(along)
    return {
        "why": "" if curve.status == "finished" else say("end.opposite", how=curve.reason),
        "governing_sense": OPPOSITE if opposite_governs else FORWARD,
        "governing_safety_index": (against if opposite_governs else along).safety_index,
        **{f"{name}_against": value for name, value in own.items()},
    }


def _of_limits(model: Any) -> dict[str, Any]:
    """Both multipliers; what is missing says why."""
    from drystone.limit import limits_beside

    beside = limits_beside(model)
    return {
        "status": beside.associative is not None,
        "why": beside.note,
        "limit_associative": beside.associative,
        "limit_non_associative": beside.non_associative,
    }


def _largest(values: Array) -> float | None:
    known = values[~np.isnan(values)]
    return float(known.max()) if known.size else None


def resampled(displacement: Array, multiplier: Array, points: int) -> Array:
    """A curve at so many places along its way, denser where it begins, (2, points).

    The way is the sum of what the control point has moved, so that curves that go back and forth
    keep their shape; places are at squares of equal shares of it, as a peak comes early.
    """
    way = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(displacement)))))
    at = way[-1] * (np.arange(points) / (points - 1)) ** 2
    found: Array = np.vstack([np.interp(at, way, displacement), np.interp(at, way, multiplier)])
    return found


def _named(task: Task, values: Sequence[Any], seed: int) -> dict[str, Any]:
    return {**dict(zip(task.names, values, strict=True)), "seed": seed}


@cache
def _function(
    place: str, folder: str, file: str | None
) -> Callable[[dict[str, Any]], Mapping[str, Any]]:
    """A function by "module:name": of a file, or from where Python looks and a folder."""
    module, _, name = place.partition(":")
    if folder and folder not in sys.path:
        sys.path.append(folder)  # also for what the file imports beside it
    found: Callable[[dict[str, Any]], Mapping[str, Any]]
    found = getattr(import_module(module) if file is None else _loaded(module, file), name)
    return found


def _loaded(module: str, file: str) -> ModuleType:
    """A file as a module, whatever else Python finds under its name."""
    spec = spec_from_file_location(f"{module} of a study", file)
    if spec is None or spec.loader is None:
        raise ImportError(f"{file} is no module")
    found = module_from_spec(spec)
    sys.modules[spec.name] = found
    spec.loader.exec_module(found)
    return found


def _cell(value: Any) -> Any:
    """A value for a table: numbers and texts as they are, all else as JSON."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return json.dumps(plain(value))
    return value


def _as_text(document: Mapping[str, Any] | None) -> str:
    return json.dumps(document, sort_keys=True, default=str)


def is_missing(value: Any) -> bool:
    """Whether a number is none."""
    return value is None or (isinstance(value, float) and math.isnan(value))
