"""The program of contact forces with round friction cones, solved by Clarabel.

    maximise s   subject to   B f + s q = r,   |t| <= k + m n,   n >= l

over the contact forces f = (n, t) and one factor s, as `program` has it; with one tangential
component the cones are the inequalities of a linear program.  Nothing is kept from one solution to
the next: the method goes through the interior.

What the solver takes for a solution depends on the units of what it is given.  Walls of thousands
of blocks came out 1e-4 too low while it called them solved: with the dual condition F.u = 1
velocities are of the order of one over the number of blocks, and its tolerance on them means
nothing.  The objective is therefore multiplied by the number of blocks, and forces are measured in
what blocks high up press on those below.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array, csc_matrix, hstack, vstack

from drystone.common.arrays import Array, IntArray
from drystone.geometry.motion import beside
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.program import (
    FAILED,
    INFEASIBLE,
    OPTIMAL,
    UNBOUNDED,
    Answer,
    ForceProgram,
    Given,
)

#: Of Clarabel, by its names, one set after another until one answers.  Regularisation of the
#: default, 1e-8, is felt in the last digits.
OPTIONS: tuple[dict[str, Any], ...] = (
    {"static_regularization_constant": 1e-9, "dynamic_regularization_delta": 1e-8},
    {},
    {"equilibrate_enable": False, "max_step_fraction": 0.95},
)
#: Options that all sets have.
COMMON: dict[str, Any] = {
    "verbose": False,
    "max_threads": 1,
    "direct_solve_method": "qdldl",
    "max_iter": 120,
}
#: On infeasibilities and gap, relative to numbers of order one.
TOLERANCE = 1e-11
#: Angle by which friction may deviate from the direction of slip.  It is then greater than its
#: limit by half of the square.
ASIDE = 1e-4
#: The same errors as calculated here: at once accepted; accepted if no other options give a better
#: answer.  The status that the solver tells does not count.
GOOD, ACCEPTABLE = 1e-8, 1e-7


class ConeProgram:
    """One program in any dimension."""

    def __init__(self, equilibrium: Equilibrium, given: Given) -> None:
        n = equilibrium.n_contacts
        self._n, self._dim = n, equilibrium.points.dimension
        self._balance = csc_array(hstack([equilibrium.matrix, csc_array(given.column[:, None])]))
        self._right, self._slope, self._least = given.right, given.slope, given.least
        self._intercept = np.zeros(n)
        self._bounds = (-np.inf, given.largest)
        self._sense = 1.0
        self._way = np.zeros((n, self._dim - 1))  # unit vectors of contacts held at their limit
        self._normal = np.full(n, np.nan)  # of contacts whose normal force is given
        # Blocks high up press on those below: forces are larger than weights.
        self._n_blocks = equilibrium.assembly.n_blocks
        self._force = max(1.0, np.sqrt(self._n_blocks))
        self._scale = self._n_blocks * self._force

    def limit_shear(self, intercept: Array) -> None:
        """Set k, (n_contacts,)."""
        self._intercept = intercept

    def slide(self, contact: IntArray, way: Array, intercept: Array) -> None:
        """Fix contacts at their limit: t = way (k + m n), for unit vectors ``way`` (., dim - 1).

        In space t may deviate from them by `ASIDE`: they are as precise as velocities are.
        """
        self._way[contact] = way
        self._intercept = self._intercept.copy()
        self._intercept[contact] = intercept

    def fix_normal(self, contact: IntArray, normal: Array) -> None:
        """Set the normal forces of contacts."""
        self._normal[contact] = normal

    def aim(self, sense: float) -> None:
        """Maximise s for 1, minimise it for -1."""
        self._sense = sense

    def bound_factor(self, least: float, largest: float) -> None:
        """Set the bounds of s."""
        self._bounds = (least, largest)

    def solve(self) -> Answer:
        """Solve from the beginning."""
        equal, equal_right = self._equalities()
        above, above_least = self._inequalities()
        cone, cone_right, cones = self._cones()
        matrix = vstack([equal, above, cone])
        right = np.concatenate((equal_right, above_least, cone_right))
        cost = np.zeros(matrix.shape[1])
        cost[-1] = -self._sense * self._scale
        kinds = [(len(equal_right), "zero"), (len(above_least), "nonnegative"), *cones]
        return self._answer(*minimise(cost, csc_matrix(matrix), right, kinds))

    def _answer(self, status: str, x: Array, z: Array, n_iterations: int) -> Answer:
        return Answer(
            status=status,
            factor=float(x[-1]),
            forces=(self._force * x[:-1]).reshape(self._n, self._dim),
            velocity=z[: len(self._right)] / self._scale * self._sense,
            n_iterations=n_iterations,
        )

    def _columns(self, contact: IntArray, component: int, values: Array) -> csc_array:
        """Rows, one to each of the contacts, with a value in the column of a component."""
        row = np.arange(len(contact))
        shape = (len(contact), self._n * self._dim + 1)
        return csc_array((values, (row, self._dim * contact + component)), shape=shape)

    def _equalities(self) -> tuple[csc_array, Array]:
        """Balance; contacts that are fixed."""
        scale = np.full(self._balance.shape[1], self._force)
        scale[-1] = 1.0
        rows, right = [csc_array(self._balance * scale[None, :])], [self._right]
        slides = np.flatnonzero(np.any(self._way != 0.0, axis=1))
        row = self._columns(slides, 0, -self._slope[slides])
        for k in range(self._dim - 1):
            row = row + self._columns(slides, 1 + k, self._way[slides, k])
        rows.append(csc_array(row))
        right.append(self._intercept[slides] / self._force)
        fixed = np.flatnonzero(~np.isnan(self._normal))
        rows.append(self._columns(fixed, 0, np.ones(len(fixed))))
        right.append(self._normal[fixed] / self._force)
        return csc_array(vstack(rows)), np.concatenate(right)

    def _inequalities(self) -> tuple[csc_array, Array]:
        """Least normal forces where the cone alone leaves more, and bounds of s."""
        free = np.isnan(self._normal)
        slides = np.any(self._way != 0.0, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            tip = np.where(self._slope > 0.0, -self._intercept / self._slope, -np.inf)
        needed = np.flatnonzero(free & (slides | (tip < self._least)))
        rows = [self._columns(needed, 0, -np.ones(len(needed)))]
        right = [-np.maximum(self._least, tip)[needed] / self._force]
        aside = np.flatnonzero(slides)
        for sign, across in product((-1.0, 1.0), beside(self._way[aside])):
            row = self._columns(aside, 0, -ASIDE * self._slope[aside])
            for k in range(self._dim - 1):
                row = row + self._columns(aside, 1 + k, sign * across[:, k])
            rows.append(csc_array(row))
            right.append(ASIDE * self._intercept[aside] / self._force)
        for bound, sign in zip(self._bounds, (-1.0, 1.0), strict=True):
            if np.isfinite(bound):
                row = coo_array(([sign], ([0], [self._n * self._dim])), shape=(1, rows[0].shape[1]))
                rows.append(csc_array(row))
                right.append(np.array([sign * bound]))
        return csc_array(vstack(rows)), np.concatenate(right)

    def _cones(self) -> tuple[csc_array, Array, list[tuple[int, str]]]:
        """(k + m n, t) of the contacts that are not fixed at their limit."""
        contact = np.flatnonzero(np.all(self._way == 0.0, axis=1))
        rows = [self._columns(contact, 0, -self._slope[contact])]
        rows += [
            self._columns(contact, 1 + k, -np.ones(len(contact))) for k in range(self._dim - 1)
        ]
        order = np.arange(len(contact) * self._dim).reshape(self._dim, -1).T.ravel()
        right = np.zeros((len(contact), self._dim))
        right[:, 0] = self._intercept[contact] / self._force
        matrix = vstack(rows).tocsr()[order]
        return csc_array(matrix), right.ravel(), [(self._dim, "cone")] * len(contact)


def force_program(equilibrium: Equilibrium, given: Given) -> ForceProgram | ConeProgram:
    """The program of the structure's dimension, linear in the plane."""
    kind = ForceProgram if equilibrium.points.dimension == 2 else ConeProgram
    return kind(equilibrium, given)


