"""Limit analysis against closed forms.

A linear program is solved to about 1e-12 here; 1e-9 allows for the number of blocks.
"""

import numpy as np
import pytest

from builders import UNIT_WEIGHT, rectangle
from drystone.limit import (
    FLOWS,
    NonAssociativeSettings,
    collapse_load,
    collapse_loads,
    is_locked,
    least_standing,
    stands,
)
from drystone.model.assembly import Block, Corner
from drystone.model.builders import (
    PUBLISHED_WALLS,
    circular_arch,
    column,
    coursed_wall,
    make_model,
    published_wall,
    stack,
)
from drystone.model.joint_law import JointLaw
from drystone.model.loading import TiltPattern
from drystone.model.ties import Tie, TieEnd

EXACT = 1e-9
B, H = 0.4, 0.9  # m


def joint(friction, **others):
    return JointLaw(
        friction_coefficient=friction, normal_stiffness=None, shear_stiffness=None, **others
    )


def model(blocks, law, *, direction=(1.0, 0.0), corner=None, thickness=1.0):
    return make_model(
        blocks, joint=law, thickness=thickness, load_direction=direction, corner=corner
    )


def block(law, **options):
    """One block of B x H on a plane."""
    return model(stack(widths=[B], heights=[H], unit_weight=UNIT_WEIGHT), law, **options)


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("friction", [0.2, 0.4, 0.5, 0.9])
@pytest.mark.parametrize("thickness", [0.3, 1.0])
def test_block_slides_or_rocks(flow, friction, thickness):
    # lambda W = mu W, or lambda W H/2 = W B/2, whichever is less.
    found = collapse_load(block(joint(friction), thickness=thickness), flow=flow)
    assert found.load_multiplier == pytest.approx(min(friction, B / H), abs=EXACT)
    assert found.collapse_range == pytest.approx((found.load_multiplier,) * 2, abs=EXACT)


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("up", [-0.4, -0.1, 0.2, 0.5])
@pytest.mark.parametrize("friction", [0.3, 0.9])
def test_block_under_an_inclined_load(flow, up, friction):
    # With the direction (c, s):  slides  lambda c = mu (1 - lambda s)
    #                             rocks   lambda c H = (1 - lambda s) B
    c, s = np.array([1.0, up]) / np.hypot(1.0, up)
    ratio = min(friction, B / H)
    found = collapse_load(block(joint(friction), direction=(1.0, up)), flow=flow)
    assert found.load_multiplier == pytest.approx(ratio / (c + ratio * s), abs=EXACT)


@pytest.mark.parametrize("corner", [Corner(radius=0.03), Corner(chamfer=0.03)])
def test_treated_corners_shorten_the_arm(corner):
    found = collapse_load(block(joint(0.9), corner=corner))
    assert found.load_multiplier == pytest.approx((B - 0.06) / H, abs=EXACT)


@pytest.mark.parametrize("flow", FLOWS)
def test_cohesion_holds_a_sliding_block(flow):
    # lambda W = mu W + c A
    cohesion, weight = 600.0, UNIT_WEIGHT * B * H
    found = collapse_load(block(joint(0.1, cohesion=cohesion)), flow=flow)
    assert found.load_multiplier == pytest.approx(0.1 + cohesion * B / weight, abs=EXACT)


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("tension", [100.0, 500.0])
def test_tensile_strength_holds_a_rocking_block(flow, tension):
    # Half the joint's strength at its far end: lambda W H/2 = W B/2 + f A/2 B
    weight = UNIT_WEIGHT * B * H
    law = joint(0.9, cohesion=5e3, tensile_strength=tension)
    expected = B / H * (1.0 + tension * B / weight)
    assert collapse_load(block(law), flow=flow).load_multiplier == pytest.approx(
        expected, abs=EXACT
    )


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("share", [0.05, 0.5, 0.95, 1.05, 30.0])
def test_a_bonded_block_on_a_tilting_table(flow, share):
    """Strength counts by 1 / cos of the angle more: l = B/H + s sqrt(1 + l^2), s = f A B / W H.

    From s = 1 on it holds the block on a table that stands upright.
    """
    tension = share * UNIT_WEIGHT * H * H / B
    law = joint(0.9, cohesion=50.0 * tension, tensile_strength=tension)
    tilted = block(law).with_load(TiltPattern(direction=np.array([1.0, 0.0])))
    found = collapse_load(tilted, flow=flow)
    if share >= 1.0:
        assert found.status == "locked" and "turned upright" in found.reason
        return
    a = B / H
    expected = (a + share * np.sqrt(1.0 + a**2 - share**2)) / (1.0 - share**2)
    assert found.load_multiplier == pytest.approx(expected, rel=1e-6)


