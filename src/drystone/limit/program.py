"""The linear program of contact forces, solved by HiGHS.

    maximise s   subject to   B f + s q = r,   |t| <= k + m n,   n >= l

over the contact forces f = (n, t) and one factor s.  Limits k and l can be changed and the program
solved again from where it stood, which costs a few steps only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array, hstack, vstack

from drystone.common.arrays import Array, IntArray
from drystone.limit.equilibrium import Equilibrium

#: The finest tolerances that HiGHS takes.
TOLERANCE = 1e-10

#: Options of HiGHS.
OPTIONS: dict[str, Any] = {
    "output_flag": False,
    "threads": 1,
    "solver": "simplex",
    "presolve": "off",  # it would throw the last basis away
    "primal_feasibility_tolerance": TOLERANCE,
    "dual_feasibility_tolerance": TOLERANCE,
}

OPTIMAL, INFEASIBLE, UNBOUNDED, FAILED = "optimal", "infeasible", "unbounded", "failed"


def _silent_solver() -> Any:
    """HiGHS with its output off from the first on: from 1.16 it prints its name as it is made, by
    the first thing that it does then, into what may be read as JSON."""
    import highspy

    class Silent(highspy.Highs):
        def enableCallbacks(self) -> None:
            self.setOptionValue("output_flag", False)
            super().enableCallbacks()

    return Silent()


@dataclass(frozen=True, kw_only=True)
class Given:
    """What a program begins with, by the letters of the module's heading."""

    column: Array  # q, (n_rows,)
    right: Array  # r, (n_rows,)
    slope: Array  # m, (n_contacts,)
    least: Array  # l, (n_contacts,)
    largest: float = np.inf  # that s may be


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What came of one program."""

    status: str  # one of the four above
    factor: float  # s
    forces: Array  # (n_contacts, dim) in units of force
    velocity: Array  # (n_rows,) of the blocks, scaled: the dual values, with q.u = 1
    n_iterations: int


class ForceProgram:
    """One program; keeps its last basis."""

    def __init__(self, equilibrium: Equilibrium, given: Given) -> None:
        import highspy  # here, because most commands do without

        self._high = highspy
        n = equilibrium.n_contacts
        self._n_rows, self._n = len(given.right), n
        balance = hstack([equilibrium.matrix, csc_array(given.column[:, None])])
        matrix = csc_array(vstack([balance, hstack([_cone(given.slope), csc_array((2 * n, 1))])]))
        matrix.eliminate_zeros()
        matrix.sort_indices()
        infinity = highspy.kHighsInf
        lp = highspy.HighsLp()
        lp.num_row_, lp.num_col_ = matrix.shape
        lp.col_cost_ = np.concatenate((np.zeros(2 * n), [-1.0]))
        lower = np.full(2 * n + 1, -infinity)
        lower[: 2 * n : 2] = given.least
        lp.col_lower_ = lower
        lp.col_upper_ = np.concatenate((np.full(2 * n, infinity), [min(given.largest, infinity)]))
        lp.row_lower_ = np.concatenate((given.right, np.full(2 * n, -infinity)))
        lp.row_upper_ = np.concatenate((given.right, np.zeros(2 * n)))
        lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        lp.a_matrix_.start_ = matrix.indptr
        lp.a_matrix_.index_ = matrix.indices
        lp.a_matrix_.value_ = matrix.data
        self._solver = _silent_solver()
        for option, value in OPTIONS.items():
            self._solver.setOptionValue(option, value)
        self._solver.passModel(lp)

    def limit_shear(self, intercept: Array) -> None:
        """Set k, (n_contacts,)."""
        rows = np.arange(self._n_rows, self._n_rows + 2 * self._n, dtype=np.int32)
        lower = np.full(len(rows), -self._high.kHighsInf)
        self._solver.changeRowsBounds(len(rows), rows, lower, np.repeat(intercept, 2))

    def slide(self, contact: IntArray, way: Array, intercept: Array) -> None:
        """Fix contacts at their limit: t = way (k + m n), for ways (., 1) of 1 or -1, limits k."""
        rows = (self._n_rows + 2 * contact + (way[:, 0] < 0.0)).astype(np.int32)
        self._solver.changeRowsBounds(len(rows), rows, intercept, intercept)

    def fix_normal(self, contact: IntArray, normal: Array) -> None:
        """Set the normal forces of contacts."""
        self._solver.changeColsBounds(len(contact), (2 * contact).astype(np.int32), normal, normal)

    def aim(self, sense: float) -> None:
        """Maximise s for 1, minimise it for -1."""
        self._solver.changeColCost(2 * self._n, -sense)

    def bound_factor(self, least: float, largest: float) -> None:
        """Set the bounds of s."""
        self._solver.changeColBounds(2 * self._n, least, min(largest, self._high.kHighsInf))

    def solve(self) -> Answer:
        """Solve from the last basis, and once more from the beginning where that fails."""
        status = self._run()
        if status == FAILED:
            self._solver.clearSolver()
            status = self._run()
        solution = self._solver.getSolution()
        values = np.array(solution.col_value) if status == OPTIMAL else np.zeros(2 * self._n + 1)
        dual = np.array(solution.row_dual) if status == OPTIMAL else np.zeros(self._n_rows)
        return Answer(
            status=status,
            factor=float(values[-1]),
            forces=values[:-1].reshape(-1, 2),
            velocity=-dual[: self._n_rows],
            n_iterations=int(self._solver.getInfo().simplex_iteration_count),
        )

    def _run(self) -> str:
        self._solver.run()
        known = self._high.HighsModelStatus
        return {
            known.kOptimal: OPTIMAL,
            known.kInfeasible: INFEASIBLE,
            known.kUnbounded: UNBOUNDED,
            known.kUnboundedOrInfeasible: UNBOUNDED,
        }.get(self._solver.getModelStatus(), FAILED)


def _cone(slope: Array) -> coo_array:
    """Rows 2 k, t - m n, and 2 k + 1, -t - m n, of the limits on shear, over (n, t) by contact."""
    n = len(slope)
    normal, tangential = 2 * np.arange(n), 2 * np.arange(n) + 1
    return coo_array(
        (
            np.concatenate((np.ones(n), -np.ones(n), -slope, -slope)),
            (
                np.concatenate((normal, tangential, normal, tangential)),
                np.concatenate((tangential, tangential, normal, normal)),
            ),
        ),
        shape=(2 * n, 2 * n),
    )
