"""What becomes of a file that was changed: refused, read or run; or a fault of the program.

A file is refused by one of the errors that are meant for users, in sentences of one line each.
What is read is a model; a small one is run for a few points, or looked at in another way, and
whatever comes of that is finite and as good as its certificate says.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from drystone.analysis.driver import pushover
from drystone.assessment.errors import AssessmentError
from drystone.engines import make_engine
from drystone.engines.base import EngineError
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model

#: Blocks of what is run, by dimension: a few points of it take some tenths of a second.
SMALL = {2: 12, 3: 6}
POINTS = 5
ENGINES = ("equilibrium", "nscd", "distinct")
#: Letters of a sentence that somebody can still read.
LONGEST = 2000

REFUSED, READ, RAN, STOPPED = "refused", "read", "ran", "would not run"
GOOD = (REFUSED, READ, RAN, STOPPED)
TRACEBACK, NOT_FINITE, RESIDUAL, UNCLEAR, WARNING = (
    "traceback", "not finite", "residual", "unclear error", "warning",
)  # fmt: skip


class Fault(Exception):
    """Something that no file should bring about."""

    def __init__(self, kind: str, what: str) -> None:
        super().__init__(kind, what)
        self.kind, self.what = kind, what


def outcome(look: Callable[[Path, Random], str], path: Path, draw: Random) -> tuple[str, str]:
    """What becomes of a file, and what there is to say about a fault."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return look(path, draw), ""
    except Fault as fault:
        return fault.kind, fault.what
    except Warning as warning:
        return WARNING, _where(warning)
    except Exception as error:
        return TRACEBACK, _where(error)


def _where(error: BaseException) -> str:
    """An error with its place: the last line of the package that it went through."""
    place, where = error.__traceback__, ""
    while place is not None:
        code = place.tb_frame.f_code
        if "drystone" in code.co_filename:
            file = code.co_filename.rpartition("drystone/")[2]
            where = f"{file}:{place.tb_lineno} {code.co_name}"
        place = place.tb_next
    return f"{where}: {type(error).__name__}: {' '.join(str(error).split())[:200]}"


def clear(problems: list[str], path: Path | None = None) -> str:
    """`REFUSED`, where what was said is clear."""
    if not problems:
        raise Fault(UNCLEAR, "no sentence")
    for problem in problems:
        if path is not None and not problem.startswith(f"{path}: "):
            raise Fault(UNCLEAR, f"does not name the file: {problem[:200]!r}")
        if not problem.isprintable() or len(problem) > LONGEST or len(problem) < 10:
            raise Fault(UNCLEAR, f"{len(problem)} letters: {problem[:300]!r}")
    return REFUSED


def finite(name: str, values: Any) -> None:
    """Raise `Fault` where one of some numbers is none."""
    if not np.all(np.isfinite(np.asarray(values, dtype=np.float64))):
        raise Fault(NOT_FINITE, name)


def of_model(path: Path, draw: Random) -> str:
    """A model file is read, and looked at."""
    from drystone.io.modelfile import read_model

    try:
        model = read_model(path)
    except ModelError as error:
        return clear(error.problems, path)
    return looked_at(model, draw)


def looked_at(model: Model, draw: Random) -> str:
    """A model that was read is run, or bounded by limit analysis, or described, if it is small."""
    assembly = model.assembly
    for block in assembly.blocks:
        finite(f"vertices of {block.id[:40]!r}", block.vertices)
    finite("weight", assembly.weight)
    action = draw.choice((*ENGINES, "equilibrium", "equilibrium", "limit", "described", "drawn"))
    if assembly.n_blocks > SMALL[assembly.dimension] or _points(model) > 400:
        return READ
    try:
        if action in ENGINES:
            return _run(model, action)
        return {"limit": _bounded, "described": _described, "drawn": _drawn}[action](model, draw)
    except (EngineError, ModelError, AssessmentError) as error:
        clear(str(error).split("\n"))
        return STOPPED


def _points(model: Model) -> int:
    return int(model.assembly.points * len(model.assembly.interfaces.size))


