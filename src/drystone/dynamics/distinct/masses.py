"""Masses of explicit cycles, and the time step for which they are stable.

The energy k (h_a.x_a + h_b.x_b)^2 of a contact is at most 2 k (h_a.x_a)^2 + 2 k (h_b.x_b)^2.  Let
B = 2 sum k h h^T over the contacts of one block.  Then no frequency of the assembly is above
omega^2 = max eig(M^-1/2 B M^-1/2), the maximum over all blocks.  Undamped cycles are stable for
dt < 2 / omega.  If a velocity changes its sign at every cycle, local damping alpha makes every
force (1 + alpha) times as large, so that

    dt < 2 / (omega sqrt(1 + alpha))

A block that meets another and leaves it within one cycle gains energy if dt > sqrt(2) / omega.  So
undamped motion with impacts needs a safety factor below 0.7.
"""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import FREE_TIME_STEP, LEAST_STIFFNESS, TINY, WATCHED, WATCHED_REACH
from drystone.contact.contacts import Pairs, Slots
from drystone.dynamics import explicit
from drystone.dynamics.distinct.state import DistinctPrepared, DistinctSettings
from drystone.engines.tie_forces import TieForces
from drystone.law.columns import BROKEN, COHESION, COHESIVE, DILATION, PULLS, TENSION


def search_reach(settings: DistinctSettings, prepared: DistinctPrepared) -> float:
    """Largest motion of a block between two searches [m]."""
    return settings.search_tolerance * prepared.assembly.smallest_extent


def masses(
    settings: DistinctSettings,
    prepared: DistinctPrepared,
    pairs: Pairs,
    slots: Slots,
    pose: Array,
    history: Array,
    *,
    real: bool,
    ties: TieForces | None = None,
) -> tuple[Array, float]:
    """Masses (n, n_dof) and the stable time step [s] for them, for slots in a pose.

    Open contacts count if they may close before the next search.  Contacts whose bond is not lost
    always count, because they pull with k_n and stick with k_s, however far they have opened.
    """
    assembly, s = prepared.assembly, settings
    blocks = np.zeros((assembly.n_bodies, assembly.n_dof, assembly.n_dof))
    contacts = prepared.detector.pack(pairs, pose, slots, prepared.laws)
    between = max(search_reach(s, prepared), WATCHED * assembly.smallest_extent)
    watched = np.inf if real else WATCHED_REACH * between
    known = history[contacts.slot]
    away = slots.gap[contacts.slot] - known[:, DILATION]
    acts = (away <= watched) | _bonded(prepared, pairs.law_of_slot[contacts.slot], known)
    explicit.stiffness_blocks(prepared.dof, contacts, acts, blocks)
    touched = np.einsum("nii->ni", blocks).any(axis=1) & ~assembly.fixed
    if ties is not None and prepared.bars.n_ties:
        ties.act(pose)
        ties.add_twice(blocks)
    blocks *= 0.25 * (1.0 + s.local_damping) / s.safety**2
    scaling = s.mass_scaling or (1.0 if real else np.inf)
    needed = _needed(blocks, assembly.fixed, touched)
    if needed is None:
        return assembly.mass, FREE_TIME_STEP
    if np.isinf(scaling):
        return needed, 1.0
    highest = _highest(blocks, assembly.mass)[~assembly.fixed].max()
    dt = float(np.sqrt(scaling / highest))
    if scaling == 1.0:
        return assembly.mass, dt
    return np.maximum(assembly.mass, needed * dt**2), dt


def _bonded(prepared: DistinctPrepared, law: IntArray, history: Array) -> BoolArray:
    """Contacts (n,) whose bond is not lost, from their laws (n,) and their histories."""
    strengths = [COHESION, TENSION, COHESIVE, PULLS]
    has_bond = np.asarray((prepared.laws[:, strengths] > 0.0).any(axis=1))
    return np.asarray(has_bond[law] & (history[:, BROKEN] == 0.0))


def _needed(blocks: Array, fixed: BoolArray, touched: BoolArray) -> Array | None:
    """Masses (n, n_dof) for which a time step of one is stable; None if no block has stiffness.

    A block that is not ``touched`` (n,) by another gets the largest mass.  So it falls, or swings
    on its tie, as slowly as the stiffest block moves, and is stopped where it lands.
    """
    stiffness = np.einsum("nii->ni", blocks)
    held = stiffness.any(axis=1) & ~fixed
    if not held.any():
        return None
    needed = np.maximum(stiffness, LEAST_STIFFNESS * stiffness[~fixed].max(axis=0) + TINY)
    needed *= _highest(blocks, needed)[:, None]
    needed[~touched] = needed[held].max(axis=0)
    return np.asarray(needed, dtype=np.float64)


def _highest(blocks: Array, mass: Array) -> Array:
    """Highest eigenvalue of M^-1/2 B M^-1/2 of each block, (n,) [1/s2]."""
    root = 1.0 / np.sqrt(mass)
    values = np.linalg.eigvalsh(blocks * root[:, :, None] * root[:, None, :])
    return np.asarray(values[:, -1], dtype=np.float64)
