"""Arrays as few bytes: differences from point to point, byte planes, deflate.

A stream is one array.  Those that change from point to point are written as differences to the
point before (of their bits, as unsigned integers, so that nothing is lost), with the first bytes
of all values before their second: what hardly changes then becomes long runs of zeros.  Many
values are rounded to 16 bits before, over the largest of their point.
"""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array

#: How hard deflate tries: 9 takes thrice as long for a hundredth less.
LEVEL = 6
KINDS = {"f4": 4, "i2": 2, "u1": 1, "u2": 2, "u4": 4}


@dataclass
class Pack:
    """Streams one after the other, with the table that tells where each is."""

    table: list[dict[str, Any]] = field(default_factory=list)
    _chunks: list[bytes] = field(default_factory=list)
    _length: int = 0

    def put(self, name: str, values: Any, kind: str, *, varying: bool = False) -> None:
        """Add an array as ``kind``, see `KINDS`; ``varying`` ones change along their first axis."""
        array = np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))
        self.table.append(
            {
                "name": name,
                "kind": kind,
                "shape": list(array.shape),
                "offset": self._length,
                "varying": varying,
            }
        )
        chunk = _planes(array) if varying else array.tobytes()
        chunk += bytes(-len(chunk) % 4)  # the next one begins at a multiple of its items' size
        self._chunks.append(chunk)
        self._length += len(chunk)

    def put_varying(self, name: str, values: Array, *, rounded: bool, bits: int = 16) -> None:
        """Add values (n_points, n, c): floats, or rounded over the largest of point and component.

        ``bits`` are those that are kept of a rounded value.
        """
        values = np.asarray(values, dtype=np.float64)
        planes = np.moveaxis(values, 2, 0)  # components apart: they differ in size and course
        if not rounded:
            self.put(name, np.moveaxis(planes, 1, 0), "f4", varying=True)
            return
        numbers, scale = round_to_integers(values, bits)
        self.put(f"{name}_scale", scale, "f4")
        self.put(name, np.moveaxis(numbers, 2, 1), "i2", varying=True)

    def deflated(self) -> bytes:
        """All streams, in the format of zlib."""
        return zlib.compress(b"".join(self._chunks), LEVEL)

    def text(self) -> str:
        """All streams as letters that stand in a page."""
        return base64.b64encode(self.deflated()).decode("ascii")


def round_to_integers(values: Array, bits: int = 16) -> tuple[NDArray[np.int16], Array]:
    """Whole numbers (n_points, n, c) and what they are to be multiplied by, (n_points, c).

    A value is off by at most half of its ``scale``, which is the largest of the point and
    component over 2^(bits - 1) - 1.
    """
    largest = np.abs(values).max(axis=1, initial=0.0)
    most = 2 ** (bits - 1) - 1
    scale = np.where(largest > 0.0, largest, 1.0) / most
    return np.rint(values / scale[:, None]).astype(np.int16), scale


def _planes(array: NDArray[Any]) -> bytes:
    """Differences along the first axis, as unsigned integers, byte after byte of all values."""
    size = array.dtype.itemsize
    bits = array.view(f"<u{size}").copy()
    bits[1:] -= array.view(f"<u{size}")[:-1]
    return bits.reshape(-1).view(np.uint8).reshape(-1, size).T.tobytes()
