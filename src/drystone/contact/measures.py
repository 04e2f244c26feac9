"""Sums over the blocks and contacts of a step, each in one pass; see `engines.measures`."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ARM_A,
    GAP,
    KIND,
    NONE,
    NORMAL,
    PART_A,
    PART_B,
    RATIO,
    VERTEX_B,
    A,
    B,
)


@njit(cache=True, error_model="numpy")
def sum_blocks(
    increment, acceleration, velocity, contact, touched, dead, pattern, mass, fixed, direction,
    multiplier,
):  # fmt: skip
    """Forces, works and energy of a step.

    Parameters
    ----------
    increment, acceleration, velocity
        (n, n_dof) [m, m/s2, m/s; rad, rad/s2, rad/s].
    contact, dead, pattern
        Forces, (n, n_dof) [N, N m]; the pattern is that at multiplier one.
    touched
        (n,) whether a contact acts on the block.
    mass
        (n, n_dof) [kg, kg m2].
    fixed
        (n,) supports.
    direction
        (dim,) of the load.

    Returns
    -------
    carried
        Force of the blocks on the supports along the load, less the dead load [N].
    inertia
        Sum of the absolute values of all inertia forces [N].
    fastest
        Largest acceleration of a centroid [m/s2].
    kinetic, work
        Kinetic energy; absolute value of the work of all loads [J].
    push, strokes, resistance
        Of the blocks on which contacts act: work of the pattern at multiplier one; sum of the
        absolute values of its parts; work of the inertia forces [J].
    free_strokes
        The same as ``strokes``, of the blocks on which no contact acts [J].
    """
    n, n_dof = increment.shape
    dim = direction.shape[0]
    carried, inertia, fastest = 0.0, 0.0, 0.0
    kinetic, work = 0.0, 0.0
    push, strokes, resistance, free_strokes = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        force, square = 0.0, 0.0
        for d in range(dim):
            if fixed[i]:
                carried += contact[i, d] * direction[d]
            carried -= dead[i, d] * direction[d]
            force += (mass[i, d] * acceleration[i, d]) ** 2
            square += acceleration[i, d] ** 2
        inertia += np.sqrt(force)
        fastest = max(fastest, square)
        for d in range(n_dof):
            kinetic += 0.5 * mass[i, d] * velocity[i, d] ** 2
            work += (dead[i, d] + multiplier * pattern[i, d]) * increment[i, d]
        for d in range(n_dof):
            stroke = pattern[i, d] * increment[i, d]
            if not touched[i]:
                free_strokes += abs(stroke)
                continue
            push += stroke
            strokes += abs(stroke)
            resistance += mass[i, d] * acceleration[i, d] * increment[i, d]
    fastest, work = np.sqrt(fastest), abs(work)
    return carried, inertia, fastest, kinetic, work, push, strokes, resistance, free_strokes


@njit(cache=True, error_model="numpy")
def count_contacts(slots, status, counts):
    """Count the contacts of each status into ``counts`` (3,); returns the deepest overlap [m]."""
    which, value = slots
    counts[:] = 0
    deepest = 0.0
    for k in range(which.shape[0]):
        deepest = max(deepest, -value[k, GAP])
        if which[k, KIND] != NONE:
            counts[status[k]] += 1
    return deepest


@njit(cache=True, error_model="numpy")
def contact_points(slots, pairs, centroid, radius, pose, used, position):
    """Fill ``position`` (n_contacts, 2) [m] of the slots ``used`` (n_contacts,), in the plane, for
    poses (n, 3).

    At these points, reactions along normal and tangent have the moments on both bodies that the
    gradients of gap and slip give.
    """
    (which, value), pair, of_pair = slots, pairs.of_slot, pairs.which
    for row in range(used.shape[0]):
        k = used[row]
        p = pair[k]
        a = of_pair[p, A]
        on_b = which[k, KIND] == VERTEX_B
        # Between two rounded corners that press each other, the point divides the distance of their
        # centres in proportion to the radii.
        reach = radius[of_pair[p, PART_A]] / value[k, RATIO]
        if on_b:
            reach = -radius[of_pair[p, PART_B]]
        for d in range(2):
            place = centroid[a, d] + pose[a, d] + value[k, ARM_A + d]
            position[row, d] = place + reach * value[k, NORMAL + d]


@njit(cache=True, error_model="numpy")
def mark_loose(pairs, slots, reaction, fixed, part):
    """Whether there is a body that is connected to no ``fixed`` body (n,), directly or through
    others.

    Bodies are connected if a contact between them is closed or carries.  ``part`` (n,) is filled:
    for each body the first body of its connected part.
    """
    pair, of_pair, (which, value) = pairs.of_slot, pairs.which, slots
    n = fixed.shape[0]
    for i in range(n):
        part[i] = i
    for k in range(which.shape[0]):
        if which[k, KIND] == NONE or not (value[k, GAP] <= 0.0 or reaction[k, 0] != 0.0):
            continue
        a, b = of_pair[pair[k], A], of_pair[pair[k], B]
        while part[a] != a:
            part[a] = part[part[a]]
            a = part[a]
        while part[b] != b:
            part[b] = part[part[b]]
            b = part[b]
        part[max(a, b)] = min(a, b)
    attached = np.zeros(n, np.bool_)
    for i in range(n):
        part[i] = part[part[i]]  # the first body of the part, which has the smallest number
        attached[part[i]] |= fixed[i]
    loose = False
    for i in range(n):
        loose |= not attached[part[i]]
    return loose


@njit(cache=True, error_model="numpy")
def left_behind(source, shear):
    """Sum of the sizes of those tangential reactions ``shear`` (n, dim - 1) [N] that no slot
    inherits.

    ``source`` (m,) is the row of ``shear`` that each slot inherits, or -1.
    """
    persists = np.zeros(shear.shape[0], np.bool_)
    for k in range(source.shape[0]):
        if source[k] >= 0:
            persists[source[k]] = True
    total = 0.0
    for j in range(shear.shape[0]):
        if not persists[j]:
            square = 0.0
            for d in range(shear.shape[1]):
                square += shear[j, d] * shear[j, d]
            total += np.sqrt(square)
    return total
