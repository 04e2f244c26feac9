"""How far a solution is from the equations of a step: the one measure that judges every solver."""

from __future__ import annotations

import numpy as np
from numba import njit

#: A bond holds beyond its strength by this share of it: what is at its limit has not broken.
BOND_TIE = 1e-6


@njit(cache=True)
def joint_law_violation(
    gap, slip, reaction, shear_before, normal_stiffness, shear_stiffness, friction, bond, tension
):
    """Largest distances [N] of reactions from those that the joint law gives.

    The law's reaction is r_n = k_n <-g> and r_t = clip(t_0 - k_s s, +-(mu r_n + bond)); a bond
    also pulls, r_n = -k_n g, up to its tensile strength.  For friction without shear stiffness,
    pass the reaction itself as ``shear_before`` and any positive stiffness: the distance is then
    zero only where the law holds (natural map).  Without a slip, what is left of it is the cone.

    Parameters
    ----------
    gap
        At the end of the step, less dilation, (n_contacts,) [m].
    slip
        Sliding distance in the step, (n_contacts,) [m].
    reaction
        (n_contacts, 2) [N], normal and tangential.
    shear_before
        (n_contacts,) [N], tangential reaction at the start of the step.
    normal_stiffness, shear_stiffness
        (n_contacts,) [N/m].
    friction
        (n_contacts,)
    bond, tension
        (n_contacts,) [N], cohesion and tensile strength of joints that still have them.

    Returns
    -------
    normal, tangential
        Of normal and of tangential reactions [N].
    cone
        Excess of tangential reactions over what friction and cohesion hold [N].
    """
    normal, tangential, cone = 0.0, 0.0, 0.0
    for c in range(gap.shape[0]):
        strength = bond[c] + tension[c]
        law_n = -normal_stiffness[c] * gap[c]
        if law_n < -tension[c] - BOND_TIE * strength or (law_n < 0.0 and strength == 0.0):
            law_n = 0.0
        limit = max(friction[c] * reaction[c, 0] + bond[c], 0.0)
        law_t = shear_before[c] - shear_stiffness[c] * slip[c]
        law_t = min(max(law_t, -limit), limit)
        normal = max(normal, abs(reaction[c, 0] - law_n))
        tangential = max(tangential, abs(reaction[c, 1] - law_t))
        cone = max(cone, abs(reaction[c, 1]) - limit)
        # Comparisons lose what is not a number.
        if not np.isfinite(law_n + law_t + reaction[c, 0] + reaction[c, 1]):
            return np.nan, np.nan, np.nan
    return normal, tangential, cone


@njit(cache=True)
def unbalanced_force(force, inertia, extent, fixed):
    """Largest force, or moment over block size, that is not balanced on a movable block [N].

    Not a number where a force is none.  ``force`` (n, 3) holds all forces on each block, contacts
    included; ``inertia`` (n, 3) the product of mass and acceleration; ``extent`` (n,) [m] the size
    by which moments are divided.
    """
    worst = 0.0
    for i in range(force.shape[0]):
        if fixed[i]:
            continue
        x = force[i, 0] - inertia[i, 0]
        y = force[i, 1] - inertia[i, 1]
        m = force[i, 2] - inertia[i, 2]
        size = max(np.sqrt(x * x + y * y), abs(m) / extent[i])
        if not np.isfinite(x + y + m):
            return np.nan
        worst = max(worst, size)
    return worst


@njit(cache=True)
def add_contact_forces(body_a, body_b, mapping, reaction, force):
    """Add H^T r to ``force`` (n, 3) on all bodies, fixed ones included."""
    for c in range(reaction.shape[0]):
        for d in range(3):
            force[body_a[c], d] += (
                mapping[c, 0, d] * reaction[c, 0] + mapping[c, 1, d] * reaction[c, 1]
            )
            force[body_b[c], d] += (
                mapping[c, 0, 3 + d] * reaction[c, 0] + mapping[c, 1, 3 + d] * reaction[c, 1]
            )


@njit(cache=True)
def mark_held(body_a, body_b, reaction, held):
    """Set ``held`` (n,) for bodies on which a contact acts."""
    for c in range(reaction.shape[0]):
        if reaction[c, 0] != 0.0 or reaction[c, 1] != 0.0:
            held[body_a[c]] = True
            held[body_b[c]] = True