def test_tension_ends_where_the_friction_cone_does():
    # |t| <= c + mu n allows no n < -c/mu, whatever the tensile strength.
    weak = joint(0.9, cohesion=90.0, tensile_strength=1e6)
    limited = joint(0.9, cohesion=90.0, tensile_strength=100.0)
    a, b = (collapse_load(block(law), flow="associative") for law in (weak, limited))
    assert a.load_multiplier == pytest.approx(b.load_multiplier, abs=EXACT)


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("n_blocks", [1, 3, 12])
@pytest.mark.parametrize("friction", [0.1, 0.7])
def test_column_of_equal_blocks(flow, n_blocks, friction):
    blocks = column(width=0.5, height=2.0, n_blocks=n_blocks, unit_weight=UNIT_WEIGHT)
    found = collapse_load(model(blocks, joint(friction)), flow=flow)
    assert found.load_multiplier == pytest.approx(min(friction, 0.25), abs=EXACT)


def test_column_of_400_blocks_by_the_interior_point_method():
    # Its tolerance is 1e-8, relative to numbers of order one.
    blocks = column(width=5.0, height=20.0, n_blocks=400, unit_weight=UNIT_WEIGHT)
    found = collapse_load(model(blocks, joint(0.7)), flow="associative")
    assert found.load_multiplier == pytest.approx(0.25, abs=1e-6)
    assert found.duality_gap < 1e-6


@pytest.mark.parametrize("flow", FLOWS)
def test_stack_that_narrows_fails_at_its_weakest_joint(flow):
    # Any upper part may rock about its lower right corner: its own width is the arm.
    widths, heights = np.array([1.0, 0.5, 0.4]), np.array([0.3, 0.8, 0.6])
    weight, level = widths * heights, np.cumsum(heights) - heights
    expected = min(
        np.sum(weight[k:] * widths[k] / 2)
        / np.sum(weight[k:] * (level[k:] + heights[k:] / 2 - level[k]))
        for k in range(3)
    )
    blocks = stack(widths=widths, heights=heights, unit_weight=UNIT_WEIGHT)
    found = collapse_load(model(blocks, joint(2.0)), flow=flow)
    assert found.load_multiplier == pytest.approx(expected, abs=EXACT)


def corbel(overhang, n=6):
    """Blocks of width 1 m shifted by ``overhang`` times the harmonic stack's steps 1/(2 k)."""
    steps = [0.0] + [overhang / (2.0 * k) for k in range(n - 1, 0, -1)]
    blocks = stack(
        widths=[1.0] * n, heights=[0.1] * n, offsets=np.cumsum(steps), unit_weight=UNIT_WEIGHT
    )
    return model(blocks, joint(0.6))


def test_harmonic_stack_reaches_as_far_as_it_stands():
    # sum of 1/(2 k): the classical overhang.
    assert stands(corbel(0.999).assembly) and not stands(corbel(1.001).assembly)
    limit = least_standing(lambda x: corbel(2.0 - x), 0.5, 1.5)  # from falling to standing
    assert 2.0 - limit == pytest.approx(1.0, abs=1e-8)


def test_what_falls_is_named():
    found = collapse_load(corbel(1.2))
    assert found.status == "unstable" and np.isnan(found.load_multiplier)
    assert found.moving and all(name in found.reason for name in found.moving)
    assert "base" not in found.moving
    assert np.abs(found.velocities).max() > 0.0


@pytest.mark.parametrize("units", [6, 40])  # by the simplex and by the interior-point method
def test_what_need_not_fall_is_not_named(units):
    blocks = coursed_wall(
        unit=(0.4, 0.2),
        courses=("h" + (units - 1) * "1" + "h", units * "1"),
        repeat=4,
        base=True,
        unit_weight=UNIT_WEIGHT,
    )
    for i in range(2):  # two blocks in the air, one upon the other
        vertices = rectangle(-5.0, 2.0 + 0.2 * i, 0.4, 0.2)
        blocks.append(Block(id=f"loose{i}", vertices=vertices, unit_weight=UNIT_WEIGHT))
    found = collapse_load(model(blocks, joint(0.6)))
    assert (found.status, found.moving) == ("unstable", ("loose0", "loose1"))


