"""LU of matrices made of one dense block per body and two per pair of bodies.

`linear.order` orders the bodies, and `linear.symbolic` finds the pattern of the factors.  Rows are
exchanged only inside a body's own block.  So the pattern is the same for all matrices of one list
of pairs, and is found once.

The reason not to use SuperLU is speed.  A factorisation and one solution, for walls in running bond
with three unknowns per block, take on one core (medians of process time)

    blocks                        49         500
    this                       0.027 ms    0.52 ms
    SuperLU                    0.21  ms    3.5  ms
    SuperLU, order known       0.16  ms    1.8  ms
    LAPACK, dense              0.095 ms

In addition, the sign of the determinant is known, and the bodies whose pivots are negative.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array
from drystone.common.compiled import njit
from drystone.common.tolerances import MOST_RAISED
from drystone.linear.symbolic import (
    BORDER,
    CHILD,
    ENTRY,
    FIRST,
    N_RUNS,
    PANEL,
    SIBLING,
    TILE,
    UPDATE,
    Structure,
)


class Factors(NamedTuple):
    """Memory for the factors A = (L + D) (I + U), with the diagonal blocks D, and for their
    calculation."""

    panels: Array  # for each front, its bodies' rows of L, D and U; then L below them, transposed
    inverse: Array  # (n_movable, n_dof, n_dof) inverse of D
    work: Array  # scratch memory


def allocate(structure: Structure) -> Factors:
    """Memory for the factors of matrices of this structure."""
    n_dof = len(structure.dof)
    end = structure.fronts[-1]
    width = np.diff(structure.fronts[:, [FIRST, BORDER]], axis=0).sum(axis=1)
    return Factors(
        panels=np.zeros(end[PANEL]),
        inverse=np.zeros((end[FIRST], n_dof, n_dof)),
        work=np.zeros(end[UPDATE] + n_dof * (n_dof * int(width.max(initial=0)) + 1)),
    )


@njit(cache=True, error_model="numpy")
def add_rows(to, t, to_stride, source, s, stride, n, m):
    """Add a matrix (n, m) to another one.  Both are parts of flat arrays: ``source`` from ``s`` on,
    ``to`` from ``t`` on."""
    for _ in range(n):
        x, y = to[t : t + m], source[s : s + m]
        for j in range(m):
            x[j] += y[j]
        t += to_stride
        s += stride


@njit(cache=True, error_model="numpy")
def subtract_product(c, c_at, left, left_at, right, right_at, size):
    """C -= L R with ``size`` (n, p, m): C (n, m), L (n, p), R (p, m).

    Each is part of a flat array.  Its ``_at`` holds the first index, the stride from row to row
    and, for L, the stride along a row.  ``n`` and ``p`` are multiples of `TILE`.
    """
    n, p, m = size
    at, stride = c_at
    i0, down, along = left_at
    j0, r_stride = right_at
    for _ in range(0, n, TILE):
        c0 = c[at : at + m]
        c1 = c[at + stride : at + stride + m]
        c2 = c[at + 2 * stride : at + 2 * stride + m]
        i, j = i0, j0
        for _ in range(0, p, TILE):
            l00, l10, l20 = left[i], left[i + down], left[i + 2 * down]
            i += along
            l01, l11, l21 = left[i], left[i + down], left[i + 2 * down]
            i += along
            l02, l12, l22 = left[i], left[i + down], left[i + 2 * down]
            i += along
            r0 = right[j : j + m]
            r1 = right[j + r_stride : j + r_stride + m]
            r2 = right[j + 2 * r_stride : j + 2 * r_stride + m]
            j += TILE * r_stride
            for k in range(m):
                x, y, z = r0[k], r1[k], r2[k]
                c0[k] -= l00 * x + l01 * y + l02 * z
                c1[k] -= l10 * x + l11 * y + l12 * z
                c2[k] -= l20 * x + l21 * y + l22 * z
        at += TILE * stride
        i0 += TILE * down


@njit(cache=True, error_model="numpy")
def multiply_rows(dof, block, c, at, stride, m, scratch):
    """Multiply ``m`` columns of a matrix, part of a flat array, by a small matrix from the left."""
    nd = len(dof)
    if nd == TILE:  # in registers; without it, the plane's factorisations take 1.2 to 1.3 times
        b00, b01, b02 = block[0, 0], block[0, 1], block[0, 2]
        b10, b11, b12 = block[1, 0], block[1, 1], block[1, 2]
        b20, b21, b22 = block[2, 0], block[2, 1], block[2, 2]
        c0 = c[at : at + m]
        c1 = c[at + stride : at + stride + m]
        c2 = c[at + 2 * stride : at + 2 * stride + m]
        for k in range(m):
            x, y, z = c0[k], c1[k], c2[k]
            c0[k] = b00 * x + b01 * y + b02 * z
            c1[k] = b10 * x + b11 * y + b12 * z
            c2[k] = b20 * x + b21 * y + b22 * z
        return
    for d in range(nd):
        x, y = scratch[d * m : d * m + m], c[at + d * stride : at + d * stride + m]
        for k in range(m):
            x[k] = -y[k]
            y[k] = 0.0
    flat = block.reshape(nd * nd)
    subtract_product(c, (at, stride), flat, (0, nd, np.int64(1)), scratch, (0, m), (nd, nd, m))


@njit(cache=True, error_model="numpy")
def invert(dof, matrix, scale):
    """Invert a small matrix in place, with exchange of rows.

    Returns the smallest ratio of a pivot to the largest entry of its column of ``scale``, at most
    1, with the sign of the determinant; 0 for a singular matrix.
    """
    nd = len(dof)
    smallest, sign = 1.0, 1.0
    exchanged = 0
    for k in range(nd):
        best, size = k, 0.0
        for i in range(nd):
            size = max(size, abs(scale[i, k]))
            if i > k and abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        ratio = abs(matrix[best, k]) / size
        if not ratio > 0.0:  # also if it is NaN
            return 0.0
        smallest = min(smallest, ratio)
        exchanged |= best << (4 * k)
        sign = sign if matrix[best, k] > 0.0 else -sign
        if best != k:
            sign = -sign
            for j in range(nd):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        factor = 1.0 / matrix[k, k]
        matrix[k, k] = 1.0
        for j in range(nd):
            matrix[k, j] *= factor
        for i in range(nd):
            if i != k:
                factor = matrix[i, k]
                matrix[i, k] = 0.0
                for j in range(nd):
                    matrix[i, j] -= factor * matrix[k, j]
    for k in range(nd - 1, -1, -1):
        best = (exchanged >> (4 * k)) & 15
        if best != k:
            for i in range(nd):
                matrix[i, k], matrix[i, best] = matrix[i, best], matrix[i, k]
    return sign * smallest


@njit(cache=True, error_model="numpy")
def assemble(structure, s, diagonal, upper, lower, factors):
    """Fill front ``s`` with blocks of the matrix and the update matrices of the fronts below."""
    nd = len(structure.dof)
    order, fronts, _, runs, entries, _ = structure
    panels, _, work = factors
    w = fronts[s + 1, FIRST] - fronts[s, FIRST]
    r = fronts[s + 1, BORDER] - fronts[s, BORDER]
    m, q = nd * (w + r), nd * r
    rows = fronts[s, PANEL]
    columns = rows + nd * w * m
    rest = fronts[s, UPDATE]
    panels[rows : fronts[s + 1, PANEL]] = 0.0
    work[rest : rest + q * q] = 0.0
    for i in range(w):
        body = order[fronts[s, FIRST] + i]
        at = rows + nd * i * (m + 1)
        for x in range(nd):
            for y in range(nd):
                panels[at + x * m + y] = diagonal[body, x, y]
    for e in range(fronts[s, ENTRY], fronts[s + 1, ENTRY]):
        pair, i, j = entries[e, 0], entries[e, 1], entries[e, 2]
        right = rows + nd * (i * m + j)
        if j < w:
            left, down, along = rows + nd * (j * m + i), m, 1
        else:
            left, down, along = columns + nd * (i * q + j - w), 1, q
        for x in range(nd):
            for y in range(nd):
                xy, yx = upper[pair, x, y], lower[pair, x, y]
                if not entries[e, 3]:
                    xy, yx = yx, xy
                panels[right + x * m + y] += xy
                panels[left + x * down + y * along] += yx
    c = fronts[s, CHILD]
    while c != -1:
        begin = fronts[c, BORDER]
        stride = nd * (fronts[c + 1, BORDER] - begin)
        for a in range(begin, begin + fronts[c, N_RUNS]):
            i, n = runs[a, 1], nd * runs[a, 2]
            row = fronts[c, UPDATE] + nd * runs[a, 0] * stride
            for b in range(begin, begin + fronts[c, N_RUNS]):
                j, length = runs[b, 1], nd * runs[b, 2]
                source = row + nd * runs[b, 0]
                if i < w:
                    at = rows + nd * (i * m + j)
                    add_rows(panels, at, m, work, source, stride, n, length)
                elif j >= w:
                    at = rest + nd * ((i - w) * q + j - w)
                    add_rows(work, at, q, work, source, stride, n, length)
                else:
                    at = columns + nd * (j * q + i - w)
                    for x in range(n):
                        for y in range(length):
                            panels[at + y * q + x] += work[source + x * stride + y]
        c = fronts[c, SIBLING]


@njit(cache=True, error_model="numpy", nogil=True)
def factorise_fronts(
    structure, low, high, scratch_at, diagonal, upper, lower, factors, mass, damping, least
):
    """`factorise` the fronts ``low`` to before ``high``; those below them must be done.  Scratch
    memory begins at ``scratch_at``."""
    nd = len(structure.dof)
    order, fronts = structure.order, structure.fronts
    panels, inverse, work = factors
    scratch = work[scratch_at:]
    one = np.int64(1)  # with a plain 1, a type of its own, `subtract_product` is compiled twice
    smallest, sign = 1.0, 1.0
    for s in range(low, high):
        assemble(structure, s, diagonal, upper, lower, factors)
        w = fronts[s + 1, FIRST] - fronts[s, FIRST]
        r = fronts[s + 1, BORDER] - fronts[s, BORDER]
        m, q = nd * (w + r), nd * r
        rows = fronts[s, PANEL]
        columns = rows + nd * w * m
        for k in range(w):
            at = rows + nd * k * (m + 1)
            place = fronts[s, FIRST] + k
            block = inverse[place]
            for x in range(nd):
                for y in range(nd):
                    block[x, y] = panels[at + x * m + y]
            body = order[place]
            ratio = invert(structure.dof, block, diagonal[body])
            more = least
            lacking = ratio < 0.0
            while lacking and 0.0 < more < MOST_RAISED * least:
                # Once more after the pivot is positive: a tiny pivot would upset other bodies.
                lacking = ratio < 0.0
                damping[body] += more
                for x in range(nd):
                    panels[at + x * (m + 1)] += more * mass[body, x]
                    for y in range(nd):
                        block[x, y] = panels[at + x * m + y]
                ratio = invert(structure.dof, block, diagonal[body])
                more = damping[body]
            if ratio == 0.0:
                return 0.0
            smallest = min(smallest, abs(ratio))
            sign = sign if ratio > 0.0 else -sign
            ahead = m - nd * (k + 1)
            multiply_rows(structure.dof, block, panels, at + nd, m, ahead, scratch)
            below = at + nd * m
            subtract_product(
                panels, (below + nd, m), panels, (below, m, one), panels, (at + nd, m),
                (nd * (w - k - 1), nd, ahead),
            )  # fmt: skip
            subtract_product(
                panels, (columns + nd * k * q, q), panels, (rows + nd * k, one, m),
                panels, (columns, q), (nd, nd * k, q),
            )  # fmt: skip
        subtract_product(
            work, (fronts[s, UPDATE], q), panels, (columns, one, q), panels, (rows + nd * w, m),
            (q, nd * w, q),
        )  # fmt: skip
    return sign * smallest


@njit(cache=True, error_model="numpy")
def factorise(structure, diagonal, upper, lower, factors, mass, damping, least):
    """Factorise the matrix of the blocks ``diagonal`` (n, n_dof, n_dof), ``upper`` (n_pairs, n_dof,
    n_dof) in the rows of a and columns of b, and ``lower`` in the rows of b and columns of a.

    If ``least`` [1/s2] is positive, pivots with a negative determinant are regularised: a multiple
    of the ``mass`` (n, n_dof) of the body is added to the diagonal.  The multiple is at least
    ``least``, and twice the one that makes the determinant positive.  It is added to ``damping``
    (n,) [1/s2].

    Returns the smallest pivot over the largest entry of its column in the body's own block, at most
    1, with the sign of the determinant.  Returns 0, with unusable factors, for singular matrices
    and for matrices with NaN.
    """
    n_fronts = structure.fronts.shape[0] - 1
    scratch_at = structure.fronts[n_fronts, UPDATE]
    return factorise_fronts(
        structure, 0, n_fronts, scratch_at, diagonal, upper, lower, factors, mass, damping, least
    )


@njit(cache=True, error_model="numpy")
def _subtract_known(panels, at, stride, known, rest):
    """Subtract the products of six rows with the ``known`` unknowns from ``rest`` (6,).  Six sums
    are formed at once, so that none waits for its last term."""
    m = known.shape[0]
    u0, u1, u2 = panels[at : at + m], panels[at + stride :], panels[at + 2 * stride :]
    at += 3 * stride
    u3, u4, u5 = panels[at : at + m], panels[at + stride :], panels[at + 2 * stride :]
    s0, s1, s2, s3, s4, s5 = rest[0], rest[1], rest[2], rest[3], rest[4], rest[5]
    for j in range(m):
        x = known[j]
        s0 -= u0[j] * x
        s1 -= u1[j] * x
        s2 -= u2[j] * x
        s3 -= u3[j] * x
        s4 -= u4[j] * x
        s5 -= u5[j] * x
    rest[0], rest[1], rest[2], rest[3], rest[4], rest[5] = s0, s1, s2, s3, s4, s5


@njit(cache=True, error_model="numpy")
def _subtract_sums(panels, at, stride, known, rest, d):
    """The same for three rows, from ``rest[d]`` on; the sums are formed before they are
    subtracted."""
    m = known.shape[0]
    u0, u1, u2 = panels[at : at + m], panels[at + stride :], panels[at + 2 * stride :]
    s0 = s1 = s2 = 0.0
    for j in range(m):
        s0 += u0[j] * known[j]
        s1 += u1[j] * known[j]
        s2 += u2[j] * known[j]
    rest[d] -= s0
    rest[d + 1] -= s1
    rest[d + 2] -= s2


@njit(cache=True, error_model="numpy")
def _is_zero(x, order, first, w):
    """Whether a right-hand side ``x`` (n, n_dof) is zero for the ``w`` bodies of a front."""
    for i in range(first, first + w):
        for d in range(x.shape[1]):
            if x[order[i], d] != 0.0:
                return False
    return True


@njit(cache=True, error_model="numpy")
def solve(structure, factors, rhs):
    """Replace each of the right-hand sides ``rhs`` (k, n, n_dof) by its solution, which is zero for
    fixed bodies."""
    nd = len(structure.dof)
    order, fronts, border = structure.order, structure.fronts, structure.border
    panels, inverse, work = factors
    n_fronts = fronts.shape[0] - 1
    for s in range(n_fronts):
        first, begin = fronts[s, FIRST], fronts[s, BORDER]
        w, r = fronts[s + 1, FIRST] - first, fronts[s + 1, BORDER] - begin
        m, q = nd * (w + r), nd * r
        rows = fronts[s, PANEL]
        columns = rows + nd * w * m
        y, below, t = work[: nd * w], work[nd * w : m], work[m : m + nd]
        for side in range(rhs.shape[0]):
            x = rhs[side]
            if _is_zero(x, order, first, w):
                continue  # if forces act on few bodies, few fronts have work
            below[:] = 0.0
            for i in range(w):
                body = order[first + i]
                k = nd * i
                for d in range(nd):
                    t[d] = x[body, d]
                if nd == 2 * TILE:
                    _subtract_known(panels, rows + k * m, m, y[:k], t)
                else:
                    for d in range(nd):
                        left = panels[rows + (k + d) * m : rows + (k + d) * m + k]
                        rest = t[d]
                        for j in range(k):
                            rest -= left[j] * y[j]
                        t[d] = rest
                for d in range(nd):
                    y[k + d] = 0.0
                    for e in range(nd):
                        y[k + d] += inverse[first + i, d, e] * t[e]
                    x[body, d] = y[k + d]
                for d in range(k, k + nd, TILE):
                    at = columns + d * q
                    l0 = panels[at : at + q]
                    l1 = panels[at + q : at + 2 * q]
                    l2 = panels[at + 2 * q : at + 3 * q]
                    y0, y1, y2 = y[d], y[d + 1], y[d + 2]
                    for j in range(q):
                        below[j] += l0[j] * y0 + l1[j] * y1 + l2[j] * y2
            for j in range(r):
                for d in range(nd):
                    x[border[begin + j], d] -= below[nd * j + d]
    for s in range(n_fronts - 1, -1, -1):
        first, begin = fronts[s, FIRST], fronts[s, BORDER]
        w, r = fronts[s + 1, FIRST] - first, fronts[s + 1, BORDER] - begin
        m = nd * (w + r)
        for side in range(rhs.shape[0]):
            x = rhs[side]
            y = work[:m]
            for i in range(w + r):
                body = order[first + i] if i < w else border[begin + i - w]
                for d in range(nd):
                    y[nd * i + d] = x[body, d]
            for i in range(w - 1, -1, -1):
                k = nd * (i + 1)
                known = y[k:]
                at = fronts[s, PANEL] + nd * i * m + k
                if nd == 2 * TILE:
                    _subtract_known(panels, at, m, known, y[nd * i :])
                else:
                    _subtract_sums(panels, at, m, known, y, nd * i)
                for d in range(nd):
                    x[order[first + i], d] = y[nd * i + d]
    for body in order[fronts[n_fronts, FIRST] :]:
        rhs[:, body] = 0.0


@njit(cache=True)
def residual(structure, a, b, fixed, diagonal, upper, lower, x, rhs):
    """Subtract A x from ``rhs``; ``x`` and ``rhs`` are (k, n, n_dof), and zero on fixed bodies.

    The result is the residual of the solution x; solving for it gives the correction of x.
    """
    nd = len(structure.dof)
    for side in range(rhs.shape[0]):
        for i in range(fixed.shape[0]):
            for d in range(nd):
                for e in range(nd):
                    rhs[side, i, d] -= diagonal[i, d, e] * x[side, i, e]
        for p in range(a.shape[0]):
            i, j = a[p], b[p]
            if not (fixed[i] or fixed[j]):
                for d in range(nd):
                    for e in range(nd):
                        rhs[side, i, d] -= upper[p, d, e] * x[side, j, e]
                        rhs[side, j, d] -= lower[p, d, e] * x[side, i, e]
