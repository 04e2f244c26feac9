"""One linear step, followed from one contact's change to the next.

With constant gradients the unbalanced forces R are piecewise linear in the increments x and the
multiplier l: one piece for every choice of branches of the joint law.  The path moves the unknowns
so that all unbalanced forces shrink together,

    R(x, l) = (1 - t) R_0,    g . (x - x_0) = t lag_0,    t from 0 to 1

along straight lines with a kink where a contact leaves its branch.  At a kink the matrix changes by
u v^T only.  So the new direction takes one more solution with the factors of the first matrix
(Sherman-Morrison).  If 1 + v . K^-1 u is negative, the path has a fold: t decreases until the next
fold.  If t becomes negative, there is no solution ahead (Katzenelson 1965).  If the path passes the
t of a fold again, the drop at the fold is what the multiplier has lost in between.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.common.tolerances import BELOW_START, LEAST_PIVOT, NOTHING_FARTHER, SLOW
from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    FRICTION,
    INTERCEPT,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
)
from drystone.contact.rows import IN_PLANE, along
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING, across_joint, both, sense
from drystone.law.limits import limited_normal
from drystone.law.pieces import all_dry, change, distance, distance_of_dry
from drystone.law.plane import commit, respond
from drystone.linear.numeric import Factors, factorise, solve
from drystone.linear.symbolic import Structure, Tangent
from drystone.statics.balance import dot, solve_bordered, stiffen, unbalance
from drystone.statics.plane.contacts import (
    add,
    add_geometric_stiffness,
    assemble,
    move_trial,
    trial_rates,
)

#: How a path ends: at its target; at a fold before its target; at a change after which the matrix
#: must be factorised anew; after too many changes; at a singular matrix; or because the caller is
#: to factorise the matrix.
DONE, FOLDED, RENEW, EXHAUSTED, SINGULAR, WAITS = 0, 1, 2, 3, 4, 5


class Way(NamedTuple):
    """Memory for a path's changes."""

    changes: Array  # (n_changes, n, n_dof) K^-1 u of every change
    change_of_multiplier: Array  # (n_changes,)
    row: Array  # (n_changes, 1, 2 n_dof) v of every change
    bodies: IntArray  # (n_changes, 2)
    pivot: Array  # (n_changes,) 1 + v . K^-1 u
    rate: Array  # (n_slots, 2) of the trial reactions along the direction
    fold: Array  # (3,) of the fold that matters most, see `engines.base.Fold`; or NaN
    sense: Array  # (1,) -1 if the path goes back, else 1
    bends: Array  # (n_bends, 2) share of the step and multiplier at the first changes


class Pieces(NamedTuple):
    """The parts from which the forces and the matrix of a linear piece are summed."""

    structure: Structure  # of the matrix
    factors: Factors
    pair_bodies: IntArray  # (n_pairs, 2) of all pairs of the matrix
    #: Stiffness that does not depend on the branches of contacts: of ties and of loads that turn;
    #: and the same with the geometric stiffness of contacts.
    others: Tangent
    geometric: Tangent
    tangent: Tangent  # the whole matrix, with inertia
    damping: Array  # (n,)
    away: Array  # (n, n_dof) increments from where the gradients were taken to where the path is


class Rules(NamedTuple):
    """How a path is followed."""

    #: Body whose displacement is prescribed, the multiplier being an unknown; -1 if there is none.
    body: int
    #: Prescribed displacement that is missing where the gradients were taken [m].
    lag: float
    inertia_factor: float  # 1/s2
    #: Largest number of changes, and of changes in a row that bring the path no farther.
    patience: int
    idle: int
    #: Whether the caller factorises the matrix, see `WAITS`.
    waits: bool


