"""Samples and curves as Parquet: parts while a study runs, one table of each at its end.

A part holds some samples, whole or not at all: it is written beside and then renamed, its curves
first.  What a process had not written when it was killed is computed again.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.arrays import BoolArray
from drystone.io.results.folder import whole_file
from drystone.studies.errors import needed
from drystone.studies.sample import Outcome

SAMPLES, CURVES, FAILURES = "samples.parquet", "curves.parquet", "failures.parquet"
PARTS = "parts"
KINDS = (CURVES, FAILURES, SAMPLES)  # the last says that the others are whole

#: Columns whose type is not that of a number with decimals.
_WHOLE = ("sample", "seed", "n_points")
_TEXT = ("status", "reason", "version", "digest", "governing_sense")
_TRUTH = ("certified", "peak_passed", "stands", "satisfied", "satisfied_against")

#: Samples that are put in order at a time: of 1e5 samples 17 MiB less than with four times as many.
WINDOW = 5_000


class Parts:
    """The parts in a folder of results."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder / PARTS
        self._whole = folder
        self._next = 1 + max((number for number, _ in self._found(SAMPLES)), default=-1)

    def reopen(self) -> None:
        """Take a finished table as the first part again, and leave out what was half written.

        A table of samples beside parts of samples has them all: the process that merged them was
        killed before it removed the parts.
        """
        if (self._whole / SAMPLES).exists() and any(self._found(SAMPLES)):
            self.discard()
            self._next = 0
        self._folder.mkdir(parents=True, exist_ok=True)
        for draft in self._folder.glob("*.part"):
            draft.unlink()
        for kind in KINDS:
            whole = self._whole / kind
            if whole.exists():
                whole.replace(self._path(kind, self._next))
        known = {number for number, _ in self._found(SAMPLES)}
        for kind in KINDS[:-1]:
            for number, path in self._found(kind):
                if number not in known:
                    path.unlink()
        self._next = 1 + max(known, default=-1)

    def done(self, count: int) -> BoolArray:
        """Which samples are in parts, (count,)."""
        parquet = needed("pyarrow.parquet")
        done = np.zeros(count, dtype=np.bool_)
        for _, path in self._found(SAMPLES):
            own = parquet.read_table(path, columns=["sample"])["sample"].to_numpy()
            done[own[own < count]] = True
        return done

    def write(self, outcomes: Sequence[Outcome]) -> None:
        """Write a part of these samples."""
        if not outcomes:
            return
        self._folder.mkdir(parents=True, exist_ok=True)
        outcomes = sorted(outcomes, key=lambda outcome: int(outcome.row["sample"]))
        tables = {
            CURVES: _curves(outcomes),
            FAILURES: _failures(outcomes),
            SAMPLES: samples_table([outcome.row for outcome in outcomes]),
        }
        for kind in KINDS:
            if tables[kind].num_rows:
                write_table(tables[kind], self._path(kind, self._next))
        self._next += 1

    def merge(self, count: int | None = None) -> None:
        """Put all parts in the order of the samples into one table of each kind; then they go.

        A window of samples is in memory at a time.

        Parameters
        ----------
        count
            Of samples that the tables have: parts may have more, of a longer study.
        """
        for kind in KINDS:
            files = [_Part(path) for _, path in self._found(kind)]
            files = [file for file in files if count is None or file.first < count]
            if files:
                with whole_file(self._whole / kind) as draft:
                    _merged(files, draft, count)
        self.discard()

    def discard(self) -> None:
        """Remove all parts, those of samples last."""
        for kind in KINDS:
            for _, path in self._found(kind):
                path.unlink()
        if self._folder.is_dir() and not any(self._folder.iterdir()):
            self._folder.rmdir()

    def _path(self, kind: str, number: int) -> Path:
        return self._folder / f"{kind.removesuffix('.parquet')}-{number:06d}.parquet"

    def _found(self, kind: str) -> list[tuple[int, Path]]:
        name = re.compile(re.escape(kind.removesuffix(".parquet")) + r"-(\d+)\.parquet")
        if not self._folder.is_dir():
            return []
        matches = ((name.fullmatch(path.name), path) for path in sorted(self._folder.iterdir()))
        return [(int(match[1]), path) for match, path in matches if match]


def samples_table(rows: Sequence[Mapping[str, Any]]) -> Any:
    """A table of rows, which may have different columns."""
    arrow = needed("pyarrow")
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {name: [row.get(name) for row in rows] for name in names}
    return arrow.table(
        {name: arrow.array(own, type=_type_of(name, own)) for name, own in columns.items()}
    )


def _type_of(name: str, values: Sequence[Any]) -> Any:
    arrow = needed("pyarrow")
    if name in _WHOLE:
        return arrow.int64()
    if name in _TEXT or any(isinstance(value, str) for value in values):
        return arrow.string()
    if name in _TRUTH or any(isinstance(value, bool) for value in values):
        return arrow.bool_()
    # Where no sample of a part has a value, other parts say what it is.
    return arrow.null() if all(value is None for value in values) else arrow.float64()


