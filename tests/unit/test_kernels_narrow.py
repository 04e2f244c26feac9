"""Contacts between convex blocks: distances, exact derivatives, areas, identity.

The distances are judged by brute force over all vertices and edges, the derivatives by central
differences.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from unittest import mock

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from builders import (
    UNIT_WEIGHT,
    approach,
    contacts_of,
    convex_polygons,
    rectangle,
    turned,
    with_corner,
)
from drystone.contact.contacts import (
    INTACT,
    LIFT,
    NONE,
    SIZE,
    STIFF_N,
    VERTEX_A,
    VERTEX_B,
    VERTICES,
    Contacts,
    Slots,
)
from drystone.contact.histories import predecessor_pairs
from drystone.contact.plane import narrow, rows
from drystone.geometry import GeometryError, broad
from drystone.geometry.broad import candidate_pairs
from drystone.law import packing
from drystone.law import plane as plane_law
from drystone.law.branches import BACKWARD, BONDED, FORWARD, OPEN, STICKING
from drystone.law.columns import (
    BROKEN,
    COHESION,
    DILATANCY_END,
    N_HISTORY,
    N_LAW,
    SHEAR,
    TAN_PSI,
    TENSION,
)
from drystone.linear.symbolic import Tangent
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.builders import published_wall
from drystone.model.joint_law import JointLaw
from drystone.statics.plane import contacts as step_contacts
from interpreted import fewer

pytestmark = pytest.mark.kernels

# Sums of products of lengths below 10 m: a few rounding errors of 1e-15.
ROUNDING = 1e-12

angles = st.floats(-np.pi, np.pi)


def pair_of(a, b, *, radius=0.0, friction=0.3, shear_stiffness=1e6, first_fixed=False):
    """Two blocks in one assembly."""
    return Assembly.build(
        [
            Block(id="a", vertices=a, unit_weight=UNIT_WEIGHT, support=first_fixed),
            Block(id="b", vertices=b, unit_weight=UNIT_WEIGHT),
        ],
        joint=JointLaw(
            friction_coefficient=friction, normal_stiffness=1e6, shear_stiffness=shear_stiffness
        ),
        corner=Corner(radius=radius or None),
    )


@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("radius", [0.0, 0.02])
def test_gaps_are_as_precise_as_displacements_however_far_away(angle, radius):
    """A joint closes by a millionth of the rounding of its place, and the gap says by how much."""
    place = np.array([1e3, -7e2])
    lower = turned(rectangle(0.0, -0.3, 1.0, 0.3), angle) + place
    upper = turned(rectangle(0.1, 0.0, 0.7, 0.3), angle) + place
    assembly = pair_of(lower, upper, radius=radius)
    pose = assembly.design_pose()
    detector, pairs, slots = contacts_of(assembly, pose)
    before, used = slots.gap.copy(), slots.kind != NONE
    moved, turn = 1e-10, 1e-10
    normal = np.array([-np.sin(angle), np.cos(angle)])
    pose[1] = *(-moved * normal), turn
    detector.fill(pairs, pose, slots)
    along = slots.arm_b[used] @ [np.cos(angle), np.sin(angle)]
    # But for the constant that the designed places' rounding makes of the gap: the spacing of
    # doubles there; and the second order of the motion, some 1e-20.
    error = slots.gap[used] - before[used] - (turn * along - moved)
    assert np.abs(error).max() < 1e-20 + np.spacing(np.abs(before[used]).max())


class TestBroadPhase:
    @given(
        st.lists(
            st.tuples(
                st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(0.0, 2.0), st.floats(0.0, 2.0)
            ),
            max_size=40,
        )
    )
    def test_equals_brute_force(self, boxes):
        boxes = np.array(boxes).reshape(-1, 4)
        lower, upper = boxes[:, :2], boxes[:, :2] + boxes[:, 2:]
        expected = [
            (i, j)
            for i in range(len(boxes))
            for j in range(i + 1, len(boxes))
            if np.all(lower[i] <= upper[j]) and np.all(lower[j] <= upper[i])
        ]
        for few in (broad.FEW, 0):  # all with all, and by a grid
            with mock.patch.object(broad, "FEW", few):
                a, b = candidate_pairs(lower, upper)
            assert list(zip(a.tolist(), b.tolist(), strict=True)) == expected

    def test_one_huge_box_among_small_ones(self):
        # A base under a long row: no pair is lost, none comes twice.
        x = 0.5 * np.arange(200.0)  # exact in binary
        lower = np.vstack(([[-1.0, -1.0]], np.column_stack((x, 0.0 * x))))
        upper = np.vstack(([[101.0, 0.0]], np.column_stack((x + 0.5, 0.0 * x + 0.2))))
        a, b = candidate_pairs(lower, upper)
        pairs = set(zip(a.tolist(), b.tolist(), strict=True))
        assert len(pairs) == len(a)
        assert pairs >= {(0, i) for i in range(1, 201)} | {(i, i + 1) for i in range(1, 200)}

    @pytest.mark.parametrize("n", [0, 1])
    def test_too_few_boxes_for_a_pair(self, n):
        a, b = candidate_pairs(np.zeros((n, 2)), np.ones((n, 2)))
        assert len(a) == len(b) == 0


class TestDistance:
    """The smallest gap of a pair is the distance of its rounded shapes, whatever the corners."""

    @staticmethod
    def apart(p, q, angle, radius, wanted):
        """Two blocks ``wanted`` [m] apart, core from core, the second come from anywhere."""
        u = np.array([np.cos(angle), np.sin(angle)])
        try:
            assembly = pair_of(p, q + 5.0 * u, radius=radius)
        except GeometryError:
            assume(False)  # the corner leaves nothing of an edge
        return assembly, *approach(assembly, -u, wanted)

    # A core as far from the other as 0.5 r presses 1.5 r into it, rounding included.
    @given(
        convex_polygons(),
        convex_polygons(),
        angles,
        st.sampled_from((0.005, 0.02)),
        st.floats(0.5, 4.0),
    )
    @settings(max_examples=fewer(300, 60))
    def test_of_rounded_blocks(self, p, q, angle, radius, share):
        assembly, pose, apart, _ = self.apart(p, q, angle, radius, share * radius)
        detector, _, slots = contacts_of(assembly, pose)
        gap = apart - 2.0 * radius
        if gap < detector.reach:
            assert slots.gap.min() == pytest.approx(gap, abs=1e-9)
        else:
            assert not slots.kind.any()

    @given(convex_polygons(), convex_polygons(), angles, st.floats(1e-6, 0.03))
    @settings(max_examples=fewer(300, 60))
    def test_of_sharp_blocks(self, p, q, angle, wanted):
        # Two sharp vertices have no common normal, and make no contact; an edge and a vertex do.
        assembly, pose, apart, vertices = self.apart(p, q, angle, 0.0, wanted)
        detector, _, slots = contacts_of(assembly, pose)
        assume(apart < detector.reach)
        if vertices and apart < narrow.SAME_CORNER * 2.4:  # edges of up to 1.2 m: one corner
            assert np.abs(slots.gap).min() <= apart + 1e-9 or not slots.kind.any()
        elif vertices:
            assert slots.gap.min() >= apart - 1e-9
        else:
            assert slots.gap.min() == pytest.approx(apart, abs=1e-9)

    @pytest.mark.parametrize("radius", [0.005, 0.02])
    @pytest.mark.parametrize("degrees", [-33.0, 33.0])
    @pytest.mark.parametrize("end", [-1.0, 1.0])
    @pytest.mark.parametrize("overhang", [0.02, 0.05, 0.1])
    @pytest.mark.parametrize("clearance", [-0.001, 0.0, 0.001])
    def test_of_a_tilted_block_past_the_end_of_another(
        self, radius, degrees, end, overhang, clearance
    ):
        # The unit of the published walls, turned by 33 degrees above another and hanging past an
        # end of it: the vertex of the lower block lies inside an edge of the upper one, while the
        # edges that face each other most may well touch nothing.
        unit = rectangle(-0.2, -0.0875, 0.4, 0.175)
        above = unit + (end * (0.2 + overhang), 1.0)
        assembly = pair_of(unit, above, radius=radius, first_fixed=True)
        down, wanted = np.array([0.0, -1.0]), 2.0 * radius + clearance
        pose, apart, _ = approach(assembly, down, wanted, angle=np.radians(degrees))
        _, _, slots = contacts_of(assembly, pose)
        gap = apart - 2.0 * radius
        assert gap == pytest.approx(clearance, abs=1e-8)
        assert slots.gap.min() == pytest.approx(gap, abs=1e-9)


class TestPressed:
    @given(angles, st.floats(1e-5, 5e-3), st.sampled_from((0.0, 0.02)))
    def test_equal_blocks_right_above_each_other_keep_both_points(self, angle, depth, radius):
        """Their corners coincide but for rounding, however deep they are pressed."""
        unit = rectangle(-0.2, -0.1, 0.4, 0.2)
        lower, upper = (turned(unit + (0.0, y), angle, (3.0, -2.0)) for y in (0.0, 0.2))
        assembly = pair_of(lower, upper, radius=radius)
        pose = np.zeros((2, 3))
        pose[1, :2] = depth * np.array([np.sin(angle), -np.cos(angle)])
        _, _, slots = contacts_of(assembly, pose)
        assert np.all(slots.kind != NONE)
        assert slots.gap == pytest.approx(-depth, abs=ROUNDING)
        assert slots.size == pytest.approx(0.2, abs=ROUNDING)

    @staticmethod
    def flush(end, depth, radius=0.0):
        """Two equal blocks, one end in line and pressed by ``depth`` [m], core from core.

        The upper one is tilted so that each corner lies beyond the other edge's end by a hair.
        """
        unit, tilt = rectangle(-0.2, -0.1, 0.4, 0.2), 1e-3 * end * np.sign(depth)
        assembly = pair_of(unit, unit + (0.0, 0.2), radius=radius)
        corner = np.array([(0.2 - radius) * end, 0.1 - radius])
        arm = corner * (1.0, -1.0)
        c, s = np.cos(tilt), np.sin(tilt)
        turned_arm = np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])
        pose = np.zeros((2, 3))
        pose[1, :2] = corner + (0.5 * depth * tilt, -depth) - turned_arm - (0.0, 0.2)
        pose[1, 2] = tilt
        return contacts_of(assembly, pose)[2]

    @pytest.mark.parametrize("end", [-1.0, 1.0])
    @pytest.mark.parametrize("depth", [3e-4, -3e-4])
    def test_flush_ends_that_neither_edge_covers_keep_their_point(self, end, depth):
        slots = self.flush(end, depth)
        assert np.all(slots.kind != NONE)
        assert np.abs(slots.gap + depth).min() < 1e-3 * abs(depth)

    @pytest.mark.parametrize("end", [-1.0, 1.0])
    @pytest.mark.parametrize("share", [1e-6, 0.05])
    def test_cores_that_have_passed_each_other_keep_their_direction(self, end, share):
        """Corners rounded by half of what their joint closes by."""
        slots = self.flush(end, share * 1e-4, radius=1e-4)
        assert np.all(slots.kind != NONE)
        assert np.abs(slots.gap + 2e-4).min() < 2e-4 * share
        np.testing.assert_allclose(slots.normal, [(0.0, 1.0)] * 2, atol=1.1e-3)


def configurations(radius, n=40, pressed=True):
    """Pairs of blocks that press on each other or just touch, in every kind of contact there is.

    Small and large angles, edges on edges, vertices on edges of either block, and (with rounded
    corners) vertices on vertices beside each other's ends.
    """
    random = np.random.default_rng(7)
    unit = rectangle(-0.2, -0.1, 0.4, 0.2)
    for i in range(n):
        angle = (1e-3 * random.normal(), random.uniform(0.05, 0.75), -random.uniform(0.05, 0.75))[
            i % 3
        ]
        x = random.uniform(-0.39, 0.39)
        if radius and i % 4 == 3:  # the discs at two corners, beside each other
            x, angle = 0.4 - radius * random.uniform(0.8, 1.2), 0.03 * random.normal()
        side = 1.0 if i % 2 else -1.0  # the first block is below or above
        assembly = pair_of(
            unit, unit + (x, side), radius=radius, shear_stiffness=(1e6, 1e4)[i // 2 % 2]
        )
        depth = radius * random.uniform(0.3, 0.5) if pressed else 0.0
        pose, _, _ = approach(assembly, np.array([0.0, -side]), 2.0 * radius - depth, angle)
        if pressed and not radius:
            pose[1, 1] -= 3e-3 * side
        yield assembly, pose


class JointOfPair:
    """Gaps, slips and forces of one pair as functions of the motion since the start of the step.

    The features that touch at the start are followed.  Slips are exact, or linear by the gradients
    half way through the step, as they are for contacts that were there when it began.
    """

    def __init__(
        self, assembly, pose, *, friction=0.3, tan_psi=0.0, bond=0.0, shear=0.0, linear=None
    ):
        self.assembly, self.pose = assembly, pose
        self.detector, self.pairs, self.known = contacts_of(assembly, pose)
        n = len(self.known.kind)
        self.slots = Slots.empty(self.pairs.n_slots, 2)
        self.known.size[:] = 0.1  # fixed within a step, as engines do
        self.laws = np.zeros((1, N_LAW))
        law = assembly.joint
        self.laws[0, : TAN_PSI + 1] = (
            friction, law.normal_stiffness, law.shear_stiffness, tan_psi,
        )  # fmt: skip
        self.laws[0, [COHESION, TENSION]] = bond
        self.laws[0, DILATANCY_END] = np.inf
        self.history = np.zeros((n, N_HISTORY))
        self.history[:, SHEAR] = shear
        self.there, self.lines = np.zeros(n, np.bool_), np.zeros((n, 2, 6))
        if linear is not None:
            self.there[:] = True
            half = Slots.empty(self.pairs.n_slots, 2)
            self.detector.follow(self.pairs, pose + 0.5 * linear, self.known, half)
            rows.slot_rows(half, self.lines)

    def at(self, increment):
        n = len(self.slots.kind)
        self.detector.follow(self.pairs, self.pose + increment, self.known, self.slots)
        self.force, carried = np.zeros((2, 3)), np.zeros((n, 3))
        branch, response = np.full(n, -1), np.zeros((n, 3, 3))
        self.contacts = Contacts.empty(n, 2, 3)
        self.count = packing.pack_laws(self.known, self.pairs, self.laws, 1.0, self.contacts)
        table, count = self.contacts.table, self.count
        table[:count, LIFT] = table[:count, STIFF_N] * self.laws[0, TAN_PSI]
        bonded = self.laws[0, COHESION] + self.laws[0, TENSION] > 0.0
        table[:count, INTACT] = bonded & (self.history[self.contacts.slot[:count], BROKEN] == 0.0)
        step_contacts.locate(
            self.slots, self.history, self.there, self.lines, self.contacts, count, increment,
            np.zeros((n, 3)),
        )  # fmt: skip
        plane_law.choose(table, 0, count, branch)
        plane_law.respond(table, 0, count, branch, carried, response)
        step_contacts.sum_forces(self.contacts, count, carried, self.force)
        self.by_contact, used = (branch, carried), self.contacts.slot[:count]
        self.branch, self.reaction = np.full(n, -1), np.zeros((n, 2))
        self.branch[used], self.reaction[used] = branch[:count], carried[:count, :2]
        return self

    def linearised(self, motion):
        """Forces at ``motion`` from where the pair is, to first order, and the tangent (6, 6)."""
        contacts = Contacts._make(array.copy() for array in self.contacts)
        n_pairs, force = len(self.pairs.a), np.full((2, 3), np.nan)
        blocks, bent = (
            Tangent(*(np.full((n, 3, 3), np.nan) for n in (2, n_pairs, n_pairs))) for _ in range(2)
        )
        every = contacts, self.count
        step_contacts.move_trial(*contacts, self.count, motion)
        branch, carried = self.by_contact
        reaction, response = np.zeros_like(carried), np.zeros((len(carried), 3, 3))
        plane_law.respond(contacts.table, 0, self.count, branch, reaction, response)
        step_contacts.geometric_stiffness(self.slots, *every, carried, bent)
        step_contacts.assemble(
            *every, self.pairs.which[:, :2], reaction, response, bent, motion, force, blocks
        )  # fmt: skip
        diagonal, upper, lower = blocks
        top, bottom = np.hstack((diagonal[0], upper[0])), np.hstack((lower[0], diagonal[1]))
        return force, np.vstack((top, bottom))

    def mapping(self):
        packed = self.contacts.of(slice(self.count))
        return packed.slot, packed.rows[:, :2]


def central_differences(evaluate, at, step=1e-6):
    """Derivatives by all six motions, with the value at each; a trial costs two evaluations."""
    columns = []
    for j in range(6):
        e = np.zeros(6)
        e[j] = step
        e = e.reshape(2, 3)
        columns.append((evaluate(at + e) - evaluate(at - e)) / (2.0 * step))
    return np.stack(columns, axis=-1)


class TestDerivatives:
    """Steps of 1e-6 leave an error of 1e-12 / 6 times the third derivative, which is of order
    1 / d^2 of the least distance d of cores (millimetres), and rounding of 1e-16 / 1e-6."""

    @staticmethod
    def smooth(pair, increment, step=1e-6):
        """Whether no branch of the law ends within the step of the differences."""
        here = pair.at(increment).branch.tolist()
        for j in range(12):
            e = np.zeros(6)
            e[j % 6] = step if j < 6 else -step
            if pair.at(increment + e.reshape(2, 3)).branch.tolist() != here:
                return False
        return True

    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_of_gap_and_slip_are_the_contact_mapping(self, radius):
        random = np.random.default_rng(1)
        seen = Counter()
        for assembly, pose in configurations(radius):
            # Friction without end: the shear is the slip times the stiffness.
            pair = JointOfPair(assembly, pose, friction=1e9)
            increment = 1e-3 * random.normal(size=(2, 3))
            if not self.smooth(pair, increment):
                continue
            used, rows = pair.at(increment).mapping()
            pressed = pair.branch[used] != OPEN
            kinds = pair.slots.kind[used]
            stiffness = assembly.joint.shear_stiffness * 0.1

            def gap(x, pair=pair, used=used):
                return pair.at(x).slots.gap[used]

            def slip(x, pair=pair, used=used, stiffness=stiffness):
                return -pair.at(x).reaction[used, 1] / stiffness

            assert rows[:, 0] == pytest.approx(central_differences(gap, increment), abs=1e-7)
            differences = central_differences(slip, increment)
            assert rows[pressed, 1] == pytest.approx(differences[pressed], abs=1e-7)
            seen.update(kinds[pressed].tolist())
        kinds = {VERTEX_A, VERTEX_B, VERTICES} if radius else {VERTEX_A, VERTEX_B}
        assert set(seen) == kinds and min(seen.values()) >= 3

    def pressed(self, radius, tan_psi, linear, bond=0.0):
        """Pairs in contact and their motions, away from where a branch of the law ends."""
        random = np.random.default_rng(2)
        for assembly, pose in configurations(radius):
            increment = 1e-3 * random.normal(size=(2, 3))
            pair = JointOfPair(
                assembly, pose, tan_psi=tan_psi, bond=bond, shear=300.0 * random.normal(),
                linear=increment if linear else None,
            )  # fmt: skip
            if self.smooth(pair, increment) and pair.at(increment).branch.any():
                yield pair, increment

    @pytest.mark.parametrize("tan_psi", [0.0, 0.2])
    @pytest.mark.parametrize("linear", [False, True], ids=["exact slip", "linear slip"])
    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_of_forces_are_the_tangent(self, radius, linear, tan_psi):
        seen = Counter()
        for pair, increment in self.pressed(radius, tan_psi, linear):
            here, branch = pair.force, pair.branch
            force, tangent = pair.linearised(np.zeros((2, 3)))
            assert force == pytest.approx(here, abs=ROUNDING * np.abs(here).max())

            def force_at(x, pair=pair):
                return pair.at(x).force.ravel()

            numerical = -central_differences(force_at, increment)
            assert tangent == pytest.approx(numerical, abs=1e-6 * np.abs(numerical).max())
            seen.update(zip(pair.slots.kind.tolist(), branch.tolist(), strict=True))
        for kind in {VERTEX_A, VERTEX_B, VERTICES} if radius else {VERTEX_A, VERTEX_B}:
            assert seen[kind, STICKING] >= 1
            assert seen[kind, FORWARD] + seen[kind, BACKWARD] >= 1
        for branch in (OPEN, STICKING, FORWARD, BACKWARD):
            assert sum(n for (kind, b), n in seen.items() if kind and b == branch) >= 2

    @pytest.mark.parametrize("linear", [False, True], ids=["exact slip", "linear slip"])
    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_of_bonded_forces_are_the_tangent(self, radius, linear):
        """Reactions of a bond are held beyond friction's limit and in tension."""
        beyond = pulled = 0
        for pair, increment in self.pressed(radius, 0.2, linear, bond=2e4):
            bonded, (rn, rt) = pair.branch == BONDED, pair.reaction.T
            beyond += np.sum(bonded & (np.abs(rt) > 0.3 * rn))
            pulled += np.sum(bonded & (rn < 0.0))
            _, tangent = pair.linearised(np.zeros((2, 3)))

            def force_at(x, pair=pair):
                return pair.at(x).force.ravel()

            numerical = -central_differences(force_at, increment)
            assert tangent == pytest.approx(numerical, abs=1e-6 * np.abs(numerical).max())
        assert beyond >= 3 and pulled >= 3

    @pytest.mark.parametrize("linear", [False, True], ids=["exact slip", "linear slip"])
    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_forces_at_a_motion_are_those_of_the_tangent(self, radius, linear):
        """Also where a motion changes the sign of the trial reactions: branches stay as given."""
        random = np.random.default_rng(5)
        for pair, _ in self.pressed(radius, 0.2, linear):
            motion = 1e-3 * random.normal(size=(2, 3))
            here, at_rest = pair.linearised(np.zeros((2, 3)))
            force, tangent = pair.linearised(motion)
            expected = here.ravel() - at_rest @ motion.ravel()
            scale = np.abs(at_rest).max() * np.abs(motion).max() + np.abs(here).max()
            assert force.ravel() == pytest.approx(expected, abs=1e-12 * scale)
            assert np.array_equal(tangent, at_rest)

    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_slips_half_way_are_of_second_order(self, radius):
        """By the gradients half way, the error of a slip falls with the third power of the step."""
        for assembly, pose in configurations(radius, n=12):
            motion = np.random.default_rng(3).normal(size=(2, 3))
            stiffness = assembly.joint.shear_stiffness * 0.1
            errors, pressed = [], np.ones(2, bool)
            for size in (1e-3, 2.5e-4):
                exact = JointOfPair(assembly, pose, friction=1e9).at(size * motion)
                linear = JointOfPair(assembly, pose, friction=1e9, linear=size * motion)
                linear.at(size * motion)
                pressed &= exact.branch != OPEN
                errors.append(np.abs(exact.reaction[:, 1] - linear.reaction[:, 1]) / stiffness)
            # 64 times less at a quarter; of second order it would be 16 times.  Rounding aside.
            assert np.all(errors[1][pressed] <= errors[0][pressed] / 32.0 + 1e-14)

    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_followed_contacts_are_those_that_are_found(self, radius):
        for assembly, pose in configurations(radius):
            pair = JointOfPair(assembly, pose)
            increment = 1e-3 * np.random.default_rng(4).normal(size=(2, 3))
            pair.at(increment)
            _, pairs, found = contacts_of(assembly, pose + increment)
            assert pairs.a.tolist() == pair.pairs.a.tolist()
            same = (found.kind == pair.slots.kind) & np.all(
                found.feature == pair.slots.feature, axis=1
            )
            used = np.flatnonzero(same & (found.kind != NONE))
            # All but lengths, which are those of the start.
            mine, theirs = (np.delete(s.value[used], SIZE, axis=1) for s in (pair.slots, found))
            assert mine == pytest.approx(theirs, abs=ROUNDING)

    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_rigid_motion_of_both_moves_no_joint(self, radius):
        # A motion of the pair as one: no gap changes, nothing slips.
        for assembly, pose in configurations(radius, n=12):
            pair = JointOfPair(assembly, pose, friction=1e9)
            before = pair.at(np.zeros((2, 3))).slots.gap.copy()
            angle = 0.3
            centre = assembly.centroid + pair.pose[:, :2]
            increment = np.column_stack((turned(centre, angle) - centre + (0.1, -0.2), [angle] * 2))
            pair.at(increment)
            used = np.flatnonzero(pair.slots.kind)
            assert len(used) > 0
            assert pair.slots.gap[used] == pytest.approx(before[used], abs=ROUNDING)
            # The shear stiffness times the rounding of a slip.
            assert pair.reaction[used, 1] == pytest.approx(0.0, abs=1e6 * ROUNDING)


