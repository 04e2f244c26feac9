"""What one block is: its convex parts, its mass, and its contact shapes, in both dimensions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.geometry import GeometryError, cores
from drystone.geometry.cores import SolidCore
from drystone.geometry.plane import parts as outline_parts
from drystone.geometry.plane import polygon
from drystone.geometry.plane.polygon import Core
from drystone.geometry.space import parts as solid_parts
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Faces, Part


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """A block of unit density, in the plane also of unit thickness."""

    parts: tuple[Part, ...]  # convex, that move as one
    volume: float  # m3; in the plane the area, m2
    centroid: Array  # (dim,) m
    moments: Array  # (1,) m4 in the plane, (3,) m5 in space: of inertia, about the axes
    axes: Array  # (dim, dim) the principal ones, in columns; in the plane those of the world

    @classmethod
    def of(cls, vertices: Array, faces: Faces = (), parts: Sequence[Part] = ()) -> Figure:
        """That of an outline (n, 2) or a solid (n, 3), or of convex parts where they are given.

        Raises `GeometryError`.
        """
        if parts:
            return _of_parts(tuple(parts))
        if vertices.ndim == 2 and vertices.shape[1] == 3:
            if not faces:
                vertices, faces = solid.hull(vertices)
            solid.check(vertices, faces)
            whole = solid.mass_properties(vertices, faces)
            pieces = tuple(solid_parts.convex_parts(vertices, faces))
            return _of_solid(pieces, whole)
        pieces = tuple(Part(outline) for outline in outline_parts.convex_outlines(vertices))
        return _of_outline(pieces, polygon.mass_properties(vertices))

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.centroid)

    @cached_property
    def least_depth(self) -> float:
        """Least distance of an edge, in space a face, from what lies farthest behind it [m]."""
        vertices = np.vstack([part.vertices for part in self.parts])
        depths = []
        for part, seam in zip(self.parts, self.seams, strict=True):
            normals, _ = _planes(part)
            depths.append(np.ptp(vertices @ normals[~seam].T, axis=0).min(initial=np.inf))
        return float(min(depths))

    @cached_property
    def seams(self) -> list[BoolArray]:
        """Of each part, which of its edges, in space its faces, lie on other parts altogether."""
        if len(self.parts) == 1:
            part = self.parts[0]
            return [np.zeros(len(part.faces) if self.dimension == 3 else len(part.vertices), bool)]
        if self.dimension == 3:
            return solid_parts.solid_seams(self.parts)
        return outline_parts.outline_seams([part.vertices for part in self.parts])

    def distance(self, point: Array) -> float:
        """How far a point (dim,) lies outside of all parts [m], by the planes of their faces."""
        return min(_outside(part, point) for part in self.parts)

    def entry(self, point: Array, direction: Array) -> float:
        """Where the line through a point (dim,) along a unit vector (dim,) first meets the block,
        from the point on [m]; zero where it misses it."""
        found = []
        for part in self.parts:
            normal, offset = _planes(part)
            across, distance = normal @ direction, offset - normal @ point
            with np.errstate(divide="ignore", invalid="ignore"):
                way = distance / across
            first = way[across < 0.0].max(initial=-np.inf)
            last = way[across > 0.0].min(initial=np.inf)
            if first <= last and np.all(distance[across == 0.0] >= 0.0):
                found.append(float(first))
        return min(found, default=0.0)

    def cores(
        self, *, radius: float | None, chamfer: float | None
    ) -> tuple[Core, ...] | tuple[SolidCore, ...]:
        """Contact shapes of the parts with rounded edges, or with edges that are cut off [m].

        Raises `GeometryError` where nothing is left.
        """
        if self.dimension == 3:
            return self._solid_cores(radius, chamfer)
        outlines = [part.vertices for part in self.parts]
        if radius:
            return tuple(
                cores.rounded_outline(outline, radius, seam)
                for outline, seam in zip(outlines, self.seams, strict=True)
            )
        if chamfer:
            uncut = outline_parts.touched_corners(outlines) if len(outlines) > 1 else [None]
            return tuple(
                polygon.chamfered_core(outline, chamfer)
                if kept is None
                else cores.chamfered_outline(outline, chamfer, kept)
                for outline, kept in zip(outlines, uncut, strict=True)
            )
        return tuple(polygon.sharp_core(outline) for outline in outlines)

    def _solid_cores(self, radius: float | None, chamfer: float | None) -> tuple[SolidCore, ...]:
        parts = self.parts
        if radius:
            return tuple(
                cores.rounded_solid(part.vertices, part.faces, radius, seam)
                for part, seam in zip(parts, self.seams, strict=True)
            )
        if chamfer:
            uncut = solid_parts.touched_edges(parts) if len(parts) > 1 else [set()]
            return tuple(
                cores.chamfered_solid(part.vertices, part.faces, chamfer, kept)
                for part, kept in zip(parts, uncut, strict=True)
            )
        return tuple(cores.sharp_solid(part.vertices, part.faces) for part in parts)


def _outside(part: Part, point: Array) -> float:
    """How far a point (dim,) lies beyond the edge or the face that it lies furthest beyond [m]."""
    normal, offset = _planes(part)
    return float((normal @ point - offset).max())


def _planes(part: Part) -> tuple[Array, Array]:
    """Outward unit normals (k, dim) of its edges or faces, and their offsets (k,) [m]."""
    if part.faces:
        return solid.face_planes(part.vertices, part.faces)
    normal = polygon.normals(part.vertices)
    return normal, np.sum(normal * part.vertices, axis=1)


def _of_parts(parts: tuple[Part, ...]) -> Figure:
    """That of parts that a user has given."""
    if parts[0].vertices.ndim == 2 and parts[0].vertices.shape[1] == 3:
        whole, hulls = [], []
        for k, part in enumerate(parts):
            try:
                faces = part.faces
                vertices, faces = (part.vertices, faces) if faces else solid.hull(part.vertices)
                solid.check(vertices, faces)
                if not solid.is_convex(vertices, faces):
                    raise GeometryError("it is not convex: cut it, or give the block as a whole")
            except GeometryError as error:
                raise GeometryError(f"part {k + 1}: {error}") from None
            hulls.append(solid_parts.plain(vertices, faces))
            whole.append(solid.mass_properties(vertices, faces))
        return _of_solid(tuple(hulls), solid.sum_of(whole))
    for k, part in enumerate(parts):
        try:
            polygon.check_convex(part.vertices)
        except GeometryError as error:
            raise GeometryError(f"part {k + 1}: {error}") from None
    return _of_outline(parts, polygon.sum_of([polygon.mass_properties(p.vertices) for p in parts]))


def _of_outline(parts: tuple[Part, ...], whole: polygon.MassProperties) -> Figure:
    return Figure(
        parts=parts,
        volume=whole.area,
        centroid=whole.centroid,
        moments=np.array([whole.polar_moment]),
        axes=np.eye(2),
    )


def _of_solid(parts: tuple[Part, ...], whole: solid.SolidMass) -> Figure:
    axes, moments = solid.principal(whole.inertia)
    return Figure(
        parts=parts, volume=whole.volume, centroid=whole.centroid, moments=moments, axes=axes
    )
