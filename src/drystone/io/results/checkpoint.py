"""``checkpoint.npz``: where a run stands between two steps, and the model that it traces.

The file holds three records, each as a tree for JSON and one array of bytes that its arrays lie in
(see `common.codec`).  It is written beside and then put in the place of the one before, so that one
is whole at every moment.  It belongs to the ``results.h5`` beside it whose attribute ``run`` is its
own; points that came after it are computed again.

``directions.npz``, of a model that is pushed in several directions, holds the model and what was
asked for.
"""

from __future__ import annotations

import io
import json
import os
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drystone.common.codec import CodecError, Packed, check_fields, packed, unpacked
from drystone.common.version import package_version
from drystone.io.results.folder import sync_folder, whole_file
from drystone.io.results.laidover import put_all
from drystone.model.model import Model
from drystone.results.checkpoint import Checkpoint

#: What is written of a `Standing` within its checkpoint: it stands beside it.
NOTHING = Packed(None, [])

#: Names of the files.
CHECKPOINT, PLAN = "checkpoint.npz", "directions.npz"


class CheckpointError(ValueError):
    """A checkpoint that cannot be used; the message says why, as the end of a sentence."""


class CheckpointWriter:
    """Writes the checkpoints of one run of a model."""

    def __init__(self, folder: Path, model: Model, run: str) -> None:
        self._path, self._run = folder / CHECKPOINT, run
        self._model = _entries("model", packed(model))

    def write(self, checkpoint: Checkpoint, *, sync: bool = True) -> None:
        """Put a checkpoint in the place of the last; raises `OSError`, and leaves that one then.

        With ``sync`` it outlasts a power cut.
        """
        about = {"run": self._run, "version": package_version()}
        entries: dict[str, Any] = {
            "about": _text(about),
            **self._model,
            **_entries("standing", checkpoint.standing),
            **_entries("checkpoint", packed(replace(checkpoint, standing=NOTHING))),
        }
        _put(self._path, entries, sync=sync)


def write_plan(
    folder: Path, model: Model, plan: Mapping[str, Any], before: Callable[[], None]
) -> None:
    """Keep what is asked for of a model in several directions; raises `OSError`.

    ``before`` is called once the plan is on the disk, before it has its name.
    """
    about = {"plan": plan, "version": package_version()}
    _put(folder / PLAN, {"about": _text(about), **_entries("model", packed(model))}, before=before)


def read_plan(folder: Path) -> tuple[Model, dict[str, Any]] | None:
    """Model and plan of several directions; None of other folders, `CheckpointError` of a file that
    cannot be used."""
    try:
        with _opened(folder / PLAN) as file:
            return _model(file), dict(json.loads(file["about"].tobytes())["plan"])
    except FileNotFoundError:
        return None


def read_checkpoint(folder: Path, run: str) -> tuple[Model, Checkpoint] | None:
    """Model and last checkpoint of a run; None where it has none.

    Raises
    ------
    CheckpointError
        There is one that this version cannot use.
    """
    try:
        with _opened(folder / CHECKPOINT) as file:
            if json.loads(file["about"].tobytes())["run"] != run:
                return None
            model, checkpoint = _model(file), unpacked(_parts("checkpoint", file))
            standing = _parts("standing", file)
            if not isinstance(checkpoint, Checkpoint):
                raise CheckpointError("it is damaged (it holds something else)")
            _check_version(standing)
            return model, replace(checkpoint, standing=standing)
    except FileNotFoundError:
        return None


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """A file of this version; what is wrong with it is a `CheckpointError`."""
    try:
        with np.load(path, allow_pickle=False) as file:
            version = json.loads(file["about"].tobytes())["version"]
            if version != package_version():
                raise CheckpointError(
                    f"version {version} has written it, and this is {package_version()}, whose "
                    "curve may be another"
                )
            yield file
    except (FileNotFoundError, CheckpointError):
        raise
    except (OSError, KeyError, ValueError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        raise CheckpointError(f"it is damaged ({error})") from None


def _check_version(standing: Packed) -> None:
    """Raise `CheckpointError` where a state has other fields than those of this version.

    Trees of the sources between two releases have one version.
    """
    try:
        check_fields(standing.tree)
    except (CodecError, ImportError, LookupError, TypeError, AttributeError) as error:
        raise CheckpointError(
            f"another version has written its state, which this one cannot continue ({error})"
        ) from None


def _model(file: Any) -> Model:
    model = unpacked(_parts("model", file), packages=_packages())
    if not isinstance(model, Model):
        raise CheckpointError("it is damaged (it holds something else)")
    return model


def _put(
    path: Path,
    entries: dict[str, Any],
    *,
    sync: bool = True,
    before: Callable[[], None] | None = None,
) -> None:
    """Write a file beside, then put it in its place; ``before`` is called between."""
    content = io.BytesIO()
    np.savez(content, **entries)
    with whole_file(path) as draft:
        with draft.open("wb", buffering=0) as file:
            put_all(file, content.getbuffer())
            if sync:
                os.fsync(file.fileno())
        if before is not None:
            before()
    if sync:
        sync_folder(path.parent)


def _entries(name: str, parts: Packed) -> dict[str, NDArray[Any]]:
    """A record as entries of the file; its arrays lie one after the other."""
    about, pieces, place = [], [], 0
    for array in parts.arrays:
        order: Literal["C", "F"] = (
            "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"
        )
        data = array.tobytes(order=order)
        about.append([array.dtype.str, array.shape, order, place])
        pieces.append(data)
        place += len(data)
    return {
        name: _text({"tree": parts.tree, "arrays": about}),
        f"{name}_arrays": np.frombuffer(b"".join(pieces), np.uint8),
    }


def _parts(name: str, file: Any) -> Packed:
    told, data = json.loads(file[name].tobytes()), file[f"{name}_arrays"].tobytes()
    arrays = []
    for kind, shape, order, place in told["arrays"]:
        dtype = np.dtype(kind)
        count = int(np.prod(shape, dtype=np.int64))
        if dtype.hasobject or count < 0 or place < 0:
            raise CheckpointError("it is damaged (an array that cannot be)")
        flat = np.frombuffer(data, dtype, count, place) if count else np.zeros(0, dtype)
        arrays.append(flat.reshape(shape, order=order).copy(order=order))
    return Packed(told["tree"], arrays)


def _text(value: Any) -> NDArray[np.uint8]:
    return np.frombuffer(json.dumps(value, allow_nan=False).encode(), np.uint8)


def _packages() -> set[str]:
    """Packages of others whose load patterns a model may have."""
    from drystone.model.loading.patterns import PATTERNS

    return {pattern.__module__.partition(".")[0] for _, pattern in PATTERNS.loaded()}
