"""Contacts as arrays that every kernel takes: candidate pairs, and what is found between them.

A pair of blocks owns a number of slots, one for each contact point that it may have at a time; a
slot knows its pair, so that how many of them a pair has is nobody else's business.  What solvers
work on are the slots in use, packed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: What meets in a slot: nothing, a vertex of b and an edge of a, the reverse, two vertices.
NONE, VERTEX_B, VERTEX_A, VERTICES = 0, 1, 2, 3


class Pairs(NamedTuple):
    """Candidate pairs, each with its joint law and its slots, and where they were made.

    A pair is one of convex parts; blocks of several may meet in several pairs.  Pair p owns the
    slots from ``first[p]`` to ``first[p + 1]``.
    """

    a: IntArray  # (n_pairs,) blocks
    b: IntArray  # (n_pairs,)
    part_a: IntArray  # (n_pairs,) their parts that are near
    part_b: IntArray  # (n_pairs,)
    law: IntArray  # (n_pairs,) index into `Assembly.laws`
    first: IntArray  # (n_pairs + 1,)
    pose: Array  # (n, n_dof) poses they were found in

    @property
    def n_slots(self) -> int:
        """Number of slots of all pairs."""
        return int(self.first[-1])


class Slots(NamedTuple):
    """Contacts of all candidate pairs; see `kernels.narrow`."""

    pair: IntArray  # (n_slots,)
    kind: IntArray  # (n_slots,)
    feature: IntArray  # (n_slots, 2) vertex or edge (by its first vertex) of a and of b
    edges: IntArray  # (n_slots, 2) the facing edges of a and of b
    gap: Array  # (n_slots,) m, positive open
    normal: Array  # (n_slots, dim) from a to b
    arm_a: Array  # (n_slots, dim) m
    arm_b: Array  # (n_slots, dim) m
    roll: Array  # (n_slots, 2) m, roll_a and roll_b
    ratio: Array  # (n_slots,)
    length: Array  # (n_slots,) m, tributary length of joint


#: Columns of the table of packed contacts: k_n, k_s [N/m], mu, k_n tan psi [N/m], c A, f_t A [N],
#: trial reactions [N], and what sliding that has ended within the step adds to them [N], with its
#: length [m].
STIFF_N, STIFF_T, FRICTION, LIFT, BOND, TENSILE = 0, 1, 2, 3, 4, 5
TRIAL_N, TRIAL_T, ADD_N, ADD_T, PLASTIC = 6, 7, 8, 9, 10
N_TABLE = 11


class Contacts(NamedTuple):
    """Contacts in use, packed: each row of the arrays is one, the first ``count`` of n are filled.

    Reactions act along the gradients of gap and slip; slip may be measured by other gradients.
    """

    slot: IntArray  # (n,)
    pair: IntArray  # (n,)
    body_a: IntArray  # (n,)
    body_b: IntArray  # (n,)
    rows: Array  # (n, dim, 2 n_dof) gradients of gap and slip by the motions of both bodies
    measured: Array  # (n, dim - 1, 2 n_dof)
    table: Array  # (n, N_TABLE)

    @classmethod
    def empty(cls, n: int, dim: int, n_dof: int) -> Contacts:
        """Memory for a number of contacts."""
        slot, pair, body_a, body_b = (np.zeros(n, np.int64) for _ in range(4))
        return cls(
            slot=slot,
            pair=pair,
            body_a=body_a,
            body_b=body_b,
            rows=np.zeros((n, dim, 2 * n_dof)),
            measured=np.zeros((n, dim - 1, 2 * n_dof)),
            table=np.zeros((n, N_TABLE)),
        )

    def of(self, rows: IntArray | slice) -> Contacts:
        """Some of them: views where ``rows`` is a slice, else copies."""
        return Contacts._make(array[rows] for array in self)
