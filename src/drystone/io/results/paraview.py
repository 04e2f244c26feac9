"""Time series for ParaView, ``blocks.pvd`` and ``contacts.pvd``.

Their time is the step: it only grows, where the control displacement may go back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.contact.forces import ContactForces
from drystone.geometry import motion
from drystone.geometry.motion import in_space
from drystone.io.results import vtu
from drystone.io.results.names import PARAVIEW
from drystone.io.results.outputs import Finished, Output
from drystone.model.assembly import Assembly
from drystone.results.curve import CurvePoint
from drystone.results.frames import rows_along
from drystone.results.shapes import MovingShapes, compliance, moving_blocks

#: Grids written of one curve, about; a curve may have thousands of points.
MOST_FRAMES = 100
BLOCKS, CONTACTS = "blocks", "contacts"


def write_series(
    folder: Path,
    assembly: Assembly,
    points: Sequence[CurvePoint],
    frames: Sequence[int],
    pose: Callable[[int], Array],
    contacts: Callable[[int], ContactForces],
) -> None:
    """Write both series into ``folder``, which exists.

    Parameters
    ----------
    points
        The points of the curve.
    frames
        Rows of the points to write.
    pose, contacts
        Give the state of a row; row 0, where the load begins, and then each frame, in order.
    """
    blocks = BlockFrames(assembly, pose(0))
    block_files, contact_files = [], []
    for number, row in enumerate(frames):
        point = points[row]
        field_data = [
            vtu.field_value("TimeValue", float(point.step)),
            vtu.field_value("control_displacement", point.control_displacement),
            vtu.field_value("load_multiplier", point.load_multiplier),
            vtu.field_value("step", float(point.step)),
        ]
        name = f"{BLOCKS}_{number:04d}.vtu"
        blocks.write(folder / name, pose(row), field_data)
        block_files.append((float(point.step), name))
        name = f"{CONTACTS}_{number:04d}.vtu"
        write_contacts(folder / name, contacts(row), field_data)
        contact_files.append((float(point.step), name))
    vtu.write_pvd(folder / f"{BLOCKS}.pvd", block_files)
    vtu.write_pvd(folder / f"{CONTACTS}.pvd", contact_files)


def remove_series(folder: Path) -> None:
    """Remove the files of an earlier series, and nothing else."""
    for series in (BLOCKS, CONTACTS):
        for path in (folder / f"{series}.pvd", *folder.glob(f"{series}_[0-9][0-9][0-9][0-9].vtu")):
            path.unlink(missing_ok=True)


class BlockFrames:
    """Writes the blocks of one assembly; what never changes is encoded once.

    A cell is an outline in the plane, a convex part in space; ``block`` says of which block.
    Displacements are from the designed places; blocks that move are those that have moved since
    the poses ``initial``, (n, n_pose).
    """

    def __init__(self, assembly: Assembly, initial: Array | None = None) -> None:
        self._shapes = shapes = MovingShapes.of(assembly)
        self._start = shapes.vertices if initial is None else shapes.moved(initial)
        self._fixed = assembly.fixed
        self._compliance = compliance(shapes, initial, assembly.fixed)
        if faces := assembly.packed.face_arrays:
            self._cells = vtu.polyhedra(shapes.offset, *faces.values())
        else:
            rows = np.arange(len(shapes.vertices))
            self._cells = vtu.cells(rows, shapes.offset[1:], vtu.POLYGON)
        self._constant = [
            vtu.data_array("block", shapes.body),
            vtu.data_array("is_support", assembly.fixed.astype(np.uint8)[shapes.body]),
            vtu.data_array("weight", assembly.weight[shapes.body]),
        ]

    def write(self, path: Path, pose: Array, field_data: Iterable[str] = ()) -> None:
        """One grid: moved shapes, with displacement of the centroids [m] and rotation [rad], in
        space a vector."""
        shapes = self._shapes
        points = shapes.moved(pose)
        displacement = shapes.largest(points - self._start)
        moving = moving_blocks(displacement, self._fixed, self._compliance)
        away = points - shapes.vertices
        displacement = motion.translations(pose)[shapes.body]
        vtu.write_vtu(
            path,
            points=points,
            n_cells=len(shapes.body),
            cells=self._cells,
            point_data=[vtu.data_array("vertex_displacement", in_space(away))],
            cell_data=[
                *self._constant,
                vtu.data_array("displacement", in_space(displacement)),
                vtu.data_array("rotation", motion.rotation_vectors(pose)[shapes.body]),
                vtu.data_array("moving", moving.astype(np.uint8)[shapes.body]),
            ],
            field_data=field_data,
        )


@lru_cache(maxsize=16)
def _vertices(n: int) -> str:
    """Cells that are points, which many frames of a curve have as many of."""
    rows = np.arange(n)
    return vtu.cells(rows, rows + 1, vtu.VERTEX)


def write_contacts(path: Path, contacts: ContactForces, field_data: Iterable[str] = ()) -> None:
    """One grid: contact points with reactions [N] on block b, normals from a to b, gaps [m]."""
    vtu.write_vtu(
        path,
        points=contacts.position,
        n_cells=contacts.n_contacts,
        cells=_vertices(contacts.n_contacts),
        point_data=[
            vtu.data_array("reaction", in_space(contacts.vectors())),
            vtu.data_array("normal", in_space(contacts.normal)),
            vtu.data_array("normal_reaction", contacts.normal_reaction),
            vtu.data_array("gap", contacts.gap),
            vtu.data_array("status", contacts.status.astype(np.int8)),
            vtu.data_array("block_a", contacts.block_a),
            vtu.data_array("block_b", contacts.block_b),
        ],
        field_data=field_data,
    )


def _write(done: Finished, keys: Mapping[str, Any]) -> None:
    curve, results = done.curve, done.results
    assert results is not None
    peak = curve.points.index(curve.peak)
    frames = rows_along(curve.control_displacement, MOST_FRAMES, keep=[peak])
    write_series(
        done.folder / PARAVIEW,
        done.model.assembly,
        curve.points,
        frames,
        results.pose,
        results.contacts_in_turn(),
    )


#: Its files stand in a folder of their own, see `remove_series`.
SERIES_OUTPUT = Output(files=(), write=_write)
