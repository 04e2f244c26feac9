"""Reads ``results.h5``, which may still grow; `hdf5` says what it holds."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, IntArray
from drystone.contact.forces import ContactForces
from drystone.io.results.hdf5 import (
    COLUMN_TYPES,
    CONTACT_FIELDS,
    LEFT_TYPES,
    STORED_AS,
    TIE_FIELDS,
)
from drystone.io.results.journal import overlaid, pending
from drystone.results.curve import BlockLeft, CurvePoint
from drystone.results.forces import TieRecord

#: Contact points that are read at a time where points are asked for in turn: some 2 MB.
READ_AHEAD = 1 << 14


class ResultsReader:
    """Reads a ``results.h5`` point by point, so that memory holds one state at a time."""

    def __init__(self, path: Path | str) -> None:
        self._file = _opened(Path(path))
        self._offset = self._file["contacts"]["offset"][:]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    @property
    def n_points(self) -> int:
        """Points whose contacts were written, too."""
        return len(self._offset) - 1

    def attribute(self, name: str) -> Any:
        """One of the attributes of the file, see the module's description."""
        return self._file.attrs[name]

    def run(self) -> str:
        """A word that no other run has, nor a run that was begun anew; empty in older files."""
        return str(self._file.attrs.get("run", ""))

    def part_of(self) -> str:
        """Digest of the model of which this is the other sense; empty where it is none."""
        return str(self._file.attrs.get("part_of", ""))

    def files(self) -> dict[str, str]:
        """Texts of the files that the model names, by their names."""
        if "files" not in self._file:  # of an older version
            return {}
        names, texts = (self._file["files"][key].asstr()[:] for key in ("name", "text"))
        return dict(zip(map(str, names), map(str, texts), strict=True))

    def points(self) -> tuple[CurvePoint, ...]:
        """All points of the curve."""
        columns = {
            name: self._file["curve"][name][: self.n_points].tolist()
            for name in COLUMN_TYPES
            if name in self._file["curve"]  # of those that came later, none in older files
        }
        columns["status"] = [status.decode() for status in columns["status"]]
        rows = zip(*columns.values(), strict=True)
        return tuple(CurvePoint(**dict(zip(columns, row, strict=True))) for row in rows)

    def blocks_left(self) -> tuple[BlockLeft, ...]:
        """Blocks that have left the structure; none are known while the analysis goes on."""
        group = self._file.get("blocks_left")
        if group is None:
            return ()
        names, steps, places = (group[name][:].tolist() for name in LEFT_TYPES)
        return tuple(
            BlockLeft(block=name.decode(), step=step, control_displacement=place)
            for name, step, place in zip(names, steps, places, strict=True)
        )

    def groups(self) -> dict[str, IntArray]:
        """Rows of the blocks of each group, ascending; none of older files."""
        if "groups" not in self._file:
            return {}
        names, offset, block = (self._file["groups"][key][:] for key in ("name", "offset", "block"))
        return {
            name.decode(): block[offset[k] : offset[k + 1]] for k, name in enumerate(names.tolist())
        }

    def ties(self) -> TieRecord | None:
        """What every tie carried at every point; None where there are no ties."""
        group = self._file.get("ties")
        if group is None or len(group["force"]) < self.n_points:
            return None
        values = {own: group[name][: self.n_points] for name, own, _ in TIE_FIELDS}
        return TieRecord(
            names=tuple(name.decode() for name in group["name"][:]),
            force=values["force"],
            elongation=values["elongation"],
            branch=values["branch"].astype(np.int64),
        )

    @cached_property
    def _poses(self) -> h5py.Dataset:
        return self._file["poses"]  # to look it up takes longer than to read one point of it

    def poses(self) -> Array:
        """Poses of the blocks at all points, (n_points, n, n_pose)."""
        return np.asarray(self._poses[: self.n_points])

    def pose(self, k: int) -> Array:
        """Poses of the blocks at point ``k``, (n, n_pose)."""
        return np.asarray(self._poses[k])

    def blocks(self) -> dict[str, NDArray[Any]]:
        """What the file tells of the blocks, by the names of the module's description."""
        return {name: values[:] for name, values in self._file["blocks"].items()}

    def contacts(self, k: int) -> ContactForces:
        """Contact points at point ``k``."""
        return self.contacts_between(k, k + 1)

    def contacts_in_turn(self) -> Callable[[int], ContactForces]:
        """What gives the contact points at one point after another, in ascending order: those of
        several points are read at a time."""
        first, last, held = 0, 0, self.contacts_between(0, 0)

        def contacts(k: int) -> ContactForces:
            nonlocal first, last, held
            if not first <= k < last:
                rows = int(self._offset[k]) + READ_AHEAD
                first, last = k, max(k + 1, int(self._offset.searchsorted(rows, "right")) - 1)
                held = self.contacts_between(first, last)
            start = self._offset[first]
            return held.rows(slice(self._offset[k] - start, self._offset[k + 1] - start))

        return contacts

    def n_contacts(self) -> IntArray:
        """Contact points at every point, (n_points,)."""
        return np.diff(self._offset)

    def contacts_between(self, first: int, last: int) -> ContactForces:
        """Contact points at the points from ``first`` to before ``last``, one after the other."""
        rows = slice(self._offset[first], self._offset[last])
        group = self._file["contacts"]
        values = {name: group[name][rows] for name in CONTACT_FIELDS if name in group}
        return ContactForces(
            **{n: v.astype(np.int64) if n in STORED_AS else v for n, v in values.items()}
        )


def _opened(path: Path) -> h5py.File:
    """A file to read, with what a writer that was killed has left to be written over it."""
    found = pending(path)
    if found is None:
        return h5py.File(path, "r", locking=False)
    return h5py.File(overlaid(path, *found), "r")
