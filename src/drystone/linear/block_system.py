"""The linear system of implicit steps: blocks of bodies and of pairs in contact."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.linear import numeric as lu_numeric
from drystone.linear import symbolic as lu_symbolic
from drystone.linear.symbolic import Tangent


class SingularMatrixError(ArithmeticError):
    """The tangent has no inverse."""


class BlockSystem:
    """Solves for the velocities of blocks in contact, for one list of pairs.

    ``a`` and ``b`` (n_pairs,) are the bodies of each pair.  ``mass`` (n, n_dof) [kg, kg m2] is zero
    on ``fixed`` bodies (n,).  ``place`` (n, dim) [m] are approximate places of the bodies, which
    only determine the order of elimination.
    """

    def __init__(
        self, a: IntArray, b: IntArray, mass: Array, fixed: BoolArray, place: Array
    ) -> None:
        n, n_dof = mass.shape
        self.a, self.b, self.mass, self.fixed = a, b, mass, fixed
        self.unheld = np.zeros(n)
        self.tangent = Tangent.zeros(n, len(a), n_dof)  # kg
        self.structure = lu_symbolic.analyse(a, b, fixed, place, n_dof)
        self.factors = lu_numeric.allocate(self.structure)

    def begin(self) -> Tangent:
        """The blocks of the matrix [kg], with nothing in them but the mass of the bodies."""
        for blocks in self.tangent:
            blocks[:] = 0.0
        np.einsum("kii->ki", self.tangent.diagonal)[:] = self.mass
        return self.tangent

    def solve(self, momenta: Array) -> Array:
        """Velocities (n, n_dof) for momenta (n, n_dof) that are zero on fixed bodies.

        Rows are exchanged only inside blocks.  If contacts stick by a stiff penalty beside others
        that slide, this leaves errors a thousand times those of rounding.  So the solution is
        corrected once by solving for its residual.

        Raises `SingularMatrixError`.
        """
        self.factorise()
        return self.solve_again(momenta)

    def factorise(self) -> None:
        """Factorise the matrix for `solve_again`; raises `SingularMatrixError`."""
        structure, factors = self.structure, self.factors
        pivot = lu_numeric.factorise(structure, *self.tangent, factors, self.mass, self.unheld, 0.0)
        if pivot == 0.0:
            raise SingularMatrixError

    def solve_again(self, momenta: Array) -> Array:
        """`solve` with the factors of the last factorisation."""
        structure, factors = self.structure, self.factors
        velocity, left = momenta[None].copy(), momenta[None].copy()
        lu_numeric.solve(structure, factors, velocity)
        lu_numeric.residual(structure, self.a, self.b, self.fixed, *self.tangent, velocity, left)
        lu_numeric.solve(structure, factors, left)
        corrected: Array = velocity[0] + left[0]
        return corrected
