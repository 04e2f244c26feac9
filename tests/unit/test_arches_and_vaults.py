"""Arches, portals, bridges, vaults and domes: volume, joints and surface against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from built import assembled, brute_joints, exposed, joint_area
from drystone.model.builders import (
    ModelError,
    arch,
    barrel_vault,
    bridge,
    dome,
    groin_vault,
    portal,
)
from drystone.model.builders.profile import half_curve, length_of, ring

W = {"unit_weight": 20e3}
# Sums of some hundred areas of the order of 1 m2, each to rounding errors of coordinates.
EXACT = {"rel": 1e-9}

shapes = st.sampled_from(("circular", "pointed", "elliptic"))


@st.composite
def curves(draw, voussoirs=(3, 21)):
    """Measures of an arch that there is."""
    shape, span = draw(shapes), 0.1 * draw(st.integers(10, 60))
    share = draw(st.integers(5, 10) if shape == "circular" else st.integers(10, 20))
    if shape == "elliptic":
        share = draw(st.integers(6, 16))
    n = draw(st.integers(*voussoirs))
    return {
        "span": span,
        "rise": 0.05 * share * span,
        "shape": shape,
        "voussoirs": n + n % 2 if shape == "pointed" else n,
        "thickness": 0.05 * span,
    }


def chords(points):
    """Length of the way through points [m]."""
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def polygon_area(points):
    x, y = np.asarray(points).T
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))


@settings(max_examples=40, deadline=None)
@given(curve=curves(), deep=st.booleans())
def test_an_arch_is_the_ring_between_its_chords(curve, deep):
    joints = ring(**curve)
    n, t = curve["voussoirs"], curve["thickness"]
    assert joints.inner[0] == pytest.approx([-0.5 * curve["span"], 0.0], abs=1e-9)
    assert joints.inner == pytest.approx(joints.inner[::-1] * [-1, 1], abs=1e-9)  # symmetric
    assert joints.outer == pytest.approx(joints.outer[::-1] * [-1, 1], abs=1e-9)
    crown = ring(**{**curve, "voussoirs": n + n % 2}).inner
    assert crown[:, 1].max() == pytest.approx(curve["rise"], rel=1e-9)
    length = np.linalg.norm(joints.outer - joints.inner, axis=1)
    regular = np.ones(n + 1, bool)
    if curve["shape"] == "pointed":  # whose upright joint is longer
        regular[n // 2] = False
        assert length[n // 2] > t
    assert length[regular] == pytest.approx(t, rel=1e-9)
    assembly = assembled(arch(**curve, **({"depth": 0.5} if deep else {}), **W))
    outline = np.vstack((joints.inner, joints.outer[::-1]))
    times = 0.5 if deep else 1.0
    assert assembly.volume.sum() == pytest.approx(polygon_area(outline) * times, **EXACT)
    assert joint_area(assembly) == pytest.approx(length[1:-1].sum() * times, **EXACT)


@settings(max_examples=20, deadline=None)
@given(curve=curves())
def test_voussoirs_are_equal_along_the_intrados(curve):
    """But for chords and arcs: of 21 pieces they differ by less than a hundredth."""
    n = 20
    joints = ring(**{**curve, "voussoirs": n})
    size = np.linalg.norm(np.diff(joints.inner, axis=0), axis=1)
    assert np.ptp(size) < 0.02 * size.mean()
    length = 2.0 * length_of(half_curve(curve["shape"], curve["span"], curve["rise"]))
    size = length / 14.6  # which fits nowhere: the nearest odd number is 15, the nearest even 14
    del curve["voussoirs"]
    wanted = 14 if curve["shape"] == "pointed" else 15
    assert ring(**curve, size=size).n_voussoirs == wanted


def test_any_intrados():
    """Through points of a catenary; the spline between nine of them is as near as a millimetre."""
    x = np.linspace(-1.0, 1.0, 9)
    joints = ring(
        intrados=np.column_stack((x, np.cosh(1.0) - np.cosh(x))), thickness=0.2, voussoirs=12
    )
    assert joints.inner[:, 1] == pytest.approx(np.cosh(1.0) - np.cosh(joints.inner[:, 0]), abs=1e-3)
    assert np.linalg.norm(joints.outer - joints.inner, axis=1) == pytest.approx(0.2, rel=1e-9)
    # Arcs of sinh(1) each half; joints are normal: across the slope sinh(x).
    along = np.sinh(joints.inner[:, 0])
    assert np.diff(along) == pytest.approx(2 * np.sinh(1.0) / 12, rel=2e-3)
    slope = (joints.outer - joints.inner) @ np.array([[1.0], [0.0]])
    steep = np.sinh(joints.inner[:, 0])
    assert slope[:, 0] / 0.2 == pytest.approx(steep / np.sqrt(1 + steep**2), abs=2e-2)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"rise": 2.5}, 'the nearest that fits is 2 m, or take shape = "pointed"'),
        ({"rise": 1.5, "shape": "pointed"}, "the nearest that fits is 2 m"),
        ({"shape": "pointed", "rise": 3.0}, "15 is odd: the nearest that fit are 14 and 16"),
        ({"shape": "round"}, "there is no shape"),
        ({"size": 0.3}, "give either their number or their size"),
        ({"span": None}, "give either the span or an intrados"),
        ({"thickness": -0.3}, "thickness: must be greater than 0 m"),
    ],
)
def test_arches_that_there_are_not(change, sentence):
    measures = {"span": 4.0, "thickness": 0.3, "voussoirs": 15}
    with pytest.raises(ModelError, match=sentence):
        arch(**{**measures, **change}, **W)


def test_an_intrados_that_is_too_sharp_for_its_thickness():
    """A hollow of a curve is sharper than the arch is thick: joints would cross."""
    points = [(-2, 0), (-1, 1), (0, 0.4), (1, 1), (2, 0)]
    with pytest.raises(ModelError, match="joints cross within voussoir"):
        arch(intrados=points, thickness=1.0, voussoirs=21, **W)


@settings(max_examples=25, deadline=None)
@given(curve=curves((5, 15)), width=st.integers(1, 6), deep=st.booleans())
def test_a_portal_by_its_outline(curve, width, deep):
    """All that is no joint is outside: two piers, the arch, skewbacks up to the springings."""
    joints = ring(**curve)
    reach = float(joints.inner[0, 0] - joints.outer[0, 0])
    wide, high = reach + 0.2 * width, 1.0
    more = {"depth": 0.5} if deep else {}
    blocks = portal(**curve, pier_width=wide, pier_height=high, unit=(0.4, 0.2), **more, **W)
    assembly = assembled(blocks)
    skew = float(joints.outer[0, 1])
    area = polygon_area(np.vstack((joints.inner, joints.outer[::-1]))) + 2 * wide * high
    area += 2 * skew * (wide - 0.5 * reach)
    rim = chords(joints.inner) + chords(joints.outer)
    rim += 2 * (2 * high + skew + wide + wide - reach)
    if deep:
        assert assembly.volume.sum() == pytest.approx(0.5 * area, **EXACT)
        assert exposed(assembly) == pytest.approx(2 * area + 0.5 * rim, **EXACT)
    else:
        assert assembly.volume.sum() == pytest.approx(area, **EXACT)
        assert exposed(assembly) == pytest.approx(rim, **EXACT)


def test_a_lintel_and_a_pier_too_narrow():
    blocks = portal(
        span=1.2, thickness=0.3, pier_width=0.4, pier_height=1.0, unit=(0.4, 0.2), shape="lintel",
        **W,
    )  # fmt: skip
    assert exposed(assembled(blocks)) == pytest.approx(2 * 2.0 + 4 * 1.0 + 2 * 0.3, **EXACT)
    with pytest.raises(ModelError, match=r"pier_width: .* the nearest that fits is 0.3 m"):
        portal(
            span=1.2, thickness=0.3, pier_width=0.2, pier_height=1.0, unit=(0.4, 0.2), voussoirs=9,
            **W,
        )  # fmt: skip


@settings(max_examples=25, deadline=None)
@given(
    curve=curves((7, 15)), n=st.integers(1, 3), wider=st.integers(0, 5), cover=st.integers(2, 20)
)
def test_a_bridge_by_its_outline(curve, n, wider, cover):
    """Of a bridge all that is no joint is its rim: nothing is left open inside."""
    joints = ring(**curve)
    reach = float(joints.inner[0, 0] - joints.outer[0, 0])
    span, high = curve.pop("span"), 1.0
    width = 2 * reach + 0.1 * wider * span
    blocks = bridge(
        spans=[span] * n, **curve, pier_width=width, pier_height=high,
        abutment_width=2 * reach, cover=0.02 * cover * span, unit=(0.2 * span, 0.1 * span), **W,
    )  # fmt: skip
    assembly = assembled(blocks)
    deck = high + float(joints.outer[:, 1].max()) + 0.02 * cover * span
    length = n * span + (n - 1) * width + 4 * reach
    feet = length - n * span
    hole = n * (span * high + polygon_area(joints.inner))
    assert assembly.volume.sum() == pytest.approx(length * deck - hole, **EXACT)
    rim = 2 * deck + length + feet + n * (2 * high + chords(joints.inner))
    # Slivers under the tolerance of joints are none: spandrels end in edges along the arches.
    assert exposed(assembly) == pytest.approx(rim, rel=1e-3)


def test_spans_of_a_bridge_may_differ_where_springings_are_level():
    measures = {
        "thickness": 0.3, "pier_width": 1.0, "pier_height": 1.0, "abutment_width": 1.0,
        "cover": 0.5, "unit": (0.6, 0.3), "size": 0.4,
    }  # fmt: skip
    blocks = bridge(spans=[3.0, 4.0], **measures, **W)
    assembly = assembled(blocks)
    assert {"arch 1", "arch 2", "pier 1", "spandrel 3", "left abutment"} <= set(assembly.groups)
    with pytest.raises(ModelError, match="unlike spans slope unlike"):
        bridge(spans=[3.0, 4.0], rise=0.8, **measures, **W)
    with pytest.raises(ModelError, match=r"pier_width: .* nearest that fits is 0.6 m"):
        bridge(spans=[3.0, 3.0], **{**measures, "pier_width": 0.5}, **W)


@settings(max_examples=15, deadline=None)
@given(curve=curves((3, 9)), length=st.integers(4, 30))
def test_a_barrel_vault_is_an_arch_in_stones(curve, length):
    long = 0.1 * length
    assembly = assembled(barrel_vault(**curve, length=long, unit=0.4, **W))
    joints = ring(**curve)
    area = polygon_area(np.vstack((joints.inner, joints.outer[::-1])))
    assert assembly.volume.sum() == pytest.approx(area * long, **EXACT)
    rim = chords(joints.inner) + chords(joints.outer)
    rim += sum(np.linalg.norm(joints.outer[k] - joints.inner[k]) for k in (0, -1))
    assert exposed(assembly) == pytest.approx(2 * area + rim * long, **EXACT)


@settings(max_examples=8, deadline=None)
@given(
    n=st.sampled_from((3, 5, 7)), unit=st.integers(4, 12), mitred=st.booleans(), wide=st.booleans()
)
def test_a_groin_vault_is_two_barrels_that_cross(n, unit, mitred, wide):
    """Volume: a barrel's ring over its web, of which each point is as long as its distance from
    the vault's edge less that from the crown; integrated over each voussoir's quadrilateral."""
    span, t = 3.0, 0.3
    edge = 0.5 if wide else t
    blocks = groin_vault(
        span=span, thickness=t, voussoirs=n, unit=0.1 * unit, mitred=mitred, edge=edge, **W
    )
    assembly = assembled(blocks)
    joints, volume = ring(span=span, thickness=t, voussoirs=n), 0.0
    reach = 0.5 * span + edge
    for i in range(n):
        quad = joints.outline(i)
        for a, b, c in ((quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])):
            if 2 * i + 1 != n:  # linear over a triangle: its mean is that of its corners
                volume += polygon_area([a, b, c]) * (reach - np.abs([a[0], b[0], c[0]]).mean())
    low, high = (abs(joints.outline(n // 2)[k]) for k in (0, 2))
    depth, (p, q) = high[1] - low[1], (low[0], high[0])
    # The keystones' row reaches from the boss, whose sides lean, so that its length is linear in z.
    volume += depth * ((p + q) * reach - (2.0 / 3.0) * (p * p + p * q + q * q))
    boss = depth * 4.0 * (p * p + p * q + q * q) / 3.0
    assert assembly.volume.sum() == pytest.approx(4 * volume + boss, **EXACT)
    assert joint_area(assembly) == pytest.approx(brute_joints(assembly), rel=1e-6)
    groins = [block for block in blocks if "groin northeast" in block.groups]
    assert len(groins) == (0 if mitred else n // 2)
    assert all(len(block.parts) == 2 for block in groins)


@settings(max_examples=25, deadline=None)
@given(
    curve=curves(), rings=st.integers(1, 8), sectors=st.integers(4, 16), share=st.integers(0, 4),
    bond=st.sampled_from(("running", "stack")),
)  # fmt: skip
def test_a_dome_between_its_chords(curve, rings, sectors, share, bond):
    """Regular polygons stand for circles.  Of one with m sides through radius r the area is
    r^2 m/2 sin(2 pi/m), so that a ring has the moment of its profile about the axis times
    m sin(2 pi/m) as volume; a face between (r, z) and (s, y) is a trapezoid, see `facets`."""
    del curve["voussoirs"]
    oculus, t = 0.1 * share * curve["span"], curve["thickness"]
    blocks = dome(**curve, rings=rings, sectors=sectors, oculus=oculus, bond=bond, **W)
    assert len(blocks) == rings * sectors
    sides = sectors * (2 if bond == "running" else 1)
    at = half_curve(curve["shape"], curve["span"], curve["rise"], oculus)
    points, normals = np.array([at(k / rings) for k in range(rings + 1)]).swapaxes(0, 1)
    inner, outer = points * [-1, 1], (points + t * normals) * [-1, 1]
    assert inner[[0, -1], 0] == pytest.approx([0.5 * curve["span"], 0.5 * oculus], abs=1e-9)
    if share == 0:  # the crown's joint is in the axis, where extrados of a pointed one meet
        outer[-1] = 0.0, max(block.vertices[:, 2].max() for block in blocks)
    p = np.vstack((inner, outer[::-1]))
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    moment = abs(float(((p[:, 0] + q[:, 0]) * cross).sum())) / 6.0
    assembly = assembled(blocks)
    volume = moment * sides * np.sin(2.0 * np.pi / sides)
    assert assembly.volume.sum() == pytest.approx(volume, **EXACT)

    def facets(p, q):
        """Area of all faces between two circles."""
        c, s = np.cos(np.pi / sides), np.sin(np.pi / sides)
        slant = np.hypot((p[0] - q[0]) * c, p[1] - q[1])
        return sides * (p[0] + q[0]) * s * slant

    # Outside are intrados, extrados, springing and oculus; all else lies on each other.
    assert exposed(assembly) == pytest.approx(sum(map(facets, p, q)), **EXACT)


@pytest.mark.parametrize("bond", ["running", "stack"])
def test_joints_of_domes_by_brute_force(bond):
    blocks = dome(span=3.0, thickness=0.3, rings=3, sectors=6, oculus=0.6, bond=bond, **W)
    assembly = assembled(blocks)
    assert joint_area(assembly) == pytest.approx(brute_joints(assembly), rel=1e-6)
