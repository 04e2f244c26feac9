"""One linear step, followed from one contact's change to the next.

With constant gradients the unbalanced forces R are piecewise linear in the increments x and the
multiplier l: one piece for every choice of branches of the joint law.  The path moves the unknowns
so that all unbalanced forces shrink together,

    R(x, l) = (1 - t) R_0,    g . (x - x_0) = t lag_0,    t from 0 to 1

along straight lines with a kink where a contact leaves its branch.  There the matrix changes by
u v^T only, so that the new direction takes one more solution with the factors of the first matrix
(Sherman-Morrison).  Where 1 + v . K^-1 u is negative the path has a fold: t decreases until the
next fold.  A path that falls below its start has no solution ahead of it (Katzenelson 1965).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.common.compiled import njit
from drystone.common.tolerances import BELOW_START, SLOW, SLOW_BACK
from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    FRICTION,
    INTERCEPT,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
)
from drystone.contact.plane.rows import along
from drystone.contact.rows import MEASURED, OF_GAP
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING, across_joint, both, sense
from drystone.law.limits import limited_normal
from drystone.law.pieces import all_dry, change, distance, distance_of_dry
from drystone.law.plane import commit
from drystone.statics.balance import solve_bordered
from drystone.statics.linear.numeric import solve

#: How a path ends: at its target; at a fold before it; at a change after which the matrix must be
#: factorised anew; after too many changes; where the matrix is singular; where it starts, with
#: more changes ahead than are worth following.
DONE, FOLDED, RENEW, LOST, SINGULAR, MANY = 0, 1, 2, 3, 4, 5

Array = NDArray[np.float64]


class BorderedPath(NamedTuple):
    """What borders the matrix, and memory for a path's directions; arrays are (n, n_dof)."""

    load: Array  # F
    gradient: Array  # g, gradient of the prescribed displacement
    axis: Array  # direction of the spring e over all bodies
    columns: Array  # (3, n, n_dof) direction, K'^-1 F, k K'^-1 e
    changes: Array  # (n_changes, n, n_dof) K^-1 u of every change
    change_of_multiplier: Array  # (n_changes,)
    row: Array  # (n_changes, 1, 2 n_dof) v of every change
    bodies: NDArray[np.int64]  # (n_changes, 2)
    pivot: Array  # (n_changes,) 1 + v . K^-1 u
    rate: Array  # (n_slots, 2) of the trial reactions along the direction
    fold: Array  # (2,) share of the step and multiplier of the first fold; or NaN
    sense: Array  # (1,) -1 where the path goes back, else 1
    # (1,) determinant of the bordered matrix over that of K'
    determinant_ratio: Array
    sign: Array  # (1,) of the latter; where the product is positive, a motion is unstable
    bends: Array  # (n_bends, 2) share of the step and multiplier at every change


class Rules(NamedTuple):
    """How a path is followed."""

    #: Whether a displacement is prescribed and the multiplier is an unknown.
    prescribes: bool
    #: Whether sliding counts over the whole of the step, as in the implicit law.  Otherwise a slip
    #: ends, and is kept, as soon as the contact would slide back: the path of a slow loading, which
    #: no structure follows beyond a fold.
    whole: bool
    #: Largest number of changes.
    patience: int
    #: Number of changes ahead up to which they are followed.
    worth: int


class PathPoint(NamedTuple):
    """A point of a path: the multiplier, the share 1 - t of the step that is left, and the number
    of changes so far."""

    multiplier: float
    left: float
    changes: int


@njit(cache=True, error_model="numpy")
def _rates(table, rows, c, field, a, b):
    """Rates of the trial reactions of contact c along a field of the bodies' motion."""
    gap, slip = along(rows, c, OF_GAP, field, a, b), along(rows, c, MEASURED, field, a, b)
    return -table[c, STIFF_N] * gap, -table[c, STIFF_T] * slip


@njit(cache=True, error_model="numpy")
def _sliding_back(table, c, now, rate_n, rate_t):
    """Rate of a sliding contact along its branch [m], negative where it slides back."""
    if now <= BACKWARD:
        sign = 1.0 if now == FORWARD else -1.0
        return (sign * rate_t - table[c, FRICTION] * rate_n) / table[c, STIFF_T]
    return sense(now) * rate_t / table[c, STIFF_T]


