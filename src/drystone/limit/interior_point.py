"""Interior-point method for programs of cones, of thousands of blocks.

    minimise c.x   subject to   A x = b,   x in a product of cones but for the free ones

With cones of size 1 it is a linear program, and so it is with those of size 2; friction in space
has cones of size 3.  Mehrotra's predictor and corrector with Gondzio's further correctors
(Computational Optimization and Applications 6, 1996), in the scaling of `cone_algebra`.  Every
iteration factorises the normal equations

    (A W^2 A^T) dy + A_f dx_f = h,      A_f^T dy = g

A block touches a handful of others, so that the factor of a wall stays sparse; the few free
columns A_f are eliminated by a small dense system.  The equations grow singular towards the end,
as they have to: what the step leaves unbalanced is solved for once more until nothing is gained.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array, csc_matrix, csr_array, diags_array
from scipy.sparse.linalg import SuperLU, splu

from drystone.common.arrays import Array, IntArray
from drystone.limit.cone_algebra import Cones

#: Share of the distance to the boundary that a step takes.
STEP = 0.995
#: Further correctors an iteration may take; each costs a solution, not a factorisation.
MOST_CORRECTORS = 4
#: Added to each diagonal entry, as a share of it.
REGULARISATION = 1e-14
#: Refinements of a step, and what is unbalanced, over numbers of order one, that needs none.
MOST_REFINEMENTS, SMALL_RESIDUAL = 6, 1e-15
#: Without progress in this many iterations the best point so far is given back.
PATIENCE = 12


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Primal and dual solution of a program."""

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


class _Step(NamedTuple):
    x: Array
    free: Array
    y: Array
    z: Array


def solve(
    cost: Array,
    matrix: csc_array,
    right: Array,
    free: IntArray,
    *,
    cones: Sequence[tuple[int, int]] = (),
    tolerance: float = 1e-8,
    max_iterations: int = 200,
    enough: float | None = None,
    give_up: float = 1e7,
) -> Solution:
    """Solve the program of the module's heading.

    Parameters
    ----------
    cost, matrix, right
        c (n_columns,), A (n_rows, n_columns), b (n_rows,), all of order one.
    free
        Columns without bounds, few.
    cones
        How many cones of which size the other columns make up, in their order; all of size 1 where
        none is given.
    tolerance
        On the relative infeasibilities and the relative gap.
    enough
        Stop as soon as a feasible x has an objective below this.
    give_up
        Stop as unbounded when the objective falls below minus this.
    """
    bounded = np.setdiff1d(np.arange(len(cost)), free)
    c, c_free = cost[bounded], cost[free]
    product = Cones(cones or [(len(bounded), 1)])
    newton = _Newton(csr_array(matrix[:, bounded]), matrix[:, free].toarray(), product)
    try:
        point = _start(newton, c, c_free, right)
    except (RuntimeError, np.linalg.LinAlgError):  # rows or free columns that depend on others
        nothing = np.zeros(len(cost))
        return Solution(x=nothing, y=0.0 * right, converged=False, error=np.inf, n_iterations=0)
    best, best_error, converged, n_iterations = _follow(
        newton, point, (c, c_free, right), tolerance, max_iterations, enough, give_up
    )
    x = np.zeros(len(cost))
    x[bounded], x[free] = best.x, best.free
    return Solution(x=x, y=best.y, converged=converged, error=best_error, n_iterations=n_iterations)


def _follow(
    newton: _Newton,
    point: _Point,
    program: tuple[Array, Array, Array],
    tolerance: float,
    max_iterations: int,
    enough: float | None,
    give_up: float,
) -> tuple[_Point, float, bool, int]:
    """The best point found, its error, whether it is good enough, and how many steps."""
    best, best_error, waited, converged, n_iterations = point, np.inf, 0, False, 0
    while n_iterations < max_iterations:
        at = _missing(newton, point, *program)
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
            with np.errstate(divide="raise", over="raise", invalid="raise"):
                point = _iterate(newton, point, *at.residuals)
        except (RuntimeError, np.linalg.LinAlgError, FloatingPointError):
            break  # the factorisation broke down, or the point lies on the boundary
        n_iterations += 1
    return best, float(best_error), converged, n_iterations


