"""Gradients of gap and slip as rows of a matrix, with one column for each motion of both bodies.

`contact.plane.rows` and `contact.space.rows` fill these rows.  The functions here use them in both
dimensions.
"""

from __future__ import annotations

from drystone.common.compiled import njit
from drystone.contact.contacts import BODY_A, BODY_B

#: For functions of both dimensions: tuples as long as a body has degrees of freedom.  The length of
#: a tuple is known to the compiler, so that loops over it are unrolled.
IN_PLANE, IN_SPACE = (0,) * 3, (0,) * 6

#: Rows of a contact in the plane: gradient of the gap, gradient of the slip, gradient by which slip
#: is measured.  In space there are two rows for each slip, so that rows 0, 1 and 2 are the gap and
#: both slips.
OF_GAP, OF_SLIP, MEASURED = 0, 1, 2


def dof_of(field):
    """`IN_PLANE` or `IN_SPACE` for a field (n, n_dof)."""
    return IN_PLANE if field.shape[1] == len(IN_PLANE) else IN_SPACE


@njit(cache=True, error_model="numpy")
def add_reaction(dof, rows, c, reaction, k, a, b, force):
    """Add the forces of contact c on its bodies a and b to ``force`` (n, n_dof), from row k of
    ``reaction`` (n, dim or more) [N]; ``dof`` is `IN_PLANE` or `IN_SPACE`.
    """
    nd = len(dof)
    rn, rt = reaction[k, 0], reaction[k, 1]
    for i in range(nd):
        on_a = rn * rows[c, OF_GAP, i] + rt * rows[c, OF_SLIP, i]
        on_b = rn * rows[c, OF_GAP, nd + i] + rt * rows[c, OF_SLIP, nd + i]
        if nd == 6:
            on_a += reaction[k, 2] * rows[c, OF_SLIP + 1, i]
            on_b += reaction[k, 2] * rows[c, OF_SLIP + 1, nd + i]
        force[a, i] += on_a
        force[b, i] += on_b


@njit(cache=True, error_model="numpy")
def along(dof, rows, c, row, field, a, b):
    """Scalar product of a row of contact c with the motion or velocity ``field`` (n, n_dof) of its
    bodies a and b."""
    nd = len(dof)
    total = 0.0
    for i in range(nd):
        total += rows[c, row, i] * field[a, i] + rows[c, row, nd + i] * field[b, i]
    return total


@njit(cache=True, error_model="numpy")
def add_block(dof, block, a, b, pair, diagonal, upper, lower):
    """Add the block (2 n_dof, 2 n_dof) of a contact of a ``pair``, by the motions of both bodies a
    and b, to the blocks of a matrix."""
    nd = len(dof)
    for i in range(nd):
        for j in range(nd):
            diagonal[a, i, j] += block[i, j]
            diagonal[b, i, j] += block[nd + i, nd + j]
            upper[pair, i, j] += block[i, nd + j]
            lower[pair, i, j] += block[nd + i, j]


@njit(cache=True)
def contact_velocities(dof, contacts, velocity, out):
    """Fill ``out`` (n_contacts, dim) [m/s] with the relative velocities H v, normal and tangential,
    for the velocities (n, n_dof) of the bodies."""
    nd = len(dof)
    which, rows = contacts.which, contacts.rows
    for c in range(rows.shape[0]):
        a = which[c, BODY_A]
        b = which[c, BODY_B]
        for i in range(out.shape[1]):
            u = 0.0
            for d in range(nd):
                u += rows[c, i, d] * velocity[a, d]
                u += rows[c, i, nd + d] * velocity[b, d]
            out[c, i] = u
