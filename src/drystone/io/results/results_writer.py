"""Writes ``results.h5`` while an analysis runs; `hdf5` says what it holds.

Points are gathered in memory and written about once a second, more rarely where the disk is slow:
what is on the disk is a readable file at every moment (see `diskfile`), so that a process that is
killed, a power cut or a disk that is full leaves the points of up to a second ago.  The file is not
locked: it can be read while it grows.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Self
from uuid import uuid4

import h5py
import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array
from drystone.common.version import package_version
from drystone.contact.forces import ContactForces
from drystone.io.modelfile import model_to_dict
from drystone.io.modelfile.named import texts_of
from drystone.io.modelfile.parse import parse
from drystone.io.modelfile.write import to_toml
from drystone.io.results.diskfile import DiskFile
from drystone.io.results.hdf5 import (
    COLUMN_TYPES,
    CONTACT_FIELDS,
    LEFT_TYPES,
    OF_SPACE,
    RUNNING,
    STORED_AS,
    TIE_FIELDS,
    UNITS,
)
from drystone.io.results.interrupts import uninterrupted
from drystone.io.results.results_reader import ResultsReader
from drystone.model.assembly import Assembly
from drystone.model.model import Model
from drystone.model.ties import TieState, names_of
from drystone.results.curve import BlockLeft, CapacityCurve, CurvePoint
from drystone.results.shapes import MovingShapes

#: Points are written when this many seconds have passed since the last time, and as many times
#: those that writing took then ...
SECONDS, TIMES = 1.0, 100.0
#: ... or when this many bytes wait, whichever comes first.
BYTES = 32_000_000
#: States of more blocks than this are compressed: that takes little time beside their steps.
MANY_BODIES = 1000


class ResultsWriter:
    """Writes one ``results.h5``.  Replaces a file of that name."""

    def __init__(
        self, path: Path | str, model: Model, engine: str, strategy: str, *, part_of: str = ""
    ) -> None:
        self.run = uuid4().hex
        self._open(DiskFile(path), "w", n_points=0, n_contacts=0)
        large = model.assembly.n_bodies > MANY_BODIES
        self._packing: dict[str, Any] = (
            {"compression": "gzip", "compression_opts": 1, "shuffle": True} if large else {}
        )
        try:
            self._describe(model, engine, strategy, part_of=part_of)
            self._lay_out(model)
            self.flush()
        except BaseException:
            self._close_file()
            Path(path).unlink(missing_ok=True)
            raise

    @classmethod
    def going_on(cls, path: Path | str, n_points: int) -> Self:
        """A writer that goes on after the first points of a file; what it has beyond goes."""
        with ResultsReader(path) as stored:
            n_contacts = int(stored.n_contacts()[:n_points].sum())
            run = stored.run()
        writer = cls.__new__(cls)
        writer.run = run
        writer._open(DiskFile(path, on=True), "r+", n_points=n_points, n_contacts=n_contacts)
        writer._cut()
        return writer

    def _open(self, disk: DiskFile, mode: str, *, n_points: int, n_contacts: int) -> None:
        self._disk, self._file = disk, h5py.File(disk, mode)
        self.whole = True  # the disk took everything so far
        self.n_kept = n_points  # on the disk
        self._points: list[CurvePoint] = []
        self._poses: list[Array] = []
        self._contacts: list[ContactForces] = []
        self._ties: list[TieState] = []
        self._waiting = 0  # bytes
        self._n_points, self._n_contacts = n_points, n_contacts  # in the file
        self._written, self._pause = time.monotonic(), SECONDS

    def _cut(self) -> None:
        """Leave the file with its first points, as that of a run that has not ended."""
        n, file = self._n_points, self._file
        for rows in (*file["curve"].values(), file["poses"]):
            rows.resize(n, axis=0)
        for name, _, _ in TIE_FIELDS if "ties" in file else ():
            file["ties"][name].resize(n, axis=0)
        for name, rows in file["contacts"].items():
            rows.resize(n + 1 if name == "offset" else self._n_contacts, axis=0)
        if "blocks_left" in file:
            del file["blocks_left"]
        file.attrs["status"], file.attrs["reason"] = RUNNING, ""

    @property
    def syncs(self) -> bool:
        """See `DiskFile.syncs`."""
        return self._disk.syncs

    def append(
        self,
        point: CurvePoint,
        pose: Array,
        contacts: ContactForces,
        ties: TieState | None = None,
    ) -> None:
        """Take one point; the first is on the disk at once, others a second later, or after
        `flush`."""
        if ties is not None:
            self._ties.append(ties)
        self._points.append(point)
        self._poses.append(np.array(pose))
        self._contacts.append(contacts)
        self._waiting += pose.nbytes + sum(
            getattr(contacts, name).nbytes for name in CONTACT_FIELDS
        )
        first = self._n_points == 0
        if first or self._waiting > BYTES or time.monotonic() - self._written > self._pause:
            self.flush()

    def flush(self) -> None:
        """Write what waits and bring it to the disk; raises `OSError` where that takes no more."""
        begun, has_points = time.monotonic(), bool(self._points)
        with uninterrupted():
            self._lay_down()
            self._file.flush()
            try:
                self._disk.commit()
            except OSError:
                self.whole = False
                raise
        if has_points:  # else it says nothing of how long points take
            self._written = time.monotonic()
            self._pause = max(SECONDS, TIMES * (self._written - begun))
        self.n_kept = self._n_points

    def move(self, path: Path) -> None:
        """Give the file another name, in place of a file that has it; raises `OSError`."""
        self._disk.move(path)

    def close(self, curve: CapacityCurve | None = None) -> None:
        """Write what waits, and how the analysis ended where it did.  May be called twice.

        After a write that failed the file stays as it was before.
        """
        if not self._file:
            return
        try:
            if self.whole and curve is not None:
                attributes = self._file.attrs
                attributes["status"], attributes["reason"] = curve.status, _text_of(curve.reason)
                for name in ("stop_multiplier", "settlement", "wall_time", "compile_time"):
                    attributes[name] = getattr(curve, name)
                self._put_left(curve.blocks_left)
            if self.whole:
                self.flush()
        finally:
            self._close_file()

    def _put_left(self, left: Sequence[BlockLeft]) -> None:
        group = self._file.create_group("blocks_left")
        for name, kind in LEFT_TYPES.items():
            values = [getattr(block, name) for block in left]
            values = [_text_of(v) if isinstance(v, str) else v for v in values]
            group.create_dataset(name, data=np.array(values, dtype=kind))

    def _close_file(self) -> None:
        with uninterrupted():
            self._file.close()
            self._disk.close()

    def _lay_down(self) -> None:
        """Give HDF5 the points that wait."""
        if not self._points:
            return
        n = self._n_points
        for name, kind in COLUMN_TYPES.items():
            values = np.array([getattr(point, name) for point in self._points], dtype=kind)
            _put(self._file["curve"][name], n, values)
        _put(self._file["poses"], n, np.array(self._poses))
        if self._ties:
            for name, own, _ in TIE_FIELDS:
                rows = np.array([getattr(state, own) for state in self._ties])
                _put(self._file["ties"][name], n, rows)
        group = self._file["contacts"]
        counts = [contacts.n_contacts for contacts in self._contacts]
        for name in filter(group.__contains__, CONTACT_FIELDS):
            values = np.concatenate([getattr(c, name) for c in self._contacts])
            _put(group[name], self._n_contacts, values)
        # Last: what it counts is there.
        _put(group["offset"], n + 1, self._n_contacts + np.cumsum(counts))
        self._n_points += len(counts)
        self._n_contacts += sum(counts)
        self._points, self._poses, self._contacts, self._waiting = [], [], [], 0
        self._ties = []

    def extend(self, model: Model) -> None:
        """Say what is analysed from here on: the same model with another end."""
        self._file.attrs["model"] = _text_of(to_toml(model_to_dict(model)))
        self._file.attrs["stop_multiplier"] = model.analysis.stop_multiplier

    def _describe(self, model: Model, engine: str, strategy: str, *, part_of: str) -> None:
        """Say what is analysed."""
        text = _text_of_file(model)
        if text is None:
            data = model_to_dict(model)
            text = to_toml(data)
        else:
            data = parse(text.encode(), is_json=False)
        files = texts_of(model, data)
        group = self._file.create_group("files")
        for key, texts in (("name", files.keys()), ("text", files.values())):
            group[key] = np.array([_text_of(text) for text in texts], dtype=h5py.string_dtype())
        self._file.attrs.update(
            {
                "title": _text_of(model.title),
                "engine": engine,
                "strategy": strategy,
                "status": RUNNING,
                "reason": "",
                "stop_multiplier": model.analysis.stop_multiplier,
                "dimension": model.assembly.dimension,
                "thickness": model.assembly.thickness,
                "model": _text_of(text),
                "model_source": _text_of(model.source or ""),
                "model_sha256": model.sha256,
                "part_of": part_of,
                "run": self.run,
                "version": package_version(),
                "units": "SI: m, N, s, rad",
            }
        )

    def _lay_out(self, model: Model) -> None:
        assembly = model.assembly
        blocks = self._file.create_group("blocks")
        blocks["id"] = np.array(
            [_text_of(name) for name in assembly.ids], dtype=h5py.string_dtype()
        )
        for name, values in (
            *_shapes(assembly),
            ("centroid", assembly.centroid),
            ("weight", assembly.weight),
            ("support", assembly.fixed),
        ):
            blocks[name] = values
            if name in UNITS:
                blocks[name].attrs["unit"] = UNITS[name]

        groups = self._file.create_group("groups")
        groups["name"] = np.array(
            [_text_of(name) for name in assembly.groups], dtype=h5py.string_dtype()
        )
        members = list(assembly.groups.values())
        groups["offset"] = np.cumsum([0, *map(len, members)])
        groups["block"] = np.concatenate([np.zeros(0, np.int64), *members])

        curve = self._file.create_group("curve")
        for name, kind in COLUMN_TYPES.items():
            self._growing(curve, name, (), kind, rows=512)
        shape = assembly.design_pose().shape
        rows = int(np.clip(1_000_000 // (8 * shape[0] * shape[1]), 1, 64))
        self._growing(self._file, "poses", shape, np.dtype("f8"), rows=rows)
        self._file["poses"].attrs["unit"] = assembly.kind.pose_units

        if model.ties:
            ties, names = self._file.create_group("ties"), names_of(model.ties)
            ties["name"] = np.array([_text_of(n) for n in names], dtype=h5py.string_dtype())
            for name, _, stored in TIE_FIELDS:
                self._growing(ties, name, (len(names),), np.dtype(stored), rows=64)

        contacts = self._file.create_group("contacts")
        widths = {"position": assembly.dimension, "normal": assembly.dimension}
        widths["tangential_reaction"] = assembly.dimension - 1
        widths["tangent"] = assembly.dimension
        for name in CONTACT_FIELDS:
            if name in OF_SPACE and assembly.depth is not None:
                continue
            width = (widths[name],) if name in widths else ()
            self._growing(contacts, name, width, np.dtype(STORED_AS.get(name, "f8")), rows=16384)
        self._growing(contacts, "offset", (), np.dtype("i8"), rows=512)
        _put(contacts["offset"], 0, np.zeros(1, dtype=np.int64))

    def _growing(
        self,
        group: h5py.Group,
        name: str,
        shape: tuple[int, ...],
        kind: np.dtype[Any],
        *,
        rows: int,
    ) -> None:
        dataset = group.create_dataset(
            name,
            shape=(0, *shape),
            maxshape=(None, *shape),
            dtype=kind,
            chunks=(rows, *shape),
            **self._packing,
        )
        if name in UNITS:
            dataset.attrs["unit"] = UNITS[name]


def _shapes(assembly: Assembly) -> Iterator[tuple[str, NDArray[Any]]]:
    """Arrays of the blocks' shapes by their names in the file."""
    shapes = MovingShapes.of(assembly)
    yield "offset", shapes.offset
    yield "vertices", shapes.vertices
    faces = assembly.packed.face_arrays
    yield from faces.items()
    if faces:
        yield "axes", assembly.axes
    if faces or len(shapes.body) != assembly.n_bodies:
        yield "body", shapes.body


def _text_of_file(model: Model) -> str | None:
    """The model file, where that is all there is to the model: without imports, and as read."""
    if model.source is None:
        return None
    try:
        contents = Path(model.source).read_bytes()
    except OSError:
        return None
    if hashlib.sha256(contents).hexdigest() != model.sha256:
        return None
    return contents.decode("utf-8", errors="replace")


def _text_of(text: str) -> str:
    """A text that HDF5 takes: without the NUL, at which its own would end."""
    return text.replace("\0", "")


def _put(dataset: h5py.Dataset, start: int, values: NDArray[Any]) -> None:
    """Rows from ``start`` on, which become the last."""
    if len(values):
        dataset.resize(start + len(values), axis=0)
        dataset[start:] = values
