"""Walls of polygonal rubble: cells of Voronoi around random points."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from drystone.common.arrays import Array
from drystone.common.keys import Whole
from drystone.model.assembly import Block
from drystone.model.builders.base import AlongY, Builder, Metres, Pair
from drystone.model.builders.stones import Mason, check_count, positive
from drystone.model.construction.errors import ModelError

#: Edges shorter than this share of a stone are taken out.
SHORT = 0.12
#: How far from the middle of its place a point may be, over half the place.
SCATTER = 0.8
#: Turn of the plane under which a corner is none: sine of the angle.
STRAIGHT = 0.02


# Long by its keys, each with its words: they are those of model files.
def rubble(
    *,
    length: Metres,
    height: Metres,
    stone: Annotated[Pair, "[length, height] of a stone in metres"],
    seed: Annotated[int, Whole(0, 2**63 - 1), "a whole number"],
    unit_weight: float,
    relaxed: Annotated[int, Whole(0, 100)] = 1,
    depth: AlongY = None,
    material: str = "",
) -> list[Block]:
    """A rectangle of convex polygonal stones, from the origin along x.

    Points are scattered about the places of a running bond; each stone is what lies nearest to its
    point, where heights count as much more as stones are longer than high.  Short edges are taken
    out, as far as stones stay convex.  The numbers of places are cut to fit, the nearest whole
    ones.

    Parameters
    ----------
    length, height
        Of the wall [m].
    stone
        Length and height of a stone on average [m].
    seed
        A whole number; the same one gives the same wall.
    unit_weight
        N/m3.
    relaxed
        How many times points are moved to the middle of their stones, which makes them more alike.
    depth
        Along y, from 0 [m]; none in the plane.

    Returns
    -------
    list of Block
        ``s1`` to ``sN``, row by row from the bottom and from left to right.

    Raises
    ------
    ModelError
        The measures make no wall.
    """
    problems = positive(length=length, height=height, depth=depth)
    if len(stone) != 2 or not min(stone) > 0.0:
        problems.append("stone: must be [length, height] in metres, both greater than 0")
    if seed < 0 or not 0 <= relaxed <= 100:
        problems.append("seed: must be at least 0, and relaxed from 0 to 100")
    if problems:
        raise ModelError(problems)
    columns, rows = max(1, round(length / stone[0])), max(1, round(height / stone[1]))
    check_count(columns * rows)
    size = np.array([length, height])
    unit = size / (columns, rows)  # distances count in these
    points = _scattered(columns, rows, np.random.default_rng(seed))
    for _ in range(relaxed):
        vertices, cells = _cells(points, (columns, rows))
        points = np.array([_middle(vertices[cell]) for cell in cells])
    vertices, cells = _cells(points, (columns, rows))
    vertices, cells = _without_short_edges(vertices, cells, (columns, rows))
    mason = Mason(unit_weight=unit_weight, material=material)
    across = None if depth is None else (0.0, depth)
    return [
        mason.upright(f"s{k}", vertices[cell] * unit, across)
        for k, cell in enumerate(cells, start=1)
    ]


RUBBLE = Builder(make=rubble)


def _scattered(columns: int, rows: int, rng: np.random.Generator) -> Array:
    """Points about the places of a running bond, row by row, (n, 2)."""
    found = []
    for row in range(rows):
        shift = 0.5 * (row % 2)
        for column in range(columns + row % 2):
            x = min(max(column + 0.5 - shift, 0.25), columns - 0.25)
            off = (
                SCATTER
                * (rng.random(2) - 0.5)
                * np.array([0.5 if x in (0.25, columns - 0.25) else 1.0, 1.0])
            )
            found.append((x + off[0], row + 0.5 + off[1]))
    return np.array(found)


def _cells(points: Array, size: tuple[int, int]) -> tuple[Array, list[list[int]]]:
    """Vertices (n, 2) and, of each point, those around what is nearest to it in a rectangle.

    Mirror images of the points beyond its sides make the sides their cells' borders.
    """
    from scipy.spatial import Voronoi  # takes long to import; other builders do without

    if len(points) == 1:
        x, y = size
        return np.array([[0, 0], [x, 0], [x, y], [0, y]], float), [[0, 1, 2, 3]]
    images = [points]
    for axis, border in ((0, 0.0), (0, float(size[0])), (1, 0.0), (1, float(size[1]))):
        image = points.copy()
        image[:, axis] = 2.0 * border - image[:, axis]
        images.append(image)
    found = Voronoi(np.vstack(images))
    vertices = np.clip(found.vertices, 0.0, size)
    for axis in (0, 1):  # what lies on a side lies on it exactly
        for border in (0.0, float(size[axis])):
            near = np.abs(found.vertices[:, axis] - border) < 1e-9 * max(size)
            vertices[near, axis] = border
    cells = []
    for k in range(len(points)):
        around = np.array(found.regions[found.point_region[k]])
        arm = vertices[around] - points[k]
        cells.append(around[np.argsort(np.arctan2(arm[:, 1], arm[:, 0]))].tolist())
    return vertices, cells


def _middle(outline: Array) -> Array:
    """Centroid of a polygon (n, 2)."""
    p = outline - outline[0]
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    return np.asarray(outline[0] + (p + q).T @ cross / (3.0 * cross.sum()))


def _without_short_edges(
    vertices: Array, cells: list[list[int]], size: tuple[int, int]
) -> tuple[Array, list[list[int]]]:
    """The two ends of a short edge made one, shortest edges first, where cells stay convex.

    What lies on a side of the rectangle stays on it, and corners stay where they are.
    """
    vertices, cells = vertices.copy(), [list(cell) for cell in cells]
    owners: dict[int, set[int]] = {}
    for k, cell in enumerate(cells):
        for v in cell:
            owners.setdefault(v, set()).add(k)
    edges = {
        tuple(sorted(e)) for cell in cells for e in zip(cell, cell[1:] + cell[:1], strict=True)
    }
    length = {edge: float(np.linalg.norm(vertices[edge[0]] - vertices[edge[1]])) for edge in edges}
    for edge in sorted(edges, key=lambda edge: length[edge]):
        if length[edge] >= SHORT:
            break
        _merge(vertices, cells, owners, edge, size)
    return vertices, cells


def _merge(
    vertices: Array, cells: list[list[int]], owners: dict[int, set[int]], edge: tuple[int, ...],
    size: tuple[int, int],
) -> None:  # fmt: skip
    """Make one vertex of two, unless a cell would not stay a convex polygon."""
    a, b = edge
    if a not in owners or b not in owners:
        return  # one has been removed already
    on = [_borders(vertices[v], size) for v in (a, b)]
    if on[0] and on[1] and on[0] != on[1]:
        return
    keep = a if len(on[0]) >= len(on[1]) else b
    place = vertices[keep] if on[0] != on[1] else 0.5 * (vertices[a] + vertices[b])
    touched = owners[a] | owners[b]
    before = vertices[[a, b]].copy()
    vertices[[a, b]] = place
    merged = {k: [v for v in cells[k] if not (v == b and a in cells[k])] for k in touched}
    merged = {k: [a if v == b else v for v in cell] for k, cell in merged.items()}
    if not all(len(cell) >= 3 and _is_convex(vertices[cell]) for cell in merged.values()):
        vertices[[a, b]] = before
        return
    for k, cell in merged.items():
        cells[k] = cell
    owners[a] = touched
    del owners[b]


def _borders(point: Array, size: tuple[int, int]) -> set[tuple[int, float]]:
    """On which sides of the rectangle a point lies."""
    return {
        (axis, border)
        for axis in (0, 1)
        for border in (0.0, float(size[axis]))
        if point[axis] == border
    }


def _is_convex(outline: Array) -> bool:
    edges = np.roll(outline, -1, axis=0) - outline
    edges /= np.linalg.norm(edges, axis=1)[:, None]
    after = np.roll(edges, -1, axis=0)
    return bool((edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0] > STRAIGHT).all())
