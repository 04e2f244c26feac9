"""Where two faces overlap: a polygon, its named corners, and the contact points spread over it.

Everything is done in the plane of the *reference* face, in coordinates (x, y) [m] in which this
face runs counter-clockwise.  The other face, the *incident* one, is projected on the plane and
listed in the same sense.

The sides of the reference face cut the incident face (Sutherland and Hodgman).  This gives the true
area and centroid.  Flush faces would give a cluster of corners wherever two vertices meet, which
changes with every rounding error.  So corners are named afterwards:

1. A corner that is nearer than CLIP widths to a vertex of the incident face has the name of this
   vertex.  Otherwise, if it is as near to a vertex of the reference face, it has the name of that
   vertex.  Otherwise it is a crossing of two sides.  Its place is its own in each case: if a corner
   were moved to its vertex, the gap of tilted faces would jump as it gets its name, and a vertex
   beyond the rim would carry.
2. The shortest side is removed, as long as it is shorter than MERGE widths of the overlap.  One of
   its two ends remains.  If the faces tilt along the side by more than SIDE_SLOPE, the end remains
   where they are nearer: a side of one face that runs nearly along a side of the other crosses it
   far from the corner that carries.  If the faces are flush, or tilt by more than EDGE_FLAT and
   meet by their edges, the better defined end remains: a vertex before a crossing.  A side whose
   two ends were contact points before is removed only if it is shorter than MERGED_AGAIN of the
   limit.  Otherwise a point that carries might come and go from step to step, as its force opens
   it.
3. A crossing that lies nearly on the line between its neighbours is removed.

What remains are true corners of the overlap in their true places.  Faces that only share a piece
of a side, or a corner, do not overlap.  They are cut with a slack of CLIP widths, and keep the one
or two points where they touch.

The width of a polygon is four times its area over its perimeter: for a square, its side.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import MERGED_AGAIN, PARALLEL, ROUNDING, SIDE_SLOPE, SUMS

#: Types of corners and points: a vertex of the incident face, a vertex of the reference face, a
#: crossing of two sides, a point on a side of the overlap, a point within (also the centroid).
VERTEX_Q, VERTEX_P, CROSSING, ON_SIDE, INNER = 0, 1, 2, 3, 4

#: Columns of the names of corners and points: type; vertex or side of the reference face; vertex or
#: side of the incident face; for corners the side that leaves the corner (sides of the incident
#: face come first, then those of the reference face), for points their number along the side; for
#: corners whether they were contact points before.
TYPE, OF_P, OF_Q, LEAVES, KEPT = range(5)
N_NAME = 5


@njit(cache=True)
def width_of(area, perimeter):
    """Side of the square that has this ratio of area to perimeter [m]."""
    return 4.0 * area / perimeter if perimeter > 0.0 else 0.0


@njit(cache=True)
def measure(corner, half, n):
    """Area [m2], centroid (x, y) and perimeter [m] of a polygon of n corners; zeros for n = 0.

    The polygon is the first or the second ``half`` of ``corner`` (2, k, 2).
    """
    if n == 0:
        return 0.0, 0.0, 0.0, 0.0
    x0, y0 = corner[half, 0, 0], corner[half, 0, 1]
    twice, mx, my, perimeter, sx, sy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        ax, ay = corner[half, i, 0] - x0, corner[half, i, 1] - y0
        bx, by = corner[half, j, 0] - x0, corner[half, j, 1] - y0
        cross = ax * by - ay * bx
        twice += cross
        mx += cross * (ax + bx)
        my += cross * (ay + by)
        perimeter += np.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
        sx += ax
        sy += ay
    if twice <= SUMS * perimeter * perimeter:
        return 0.0, x0 + sx / n, y0 + sy / n, perimeter
    return 0.5 * twice, x0 + mx / (3.0 * twice), y0 + my / (3.0 * twice), perimeter


@njit(cache=True)
def widened(corner, half, n, reach):
    """Area [m2] that a polygon of n corners gains if its sides move out by ``reach`` (n,) [m].

    A corner moves to where its two sides then meet.  If they are nearly parallel, they would meet
    far away, and the corner moves no farther than the sides.
    """
    gained = 0.0
    for i in range(n):
        before, after = (i - 1) % n, (i + 1) % n
        ux, uy = (
            corner[half, i, 0] - corner[half, before, 0],
            corner[half, i, 1] - corner[half, before, 1],
        )
        vx, vy = (
            corner[half, after, 0] - corner[half, i, 0],
            corner[half, after, 1] - corner[half, i, 1],
        )
        u, v = np.sqrt(ux * ux + uy * uy), np.sqrt(vx * vx + vy * vy)
        gained += v * reach[i]
        sine, cosine = ux * vy - uy * vx, ux * vx + uy * vy
        if sine > PARALLEL * u * v:
            # The area of the kite between the old corner, its feet on both sides, and the new one.
            s, t = reach[before], reach[i]
            gained += s * t * u * v / sine - 0.5 * (s * s + t * t) * cosine / sine
    return max(gained, 0.0)


@njit(cache=True)
def clip(incident, m, reference, n, slack, corner, name):
    """Cut the incident polygon (m corners) by the reference polygon (n corners).

    Points up to ``slack`` [m] outside count as inside.  ``corner`` (2, k, 2) and ``name``
    (2, k, N_NAME) are filled.  Returns which of their two halves holds the result, and its number
    of corners.
    """
    side, count, capacity = 0, m, corner.shape[1]
    for j in range(m):
        corner[0, j, 0], corner[0, j, 1] = incident[j, 0], incident[j, 1]
        name[0, j, TYPE], name[0, j, OF_P] = VERTEX_Q, -1
        name[0, j, OF_Q], name[0, j, LEAVES] = j, j
    for k in range(n):
        after = k + 1 if k + 1 < n else 0
        x0, y0 = reference[k, 0], reference[k, 1]
        ex, ey = reference[after, 0] - x0, reference[after, 1] - y0
        length = np.sqrt(ex * ex + ey * ey)
        if length == 0.0:
            continue
        nx, ny = -ey / length, ex / length
        least, greatest = np.inf, -np.inf
        for i in range(count):
            d = nx * (corner[side, i, 0] - x0) + ny * (corner[side, i, 1] - y0)
            least, greatest = min(least, d), max(greatest, d)
        if least >= -slack:
            continue
        if greatest < -slack:
            return side, 0
        other, made, before = 1 - side, 0, count - 1
        d_before = nx * (corner[side, before, 0] - x0) + ny * (corner[side, before, 1] - y0)
        for i in range(count):
            x, y = corner[side, i, 0], corner[side, i, 1]
            d = nx * (x - x0) + ny * (y - y0)
            inside = d >= -slack
            if inside != (d_before >= -slack) and made < capacity:
                share = min(max(d_before / (d_before - d), 0.0), 1.0)
                bx, by = corner[side, before, 0], corner[side, before, 1]
                corner[other, made, 0] = bx + share * (x - bx)
                corner[other, made, 1] = by + share * (y - by)
                line = name[side, before, LEAVES]
                name[other, made, LEAVES] = line if inside else m + k
                if line < m:
                    name[other, made, TYPE] = CROSSING
                    name[other, made, OF_P], name[other, made, OF_Q] = k, line
                else:
                    vertex = 0 if line == m and k == n - 1 else k
                    name[other, made, TYPE] = VERTEX_P
                    name[other, made, OF_P], name[other, made, OF_Q] = vertex, -1
                made += 1
            if inside and made < capacity:
                corner[other, made, 0], corner[other, made, 1] = x, y
                for c in range(N_NAME):
                    name[other, made, c] = name[side, i, c]
                made += 1
            before, d_before = i, d
        side, count = other, made
    return side, count


@njit(cache=True)
def _nearest(x, y, polygon, n, within):
    """Vertex of a polygon nearest to (x, y), or -1 if none is nearer than ``within`` [m]."""
    found, best = -1, within * within
    for j in range(n):
        d = (polygon[j, 0] - x) ** 2 + (polygon[j, 1] - y) ** 2
        if d <= best:
            found, best = j, d
    return found


@njit(cache=True)
def _take_place(corner, half, i, polygon, j, same):
    """Move corner i to vertex j of a polygon if it is no farther than ``same`` [m]."""
    x, y = polygon[j, 0], polygon[j, 1]
    if (corner[half, i, 0] - x) ** 2 + (corner[half, i, 1] - y) ** 2 <= same * same:
        corner[half, i, 0], corner[half, i, 1] = x, y


@njit(cache=True)
def name_corners(corner, name, half, count, incident, m, reference, n, near, same):
    """Step 1 of the module's text: corners that are ``near`` [m] to a vertex get its name, and its
    place if it is the ``same`` [m] but for rounding."""
    for i in range(count):
        if name[half, i, TYPE] == VERTEX_Q:
            continue
        x, y = corner[half, i, 0], corner[half, i, 1]
        j = _nearest(x, y, incident, m, near)
        if j >= 0:
            name[half, i, TYPE], name[half, i, OF_P], name[half, i, OF_Q] = VERTEX_Q, -1, j
            _take_place(corner, half, i, incident, j, same)
            continue
        if name[half, i, TYPE] == CROSSING:
            j = _nearest(x, y, reference, n, near)
            if j >= 0:
                name[half, i, TYPE], name[half, i, OF_P], name[half, i, OF_Q] = VERTEX_P, j, -1
        if name[half, i, TYPE] == VERTEX_P:
            _take_place(corner, half, i, reference, name[half, i, OF_P], same)


@njit(cache=True)
def _worse(name, half, i, j):
    """Whether corner i is less well defined than corner j; if they are equal, whether i > j."""
    for c in range(3):
        if name[half, i, c] != name[half, j, c]:
            return name[half, i, c] > name[half, j, c]
    return i > j


@njit(cache=True)
def _same_name(name, half, i, j):
    """Whether corners i and j have the name of one vertex."""
    same = True
    for c in range(3):
        same = same and name[half, i, c] == name[half, j, c]
    return same


@njit(cache=True)
def _goes(corner, name, half, i, j, slope):
    """Whether corner i of a short side is removed, and not its other end, corner j; see the
    module's text."""
    dx, dy = corner[half, j, 0] - corner[half, i, 0], corner[half, j, 1] - corner[half, i, 1]
    rise = slope[0] * dx + slope[1] * dy
    if rise * rise > SIDE_SLOPE * SIDE_SLOPE * (dx * dx + dy * dy):
        return rise < 0.0
    return _worse(name, half, i, j)