class _Missing(NamedTuple):
    """How far a point is from the solution."""

    residuals: tuple[Array, Array, Array]  # of rows, of bounded columns, of free ones
    objective: float
    infeasibility: float  # of the rows, relative
    error: float  # largest of relative infeasibilities and relative gap


def _missing(newton: _Newton, point: _Point, c: Array, c_free: Array, right: Array) -> _Missing:
    rp = right - newton.a @ point.x - newton.a_free @ point.free
    rd = c - newton.a_t @ point.y - point.z
    rf = c_free - newton.a_free.T @ point.y
    scale_b = 1.0 + np.abs(right).max(initial=0.0)
    scale_c = 1.0 + max(np.abs(c).max(initial=0.0), np.abs(c_free).max(initial=0.0))
    objective = float(c @ point.x + c_free @ point.free)
    primal = float(np.abs(rp).max(initial=0.0)) / scale_b
    dual = max(np.abs(rd).max(initial=0.0), np.abs(rf).max(initial=0.0)) / scale_c
    gap = abs(objective - float(right @ point.y)) / (1.0 + abs(objective))
    return _Missing((rp, rd, rf), objective, primal, max(primal, dual, gap))


class _Newton:
    """The normal equations of one matrix, factorised anew for every scaling."""

    def __init__(self, a: csr_array, a_free: Array, cones: Cones) -> None:
        self.a, self.a_t, self.a_free, self.cones = a, csr_array(a.T), a_free, cones
        self._order = sparse_order(a, cones.matrix())
        self._ordered = csr_array(a[self._order])
        self._ordered_t = csr_array(self._ordered.T)

    def factorise(self) -> None:
        """Prepare solutions for the cones' scaling."""
        normal = self._ordered @ (self.cones.matrix() @ self._ordered_t)
        diagonal = normal.diagonal()
        least = float(diagonal[diagonal > 0.0].min(initial=1.0))
        normal = normal + diags_array(REGULARISATION * np.maximum(diagonal, least))
        self._lu = _factor(normal, "NATURAL")
        if self.a_free.shape[1]:
            self._columns = np.column_stack([self._normal(col) for col in self.a_free.T])
            self._small = self.a_free.T @ self._columns

    def _normal(self, h: Array) -> Array:
        """Solve A W^2 A^T y = h."""
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

    def step(self, rp: Array, rd: Array, rf: Array, scaled: Array) -> _Step:
        """Newton's step for residuals, and ``scaled`` of W^-1 dx + W dz."""
        along = self.cones.scaled(scaled)
        dy, dx_free = self.solve(rp - self.a @ (along - self.cones.squared(rd)), rf)
        dz = rd - self.a_t @ dy
        return _Step(along - self.cones.squared(dz), dx_free, dy, dz)

    def refined(self, step: _Step, rp: Array, rf: Array) -> _Step:
        """The step with what it leaves of the rows solved for, as long as that grows less."""
        residual, free = self._residual(step, rp, rf)
        size = float(np.abs(residual).max(initial=0.0))
        for _ in range(MOST_REFINEMENTS):
            if size <= SMALL_RESIDUAL:
                break
            dy, dx_free = self.solve(residual, free)
            back = self.a_t @ dy
            finer = _Step(
                step.x + self.cones.squared(back), step.free + dx_free, step.y + dy, step.z - back
            )
            residual, free = self._residual(finer, rp, rf)
            before, size = size, float(np.abs(residual).max(initial=0.0))
            if not size < before:
                break
            step = finer
            if size > 0.5 * before:
                break
        return step

    def _residual(self, step: _Step, rp: Array, rf: Array) -> tuple[Array, Array]:
        rows = rp - self.a @ step.x - self.a_free @ step.free
        return rows, rf - self.a_free.T @ step.y


