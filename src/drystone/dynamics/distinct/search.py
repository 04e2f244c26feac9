"""Search for contacts between cycles, with the inheritance of histories; blocks that leave."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array
from drystone.common.tolerances import WATCHED
from drystone.contact.contacts import EDGE_A, EDGE_B, NONE, Pairs, Slots
from drystone.contact.histories import Histories, handed_on
from drystone.dynamics.distinct.state import DistinctPrepared, RunAwayError
from drystone.dynamics.distinct.workspace import Workspace
from drystone.engines.departure import departing
from drystone.engines.measures import LoadArrays
from drystone.law.columns import BROKEN, DILATION, KN, KS, SHEAR, TENSION


def search(work: Workspace) -> None:
    """Find all contacts anew; contacts that persist keep their history."""
    prepared, pose = work.prepared, work.motion.pose
    detector = prepared.detector
    work.unpack()
    if work.real_masses:
        work.search_work += elastic_energy(prepared, work.pairs, work.slots, work.history)
    if detector.outdated(work.pairs.pose, pose):
        _new_pairs(work, detector.pairs(pose, work.lost))
    old, slots = work.slots, detector.find(work.pairs, pose, work.slots)
    past = _past(work)
    heirs = handed_on(detector.narrow, past, work.pairs, slots, bears=prepared.strengths.bears)
    work.lost_shear += heirs.lost(past)
    work.slots, work.history, work.searched = slots, heirs.history, pose.copy()
    if work.real_masses:
        work.search_work -= elastic_energy(prepared, work.pairs, slots, heirs.history)
    work.n_searches += 1
    same = np.array_equal(old.feature, slots.feature) and np.array_equal(old.kind, slots.kind)
    since = prepared.assembly.difference(pose, work.weighed)
    moved = detector.farthest(since) > WATCHED * prepared.assembly.smallest_extent
    work.pack(weigh=moved or not same)


def drop_departed(work: Workspace) -> None:
    """Take out blocks that have left the structure; forces on the others do not change.

    Raises `RunAwayError` if the load acts on nothing that is left.
    """
    prepared, pose = work.prepared, work.motion.pose
    work.unpack()
    left = departing(
        prepared.problem, prepared.detector, work.acting, pose, work.multiplier, work.pairs,
        work.slots, work.reaction, prepared.bars.whole(work.ties.ended()),
    )  # fmt: skip
    lost = work.lost | left
    if not left.any() or (lost | prepared.assembly.fixed).all():
        return  # if no block is left, the run ends elsewhere
    acting = LoadArrays.of(prepared.problem, lost, work.state.stage)
    if work.acting.pattern.any() and not acting.pattern.any():
        raise RunAwayError(prepared.assembly.ids[int(np.argmax(left))], work.travel())
    work.lost = lost
    work.ties.lose(lost)
    work.acting = acting
    motion = work.motion
    for array in (motion.velocity, motion.force, motion.mean, motion.opposed):
        array[left] = 0.0
    _new_pairs(work, prepared.detector.pairs(pose, lost))
    work.pack(weigh=True)


def _new_pairs(work: Workspace, pairs: Pairs) -> None:
    """Change to another list of pairs, with the slots and histories of pairs that persist."""
    heirs = handed_on(work.prepared.detector.narrow, _past(work), pairs, former=work.pairs)
    work.pairs, work.slots, work.history = pairs, heirs.slots, heirs.history
    work.reaction, work.status = heirs.reaction, heirs.branch


def _past(work: Workspace) -> Histories:
    return Histories.own(work.slots, work.history, work.reaction, work.status)


def others_separate(work: Workspace) -> bool:
    """Whether blocks that press each other would do so on other faces if contacts were searched
    now.

    Faces of several directions separate blocks that meet in an edge or a corner equally well.  So
    another face may be the best after a motion far smaller than that between two searches.
    """
    work.unpack()
    now = work.prepared.detector.find(work.pairs, work.motion.pose, work.slots)
    pair, n_pairs = work.pairs.of_slot, len(work.pairs.which)
    faces = [EDGE_A, EDGE_B]
    presses = np.flatnonzero((work.slots.kind != NONE) & (work.reaction[:, 0] > 0.0))
    used = np.flatnonzero(now.kind != NONE)
    first = np.full(n_pairs, -1, np.int64)
    first[pair[used]] = used
    then = first[pair[presses]]
    same = (work.slots.which[presses][:, faces] == now.which[then][:, faces]).all(axis=1)
    return not bool((same & (then >= 0)).all())


def elastic_energy(prepared: DistinctPrepared, pairs: Pairs, slots: Slots, history: Array) -> float:
    """Elastic energy of the joints [J]."""
    law = prepared.laws[pairs.law_of_slot]
    area = slots.size * prepared.assembly.thickness
    overlap = history[:, DILATION] - slots.gap
    bonded = (history[:, BROKEN] == 0.0) & (law[:, TENSION] > 0.0)
    used = (slots.kind != NONE) & ((overlap > 0.0) | bonded)
    normal = law[used, KN] * area[used] * overlap[used] ** 2
    shear = np.sum(history[used, SHEAR:] ** 2, axis=1)
    shear /= law[used, KS] * area[used]
    return 0.5 * float(np.sum(normal + shear))
