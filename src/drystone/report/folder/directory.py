"""The folder of results of one analysis, filled while it runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from drystone.common.arrays import Array
from drystone.common.language import say
from drystone.contact.forces import ContactForces
from drystone.io.results.checkpoint import CheckpointWriter
from drystone.io.results.folder import (
    FolderLock,
    OutputError,
    as_output_error,
    check_apart,
    check_writable,
    in_a_sentence,
)
from drystone.io.results.interrupts import uninterrupted
from drystone.io.results.names import PARAVIEW, RESULTS
from drystone.io.results.outputs import file_names
from drystone.io.results.own_files import check_free, clear, clear_derived
from drystone.io.results.results_writer import ResultsWriter
from drystone.limit.beside import Beside
from drystone.model.model import Model
from drystone.model.ties import TieState
from drystone.report.folder.ending import finished, write_long, write_short
from drystone.report.folder.kept import Kept, kept_in
from drystone.results.checkpoint import Checkpoint
from drystone.results.curve import CapacityCurve, CurvePoint

if TYPE_CHECKING:
    from drystone.common.aside import Aside


#: Seconds before a checkpoint, from the begin of the run or the checkpoint before: at least these,
#: and as many times those that one takes, so that they cost a hundredth of the run; at most those,
#: of work that a kill may cost beside the step that it cuts off.
SECONDS, TIMES, MOST_SECONDS = 5.0, 100.0, 15.0
#: Name of results before their first point is on the disk.
DRAFT = RESULTS + ".part"


class ResultsDirectory:
    """Records one analysis in a folder; a `Recorder` of the pushover.

    Nothing is written before the first point, so that a model that turns out to be wrong leaves no
    trace.  From then on ``results.h5`` grows with the analysis; the other files are written at its
    end, also when it was interrupted or the disk is full.  Earlier results in the folder (of runs,
    assessments and pages) are removed once the first point is on the disk. If the disk is too full
    for it, they stay.  From the first point to the end the folder is locked.

    Parameters
    ----------
    path
        The folder; made where it is missing, with its parents.
    mechanism_displacement
        Control displacement [m] of ``mechanism.png``; by default what the model's analysis says
        under ``mechanism_displacement``, else 0.2 m.
    beside
        Multipliers of limit analysis, for ``summary.json`` and ``curve.png``; or what gives them,
        asked at the end.
    aside
        A process that draws the pictures while the rest is written here.
    formats
        Of pictures beside PNG: "svg", "pdf".
    part_of
        Digest of the model in the folder above, of which this is the other sense.
    takes_over
        Called once the first point is on the disk, before earlier results go.

    Raises
    ------
    OutputError
        At once, where nothing can be written there; later, where that is so no more.
    """

    def __init__(
        self,
        path: Path | str,
        *,
        mechanism_displacement: float | None = None,
        beside: Beside | Callable[[], Beside] | None = None,
        aside: Aside | None = None,
        formats: Sequence[str] = (),
        part_of: str = "",
        takes_over: Callable[[], None] | None = None,
    ) -> None:
        self.path = Path(path)
        self.beside = beside or Beside()  # may be said later, before the end
        self._aside = aside
        self._formats = tuple(formats)
        self.summary: dict[str, Any] | None = None  # of the analysis, once it ended
        self._mechanism_displacement = mechanism_displacement
        self._model: Model | None = None
        self._names = ("", "")
        self._part_of = part_of
        self._takes_over = takes_over
        self._ties: TieState | None = None  # of the point to come
        self._writer: ResultsWriter | None = None
        self._lock: FolderLock | None = None
        self._kept: Kept | None = None  # of a run that goes on
        self._checkpoints: CheckpointWriter | None = None
        self._keeps_at = 0.0  # s, of the clock, from which on a checkpoint is taken
        self._last: Checkpoint | None = None  # of the end, for `end` to write
        check_writable(self.path)

    @property
    def begun(self) -> bool:
        """Whether anything was written."""
        return self._writer is not None

    def take_up(self) -> Kept:
        """Hold the folder, whose run stopped, to go on with it; what it has kept.

        Raises
        ------
        OutputError
            There is no such folder, another run writes there, or nothing is kept that can be read.
        """
        if not self.path.is_dir():
            raise OutputError(
                f"there is no folder {self.path}: name the folder of a run that stopped"
            )
        self._lock = in_a_sentence(lambda: FolderLock(self.path))
        self._kept = kept_in(self.path)
        self._part_of = self._kept.part_of
        return self._kept

    def begin(self, model: Model, engine: str, strategy: str) -> None:
        """Take note of what is analysed."""
        self._model, self._names = model, (engine, strategy)
        self._keeps_at = time.monotonic() + SECONDS
        check_apart(model.source, files_of(self.path))
        if self._kept is not None and self._kept.past is not None:
            n_points = self._kept.past.checkpoint.n_points
            self._writer = in_a_sentence(lambda: self._go_on(model, n_points))

    def ties(self, ties: TieState) -> None:
        """Take what ties carry at the point to come."""
        self._ties = ties

    def point(self, point: CurvePoint, pose: Array, contacts: ContactForces) -> None:
        """Take one point of the curve."""
        writer = self._writer
        if writer is None:
            with uninterrupted():
                self._first(point, pose, contacts)
        else:
            in_a_sentence(lambda: writer.append(point, pose, contacts, self._ties))

    def keep(self, make: Callable[[], Checkpoint], *, last: bool = False) -> None:
        """Take a checkpoint where it is time for one, or it is the ``last``.

        The points before it are on the disk first; the last one waits for the end of the curve,
        which brings its points there.  Of results that the disk does not take, the checkpoint
        before stays: its points are there.
        """
        writer = self._writer
        if writer is None or not writer.whole:
            return
        if last:
            self._last = make()
            return
        begun = time.monotonic()
        if begun < self._keeps_at:
            return
        checkpoint = make()
        in_a_sentence(writer.flush)
        in_a_sentence(lambda: self._put(writer, checkpoint))
        taken = time.monotonic() - begun
        self._keeps_at = begun + min(max(SECONDS, TIMES * taken), MOST_SECONDS)

    def _put(self, writer: ResultsWriter, checkpoint: Checkpoint) -> None:
        assert self._model is not None
        if self._checkpoints is None:
            self._checkpoints = CheckpointWriter(self.path, self._model, writer.run)
        with uninterrupted():
            self._checkpoints.write(checkpoint, sync=writer.syncs)

    def end(self, curve: CapacityCurve) -> None:
        """Write everything that stands at the end: figures of the analysis first, pictures last."""
        try:
            if self._writer is not None and curve.points:
                in_a_sentence(lambda: self._finish(curve))
        finally:
            self.close()

    def close(self) -> None:
        """Close ``results.h5`` and unlock the folder; what was recorded stays."""
        try:
            if self._writer is not None:
                writer = self._writer
                in_a_sentence(writer.close)
        finally:
            if self._lock is not None:
                self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _first(self, point: CurvePoint, pose: Array, contacts: ContactForces) -> None:
        """Take the first point, in place of earlier results."""
        made = not self.path.exists()
        draft = self.path / DRAFT
        writer: ResultsWriter | None = None
        try:
            writer = in_a_sentence(lambda: self._open(draft))
            in_a_sentence(lambda: writer.append(point, pose, contacts, self._ties))
            in_a_sentence(lambda: check_free(self.path))
            if self._takes_over is not None:
                in_a_sentence(self._takes_over)
        except OutputError:
            self._withdraw(writer, draft, made=made)
            raise
        in_a_sentence(lambda: clear(self.path))
        in_a_sentence(lambda: writer.move(self.path / RESULTS))
        self._writer = writer
        in_a_sentence(lambda: (self.path / PARAVIEW).mkdir(exist_ok=True))

    def _open(self, draft: Path) -> ResultsWriter:
        if self._model is None:
            raise RuntimeError("`begin` comes before the first point")
        self.path.mkdir(parents=True, exist_ok=True)
        if self._lock is None:
            self._lock = FolderLock(self.path)
        return ResultsWriter(draft, self._model, *self._names, part_of=self._part_of)

    def _go_on(self, model: Model, n_points: int) -> ResultsWriter:
        """Results without the points beyond a checkpoint, and without files made of them."""
        clear_derived(self.path)
        (self.path / PARAVIEW).mkdir(exist_ok=True)
        writer = ResultsWriter.going_on(self.path / RESULTS, n_points)
        if self._kept is not None and model is not self._kept.model:
            writer.extend(model)
        return writer

    def _withdraw(self, writer: ResultsWriter | None, draft: Path, *, made: bool) -> None:
        """Leave nothing of results of which the disk does not take the first point."""
        with suppress(OSError):
            if writer is not None:
                writer.close()
        if self._lock is not None:  # else the draft is another run's
            draft.unlink(missing_ok=True)
        if made:
            with suppress(OSError):  # of something else that is in it
                self.path.rmdir()

    def _close_whole(self, writer: ResultsWriter, curve: CapacityCurve) -> OSError | None:
        """Bring the curve to the disk, then its last checkpoint; the error where that fails."""
        try:
            writer.close(curve)
        except OSError as error:
            return error
        if writer.whole and self._last is not None:
            with suppress(OSError):
                self._put(writer, self._last)
        return None

    def _finish(self, curve: CapacityCurve) -> None:
        """Write all files.  Where ``results.h5`` fails, the short files are still written, of the
        points that it has."""
        model, writer = self._model, self._writer
        assert model is not None and writer is not None
        failure = self._close_whole(writer, curve)
        if failure is not None and curve.status == "finished":
            curve = replace(curve, status="stopped", reason=str(as_output_error(failure)))
        if writer.n_kept < len(curve.points):
            curve = _as_kept(curve, writer.n_kept)
        beside = self.beside if isinstance(self.beside, Beside) else self.beside()
        done = finished(
            self.path,
            model,
            curve,
            beside,
            formats=self._formats,
            mechanism_displacement=self._mechanism_displacement,
        )
        self.summary = done.summary
        with uninterrupted():
            write_short(done)
        if failure is not None:
            raise failure
        if writer.whole:
            write_long(done, self._aside)


def _as_kept(curve: CapacityCurve, n: int) -> CapacityCurve:
    """The points that the disk has taken: all files of a folder are of the same."""
    lost = say("end.disk_took", most=len(curve.points), results=RESULTS, n=n)
    return replace(curve.first(n), reason=f"{curve.reason}; {lost}")


def files_of(folder: Path) -> list[Path]:
    """Files that an analysis writes into its folder, those of ParaView apart."""
    return [folder / name for name in (RESULTS, *file_names())]