def _curves(outcomes: Sequence[Outcome]) -> Any:
    """A table of points, those of a sample one after the other."""
    arrow = needed("pyarrow")
    traced = [(o.row["sample"], o.curve) for o in outcomes if o.curve is not None]
    number = [np.full(curve.shape[1], sample, dtype=np.int64) for sample, curve in traced]
    point = [np.arange(curve.shape[1], dtype=np.int32) for _, curve in traced]
    both = np.hstack([curve for _, curve in traced]) if traced else np.empty((2, 0))
    return arrow.table(
        {
            "sample": np.concatenate(number) if number else np.empty(0, np.int64),
            "point": np.concatenate(point) if point else np.empty(0, np.int32),
            "control_displacement": both[0],
            "load_multiplier": both[1],
        }
    )


def _failures(outcomes: Sequence[Outcome]) -> Any:
    """A table of the samples without a result, each with its model as JSON."""
    arrow = needed("pyarrow")
    failed = [outcome for outcome in outcomes if outcome.model is not None]
    return arrow.table(
        {
            "sample": arrow.array([o.row["sample"] for o in failed], type=arrow.int64()),
            "reason": arrow.array([o.row["reason"] for o in failed], type=arrow.string()),
            "model": arrow.array([o.model for o in failed], type=arrow.string()),
        }
    )


def write_table(table: Any, path: Path) -> None:
    """Write a table, whole or not at all."""
    with whole_file(path) as draft:
        needed("pyarrow.parquet").write_table(table, draft, compression="zstd")


def _merged(files: Sequence[_Part], draft: Path, count: int | None) -> None:
    """One table in the order of the samples, of the first so many."""
    arrow, parquet = needed("pyarrow"), needed("pyarrow.parquet")
    schema = arrow.unify_schemas([file.schema for file in files], promote_options="permissive")
    schema = _with_values(schema.remove_metadata())
    end = max(file.last for file in files) + 1
    end = end if count is None else min(end, count)
    with parquet.ParquetWriter(draft, schema, compression="zstd") as writer:
        for begin in range(min(file.first for file in files), end, WINDOW):
            before = min(begin + WINDOW, end)
            own = [
                table
                for file in files
                if file.first < before and file.last >= begin
                for table in file.between(begin, before)
            ]
            if own:
                whole = arrow.concat_tables(own, promote_options="permissive")
                order = np.argsort(whole["sample"].to_numpy(), kind="stable")
                writer.write_table(whole.take(order).cast(schema))


def _with_values(schema: Any) -> Any:
    """The columns of a table; those in which no sample has a value are of numbers."""
    arrow = needed("pyarrow")
    return arrow.schema(
        [
            arrow.field(own.name, arrow.float64()) if arrow.types.is_null(own.type) else own
            for own in schema
        ]
    )


class _Part:
    """A file of a part: which samples it has, known without reading it."""

    def __init__(self, path: Path) -> None:
        parquet = needed("pyarrow.parquet")
        self._path = path
        with parquet.ParquetFile(path) as file:
            self.schema = file.schema_arrow
            column = self.schema.names.index("sample")
            about = [
                file.metadata.row_group(i).column(column).statistics
                for i in range(file.metadata.num_row_groups)
            ]
        self.first = min(statistics.min for statistics in about)
        self.last = max(statistics.max for statistics in about)

    def between(self, begin: int, end: int) -> Iterator[Any]:
        """Rows of samples from one number to before another."""
        compute, parquet = needed("pyarrow.compute"), needed("pyarrow.parquet")
        field = compute.field("sample")
        yield parquet.read_table(self._path, filters=(field >= begin) & (field < end))


def read_samples(folder: Path, columns: Sequence[str] | None = None) -> Any:
    """The samples of a finished study, a frame of pandas; `OSError` where there are none."""
    return needed("pandas").read_parquet(
        folder / SAMPLES, columns=None if columns is None else list(columns)
    )


def column_names(folder: Path) -> list[str]:
    """Names of the columns of samples."""
    return list(needed("pyarrow.parquet").read_schema(folder / SAMPLES).names)


def some_curves(folder: Path, most: int) -> Any:
    """Curves of samples evenly spread over the study, at most so many: arrays (n, points) of
    control displacement [m] and load multiplier, and their samples (n,)."""
    parquet = needed("pyarrow.parquet")
    if not (folder / CURVES).exists():
        return np.empty((0, 0)), np.empty((0, 0)), np.empty(0, np.int64)
    with parquet.ParquetFile(folder / CURVES) as file:
        points = int(file.read_row_group(0, columns=["point"])["point"].to_numpy().max()) + 1
        n = file.metadata.num_rows // points
        every = max(1, -(-n // most))
        kept: list[Any] = []
        at = 0
        for batch in file.iter_batches(batch_size=points * 4096):
            rows = np.arange(at, at + batch.num_rows)
            chosen = (rows // points) % every == 0
            at += batch.num_rows
            names = ("control_displacement", "load_multiplier", "sample")
            kept.append([batch.column(name).to_numpy()[chosen] for name in names])
    d, m, sample = (np.concatenate(columns) for columns in zip(*kept, strict=True))
    return d.reshape(-1, points), m.reshape(-1, points), sample[::points]
