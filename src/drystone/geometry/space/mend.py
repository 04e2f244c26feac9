"""Solids as drawn made solids that touch: surfaces closed, faces flat, joints without gaps.

A drawing is rounded, holds faces twice, in pieces or inside out, and faces that were meant to lie
on each other do not.  First each solid is put in order by itself; then those planes that belong
together are found: of one face, of faces that nearly lie on each other, of vertices that nearly lie
in a neighbour's face.  All vertices are moved into their planes at once, as little as may be.
Every change is recorded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from drystone.common.arrays import Array, BoolArray
from drystone.common.tolerances import MENDED_FLAT, ONE_FACE, ROUNDING, SAME_POINT, TILTED, WELDED
from drystone.geometry import GeometryError
from drystone.geometry.mended import FANS, Mended
from drystone.geometry.space import solid
from drystone.geometry.space.bends import Cut, along_bends, as_fans
from drystone.geometry.space.flatness import off_plane, plane_labels, united
from drystone.geometry.space.meshes import (
    Mesh,
    is_flat,
    once,
    oriented,
    shells,
    shortest_edge,
    stitched,
    unevenness,
    welded,
)
from drystone.geometry.space.neighbours import meeting_faces, vertices_in_faces
from drystone.geometry.space.planes import Incidences, fitted_planes, onto_planes
from drystone.geometry.space.solid import Faces, volume_of

#: How bent faces were cut, as the end of sentences.
FANNED, BENT = "into fans from their first corners", "along their bends"
#: How often joints that cannot be closed are given up, before all of them are.
ATTEMPTS = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnSolid:
    """A solid as a file holds it: faces of vertices, in any state."""

    name: str
    vertices: Array  # (n, 3) m
    faces: Faces
    support: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class MendedSolid:
    """A solid that `solid.check` passes."""

    name: str
    source: int  # row of what was drawn
    vertices: Array
    faces: Faces


def mended_solids(
    drawn: Sequence[DrawnSolid], tolerance: float, bent: str = FANS, overlap: float = 0.0
) -> tuple[list[MendedSolid], list[Mended]]:
    """Solids from what was drawn, a closed surface each, and what was done to them.

    Parameters
    ----------
    drawn
        Those of several surfaces become several solids: name/1, name/2, ...
    tolerance
        Largest distance by which vertices are moved, over the shortest edge of their solid.
    bent
        How faces are cut that are farther off a plane: `mended.FANS`, in solids that these do not
        make cross themselves, and on whose bent faces no other one lies; or `mended.BENDS`.
    overlap
        Distance [m] up to which faces that stand in each other are put in one plane, too; their
        vertices move by up to `TILTED` times as much.

    Raises
    ------
    GeometryError
        Something is no solid and cannot be made one; the message names it and, where it is open,
        the edges.
    """
    records: list[Mended] = []
    surfaces: list[_Surface] = []
    for source, one in enumerate(drawn):
        try:
            surfaces += _surfaces(one, source, tolerance, records)
        except GeometryError as error:
            raise GeometryError(f'"{one.name}": {error}') from None
    if not surfaces:
        return [], records
    surfaces = _cut(surfaces, tolerance, bent, records)
    pieces = [_piece(surface, tolerance, records) for surface in surfaces]
    support = [drawn[piece.source].support for piece in pieces]
    moved = _fitted(pieces, support, overlap, records)
    solids = []
    for piece, vertices in zip(pieces, moved, strict=True):
        way = float(np.linalg.norm(vertices - piece.mesh.vertices, axis=1).max())
        if way > ROUNDING * solid.size_of(vertices):
            records.append(
                Mended(block=piece.name, what="had vertices moved to close joints", how_much=way)
            )
        faces = solid.turned_out(vertices, piece.mesh.faces)
        try:
            solid.check(vertices, faces)
        except GeometryError as error:
            raise GeometryError(f'"{piece.name}": {error}') from None
        solids.append(
            MendedSolid(name=piece.name, source=piece.source, vertices=vertices, faces=faces)
        )
    return solids, records


# --- one by one -------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Surface:
    """A closed surface of what was drawn, its faces outward."""

    name: str
    source: int
    mesh: Mesh


@dataclass(frozen=True, eq=False)
class _Piece(_Surface):
    """A closed surface of nearly flat faces."""

    label: list[int]  # which plane each face lies in
    near: float  # m, by how much vertices may be moved


def _surfaces(
    one: DrawnSolid, source: int, tolerance: float, records: list[Mended]
) -> list[_Surface]:
    """The closed surfaces of what was drawn as one."""
    if not np.isfinite(one.vertices).all():
        raise GeometryError("every coordinate must be a finite number")
    if not one.faces:
        raise GeometryError("it has no faces: draw a closed surface")
    whole, _ = welded(Mesh.of_used(one.vertices, one.faces), SAME_POINT * _size(one.vertices))
    if not whole.faces:
        raise GeometryError("all its faces are points or lines: draw a closed surface")
    whole, doubles = once(whole)
    found = []
    meshes = shells(whole)
    for k, shell in enumerate(meshes, 1):
        name = one.name if len(meshes) == 1 else f"{one.name}/{k}"
        try:
            found.append(_Surface(name, source, _closed(shell, name, tolerance, records)))
        except GeometryError as error:
            if len(meshes) == 1:
                raise
            raise GeometryError(f"surface {k} of {len(meshes)}: {error}") from None
    if doubles:
        records.append(
            Mended(block=one.name, what="had faces that were drawn twice", count=doubles)
        )
    return found


def _size(vertices: Array) -> float:
    return solid.size_of(vertices) if len(vertices) else 0.0


def _closed(mesh: Mesh, name: str, tolerance: float, records: list[Mended]) -> Mesh:
    """A shell without gaps, its faces outward."""

    def note(what: str, count: int) -> None:
        if count:
            records.append(Mended(block=name, what=what, count=count))

    size = _size(mesh.vertices)
    if is_flat(mesh, ROUNDING):
        raise GeometryError("it is flat and encloses no volume: give it a thickness")
    mesh, count = welded(mesh, WELDED * tolerance * size)
    note("had vertices so near to each other that they were made one", count)
    if len(mesh.faces) < 4:
        raise GeometryError("less than four faces are left of it: draw a closed surface")
    mesh, count = stitched(mesh, max(WELDED * tolerance, SAME_POINT) * size)
    note("had edges that other vertices lay on", count)
    mesh, count = oriented(mesh)
    note("had faces that ran clockwise and were turned round", count)
    return mesh


def _cut(
    surfaces: Sequence[_Surface], tolerance: float, bent: str, records: list[Mended]
) -> list[_Surface]:
    """Surfaces of faces that are nearly flat."""
    near = [_near(surface.mesh, tolerance) for surface in surfaces]
    cuts = [along_bends(one.mesh, own) for one, own in zip(surfaces, near, strict=True)]
    shared = _lain_on(cuts, np.array(near)) if bent == FANS else set()
    found = []
    for k, (surface, cut) in enumerate(zip(surfaces, cuts, strict=True)):
        fans = as_fans(cut) if bent == FANS and cut.bent and k not in shared else None
        mesh = (fans or cut).mesh
        if cut.bent:
            how, other, than = (FANNED, cut.mesh, BENT) if fans else (BENT, surface.mesh, FANNED)
            more = volume_of(mesh.vertices, mesh.faces) - volume_of(other.vertices, other.faces)
            records.append(
                Mended(
                    block=surface.name,
                    what=f"had faces that were not flat and were cut {how}",
                    count=len(cut.bent),
                    volume=more,
                    than=than,
                )
            )
        found.append(_Surface(surface.name, surface.source, mesh))
    return found


def _near(mesh: Mesh, tolerance: float) -> float:
    """By how much vertices may be moved [m]."""
    return max(tolerance * shortest_edge(mesh), ROUNDING * _size(mesh.vertices))


def _lain_on(cuts: Sequence[Cut], near: Array) -> set[int]:
    """Surfaces on whose bent faces another one lies."""
    if not any(cut.bent for cut in cuts):
        return set()
    owners, bent = [cut.owner for cut in cuts], [set(cut.bent) for cut in cuts]
    found = set()
    for a, p, b, q in meeting_faces([cut.mesh for cut in cuts], near):
        found |= {i for i, face in ((a, p), (b, q)) if owners[i][face] in bent[i]}
    return found


def _piece(surface: _Surface, tolerance: float, records: list[Mended]) -> _Piece:
    """A surface with faces that lie in one plane made one, and the planes."""
    name, mesh = surface.name, surface.mesh

    def note(what: str, count: int) -> None:
        if count:
            records.append(Mended(block=name, what=what, count=count))

    size = _size(mesh.vertices)
    within = max(ONE_FACE * tolerance * shortest_edge(mesh), ROUNDING * size)
    mesh, label, n_faces, n_vertices = united(mesh, plane_labels(mesh, within), within)
    note("had faces in one plane that were made one", n_faces)
    note("had vertices within edges or faces, which were left out", n_vertices)
    off = zip(mesh.faces, unevenness(mesh).tolist(), strict=True)
    rough = [face for face, by in off if by > ROUNDING * size]
    uneven = max((off_plane(mesh.vertices[list(face)]) for face in rough), default=0.0)
    if uneven > ROUNDING * size:
        records.append(
            Mended(
                block=name,
                what="had faces that were nearly flat and were made flat",
                how_much=uneven,
            )
        )
    return _Piece(name, surface.source, mesh, label, tolerance * shortest_edge(mesh))


# --- all together -----------------------------------------------------------------------------


class _Planes:
    """Vertices and planes of all pieces by number, and what may belong together."""

    def __init__(self, pieces: Sequence[_Piece], near: Array, overlap: float) -> None:
        meshes = [piece.mesh for piece in pieces]
        count = [max(piece.label) + 1 for piece in pieces]
        self.first_vertex = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
        self.first_plane = np.cumsum([0, *count])
        own = [
            (self.first_vertex[k] + i, self.first_plane[k] + label)
            for k, piece in enumerate(pieces)
            for face, label in zip(piece.mesh.faces, piece.label, strict=True)
            for i in face
        ]
        self.own = np.array(own, np.int64)

        def plane_of(k: int, face: int) -> int:
            return int(self.first_plane[k] + pieces[k].label[face])

        reach = np.maximum(near, overlap)
        meeting = meeting_faces(meshes, reach) if reach.any() else []
        lying = vertices_in_faces(meshes, near, meeting) if near.any() else []
        #: Pieces and planes of faces that lie on each other, (n, 4).
        self.joints = np.array(
            [(a, b, plane_of(a, p), plane_of(b, q)) for a, p, b, q in meeting], np.int64
        ).reshape(-1, 4)
        #: Pieces, vertex of the first and plane of the second that it lies in, (n, 4).
        self.snaps = np.array(
            [(a, b, self.first_vertex[a] + i, plane_of(b, face)) for a, i, b, face in lying],
            np.int64,
        ).reshape(-1, 4)

    def incidences(self, unjoined: BoolArray, unsnapped: BoolArray) -> Incidences:
        """Which vertex belongs to which plane, without joints and vertices of some pieces."""
        joints = self.joints[~unjoined[self.joints[:, :2]].any(axis=1)]
        snaps = self.snaps[~unsnapped[self.snaps[:, :2]].any(axis=1)]
        n = int(self.first_plane[-1])
        links = coo_array((np.ones(len(joints)), (joints[:, 2], joints[:, 3])), shape=(n, n))
        _, one = connected_components(links, directed=False)
        vertex = np.concatenate((self.own[:, 0], snaps[:, 2]))
        return Incidences.of(vertex, one[np.concatenate((self.own[:, 1], snaps[:, 3]))])


def _fitted(
    pieces: Sequence[_Piece], support: Sequence[bool], overlap: float, records: list[Mended]
) -> list[Array]:
    """Vertices of each piece in the planes that they belong to."""
    near = np.array([piece.near for piece in pieces])
    planes = _Planes(pieces, near, overlap)
    vertices = np.vstack([piece.mesh.vertices for piece in pieces])
    origin = vertices.mean(axis=0)  # a near origin keeps digits
    place = vertices - origin
    owner = np.repeat(np.arange(len(pieces)), np.diff(planes.first_vertex))
    size = np.array([_size(piece.mesh.vertices) for piece in pieces])
    most = np.maximum(np.maximum(near, TILTED * overlap), ROUNDING * size)[owner]
    fixed = np.array(support, dtype=bool)[owner]
    unjoined, unsnapped = (np.zeros(len(pieces), dtype=bool) for _ in range(2))
    for attempt in range(ATTEMPTS):
        incidences = planes.incidences(unjoined, unsnapped)
        moved = onto_planes(place, incidences, fixed)
        bad = np.linalg.norm(moved - place, axis=1) > most
        off = np.abs(fitted_planes(moved, incidences).off)
        bad[incidences.vertex[off > MENDED_FLAT * size[owner[incidences.vertex]]]] = True
        wrong = np.unique(owner[bad])
        if not len(wrong) or unjoined[wrong].all():
            break
        # Vertices first: joints are what matters.
        again = wrong[unsnapped[wrong]]
        unjoined[again] = True
        unsnapped[wrong] = True
        if attempt == ATTEMPTS - 2:
            unjoined[:] = unsnapped[:] = True
    way = np.linalg.norm(moved - place, axis=1)
    moved = np.where((way > ROUNDING * size[owner])[:, None], moved + origin, vertices)
    left = np.intersect1d(np.flatnonzero(unjoined), planes.joints[:, :2])
    records += [
        Mended(block=pieces[k].name, what="had joints that could not be closed and stayed as drawn")
        for k in left.tolist()
    ]
    return np.split(moved, planes.first_vertex[1:-1])
