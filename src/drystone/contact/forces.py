"""The contacts of one state, as results: what is drawn, written and judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

OPEN, STICKING, SLIDING = 0, 1, 2


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactForces:
    """One row per contact point that is near enough to be watched.

    The normal points from block ``a`` to block ``b``; the reaction acts on ``b``.
    """

    block_a: IntArray  # (n_contacts,) row in the assembly
    block_b: IntArray  # (n_contacts,)
    position: Array  # (n_contacts, dim) m
    normal: Array  # (n_contacts, dim)
    gap: Array  # (n_contacts,) m, positive open
    area: Array  # (n_contacts,) m2, tributary
    normal_reaction: Array  # (n_contacts,) N, compression positive
    tangential_reaction: Array  # (n_contacts, dim - 1) N, along the normal turned clockwise
    status: IntArray  # (n_contacts,) OPEN, STICKING or SLIDING

    @property
    def n_contacts(self) -> int:
        """Number of contact points, open ones included."""
        return len(self.gap)

    def vectors(self) -> Array:
        """Reaction on block ``b`` as vectors, (n_contacts, dim) [N]."""
        tangent = np.column_stack((self.normal[:, 1], -self.normal[:, 0]))
        return self.normal_reaction[:, None] * self.normal + self.tangential_reaction * tangent
