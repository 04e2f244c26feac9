"""The status of contacts in results: open, sticking or sliding."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import AT_CONE
from drystone.contact.contacts import LAW
from drystone.contact.forces import OPEN, SLIDING, STICKING
from drystone.law import branches
from drystone.law.columns import MU

#: Status by branch, (N_BRANCHES,).  Torn contacts count as open.
STATUS_OF = np.full(branches.N_BRANCHES, OPEN)
STATUS_OF[[branches.STICKING, branches.BONDED, branches.CRUSHED_STICKING]] = STICKING
STATUS_OF[[branches.FORWARD, branches.BACKWARD]] = SLIDING
STATUS_OF[[branches.CRUSHED_FORWARD, branches.CRUSHED_BACKWARD]] = SLIDING


@njit(cache=True, error_model="numpy")
def status_of(pairs, laws, reaction, status):
    """Fill the ``status`` (n_slots,) of slots, from their reactions (n_slots, dim) [N]."""
    pair, of_pair = pairs.of_slot, pairs.which
    for k in range(reaction.shape[0]):
        normal, square = reaction[k, 0], 0.0
        for d in range(1, reaction.shape[1]):
            square += reaction[k, d] * reaction[k, d]
        limit = laws[of_pair[pair[k], LAW], MU] * normal * (1.0 - AT_CONE)
        if normal <= 0.0:
            status[k] = OPEN
        else:
            status[k] = SLIDING if np.sqrt(square) >= limit else STICKING