def _run(model: Model, engine: str) -> str:
    curve = pushover(model, engine=engine, max_steps=POINTS, progress=False)
    for name in ("control_displacement", "load_multiplier", "residual", "penetration"):
        finite(f"{name} by {engine}", curve.column(name))
    assert curve.poses is not None
    for pose in curve.poses:
        finite(f"poses by {engine}", pose)
    clear([curve.reason])
    limit = make_engine(engine).capabilities.residual_limit or math.inf
    worst = max(point.residual for point in curve.points)
    if curve.status == "finished" and worst > limit:
        raise Fault(RESIDUAL, f"finished by {engine} with {worst:.2g} above {limit:g}")
    return RAN


def _bounded(model: Model, draw: Random) -> str:
    from drystone.limit import FLOWS, collapse_load

    flow = draw.choice(FLOWS)
    found = collapse_load(model, flow=flow)
    if found.status == "finished":
        finite(f"collapse multiplier, {flow}", found.load_multiplier)
    clear([found.reason])
    return RAN


def _described(model: Model, draw: Random) -> str:
    from drystone.cli.check import report, statics
    from drystone.model.inspection import inspect

    found = inspect(model)
    against, reaction, why_not = statics(model)
    report(found, [*found.problems, *against], reaction, why_not)
    finite("weight and size", [found.weight, found.volume, *found.lower, *found.upper])
    return RAN


def _drawn(model: Model, draw: Random) -> str:
    """Written in a format, and read again where that is ours to read."""
    from drystone.io.convert import targets

    _, target = draw.choice(sorted(targets().items()))
    text = target.write(model, f"a{target.endings[0]}").text
    if target.read is not None:
        target.read(text)
    return RAN


def of_script(path: Path, draw: Random) -> str:
    """A file that was written for another program is read back."""
    from drystone.io import convert

    try:
        model = convert.read(path)
    except ModelError as error:
        return clear(error.problems)
    return looked_at(model, draw)


def of_spectrum(path: Path, draw: Random) -> str:
    """A spectrum is read, and asked at some periods."""
    from drystone.assessment.spectra.table import read_spectrum

    try:
        found = read_spectrum(path, unit=draw.choice(("g", "m/s2")), damping=0.05)
    except AssessmentError as error:
        return clear([str(error)])
    periods = np.array([0.0, 1e-3, 0.1, 1.0, 10.0])
    finite("S_e", found.sa(periods, 0.05))
    finite("S_De", found.sd(periods, 0.05))
    finite("T_C", found.corner_period)
    finite("scaled", found.scaled(1.0).sa(periods, 0.1))
    return RAN


#: Samples of a study of which one is computed, and what it may take [s].
FEW_SAMPLES, STUDY_SECONDS = 1000, 3.0


def of_study(path: Path, draw: Random) -> str:
    """A study is read, its samples are drawn, and the last one is computed."""
    from drystone.studies.errors import StudyError
    from drystone.studies.read import read_study
    from drystone.studies.sample import FAILED, compute

    try:
        study = read_study(path)
        if study.target is not None or study.task.function is not None:
            return READ
        if study.count > FEW_SAMPLES:
            return READ
        values = study.values_at(study.count - 1)
    except StudyError as error:
        return clear(error.problems, path)
    task = replace(study.task, timeout=min(study.task.timeout or STUDY_SECONDS, STUDY_SECONDS))
    row = compute(task, study.count - 1, values).row
    if row["status"] == FAILED:
        said = str(row["reason"])
        if re.match(r"\w+(Error|Exception|Warning|Fault): ", said):
            raise Fault(TRACEBACK, said[:300])
        clear([said])
        return STOPPED
    for name in ("peak_multiplier", "capacity_multiplier", "limit_associative"):
        if row.get(name) is not None:
            finite(name, row[name])
    return RAN


class _Block:
    """A stone of 1 m that rocks."""

    limit, uplift, speed = 0.2, 2.0, 0.6

    def acceleration(self, x: float, ground: float) -> float:
        return -self.uplift * (1.0 - x / self.limit) - ground


def of_record(path: Path, draw: Random) -> str:
    """A record is read, and rocked under."""
    from drystone.assessment.rocking.motion import respond
    from drystone.assessment.rocking.record import read_record

    try:
        record = read_record(path, unit=draw.choice(("g", "m/s2")))
        finite("peaks", [record.peak_acceleration, record.peak_velocity])
        found = respond(_Block(), record, restitution=0.9, sides=draw.choice(("one", "two")))
    except AssessmentError as error:
        return clear([str(error)])
    for values in (found.time, found.displacement, found.velocity):
        finite("rocking", values)
    return RAN