@njit(cache=True)
def _drop(corner, name, half, count, removed):
    """Remove one corner from a list."""
    for i in range(removed, count - 1):
        corner[half, i, 0], corner[half, i, 1] = corner[half, i + 1, 0], corner[half, i + 1, 1]
        for c in range(N_NAME):
            name[half, i, c] = name[half, i + 1, c]


@njit(cache=True)
def merge_corners(corner, name, half, count, short, near, slope):
    """Steps 2 and 3 of the module's text; returns the number of corners that remain.

    ``short`` [m] is the length up to which sides are removed, ``near`` [m] the distance from a line
    up to which crossings are.  ``slope`` (2,) is that of the incident face over the reference face.
    """
    while count > 1:
        shortest, at = short * short, -1
        for i in range(count):
            j = i + 1 if i + 1 < count else 0
            d = (corner[half, j, 0] - corner[half, i, 0]) ** 2 + (
                corner[half, j, 1] - corner[half, i, 1]
            ) ** 2
            if name[half, i, KEPT] and name[half, j, KEPT]:
                d /= MERGED_AGAIN * MERGED_AGAIN
            if _same_name(name, half, i, j):  # two crossings near one vertex
                d = 0.0
            if d <= shortest:
                shortest, at = d, i
        if at < 0:
            break
        after = at + 1 if at + 1 < count else 0
        removed = at
        if not _goes(corner, name, half, at, after, slope):
            removed = after
            name[half, at, LEAVES] = name[half, after, LEAVES]
        _drop(corner, name, half, count, removed)
        count -= 1
    i = 0
    while i < count and count > 3:
        before, after = i - 1 if i > 0 else count - 1, i + 1 if i + 1 < count else 0
        ux, uy = (
            corner[half, after, 0] - corner[half, before, 0],
            corner[half, after, 1] - corner[half, before, 1],
        )
        dx, dy = (
            corner[half, i, 0] - corner[half, before, 0],
            corner[half, i, 1] - corner[half, before, 1],
        )
        off = abs(ux * dy - uy * dx)
        if name[half, i, TYPE] == CROSSING and off <= near * np.sqrt(ux * ux + uy * uy):
            _drop(corner, name, half, count, i)
            count -= 1
        else:
            i += 1
    return count


