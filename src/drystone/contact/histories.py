"""The history of contacts, and how contacts that are found anew inherit it.  All engines use it."""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.contact import measures
from drystone.contact.contacts import FIRST, PART_A, PART_B, Pairs, Slots
from drystone.contact.detection import NarrowPhase
from drystone.law.branches import OPEN
from drystone.law.columns import BROKEN, DILATION, SHEAR

Number = TypeVar("Number", np.float64, np.int64, np.bool_)


class Histories(NamedTuple):
    """Histories, reactions and branches of all slots of one list of pairs, and their origin."""

    slots: Slots
    history: Array  # (n_slots, N_HISTORY + dim - 2); no columns if an engine keeps no history
    reaction: Array  # (n_slots, dim) N
    branch: IntArray  # (n_slots,) of the joint law, or a status
    source: IntArray  # (n_slots,) former slot that each one inherits from; -1 if it is new

    @classmethod
    def own(cls, slots: Slots, history: Array, reaction: Array, branch: IntArray) -> Histories:
        """Histories of contacts that are their own source."""
        # Contiguous, like all later arrays, because kernels are compiled for each memory layout.
        whole = np.ascontiguousarray(reaction)
        return cls(slots, history, whole, branch, np.arange(len(branch)))

    def of(
        self, values: NDArray[Number], otherwise: float | NDArray[Number] = 0
    ) -> NDArray[Number]:
        """Values (n_slots, ...) of the contacts, inherited from ``values`` (n_before, ...) of the
        former slots; new contacts get ``otherwise``."""
        new = np.flatnonzero(self.source < 0)
        if len(new) == len(self.source):  # also if there are no former slots
            after = np.empty((len(new), *values.shape[1:]), values.dtype)
        else:
            after = values.take(self.source, axis=0)
        after[new] = otherwise[new] if isinstance(otherwise, np.ndarray) else otherwise
        return after

    def lost(self, before: Histories) -> float:
        """Sum of the sizes of shear reactions of ``before`` that no contact inherits [N]."""
        shear = np.ascontiguousarray(before.history[:, SHEAR:])
        return float(measures.left_behind(self.source, shear))


def handed_on(
    narrow: NarrowPhase,
    past: Histories,
    pairs: Pairs,
    now: Slots | None = None,
    *,
    known: Slots | None = None,
    former: Pairs | None = None,
    bears: Array | None = None,
) -> Histories:
    """What contacts inherit from the ``past``.  Past and present contacts are in the same poses.

    Parameters
    ----------
    past
        Histories of the former contacts; reactions are along the tangents of its slots.
    pairs
        Pairs of the contacts that inherit.
    now
        The contacts that inherit, found anew.  Each inherits from one of the same pair, see
        `NarrowPhase`; its tangential reactions are along the new tangents.
    known
        The features of the former contacts, if not those of the slots of ``past``.
    former
        Instead of ``now``: the list of pairs of the ``past``.  Contacts then stay as they are, and
        those of pairs that are not in ``pairs`` are dropped.
    bears
        Closure at which joints of each law are crushed, (n_laws,) [m]; None if no joint is crushed.

    New contacts are open, have neither shear nor dilation, and are not bonded.  If blocks have
    moved into a joint with other features, a new contact may lie deeper than the joint can bear.
    It is crushed by the difference.
    """
    if former is not None:
        source = predecessor_slots(former, pairs)
        slots = past.slots.at(source)
    else:
        assert now is not None
        source, slots = narrow.predecessors(pairs, known or past.slots, now), now
    n, columns = len(source), past.history.shape[1]
    history, reaction = np.empty((n, columns)), np.empty((n, past.reaction.shape[1]))
    branch, origin = np.empty(n, np.int64), np.empty(n, np.int64)
    heirs = Histories(slots, history, reaction, branch, origin)
    _inherit(source, past[1:], heirs[1:])
    if former is None:
        if columns:
            narrow.rotate_shear(
                past.slots, slots, source, past.history[:, SHEAR:], history[:, SHEAR:]
            )
        narrow.rotate_shear(past.slots, slots, source, past.reaction[:, 1:], reaction[:, 1:])
    if bears is not None:
        beyond = slots.gap + bears[pairs.law_of_slot]
        deeper = (source < 0) & (beyond < 0.0)
        history[deeper, DILATION] = beyond[deeper]
    return heirs


@njit(cache=True, error_model="numpy")
def _inherit(source, past, heirs):
    """Fill all fields of `Histories` but the slots, from the sources (n_slots,)."""
    history, reaction, branch, origin = past
    new_history, new_reaction, new_branch, new_origin = heirs
    for k in range(source.shape[0]):
        j = source[k]
        for i in range(history.shape[1]):
            new_history[k, i] = history[j, i] if j >= 0 else 0.0
        if j < 0 and history.shape[1] > 0:
            new_history[k, BROKEN] = 1.0
        for i in range(reaction.shape[1]):
            new_reaction[k, i] = reaction[j, i] if j >= 0 else 0.0
        new_branch[k] = branch[j] if j >= 0 else OPEN
        new_origin[k] = origin[j] if j >= 0 else -1


def predecessor_pairs(previous: Pairs, current: Pairs) -> IntArray:
    """Row of each current pair in the previous list, or -1, (n_pairs,)."""
    n = int(max(pairs.which[:, PART_B].max(initial=0) for pairs in (previous, current))) + 1
    old, new = (p.which[:, PART_A] * n + p.which[:, PART_B] for p in (previous, current))
    if len(old) == 0:
        return np.full(len(new), -1, np.int64)
    row = np.minimum(np.searchsorted(old, new), len(old) - 1)
    return np.where(old[row] == new, row, -1).astype(np.int64)


def predecessor_slots(previous: Pairs, current: Pairs) -> IntArray:
    """Slot of each current slot in the previous list, or -1, (n_slots,)."""
    if previous.n_pairs == 0:
        return np.full(current.n_slots, -1, np.int64)
    row = predecessor_pairs(previous, current)
    later = previous.which[row, FIRST] - current.which[:, FIRST]
    of_slot = current.of_slot
    return np.where(row[of_slot] >= 0, np.arange(len(of_slot)) + later[of_slot], -1)
