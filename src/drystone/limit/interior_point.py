"""Interior-point method for linear programs of thousands of blocks.

    minimise c.x   subject to   A x = b,   x_j >= 0 but for the free ones

Mehrotra's predictor and corrector with Gondzio's further correctors (Computational Optimization and
Applications 6, 1996).  Every iteration factorises the normal equations

    (A D A^T) dy + A_f dx_f = h,      A_f^T dy = g,      D = diag(x / z)

A block touches a handful of others, so that the factor of a plane wall stays sparse; the few free
columns A_f are eliminated by a small dense system.  A general solver is as exact but orders of
magnitude slower here: iterative or simplex steps suffer from the many equally good force states
of a wall, a direct factorisation does not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csc_matrix, csr_array, diags_array
from scipy.sparse.linalg import SuperLU, splu

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Share of the way to the boundary that a step goes.
STEP = 0.995
#: Further correctors an iteration may take; each costs a solution, not a factorisation.
MOST_CORRECTORS = 4
#: Added to each diagonal entry, as a share of it.
REGULARISATION = 1e-14
#: Refinements of one solution, and the residual over the right side that needs none.
MOST_REFINEMENTS, SMALL_REST = 4, 1e-13
#: Without progress in this many iterations the best point so far is given back.
PATIENCE = 12


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Primal and dual solution of a linear program."""

    x: Array  # (n_columns,)
    y: Array  # (n_rows,) dual values of the rows
    converged: bool
    error: float  # largest of relative infeasibilities and relative gap
    n_iterations: int


@dataclass(kw_only=True)
class _Point:
    x: Array  # of the bounded columns
    free: Array
    y: Array
    z: Array


def solve(
    cost: Array,
    matrix: csc_array,
    right: Array,
    free: IntArray,
    *,
    tolerance: float = 1e-8,
    max_iterations: int = 200,
    enough: float | None = None,
    give_up: float = 1e7,
) -> Solution:
    """Solve the linear program of the module's heading.

    Parameters
    ----------
    cost, matrix, right
        c (n_columns,), A (n_rows, n_columns), b (n_rows,), all of order one.
    free
        Columns without bounds, few.
    tolerance
        On the relative infeasibilities and the relative gap.
    enough
        Stop as soon as a feasible x has an objective below this.
    give_up
        Stop as unbounded when the objective falls below minus this.
    """
    bounded = np.setdiff1d(np.arange(len(cost)), free)
    c, c_free = cost[bounded], cost[free]
    newton = _Newton(csc_array(matrix[:, bounded]), matrix[:, free].toarray())
    try:
        point = _start(newton, c, c_free, right)
    except (RuntimeError, np.linalg.LinAlgError):  # rows or free columns that depend on others
        nothing = np.zeros(len(cost))
        return Solution(x=nothing, y=0.0 * right, converged=False, error=np.inf, n_iterations=0)
    best, best_error, waited, converged, n_iterations = point, np.inf, 0, False, 0
    while n_iterations < max_iterations:
        at = _missing(newton, point, c, c_free, right)
        waited = 0 if at.error < 0.9 * best_error else waited + 1
        if at.error < best_error:
            best, best_error = point, at.error
        feasible = at.infeasibility <= tolerance
        if feasible and enough is not None and at.objective < enough:
            best, converged = point, True
        converged = converged or best_error <= tolerance
        if converged or waited > PATIENCE or (feasible and at.objective < -give_up):
            break
        try:
            point = _iterate(newton, point, *at.residuals)
        except (RuntimeError, np.linalg.LinAlgError):  # the factorisation broke down
            break
        n_iterations += 1
    x = np.zeros(len(cost))
    x[bounded], x[free] = best.x, best.free
    return Solution(
        x=x, y=best.y, converged=converged, error=float(best_error), n_iterations=n_iterations
    )


class _Missing(NamedTuple):
    """How far a point is from the solution."""

    residuals: tuple[Array, Array, Array]  # of rows, of bounded columns, of free ones
    objective: float
    infeasibility: float  # of the rows, relative
    error: float  # largest of relative infeasibilities and relative gap


def _missing(newton: _Newton, point: _Point, c: Array, c_free: Array, right: Array) -> _Missing:
    a, a_free = newton.a, newton.a_free
    rp = right - a @ point.x - a_free @ point.free
    rd = c - a.T @ point.y - point.z
    rf = c_free - a_free.T @ point.y
    scale_b = 1.0 + np.abs(right).max(initial=0.0)
    scale_c = 1.0 + max(np.abs(c).max(initial=0.0), np.abs(c_free).max(initial=0.0))
    objective = float(c @ point.x + c_free @ point.free)
    primal = float(np.abs(rp).max(initial=0.0)) / scale_b
    dual = max(np.abs(rd).max(initial=0.0), np.abs(rf).max(initial=0.0)) / scale_c
    gap = abs(objective - float(right @ point.y)) / (1.0 + abs(objective))
    return _Missing((rp, rd, rf), objective, primal, max(primal, dual, gap))


