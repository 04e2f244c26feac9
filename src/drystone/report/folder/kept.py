"""What a folder of results has kept of a run that stopped."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from drystone.common.language import say
from drystone.io.results.checkpoint import CHECKPOINT, CheckpointError, read_checkpoint
from drystone.io.results.folder import OutputError
from drystone.io.results.hdf5 import RUNNING
from drystone.io.results.names import RESULTS, SUMMARY
from drystone.io.results.results_reader import ResultsReader
from drystone.model.model import Model
from drystone.report.folder.stored import StoredContacts, model_of
from drystone.results.checkpoint import Past
from drystone.results.curve import FINISHED


@dataclass(frozen=True, kw_only=True)
class Kept:
    """A run that stopped, and how far another can go on with it."""

    path: Path
    model: Model
    engine: str
    strategy: str
    status: str  # "running" where it was killed
    reason: str
    n_points: int
    part_of: str
    past: Past | None  # None: no checkpoint was kept, and the run begins anew

    @property
    def complete(self) -> bool:
        """Whether the curve and all files of it are there."""
        return self.status == FINISHED and (self.path / SUMMARY).is_file()

    @property
    def history_is_over(self) -> bool:
        """Whether all displacements of a history were reached: no other end takes it farther."""
        history = self.model.history
        if history is None or self.status != FINISHED:
            return False
        return self.reason.partition("; ")[0] == say("end.history", n=len(history.targets))


def kept_in(folder: Path) -> Kept:
    """What is kept in a folder that this process holds; raises `OutputError`."""
    file = folder / RESULTS
    if not file.is_file():
        raise OutputError(
            f"{folder} holds no {RESULTS}, so there is nothing to go on with: name the folder of a "
            "run that stopped, or run the model"
        )
    try:
        with ResultsReader(file) as stored:
            return _kept(folder, stored)
    except (OSError, KeyError) as error:
        raise OutputError(
            f"{file} is torn or no such file ({error}), and no run can go on with it: run the "
            "model again"
        ) from None


def _holding(model: Model, files: Mapping[str, str]) -> Model:
    """The model of a checkpoint, whose files are those that the results hold."""
    site, assessment = model.site, model.assessment
    held = replace(
        model,
        site=None if site is None else replace(site, files=files),
        assessment=None if assessment is None else replace(assessment, files=files),
    )
    if model.origin is None or model.source is None:  # varied since it was read
        return held
    return replace(held, origin=replace(model.origin, contents=held.contents))


def _kept(folder: Path, stored: ResultsReader) -> Kept:
    past, n_points = None, stored.n_points
    try:
        found = read_checkpoint(folder, stored.run())
    except CheckpointError as error:
        raise OutputError(
            f"{folder / CHECKPOINT} cannot be used, {error}: run the model again"
        ) from None
    if found is None:
        model = model_of(stored)
        if model is None:
            raise OutputError(
                f"{folder / RESULTS} keeps no state, and a model that this version cannot read: "
                "run the model again"
            )
    else:
        model, checkpoint = found
        model = _holding(model, stored.files())
        n = checkpoint.n_points
        if n > n_points:
            raise OutputError(
                f"{folder / RESULTS} has {n_points} points, fewer than {CHECKPOINT} beside it "
                f"tells ({n}): they are of different runs; run the model again"
            )
        ties = stored.ties()
        past = Past(
            model=model,
            checkpoint=checkpoint,
            points=stored.points()[:n],
            poses=stored.poses()[:n],
            contacts=StoredContacts(folder / RESULTS, range(n)),
            ties=None if ties is None else ties.until(n),
        )
    status = stored.attribute("status")
    return Kept(
        path=folder,
        model=model,
        engine=stored.attribute("engine"),
        strategy=stored.attribute("strategy"),
        status=status,
        reason="" if status == RUNNING else stored.attribute("reason"),
        n_points=n_points,
        part_of=stored.part_of(),
        past=past,
    )
