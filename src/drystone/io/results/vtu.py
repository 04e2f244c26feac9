"""VTK's XML format for unstructured grids, as much of it as blocks and contacts need.

Arrays are inline, base64, compressed by zlib: what ParaView itself writes.  See "VTK File Formats",
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

import base64
import struct
import sys
import zlib
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, IntArray
from drystone.geometry.motion import in_space

#: Cell types of VTK.
VERTEX, POLYGON, POLYHEDRON = 1, 7, 42
#: Bytes compressed at a time.
PIECE = 1 << 20

TYPE_NAMES = {
    np.dtype("f8"): "Float64",
    np.dtype("f4"): "Float32",
    np.dtype("i8"): "Int64",
    np.dtype("i4"): "Int32",
    np.dtype("i1"): "Int8",
    np.dtype("u1"): "UInt8",
}


def data_array(name: str, values: NDArray[np.generic]) -> str:
    """One ``<DataArray>``: a row per point or cell, components in columns."""
    values = np.ascontiguousarray(values)
    components = values.shape[1] if values.ndim == 2 else 1
    body = _encode(values.tobytes())
    return (
        f'<DataArray type="{TYPE_NAMES[values.dtype]}" Name="{escape(name)}" '
        f'NumberOfComponents="{components}" format="binary">{body}</DataArray>\n'
    )


def field_value(name: str, value: float) -> str:
    """One number that belongs to the whole grid."""
    return (
        f'<DataArray type="Float64" Name="{escape(name)}" NumberOfTuples="1" format="binary">'
        f"{_encode(struct.pack('=d', value))}</DataArray>\n"
    )


def cells(connectivity: IntArray, offsets: IntArray, kind: int) -> str:
    """Cells of one kind; cell ``i`` ends before entry ``offsets[i]`` of the connectivity."""
    return (
        data_array("connectivity", connectivity)
        + data_array("offsets", offsets)
        + data_array("types", np.full(len(offsets), kind, dtype=np.uint8))
    )


def polyhedra(
    offset: IntArray,
    rows: IntArray,
    face_offset: IntArray,
    part_faces: IntArray,
) -> str:
    """Cells that are polyhedra, packed as in `geometry.space.polyhedra.Polyhedra`.

    VTK's stream of faces has for each cell the number of its faces, and for each of these the
    number of its vertices before them.
    """
    n_faces, n_cells = len(face_offset) - 1, len(part_faces) - 1
    counts = np.diff(face_offset)
    cell = np.repeat(np.arange(n_cells), np.diff(part_faces))
    # Before face f stand its own count, those of the faces before it, and those of the cells.
    place = face_offset[:-1] + np.arange(n_faces) + cell + 1
    stream = np.empty(len(rows) + n_faces + n_cells, np.int64)
    stream[place] = counts
    first = part_faces[:-1]
    stream[first + face_offset[first] + np.arange(n_cells)] = np.diff(part_faces)
    face = np.repeat(np.arange(n_faces), counts)
    stream[place[face] + 1 + np.arange(len(rows)) - face_offset[face]] = rows
    ends = part_faces[1:] + face_offset[part_faces[1:]] + np.arange(1, n_cells + 1)
    return (
        cells(np.arange(offset[-1]), offset[1:], POLYHEDRON)
        + data_array("faces", stream)
        + data_array("faceoffsets", ends)
    )


def write_vtu(
    path: Path,
    *,
    points: Array,
    n_cells: int,
    cells: str,
    point_data: Iterable[str] = (),
    cell_data: Iterable[str] = (),
    field_data: Iterable[str] = (),
) -> None:
    """Write one grid, see `vtu_text`."""
    text = vtu_text(
        points=points,
        n_cells=n_cells,
        cells=cells,
        point_data=point_data,
        cell_data=cell_data,
        field_data=field_data,
    )
    path.write_text(text, encoding="ascii")


def vtu_text(
    *,
    points: Array,
    n_cells: int,
    cells: str,
    point_data: Iterable[str] = (),
    cell_data: Iterable[str] = (),
    field_data: Iterable[str] = (),
) -> str:
    """One grid as a file's contents.

    Parameters
    ----------
    points
        (n_points, 2 or 3) [m].
    n_cells, cells
        How many, and what `cells` made of them.
    point_data, cell_data, field_data
        Arrays as `data_array` and `field_value` give them.
    """
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    return (
        '<?xml version="1.0"?>\n'
        f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{order}" '
        'header_type="UInt64" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
        f"<FieldData>\n{''.join(field_data)}</FieldData>\n"
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{n_cells}">\n'
        f"<Points>\n{data_array('Points', in_space(points))}</Points>\n"
        f"<Cells>\n{cells}</Cells>\n"
        f"<PointData>\n{''.join(point_data)}</PointData>\n"
        f"<CellData>\n{''.join(cell_data)}</CellData>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )


def write_pvd(path: Path, frames: Sequence[tuple[float, str]]) -> None:
    """Write a time series: time and file name, relative to the series' own folder, of each grid."""
    entries = "".join(
        f'<DataSet timestep="{time!r}" group="" part="0" file="{escape(name)}"/>\n'
        for time, name in frames
    )
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
        f"<Collection>\n{entries}</Collection>\n</VTKFile>\n",
        encoding="utf-8",
    )


def _encode(raw: bytes) -> str:
    """Base64 of the header (pieces, size of one, of the last, when packed), then of the pieces."""
    pieces = [zlib.compress(raw[i : i + PIECE], 1) for i in range(0, len(raw), PIECE)]
    last = len(raw) % PIECE
    header = struct.pack(f"={3 + len(pieces)}Q", len(pieces), PIECE, last, *map(len, pieces))
    return (base64.b64encode(header) + base64.b64encode(b"".join(pieces))).decode("ascii")
