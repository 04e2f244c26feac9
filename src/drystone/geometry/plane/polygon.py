"""Plane polygons: checks, mass properties, corners of convex ones taken off.

Every polygon is an ``(n, 2)`` float64 array of vertices [m], counter-clockwise.
Edge ``i`` runs from vertex ``i`` to vertex ``i + 1``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import DEGENERATE
from drystone.geometry import GeometryError


def _following(rows: Array) -> Array:
    """The rows from the second on, then the first: `np.roll` in a tenth of its time."""
    return np.concatenate((rows[1:], rows[:1]))


def _preceding(rows: Array) -> Array:
    """The last row, then the others."""
    return np.concatenate((rows[-1:], rows[:-1]))


def signed_area(vertices: Array) -> float:
    """Area [m2] by the shoelace formula, positive when counter-clockwise."""
    x, y = (vertices - vertices[0]).T
    return 0.5 * float((x * _following(y) - _following(x) * y).sum())


def is_clockwise(vertices: Array) -> bool:
    """Whether an outline runs the wrong way round; what is no outline does not."""
    if vertices.ndim != 2 or vertices.shape[1] != 2 or len(vertices) < 3:
        return False
    return bool(np.isfinite(vertices).all()) and signed_area(vertices) < 0.0


def check_convex(vertices: Array) -> None:
    """Raise `GeometryError` unless the vertices make a convex, counter-clockwise polygon."""
    angle = _checked_turns(vertices)
    reflex = angle < -_rounding(vertices)
    if np.any(reflex):
        i = (int(np.argmin(angle)) + 1) % len(vertices)
        x, y = vertices[i]
        raise GeometryError(
            f"the outline is not convex at vertex {i + 1} ({x:g}, {y:g}): "
            "split the block into convex ones"
        )


def check_outline(vertices: Array) -> bool:
    """Raise `GeometryError` unless these make a counter-clockwise outline, concave or not, that
    neither crosses nor touches itself; returns whether it is convex."""
    angle = _checked_turns(vertices)
    if np.any(np.abs(angle) > np.pi - DEGENERATE):
        i = (int(np.argmax(np.abs(angle))) + 1) % len(vertices)
        x, y = vertices[i]
        raise GeometryError(f"the outline turns back at vertex {i + 1} ({x:g}, {y:g}): remove it")
    convex = not np.any(angle < -_rounding(vertices))
    if not convex:
        _check_simple(vertices)
    return convex


def reflex_corners(vertices: Array) -> BoolArray:
    """Whether an outline turns clockwise at each vertex, (n,), by more than rounding."""
    return np.asarray(_preceding(_turns(vertices)) < -_rounding(vertices))


def _check_simple(vertices: Array) -> None:
    """Raise `GeometryError` where two edges that do not follow each other meet."""
    n = len(vertices)
    start, end = vertices, _following(vertices)
    near = DEGENERATE * float(np.ptp(vertices, axis=0).max())
    edge = end - start
    length = np.hypot(edge[:, 0], edge[:, 1])
    tangent = edge / length[:, None]
    arm = vertices[None] - start[:, None]  # (edge, vertex)
    along = np.sum(arm * tangent[:, None], axis=2)
    off = tangent[:, None, 0] * arm[..., 1] - tangent[:, None, 1] * arm[..., 0]
    row, column = np.arange(n)[:, None], np.arange(n)[None]
    # A vertex on an edge that is not its own, or edges that pass through each other.
    own = (column == row) | (column == (row + 1) % n)
    on = (np.abs(off) <= near) & (along >= -near) & (along <= length[:, None] + near) & ~own
    across = off * np.roll(off, -1, axis=1) < 0.0
    crossing = across & across.T & ~own & ~own.T
    if np.any(on):
        i, j = np.argwhere(on)[0]
        x, y = vertices[j]
        raise GeometryError(
            f"the outline touches itself at vertex {j + 1} ({x:g}, {y:g}), which lies on the edge "
            f"after vertex {i + 1}: make two blocks of it, or leave a gap"
        )
    if np.any(crossing):
        i, j = np.argwhere(crossing)[0]
        raise GeometryError(
            f"the outline crosses itself: the edges after vertices {i + 1} and {j + 1} meet; list "
            "the vertices in order around the block"
        )


def _turns(vertices: Array) -> Array:
    """Angles [rad] by which the outline turns at the end of every edge, (n,)."""
    return _turns_of(_following(vertices) - vertices)


def _turns_of(edges: Array) -> Array:
    """The same, from the edges (n, 2) of the outline."""
    following = _following(edges)
    turn = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    return np.arctan2(turn, np.sum(edges * following, axis=1))


def _rounding(vertices: Array) -> float:
    """Turn [rad] that may come of rounded coordinates."""
    edges = _following(vertices) - vertices
    shortest = np.hypot(edges[:, 0], edges[:, 1]).min()
    return max(DEGENERATE, 4.0 * float(np.spacing(np.abs(vertices).max()) / shortest))


def _checked_turns(vertices: Array) -> Array:
    """Turns at the ends of the edges of an outline that may be concave."""
    if vertices.ndim != 2 or vertices.shape[1] != 2:
        raise GeometryError("vertices must be a list of [x, y] pairs")
    n = len(vertices)
    if n < 3:
        raise GeometryError(f"a polygon needs at least 3 vertices, it has {n}")
    if not np.isfinite(vertices).all():
        raise GeometryError("every coordinate must be a finite number")
    edges = _following(vertices) - vertices
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    size = float((vertices.max(axis=0) - vertices.min(axis=0)).max())
    if size == 0.0 or (lengths < DEGENERATE * size).any():
        i = int(np.argmin(lengths))
        raise GeometryError(
            f"vertices {i + 1} and {(i + 1) % n + 1} are the same point: remove one"
        )
    area = signed_area(vertices)
    if abs(area) < DEGENERATE * size**2:
        raise GeometryError(
            "the outline encloses no area: its vertices lie on one line, or it crosses itself; "
            "list them in order around the block"
        )
    angle = _turns_of(edges)
    turns = round(float(angle.sum()) / (2.0 * np.pi))
    if abs(turns) != 1:
        raise GeometryError(
            "the outline crosses itself: list the vertices in order around the block"
        )
    if turns < 0:
        raise GeometryError("the vertices run clockwise: list them counter-clockwise")
    return angle


def bends(vertices: Array) -> Array:
    """How far each vertex is off the line between its neighbours; endless where it turns back."""
    before, after = _preceding(vertices), _following(vertices)
    way, arm = after - before, vertices - before
    length = np.hypot(way[:, 0], way[:, 1])
    along = np.sum(way * arm, axis=1)
    off = np.abs(way[:, 0] * arm[:, 1] - way[:, 1] * arm[:, 0])
    between = (along > 0.0) & (along < length**2)
    return np.where(between, off / np.where(length > 0.0, length, 1.0), np.inf)


def turning(vertices: Array, near: float) -> IntArray:
    """Rows of the vertices that bend an outline; the others lie amid straight edges, within
    ``near`` [m].

    They go one at a time, the straightest first: neighbours are each other's measure.
    """
    rows = np.arange(len(vertices))
    while len(rows) > 3:
        off = bends(vertices[rows])
        least = int(np.argmin(off))
        if off[least] > near:
            break
        rows = np.delete(rows, least)
    return rows


def least_width(vertices: Array) -> float:
    """Least extent of an outline along the normals of its edges [m]."""
    return float(np.ptp(vertices @ normals(vertices).T, axis=0).min())


def normals(vertices: Array) -> Array:
    """Unit normals (k, 2) of the edges of an outline, to the right of the way along them; those of
    no length have none."""
    edges = _following(vertices) - vertices
    edges = edges[edges.any(axis=1)]
    return np.column_stack((edges[:, 1], -edges[:, 0])) / np.hypot(*edges.T)[:, None]


def dent(vertices: Array) -> float:
    """How deep an outline's deepest dent is, from the edge of its convex hull [m]."""
    hull = _hull(vertices)
    edge = _following(hull) - hull
    tangent = edge / np.hypot(edge[:, 0], edge[:, 1])[:, None]
    arm = vertices[:, None] - hull[None]
    inside = tangent[None, :, 0] * arm[..., 1] - tangent[None, :, 1] * arm[..., 0]
    return float(inside.min(axis=1).max())


