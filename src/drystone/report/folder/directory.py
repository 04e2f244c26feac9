"""The folder of results of one analysis, filled while it runs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from drystone.contact.forces import ContactForces
from drystone.io.results.csv import write_curve, write_ties
from drystone.io.results.folder import (
    FolderLock,
    OutputError,
    as_output_error,
    check_apart,
    check_writable,
    in_a_sentence,
    whole_file,
)
from drystone.io.results.hdf5 import ResultsReader, ResultsWriter
from drystone.io.results.interrupts import uninterrupted
from drystone.io.results.own_files import (
    CURVE,
    CURVE_FIGURE,
    FILES,
    MECHANISM_FIGURE,
    PARAVIEW,
    RESULTS,
    SUMMARY,
    TIES,
    clear,
)
from drystone.io.results.paraview import choose_frames, write_series
from drystone.io.results.summary import plain, summarise, write_summary
from drystone.model.model import Model
from drystone.model.ties import TieState
from drystone.report import Mechanism, canvas, draw_curve, draw_mechanism
from drystone.report.mechanism import readable_magnification
from drystone.report.quantities import state_text
from drystone.results.curve import CapacityCurve, CurvePoint

if TYPE_CHECKING:
    from drystone.limit.beside import Beside

Array = NDArray[np.float64]

#: Control displacement [m] of the mechanism's picture, the published one.
MECHANISM_DISPLACEMENT = 0.2
#: The option of a model's analysis that says otherwise.
MECHANISM_OPTION = "mechanism_displacement"


class ResultsDirectory:
    """Records one analysis in a folder; a `Recorder` of the pushover.

    Nothing is written before the first point, so that a model that turns out to be wrong leaves no
    trace.  From then on ``results.h5`` grows with the analysis; the other files are written at its
    end, also when it was interrupted or the disk is full.  What the program has left there
    before, of runs, assessments and pages, goes first.  From the first point to the end the folder
    is locked.

    Parameters
    ----------
    path
        The folder; made where it is missing, with its parents.
    mechanism_displacement
        Control displacement [m] of ``mechanism.png``; by default what the model's analysis says
        under ``mechanism_displacement``, else 0.2 m.
    beside
        Multipliers of limit analysis, for ``summary.json`` and ``curve.png``.
    formats
        Of pictures beside PNG: "svg", "pdf".
    part_of
        Digest of the model in the folder above, of which this is the other sense.

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
        beside: Beside | None = None,
        formats: Sequence[str] = (),
        part_of: str = "",
    ) -> None:
        self.path = Path(path)
        from drystone.limit.beside import Beside  # takes long, which reading results need not

        self._beside = beside or Beside()
        self._formats = tuple(dict.fromkeys(("png", *formats)))
        self.summary: dict[str, Any] | None = None  # of the analysis, once it ended
        self._mechanism_displacement = mechanism_displacement
        self._model: Model | None = None
        self._names = ("", "")
        self._part_of = part_of
        self._ties: TieState | None = None  # of the point to come
        self._writer: ResultsWriter | None = None
        self._lock: FolderLock | None = None
        check_writable(self.path)

    @property
    def begun(self) -> bool:
        """Whether anything was written."""
        return self._writer is not None

    def begin(self, model: Model, engine: str, strategy: str) -> None:
        """Take note of what is analysed."""
        self._model, self._names = model, (engine, strategy)
        check_apart(model.source, files_of(self.path))

    def ties(self, ties: TieState) -> None:
        """Take what ties carry at the point to come."""
        self._ties = ties

    def point(self, point: CurvePoint, pose: Array, contacts: ContactForces) -> None:
        """Take one point of the curve."""
        if self._writer is None:
            self._writer = in_a_sentence(self._open)
        writer = self._writer
        try:
            in_a_sentence(lambda: writer.append(point, pose, contacts, self._ties))
        except OutputError:
            if not writer.n_kept:
                self._withdraw(writer)
            raise

    def end(self, curve: CapacityCurve) -> None:
        """Write everything that stands at the end: figures of the analysis first, pictures last."""
        if self._writer is not None and curve.points:
            in_a_sentence(lambda: self._finish(curve))
        self.close()

    def close(self) -> None:
        """Let go of ``results.h5`` and the folder; what was recorded stays."""
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

    def _open(self) -> ResultsWriter:
        if self._model is None:
            raise RuntimeError("`begin` comes before the first point")
        self.path.mkdir(parents=True, exist_ok=True)
        self._lock = FolderLock(self.path)
        (self.path / PARAVIEW).mkdir(exist_ok=True)
        clear(self.path)
        return ResultsWriter(self.path / RESULTS, self._model, *self._names, part_of=self._part_of)

    def _withdraw(self, writer: ResultsWriter) -> None:
        """Leave nothing of results of which the disk does not take the first point."""
        with suppress(OSError):
            writer.close()
        (self.path / RESULTS).unlink(missing_ok=True)
        for empty in (self.path / PARAVIEW, self.path):
            with suppress(OSError):  # of something else that is in it
                empty.rmdir()
        self._writer = None

    def _finish(self, curve: CapacityCurve) -> None:
        """What fails of ``results.h5`` keeps nothing from the short files, which may find room, of
        the points that it has."""
        model, writer = self._model, self._writer
        assert model is not None and writer is not None
        failure: OSError | None = None
        try:
            writer.close(curve)
        except OSError as error:
            failure = error
            if curve.status == "finished":
                curve = replace(curve, status="stopped", reason=str(as_output_error(error)))
        if writer.n_kept < len(curve.points):
            curve = _as_kept(curve, writer.n_kept)
        self.summary = summarise(curve, model) | {
            "associative_multiplier": self._beside.associative,
            "non_associative_multiplier": self._beside.non_associative,
            "collapse_range": plain(self._beside.collapse_range),
            "upper_bound": plain(self._beside.upper_bound),
        }
        with uninterrupted():
            write_curve(curve, self.path / CURVE)
            if curve.ties is not None:
                write_ties(curve, curve.ties, self.path / TIES)
            write_summary(self.summary, self.path / SUMMARY)
        if failure is not None:
            raise failure
        if writer.whole:
            self._draw(model, curve)

    def _draw(self, model: Model, curve: CapacityCurve) -> None:
        """Pictures and series, of the points that ``results.h5`` has."""
        for format in self._formats:
            with whole_file((self.path / CURVE_FIGURE).with_suffix(f".{format}")) as draft:
                draw_curve(
                    curve, draft, title=model.title, limits=self._beside.limits, format=format
                )
        with ResultsReader(self.path / RESULTS) as results:
            curve = replace(curve, points=curve.points[: results.n_points])
            self._draw_mechanism(model, curve, results)
            frames = choose_frames(
                curve.control_displacement, keep=[curve.points.index(curve.peak)]
            )
            write_series(
                self.path / PARAVIEW,
                model.assembly,
                curve.points,
                frames,
                results.pose,
                results.contacts,
            )

    def _draw_mechanism(self, model: Model, curve: CapacityCurve, results: ResultsReader) -> None:
        wanted = self._mechanism_displacement
        if wanted is None:
            usual = model.settlement.largest if model.settlement else MECHANISM_DISPLACEMENT
            wanted = float(model.analysis.options.get(MECHANISM_OPTION, usual))
        row = mechanism_row(curve, wanted)
        point, pose, settled = curve.points[row], results.pose(row), results.pose(0)
        gone = curve.gone(model.assembly.ids, point.step)
        pose = np.where(gone[:, None], settled, pose)  # they are shown as designed
        mechanism = Mechanism(
            assembly=model.assembly,
            pose=pose,
            settled=settled,
            gone=gone,
            contacts=results.contacts(row),
            load_direction=model.load_shown,
            control_point=model.control_point,
            ties=model.ties,
            dead_loads=model.dead_loads,
            tie_branch=curve.ties.branch[row] if curve.ties else None,
            magnification=readable_magnification(model.assembly, pose, settled),
        )
        title = mechanism_title(model.title, curve, point)
        for format in self._formats:
            with whole_file((self.path / MECHANISM_FIGURE).with_suffix(f".{format}")) as draft:
                draw_mechanism(mechanism, draft, title=title, format=format)


def _as_kept(curve: CapacityCurve, n: int) -> CapacityCurve:
    """The points that the disk has taken: all files of a folder are of the same."""
    lost = f"of {len(curve.points)} points {RESULTS} took the first {n}, and all files have these"
    return replace(curve.first(n), reason=f"{curve.reason}; {lost}")


def files_of(folder: Path) -> list[Path]:
    """Files that an analysis writes into its folder, those of ParaView apart."""
    return [folder / name for name in (*FILES, TIES)]


def mechanism_row(curve: CapacityCurve, control_displacement: float) -> int:
    """Row of the point nearest to a control displacement [m], the last if the curve ends before."""
    if float(curve.control_displacement.max()) < control_displacement:
        return len(curve.points) - 1
    return curve.nearest(control_displacement)


def mechanism_title(title: str, curve: CapacityCurve, point: CurvePoint) -> str:
    """What a picture shows: the point's own displacement, not the one that was asked for."""
    values = state_text(curve, point)
    return f"{canvas.literal(title)}: {values}" if title else values