class TestKinematics:
    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_the_mapping_is_the_relative_motion_of_the_touching_points(self, radius):
        """By rigid kinematics at the point where the shapes touch, rolling included.

        A body's material point at p moves by u + w x (p - x); the contact sees the difference of b
        and a along the normal and along the tangent (n_y, -n_x).  Points that only just touch have
        one such p, whatever rolls on what.
        """
        seen = Counter()
        for assembly, pose in configurations(radius, pressed=False):
            _, pairs, slots = contacts_of(assembly, pose)
            used = np.flatnonzero(slots.kind)
            gradients = np.zeros((len(slots.kind), 2, 6))
            rows.slot_rows(slots, gradients)
            for row, k in zip(gradients[used], used, strict=True):
                kind, n = slots.kind[k], slots.normal[k]
                if abs(slots.gap[k]) > 1e-8:
                    continue
                # From the vertex that touches, or the two, to the surface of its disc.
                from_a = slots.arm_a[k] + radius * n * (-1.0 if kind == VERTEX_B else 1.0)
                from_b = slots.arm_b[k] + radius * n * (1.0 if kind == VERTEX_A else -1.0)
                assert (pairs.a[pairs.of_slot[k]], pairs.b[pairs.of_slot[k]]) == (0, 1)
                for found, direction in zip(row, (n, np.array([n[1], -n[0]])), strict=True):
                    turn_a = from_a[0] * direction[1] - from_a[1] * direction[0]
                    turn_b = from_b[0] * direction[1] - from_b[1] * direction[0]
                    # The gap of 1e-8 m over the radii that it is measured by.
                    assert found == pytest.approx(
                        [*-direction, -turn_a, *direction, turn_b], abs=1e-6
                    )
                seen[int(kind)] += 1
        assert set(seen) == ({VERTEX_A, VERTEX_B, VERTICES} if radius else {VERTEX_A, VERTEX_B})

    @pytest.mark.parametrize("first", ["disc", "plane"])
    def test_a_rounded_corner_rolls_without_slipping(self, first):
        """The disc's centre moves on by r w: nothing slips; turned in place, it slips by r w."""
        radius, turn = 0.05, 0.2
        plane = rectangle(-1.0, -1.0, 2.0, 1.0)
        block = turned(rectangle(-0.1, -0.1, 0.2, 0.2), 0.3)
        block = block + (0.0, -block[:, 1].min() - (np.cos(0.3) + np.sin(0.3) - 1.0) * radius)
        shapes = (block, plane) if first == "disc" else (plane, block)
        disc = 0 if first == "disc" else 1
        assembly = pair_of(*shapes, radius=radius)
        pair = JointOfPair(assembly, np.zeros((2, 3)), friction=1e9)
        (k,) = np.flatnonzero(np.abs(pair.known.gap) < 1e-9)
        arm = (pair.known.arm_a if disc == 0 else pair.known.arm_b)[k]
        for share in (0.0, 1.0):
            # Counter-clockwise on level ground rolls to the left; 1 micrometre closed.
            increment = np.zeros((2, 3))
            increment[disc, :2] = arm - turned(arm[None], turn)[0] + (-share * radius * turn, -1e-6)
            increment[disc, 2] = turn
            pair.at(increment)
            slip = -pair.reaction[k, 1] / (assembly.joint.shear_stiffness * 0.1)
            assert abs(slip) == pytest.approx((1.0 - share) * radius * turn, abs=1e-9)


