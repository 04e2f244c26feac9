"""Limit analysis with associative flow: one program of cones, exact from both sides.

The lower bound theorem: the largest multiplier under which forces within the joints' strength
balance the loads,

    maximise lambda   subject to   B f + G + lambda F = 0,   |t| <= c + mu n,   n >= -f_t

Its dual values are the velocities u of a mechanism, in which every sliding joint opens by mu times
its slip, and whose power balance gives the upper bound

    lambda = (D(u) - G.u) / F.u,      D = sum over contacts of (c + mu l) |v_t| - l v_n

with l the normal force at which a contact opens in tension.  In the plane, t is a number and the
program is linear; in space, the friction cone is round.  Two further programs of the same kind
explain why there is no such multiplier.  One finds the share of the dead load that can be carried;
if it is less than one, the structure does not stand.  The other finds whether forces can carry the
load pattern by itself; then friction locks the structure, and no multiple of the load makes it
collapse.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from drystone.common.arrays import Array
from drystone.limit.cone_program import force_program
from drystone.limit.cones import Regions, least_normal, least_of_growth, shear_strength
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.inside import WHOLE, from_inside
from drystone.limit.program import FAILED, OPTIMAL, UNBOUNDED, Answer, Given

#: Number of contact points from which the interior-point method is tried first, by dimension.  On
#: dry walls it is as fast as the simplex method at 340 points, twice as fast at 550, five times at
#: 1,100.  In space it is always first, because the simplex method cannot treat round cones.
INTERIOR_FROM = {2: 600, 3: 0}
#: A motion that goes less than this share along the load does not go along it.
SLIGHT = 1e-6


def collapse(equilibrium: Equilibrium) -> Answer:
    """The largest multiplier of the load pattern that can be carried with the dead load.

    Unbounded where friction locks the structure.
    """
    large = is_large(equilibrium)
    answer = None
    if large:
        regions = Regions.of(equilibrium)
        answer = from_inside(equilibrium, regions, equilibrium.live, -equilibrium.dead)
    if answer is None and not (large and is_locked(equilibrium)):
        answer = _by_program(equilibrium, equilibrium.live, -equilibrium.dead)
    if answer is None or (answer.status != OPTIMAL and is_locked(equilibrium)):
        return _no_answer(equilibrium, UNBOUNDED)
    return answer if answer.status == OPTIMAL else _no_answer(equilibrium, FAILED)


def dead_load_factor(equilibrium: Equilibrium) -> Answer:
    """How much of the dead load can be carried, at most 1; else the velocities of the fall."""
    zero = np.zeros_like(equilibrium.dead)
    return _strongest(equilibrium, equilibrium.dead, zero)


def fall(equilibrium: Equilibrium) -> Array:
    """Velocities (n_rows,) of a structure that does not stand under its own weight.

    Of all mechanisms with no block faster than one, that on which the dead load does most work:
    what need not fall does not move.  It is the dual of balancing the dead load with as little help
    from outside as possible, a force and a moment on each block.
    """
    from drystone.limit import interior_point  # takes long; what stands does without

    regions = Regions.of(equilibrium)
    n_amounts, n_rows = regions.combination.shape[1], len(equilibrium.dead)
    n_shared, n_blocks = regions.sharing.shape[0], equilibrium.assembly.n_blocks
    of_blocks = np.arange(n_rows - equilibrium.n_beside)
    dim, row = equilibrium.points.dimension, of_blocks.reshape(n_blocks, -1)
    help_, columns, cones = [], 0, []
    for part in (row[:, :dim], row[:, dim:]):  # the size of a force or moment, then itself
        size = part.shape[1]
        column = columns + (1 + size) * np.arange(n_blocks)[:, None] + 1 + np.arange(size)
        help_.append((part.ravel(), column.ravel()))
        columns += (1 + size) * n_blocks
        cones.append((n_blocks, 1 + size))
    at = tuple(np.concatenate(places) for places in zip(*help_, strict=True))
    identity = csc_array((np.ones(len(at[0])), at), shape=(n_rows, columns))
    matrix = vstack(
        [
            hstack([equilibrium.matrix @ regions.combination, identity]),
            hstack([regions.sharing, csc_array((n_shared, columns))]),
        ]
    )
    bound = np.concatenate(
        (-equilibrium.dead - equilibrium.matrix @ regions.fixed, np.ones(n_shared))
    )
    cost = np.zeros(n_amounts + columns)
    sizes = np.setdiff1d(np.arange(columns), at[1])
    cost[n_amounts + sizes] = 1.0
    none = np.zeros(0, np.int64)
    cones = [*regions.cones, *cones]
    return -interior_point.solve(cost, csc_array(matrix), bound, none, cones=cones).y[:n_rows]


def stands(equilibrium: Equilibrium) -> bool:
    """Whether the structure carries its own weight."""
    return is_whole(dead_load_factor(equilibrium))


def is_locked(equilibrium: Equilibrium, *, friction: bool = True) -> bool:
    """Whether contact forces without any strength but friction carry the pattern by itself.

    Without ``friction`` pushing has to do: then nothing can move along the load, whatever joints
    slide.
    """
    if not friction:
        smooth = replace(equilibrium.points, friction=np.zeros(equilibrium.n_contacts))
        equilibrium = replace(equilibrium, points=smooth)
    zero = np.zeros_like(equilibrium.dead)
    return is_whole(_strongest(equilibrium, equilibrium.live, zero, recession=True))


def slides_away(equilibrium: Equilibrium, direction: Array) -> bool:
    """Whether the blocks can leave their supports as one body, along a load of that direction.

    A mechanism that opens every joint by more than its friction wants, found without a linear
    program: the structure is not locked.  False says nothing.
    """
    assembly, points = equilibrium.assembly, equilibrium.points
    joined = slice(equilibrium.n_joined)  # ties are no hindrance to a load of any size
    held = assembly.restrained[~assembly.fixed, : assembly.dimension].any(axis=0)
    side = np.where(assembly.fixed[points.block_a[joined]], 1.0, 0.0)
    side -= np.where(assembly.fixed[points.block_b[joined]], 1.0, 0.0)
    borne = np.flatnonzero(side)
    away = side[borne, None, None] * points.frame[borne]
    upward = away[:, 0].mean(axis=0) if len(borne) else np.zeros_like(direction)
    for share in (0.0, 0.5, 1.0, 2.0, 4.0):
        motion = direction + share * upward
        opening, slip = away[:, 0] @ motion, np.linalg.norm(away[:, 1:] @ motion, axis=1)
        free = np.all(opening >= points.friction[borne] * slip)
        if np.any(np.abs(motion[held]) > SLIGHT):  # rollers are
            continue
        if free and direction @ motion > SLIGHT:
            return True
    return False


def upper_bound(equilibrium: Equilibrium, velocity: Array) -> float:
    """Multiplier of a mechanism by its balance of power, (D - G.u) / F.u."""
    relative = equilibrium.relative(velocity)
    low = least_normal(equilibrium)
    strength = shear_strength(equilibrium, low)
    dissipated = float(strength @ equilibrium.slip(relative) - low @ relative[:, 0])
    dead, live = float(equilibrium.dead @ velocity), float(equilibrium.live @ velocity)
    return (dissipated - dead) / live


def flow_violation(equilibrium: Equilibrium, velocity: Array, tangent: Array) -> float:
    """Largest amount by which contacts close, or open less than ``tangent`` times their slip.

    Over the largest relative velocity of all contacts.
    """
    relative = equilibrium.relative(velocity)
    largest = float(np.abs(relative).max(initial=0.0))
    missing = float((tangent * equilibrium.slip(relative) - relative[:, 0]).max(initial=0.0))
    return missing / largest if largest > 0.0 else 0.0


def is_whole(answer: Answer) -> bool:
    """Whether all of what was asked for is carried."""
    return answer.status == OPTIMAL and answer.factor >= 1.0 - WHOLE


def _no_answer(equilibrium: Equilibrium, status: str) -> Answer:
    return Answer(
        status=status,
        factor=np.inf if status == UNBOUNDED else np.nan,
        forces=np.zeros((equilibrium.n_contacts, equilibrium.points.dimension)),
        velocity=np.zeros_like(equilibrium.dead),
        n_iterations=0,
    )


def _strongest(
    equilibrium: Equilibrium, column: Array, right: Array, *, recession: bool = False
) -> Answer:
    """Maximise s, at most 1, with B f + s column = right and the strength of the contacts."""
    if is_large(equilibrium):
        regions = Regions.of(equilibrium, recession=recession)
        answer = from_inside(equilibrium, regions, column, right, largest=1.0)
        if answer is not None:
            return answer
    return _by_program(equilibrium, column, right, largest=1.0, recession=recession)


def is_large(equilibrium: Equilibrium) -> bool:
    """Whether methods from within are asked first, here and by the non-associative flow."""
    return equilibrium.n_contacts >= INTERIOR_FROM[equilibrium.points.dimension]


def _by_program(
    equilibrium: Equilibrium,
    column: Array,
    right: Array,
    *,
    largest: float = np.inf,
    recession: bool = False,
) -> Answer:
    given = Given(
        column=column,
        right=right,
        slope=equilibrium.points.friction,
        least=least_of_growth(equilibrium) if recession else least_normal(equilibrium),
        largest=largest,
    )
    program = force_program(equilibrium, given)
    nothing = np.zeros(equilibrium.n_contacts)
    program.limit_shear(nothing if recession else equilibrium.cohesion)
    return program.solve()