def under_a_ceiling(friction=0.5):
    blocks = stack(widths=[0.4], heights=[0.4], unit_weight=UNIT_WEIGHT)
    blocks.append(
        Block(
            id="ceiling",
            vertices=rectangle(-1.0, 0.4, 2.0, 0.2),
            unit_weight=UNIT_WEIGHT,
            support=True,
        )
    )
    return model(blocks, joint(friction))


def test_a_ceiling_locks_joints_that_must_open_but_not_those_that_need_not():
    associative, other = collapse_loads(under_a_ceiling())
    assert associative.status == "locked" and associative.load_multiplier == np.inf
    assert "no finite multiplier" in associative.reason
    # Without dilatancy the block slides; how hard the ceiling presses is anyone's guess.
    assert other.status == "finished"
    assert other.load_multiplier == pytest.approx(0.5, abs=EXACT)
    assert other.collapse_range == (pytest.approx(0.5, abs=EXACT), np.inf)


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("yields_at", [1e6, 50.0])
def test_what_has_no_limit_of_strength_locks(flow, yields_at):
    """A flat block and a bar that pulls it back, of 50 times its weight or as good as endless."""
    weight = 2.0 * 0.5 * UNIT_WEIGHT
    bar = Tie(
        start=TieEnd(block="b1", point=(-1.0, 0.25)),
        end=TieEnd(point=(-3.0, 0.25)),
        stiffness=1e6,
        yield_force=yields_at * weight,
        compression=False,
    )
    blocks = stack(widths=[2.0], heights=[0.5], unit_weight=UNIT_WEIGHT)
    held = make_model(
        blocks, joint=joint(0.6), thickness=1.0, load_direction=(1.0, 0.0), ties=[bar]
    )
    found = collapse_load(held, flow=flow)
    if yields_at < 1e3:
        assert found.load_multiplier == pytest.approx(yields_at + 0.6, abs=EXACT)
    else:
        assert found.status == "locked" and found.load_multiplier == np.inf


def test_a_load_straight_down_locks():
    for found in collapse_loads(block(joint(0.5), direction=(0.0, -1.0))):
        assert (found.status, found.load_multiplier) == ("locked", np.inf)


@pytest.mark.parametrize("flow", FLOWS)
def test_a_load_straight_up_lifts_at_one(flow):
    found = collapse_load(block(joint(0.5), direction=(0.0, 1.0)), flow=flow)
    assert found.load_multiplier == pytest.approx(1.0, abs=EXACT)


def test_dilatancy_of_the_joint_is_the_flow():
    # With psi = phi the non-associative scheme is the associative one.
    law = joint(0.5, dilatancy_angle=float(np.degrees(np.arctan(0.5))))
    blocks = stack(widths=[0.4], heights=[0.4], unit_weight=UNIT_WEIGHT)
    a, b = collapse_loads(model(blocks, law))
    assert b.load_multiplier == pytest.approx(a.load_multiplier, abs=EXACT)
    sliding = b.velocities[1]
    assert sliding[1] / sliding[0] == pytest.approx(0.5, abs=1e-9)


def test_without_dilatancy_blocks_slide_along_the_joint():
    blocks = stack(widths=[0.4], heights=[0.4], unit_weight=UNIT_WEIGHT)
    found = collapse_load(model(blocks, joint(0.3)))
    assert found.velocities[1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    "settings",
    [NonAssociativeSettings(alpha=0.0, beta=b) for b in (0.2, 0.6, 1.0)]
    + [NonAssociativeSettings(alpha=0.01)],
)
def test_parameters_of_the_scheme_do_not_move_a_unique_multiplier(settings):
    found = collapse_load(block(joint(0.3)), settings=settings)
    assert found.load_multiplier == pytest.approx(0.3, abs=EXACT)


# arches


def arch(thickness, n_voussoirs, *, radius=10.0, embrace=180.0, friction=10.0):
    blocks = circular_arch(
        radius=radius,
        thickness=thickness,
        embrace=embrace,
        n_voussoirs=n_voussoirs,
        unit_weight=20e3,
    )
    return model(blocks, joint(friction))


def test_semicircular_arch_of_least_thickness():
    # Milankovitch (1907): 0.1075 of the mean radius for infinitely many voussoirs; that of 200
    # plane-faced ones differs by 1e-5.
    ratio = least_standing(lambda x: arch(10.0 * x, 200), 0.1, 0.12, tolerance=1e-6)
    assert ratio == pytest.approx(0.1075, abs=5e-5)