class TestBalance:
    @given(
        convex_polygons(),
        convex_polygons(),
        angles,
        st.sampled_from((0.0, 0.02)),
        st.floats(-50.0, 50.0),
        st.integers(0, 2**31),
    )
    def test_forces_and_moments_on_a_pair(self, p, q, angle, radius, shear, seed):
        """Whatever the contact, a pair feels no resultant and no moment."""
        assembly, pose, _, _ = TestDistance.apart(p, q, angle, radius, 0.5 * radius + 1e-9)
        pair = JointOfPair(assembly, pose, shear=shear)
        # Pressed a little further, and turned.
        u = np.array([np.cos(angle), np.sin(angle)])
        increment = 1e-3 * np.random.default_rng(seed).normal(size=(2, 3))
        increment[1, :2] -= 2e-3 * u
        pair.at(increment)
        assume(pair.branch.any())
        centre = assembly.centroid + (pose + increment)[:, :2]
        f = pair.force
        scale = np.abs(f).max()
        assert f[0, :2] == pytest.approx(-f[1, :2], abs=ROUNDING * scale)
        moment = f[:, 2] + centre[:, 0] * f[:, 1] - centre[:, 1] * f[:, 0]
        assert moment.sum() == pytest.approx(0.0, abs=1e2 * ROUNDING * scale)