def sparse_order(a: csr_array, blocks: csr_array) -> IntArray:
    """The order of the rows of a that keeps the factor of a times ``blocks`` times a^T sparse."""
    filled = blocks.copy()
    filled.data[:] = 1.0
    pattern = abs(a) @ filled @ abs(a).T  # without cancellation
    pattern = pattern + diags_array(np.asarray(pattern.sum(axis=1)) + 1.0)
    order: IntArray = np.argsort(_factor(pattern, "MMD_AT_PLUS_A").perm_c)
    return order


def _factor(normal: csc_array, order: str) -> SuperLU:
    return splu(
        csc_matrix(normal),
        permc_spec=order,
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def _start(newton: _Newton, c: Array, c_free: Array, b: Array) -> _Point:
    """Mehrotra's starting point: least squares, pushed into the interior."""
    cones, e = newton.cones, newton.cones.unity
    newton.factorise()
    dy, free = newton.solve(b, np.zeros(len(c_free)))
    x = newton.a_t @ dy
    y, _ = newton.solve(newton.a @ c, c_free)
    z = c - newton.a_t @ y
    x = x + (max(-1.5 * cones.depth(x), 0.0) + 1e-3) * e
    z = z + (max(-1.5 * cones.depth(z), 0.0) + 1e-3) * e
    product = float(x @ z)
    x, z = x + 0.5 * product / (z @ e) * e, z + 0.5 * product / (x @ e) * e
    return _Point(x=x, free=free, y=y, z=z)


def _iterate(newton: _Newton, point: _Point, rp: Array, rd: Array, rf: Array) -> _Point:
    cones, x, z = newton.cones, point.x, point.z
    cones.scale(x, z)
    newton.factorise()
    middle = cones.scaled(z)
    square = cones.product(middle, middle)
    mu = float(x @ z) / cones.degree
    step = newton.step(rp, rd, rf, -middle)
    ap, ad = _reach(cones, point, step)
    after = float((x + ap * step.x) @ (z + ad * step.z)) / cones.degree
    target = (after / mu) ** 3 * mu
    both = cones.product(cones.scaled(step.x, inverse=True), cones.scaled(step.z))
    aim = target * cones.unity - square - both
    step = newton.step(rp, rd, rf, cones.quotient(middle, aim))
    step = _corrected(newton, point, step, middle, target)
    step = newton.refined(step, rp, rf)
    ap, ad = (min(1.0, STEP * share) for share in _reach(cones, point, step))
    return _Point(
        x=x + ap * step.x,
        free=point.free + ap * step.free,
        y=point.y + ad * step.y,
        z=z + ad * step.z,
    )


def _corrected(newton: _Newton, point: _Point, step: _Step, middle: Array, target: float) -> _Step:
    """Aim further than the step goes, and correct the products that fall out of line."""
    cones = newton.cones
    nothing = np.zeros_like(point.y), np.zeros_like(point.z), np.zeros_like(point.free)
    ap, ad = _reach(cones, point, step)
    for _ in range(MOST_CORRECTORS):
        wider_p, wider_d = min(1.0, 1.3 * ap + 0.1), min(1.0, 1.3 * ad + 0.1)
        product = cones.product(
            middle + wider_p * cones.scaled(step.x, inverse=True),
            middle + wider_d * cones.scaled(step.z),
        )
        missing = cones.towards(product, 0.1 * target, 10.0 * target)
        more = newton.step(*nothing, cones.quotient(middle, missing))
        tried = _Step(*(s + m for s, m in zip(step, more, strict=True)))
        tp, td = _reach(cones, point, tried)
        if (tp < ap + 0.01 and td < ad + 0.01) or tp + td < ap + ad:
            break
        step, ap, ad = tried, tp, td
    return step


def _reach(cones: Cones, point: _Point, step: _Step) -> tuple[float, float]:
    """Largest shares of the step, up to 1 / `STEP`, that keep x and z within the cones."""
    return cones.reach(point.x, step.x, 1.0 / STEP), cones.reach(point.z, step.z, 1.0 / STEP)
