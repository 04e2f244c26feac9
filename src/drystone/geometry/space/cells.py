"""Convex solids cut by planes, one plane after the other.

Cuts are topological: vertices within a tolerance of a plane are taken to lie on it and stay where
they are, and what is cut open is closed along the edges that were left single.  So cells are closed
however thin they are, and the volumes of two halves add up to the whole.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array

Point = tuple[float, float, float]
Loop = tuple[int, ...]


@dataclass(frozen=True)
class Cell:
    """A convex solid; its points are rows of a list that cells share and cuts add to."""

    faces: tuple[Loop, ...]  # counter-clockwise from outside
    tags: tuple[int, ...]  # one for each face, kept when it is cut

    @property
    def corners(self) -> list[int]:
        """Rows of its points, each once, sorted."""
        return sorted({i for face in self.faces for i in face})


def cell_of(vertices: Array, faces: Sequence[Loop]) -> tuple[list[Point], Cell]:
    """Points and a cell whose faces have their rows as tags."""
    points: list[Point] = [(x, y, z) for x, y, z in vertices.tolist()]
    return points, Cell(tuple(faces), tuple(range(len(faces))))


def packed(points: Sequence[Point], cell: Cell) -> tuple[Array, tuple[Loop, ...]]:
    """Vertices (n, 3) and faces of a cell by itself."""
    corners = cell.corners
    row = {i: k for k, i in enumerate(corners)}
    faces = tuple(tuple(row[i] for i in face) for face in cell.faces)
    return np.array([points[i] for i in corners]), faces


def heights(points: Sequence[Point], cell: Cell, plane: Sequence[float]) -> dict[int, float]:
    """How far each corner lies beyond a plane, six numbers: its unit normal and a point [m]."""
    a, b, c, px, py, pz = plane
    found = {}
    for i in cell.corners:
        x, y, z = points[i]
        found[i] = a * (x - px) + b * (y - py) + c * (z - pz)
    return found


def below(
    points: list[Point],
    cell: Cell,
    height: dict[int, float],
    tolerance: float,
    tag: int,
    made: dict[tuple[int, int], int],
) -> Cell | None:
    """What lies below a plane, closed by a face with ``tag``; None where nothing does.

    Parameters
    ----------
    height
        Of each corner above the plane [m], within ``tolerance`` [m] of which it lies on it.
    made
        Points where edges meet the plane, by their ends; shared by the two sides of a cut.
    """
    above = {i for i, h in height.items() if h > tolerance}
    under = {i for i, h in height.items() if h < -tolerance}
    if not under:
        return None
    if not above:
        return cell
    on = set(height) - above - under
    faces, tags, edges = [], [], []
    for face, its_tag in zip(cell.faces, cell.tags, strict=True):
        if not above.isdisjoint(face):
            if under.isdisjoint(face):
                continue
            face = _kept(points, face, height, tolerance, made)
            edges += _edges_of(face, lambda i: i in on or i not in height)
        elif not on.isdisjoint(face):
            edges += _edges_of(face, on.__contains__)
        faces.append(face)
        tags.append(its_tag)
    runs = set(edges)
    single = {j: i for i, j in runs if (j, i) not in runs}
    first = min(single)
    cap, at = [first], single[first]
    while at != first:
        cap.append(at)
        at = single[at]
    return Cell((*faces, tuple(cap)), (*tags, tag))


def _edges_of(face: Loop, on: Callable[[int], bool]) -> list[tuple[int, int]]:
    """Edges of a face of which both ends lie on the plane."""
    lies = [on(i) for i in face]
    return [(face[k - 1], face[k]) for k in range(len(face)) if lies[k - 1] and lies[k]]


def _kept(
    points: list[Point],
    face: Loop,
    height: dict[int, float],
    tolerance: float,
    made: dict[tuple[int, int], int],
) -> Loop:
    """The part of a face that lies below the plane."""
    kept: list[int] = []
    for k, i in enumerate(face):
        before = face[k - 1]
        low, high = (before, i) if height[before] < height[i] else (i, before)
        if height[low] < -tolerance and height[high] > tolerance:
            edge = (min(low, high), max(low, high))
            if edge not in made:
                made[edge] = len(points)
                points.append(_between(points, height, *edge))
            kept.append(made[edge])
        if height[i] <= tolerance:
            kept.append(i)
    return tuple(kept)


def _between(points: list[Point], height: dict[int, float], i: int, j: int) -> Point:
    """Where the edge between two points meets the plane."""
    share = height[i] / (height[i] - height[j])
    (x, y, z), (u, v, w) = points[i], points[j]
    return (x + share * (u - x), y + share * (v - y), z + share * (w - z))