#: The variables of a path, all in one array:
#:
#: MULTIPLIER  the load multiplier
#: LEFT        the share of the step that is left, 1 - t
#: CHANGES     the number of changes so far
#: WHOLE       whether the path is that of the implicit law, see below
#: LEAST       the least share left so far
#: SINCE       the number of changes since then
#: SPRING      the stiffness of the spring at the control point [N/m]
#: PIVOT       the pivot of the matrix; NaN before it is factorised
#: TURNED      the share left at the last fold whose share was not passed again; NaN if none
#: TOP         the multiplier there
#: PASSED      the share left where the path last passed the share of a fold again
#:
#: In the implicit law, sliding counts over the whole step.  Otherwise the path is that of a slow
#: loading: a slip ends, and is kept, as soon as the contact would slide back.  From a fold on, no
#: structure follows the path, but snaps to where the path passes the same share again.  Up to
#: there, the path is that of the implicit law.
MULTIPLIER, LEFT, CHANGES, WHOLE, LEAST, SINCE, SPRING, PIVOT, TURNED, TOP, PASSED = range(11)
N_PROGRESS = 11


@njit(cache=True, error_model="numpy")
def _sliding_back(table, c, now, rate_n, rate_t):
    """Rate of a sliding contact along its branch [m], negative where it slides back."""
    if now <= BACKWARD:
        sign = 1.0 if now == FORWARD else -1.0
        return (sign * rate_t - table[c, FRICTION] * rate_n) / table[c, STIFF_T]
    return sense(now) * rate_t / table[c, STIFF_T]


@njit(cache=True, error_model="numpy")
def _keep_slow(contacts, count, branch):
    """Keep the slip of contacts that slide back too slowly for their slip to have ended."""
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
    """Find the first contact that leaves its branch along the direction, and fill the ``rate`` of
    all contacts.

    The contact ``last`` does not go back to the branch it has ``left_behind``.  Returns the length
    along the direction, the contact, ``count`` if there is none, and the branch that it takes.
    """
    which, rows, table = contacts
    nearest = np.inf
    chosen, following = count, count  # none yet; for a literal, all would be compiled once more
    slowest, back = 0.0, False
    if not whole:
        for i in range(direction.shape[0]):
            slowest = max(slowest, abs(direction[i, 0]), abs(direction[i, 1]))
        slowest *= -SLOW
    for c in range(count):
        rate_n, rate_t = trial_rates(table, rows, c, direction, which[c, BODY_A], which[c, BODY_B])
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
def _add_change(
    structure, factors, bordered, way, prescribes, contacts, chosen, before, following, new
):
    """Apply the change of a contact's branch to the matrix, as change number ``new`` since the
    factorisation.

    Returns the pivot 1 + v . K^-1 u of the change, which is zero if the matrix becomes singular.
    """
    past, pivots, past_v, bodies = way.changes, way.pivot, way.row, way.bodies
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
    flat = w.reshape(-1)
    for old in range(new):
        share = along(IN_PLANE, past_v, old, 0, w, bodies[old, 0], bodies[old, 1]) / pivots[old]
        earlier = past[old].reshape(-1)
        for i in range(flat.shape[0]):
            flat[i] -= share * earlier[i]
        by_w -= share * way.change_of_multiplier[old]
    way.change_of_multiplier[new] = by_w
    pivots[new] = 1.0 + along(IN_PLANE, past_v, new, 0, w, a, b)
    return pivots[new]


@njit(cache=True, error_model="numpy", inline="always")
def _first_direction(structure, factors, bordered, prescribes, force, lag, spring):
    """Fill the first direction; returns the change of the multiplier along it, NaN if there is no
    direction."""
    columns = bordered.columns[:2] if prescribes else bordered.columns[:1]
    for i in range(force.shape[0]):
        for d in range(force.shape[1]):
            columns[0, i, d] = force[i, d]
            if prescribes:
                columns[0, i, d] += spring * lag * bordered.gradient[i, d]
                columns[1, i, d] = bordered.load[i, d]
    solve(structure, factors, columns)
    return solve_bordered(bordered, columns[0], lag) if prescribes else 0.0


@njit(cache=True, error_model="numpy", inline="always")
def _go(direction, length, x, rate, share, table, count):
    """Move the increments ``x`` on by ``length`` times the direction, and the trial reactions by
    ``share`` times their rates."""
    to, way = x.reshape(-1), direction.reshape(-1)
    for i in range(to.shape[0]):
        to[i] += length * way[i]
    for c in range(count):
        table[c, TRIAL_N] += share * rate[c, 0]
        table[c, TRIAL_T] += share * rate[c, 1]


