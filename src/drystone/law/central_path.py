"""How far an iteration of an interior-point method goes, and by how much it reduces the barrier.

Both interior-point methods on the contacts of `law.cones` use it: that of a static step, and that
of the velocities of an implicit step.
"""

from __future__ import annotations

from drystone.common import tolerances
from drystone.common.arrays import Array
from drystone.law import cones


def step_length(
    table: Array, inner: Array, change: Array, radius: float = 0.0, slip_radius: float = 0.0
) -> float:
    """Length along the changes, at most 1, for which every contact stays near the central path.

    ``radius`` and ``slip_radius`` [J] are the barriers that set the size of the neighbourhood, for
    normal reactions and for the direction of slip.  Pairs may leave their cones if they can be
    projected back.
    """
    far, least = cones.length(table, inner, change, radius)
    while far > least and cones.slip_rotates_too_far(table, far, inner, change, slip_radius):
        far *= tolerances.LENGTH_SHORTER
    return float(max(far, least))


def reduction(table: Array, inner: Array, change: Array, far: float, energy: float) -> float:
    """Barrier to aim at, over the present one, after a predictor that reaches the length ``far``.

    ``energy`` [J] is the present mean energy of the contacts.
    """
    if not energy > 0.0:
        return 0.0
    left = min(cones.energy_at(table, far, inner, change) / energy, 1.0)
    return min(max(left**3, tolerances.LEAST_REDUCTION), tolerances.MOST_REDUCTION)
