"""Blocks that touch in less than a face: one list of joints for limit analysis and the engines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import drystone as ds
from builders import UNIT_WEIGHT, rectangle
from drystone.geometry.plane import polygon
from drystone.geometry.space import solid
from drystone.limit import ASSOCIATIVE, collapse_load, limits_beside
from drystone.limit.against import carried_against
from drystone.limit.edges import Edges
from drystone.limit.joints import contact_points
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.builders import make_model
from drystone.model.model import Analysis
from drystone.results.events import Event, EventKind
from solids import joint, model_of

EQUILIBRIUM = Analysis(engine="equilibrium")
EXACT = 1e-9  # of programs solved to 1e-10
HALF = 0.5 * np.sqrt(0.5)  # m, half the diagonal of a bar of 0.5 m


def extruded(name, ring, *, support=False, width=0.5):
    """A prism along y over an outline in x and z."""
    vertices, faces = solid.extruded(np.array(ring, float), (0.0, width))
    return Block(id=name, vertices=vertices, faces=faces, unit_weight=UNIT_WEIGHT, support=support)


def flat(name, ring, *, support=False):
    """The same in the plane."""
    return Block(id=name, vertices=np.array(ring, float), unit_weight=UNIT_WEIGHT, support=support)


def assembled(outlines, law, *, space, between=None, corner=None):
    """A model of outlines pushed along x; those whose names begin with "base" are supports."""
    make = extruded if space else flat
    blocks = [make(n, ring, support=n.startswith("base")) for n, ring in outlines.items()]
    if not space:
        return make_model(
            blocks, joint=law, joint_between=between or {}, thickness=0.5,
            load_direction=(1.0, 0.0), corner=corner,
        )  # fmt: skip
    model = model_of(blocks, law, push=(1.0, 0.0, 0.0), analysis=EQUILIBRIUM, corner=corner)
    assembly = Assembly.build(blocks, joint=law, joint_between=between or {}, corner=corner)
    return replace(model, assembly=assembly)


def plank_on_ridges(law, **options):
    """A plank whose face lies on the ridges of two prisms."""
    ridges = {f"base{x}": [(x - 0.2, 0.0), (x + 0.2, 0.0), (x, 0.3)] for x in (0, 1)}
    return assembled({**ridges, "plank": rectangle(-0.3, 0.3, 1.6, 0.2)}, law, **options)


def bar_between_rims(law, **options):
    """A square bar, on end, whose lower faces lie on the rims of two tables: a slab in a notch."""
    x = 0.5 * HALF
    outlines = {
        "base left": rectangle(-1.0, -1.0, 1.0 - x, 1.0 + x),
        "base right": rectangle(x, -1.0, 1.0 - x, 1.0 + x),
        "bar": [(0.0, 0.0), (HALF, HALF), (0.0, 2.0 * HALF), (-HALF, HALF)],
    }
    return assembled(outlines, law, **options)


def birds_mouth(law, seat, heel, **options):
    """A rafter whose notch sits on the edge of a wall, its far end, without friction, on a post.

    The faces of the notch open from those of the wall by angles [degrees].  Beside the model the
    multiplier at which the wall turns over, pushed by the rafter, whose far end slides along.
    """
    rise, lean = np.tan(np.radians([seat, heel]))
    width, far = 0.4, 1.2
    rafter = [
        *[(-0.3, -0.3), (-0.3 * lean, -0.3), (0.0, 0.0), (0.7, 0.7 * rise)],
        *[(0.9, 0.1), (far, 0.1), (far, 0.6), (-0.3, 0.6)],
    ]
    outlines = {
        "base": rectangle(-1.0, -1.3, 2.0, 0.3),
        "base post": rectangle(1.0, -1.3, 0.3, 1.4),
        "wall": rectangle(0.0, -1.0, width, 1.0),
        "rafter": rafter,
    }
    between = {
        frozenset(("base post", "rafter")): joint(0.0, law.normal_stiffness),
        frozenset(("base", "wall")): joint(0.9, law.normal_stiffness),
    }
    mass = polygon.mass_properties(np.array(rafter))
    (x, z), heavy, light = mass.centroid, mass.area, width
    turn = width / far  # of the rafter, over that of the wall
    held = heavy * (width - turn * x) + light * 0.5 * width
    pushed = heavy * (1.0 + turn * z) + light * 0.5
    return assembled(outlines, law, between=between, **options), held / pushed


def crossing(law, **options):
    """Two blocks beside each other upon two others: head joints run through.

    The upper left one hardly rubs on the one below and pushes the upper right one.
    """
    outlines = {"base": rectangle(-3.0, -0.3, 6.0, 0.3)}
    for i in range(2):
        for k, level in enumerate("bt"):
            outlines[f"{level}{i}"] = rectangle(0.4 * i, 0.25 * k, 0.4, 0.25)
    laws = {("b0", "t0"): 0.1, ("b1", "t1"): 0.5, ("t0", "b1"): 0.5, ("b0", "t1"): 0.5}
    k = law.normal_stiffness
    between = {frozenset(pair): joint(mu, k) for pair, mu in laws.items()}
    return assembled(outlines, law, between=between, **options)


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize(
    ("make", "friction", "expected"),
    [
        (plank_on_ridges, 0.7, 0.7),  # slides on its ridges
        (bar_between_rims, 0.5, 1.0),  # turns about the right rim: its arm over its height, 1
    ],
)
def test_what_rests_on_edges_stands_and_carries(make, friction, expected, space):
    """Neither has a face on a face; without edges both fall."""
    model = make(joint(friction, 1e10), space=space)
    assert not len(model.assembly.interfaces.block_a)
    found = collapse_load(model, flow=ASSOCIATIVE)
    assert found.load_multiplier == pytest.approx(expected, abs=EXACT)
    assert found.upper_bound == found.load_multiplier
    assert collapse_load(model).load_multiplier == pytest.approx(expected, abs=EXACT)
    peak = ds.pushover(model, max_displacement=0.01).peak.load_multiplier
    # Joints of 1e10 Pa/m close by less than a micrometre.
    assert 0.999 * expected < peak < expected * (1.0 + 1e-5)
    assert limits_beside(model).associative == found.load_multiplier


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize(("seat", "heel"), [(0.0, 5.0), (2.0, 5.0), (2.0, 20.0)])
def test_a_notch_holds_on_an_edge_by_both_its_faces(seat, heel, space):
    """Each part of the notch by itself could leave along several normals: taken for corners, they
    carried nothing: the rafter fell, or slid off at the friction of its seat."""
    model, expected = birds_mouth(joint(0.5, 1e10), seat, heel, space=space)
    found = collapse_load(model, flow=ASSOCIATIVE)
    assert found.load_multiplier == pytest.approx(expected, abs=EXACT)
    assert found.upper_bound == pytest.approx(found.load_multiplier, abs=EXACT)
    assert collapse_load(model).load_multiplier == pytest.approx(expected, abs=EXACT)
    peak = ds.pushover(model, max_displacement=0.005).peak.load_multiplier
    assert 0.999 * expected < peak < expected * (1.0 + 1e-5)


@pytest.mark.parametrize("corner", [Corner(radius=0.01), Corner(chamfer=0.01)])
def test_treated_edges_touch_nothing(corner):
    model = plank_on_ridges(joint(0.7), space=True, corner=corner)
    assert contact_points(model.assembly).n_contacts == 0


@pytest.mark.parametrize("space", [False, True])
def test_blocks_at_a_crossing_are_free_to_slide_past_each_other(space):
    """The upper two slide together, by associative flow: the left one rises by 0.1 of its way and
    the right one by 0.5, on which the head joint rubs.

    The right one drags along the left with the head joint's normal force N and mu N: with weights
    of one, lambda = 0.1 (1 - mu N) + N and lambda = 0.5 (1 + mu N) - N, mu = 0.8.
    """
    model = crossing(joint(0.8), space=space)
    push = 0.4 / (2.0 - 0.8 * 0.6)
    expected = 0.1 * (1.0 - 0.8 * push) + push
    found = collapse_load(model, flow=ASSOCIATIVE)
    assert found.load_multiplier == pytest.approx(expected, abs=1e-6)
    # A lower block in the way of the upper left one would have to turn or slide: two at a corner.
    edges = Edges.of(model.assembly)
    assert edges.corner.all() and len(np.unique(np.round(np.abs(edges.normal), 9), axis=0)) == 2
    assert found.upper_bound > 1.2 * expected
    assert "at a corner" in found.reason


def test_turning_the_plane_changes_no_edge():
    model = crossing(joint(0.8), space=True)
    blocks = [
        replace(b, vertices=b.vertices[:, [1, 0, 2]] * (-1, 1, 1)) for b in model.assembly.blocks
    ]
    turned = Assembly.build(blocks, joint=model.assembly.joint)
    one, two = Edges.of(model.assembly), Edges.of(turned)
    assert len(one.area) == len(two.area)
    assert np.sort(one.area) == pytest.approx(np.sort(two.area))


# --- why a curve lies above --------------------------------------------------------------------


def stopped():
    """A block slides at 0.3, and after 1 mm meets a stop."""
    outlines = {
        "base": rectangle(-1.0, -0.3, 3.0, 0.3),
        "block": rectangle(0.0, 0.0, 0.5, 0.2),
        "base stop": rectangle(0.501, 0.0, 0.3, 0.3),
    }
    return assembled(outlines, joint(0.3), space=False)


def test_blocks_that_come_to_touch_are_the_cause():
    model = stopped()
    curve = ds.pushover(model, max_displacement=1.2e-3)
    told = limits_beside(model).warning(curve, model)
    assert "lies above the associative collapse multiplier 0.3000" in told
    assert '"block" and "base stop"' in told and "did not touch, apart by up to 0.001 m" in told
    assert "smaller steps" not in told


def test_events_and_motion_are_causes():
    model = plank_on_ridges(joint(0.7, 1e10), space=False)
    curve = ds.pushover(model, max_displacement=0.01)
    low = replace(limits_beside(model), associative=0.5)
    assert "because blocks have moved by up to 0.0" in low.warning(curve, model)
    event = Event(
        kind=EventKind.LOSS_OF_EQUILIBRIUM, step=0, control_displacement=0.0, load_multiplier=0.1,
        blocks=("plank",), motion=0.02,
    )  # fmt: skip
    told = low.warning(replace(curve, events=(event,)), model)
    assert "because the structure moves by itself, by 0.02 m" in told


def leaning():
    """Two blocks on each other; the bed between falls by 1 in 200 the way they are pushed, so that
    the upper one slides at 0.2946 and both at 0.3."""
    outlines = {
        "base": rectangle(-1.0, -0.3, 3.0, 0.3),
        "lower": np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.2], [0.0, 0.205]]),
        "upper": np.array([[0.2, 0.204], [0.8, 0.201], [0.8, 0.3], [0.2, 0.3]]),
    }
    return assembled(outlines, joint(0.3, 1e10), space=False)


def test_a_multiplier_read_off_a_motion_is_told_from_one_at_rest():
    model = leaning()
    sliding = (0.3 - 0.005) / (1.0 + 0.3 * 0.005)
    beside, collapse = limits_beside(model), collapse_load(model, flow=ASSOCIATIVE)
    assert beside.associative == pytest.approx(sliding, rel=1e-6)
    kept = {"keep_poses": True, "keep_contacts": True, "max_displacement": 0.005}
    curve = ds.pushover(model, engine="nscd", **kept)
    told = beside.warning(curve, model)
    assert "because it is read off a motion" in told
    point = curve.capacity
    pose, contacts = curve.poses[point.step], curve.contacts[point.step]
    carried = carried_against(model, collapse.velocities, contacts, pose)
    assert carried == pytest.approx(sliding, rel=1e-5) and point.load_multiplier > 1.005 * sliding
    # At rest any mechanism tells the same.
    still = ds.pushover(model, engine="equilibrium", **kept)
    assert beside.warning(still, model) is None
    for point in still.points[1:]:
        pose, contacts = still.poses[point.step], still.contacts[point.step]
        carried = carried_against(model, collapse.velocities, contacts, pose)
        assert carried == pytest.approx(point.load_multiplier, rel=1e-5)


def test_without_friction_nothing_exceeds_nothing():
    """0.0000 exceeded -0.0000."""
    model = assembled(
        {"base": rectangle(-1.0, -0.3, 3.0, 0.3), "block": rectangle(0.0, 0.0, 0.5, 0.2)},
        joint(0.0),
        space=False,
    )
    beside = limits_beside(model)
    assert beside.associative == pytest.approx(0.0, abs=1e-9)
    curve = ds.pushover(model, max_displacement=0.01)
    assert beside.warning(curve, model) is None


def test_a_motion_that_is_too_small_is_no_cause():
    model = plank_on_ridges(joint(0.7, 1e10), space=False)
    curve = ds.pushover(model, max_steps=4)
    low = replace(limits_beside(model), associative=0.1)
    assert "too little to be the cause: doubt this point" in low.warning(curve, model)