@njit(cache=True, error_model="numpy")
def walk(box, count, x, progress, rules):
    """Follow the path of a step from where it is, with as many factorisations as it takes.

    The ``box`` holds `Located`, the ``count`` contacts where the gradients were taken; `Pieces`;
    `Bordered`; and the `Way`.  The increments ``x`` (n, n_dof) and the variables ``progress``
    (N_PROGRESS,), see `MULTIPLIER`, are updated.  Returns how the path has ended.  If it `WAITS`,
    the caller factorises the matrix, writes its pivot into ``progress``, and calls again.
    """
    located, pieces, bordered, way = box.value
    contacts, answer, forces = located.contacts, located.answer, located.forces
    end = RENEW
    while end == RENEW:
        if np.isnan(progress[PIVOT]):
            _factorable(located, pieces, bordered, count, x, progress, rules)
            if rules.waits:
                return WAITS
            progress[PIVOT] = factorise(
                pieces.structure, pieces.tangent.diagonal, pieces.tangent.upper,
                pieces.tangent.lower, pieces.factors, forces.mass, pieces.damping, 0.0,
            )  # fmt: skip
        bordered.sign[0] = np.sign(progress[PIVOT])
        if not abs(progress[PIVOT]) > LEAST_PIVOT:
            return SINGULAR
        progress[PIVOT] = np.nan
        end = _follow(
            pieces, contacts, count, answer.branch, bordered, way, forces, x, progress, rules
        )
    return end


@njit(cache=True, error_model="numpy")
def _copy(blocks, into):
    """Copy blocks of a matrix (n, n_dof, n_dof).

    An assignment of arrays would take the compiler seconds, because it also compiles the message
    about shapes that do not fit.
    """
    for i in range(blocks.shape[0]):
        for d in range(blocks.shape[1]):
            for e in range(blocks.shape[2]):
                into[i, d, e] = blocks[i, d, e]


