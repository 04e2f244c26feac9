"""Joints of solids that are crushed, in limit analysis: exact blocks of stress, and any polygon.

A block whose joint is crushed to a block of stress, the part P of the joint beyond a line, carries
its weight W = f_c |P| there.  About the middle of the joint the resultant has the arm of P's
centroid, and lambda H / 2 is that.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import drystone as ds
import solids
from drystone.geometry import patches
from drystone.geometry.space import solid
from drystone.limit import collapse_load, crushing
from drystone.model.assembly import Block
from drystone.model.joint_law import JointLaw

B, D, H = 0.6, 0.4, 1.2  # m
FLOWS = ["associative", "non-associative"]
#: Of the side of a rectangle: the points' resultant is nearer to the edge by no more.
NEARER = (np.pi / (patches.ALONG - 1)) ** 2 / 8.0


def law(crushed=np.inf, friction=0.9, **more):
    return JointLaw(
        friction_coefficient=friction,
        normal_stiffness=None,
        shear_stiffness=None,
        compressive_strength=crushed,
        **more,
    )


def block(angle, joint):
    model = solids.one_block(B, D, H, angle=angle)
    return replace(model, assembly=replace(model.assembly, joint=joint))


def multiplier(model, flow="associative"):
    found = collapse_load(model, flow=flow)
    assert found.status == "finished", found.reason
    assert max(found.duality_gap, found.residual) < 1e-7
    assert max(found.friction_violation, found.dilatancy_violation) < 1e-7
    return found.load_multiplier


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("share", [0.03, 0.1, 0.3])
@pytest.mark.parametrize("angle", [0.0, 90.0])
def test_a_block_on_a_crushed_edge(angle, share, flow):
    """a = W / f_c t and lambda = (B - a) / H; the points take twice their arm's error more."""
    across, along = (D, B) if angle else (B, D)
    a = share * across
    weight = solids.UNIT_WEIGHT * B * D * H
    above = multiplier(block(angle, law(weight / (a * along))), flow) - (across - a) / H
    assert -1e-8 <= above <= 2.0 * NEARER * across / H


@pytest.mark.parametrize("flow", FLOWS)
def test_a_block_on_a_crushed_corner(flow):
    """Pushed along the diagonal of a square it stands on a triangle with the legs c, W = f_c c^2/2,
    whose centroid is c / 3 from both sides."""
    c = 0.2
    model = solids.one_block(B, B, H, angle=45.0)
    weight = solids.UNIT_WEIGHT * B * B * H
    joint = law(2.0 * weight / c**2, friction=2.0)
    model = replace(model, assembly=replace(model.assembly, joint=joint))
    exact = np.sqrt(2.0) * (B - 2.0 * c / 3.0) / H
    assert -1e-8 <= multiplier(model, flow) - exact <= 2.0 * np.sqrt(2.0) * NEARER * B / H


def test_a_tilted_block_presses_its_edge_less():
    """a = W cos(alpha) / f_c t: tan(alpha) = (B - a) / H."""
    a = 0.1
    weight = solids.UNIT_WEIGHT * B * D * H
    model = block(0.0, law(weight / (a * D)))
    model = model.with_load(ds.TiltPattern(direction=np.array([1.0, 0.0, 0.0])))
    exact = brentq(lambda slope: slope - (B - a / np.sqrt(1.0 + slope**2)) / H, 0.0, 1.0)
    assert 0.0 <= multiplier(model) - exact <= 2.0 * NEARER * B / H


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("angle", [0.0, 20.0, 90.0])
def test_strong_joints_are_dry(angle, flow):
    strong, dry = (multiplier(block(angle, law(f)), flow) for f in (1e13, np.inf))
    assert strong == pytest.approx(dry, rel=1e-7)


def test_joints_without_crushing_keep_their_points():
    points = ds.limit.joints.contact_points(block(0.0, law()).assembly)
    assert crushing.spread(points) is points