class _Newton:
    """The normal equations of one matrix, factorised anew for every scaling."""

    def __init__(self, a: csc_array, a_free: Array) -> None:
        self.a, self.a_free = a, a_free
        # The order of rows that keeps the factor sparse, from the pattern without cancellation.
        pattern = abs(a) @ abs(a).T
        pattern = pattern + diags_array(np.asarray(pattern.sum(axis=1)) + 1.0)
        self._order: IntArray = np.argsort(_factor(pattern, "MMD_AT_PLUS_A").perm_c)
        self._ordered = csc_array(csr_array(a)[self._order])

    def factorise(self, scaling: Array) -> None:
        """Prepare solutions for D = diag(scaling)."""
        normal = (self._ordered @ diags_array(scaling)) @ self._ordered.T
        diagonal = normal.diagonal()
        least = float(diagonal[diagonal > 0.0].min(initial=1.0))
        normal = normal + diags_array(REGULARISATION * np.maximum(diagonal, least))
        self._lu = _factor(normal, "NATURAL")
        self._scaling = scaling
        if self.a_free.shape[1]:
            self._columns = np.column_stack([self._normal(col) for col in self.a_free.T])
            self._small = self.a_free.T @ self._columns

    def _normal(self, h: Array) -> Array:
        """Solve A D A^T y = h, refined until the residual no longer shrinks."""
        y = self._direct(h)
        rest = h - self.a @ (self._scaling * (self.a.T @ y))
        size = float(np.abs(rest).max(initial=0.0))
        for _ in range(MOST_REFINEMENTS):
            if size <= SMALL_REST * float(np.abs(h).max(initial=0.0)):
                break
            finer = y + self._direct(rest)
            rest = h - self.a @ (self._scaling * (self.a.T @ finer))
            before, size = size, float(np.abs(rest).max(initial=0.0))
            if size >= before:
                break
            y = finer
        return y

    def _direct(self, h: Array) -> Array:
        y = np.empty_like(h)
        y[self._order] = self._lu.solve(h[self._order])
        return y

    def solve(self, h: Array, g: Array) -> tuple[Array, Array]:
        """Solve for dy and dx_f."""
        dy = self._normal(h)
        if not self.a_free.shape[1]:
            return dy, np.zeros(0)
        dx = np.asarray(np.linalg.solve(self._small, self.a_free.T @ dy - g), dtype=np.float64)
        return dy - self._columns @ dx, dx


def _factor(normal: csc_array, order: str) -> SuperLU:
    return splu(
        csc_matrix(normal),
        permc_spec=order,
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def _start(newton: _Newton, c: Array, c_free: Array, b: Array) -> _Point:
    """Mehrotra's starting point: least squares, pushed into the interior."""
    a = newton.a
    newton.factorise(np.ones(a.shape[1]))
    dy, free = newton.solve(b, np.zeros(len(c_free)))
    x = a.T @ dy
    y, _ = newton.solve(a @ c, c_free)
    z = c - a.T @ y
    x = x + max(-1.5 * x.min(initial=0.0), 0.0) + 1e-3
    z = z + max(-1.5 * z.min(initial=0.0), 0.0) + 1e-3
    product = float(x @ z)
    x, z = x + 0.5 * product / z.sum(), z + 0.5 * product / x.sum()
    return _Point(x=x, free=free, y=y, z=z)


def _iterate(newton: _Newton, point: _Point, rp: Array, rd: Array, rf: Array) -> _Point:
    x, z = point.x, point.z
    n = len(x)
    newton.factorise(x / z)

    def direction(rp: Array, rd: Array, rf: Array, rc: Array) -> tuple[Array, ...]:
        """Newton's direction for the given residuals; rc of x z."""
        dy, dx_free = newton.solve(rp - newton.a @ ((rc - x * rd) / z), rf)
        dz = rd - newton.a.T @ dy
        return (rc - x * dz) / z, dx_free, dy, dz

    mu = float(x @ z) / n
    step = direction(rp, rd, rf, -x * z)
    ap, ad = _reach(x, step[0]), _reach(z, step[3])
    after = float((x + ap * step[0]) @ (z + ad * step[3])) / n
    target = (after / mu) ** 3 * mu
    step = direction(rp, rd, rf, target - x * z - step[0] * step[3])
    ap, ad = _reach(x, step[0]), _reach(z, step[3])
    for _ in range(MOST_CORRECTORS):
        # Aim further than the step goes, and correct the products that fall out of line.
        wider_p, wider_d = min(1.0, 1.3 * ap + 0.1), min(1.0, 1.3 * ad + 0.1)
        product = (x + wider_p * step[0]) * (z + wider_d * step[3])
        rc = np.clip(product, 0.1 * target, 10.0 * target) - product
        rc = np.maximum(rc, -10.0 * target)
        more = direction(np.zeros_like(rp), np.zeros_like(rd), np.zeros_like(rf), rc)
        tried = tuple(s + m for s, m in zip(step, more, strict=True))
        tp, td = _reach(x, tried[0]), _reach(z, tried[3])
        if tp < ap + 0.01 and td < ad + 0.01:
            break
        if tp + td < ap + ad:
            break
        step, ap, ad = tried, tp, td
    ap, ad = min(1.0, STEP * ap), min(1.0, STEP * ad)
    return _Point(
        x=x + ap * step[0],
        free=point.free + ap * step[1],
        y=point.y + ad * step[2],
        z=z + ad * step[3],
    )


def _reach(x: Array, dx: Array) -> float:
    """Largest share of the step, up to 1 / `STEP`, that keeps x from going negative."""
    falling = dx < 0.0
    reach = float(np.min(-x[falling] / dx[falling], initial=np.inf))
    return min(1.0 / STEP, reach)
