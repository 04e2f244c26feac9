"""3DEC in space: blocks as prisms or face by face.

z is up.  A solid of which two faces of as many corners are joined by its other edges is written as
a prism between them, as any box, extruded outline or voussoir can be; others by their faces, each
counter-clockwise as seen from outside.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.space.solid import Faces, Part
from drystone.io.convert import itasca
from drystone.io.convert.common import number


def block_command(region: int, part: Part) -> list[str]:
    """Lines that make a convex solid a block of that region."""
    ends = prism_ends(part.faces)
    if ends is not None:
        words = [f"poly region {region} prism"]
        for name, rows in zip("ab", ends, strict=True):
            words += [name, *_points(part.vertices, rows)]
    else:
        words = [f"poly region {region}"]
        for face in part.faces:
            words += ["face", *_points(part.vertices, face)]
    return itasca.command(*words)


def prism_ends(faces: Faces) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
    """Corners of a prism's first end, counter-clockwise from outside, and those of the other end
    that they are joined to, in that order; None for a solid that is none."""
    n_vertices = len({row for face in faces for row in face})
    along = {
        (i, j) for face in faces for i, j in zip(face, face[1:] + face[:1], strict=True)
    }  # both ways round: each edge is in two faces
    for face in faces:
        others = [set(other) for other in faces if not set(other) & set(face)]
        if len(faces) != len(face) + 2 or n_vertices != 2 * len(face) or len(others) != 1:
            continue
        joined = [[j for i, j in along if i == row and j in others[0]] for row in face]
        if all(len(rows) == 1 for rows in joined):
            return face, tuple(rows[0] for rows in joined)
    return None


def solid_of(words: Sequence[str]) -> tuple[Array, Faces]:
    """Vertices (n, 3) [m] and faces of what `block_command` wrote, as its words after the region.

    The vertices are in the order in which they first come.
    """
    if words[0] == "prism":
        split = words.index("b")
        ends = [_places(words[2:split]), _places(words[split + 1 :])]
        n = len(ends[0])
        first, last = tuple(range(n)), tuple(range(n, 2 * n))
        sides = [(i, n + i, n + (i + 1) % n, (i + 1) % n) for i in range(n)]
        return np.vstack(ends), (first, last[::-1], *sides)
    starts = [k for k, word in enumerate(words) if word == "face"]
    row_of: dict[tuple[float, ...], int] = {}
    found = []
    for start, end in zip(starts, [*starts[1:], len(words)], strict=True):
        places = map(tuple, _places(words[start + 1 : end]).tolist())
        found.append(tuple(row_of.setdefault(place, len(row_of)) for place in places))
    return np.array(list(row_of)), tuple(found)


def _points(vertices: Array, rows: Sequence[int]) -> list[str]:
    """A word to a point, which is on one line then; three numbers where it has none to itself."""
    words = []
    for point in vertices[list(rows)].tolist():
        numbers = list(map(number, point))
        whole = f"({','.join(numbers)})"
        words += [whole] if len(whole) < itasca.WIDTH - 8 else numbers
    return words


def _places(words: Sequence[str]) -> Array:
    return np.array([float(word) for word in words]).reshape(-1, 3)