def minimise(
    cost: Array,
    matrix: csc_matrix,
    right: Array,
    cones: list[tuple[int, str]],
) -> tuple[str, Array, Array, int]:
    """Minimise c.x with b - A x in a product of cones.

    Parameters
    ----------
    cost, matrix, right
        c (n,), A (m, n), b (m,).
    cones
        Rows of each cone and its kind: "zero", "nonnegative", "cone" (its first component is no
        less than the length of the others).

    Returns
    -------
    status, x, z, iterations
        One of the words of `program`; solution (n,); dual values (m,).
    """
    import clarabel  # here, because most commands do without

    kinds = {
        "zero": clarabel.ZeroConeT,
        "nonnegative": clarabel.NonnegativeConeT,
        "cone": clarabel.SecondOrderConeT,
    }
    listed = [kinds[kind](size) for size, kind in cones if size]
    known = clarabel.SolverStatus
    words = {
        known.PrimalInfeasible: INFEASIBLE,
        known.DualInfeasible: UNBOUNDED,
        known.AlmostPrimalInfeasible: INFEASIBLE,
        known.AlmostDualInfeasible: UNBOUNDED,
    }
    none = csc_matrix((len(cost), len(cost)))
    best, best_error, n_iterations = (np.zeros(len(cost)), np.zeros(len(right))), np.inf, 0
    for options in OPTIONS:
        settings = clarabel.DefaultSettings()
        for name in ("tol_feas", "tol_gap_abs", "tol_gap_rel"):
            setattr(settings, name, TOLERANCE)
        for name, value in {**COMMON, **options}.items():
            setattr(settings, name, value)
        found = clarabel.DefaultSolver(none, cost, matrix, right, listed, settings).solve()
        n_iterations += found.iterations
        x, z = np.array(found.x), np.array(found.z)
        if found.status in words:
            return words[found.status], x, z, n_iterations
        error = _error(cost, matrix, right, x, z, np.array(found.s))
        if error < best_error:
            best, best_error = (x, z), error
        if error <= GOOD:
            break
    return OPTIMAL if best_error <= ACCEPTABLE else FAILED, *best, n_iterations


def _error(
    cost: Array, matrix: csc_matrix, right: Array, x: Array, z: Array, slack: Array
) -> float:
    """Largest of relative infeasibilities and relative gap."""
    if not (np.isfinite(x).all() and np.isfinite(z).all()):
        return np.inf
    primal = np.abs(matrix @ x + slack - right).max() / (1.0 + np.abs(x).max())
    dual = np.abs(matrix.T @ z + cost).max() / (1.0 + np.abs(z).max())
    gap = abs(cost @ x + right @ z) / (1.0 + abs(cost @ x))
    return float(max(primal, dual, gap))
