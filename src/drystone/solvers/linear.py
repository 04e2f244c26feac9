"""Linear systems whose matrix is made of blocks: one per body and two per pair of bodies.

Small systems go to LAPACK as dense ones, which is faster there; larger ones to SuperLU, with
scipy already a dependency.  The fill-reducing order is found once per pattern.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

from drystone.kernels.forces import Tangent
from drystone.kernels.step import fill_dense

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Solve = Callable[[Array], Array]

#: Number of unknowns up to which a dense factorisation is the faster one (measured, one core).
DENSE_LIMIT = 150


class SingularMatrixError(ArithmeticError):
    """The tangent has no inverse: a block or a part of the assembly is free to move."""


class BlockSystem:
    """Solves with the tangent of one list of pairs; fixed bodies are left out.

    Parameters
    ----------
    a, b
        Bodies of each pair, (n_pairs,).
    fixed
        (n,) bodies that do not move.
    n_dof
        Degrees of freedom of a body.
    """

    def __init__(self, a: IntArray, b: IntArray, fixed: NDArray[np.bool_], n_dof: int = 3) -> None:
        self.n_pairs, self.a, self.b = len(a), a, b
        self.movable = np.flatnonzero(~fixed)
        row = self._row = np.full(len(fixed), -1, np.int64)
        row[self.movable] = np.arange(len(self.movable))
        self.both = np.flatnonzero(~fixed[a] & ~fixed[b])
        ra, rb, rd = row[a[self.both]], row[b[self.both]], np.arange(len(self.movable))
        i, j = np.meshgrid(np.arange(n_dof), np.arange(n_dof), indexing="ij")

        def entries(block_row: IntArray, block_column: IntArray) -> tuple[IntArray, IntArray]:
            return (
                (n_dof * block_row[:, None, None] + i).ravel(),
                (n_dof * block_column[:, None, None] + j).ravel(),
            )

        parts = [entries(rd, rd), entries(ra, rb), entries(rb, ra)]
        rows = np.concatenate([p[0] for p in parts])
        columns = np.concatenate([p[1] for p in parts])
        self.size = n_dof * len(self.movable)
        self.dense = self.size <= DENSE_LIMIT
        if self.dense:
            self._matrix = np.zeros((self.size, self.size), order="F")
        else:
            self._order(rows, columns)

    def _order(self, rows: IntArray, columns: IntArray) -> None:
        pattern = coo_matrix((np.ones(len(rows)), (rows, columns)), (self.size, self.size))
        # A diagonally dominant matrix of the same pattern, only to have its order.
        dominant = pattern.tocsc()
        dominant.setdiag(10.0 * len(rows))
        order = splu(
            dominant, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
        ).perm_c  # unknown i becomes unknown order[i]
        self._position = order
        numbered = coo_matrix(
            (np.arange(1, len(rows) + 1), (order[rows], order[columns])), (self.size, self.size)
        ).tocsc()
        self._place = numbered.data - 1
        self._indices = numbered.indices.astype(np.int32)
        self._indptr = numbered.indptr.astype(np.int32)

    def gather(self, field: Array) -> Array:
        """Rows of the movable bodies of an (n, n_dof) field as one vector, (size,)."""
        return field[self.movable].ravel()

    def scatter(self, vector: Array, out: Array) -> None:
        """The inverse of `gather`, into an (n, n_dof) field."""
        out[self.movable] = vector.reshape(len(self.movable), -1)

    def factor(self, tangent: Tangent) -> Solve:
        """Factorise; the result solves for right-hand sides (size,) or (size, k) until the next
        factorisation, which may reuse its memory.

        Raises `SingularMatrixError`.
        """
        if self.dense:
            fill_dense(*tangent, self._row, self.a, self.b, self._matrix)
            lu, pivots, info = lapack.dgetrf(self._matrix, overwrite_a=1)
            if info != 0:
                raise SingularMatrixError
            return lambda rhs: lapack.dgetrs(lu, pivots, rhs)[0]
        values = np.concatenate(
            (
                tangent.diagonal[self.movable].ravel(),
                tangent.upper[self.both].ravel(),
                tangent.lower[self.both].ravel(),
            )
        )
        matrix = csc_matrix((values[self._place], self._indices, self._indptr), copy=False)
        try:
            factors = splu(
                matrix,
                permc_spec="NATURAL",
                diag_pivot_thresh=0.01,
                options={"SymmetricMode": True},
            )
        except RuntimeError:
            raise SingularMatrixError from None

        def solve(rhs: Array) -> Array:
            permuted = np.empty_like(rhs)
            permuted[self._position] = rhs
            return factors.solve(permuted)[self._position]

        return solve