@njit(cache=True)
def sort_corners(corner, name, half, count):
    """Let the list begin with the best defined corner; returns the half that then holds the
    list."""
    start = 0
    for i in range(1, count):
        if _worse(name, half, start, i):
            start = i
    if start == 0:
        return half
    other = 1 - half
    for i in range(count):
        j = i + start if i + start < count else i + start - count
        corner[other, i, 0], corner[other, i, 1] = corner[half, j, 0], corner[half, j, 1]
        for c in range(N_NAME):
            name[other, i, c] = name[half, j, c]
    return other


@njit(cache=True)
def _share(point, weight, a, b, c, d):
    """Distribute the area of the quadrilateral a b c d to its corners, by bilinear shape functions.

    The integral of a corner's function is A/6 + J/3, with the area A and the Jacobian J at the
    corner, which is a quarter of the cross product of its sides.  The shape functions represent
    linear functions exactly, so the weights have the first moment of the area.
    """
    nodes = (a, b, c, d)
    area = 0.5 * (
        (point[c, 0] - point[a, 0]) * (point[d, 1] - point[b, 1])
        - (point[c, 1] - point[a, 1]) * (point[d, 0] - point[b, 0])
    )
    for i in range(4):
        here, after, before = nodes[i], nodes[(i + 1) % 4], nodes[(i + 3) % 4]
        ax, ay = point[after, 0] - point[here, 0], point[after, 1] - point[here, 1]
        bx, by = point[before, 0] - point[here, 0], point[before, 1] - point[here, 1]
        weight[here] += area / 6.0 + (ax * by - ay * bx) / 12.0