def _hull(vertices: Array) -> Array:
    """Corners of the convex hull, counter-clockwise (Andrew's monotone chains)."""
    points = sorted(map(tuple, vertices.tolist()))
    chains = []
    for way in (points, points[::-1]):
        chain: list[tuple[float, ...]] = []
        for p in way:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0.0:
                    break
                chain.pop()
            chain.append(p)
        chains += chain[:-1]
    return np.array(chains)


@dataclass(frozen=True, kw_only=True)
class MassProperties:
    """Of a unit thickness and unit density: area, centroid and polar moment about it."""

    area: float  # m2
    centroid: Array  # (2,) m
    polar_moment: float  # m4


def mass_properties(vertices: Array) -> MassProperties:
    """Area, centroid and polar second moment about the centroid of a polygon."""
    origin = vertices.mean(axis=0)  # a near origin keeps the sums from cancelling
    p = vertices - origin
    q = _following(p)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    area = 0.5 * cross.sum()
    first = ((p + q) * cross[:, None]).sum(axis=0) / (6.0 * area)
    second = np.sum(cross * np.sum(p * p + p * q + q * q, axis=1)) / 12.0
    return MassProperties(
        area=float(area),
        centroid=origin + first,
        polar_moment=float(second - area * first @ first),
    )


def sum_of(parts: Sequence[MassProperties]) -> MassProperties:
    """Mass properties of several outlines that move as one."""
    area = sum(part.area for part in parts)
    near = parts[0].centroid
    centroid = near + sum(part.area * (part.centroid - near) for part in parts) / area
    moment = 0.0
    for part in parts:
        arm = part.centroid - centroid
        moment += part.polar_moment + part.area * float(arm @ arm)
    return MassProperties(area=area, centroid=centroid, polar_moment=moment)


