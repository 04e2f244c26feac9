"""A folder of results written from a finished curve, and read again."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from drystone.common.arrays import Array, IntArray
from drystone.common.language import say
from drystone.common.names import Named
from drystone.contact.forces import ContactForces
from drystone.io.results.folder import OutputError
from drystone.io.results.hdf5 import RUNNING
from drystone.io.results.names import RESULTS, SUMMARY
from drystone.io.results.results_reader import ResultsReader
from drystone.io.results.summary import summarise
from drystone.model.model import Model
from drystone.report.folder.directory import ResultsDirectory
from drystone.report.folder.stored import StoredContacts, model_of
from drystone.results.curve import CapacityCurve
from drystone.results.event_log import events_of
from drystone.results.events import Event


def save_results(
    curve: CapacityCurve,
    model: Model,
    path: Path | str,
    *,
    mechanism_displacement: float | None = None,
) -> dict[str, Any]:
    """Write the folder that ``drystone run`` writes; returns what ``summary.json`` holds.

    Parameters
    ----------
    curve
        With poses and contacts, which `pushover` keeps by default.
    model
        What was analysed, wherever its control point.
    path
        The folder; made where it is missing.  Results in it are replaced.
    mechanism_displacement
        Control displacement [m] of ``mechanism.png``, see `ResultsDirectory`.

    Raises
    ------
    OutputError
        The folder cannot be written.
    ValueError
        The curve has no points, poses or contacts, was traced of another model, or was loaded from
        that very folder.
    """
    if not curve.points or curve.poses is None or curve.contacts is None:
        raise ValueError(
            "the curve has no points with poses and contacts: trace it with keep_poses=True and "
            "keep_contacts=True, or with recorder=ds.ResultsDirectory(path)"
        )
    if isinstance(curve.contacts, StoredContacts) and curve.contacts.within(Path(path)):
        raise ValueError(f"the curve is read from {path} as it is written: name another folder")
    if not curve.is_of(model):
        raise ValueError(
            "the curve was traced of another structure, or under other loads: give the model that "
            "was traced"
        )
    from drystone.limit import limits_beside  # takes long, which reading results need not

    model = curve.traced_of(model)
    with ResultsDirectory(
        path, mechanism_displacement=mechanism_displacement, beside=limits_beside(model)
    ) as results:
        results.begin(model, curve.engine, curve.strategy)
        kept = zip(curve.points, curve.poses, curve.contacts, strict=True)
        for k, (point, pose, contacts) in enumerate(kept):
            if curve.ties is not None:
                results.ties(curve.ties.at(k))
            results.point(point, pose, contacts)
        results.end(curve)
    return results.summary or {}


@dataclass(frozen=True, kw_only=True, repr=False)
class Results:
    """A folder of results, read again."""

    path: Path
    curve: CapacityCurve
    """With poses and contacts; its status is "running" where the run goes on or was killed."""
    model: Model | None
    """What was analysed; None where this version cannot read its description."""
    summary: dict[str, Any]
    """Of ``summary.json``, or of what there is so far."""
    groups: dict[str, IntArray]
    """Rows of the blocks of each group, as ``model.assembly.groups``."""
    sha256: str = ""
    """Digest of the model that was traced."""
    part_of: str = ""
    """Digest of the model of which this is the other sense; empty where it is none."""

    @property
    def poses(self) -> Array:
        """Poses of the blocks at every point, (n_points, n, n_pose), see `geometry.motion`."""
        assert self.curve.poses is not None
        return self.curve.poses

    @property
    def contacts(self) -> Sequence[ContactForces]:
        """Contact forces of every point, read from the file when asked for."""
        assert self.curve.contacts is not None
        return self.curve.contacts

    def __repr__(self) -> str:
        return f"<Results {str(self.path)!r}: {self.curve!r}>"

    def _repr_html_(self) -> str:
        """The viewer with the structure that moves along its curve, for notebooks."""
        from drystone.report.notebook import results_viewer

        return results_viewer(self)


def load_results(path: Path | str) -> Results:
    """Read a folder of results, also of a run that was interrupted, killed or still goes on.

    Raises
    ------
    OutputError
        The folder holds no ``results.h5`` that can be read.
    """
    folder = Path(path)
    file = folder / RESULTS
    try:
        with ResultsReader(file) as stored:
            model = model_of(stored)
            curve = _curve_of(stored, StoredContacts(file, range(stored.n_points)), model)
            curve = _ended(curve, folder, str(stored.attribute("model_sha256")))
            groups: dict[str, Any] = Named("group", stored.groups())
            digest, part_of = str(stored.attribute("model_sha256")), stored.part_of()
    except (OSError, KeyError) as error:
        why = "there is none" if not file.is_file() else f"it is torn or no such file ({error})"
        within = sorted(found.parent.name for found in folder.glob(f"direction-*/{RESULTS}"))
        mend = "name a folder that a run or save_results has written"
        if within:
            mend = f"name one of the directions in it, {', '.join(within)}"
        raise OutputError(f"{file} cannot be read, {why}: {mend}") from None
    return Results(
        path=folder,
        curve=curve,
        model=model,
        summary=_summary_of(folder, curve, model),
        groups=groups,
        sha256=digest,
        part_of=part_of,
    )


def check_opposite(opposite: Results, forward: Results) -> None:
    """Raise `OutputError` unless results are those of the other sense of the same model."""
    if opposite.part_of != forward.sha256:
        raise OutputError(
            f"{opposite.path / RESULTS} belongs to another model than {forward.path / RESULTS}: "
            f"trace both senses again, `drystone assess MODEL --out {forward.path}`, or remove "
            f"{opposite.path}"
        )


def _curve_of(
    stored: ResultsReader, contacts: StoredContacts, model: Model | None
) -> CapacityCurve:
    """The curve; its events are found anew, so that a run that was killed has them, too."""
    status = stored.attribute("status")
    ended = status != RUNNING
    points, poses, ties = stored.points(), stored.poses(), stored.ties()
    left = stored.blocks_left()
    events: tuple[Event, ...] = ()
    if model is not None:
        events = events_of(model, points, poses, contacts, ties=ties, left=left)
    return CapacityCurve(
        engine=stored.attribute("engine"),
        strategy=stored.attribute("strategy"),
        points=points,
        status=status,
        reason=stored.attribute("reason") if ended else str(say("end.running")),
        stop_multiplier=float(stored.attribute("stop_multiplier")),
        blocks_left=left,
        events=events,
        settlement=float(stored.attribute("settlement")) if ended else math.nan,
        wall_time=float(stored.attribute("wall_time")) if ended else math.nan,
        compile_time=float(stored.attribute("compile_time")) if ended else math.nan,
        poses=poses,
        contacts=contacts,
        ties=ties,
        load_force=model.load_force if model is not None else math.nan,
        load_turns=model is not None and model.load.turns_gravity,
        targets=model.history.targets if model is not None and model.history else (),
        motion_unit=model.settlement.unit if model is not None and model.settlement else "m",
    )


def _ended(curve: CapacityCurve, folder: Path, digest: str) -> CapacityCurve:
    """The curve with the end that ``summary.json`` tells, where the disk was too full to tell it
    beside the points."""
    if curve.status != RUNNING:
        return curve
    try:
        told = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
        if told["model_sha256"] != digest:
            return curve
        status, reason, n = str(told["status"]), str(told["reason"]), int(told["n_points"])
    except (OSError, ValueError, KeyError, TypeError):
        return curve
    if n != len(curve.points):
        status = "stopped"
        files = {"results": RESULTS, "summary": SUMMARY}
        reason = str(say("end.not_whole", **files, n=len(curve.points), most=n))
    return replace(curve, status=status, reason=reason)


def _summary_of(folder: Path, curve: CapacityCurve, model: Model | None) -> dict[str, Any]:
    try:
        return json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return summarise(curve, model) if model is not None and curve.points else {}
