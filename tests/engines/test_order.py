"""The same structure with its blocks listed in another order: the same curve, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from drystone.model.construction.vary import remade
from drystone.model.ties import Tie, TieEnd
from random_solids import random_solids
from structures import structure


def shuffled(model, seed):
    """The model with its blocks in another order."""
    blocks = model.assembly.blocks
    order = np.random.default_rng(seed).permutation(len(blocks))
    assert (np.diff(order) != 1).any()
    return remade(model, blocks=tuple(blocks[i] for i in order))


def told(event):
    """What an event says; its blocks stand in the order of the drawing."""
    return {**event.as_dict(), "blocks": set(event.blocks)}


def same(model, other, **options):
    """Both curves; poses and contacts of the same blocks are compared by their names."""
    one = ds.pushover(model, keep_poses=True, keep_contacts=True, **options)
    two = ds.pushover(other, keep_poses=True, keep_contacts=True, **options)
    assert np.array_equal(one.load_multiplier, two.load_multiplier)
    assert np.array_equal(one.control_displacement, two.control_displacement)
    rows = [other.assembly.index(name) for name in model.assembly.ids]
    assert np.array_equal(one.poses, two.poses[:, rows])
    assert [told(event) for event in one.events] == [told(event) for event in two.events]
    back = np.argsort(rows)
    for a, b in zip(one.contacts, two.contacts, strict=True):
        assert np.array_equal(a.block_a, back[b.block_a])
        assert np.array_equal(a.block_b, back[b.block_b])
        assert np.array_equal(a.normal_reaction, b.normal_reaction)
    return one


@pytest.mark.parametrize("seed", [1, 3, 5, 8])
def test_in_the_plane(seed):
    model = remade(structure(seed))
    same(model, shuffled(model, seed), max_steps=120)


@pytest.mark.parametrize("seed", [0, 3, 5, 6])
def test_in_space(seed):
    model = remade(random_solids(seed))
    same(model, shuffled(model, seed), max_steps=60)


@pytest.mark.parametrize("engine", ["nscd", "distinct"])
def test_other_engines(engine):
    model = remade(structure(3))
    same(model, shuffled(model, 3), engine=engine, max_steps=12)


def test_with_ties_and_a_block_that_is_watched():
    """Ties and the control point go by the names of blocks."""
    wall = structure(5)
    ids, fixed = wall.assembly.ids, wall.assembly.fixed
    low, high = ids[int(np.flatnonzero(fixed)[0])], ids[wall.control_point.block]
    ends = [
        TieEnd(block=name, point=wall.assembly.centroid[wall.assembly.index(name)])
        for name in (low, high)
    ]
    tie = Tie(start=ends[0], end=ends[1], stiffness=1e6, yield_force=1e4, compression=False)
    tied = remade(wall, ties=(tie,))
    curve = same(tied, shuffled(tied, 5), max_steps=40)
    assert curve.ties is not None and np.abs(curve.ties.force).max() > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(25))
@pytest.mark.parametrize("made", [structure, random_solids])
def test_fifty_structures(made, seed):
    model = remade(made(seed))
    try:
        same(model, shuffled(model, seed), max_steps=400)
    except ds.UnstableError:
        pytest.skip("it does not stand")