@dataclass(frozen=True, kw_only=True)
class Core:
    """What is left of an outline when its corners are treated: a core polygon plus a disc.

    ``setback[i]`` holds by how much edge ``i`` of the core is shorter than the edge of the
    outline it lies on, at its start and at its end [m]; joints count the full edge.
    """

    vertices: Array  # (n, 2) m
    setback: Array  # (n, 2) m
    radius: float  # m


def sharp_core(vertices: Array) -> Core:
    """The outline itself."""
    return Core(vertices=vertices.copy(), setback=np.zeros((len(vertices), 2)), radius=0.0)


def rounded_core(vertices: Array, radius: float) -> Core:
    """Outline moved inwards by ``radius`` [m], to be swept with a disc of that radius."""
    edges = _following(vertices) - vertices
    length = np.hypot(edges[:, 0], edges[:, 1])
    tangent = edges / length[:, None]
    before = _preceding(tangent)
    # At a corner with turn angle a the core vertex lies back along both edges by r tan(a/2).
    cosine = np.sum(before * tangent, axis=1)
    sine = before[:, 0] * tangent[:, 1] - before[:, 1] * tangent[:, 0]
    turned = 1.0 + cosine
    if turned.min() > 0.0:
        back = radius * np.abs(sine) / turned
    else:  # a needle's tip leaves nothing of an edge
        back = np.full(len(vertices), np.inf)
    remaining = length - back - _following(back)
    if not (remaining > DEGENERATE * length).all():
        i = int(np.argmin(remaining))
        raise GeometryError(
            f"the corner radius {radius:g} m leaves nothing of the edge of {length[i]:g} m "
            f"after vertex {i + 1}: take a smaller radius"
        )
    inward = np.column_stack((-tangent[:, 1], tangent[:, 0]))
    core = vertices + back[:, None] * tangent + radius * inward
    return Core(vertices=core, setback=np.column_stack((back, _following(back))), radius=radius)


def chamfered_core(vertices: Array, leg: float) -> Core:
    """Outline with every corner cut off at ``leg`` [m] from it along both edges."""
    edges = _following(vertices) - vertices
    length = np.hypot(edges[:, 0], edges[:, 1])
    if np.any(length - 2.0 * leg <= DEGENERATE * length):
        i = int(np.argmin(length))
        raise GeometryError(
            f"the chamfer of {leg:g} m leaves nothing of the edge of {length[i]:g} m "
            f"after vertex {i + 1}: take a smaller chamfer"
        )
    tangent = edges / length[:, None]
    n = len(vertices)
    core = np.empty((2 * n, 2))
    core[0::2] = vertices + leg * tangent
    core[1::2] = _following(vertices) - leg * tangent
    setback = np.zeros((2 * n, 2))
    setback[0::2] = leg  # the edges of the outline; the cuts between them have none
    return Core(vertices=core, setback=setback, radius=0.0)
