"""``checkpoint.npz``: where a run stands between two steps, and the model that it traces.

The file holds three records, each as a tree for JSON and one array of bytes that its arrays lie in
(see `common.codec`).  It is written beside and then put in the place of the one before, so that one
is whole at every moment.  It belongs to the ``results.h5`` beside it whose attribute ``run`` is its
own; points that came after it are computed again.
"""

from __future__ import annotations

import io
import json
import os
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drystone.common.codec import CodecError, Packed, packed, unpacked
from drystone.io.results.folder import sync_folder, whole_file
from drystone.io.results.summary import package_version
from drystone.model.model import Model
from drystone.results.checkpoint import Checkpoint

#: What is written of a `Standing` within its checkpoint: it stands beside it.
NOTHING = Packed(None, [])

#: Name of the file.
CHECKPOINT = "checkpoint.npz"


class CheckpointError(ValueError):
    """A checkpoint that cannot be used; the message says why, as the end of a sentence."""


class CheckpointWriter:
    """Writes the checkpoints of one run of a model."""

    def __init__(self, folder: Path, model: Model, run: str) -> None:
        self._path, self._run = folder / CHECKPOINT, run
        self._model = _entries("model", packed(model))

    def write(self, checkpoint: Checkpoint) -> None:
        """Put a checkpoint in the place of the last; raises `OSError`, and leaves that one then."""
        about = {"run": self._run, "version": package_version()}
        entries: dict[str, Any] = {
            "about": _text(about),
            **self._model,
            **_entries("standing", checkpoint.standing),
            **_entries("checkpoint", packed(replace(checkpoint, standing=NOTHING))),
        }
        content = io.BytesIO()
        np.savez(content, **entries)
        with whole_file(self._path) as draft, draft.open("wb", buffering=0) as file:
            view = content.getbuffer()
            while view:
                view = view[file.write(view) or 0 :]
            os.fsync(file.fileno())
        sync_folder(self._path.parent)


def read_checkpoint(folder: Path, run: str) -> tuple[Model, Checkpoint] | None:
    """Model and last checkpoint of a run; None where it has none.

    Raises
    ------
    CheckpointError
        There is one that this version cannot use.
    """
    path = folder / CHECKPOINT
    try:
        with np.load(path, allow_pickle=False) as file:
            about = json.loads(file["about"].tobytes())
            if about["run"] != run:
                return None
            if about["version"] != package_version():
                raise CheckpointError(
                    f"version {about['version']} has written it, and this is {package_version()}, "
                    "whose curve may be another"
                )
            model = unpacked(_parts("model", file), packages=_packages())
            checkpoint = unpacked(_parts("checkpoint", file))
            standing = _parts("standing", file)
    except FileNotFoundError:
        return None
    except (OSError, KeyError, ValueError, TypeError, zipfile.BadZipFile, CodecError) as error:
        if isinstance(error, CheckpointError):
            raise
        raise CheckpointError(f"it is damaged ({error})") from None
    if not isinstance(model, Model) or not isinstance(checkpoint, Checkpoint):
        raise CheckpointError("it is damaged (it holds something else)")
    return model, replace(checkpoint, standing=standing)


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
