"""What builders build, by limit analysis against published figures and closed forms.

Sources: M. Milankovitch, *Theorie der Druckkurven*, Z. Math. Phys. 55 (1907), and J. Ochsendorf,
*Collapse of masonry structures* (2002): a semicircular arch of infinitely many voussoirs stands
from a thickness of 0.1075 of its mean radius on.  A. Sinopoli, M. Corradi & F. Foce, J. Eng. Mech.
123 (1997): it needs more than that where the friction coefficient is below 0.395, and with less
than 0.309 it never stands.  I. J. Oppenheim, Earthq. Eng. Struct. Dyn. 21 (1992): an arch of seven
voussoirs, an embrace of 157.5 degrees and a thickness of 0.15 of the radius moves from 0.37 g on.
J. Heyman, *The stone skeleton* (1995): a hemisphere without friction's limit 0.042 of the radius,
0.0427 of 16 rings by 24 sectors.
"""

from itertools import combinations, product

import numpy as np
import pytest

from drystone.limit import ASSOCIATIVE, collapse_load, least_standing, stands
from drystone.model.builders import (
    arch,
    barrel_vault,
    column,
    dome,
    drum_column,
    groin_vault,
    make_model,
    placed,
    portal,
    tower,
)
from drystone.model.joint_law import JointLaw

W = {"unit_weight": 20e3}
ROUGH = 10.0  # friction that nothing slides at


def model_of(blocks, friction=ROUGH):
    """The blocks pushed along x."""
    dimension = blocks[0].dimension
    law = JointLaw(friction_coefficient=friction, normal_stiffness=None, shear_stiffness=None)
    return make_model(
        blocks,
        joint=law,
        load_direction=[1.0, 0.0, 0.0][:dimension],
        thickness=1.0 if dimension == 2 else None,
    )


def multiplier(blocks, friction=ROUGH):
    return collapse_load(model_of(blocks, friction), flow=ASSOCIATIVE).load_multiplier


def semicircle(thickness, friction=ROUGH, voussoirs=101):
    """Of mean radius 1 m."""
    made = arch(span=2.0 - thickness, thickness=thickness, voussoirs=voussoirs, abutments=True, **W)
    return model_of(made, friction)


def test_least_thickness_of_a_semicircular_arch():
    """Hinges only at joints hold a few voussoirs up longer: 0.1074 of 51, 0.10747 of 201."""
    few, many = (
        least_standing(lambda t, n=n: semicircle(t, voussoirs=n), 0.08, 0.14, tolerance=1e-5)
        for n in (51, 201)
    )
    assert few < many < 0.1075
    assert many == pytest.approx(0.1075, abs=5e-5)  # half a unit of the last published digit


def test_least_friction_of_a_semicircular_arch():
    """Below 0.395 it has to be thicker; below 0.309 no thickness helps."""
    enough = 1.001 * 0.1075  # beside the bisection's tolerance of 101 voussoirs
    assert stands(semicircle(enough, 0.3965).assembly)
    assert not stands(semicircle(enough, 0.393).assembly)
    assert stands(semicircle(0.25, 0.32).assembly)
    assert not any(stands(semicircle(t, 0.3).assembly) for t in (0.2, 0.4, 0.8))


def test_oppenheims_arch():
    radius, thickness, half = 10.0, 1.5, np.radians(0.5 * 157.5)
    inner = radius - 0.5 * thickness
    made = arch(
        span=2.0 * inner * np.sin(half), rise=inner * (1.0 - np.cos(half)), thickness=thickness,
        voussoirs=7, abutments=True, **W,
    )  # fmt: skip
    # Published to two digits; his hinges are in the arcs, ours in the corners of voussoirs.
    assert multiplier(made) == pytest.approx(0.37, abs=0.005)


def test_a_barrel_vault_stands_as_its_arch_does():
    """In running bond, pushed across; stones of one course move as one."""
    measures = {"span": 2.0, "thickness": 0.3, "voussoirs": 9, "abutments": True, **W}
    deep = barrel_vault(length=1.2, unit=0.4, **measures)
    assert multiplier(deep) == pytest.approx(multiplier(arch(**measures)), rel=1e-6)


def test_columns_turn_over_their_edges():
    """b / h of a column; of a drum column in octagons the distance of a side over half the
    height, tapered drums over that of their centroid."""
    made = column(width=0.4, depth=0.7, height=2.0, n_blocks=4, base=True, **W)
    assert multiplier(made) == pytest.approx(0.2, rel=1e-6)
    side = 0.5 * np.cos(np.pi / 8)
    for top in (1.0, 0.6):
        made = drum_column(diameter=1.0, top_diameter=top, height=4.0, drums=5, sides=8, **W)
        middle = (1.0 + 2.0 * top + 3.0 * top**2) / (1.0 + top + top**2)  # of a frustum's height
        assert multiplier(placed(made, base=True)) == pytest.approx(side / middle, rel=1e-6)


def test_a_trilith_sways():
    """Posts turn about their toes by t: the lintel goes h t along and b t up, as do, by halves,
    their own weights; so that the multiplier is b / h whatever the lintel weighs."""
    for thickness in (0.3, 0.9):
        made = portal(
            span=2.0, thickness=thickness, shape="lintel", pier_width=0.6, pier_height=2.4,
            unit=(0.6, 2.4), **W,
        )  # fmt: skip
        assert multiplier(placed(made, base=True)) == pytest.approx(0.6 / 2.4, rel=1e-6)


