"""The joint law at every contact: what the blocks do to each other where they are.

With the stiffnesses times the contact's tributary area k_n, k_s [N/m], gap g, accumulated
dilation d, slip increment s and shear t_0 at the start of the step, the trial reactions are

    r_n = k_n (d - g)          r_t = t_0 - k_s s

Without tension k_s r_n + k_n tan(psi) |r_t| <= 0 means open, which without dilatancy is r_n <= 0.
|r_t| <= mu r_n sticks.  Otherwise the joint slides by

    gamma = (|r_t| - mu r_n) / (k_s + mu k_n tan psi)

against the trial shear, which raises the normal reaction by k_n tan(psi) gamma (return mapping;
non-associative unless tan psi = mu).  A bond holds whatever it carries: when it is lost is decided
between steps (see `contact.bonds`).  In each of these branches the reactions are linear in the
trial reactions, and they are continuous.

The force on block b is r_n n + r_t t, on the blocks together r_n grad(g) + r_t grad(s); their
tangent includes the second derivatives of g and s (see `kernels.narrow`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

NONE, VERTEX_B, VERTEX_A, VERTICES = 0, 1, 2, 3
OPEN, STICKING, SLIDING = 0, 1, 2

#: Branches of the law: as above, with the two senses of sliding told apart, by the sign of the
#: shear, and joints whose bond holds.
FORWARD, BACKWARD, BONDED = 2, 3, 4

#: A contact stays in the branch it came from when another is nearer by this share of its reactions
#: only: one that slides starts the next step on its cone to rounding.
TIE = 1e-7

#: Columns of the history of a contact: shear [N], dilation [m], slid distance [m], broken bond.
SHEAR, DILATION, SLID, BROKEN = 0, 1, 2, 3
N_HISTORY = 4

#: Columns of the table of joint laws: mu, k_n, k_s [Pa/m], tan psi, c, f_t [Pa], slide at which
#: dilatancy ends [m].
MU, KN, KS, TAN_PSI, COHESION, TENSION, DILATANCY_END = 0, 1, 2, 3, 4, 5, 6
N_LAW = 7

#: Columns of the table of contacts: gradients of gap and of slip, and the gradient by which slip
#: is measured, each by the motions of both blocks; k_n, k_s [N/m], mu, k_n tan psi [N/m],
#: c A, f_t A [N], trial reactions [N], and what sliding that has ended within the step adds to them
#: [N], with its length [m].
GAP, SLIP, MEASURED = 0, 6, 12
STIFF_N, STIFF_T, FRICTION, LIFT, BOND, TENSILE, TRIAL_N, TRIAL_T = 18, 19, 20, 21, 22, 23, 24, 25
ADD_N, ADD_T, PLASTIC = 26, 27, 28
N_TABLE = 29

#: Columns of the response of a contact: reactions, and their derivatives by the trial reactions,
#: the first by the normal one.
RN, RT, NN, NT, TN, TT = 0, 1, 2, 3, 4, 5
N_RESPONSE = 6

Array = NDArray[np.float64]


class Tangent(NamedTuple):
    """Block form of the stiffness matrix: diagonal blocks, and both of every pair."""

    diagonal: Array  # (n, 3, 3)
    upper: Array  # (n_pairs, 3, 3) rows of a, columns of b
    lower: Array  # (n_pairs, 3, 3) rows of b, columns of a


@njit(cache=True)
def _slip(kind, normal, arm_a, arm_b, roll, ratio, k, a, b, increment):
    """Sliding distance of b over a along the tangent since the start of the step [m].

    Written in differences from the present place backwards, so that it is as precise as the
    increments themselves: shear stiffness times the rounding of coordinates would be felt.
    """
    tx = normal[k, 1]
    ty = -normal[k, 0]
    wa = increment[a, 2]
    wb = increment[b, 2]
    sa = np.sin(wa)
    ca = 2.0 * np.sin(0.5 * wa) ** 2
    sb = np.sin(wb)
    cb = 2.0 * np.sin(0.5 * wb) ** 2
    # (I - R(-w)) v = [(1 - cos) v_x - sin v_y, sin v_x + (1 - cos) v_y]
    ax = ca * arm_a[k, 0] - sa * arm_a[k, 1]
    ay = sa * arm_a[k, 0] + ca * arm_a[k, 1]
    bx = cb * arm_b[k, 0] - sb * arm_b[k, 1]
    by = sb * arm_b[k, 0] + cb * arm_b[k, 1]
    ux = increment[b, 0] - increment[a, 0]
    uy = increment[b, 1] - increment[a, 1]
    rolled = roll[k, 0] * wa + roll[k, 1] * wb
    if kind[k] == VERTEX_B:
        ux += bx
        uy += by
        turned_x = ca * tx - sa * ty
        turned_y = sa * tx + ca * ty
        before_x = arm_a[k, 0] - ux
        before_y = arm_a[k, 1] - uy
        return tx * ux + ty * uy + turned_x * before_x + turned_y * before_y + rolled
    if kind[k] == VERTEX_A:
        ux -= ax
        uy -= ay
        turned_x = cb * tx - sb * ty
        turned_y = sb * tx + cb * ty
        before_x = arm_b[k, 0] + ux
        before_y = arm_b[k, 1] + uy
        return tx * ux + ty * uy - turned_x * before_x - turned_y * before_y + rolled
    ux += bx - ax
    uy += by - ay
    radii = roll[k, 0] + roll[k, 1]
    dx = normal[k, 0] * radii / ratio[k]
    dy = normal[k, 1] * radii / ratio[k]
    swept = np.arctan2(dx * uy - dy * ux, (dx - ux) * dx + (dy - uy) * dy)
    return rolled - radii * swept


@njit(cache=True)
def _second_derivatives(kind, normal, arm_a, arm_b, roll, ratio, k, rn, rt, hess):
    """Add -(r_n hess(g) + r_t hess(s)) to the 6 x 6 ``hess``, in the order (a, b)."""
    nx = normal[k, 0]
    ny = normal[k, 1]
    tx = ny
    ty = -nx
    # A force f = r_n n + r_t t that turns with the block that owns the edge, at a fixed line.
    fx = rn * nx + rt * tx
    fy = rn * ny + rt * ty
    if kind[k] == VERTEX_B:
        e, o = 0, 3
        along_e = fx * arm_a[k, 0] + fy * arm_a[k, 1]
        along_o = fx * arm_b[k, 0] + fy * arm_b[k, 1]
        sign = 1.0
    elif kind[k] == VERTEX_A:
        e, o = 3, 0
        along_e = -(fx * arm_b[k, 0] + fy * arm_b[k, 1])
        along_o = -(fx * arm_a[k, 0] + fy * arm_a[k, 1])
        sign = -1.0
    else:
        e, o, sign, along_e, along_o = 0, 3, 1.0, 0.0, 0.0
    if kind[k] != VERTICES:
        # hess(theta_e, x_o) = S f, hess(theta_e, x_e) = -S f, and three rotation terms.
        sx = -sign * fy
        sy = sign * fx
        hess[e + 2, o] -= sx
        hess[e + 2, o + 1] -= sy
        hess[o, e + 2] -= sx
        hess[o + 1, e + 2] -= sy
        hess[e + 2, e] += sx
        hess[e + 2, e + 1] += sy
        hess[e, e + 2] += sx
        hess[e + 1, e + 2] += sy
        hess[e + 2, e + 2] += along_e
        hess[e + 2, o + 2] -= along_o
        hess[o + 2, e + 2] -= along_o
        hess[o + 2, o + 2] += along_o
        return
    radii = roll[k, 0] + roll[k, 1]
    distance = radii / ratio[k]
    n_a = nx * arm_a[k, 0] + ny * arm_a[k, 1]
    n_b = nx * arm_b[k, 0] + ny * arm_b[k, 1]
    t_a = tx * arm_a[k, 0] + ty * arm_a[k, 1]
    t_b = tx * arm_b[k, 0] + ty * arm_b[k, 1]
    # n.J and t.J, with J the Jacobian of the vector from vertex to vertex; S n = -t, S t = n.
    nj = (-nx, -ny, -t_a, nx, ny, t_b)
    tj = (-tx, -ty, n_a, tx, ty, -n_b)
    for i in range(6):
        for j in range(6):
            hess[i, j] -= rn / distance * tj[i] * tj[j]
            hess[i, j] -= rt * radii / distance**2 * -(nj[i] * tj[j] + tj[i] * nj[j])
    hess[2, 2] -= rn * n_a + rt * ratio[k] * t_a
    hess[5, 5] += rn * n_b + rt * ratio[k] * t_b


@njit(cache=True)
def _branch(table, c, hint):
    """Branch of the law for the trial reactions of a row of the table."""
    rn = table[c, TRIAL_N]
    rt = table[c, TRIAL_T]
    mu = table[c, FRICTION]
    if hint == BONDED:
        return BONDED
    over = abs(rt) - mu * rn
    near = TIE * (abs(rt) + mu * abs(rn))
    # A joint that dilates is held closed by what it slides.
    held = table[c, STIFF_T] * rn + table[c, LIFT] * abs(rt)
    if held < 0.0 or (held == 0.0 and hint != STICKING):
        return OPEN
    sliding = FORWARD if rt > 0.0 else BACKWARD
    if abs(over) <= near and (hint == STICKING or hint == sliding):
        return hint
    return STICKING if over <= 0.0 else sliding


@njit(cache=True)
def _reactions(table, c, branch):
    """Normal and tangential reaction [N] in a branch of the law, and the sliding in it [m]."""
    rn = table[c, TRIAL_N]
    rt = table[c, TRIAL_T]
    if branch == OPEN:
        return 0.0, 0.0, 0.0
    if branch == STICKING or branch == BONDED:
        return rn, rt, 0.0
    sign = 1.0 if branch == FORWARD else -1.0
    mu, lift = table[c, FRICTION], table[c, LIFT]
    gamma = (sign * rt - mu * rn) / (table[c, STIFF_T] + mu * lift)
    rn += lift * gamma
    return rn, sign * mu * rn, gamma


@njit(cache=True)
def joint_forces(
    slots, pair_a, pair_b, pair_law, laws, thickness, start_length, start_slip, closed, memory,
    increment, force, table, used, branch, reaction, state,
):  # fmt: skip
    """Reactions of all contacts in the present poses; returns the number of contacts.

    Parameters
    ----------
    slots
        Contacts in the present poses.
    pair_a, pair_b, pair_law
        Bodies and joint law of each pair, (n_pairs,).
    laws
        (n_laws, N_LAW), see the columns above.
    thickness
        [m]
    start_length
        Tributary lengths at the start of the step, (n_slots,) [m]; zero where there was none.
    start_slip
        Gradients of the slip that hold for the step, (n_slots, 6), of contacts that were there
        when it began; others slip by the exact distance.
    closed
        (n_slots,) whether a contact was closed when the step began; others do not dilate in it.
    memory
        (n_slots, N_HISTORY), what contacts bring along; see `remember`.
    increment
        Motion since the start of the step, (n, 3) [m, rad].
    force
        (n, 3) [N, N m], filled with what all contacts do to each body.
    table, used
        Filled: (n_slots, N_TABLE) and (n_slots,), rows of contacts and the slots they are of.
    branch
        (n_slots,) branch that each slot has been in, or -1; replaced by the present one.
    reaction, state
        Filled: (n_slots, 2) [N], and the history at the end, (n_slots, N_HISTORY).
    """
    kind, normal, arm_a, arm_b = slots.kind, slots.normal, slots.arm_a, slots.arm_b
    roll, ratio, gap, length = slots.roll, slots.ratio, slots.gap, slots.length
    force[:, :] = 0.0
    count = 0
    for k in range(kind.shape[0]):
        reaction[k, 0] = 0.0
        reaction[k, 1] = 0.0
        for i in range(N_HISTORY):
            state[k, i] = memory[k, i]
        hint = branch[k]
        branch[k] = OPEN
        if kind[k] == NONE:
            continue
        shear = state[k, SHEAR]
        state[k, SHEAR] = 0.0
        p = k // 2
        a = pair_a[p]
        b = pair_b[p]
        law = pair_law[p]
        known = start_length[k] > 0.0
        area = thickness * (start_length[k] if known else length[k])
        c = count
        count += 1
        used[c] = k
        _gradients(kind, normal, arm_a, arm_b, roll, ratio, k, table, c)
        if known:
            slip = 0.0
            for i in range(3):
                table[c, MEASURED + i] = start_slip[k, i]
                table[c, MEASURED + 3 + i] = start_slip[k, 3 + i]
                slip += start_slip[k, i] * increment[a, i]
                slip += start_slip[k, 3 + i] * increment[b, i]
        else:
            for i in range(6):
                table[c, MEASURED + i] = table[c, SLIP + i]
            slip = _slip(kind, normal, arm_a, arm_b, roll, ratio, k, a, b, increment)
        kn, kt = laws[law, KN] * area, laws[law, KS] * area
        bond, tensile = laws[law, COHESION] * area, laws[law, TENSION] * area
        dilates = closed[k] and state[k, SLID] < laws[law, DILATANCY_END]
        lift = kn * laws[law, TAN_PSI] if dilates else 0.0
        table[c, STIFF_N], table[c, STIFF_T], table[c, FRICTION] = kn, kt, laws[law, MU]
        table[c, LIFT], table[c, BOND], table[c, TENSILE] = lift, bond, tensile
        table[c, TRIAL_N] = kn * (state[k, DILATION] - gap[k])
        table[c, TRIAL_T] = shear - kt * slip
        table[c, ADD_N], table[c, ADD_T], table[c, PLASTIC] = 0.0, 0.0, 0.0
        if state[k, BROKEN] == 0.0 and (bond > 0.0 or tensile > 0.0):
            hint = BONDED
        now = _branch(table, c, hint)
        branch[k] = now
        rn, rt, gamma = _reactions(table, c, now)
        state[k, DILATION] += laws[law, TAN_PSI] * gamma if lift > 0.0 else 0.0
        state[k, SLID] += gamma
        reaction[k, 0] = rn
        reaction[k, 1] = rt
        state[k, SHEAR] = rt
        for i in range(3):
            force[a, i] += rn * table[c, GAP + i] + rt * table[c, SLIP + i]
            force[b, i] += rn * table[c, GAP + 3 + i] + rt * table[c, SLIP + 3 + i]
    return count


@njit(cache=True)
def _gradients(kind, normal, arm_a, arm_b, roll, ratio, k, table, c):
    """Gradients of gap and slip of contact k into a row of the table; see `kernels.narrow`."""
    nx = normal[k, 0]
    ny = normal[k, 1]
    table[c, GAP + 0] = -nx
    table[c, GAP + 1] = -ny
    table[c, GAP + 2] = nx * arm_a[k, 1] - ny * arm_a[k, 0]
    table[c, GAP + 3] = nx
    table[c, GAP + 4] = ny
    table[c, GAP + 5] = -nx * arm_b[k, 1] + ny * arm_b[k, 0]
    q = ratio[k]
    table[c, SLIP + 0] = -q * ny
    table[c, SLIP + 1] = q * nx
    table[c, SLIP + 2] = q * (ny * arm_a[k, 1] + nx * arm_a[k, 0]) + roll[k, 0]
    table[c, SLIP + 3] = q * ny
    table[c, SLIP + 4] = -q * nx
    table[c, SLIP + 5] = -q * (ny * arm_b[k, 1] + nx * arm_b[k, 0]) + roll[k, 1]


@njit(cache=True)
def slip_gradients(slots, rows):
    """Gradients of the slip of all contacts in use, (n_slots, 6); see `kernels.narrow`."""
    kind, normal, arm_a, arm_b = slots.kind, slots.normal, slots.arm_a, slots.arm_b
    roll, ratio = slots.roll, slots.ratio
    row = np.zeros((1, 12))
    for k in range(kind.shape[0]):
        if kind[k] != NONE:
            _gradients(kind, normal, arm_a, arm_b, roll, ratio, k, row, 0)
            for i in range(6):
                rows[k, i] = row[0, SLIP + i]


@njit(cache=True)
def move_trial(table, count, used, pair_a, pair_b, motion):
    """Trial reactions where the blocks have moved on by ``motion`` (n, 3), to first order."""
    for c in range(count):
        a = pair_a[used[c] // 2]
        b = pair_b[used[c] // 2]
        row = table[c]
        gap = 0.0
        slip = 0.0
        for i in range(3):
            gap += row[GAP + i] * motion[a, i] + row[GAP + 3 + i] * motion[b, i]
            slip += row[MEASURED + i] * motion[a, i] + row[MEASURED + 3 + i] * motion[b, i]
        row[TRIAL_N] -= row[STIFF_N] * gap
        row[TRIAL_T] -= row[STIFF_T] * slip


@njit(cache=True)
def remember(table, count, used, memory):
    """Sliding that has ended becomes part of what contacts bring along (n_slots, N_HISTORY)."""
    for c in range(count):
        k = used[c]
        memory[k, SHEAR] += table[c, ADD_T]
        memory[k, DILATION] += table[c, ADD_N] / table[c, STIFF_N]
        memory[k, SLID] += table[c, PLASTIC]
        table[c, ADD_N] = 0.0
        table[c, ADD_T] = 0.0
        table[c, PLASTIC] = 0.0


@njit(cache=True)
def carry(source, history, reaction, branch, new_history, new_reaction, new_branch):
    """Fill what slots have from those that they go on in, ``source``; -1 marks contacts that are
    new: open, without shear, and never bonded."""
    for k in range(source.shape[0]):
        j = source[k]
        for i in range(N_HISTORY):
            new_history[k, i] = history[j, i] if j >= 0 else 0.0
        if j < 0:
            new_history[k, BROKEN] = 1.0
        new_reaction[k, 0] = reaction[j, 0] if j >= 0 else 0.0
        new_reaction[k, 1] = reaction[j, 1] if j >= 0 else 0.0
        new_branch[k] = branch[j] if j >= 0 else OPEN


@njit(cache=True)
def judge(table, count, used, pair_a, pair_b, gap, reaction, state, bodies, judged, values):
    """Contacts as `contact.certificate.JudgedContacts` has them: a row of ``bodies`` (2, count) and
    ``values`` (8, count) for each of its fields, and the reactions ``judged`` (count, 2)."""
    for c in range(count):
        k = used[c]
        bodies[0, c], bodies[1, c] = pair_a[k // 2], pair_b[k // 2]
        whole = 1.0 if state[k, BROKEN] == 0.0 else 0.0
        values[0, c] = gap[k] - state[k, DILATION]
        values[1, c] = 0.0  # the slip is in the trial reaction
        judged[c, 0], judged[c, 1] = reaction[k, 0], reaction[k, 1]
        values[2, c] = table[c, TRIAL_T]
        values[3, c], values[4, c] = table[c, STIFF_N], table[c, STIFF_T]
        values[5, c] = table[c, FRICTION]
        values[6, c], values[7, c] = table[c, BOND] * whole, table[c, TENSILE] * whole


@njit(cache=True)
def respond(table, count, used, branch, response):
    """Fill reactions and their derivatives by the trial reactions, (n_slots, N_RESPONSE)."""
    for c in range(count):
        now = branch[used[c]]
        response[c, RN], response[c, RT], _ = _reactions(table, c, now)
        nn, nt, tn, tt = 0.0, 0.0, 0.0, 0.0
        if now == STICKING or now == BONDED:
            nn, tt = 1.0, 1.0
        elif now != OPEN:
            sign = 1.0 if now == FORWARD else -1.0
            mu, lift = table[c, FRICTION], table[c, LIFT]
            raised = lift / (table[c, STIFF_T] + mu * lift)
            nn, nt = 1.0 - raised * mu, raised * sign
            tn, tt = sign * mu * nn, sign * mu * nt
        response[c, NN], response[c, NT] = nn, nt
        response[c, TN], response[c, TT] = tn, tt


@njit(cache=True)
def geometric_stiffness(slots, count, used, pair_a, pair_b, reaction, tangent):
    """Fill ``tangent`` with what turning contacts, at held reactions, add to that of minus forces.

    Parameters
    ----------
    slots
        Contacts in the present poses.
    count, used
        See `joint_forces`.
    pair_a, pair_b
        Bodies of each pair, (n_pairs,).
    reaction
        (n_slots, 2) [N].
    tangent
        `Tangent`.
    """
    # Fields read once, and no views of rows: in the loop each would count references.
    kind, normal, arm_a, arm_b = slots.kind, slots.normal, slots.arm_a, slots.arm_b
    roll, ratio = slots.roll, slots.ratio
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    diagonal[:, :, :] = 0.0
    upper[:, :, :] = 0.0
    lower[:, :, :] = 0.0
    hess = np.zeros((6, 6))
    for c in range(count):
        k = used[c]
        if reaction[k, 0] == 0.0:
            continue
        p = k // 2
        hess[:, :] = 0.0
        _second_derivatives(
            kind, normal, arm_a, arm_b, roll, ratio, k, reaction[k, 0], reaction[k, 1], hess
        )
        _add(hess, pair_a[p], pair_b[p], p, diagonal, upper, lower)


@njit(cache=True)
def _add(hess, a, b, p, diagonal, upper, lower):
    """Add the blocks of a contact of pair p."""
    for i in range(3):
        for j in range(3):
            diagonal[a, i, j] += hess[i, j]
            diagonal[b, i, j] += hess[3 + i, 3 + j]
            upper[p, i, j] += hess[i, 3 + j]
            lower[p, i, j] += hess[3 + i, j]


@njit(cache=True)
def assemble(table, count, used, pair_a, pair_b, response, geometric, motion, force, tangent):
    """Forces of all contacts that respond as given, and the tangent of minus them.

    Parameters
    ----------
    table, count, used
        See `joint_forces`.
    pair_a, pair_b
        Bodies of each pair, (n_pairs,).
    response
        (n_slots, N_RESPONSE), see `respond`.
    geometric
        `Tangent`, see `geometric_stiffness`.
    motion
        (n, 3) from where the table was made to where the response belongs.
    force
        (n, 3) filled with the forces there, to first order.
    tangent
        `Tangent`, filled.
    """
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    bent, above, below = geometric.diagonal, geometric.upper, geometric.lower
    for body in range(motion.shape[0]):
        for i in range(3):
            force[body, i] = 0.0
            for j in range(3):
                force[body, i] -= bent[body, i, j] * motion[body, j]
                diagonal[body, i, j] = bent[body, i, j]
    for p in range(pair_a.shape[0]):
        a = pair_a[p]
        b = pair_b[p]
        for i in range(3):
            for j in range(3):
                force[a, i] -= above[p, i, j] * motion[b, j]
                force[b, i] -= below[p, i, j] * motion[a, j]
                upper[p, i, j] = above[p, i, j]
                lower[p, i, j] = below[p, i, j]
    hess = np.zeros((6, 6))
    for c in range(count):
        p = used[c] // 2
        a = pair_a[p]
        b = pair_b[p]
        rn, rt = response[c, RN], response[c, RT]
        kn, kt = table[c, STIFF_N], table[c, STIFF_T]
        nn, nt = kn * response[c, NN], kt * response[c, NT]
        tn, tt = kn * response[c, TN], kt * response[c, TT]
        for i in range(6):
            by_gap = table[c, GAP + i] * nn + table[c, SLIP + i] * tn
            by_slip = table[c, GAP + i] * nt + table[c, SLIP + i] * tt
            for j in range(6):
                hess[i, j] = by_gap * table[c, GAP + j] + by_slip * table[c, MEASURED + j]
        for i in range(3):
            force[a, i] += rn * table[c, GAP + i] + rt * table[c, SLIP + i]
            force[b, i] += rn * table[c, GAP + 3 + i] + rt * table[c, SLIP + 3 + i]
        _add(hess, a, b, p, diagonal, upper, lower)