def test_least_thickness_does_not_depend_on_the_size():
    small, large = (
        least_standing(lambda x, r=radius: arch(r * x, 31, radius=r), 0.05, 0.2, tolerance=1e-8)
        for radius in (1.0, 100.0)
    )
    assert small == pytest.approx(large, abs=1e-7)


def test_search_wants_an_end_that_falls_and_one_that_stands():
    with pytest.raises(ValueError, match="it stands at"):
        least_standing(lambda x: arch(10.0 * x, 15), 0.15, 0.2)
    with pytest.raises(ValueError, match="it does not stand at"):
        least_standing(lambda x: arch(10.0 * x, 15), 0.04, 0.05)


@pytest.mark.parametrize("flow", FLOWS)
def test_arch_of_oppenheim(flow):
    # I. J. Oppenheim, The masonry arch as a four-link mechanism under base motion (1992): radius
    # 10 m, thickness 1.5 m, 157.5 degrees, 7 voussoirs; 0.37 g.
    found = collapse_load(arch(1.5, 7, embrace=157.5, friction=0.7), flow=flow)
    assert found.load_multiplier == pytest.approx(0.37, abs=0.005)


# theorems


@pytest.mark.parametrize("corner", [None, Corner(radius=0.02)])
def test_power_of_the_mechanism_gives_the_multiplier(corner):
    """The balance of power in newtons and metres per second, from velocities and blocks alone."""
    wall = [
        block
        for x in range(3)
        for block in stack(
            widths=[0.4, 0.3],
            heights=[0.5, 0.4],
            unit_weight=UNIT_WEIGHT,
            offsets=[0.4 * x, 0.4 * x],
            base=False,
        )
    ]
    names = iter(range(100))
    wall = [
        Block(id=f"b{next(names)}", vertices=b.vertices, unit_weight=b.unit_weight) for b in wall
    ]
    base = rectangle(-1.0, -0.3, 3.0, 0.3)
    wall.append(Block(id="base", vertices=base, unit_weight=1e4, support=True))
    structure = model(wall, joint(0.55), corner=corner)
    found = collapse_load(structure, flow="associative")
    assembly = structure.assembly
    weight = np.where(assembly.fixed, 0.0, assembly.weight)
    live, dead = weight @ found.velocities[:, 0], -weight @ found.velocities[:, 1]
    # Dry joints with associated flow dissipate nothing: lambda F.u + G.u = 0.
    assert -dead / live == pytest.approx(found.load_multiplier, abs=EXACT)
    assert found.duality_gap < EXACT and found.residual < EXACT


def against_a_support(gap=0.0):
    """A block on a plane with a fixed one beside it, on the side that the load pushes to."""
    blocks = stack(widths=[0.4], heights=[0.4], unit_weight=UNIT_WEIGHT)
    wall = rectangle(0.2 + gap, 0.0, 0.4, 0.4)
    blocks.append(Block(id="wall", vertices=wall, unit_weight=UNIT_WEIGHT, support=True))
    return blocks


def test_a_block_pushed_against_a_support_is_locked():
    assert is_locked(model(against_a_support(), joint(0.5)))
    # Pulled away it slides at the friction coefficient, and with a gap it moves into that.
    assert not is_locked(model(against_a_support(), joint(0.5), direction=(-1.0, 0.0)))
    assert not is_locked(model(against_a_support(gap=0.05), joint(0.5)))


@pytest.mark.parametrize(("slope", "locked"), [(0.45, True), (0.55, False)])
def test_a_load_within_the_friction_cone_locks(slope, locked):
    # Whatever its multiple, a force within the cone of tan 0.5 does not move a squat block.
    direction = (slope, -1.0)
    squat = stack(widths=[1.0], heights=[0.2], unit_weight=UNIT_WEIGHT)
    assert is_locked(model(squat, joint(0.5), direction=direction)) is locked


def test_what_only_dilatancy_locks_is_not_locked():
    assert not is_locked(under_a_ceiling())


def test_an_arch_is_not_locked_between_its_abutments():
    # No motion of the arch as one body leaves both: a linear program has to say it.
    arch = circular_arch(
        radius=10.0, thickness=1.5, embrace=157.5, n_voussoirs=7, unit_weight=UNIT_WEIGHT
    )
    assert not is_locked(model(arch, joint(0.75)))


@pytest.mark.parametrize("wall", PUBLISHED_WALLS)
def test_walls_are_cleared_without_a_linear_program(wall, monkeypatch):
    monkeypatch.setattr("drystone.limit.associative._strongest", None)  # calling it would fail
    assert not is_locked(published_wall(wall))