CORNERS = {
    "rounded": Corner(radius=0.02),
    "chamfered": Corner(chamfer=0.02),
    "sharp": Corner(),
}


class TestPublishedWalls:
    """83, 141 and 102 joints (Ferris & Tin-Loi 2001), each with a contact at either end."""

    @pytest.fixture(params=CORNERS)
    def corner(self, request):
        return CORNERS[request.param]

    @staticmethod
    def touching(wall, corner):
        assembly = with_corner(published_wall(wall), corner).assembly
        _, pairs, slots = contacts_of(assembly, assembly.design_pose())
        return assembly, pairs, slots, np.flatnonzero((slots.kind != NONE) & (slots.gap < 1e-9))

    @pytest.mark.parametrize(("wall", "n_contacts"), [(1, 166), (2, 282), (3, 204)])
    def test_number_and_lengths(self, wall, n_contacts, corner):
        _, _, slots, k = self.touching(wall, corner)
        assert len(k) == n_contacts
        assert slots.gap[k] == pytest.approx(0.0, abs=ROUNDING)
        # Half of the joint to each end: 0.1 m on a bed joint of half a unit of 0.4 m and 0.0875 m
        # on a head joint (the areas of the paper); whole units meet the base over 0.4 m.
        lengths = slots.size[k]
        for row in lengths:
            assert min(abs(row - np.array([0.0875, 0.1, 0.2]))) < ROUNDING
        is_bed = np.abs(slots.normal[k, 1]) > 0.5
        assert np.all(lengths[~is_bed] == pytest.approx(0.0875, abs=ROUNDING))

    @pytest.mark.parametrize("wall", [1, 2, 3])
    def test_areas_add_up_to_the_designed_joints(self, wall, corner):
        assembly, pairs, slots, k = self.touching(wall, corner)
        for p in np.unique(pairs.of_slot[k]):
            a, b = (assembly.blocks[i].vertices for i in (pairs.a[p], pairs.b[p]))
            # Boxes that touch: one side of their intersection is nothing, the other the joint.
            low, high = np.maximum(a.min(0), b.min(0)), np.minimum(a.max(0), b.max(0))
            designed = (high - low).max()
            found = slots.size[k[pairs.of_slot[k] == p]].sum()
            assert found == pytest.approx(designed, abs=ROUNDING)