@njit(cache=True)
def _between(corner, half, i, j, share, point, k):
    for c in range(2):
        point[k, c] = corner[half, i, c] + share * (corner[half, j, c] - corner[half, i, c])


@njit(cache=True)
def _named(name, k, type_, of_p, of_q, number):
    name[k, TYPE], name[k, OF_P], name[k, OF_Q], name[k, LEAVES] = type_, of_p, of_q, number


@njit(cache=True)
def n_spread(count, points, capacity):
    """Number of points that `spread` makes of a polygon of ``count`` corners, if ``points`` are
    made of a quadrilateral; at most ``capacity``."""
    if count >= 3 and points == 16 and 4 * count <= capacity:
        return 4 * count
    if count < 3 or points < 9:
        return min(count, capacity)
    for k in range((int(np.sqrt(points) + 0.5) - 1) // 2, 0, -1):
        if count * k * (k + 1) + 1 <= capacity:
            return count * k * (k + 1) + 1
    return min(count, capacity)


@njit(cache=True)
def _node(count, k, i, p, q):
    """Index of a point in a net of k steps: p steps forward and q steps back from corner i."""
    if p == k and q == k:
        return count * k * (k + 1)
    if q == k:
        i, p, q = (i - 1) % count, k, p
    return (i * k + q) * (k + 1) + p


@njit(cache=True)
def _spread_net(corner, name, half, count, cx, cy, k, point, mark, weight):
    """Spread points over a polygon in a net with k steps from corners to middles of sides; see
    `spread`."""
    for i in range(count):
        before, after = (i - 1) % count, (i + 1) % count
        for q in range(k):
            for p in range(k + 1):
                s, t, at = p / k, q / k, _node(count, k, i, p, q)
                for c in range(2):
                    here, centre = corner[half, i, c], cx if c == 0 else cy
                    on = 0.5 * (here + corner[half, after, c])
                    back = 0.5 * (here + corner[half, before, c])
                    point[at, c] = (1.0 - t) * ((1.0 - s) * here + s * on)
                    point[at, c] += t * ((1.0 - s) * back + s * centre)
                of_p, of_q = name[half, i, OF_P], name[half, i, OF_Q]
                if p == 0 and q == 0:
                    _named(mark, at, name[half, i, TYPE], of_p, of_q, 0)
                elif q == 0:
                    number = 0 if p == k else 2 + p
                    _named(mark, at, ON_SIDE, name[half, i, LEAVES], -1, number)
                elif p == 0:
                    _named(mark, at, ON_SIDE, name[half, before, LEAVES], -1, 2 + 2 * k - q)
                else:
                    number = 1 + name[half, i, TYPE] + 3 * ((p - 1) * k + q)
                    _named(mark, at, INNER, of_p, of_q, number)
    last = count * k * (k + 1)
    point[last, 0], point[last, 1] = cx, cy
    _named(mark, last, INNER, -1, -1, 0)
    for i in range(count):
        for q in range(k):
            for p in range(k):
                first, second = _node(count, k, i, p, q), _node(count, k, i, p + 1, q)
                third, fourth = _node(count, k, i, p + 1, q + 1), _node(count, k, i, p, q + 1)
                _share(point, weight, first, second, third, fourth)


@njit(cache=True)
def spread(corner, name, half, count, cx, cy, n_points, point, mark, weight):
    """Contact points of a polygon with the centroid (cx, cy), and their areas [m2] before scaling.

    The number of points decides the rule:

    - ``count``: the corners.  Each has the area between it, the middles of its sides and the
      centroid.
    - ``2 count + 1``: corners, middles of sides, centroid.  They divide the polygon into
      quadrilaterals, whose areas go to their corners by bilinear shape functions (square: 1/16,
      1/8, 1/4 of the area).
    - ``4 count``: corners, thirds of sides, and points a third of the way from the centroid to each
      corner.  They divide the polygon into cells at corners, at sides, and one within (square:
      1/36, 1/18, 1/9).
    - ``count k (k + 1) + 1``, k > 1: as ``2 count + 1``, each quadrilateral cut into a net of k by
      k (square: a grid, with the weights of the trapezium's rule).
    """
    if n_points > 4 * count:
        k = 2
        while count * k * (k + 1) + 1 < n_points:
            k += 1
        for i in range(n_points):
            weight[i] = 0.0
        _spread_net(corner, name, half, count, cx, cy, k, point, mark, weight)
        return
    for i in range(count):
        point[i, 0], point[i, 1] = corner[half, i, 0], corner[half, i, 1]
        for c in range(3):
            mark[i, c] = name[half, i, c]
        mark[i, LEAVES] = 0
    for i in range(n_points):
        weight[i] = 0.0
    if n_points == 2 * count + 1 and count > 1:
        point[2 * count, 0], point[2 * count, 1] = cx, cy
        _named(mark, 2 * count, INNER, -1, -1, 0)
        for i in range(count):
            _between(corner, half, i, (i + 1) % count, 0.5, point, count + i)
            _named(mark, count + i, ON_SIDE, name[half, i, LEAVES], -1, 0)
        for i in range(count):
            _share(point, weight, i, count + i, 2 * count, count + (i - 1) % count)
        return
    inner = 1.0
    if n_points == 4 * count:
        inner = 1.0 / 9.0
        for i in range(count):
            j = (i + 1) % count
            for k in range(2):
                _between(corner, half, i, j, (k + 1) / 3.0, point, count + 2 * i + k)
                _named(mark, count + 2 * i + k, ON_SIDE, name[half, i, LEAVES], -1, 1 + k)
            point[3 * count + i, 0] = cx + (corner[half, i, 0] - cx) / 3.0
            point[3 * count + i, 1] = cy + (corner[half, i, 1] - cy) / 3.0
            _named(
                mark,
                3 * count + i,
                INNER,
                name[half, i, OF_P],
                name[half, i, OF_Q],
                1 + name[half, i, TYPE],
            )
        for i in range(count):
            j, first, last = (i + 1) % count, count + 2 * i, count + 2 * ((i - 1) % count) + 1
            _share(point, weight, i, first, 3 * count + i, last)
            _share(point, weight, first, first + 1, 3 * count + j, 3 * count + i)
    first = n_points - count  # first corner of the inner polygon, or of the polygon itself
    for i in range(count):
        j = (i + 1) % count
        area = 0.5 * (
            (corner[half, i, 0] - cx) * (corner[half, j, 1] - cy)
            - (corner[half, i, 1] - cy) * (corner[half, j, 0] - cx)
        )
        weight[first + i] += 0.5 * inner * area
        weight[first + j] += 0.5 * inner * area


@njit(cache=True)
def scale(point, n, cx, cy, area, weight):
    """Scale the weights (n,), so that their sum is ``area`` [m2] and their centroid (cx, cy) [m].

    This is the least change: each weight gets a factor that is linear in the place of its point.
    If the points lie on a line, or a factor would be negative, only the sum is corrected.
    """
    total, mx, my, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        x, y = point[i, 0] - cx, point[i, 1] - cy
        w = max(weight[i], 0.0)
        weight[i] = w
        total += w
        mx += w * x
        my += w * y
        xx += w * x * x
        xy += w * x * y
        yy += w * y * y
    if total <= 0.0:
        for i in range(n):
            weight[i] = area / n
        return
    ax, ay, constant = 0.0, 0.0, 1.0
    det = xx * yy - xy * xy
    if det > ROUNDING * (xx + yy) ** 2:
        ax, ay = (xy * my - yy * mx) / det, (xy * mx - xx * my) / det
        least = 1.0
        for i in range(n):
            x, y = point[i, 0] - cx, point[i, 1] - cy
            least = min(least, 1.0 + ax * x + ay * y)
        mean = 1.0 + (ax * mx + ay * my) / total  # of the factors; positive but for rounding
        if least > 0.0 and mean > ROUNDING:
            constant = 1.0 / mean
        else:
            ax, ay = 0.0, 0.0
    for i in range(n):
        x, y = point[i, 0] - cx, point[i, 1] - cy
        weight[i] *= constant * (1.0 + ax * x + ay * y) * (area / total)
