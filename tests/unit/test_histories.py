"""What contacts bring along, to contacts found anew and to another list of pairs."""

from __future__ import annotations

import numpy as np
import pytest

from builders import contacts_of
from drystone.contact.histories import Histories, handed_on
from drystone.law.branches import OPEN, STICKING
from drystone.law.columns import BROKEN, SHEAR
from drystone.model.builders import published_wall

pytestmark = pytest.mark.kernels


def of_wall(pose=None):
    """Detector, pairs and slots of a published wall, and a past without two like values."""
    wall = published_wall(3).assembly
    detector, pairs, slots = contacts_of(wall, wall.design_pose() if pose is None else pose)
    n = len(slots.kind)
    past = Histories.own(
        slots,
        np.arange(1.0, 6.0 * n + 1.0).reshape(n, 6),
        -np.arange(1.0, 2.0 * n + 1.0).reshape(n, 2),
        np.full(n, STICKING),
    )
    return wall, detector, pairs, slots, past


def test_contacts_found_again_have_all_that_they_had():
    _, detector, pairs, slots, past = of_wall()
    used = slots.kind > 0
    heirs = handed_on(detector.narrow, past, pairs, slots)
    assert np.array_equal(heirs.source[used], np.flatnonzero(used))
    for had, has in zip(
        (past.history, past.reaction, past.branch),
        (heirs.history, heirs.reaction, heirs.branch),
        strict=True,
    ):
        assert np.array_equal(has[used], had[used])
    assert heirs.lost(past) == pytest.approx(past.history[~used, SHEAR].sum(), rel=1e-12)


def test_new_contacts_are_open_without_shear_and_not_bonded():
    _, detector, pairs, slots, past = of_wall()
    known = slots.copied()
    known.which[::3] = 0  # nothing met there
    heirs = handed_on(detector.narrow, past, pairs, slots, known=known)
    new = heirs.source < 0
    assert new[::3].any() and not new.all()
    assert (heirs.history[new, BROKEN] == 1.0).all()
    assert not np.delete(heirs.history[new], BROKEN, axis=1).any()
    assert not heirs.reaction[new].any() and (heirs.branch[new] == OPEN).all()
    assert (heirs.of(np.ones(len(new)), np.inf)[new] == np.inf).all()


def test_another_list_of_pairs_keeps_what_its_contacts_had_and_where_they_had_it():
    wall, detector, pairs, _, past = of_wall()
    departed = np.zeros(wall.n_bodies, bool)
    departed[wall.n_bodies // 2] = True
    fewer = detector.pairs(wall.design_pose(), departed)
    heirs = handed_on(detector.narrow, past, fewer, former=pairs)
    assert 0 < len(heirs.source) < len(past.source)
    assert np.array_equal(heirs.history, past.history[heirs.source])
    assert np.array_equal(heirs.slots.value, past.slots.value[heirs.source])
    back = handed_on(detector.narrow, heirs, pairs, former=fewer)
    new = back.source < 0
    assert new.any() and (back.history[new, BROKEN] == 1.0).all()
    assert np.array_equal(back.source[~new], past.source[~new])  # as numbered at first
    assert np.array_equal(back.reaction[~new], past.reaction[~new])