class TestLaterContacts:
    @given(st.integers(0, 2**31))
    @settings(max_examples=25)
    def test_a_kept_pair_list_misses_nothing(self, seed):
        """Blocks on a random walk: until the list is outdated, it finds all that touch."""
        random = np.random.default_rng(seed)
        unit = rectangle(-0.2, -0.1, 0.4, 0.2)
        blocks = [
            Block(
                id=str(i),
                vertices=turned(unit, random.uniform(0, 3)) + random.uniform(-1.0, 1.0, 2),
                unit_weight=UNIT_WEIGHT,
            )
            for i in range(10)
        ]
        law = JointLaw(friction_coefficient=0.5, normal_stiffness=1e8, shear_stiffness=1e8)
        assembly = Assembly.build(blocks, joint=law, corner=Corner(radius=0.01))
        pose = assembly.design_pose()
        detector, pairs, slots = contacts_of(assembly, pose)
        for _ in range(20):
            move = random.normal(size=(10, 3))
            pose = pose + 0.2 * detector.reach * move / detector.motion(move)[:, None]
            if detector.outdated(pairs.pose, pose):
                pairs = detector.pairs(pose)
                slots = Slots.empty(pairs.n_slots, 2)
            detector.fill(pairs, pose, slots)
            _, fresh_pairs, fresh = contacts_of(assembly, pose)
            found = {
                (*pairs.which[pairs.of_slot[k], :2].tolist(), slots.gap[k])
                for k in np.flatnonzero(slots.kind)
            }
            expected = {
                (
                    int(fresh_pairs.a[fresh_pairs.of_slot[k]]),
                    int(fresh_pairs.b[fresh_pairs.of_slot[k]]),
                    fresh.gap[k],
                )
                for k in np.flatnonzero(fresh.kind)
            }
            assert found == expected


