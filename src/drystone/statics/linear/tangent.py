"""Matrices of bodies and of pairs of them, in blocks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Tangent(NamedTuple):
    """Block form of the stiffness matrix: diagonal blocks, and both of every pair."""

    diagonal: Array  # (n, n_dof, n_dof)
    upper: Array  # (n_pairs, n_dof, n_dof) rows of a, columns of b
    lower: Array  # (n_pairs, n_dof, n_dof) rows of b, columns of a

    @classmethod
    def zeros(cls, n: int, n_pairs: int, n_dof: int) -> Tangent:
        """That of nothing."""
        return cls(*(np.zeros((count, n_dof, n_dof)) for count in (n, n_pairs, n_pairs)))