@njit(cache=True, error_model="numpy")
def _ahead(contacts, count, direction, branch, whole):
    """How many contacts would change along the direction."""
    which, rows, table = contacts
    changed = 0
    for c in range(count):
        a = which[c, BODY_A]
        b = which[c, BODY_B]
        rate_n, rate_t = _rates(table, rows, c, direction, a, b)
        now = branch[c]
        far, _ = distance(table, c, now, rate_n, rate_t, whole)
        back = 0.0
        if not whole and now > STICKING:
            back = _sliding_back(table, c, now, rate_n, rate_t)
        if far < 1.0 or back < -SLOW_BACK:
            changed += 1
    return changed


@njit(cache=True, error_model="numpy")
def _keep_slow(contacts, count, branch):
    """Make sliding back that was too slow to end a part of the history."""
    table = contacts.table
    for c in range(count):
        now = branch[c]
        sign = sense(now)
        if sign != 0.0:
            most = table[c, FRICTION] * limited_normal(table, c, now) + table[c, INTERCEPT]
            if sign * table[c, TRIAL_T] < most:
                commit(table, c, now)


@njit(cache=True, error_model="numpy", inline="always")
def _next_change(contacts, count, branch, direction, ahead, whole, dry, last, left_behind, rate):
    """The first contact that leaves its branch along the direction, which ``rate`` is filled for.

    The contact ``last`` does not go back to the branch it has ``left_behind``.  Returns how far
    that is, the contact, or ``count`` where there is none, and its branch from there on.
    """
    which, rows, table = contacts
    nearest = np.inf
    chosen, following = count, count  # none yet; literals would be compiled for on their own
    slowest, back = 0.0, False
    if not whole:
        for i in range(direction.shape[0]):
            slowest = max(slowest, abs(direction[i, 0]), abs(direction[i, 1]))
        slowest *= -SLOW
    for c in range(count):
        rate_n, rate_t = _rates(table, rows, c, direction, which[c, BODY_A], which[c, BODY_B])
        rate_n *= ahead
        rate_t *= ahead
        rate[c, 0], rate[c, 1] = rate_n, rate_t
        now = branch[c]
        if not whole and now > STICKING:
            speed = _sliding_back(table, c, now, rate_n, rate_t)
            if speed < slowest:
                slowest = speed
                chosen = c
                following = both(across_joint(now), STICKING)
                nearest, back = 0.0, True
        if back:
            continue
        if dry:
            far, other = distance_of_dry(table, c, now, rate_n, rate_t, whole)
        else:
            far, other = distance(table, c, now, rate_n, rate_t, whole)
        if c == last and other == left_behind:
            continue
        if far < nearest:
            nearest = far
            chosen = c
            following = other
    return nearest, chosen, following


@njit(cache=True, error_model="numpy", inline="always")
def _add_change(structure, factors, bordered, prescribes, contacts, chosen, before, following, new):
    """Take the change of a contact's branch into the matrix, as number ``new`` since it was made.

    Returns 1 + v . K^-1 u of it, which is zero where there is no direction.
    """
    past, pivots, past_v, bodies = bordered.changes, bordered.pivot, bordered.row, bordered.bodies
    n, n_dof = past.shape[1], past.shape[2]
    a = contacts.which[chosen, BODY_A]
    b = contacts.which[chosen, BODY_B]
    u = np.zeros(2 * n_dof)
    change(contacts.table, contacts.rows, chosen, before, following, u, past_v, new)
    bodies[new, 0] = a
    bodies[new, 1] = b
    w = past[new]
    w[:, :] = 0.0
    for i in range(n_dof):
        w[a, i] += u[i]
        w[b, i] += u[n_dof + i]
    solve(structure, factors, w.reshape((1, n, n_dof)))
    by_w = solve_bordered(bordered, w, 0.0) if prescribes else 0.0
    for old in range(new):
        share = along(past_v, old, 0, w, bodies[old, 0], bodies[old, 1]) / pivots[old]
        for i in range(n):
            for d in range(n_dof):
                w[i, d] -= share * past[old, i, d]
        by_w -= share * bordered.change_of_multiplier[old]
    bordered.change_of_multiplier[new] = by_w
    pivots[new] = 1.0 + along(past_v, new, 0, w, a, b)
    return pivots[new]


@njit(cache=True, error_model="numpy", inline="always")
def _first_direction(structure, factors, bordered, prescribes, force, lag, spring):
    """Fill the first direction; returns how the multiplier changes along it, NaN for none."""
    columns = bordered.columns[:3] if prescribes else bordered.columns[:1]
    for i in range(force.shape[0]):
        for d in range(force.shape[1]):
            columns[0, i, d] = force[i, d]
            if prescribes:
                columns[1, i, d] = bordered.load[i, d]
                columns[2, i, d] = spring * bordered.axis[i, d]
    solve(structure, factors, columns)
    return solve_bordered(bordered, columns[0], lag) if prescribes else 0.0