class TestIdentity:
    unit = rectangle(-0.2, -0.1, 0.4, 0.2)

    @pytest.mark.parametrize("radius", [0.0, 0.02])
    def test_a_contact_goes_on_when_another_edge_comes_to_face_it(self, radius):
        """A square rolls over its corner on a base: at 45 degrees the facing edge changes."""
        square = rectangle(-0.1, -0.1, 0.2, 0.2)
        base = rectangle(-1.0, -1.0, 2.0, 1.0)
        assembly = pair_of(base, square + (0.0, 0.1), radius=radius, first_fixed=True)
        corner = assembly.shapes.of(1)[1]  # lower right
        history = 1
        detector, pairs, slots = contacts_of(assembly, assembly.design_pose())
        # Slot of the corner at the start, followed through all the turning.
        (slot,) = (k for k in range(2) if slots.arm_b[k, 0] > 0.0)
        edges = set()
        for angle in np.radians(np.arange(1.0, 90.0, 2.0)):
            pose = np.zeros((2, 3))
            pose[1] = 0.0, radius - turned(corner, -angle)[1] - 0.1, -angle
            new, source = Slots.empty(pairs.n_slots, 2), np.full(2, -1)
            detector.fill(pairs, pose, new)
            narrow.find_predecessors(pairs, slots, new, source)
            here = [k for k in np.flatnonzero(new.kind) if abs(new.gap[k]) < ROUNDING]
            assert len(here) == 1
            assert source[here[0]] == slot, f"lost at {np.degrees(angle):.0f} degrees"
            slots, slot = new, here[0]
            edges.add(tuple(new.edges[slot].tolist()))
            history += 1
        assert len(edges) == 2

    def test_a_contact_goes_on_when_it_passes_from_edge_to_vertex(self):
        """A rounded block slides past the end of the one below: the slot stays the same."""
        assembly = pair_of(self.unit, self.unit + (0.0, 0.2), radius=0.02, first_fixed=True)
        detector, pairs, slots = contacts_of(assembly, assembly.design_pose())
        kinds = set()
        for x in np.arange(0.0, 0.398, 0.006):
            pose = np.zeros((2, 3))
            pose[1, 0] = x
            new, source = Slots.empty(pairs.n_slots, 2), np.full(2, -1)
            detector.fill(pairs, pose, new)
            narrow.find_predecessors(pairs, slots, new, source)
            for k in np.flatnonzero(new.kind & (new.gap < ROUNDING)):
                assert source[k] == k
            kinds |= set(new.kind.tolist())
            slots = new
        assert {VERTEX_A, VERTEX_B} <= kinds

    def test_a_new_contact_has_no_past(self):
        assembly = pair_of(self.unit, self.unit + (0.0, 0.2), radius=0.02)
        _, pairs, slots = contacts_of(assembly, assembly.design_pose())
        before, source = Slots.empty(pairs.n_slots, 2), np.zeros(2, np.int64)
        narrow.find_predecessors(pairs, before, slots, source)
        assert source.tolist() == [-1, -1]

    def test_pairs_are_found_again_in_a_new_list(self):
        wall = published_wall(3).assembly
        pose = wall.design_pose()
        _, before, _ = contacts_of(wall, pose)
        pose[wall.n_bodies // 2 :, 0] += 1.0  # the upper half slides along
        _, after, _ = contacts_of(wall, pose)
        old = {pair: i for i, pair in enumerate(zip(before.a, before.b, strict=True))}
        expected = [old.get(pair, -1) for pair in zip(after.a, after.b, strict=True)]
        assert predecessor_pairs(before, after).tolist() == expected
        assert -1 in expected and max(expected) > 0


class TestTributaryLength:
    """It goes with the motion: a closed point presses by its length times its depth."""

    @staticmethod
    def lengths(assembly, corner, first, last, step):
        """Of the point at vertex ``corner`` of b, while b turns over it from angle to angle."""
        detector, pairs, slots = contacts_of(assembly, assembly.design_pose())
        vertex = assembly.shapes.of(1)[corner]
        found = []
        for angle in np.arange(first, last, step):
            pose = np.zeros((2, 3))
            pose[1] = *(vertex - turned(vertex, -angle)), -angle
            detector.fill(pairs, pose, slots)
            (here,) = np.flatnonzero(np.abs(slots.gap) < ROUNDING)
            found.append(slots.size[here])
        return np.array(found)

    def turning(self, radius, outline):
        """A block whose lower right corner stands 2 cm before the end of its base."""
        return pair_of(rectangle(-2.0, -0.5, 2.02, 0.5), outline, radius=radius, first_fixed=True)

    @pytest.mark.parametrize("radius", [0.0, 0.005])
    @pytest.mark.parametrize("flat", [0.9, 0.3])
    def test_of_a_corner_on_end_does_not_jump(self, radius, flat):
        """At 45 degrees it jumped between halves of 0.64 m and of 2 cm.

        What is continuous changes a tenth as much in a tenth of the step; twice that is allowed for
        the second order.
        """
        assembly = self.turning(radius, rectangle(-flat, 0.0, flat, 0.6))
        largest = [
            np.abs(np.diff(self.lengths(assembly, 1, 0.5, 1.1, step))).max()
            for step in (1e-2, 1e-3, 1e-4)[: fewer(3, 2)]
        ]
        assert all(less <= 0.2 * more for more, less in pairwise(largest))

    def test_of_a_face_that_lies_nearly_flat_is_its_own(self):
        """Below 36 degrees, half of the shadow of the face that turns."""
        assembly = self.turning(0.0, rectangle(-0.9, 0.0, 0.9, 0.6))
        expected = 0.45 * np.cos(np.arange(0.01, 0.62, 0.01))
        found = self.lengths(assembly, 1, 0.01, 0.62, 0.01)
        assert found == pytest.approx(expected, abs=ROUNDING)

    def test_of_two_ways_to_see_a_corner_on_end_is_the_same(self):
        """At 45 degrees no face is nearer to lying: the length is the mean of both."""
        assembly = self.turning(0.0, rectangle(-0.9, 0.0, 0.9, 0.6))
        (found,) = self.lengths(assembly, 1, 0.25 * np.pi, 0.26 * np.pi, 1.0)
        assert found == pytest.approx(0.25 * (0.9 * np.sqrt(0.5) + 0.02), abs=ROUNDING)
