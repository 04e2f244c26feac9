"""Outlines as they were drawn: turned round, straightened, and joints closed that nearly are."""

from dataclasses import replace

import numpy as np
import pytest

import drystone as ds
from builders import UNIT_WEIGHT, rectangle, stack, stiff_joint, turned
from drystone.geometry.space.solid import Part
from drystone.limit import collapse_load
from drystone.model.assembly import Block
from drystone.model.builders import ModelError, circular_arch, make_model

#: Of coordinates of metres that were computed along two ways.
ROUNDING = 1e-12
#: The walls' smallest edge is 0.175 m: gaps up to 0.175 mm are closed.
HAIR = 0.5e-4


def made(blocks, **options):
    return make_model(
        blocks, joint=stiff_joint(0.6), thickness=1.0, load_direction=(1.0, 0.0), **options
    )


def drawn(number, seed, tilt=0.0, origin=(0.0, 0.0)):
    """Blocks of a published wall, each drawn a hair beside its place; the base is where it is."""
    rng = np.random.default_rng(seed)
    return [
        replace(
            block,
            vertices=turned(block.vertices, tilt)
            + origin
            + (0.0 if block.support else rng.uniform(-HAIR, HAIR, 2)),
        )
        for block in ds.published_wall(number).assembly.blocks
    ]


def misfits(model):
    """Overlap (negative: gap) of all blocks that lie near each other."""
    outlines = model.assembly.outlines
    a, b = outlines.near_pairs()
    depth = outlines.overlap_depths(a, b)
    return depth[depth > -10.0 * HAIR]


@pytest.mark.parametrize("number", [1, 2, 3])
def test_what_fits_stays_to_the_last_bit(number):
    exact = ds.published_wall(number)
    assert exact.notes == ()
    for tilt in (0.0, 0.3):
        blocks = [
            replace(block, vertices=turned(block.vertices, tilt)) for block in exact.assembly.blocks
        ]
        model = made(blocks)
        assert model.notes == ()
        for block, kept in zip(blocks, model.assembly.blocks, strict=True):
            np.testing.assert_array_equal(block.vertices, kept.vertices)


@pytest.mark.parametrize("number", [1, 3])
@pytest.mark.parametrize(("tilt", "origin"), [(0.0, (0.0, 0.0)), (0.2, (1e3, -1e3))])
def test_a_wall_drawn_by_hand_fits(number, tilt, origin):
    blocks = drawn(number, seed=number, tilt=tilt, origin=origin)
    model = made(blocks)
    exact = ds.published_wall(number).assembly
    assert np.abs(misfits(model)).max() < ROUNDING * (1.0 + np.hypot(*origin))
    assert len(misfits(model)) == len(misfits(ds.published_wall(number)))
    np.testing.assert_array_equal(model.assembly.blocks[0].vertices, blocks[0].vertices)
    for block, wanted in zip(model.assembly.blocks, exact.blocks, strict=True):
        # No further from where they should be than they were drawn, and the line of a course is
        # the mean of its blocks.
        ideal = turned(wanted.vertices, tilt) + origin
        assert np.abs(block.vertices - ideal).max() < 2.0 * HAIR
    (note,) = model.notes
    assert "to close them" in note and "drawing_tolerance" in note


def test_what_was_drawn_by_hand_carries_the_same():
    exact = made(ds.published_wall(1).assembly.blocks)
    model = made(drawn(1, seed=1))
    flow = "associative"
    # Arms of 0.2 m that are off by up to 0.1 mm.
    assert collapse_load(model, flow=flow).load_multiplier == pytest.approx(
        collapse_load(exact, flow=flow).load_multiplier, rel=1e-3
    )


def test_clockwise_outlines_are_turned_round():
    blocks = ds.published_wall(1).assembly.blocks
    wrong = [
        replace(block, vertices=block.vertices[::-1].copy()) if i in (3, 7) else block
        for i, block in enumerate(blocks)
    ]
    model = made(wrong)
    assert model.notes == (
        f'block: 2 outlines ran clockwise and were turned round: "{blocks[3].id}", '
        f'"{blocks[7].id}"',
    )
    np.testing.assert_array_equal(model.assembly.blocks[3].vertices, blocks[3].vertices)


def with_vertex_amid(vertices, edge, off=0.0):
    """An outline with a vertex in the middle of an edge, outwards of it by ``off`` [m]."""
    along = np.roll(vertices, -1, axis=0)[edge] - vertices[edge]
    outwards = np.array([along[1], -along[0]]) / np.hypot(*along)
    return np.insert(vertices, edge + 1, vertices[edge] + 0.5 * along + off * outwards, axis=0)