@njit(cache=True, error_model="numpy", inline="always")
def _go(direction, length, x, rate, share, table, count):
    """Move increments and trial reactions along."""
    for i in range(x.shape[0]):
        for d in range(x.shape[1]):
            x[i, d] += length * direction[i, d]
    for c in range(count):
        table[c, TRIAL_N] += share * rate[c, 0]
        table[c, TRIAL_T] += share * rate[c, 1]


@njit(cache=True, error_model="numpy")
def follow_path(
    structure, factors, bordered, contacts, count, branch, force, lag, spring, x, begin, rules
):
    """Follow the path of a step from where it is.

    Parameters
    ----------
    structure, factors
        Of the matrix K', see `statics.linear.numeric`.
    bordered
        See `BorderedPath`.
    contacts, count
        See `statics.plane.forces.joint_forces`; trial reactions are moved on.
    branch
        (n_slots,) changed as the path goes.
    force, lag, spring
        What is unbalanced at the start, (n, n_dof) [N, N m]; what is missing of the prescribed
        displacement [m]; k [N/m].
    x
        (n, n_dof) increments, moved on.
    begin, rules
        See `PathPoint` and `Rules`.

    Returns
    -------
    How the path ended, the multiplier, the share that is left and the number of changes.
    """
    prescribes, whole, patience, worth = rules
    multiplier, left, changes = begin
    table, rate = contacts.table, bordered.rate
    direction = bordered.columns[0]
    by_direction = _first_direction(structure, factors, bordered, prescribes, force, lag, spring)
    if not np.isfinite(by_direction):
        return SINGULAR, multiplier, left, changes
    if worth < count and _ahead(contacts, count, direction, branch, whole) > worth:
        return MANY, multiplier, left, changes
    ahead, dry = bordered.sense[0], all_dry(table, count)
    new, last = -1, -1  # change since the factorisation, and the contact that has changed
    before = OPEN
    while True:
        nearest, chosen, following = _next_change(
            contacts, count, branch, direction, ahead, whole, dry, last, before, rate
        )
        arrives = ahead > 0.0 and nearest >= 1.0
        length = 1.0 if arrives else nearest
        if not np.isfinite(length):
            return LOST, multiplier, left, changes
        _go(direction, ahead * length, x, rate, length, table, count)
        multiplier += ahead * length * by_direction
        if arrives:
            if not whole:
                _keep_slow(contacts, count, branch)
            return DONE, multiplier, 0.0, changes
        left *= 1.0 - ahead * length
        if left > 1.0 + BELOW_START:
            return FOLDED, multiplier, left, changes
        last, before = chosen, branch[chosen]
        branch[chosen] = following
        if changes < bordered.bends.shape[0]:
            bordered.bends[changes, 0], bordered.bends[changes, 1] = 1.0 - left, multiplier
        changes += 1
        new += 1
        if not whole:
            commit(table, chosen, before)
        if changes > patience:
            return LOST, multiplier, left, changes
        if new == bordered.changes.shape[0]:
            return RENEW, multiplier, left, changes
        pivot = _add_change(
            structure, factors, bordered, prescribes, contacts, chosen, before, following, new
        )
        if pivot == 0.0 or not np.isfinite(pivot):
            return SINGULAR, multiplier, left, changes
        scale = 1.0 - ahead * length
        by_direction = _bend(bordered, contacts, chosen, new, scale, direction, by_direction)
        if pivot < 0.0:
            if not whole:
                # What the structure snaps over is looked for on the path of the implicit law.
                whole = True
                bordered.fold[0], bordered.fold[1] = 1.0 - left, multiplier
            ahead = -ahead
            bordered.sense[0] = ahead


@njit(cache=True, error_model="numpy", inline="always")
def _bend(bordered, contacts, chosen, new, scale, direction, by_direction):
    """Correct the direction for the latest change; see `_add_change`."""
    which, w = contacts.which, bordered.changes[new]
    a, b = which[chosen, BODY_A], which[chosen, BODY_B]
    share = scale * along(bordered.row, new, 0, direction, a, b) / bordered.pivot[new]
    for i in range(direction.shape[0]):
        for d in range(direction.shape[1]):
            direction[i, d] = scale * direction[i, d] - share * w[i, d]
    return scale * by_direction - share * bordered.change_of_multiplier[new]
