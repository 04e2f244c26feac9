"""Blocks of several convex parts: contact is between parts, while the block moves as one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import contacts_of, stack
from drystone.analysis.driver import pushover
from drystone.contact.contacts import PART_A, PART_B
from drystone.contact.histories import predecessor_slots
from drystone.linear import numeric as lu_numeric
from drystone.linear import symbolic as lu_symbolic
from drystone.model.assembly import Assembly, Shapes
from drystone.model.model import Model


def halved(assembly: Assembly) -> Assembly:
    """The same rectangles, each as two parts that meet in a vertical seam."""
    parts = []
    for i in range(assembly.n_bodies):
        (x0, y0), (x1, y1) = assembly.shapes.of(i).min(axis=0), assembly.shapes.of(i).max(axis=0)
        middle = 0.5 * (x0 + x1)
        parts += [
            np.array([(a, y0), (b, y0), (b, y1), (a, y1)]) for a, b in ((x0, middle), (middle, x1))
        ]
    cut = replace(assembly)
    shapes = Shapes(
        body=np.repeat(np.arange(assembly.n_bodies), 2),
        offset=np.arange(0, 4 * len(parts) + 1, 4),
        vertices=np.vstack(parts),
        setback=np.zeros((4 * len(parts), 2)),
        radius=np.zeros(len(parts)),
        faces=None,
    )
    cut._derive(shapes=shapes)
    return cut


def tower(*, cut: bool) -> Model:
    """Three slender blocks on each other, of stiff joints."""
    model = stack((0.4, 0.5), (0.4, 0.5), (0.4, 0.5))
    return replace(model, assembly=halved(model.assembly)) if cut else model


def test_seams_are_no_contacts():
    assembly = tower(cut=True).assembly
    _, pairs, slots = contacts_of(assembly, assembly.design_pose())
    assert (pairs.a != pairs.b).all()
    assert (pairs.which[:, PART_A] != pairs.which[:, PART_B]).all()
    touching = (slots.kind > 0) & (np.abs(slots.gap) < 1e-12)
    # Of each joint two halves, with two points each; halves across meet in a corner.
    facing = np.abs(pairs.which[:, PART_B] - pairs.which[:, PART_A])[pairs.of_slot] % 2 == 0
    assert np.count_nonzero(touching & facing) == 4 * (assembly.n_bodies - 1)
    lengths = slots.size[touching & facing]
    assert lengths == pytest.approx(np.full(len(lengths), 0.1))


def test_histories_follow_parts():
    assembly = tower(cut=True).assembly
    detector, pairs, slots = contacts_of(assembly, assembly.design_pose())
    again = detector.pairs(assembly.design_pose())
    assert predecessor_slots(pairs, again).tolist() == list(range(len(slots.kind)))


@pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
def test_what_is_cut_rocks_as_in_one_piece(engine):
    """The joint's ends are what it turns about, and they are the same."""
    whole, cut = (pushover(tower(cut=c), engine=engine) for c in (False, True))
    assert cut.status == whole.status == "finished"
    peaks = cut.peak.load_multiplier, whole.peak.load_multiplier
    assert peaks[0] == pytest.approx(peaks[1], rel=2e-3)
    assert cut.ultimate_displacement == pytest.approx(whole.ultimate_displacement, rel=5e-3)


def test_pairs_of_the_same_bodies_add_up_in_the_matrix():
    random = np.random.default_rng(2)
    n, a, b = 4, np.array([0, 1, 1, 2, 0]), np.array([1, 2, 2, 3, 1])
    diagonal = random.normal(size=(n, 3, 3)) + 20.0 * np.eye(3)
    upper, lower = random.normal(size=(2, len(a), 3, 3))
    fixed = np.array([False, False, False, True])
    structure = lu_symbolic.analyse(a, b, fixed, random.normal(size=(n, 2)), 3)
    factors = lu_numeric.allocate(structure)
    nothing = np.zeros(n)
    lu_numeric.factorise(structure, diagonal, upper, lower, factors, np.ones((n, 3)), nothing, 0.0)
    dense = np.zeros((n, 3, n, 3))
    dense[np.arange(n), :, np.arange(n)] = diagonal
    for p, (i, j) in enumerate(zip(a, b, strict=True)):
        dense[i, :, j] += upper[p]
        dense[j, :, i] += lower[p]
    free = np.repeat(~fixed, 3)
    matrix = dense.reshape(3 * n, 3 * n)[np.ix_(free, free)]
    right = np.where(fixed[:, None], 0.0, random.normal(size=(n, 3)))
    field = right[None].copy()
    lu_numeric.solve(structure, factors, field)
    assert field.ravel()[free] == pytest.approx(np.linalg.solve(matrix, right.ravel()[free]))