def stacked(edge=None, off=0.0, parts=False):
    """Three blocks on a base, the second with a vertex amid one of its edges."""
    blocks = list(stack((0.6, 0.3), (0.6, 0.3), (0.6, 0.3)).assembly.blocks)
    if edge is not None:
        outline = with_vertex_amid(blocks[2].vertices, edge, off)
        part = (Part(outline),) if parts else ()
        blocks[2] = replace(blocks[2], vertices=outline, parts=part)
    return blocks


@pytest.mark.parametrize("parts", [False, True])
@pytest.mark.parametrize("edge", [0, 1, 2, 3])
def test_vertices_amid_straight_edges_are_left_out(edge, parts):
    """The curve is the same to the last bit; where half an edge made the joint, nothing stood."""
    model, without = made(stacked(edge, parts=parts)), made(stacked())
    assert model.notes == ('block: 1 vertex amid a straight edge was left out: "b2"',)
    curve, known = ds.pushover(model), ds.pushover(without)
    np.testing.assert_array_equal(curve.load_multiplier, known.load_multiplier)
    np.testing.assert_array_equal(curve.control_displacement, known.control_displacement)


def test_a_vertex_stays_where_the_outline_bends():
    """Solids' faces may be off by 1e-6 of the size, here 0.6 um."""
    straight = made(stacked(2, off=-5e-7)).assembly.blocks[2].vertices
    bent = made(stacked(2, off=-7e-7), drawing_tolerance=0.0).assembly.blocks[2].vertices
    assert (len(straight), len(bent)) == (4, 5)


def test_an_edge_that_closing_a_joint_makes_straight_has_no_vertex_left():
    """Both halves of the bed are put on the line of the bed below: it bent by 0.1 mm."""
    model = made(stacked(0, off=-1e-4))
    assert len(model.assembly.blocks[2].vertices) == 4
    assert len(model.notes) == 2 and "closed" not in model.notes[1]
    assert ds.pushover(model).peak.load_multiplier == pytest.approx(
        ds.pushover(made(stacked())).peak.load_multiplier, rel=1e-3
    )


def pair(gap, slope=0.0):
    top = rectangle(-0.2, gap, 0.4, 0.9)
    top[1, 1] += slope
    return [
        Block(
            id="base",
            vertices=rectangle(-1.0, -0.2, 2.0, 0.2),
            unit_weight=UNIT_WEIGHT,
            support=True,
        ),
        Block(id="b1", vertices=top, unit_weight=UNIT_WEIGHT),
    ]


@pytest.mark.parametrize(("gap", "slope"), [(1.9e-4, 0.0), (-1.9e-4, 0.0), (-1e-4, 2e-4)])
def test_a_gap_or_an_overlap_within_the_tolerance_is_closed(gap, slope):
    # The smallest edge is 0.2 m: 0.2 mm.
    model = made(pair(gap, slope))
    assert np.abs(model.assembly.blocks[1].vertices[:2, 1]).max() < ROUNDING
    assert "1 joint" in model.notes[0] and "2 vertices" in model.notes[0]


@pytest.mark.parametrize(
    ("gap", "tolerance", "complaint"),
    [(2.1e-4, 1e-3, "touches no"), (-2.1e-4, 1e-3, "overlap by"), (-1e-4, 0.0, "overlap by")],
)
def test_beyond_the_tolerance_it_is_refused(gap, tolerance, complaint):
    with pytest.raises(ModelError, match=complaint):
        made(pair(gap), drawing_tolerance=tolerance)


def test_an_arch_of_rounded_coordinates_fits():
    # Intrados and extrados to the millimetre, each joint drawn twice by different people.
    rng = np.random.default_rng(0)
    blocks = [
        replace(block, vertices=np.round(block.vertices + rng.uniform(-1e-5, 1e-5, (4, 2)), 5))
        for block in circular_arch(
            radius=4.0, thickness=0.6, embrace=150.0, n_voussoirs=9, unit_weight=UNIT_WEIGHT
        )
    ]
    model = made(blocks)
    assert len(model.notes) == 1
    assert np.abs(misfits(model)).max() < 1e-11  # joints meet under small angles at their ends


def test_notes_stay_with_what_is_varied():
    model = made(pair(1e-4))
    assert model.with_joint(friction_coefficient=0.3).notes == model.notes