def hemisphere(ratio, friction, bond="stack", sectors=24):
    """A dome of mean radius 1 m, closed at the crown."""
    made = dome(span=2.0 - ratio, thickness=ratio, rings=16, sectors=sectors, bond=bond, **W)
    return model_of(placed(made, base=True), friction)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.25, ROUGH])
def test_least_thickness_of_a_dome(friction):
    """To 1 % of the mean radius; stones in running bond hold each other, and it may be thinner."""
    assert stands(hemisphere(1.01 * 0.0427, friction).assembly)
    assert not stands(hemisphere(0.99 * 0.0427, friction).assembly)
    assert stands(hemisphere(0.99 * 0.0427, friction, "running", 12).assembly)


def test_a_groin_vault_needs_its_groins():
    """Stones that bend around the groins carry what stones mitred along them carry, and more."""
    measures = {"span": 3.0, "thickness": 0.4, "voussoirs": 9, "unit": 0.6, **W}
    bent, mitred = (
        multiplier(placed(groin_vault(**measures, mitred=mitred), base=True), 0.7)
        for mitred in (False, True)
    )
    assert 0.0 < mitred <= bent * (1.0 + 1e-6)


def test_a_square_tower_turns_over_its_foot():
    """As one body where nothing slides and courses interlock: width over height."""
    made = tower(width=2.0, thickness=0.4, height=4.0, unit=(0.8, 0.4), shape="square", **W)
    assert multiplier(placed(made, base=True)) == pytest.approx(2.0 / 4.0, rel=1e-6)


def chain_of(assembly):
    """Ends (2, 2) of the joints of blocks in a row from the ground to the ground, and weights and
    centroids of the blocks between them."""
    joints = assembly.interfaces
    own, left, at = [], list(range(len(joints.size))), int(np.flatnonzero(assembly.fixed)[0])
    bodies = []
    while left:
        k = next(i for i in left if at in (joints.block_a[i], joints.block_b[i]))
        left.remove(k)
        own.append(joints.corners[2 * k : 2 * k + 2])
        at = int(joints.block_a[k] + joints.block_b[k] - at)
        bodies.append(at)
    return own, assembly.weight[bodies[:-1]], assembly.centroid[bodies[:-1]]


def least_of_four_hinges(joints, weights, centroids):
    """Least multiplier along x of all mechanisms of four hinges in corners of joints.

    Of three links the first and the last turn about their hinges on the ground, the second about
    the point where the lines through the other two hinges of either meet; every joint opens at
    its other corner.  The works of the weights and of the load add up to nothing.
    """
    ahead = []  # across each joint, from the block before to that behind it
    for k, ends in enumerate(joints):
        inside, sign = (centroids[k], 1.0) if k < len(weights) else (centroids[k - 1], -1.0)
        along = ends[1] - ends[0]
        normal = np.array([along[1], -along[0]])
        ahead.append(sign * np.sign(normal @ (inside - ends.mean(axis=0))) * normal)
    least = np.inf
    for rows in combinations(range(len(joints)), 4):
        link = np.searchsorted(rows, np.arange(len(weights)), side="right")
        for corners in product((0, 1), repeat=4):
            a, b, c, d = p = [joints[row][k] for row, k in zip(rows, corners, strict=True)]
            lines = np.column_stack((b - a, d - c))
            if abs(np.linalg.det(lines)) < 1e-9:
                continue
            share = np.linalg.solve(lines, d - a)
            centre = a + share[0] * (b - a)
            # The second link turns by one, either way; at b and c it moves as the others do.
            spins = np.array([0.0, 1.0 - share[0], 1.0, (c - centre) @ (c - d), 0.0])
            spins[3] /= (c - d) @ (c - d)
            arm = centroids - np.array([a, a, centre, d, d])[link]
            work = weights * spins[link] @ np.column_stack((-arm[:, 1], arm[:, 0]))
            for way in (1.0, -1.0):
                opening = [
                    way * (spins[k + 1] - spins[k]) * _turned(joints[row][1 - corners[k]] - p[k])
                    @ ahead[row]
                    for k, row in enumerate(rows)
                ]  # fmt: skip
                if min(opening) > 1e-9 and way * work[0] > 0.0:
                    least = min(least, work[1] / work[0])
    return least


def _turned(arm):
    return np.array([-arm[1], arm[0]])


def test_arches_on_piers_turn_about_four_hinges():
    """Against all mechanisms of four hinges, one by one: kinematics, where limit analysis finds
    forces."""
    measures = {"span": 2.0, "thickness": 0.35, "voussoirs": 7}
    cases = []
    for pier_height, pier_width in ((0.8, 0.6), (1.6, 0.8)):
        made = portal(
            **measures,
            pier_width=pier_width,
            pier_height=pier_height,
            unit=(pier_width, pier_height),
            **W,
        )
        cases.append(placed(made, base=True))
    for blocks in cases:
        model = model_of(blocks)
        found = collapse_load(model, flow=ASSOCIATIVE).load_multiplier
        assert found == pytest.approx(least_of_four_hinges(*chain_of(model.assembly)), rel=1e-6)