@njit(cache=True, error_model="numpy", inline="always")
def _factorable(located, pieces, bordered, count, x, progress, rules):
    """Sum the forces and the matrix of the piece that the path is in."""
    contacts, answer, forces = located.contacts, located.answer, located.forces
    geometry, away, n_dof = located.x, pieces.away, x.shape[1]
    for i in range(x.shape[0]):
        pieces.damping[i] = 0.0
        for d in range(n_dof):
            away[i, d] = x[i, d] - geometry[i, d]
    if progress[CHANGES] == 0.0:
        _copy(pieces.others.diagonal, pieces.geometric.diagonal)
        _copy(pieces.others.upper, pieces.geometric.upper)
        _copy(pieces.others.lower, pieces.geometric.lower)
        add_geometric_stiffness(located.slots, contacts, count, answer.reaction, pieces.geometric)
        which, rows, table = contacts
        move_trial(which, rows, table, count, away)
    respond(contacts.table, 0, count, answer.branch, answer.reaction, answer.response)
    assemble(
        contacts, count, pieces.pair_bodies, answer.reaction, answer.response, pieces.geometric,
        away, forces.contact, pieces.tangent,
    )  # fmt: skip
    add(located.held, forces.contact)
    unbalance(forces, progress[MULTIPLIER], x, rules.inertia_factor)
    progress[SPRING] = stiffen(
        pieces.tangent.diagonal, forces.mass, rules.inertia_factor, pieces.damping, rules.body,
        bordered.gradient,
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def _keep_all(table, count, branch):
    """Keep all sliding and crushing so far in the table.

    The slip of a dry joint would also be kept later, when it ends.  Crushing, and the dilation of a
    joint that has opened, would be lost.
    """
    for c in range(count):
        commit(table, c, branch[c])


@njit(cache=True, error_model="numpy")
def _tell(fold, turned, top, multiplier):
    """Store the fold with the largest drop of the multiplier of those passed so far."""
    drop = top - multiplier
    if not abs(fold[2]) >= abs(drop):
        fold[0], fold[1], fold[2] = 1.0 - turned, top, drop


@njit(cache=True, error_model="numpy", inline="always")
def _follow(pieces, contacts, count, branch, bordered, way, forces, x, progress, rules):
    """Follow the path with the present factors of the matrix; returns how it has ended."""
    prescribes = rules.body >= 0
    structure, factors = pieces.structure, pieces.factors
    turned, top, passed = progress[TURNED], progress[TOP], progress[PASSED]
    whole = progress[WHOLE] != 0.0 or np.isfinite(turned)
    multiplier, left, changes = progress[MULTIPLIER], progress[LEFT], int(progress[CHANGES])
    lag = rules.lag - dot(bordered.gradient, pieces.away) if prescribes else 0.0
    table, rate = contacts.table, way.rate
    direction = bordered.columns[0]
    by_direction = _first_direction(
        structure, factors, bordered, prescribes, forces.left, lag, progress[SPRING]
    )
    if not np.isfinite(by_direction):
        return SINGULAR
    ahead, dry = way.sense[0], all_dry(table, count)
    new, last = -1, -1  # change since the factorisation, and the contact that has changed
    least, since, before = progress[LEAST], progress[SINCE], OPEN
    while True:
        nearest, chosen, following = _next_change(
            contacts, count, branch, direction, ahead, whole, dry, last, before, rate
        )
        arrives = ahead > 0.0 and nearest >= 1.0
        length = 1.0 if arrives else nearest
        if not np.isfinite(length):
            end = EXHAUSTED
            break
        passes = ahead > 0.0 and left * (1.0 - length) <= turned
        if passes:
            length = max(1.0 - turned / left, 0.0)
        _go(direction, ahead * length, x, rate, length, table, count)
        multiplier += ahead * length * by_direction
        if passes:
            _tell(way.fold, turned, top, multiplier)
            _keep_all(table, count, branch)
            whole, left, passed, turned = False, turned, turned, np.nan
            for i in range(direction.shape[0]):
                for d in range(direction.shape[1]):
                    direction[i, d] *= 1.0 - length
            by_direction *= 1.0 - length
            continue
        if arrives:
            if not whole:
                _keep_slow(contacts, count, branch)
            end = DONE
            break
        left *= 1.0 - ahead * length
        if left > 1.0 + BELOW_START:
            end = FOLDED
            break
        last, before = chosen, branch[chosen]
        branch[chosen] = following
        if changes < way.bends.shape[0]:
            way.bends[changes, 0], way.bends[changes, 1] = 1.0 - left, multiplier
        changes += 1
        new += 1
        since += 1.0
        if left < least - NOTHING_FARTHER:
            least, since = left, 0.0
        if not whole:
            commit(table, chosen, before)
        if changes > rules.patience or since > rules.idle:
            end = EXHAUSTED
            break
        pivot = _add_change(
            structure, factors, bordered, way, prescribes, contacts, chosen, before, following, new
        )
        if pivot == 0.0 or not np.isfinite(pivot):
            end = SINGULAR
            break
        scale = 1.0 - ahead * length
        by_direction = _bend(way, contacts, chosen, new, scale, direction, by_direction)
        if pivot < 0.0:
            if not whole:
                # The structure snaps from here.  Where to is found on the path of the implicit law.
                if not abs(left - passed) <= NOTHING_FARTHER:
                    top = multiplier  # otherwise one drop follows another, and they count as one
                whole, turned = True, left
            ahead = -ahead
            way.sense[0], bordered.sign[0] = ahead, -bordered.sign[0]
        if new + 1 == way.changes.shape[0]:
            end = RENEW
            break
    progress[MULTIPLIER], progress[LEFT], progress[CHANGES] = multiplier, left, changes
    progress[LEAST], progress[SINCE] = least, since
    progress[TURNED], progress[TOP], progress[PASSED] = turned, top, passed
    return end


@njit(cache=True, error_model="numpy", inline="always")
def _bend(way, contacts, chosen, new, scale, direction, by_direction):
    """Correct the direction for the latest change; see `_add_change`."""
    which, w = contacts.which, way.changes[new]
    a, b = which[chosen, BODY_A], which[chosen, BODY_B]
    share = scale * along(IN_PLANE, way.row, new, 0, direction, a, b) / way.pivot[new]
    flat, by_change = direction.reshape(-1), w.reshape(-1)
    for i in range(flat.shape[0]):
        flat[i] = scale * flat[i] - share * by_change[i]
    return scale * by_direction - share * way.change_of_multiplier[new]
