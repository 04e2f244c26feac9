"""Where faces of convex parts lie on each other: candidates, clipping, area; in space."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import OPPOSED, SAME_CORNER_OF_FACE


@njit(cache=True)
def clip(polygon, count, x, y, z, nx, ny, nz, out):
    """What of a polygon, ``polygon[:count]``, lies in the half-space at (x, y, z) along (nx, ny,
    nz); writes ``out`` and returns its number of corners."""
    kept = 0
    before = 0.0
    if count > 0:
        k = count - 1
        before = (polygon[k, 0] - x) * nx + (polygon[k, 1] - y) * ny + (polygon[k, 2] - z) * nz
    previous = count - 1
    for k in range(count):
        here = (polygon[k, 0] - x) * nx + (polygon[k, 1] - y) * ny + (polygon[k, 2] - z) * nz
        if (here >= 0.0) != (before >= 0.0):
            share = before / (before - here)
            for axis in range(3):
                first = polygon[previous, axis]
                out[kept, axis] = first + share * (polygon[k, axis] - first)
            kept += 1
        if here >= 0.0:
            for axis in range(3):
                out[kept, axis] = polygon[k, axis]
            kept += 1
        before = here
        previous = k
    return kept


@njit(cache=True)
def clip_to_face(polygon, count, vertices, rows, first, last, inward, back, spare):
    """Clip a polygon to a face, edges ``first`` to ``last``, set back by ``back`` (n_edges,).

    ``polygon`` and ``spare`` are overwritten; the result is in ``polygon``.
    """
    for edge in range(first, last):
        nx, ny, nz = inward[edge, 0], inward[edge, 1], inward[edge, 2]
        x = vertices[rows[edge], 0] + back[edge] * nx
        y = vertices[rows[edge], 1] + back[edge] * ny
        z = vertices[rows[edge], 2] + back[edge] * nz
        count = clip(polygon, count, x, y, z, nx, ny, nz, spare)
        for k in range(count):
            for axis in range(3):
                polygon[k, axis] = spare[k, axis]
        if count < 3:
            return 0
    return count


@njit(cache=True)
def merge(polygon, count, near):
    """Take out corners nearer than ``near`` to the line between their neighbours; how many stay."""
    k = 0
    while count >= 3 and k < count:
        before, after = (k + count - 1) % count, (k + 1) % count
        ax = polygon[k, 0] - polygon[before, 0]
        ay = polygon[k, 1] - polygon[before, 1]
        az = polygon[k, 2] - polygon[before, 2]
        bx = polygon[after, 0] - polygon[before, 0]
        by = polygon[after, 1] - polygon[before, 1]
        bz = polygon[after, 2] - polygon[before, 2]
        length = np.sqrt(bx * bx + by * by + bz * bz)
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        if np.sqrt(x * x + y * y + z * z) > near * length:
            k += 1
            continue
        count -= 1
        for j in range(k, count):
            for axis in range(3):
                polygon[j, axis] = polygon[j + 1, axis]
        k = max(k - 1, 0)
    return count if count >= 3 else 0


@njit(cache=True)
def area_and_length(polygon, count, nx, ny, nz):
    """Area of a polygon with that normal, and the length of its outline."""
    area, length = 0.0, 0.0
    for k in range(count):
        after = (k + 1) % count
        ax = polygon[k, 0] - polygon[0, 0]
        ay = polygon[k, 1] - polygon[0, 1]
        az = polygon[k, 2] - polygon[0, 2]
        bx = polygon[after, 0] - polygon[k, 0]
        by = polygon[after, 1] - polygon[k, 1]
        bz = polygon[after, 2] - polygon[k, 2]
        area += 0.5 * (
            (ay * bz - az * by) * nx + (az * bx - ax * bz) * ny + (ax * by - ay * bx) * nz
        )
        length += np.sqrt(bx * bx + by * by + bz * bz)
    return area, length


@njit(cache=True)
def _far(a, b, tolerance, normals, discs):
    """Whether faces cannot lie on each other, by their normals and the balls they lie in."""
    cosine = (
        normals[a, 0] * normals[b, 0]
        + normals[a, 1] * normals[b, 1]
        + normals[a, 2] * normals[b, 2]
    )
    if cosine > OPPOSED:
        return True
    x = discs[b, 0] - discs[a, 0]
    y = discs[b, 1] - discs[a, 1]
    z = discs[b, 2] - discs[a, 2]
    reach = discs[a, 3] + discs[b, 3] + tolerance
    if x * x + y * y + z * z > reach * reach:
        return True
    off = abs(x * normals[a, 0] + y * normals[a, 1] + z * normals[a, 2])
    tilt = np.sqrt(max(1.0 - cosine * cosine, 0.0))
    # Faces that are not quite flat stray from their own planes, too.
    return off > 2.0 * tolerance + tilt * (discs[a, 3] + discs[b, 3])


@njit(cache=True)
def find_joints(
    pairs,
    tolerance,
    vertices,
    rows,
    face_offset,
    part_faces,
    normals,
    inwards,
    discs,
    found,
    corners,
):
    """Where faces of the parts of each pair lie on each other within ``tolerance`` (n_pairs,) [m].

    ``discs`` (n_faces, 4) are the faces' centres and the distances of their farthest vertices.
    Joints are written into ``found`` (m, 5): row of the pair, both faces, first and last row of
    ``corners`` (k, 3), which lie on the face of the first part and go round its normal.  Returns
    how many joints and corners there are; those beyond the capacity of the arrays are only counted.
    """
    most = 2 * int(np.max(face_offset[1:] - face_offset[:-1])) + 4
    polygon, spare = np.empty((most, 3)), np.empty((most, 3))
    back = np.zeros(rows.size)
    n_found, n_corners = 0, 0
    for pair in range(pairs.shape[0]):
        p, q = pairs[pair, 0], pairs[pair, 1]
        near = tolerance[pair]
        for a in range(part_faces[p], part_faces[p + 1]):
            nx, ny, nz = normals[a, 0], normals[a, 1], normals[a, 2]
            for b in range(part_faces[q], part_faces[q + 1]):
                if _far(a, b, near, normals, discs):
                    continue
                first, last = face_offset[a], face_offset[a + 1]
                for k in range(last - first):
                    for axis in range(3):
                        polygon[k, axis] = vertices[rows[first + k], axis]
                b0, b1 = face_offset[b], face_offset[b + 1]
                count = clip_to_face(
                    polygon, last - first, vertices, rows, b0, b1, inwards, back, spare
                )
                count = merge(polygon, count, SAME_CORNER_OF_FACE * near)
                area, length = area_and_length(polygon, count, nx, ny, nz)
                if area <= 0.5 * near * length:  # narrower than the tolerance
                    continue
                mx, my, mz = normals[b, 0], normals[b, 1], normals[b, 2]
                touching = True
                for k in range(count):
                    off = (polygon[k, 0] - discs[b, 0]) * mx
                    off += (polygon[k, 1] - discs[b, 1]) * my
                    off += (polygon[k, 2] - discs[b, 2]) * mz
                    touching &= abs(off) <= near
                if not touching:
                    continue
                if n_found < found.shape[0] and n_corners + count <= corners.shape[0]:
                    found[n_found, 0] = pair
                    found[n_found, 1] = a
                    found[n_found, 2] = b
                    found[n_found, 3] = n_corners
                    found[n_found, 4] = n_corners + count
                    for k in range(count):
                        for axis in range(3):
                            corners[n_corners + k, axis] = polygon[k, axis]
                n_found += 1
                n_corners += count
    return n_found, n_corners


@njit(cache=True)
def set_back(corners, offset, faces, vertices, rows, face_offset, inwards, back, size, out, left):
    """Clip joints ``corners[offset[j]:offset[j + 1]]`` to both their faces ``faces`` (n, 2), each
    set back from its edges by ``back`` (n_edges,) [m].

    ``size`` (n,) [m] is that of what counts as small.  Writes corners into ``out``, as many rows as
    ``capacity`` says, and their numbers into ``left`` (n,).
    """
    most = 0
    for j in range(faces.shape[0]):
        count = offset[j + 1] - offset[j]
        for side in range(2):
            face = faces[j, side]
            count += face_offset[face + 1] - face_offset[face]
        most = max(most, count)
    polygon, spare = np.empty((most + 4, 3)), np.empty((most + 4, 3))
    written = 0
    for j in range(faces.shape[0]):
        count = offset[j + 1] - offset[j]
        for k in range(count):
            for axis in range(3):
                polygon[k, axis] = corners[offset[j] + k, axis]
        for side in range(2):
            face = faces[j, side]
            first, last = face_offset[face], face_offset[face + 1]
            count = clip_to_face(polygon, count, vertices, rows, first, last, inwards, back, spare)
        count = merge(polygon, count, SAME_CORNER_OF_FACE * size[j])
        left[j] = count
        for k in range(count):
            for axis in range(3):
                out[written + k, axis] = polygon[k, axis]
        written += count