def test_a_block_that_crushes_its_joint_does_not_stand():
    found = collapse_load(block(0.0, law(0.9 * solids.UNIT_WEIGHT * H)))
    assert "does not stand under its own weight" in found.reason


def beyond(polygon, along, offset):
    """Area and first moment along a direction of the part of a polygon (n, 2) beyond a line."""
    depth = polygon @ along - offset
    kept = []
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        if depth[i] >= 0.0:
            kept.append(polygon[i])
        if depth[i] * depth[j] < 0.0:
            kept.append(polygon[i] + depth[i] / (depth[i] - depth[j]) * (polygon[j] - polygon[i]))
    if len(kept) < 3:
        return 0.0, 0.0
    p = np.array(kept)
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    return 0.5 * cross.sum(), (cross @ ((p + q) @ along)) / 6.0


@pytest.mark.parametrize("angle", [0.0, 15.0, 30.0])
def test_a_prism_of_six_sides(angle):
    """Half the diagonal is 1; the exact part is found by its area."""
    around = np.radians(60.0 * np.arange(6) + angle)
    outline = 0.4 * np.column_stack((np.cos(around), np.sin(around)))
    vertices, faces = solid.extruded(outline, (0.0, H))  # along y
    vertices = vertices[:, [2, 0, 1]]
    blocks = [
        solids.box("base", (-1, -1, -0.3), (1, 1, 0), support=True),
        Block(id="prism", vertices=vertices, faces=faces, unit_weight=solids.UNIT_WEIGHT),
    ]
    area = beyond(outline, np.array([1.0, 0.0]), -1.0)[0]
    share = 0.15
    joint = law(solids.UNIT_WEIGHT * H / share, friction=2.0)
    model = solids.model_of(blocks, joint, push=(1.0, 0.0, 0.0))
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    assert (low, high) == pytest.approx((0.0, H))
    push = np.array([1.0, 0.0])
    line = vertices[np.isclose(vertices[:, 2], 0.0)][:, :2]
    turn = np.arctan2(line[:, 1], line[:, 0])
    line = line[np.argsort(turn)]
    offset = brentq(lambda x: beyond(line, push, x)[0] - share * area, -0.4, 0.4)
    arm = beyond(line, push, offset)[1] / (share * area)
    assert 0.0 <= multiplier(model) - 2.0 * arm / H <= 2.0 * NEARER * 0.8 / H


def test_of_any_polygon_points_keep_force_and_moments_and_add_little():
    """What the points carry beyond any line, as against the exact part: no less, and no more than
    by a share of the polygon's width; whatever is linear is exact."""
    random = np.random.default_rng(5)
    for _ in range(40):
        around = np.sort(random.uniform(0.0, 2.0 * np.pi, random.integers(3, 8)))
        if np.diff(around, append=around[0] + 2.0 * np.pi).max() > 0.9 * np.pi:
            continue
        polygon = np.column_stack((random.uniform(0.5, 2.0) * np.cos(around), np.sin(around)))
        place, share = patches.spread_over(np.column_stack((polygon, np.zeros(len(polygon)))))
        assert share.min() > 0.0
        whole = beyond(polygon, np.array([1.0, 0.0]), -9.0)
        assert share.sum() == pytest.approx(1.0, abs=1e-14)
        assert whole[0] * (share @ place[:, 0]) == pytest.approx(whole[1], abs=1e-12)
        for _ in range(10):
            turn = random.uniform(0.0, 2.0 * np.pi)
            along = np.array([np.cos(turn), np.sin(turn)])
            depth = polygon @ along
            offset = random.uniform(depth.min(), depth.max())
            found = whole[0] * (share @ np.maximum(place[:, :2] @ along - offset, 0.0))
            area, moment = beyond(polygon, along, offset)
            above = found - (moment - offset * area)
            assert -1e-12 <= above <= NEARER * np.ptp(depth) * whole[0]
