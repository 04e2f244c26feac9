"""The program of contact forces from inside: by the interior-point method, for any regions."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from drystone.common.arrays import Array
from drystone.limit.cones import Regions
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.program import FAILED, OPTIMAL, Answer

#: A load factor this near to one is one: it is 0 or 1 where joints have no cohesion.
WHOLE = 1e-6
#: Error that the interior-point method comes down to, and one that is still an answer.
TOLERANCE, ACCEPTABLE = 1e-10, 1e-7
#: Multipliers beyond this are taken for unbounded, and looked into.
GIVE_UP = 1e7


def from_inside(
    equilibrium: Equilibrium,
    regions: Regions,
    column: Array,
    right: Array,
    *,
    largest: float = np.inf,
) -> Answer | None:
    """Maximise s, at most ``largest``, with B f + s column = right and f within the regions.

    None where it does not come to an end: then there may be no s, or none may be too large.
    """
    from drystone.limit import interior_point  # takes long; small structures do without

    n_amounts, n_shared = regions.combination.shape[1], regions.sharing.shape[0]
    n_rows, scale = len(right), equilibrium.assembly.n_blocks
    matrix = hstack([equilibrium.matrix @ regions.combination, csc_array(column[:, None])])
    matrix = vstack([matrix, hstack([regions.sharing, csc_array((n_shared, 1))])])
    bound = np.concatenate((right - equilibrium.matrix @ regions.fixed, np.ones(n_shared)))
    cones = list(regions.cones)
    cost = np.zeros(n_amounts + 1)
    cost[n_amounts] = -scale  # velocities of the order of one: F.u is a sum over all blocks
    enough = None
    if largest < np.inf:  # one more row and column, s + rest = largest
        last = np.zeros((1, n_amounts + 2))
        last[0, n_amounts:] = 1.0
        matrix = vstack([hstack([matrix, csc_array((matrix.shape[0], 1))]), csc_array(last)])
        bound, cost = np.append(bound, largest), np.append(cost, 0.0)
        cones.append((1, 1))
        enough = -scale * largest * (1.0 - WHOLE)
    free = np.array([n_amounts])  # s fills all rows: it must not enter the normal equations
    found = interior_point.solve(
        cost,
        csc_array(matrix),
        bound,
        free,
        cones=cones,
        tolerance=TOLERANCE,
        enough=enough,
        give_up=GIVE_UP * scale,
    )
    if not found.converged and found.error > ACCEPTABLE:
        return None
    forces = regions.fixed + regions.combination @ found.x[:n_amounts]
    return Answer(
        status=OPTIMAL if np.isfinite(found.x).all() else FAILED,
        factor=float(found.x[n_amounts]),
        forces=forces.reshape(
            equilibrium.n_contacts, len(forces) // max(equilibrium.n_contacts, 1)
        ),
        velocity=-found.y[:n_rows] / scale,
        n_iterations=found.n_iterations,
    )
