"""Contacts of a static step in space: motions, forces, and the stiffness that goes with them."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.contact.contacts import (
    BOND,
    CRUSH,
    FRICTION,
    INTACT,
    INTERCEPT,
    LIFT,
    N_TABLE,
    PULL,
    SHIFT,
    STIFF_N,
    STIFF_T,
)
from drystone.law import space as space_law
from drystone.law.branches import BONDED, CRUSHED, FORWARD, OPEN, STICKING, TORN, both
from drystone.law.columns import DILATION, N_HISTORY, SHEAR, SLID
from drystone.statics.space import contacts
from drystone.statics.space.contacts import (
    ARM_V,
    AXES,
    BALL,
    FROM_F,
    GAP_0,
    NOW,
    POINT,
    SIDE,
    Y,
)

pytestmark = pytest.mark.kernels

N, PER = 3, 4  # bodies, contacts of a pair


def rotation(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.linalg.det(q)


class Heap:
    """Three bodies with contacts at random places, of stiffnesses near 1 N/m and sizes near 1 m.

    Pairs are (0, 1), (0, 2), without contacts, and (1, 2); either body may have the points.
    """

    def __init__(self, seed, radius=0.0):
        rng = self.rng = np.random.default_rng(seed)
        self.pairs = np.array([[0, 1], [0, 2], [1, 2]])
        self.first = np.array([0, PER, PER, 2 * PER])
        pair = np.repeat([0, 2], PER)
        n = self.n = len(pair)
        self.which = np.column_stack((np.arange(n), pair, self.pairs[pair]))
        side = np.where(np.arange(n) % 3 == 1, -1.0, 1.0)
        v = np.where(side > 0.0, self.which[:, 3], self.which[:, 2])
        f = self.which[:, 2] + self.which[:, 3] - v
        self.centroid, point = rng.normal(size=(N, 3)), rng.normal(size=(n, 3))
        self.start = np.zeros((n, contacts.N_PLACE))
        self.start[:, POINT : POINT + 3] = point - self.centroid[v]
        self.start[:, FROM_F : FROM_F + 3] = point - self.centroid[f]
        self.start[:, AXES : AXES + 9] = [rotation(rng).ravel() for _ in range(n)]
        self.start[:, SIDE], self.start[:, BALL] = side, radius
        self.start[:, GAP_0] = rng.uniform(-1.0, -0.5, n)
        self.law = np.zeros((n, N_TABLE))
        self.law[:, STIFF_N], self.law[:, STIFF_T] = rng.uniform(0.5, 2.0, (2, n))
        self.shear = rng.normal(size=(n, 2))
        self.axes_0 = np.array([rotation(rng) for _ in range(N)])
        self.motion = np.tile((0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), (N, 1))
        self.rotation, self.axes = np.zeros((N, 3, 3)), self.axes_0.copy()
        self.now, self.trial = np.zeros((n, contacts.N_NOW)), np.zeros((n, 3))
        self.reaction, self.response = np.zeros((n, 3)), np.zeros((n, 3, 3))
        self.branch = np.zeros(n, np.int64)
        body = self.pairs.ravel()
        order = np.argsort(body, kind="stable")
        self.of_body = order.astype(np.int64)
        self.begin = np.searchsorted(body[order], np.arange(N + 1)).astype(np.int64)

    def move(self, step, length=1.0):
        contacts.rotate_on(step, length, self.axes_0, self.motion, self.rotation, self.axes)
        self.locate()

    def locate(self):
        contacts.locate(
            self.which, self.start, self.law, self.shear, self.first, 0, 3, self.motion,
            self.rotation, self.now, self.trial,
        )  # fmt: skip
        space_law.respond(
            self.law, self.trial, 0, self.n, self.branch, self.reaction, self.response
        )

    def wrenches(self):
        wrench = np.full((3, 2, 6), np.nan)
        args = self.start, self.now, self.first
        contacts.wrenches(*args, 0, 3, self.reaction, wrench)
        return wrench

    def force(self, axes):
        force = np.zeros((N, 6))
        contacts.sum_wrenches(self.begin, self.of_body, self.wrenches(), axes, force)
        return force

    def stiffness(self):
        """Dense, (18, 18)."""
        part, diagonal = np.full((3, 2, 6, 6), np.nan), np.zeros((N, 6, 6))
        upper, lower = np.full((3, 6, 6), np.nan), np.full((3, 6, 6), np.nan)
        contacts.stiffness(
            self.which, self.start, self.now, self.law, self.first, 0, 3, self.reaction,
            self.response, self.axes, part, upper, lower,
        )  # fmt: skip
        contacts.sum_diagonals(self.begin, self.of_body, part, self.axes, diagonal)
        whole = np.zeros((N, 6, N, 6))
        for i in range(N):
            whole[i, :, i] = diagonal[i]
        for (a, b), ab, ba in zip(self.pairs, upper, lower, strict=True):
            whole[a, :, b], whole[b, :, a] = ab, ba
        return whole.reshape(6 * N, 6 * N)

    def differences(self, h=2e-6):
        """Of minus the forces, by increments from here, moments about axes that do not turn."""
        columns, axes = [], self.axes.copy()
        motion, branch = self.motion.copy(), self.branch.copy()
        for k in range(6 * N):
            sides = []
            for step in (h, -h):
                self.motion[:], self.axes[:] = motion, axes
                increment = np.zeros(6 * N)
                increment[k] = step
                self.move(increment.reshape(N, 6))
                assert np.array_equal(self.branch, branch)
                sides.append(self.force(axes).ravel())
            columns.append((sides[1] - sides[0]) / (2.0 * h))
        self.motion[:], self.axes[:] = motion, axes
        self.move(np.zeros((N, 6)))
        return np.array(columns).T


def dilatant(heap):
    """Friction with dilatancy, some bonds; sticking, sliding and open contacts among them."""
    heap.law[:, FRICTION], heap.law[:, LIFT] = 0.6, 0.3 * heap.law[:, STIFF_N]
    heap.law[:2, LIFT], heap.law[3, BOND] = 0.0, 1.0
    heap.law[:, INTACT][3] = 1.0
    heap.start[4, GAP_0] = 5.0  # beyond what dilatancy lifts it by
    heap.shear[:4] *= 0.01


@pytest.mark.parametrize("seed", range(3))
def test_the_stiffness_is_the_derivative_of_the_forces(seed):
    heap = Heap(seed)
    dilatant(heap)
    heap.move(0.05 * heap.rng.normal(size=(N, 6)))
    assert {OPEN, STICKING, FORWARD, BONDED} >= set(heap.branch) >= {OPEN, FORWARD, BONDED}
    stiffness = heap.stiffness()
    # Differences of 2e-6 leave 1e-12 of third derivatives, up to 1e3 where little shear slides, and
    # as much by rounding of forces of 10 N.
    assert stiffness == pytest.approx(heap.differences(), abs=1e-8)


@pytest.mark.parametrize("turn", [0.0, 1e-3])
def test_the_stiffness_of_rounded_corners_takes_rolling_to_first_order(turn):
    """Slip by rolling is the radius times a rotation that is exact to first order where the step
    starts.  There the stiffness is the derivative; after a rotation it lacks terms of the radius
    times the rotation, of stiffness near 1 and arms up to 3 m."""
    radius = 0.1
    heap = Heap(5, radius)
    dilatant(heap)
    heap.move(turn * heap.rng.normal(size=(N, 6)))
    difference = np.abs(heap.stiffness() - heap.differences()).max()
    assert difference < 1e-8 + 30.0 * radius * turn
    if turn > 0.0:
        assert difference > 0.1 * radius * turn  # else the bound above says nothing


@pytest.mark.parametrize(("size", "radius"), [(1e-6, 0.0), (0.5, 0.0), (0.5, 0.1)])
def test_rigid_motions_of_all_bodies_change_no_gap_and_no_slip(size, radius):
    heap = Heap(11, radius)
    vector, way = size * heap.rng.normal(size=(2, 3))
    step = np.zeros((N, 6))
    step[:, 3:] = np.einsum("nij,i->nj", heap.axes_0, vector)
    heap.move(step)
    heap.motion[:, :3] = way + np.einsum("nij,nj->ni", heap.rotation, heap.centroid)
    heap.locate()
    # A dozen sums of terms of the motions' size.
    assert np.abs(heap.now[:, Y : Y + 3]).max() < 100.0 * np.finfo(float).eps * size
    axes = heap.start[:, AXES : AXES + 9].reshape(-1, 3, 3)
    turned = axes + heap.rotation[0] @ axes
    assert heap.now[:, NOW : NOW + 9].reshape(-1, 3, 3) == pytest.approx(turned, abs=1e-14)


def test_the_stiffness_takes_no_force_for_translations_of_all_bodies():
    heap = Heap(2)
    dilatant(heap)
    heap.move(0.1 * heap.rng.normal(size=(N, 6)))
    field = np.zeros((N, 6))
    field[:, :3] = heap.rng.normal(size=3)
    assert heap.stiffness() @ field.ravel() == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_forces_of_a_pair_are_in_balance_whatever_its_motion(radius):
    heap = Heap(3, radius)
    dilatant(heap)
    heap.move(0.3 * heap.rng.normal(size=(N, 6)))
    place, wrench = heap.centroid + heap.motion[:, :3], heap.wrenches()
    assert np.abs(wrench[[0, 2]]).max() > 0.1
    assert wrench[1] == pytest.approx(0.0, abs=0.0)
    force = wrench[:, :, :3]
    moment = wrench[:, :, 3:] + np.cross(place[heap.pairs], force)
    assert force.sum(axis=1) == pytest.approx(0.0, abs=1e-14)
    assert moment.sum(axis=1) == pytest.approx(0.0, abs=1e-12)
    # Where the surfaces meet is the same place from either body.
    first = heap.now[0, ARM_V : ARM_V + 3] + place[heap.which[0, 3]]
    assert heap.now[0, ARM_V + 3 :] + place[heap.which[0, 2]] == pytest.approx(first, abs=1e-14)


def test_responses_are_the_derivatives_of_the_joint_law():
    heap, rng = Heap(7), np.random.default_rng(8)
    dilatant(heap)
    seen, h = set(), 1e-6
    for _ in range(20):
        trial = rng.normal(size=(heap.n, 3))
        found = []
        for k in range(3):
            sides = []
            for step in (h, -h):
                heap.trial[:] = trial
                heap.trial[:, k] += step
                respond(heap)
                sides.append((heap.reaction.copy(), heap.branch.copy()))
            assert np.array_equal(sides[0][1], sides[1][1])  # none of the draws is at a corner
            found.append((sides[0][0] - sides[1][0]) / (2.0 * h))
        heap.trial[:] = trial
        respond(heap)
        # Differences of 1e-6 leave 1e-12 of third derivatives, which sizes of 0.01 make 1e-8.
        assert heap.response == pytest.approx(np.stack(found, axis=-1), abs=1e-7)
        slides = heap.branch == FORWARD
        reaction, seen = heap.reaction[slides], seen | set(heap.branch)
        shear = np.hypot(reaction[:, 1], reaction[:, 2])
        assert shear == pytest.approx(heap.law[slides, FRICTION] * reaction[:, 0], rel=1e-12)
    assert seen == {OPEN, STICKING, FORWARD, BONDED}


def respond(heap):
    space_law.respond(heap.law, heap.trial, 0, heap.n, heap.branch, heap.reaction, heap.response)


def yielding(heap):
    """Joints that pull, that are sheared without pressure, and that are crushed; one has only the
    tip of its cone."""
    law = heap.law
    law[:, FRICTION], law[:, SHIFT], law[:, PULL], law[:, INTERCEPT], law[:, CRUSH] = (
        0.6,
        0.3,
        0.3,
        0.2,
        1.0,
    )
    law[0, INTERCEPT], law[1, CRUSH] = 0.0, 0.0


def test_joints_that_yield_have_the_clipped_law_and_its_derivatives():
    heap, rng = Heap(7), np.random.default_rng(9)
    yielding(heap)
    law, seen, h = heap.law, set(), 1e-6
    for _ in range(20):
        trial, found = rng.normal(size=(heap.n, 3)), []
        for k in range(3):
            sides = []
            for step in (h, -h):
                heap.trial[:] = trial
                heap.trial[:, k] += step
                heap.branch[:] = OPEN
                respond(heap)
                sides.append((heap.reaction.copy(), heap.branch.copy()))
            assert np.array_equal(sides[0][1], sides[1][1])
            found.append((sides[0][0] - sides[1][0]) / (2.0 * h))
        heap.trial[:] = trial
        respond(heap)
        # As of dry joints; shear near zero turns faster where there is a cohesion intercept.
        assert heap.response == pytest.approx(np.stack(found, axis=-1), abs=1e-6)
        crush = np.where(law[:, CRUSH] > 0.0, law[:, CRUSH], np.inf)
        normal = np.clip(trial[:, 0], 0.0, crush)
        size = np.hypot(trial[:, 1], trial[:, 2])
        share = np.minimum(1.0, (law[:, FRICTION] * normal + law[:, INTERCEPT]) / size)
        expected = np.column_stack((normal - law[:, PULL], share[:, None] * trial[:, 1:]))
        assert heap.reaction == pytest.approx(expected, abs=1e-12)
        seen |= set(heap.branch)
    along = {STICKING, FORWARD}
    assert seen == {OPEN} | along | {both(TORN, b) for b in along} | {
        both(CRUSHED, b) for b in along
    }


def test_what_yields_ages():
    """Beyond the law's end trial reactions become sliding, and closure that is kept."""
    heap, rng = Heap(7), np.random.default_rng(10)
    yielding(heap)
    heap.trial[:] = 2.0 * rng.normal(size=(heap.n, 3))
    respond(heap)
    history = np.zeros((heap.n, N_HISTORY + 1))
    space_law.age(heap.which, heap.law, heap.trial, heap.reaction, heap.branch, heap.n, history)
    law, beyond = heap.law, heap.trial - heap.reaction
    crush = np.where(law[:, CRUSH] > 0.0, law[:, CRUSH], np.inf)
    crushed = np.maximum(heap.trial[:, 0] - crush, 0.0)
    assert crushed.max() > 0.0
    assert history[:, DILATION] == pytest.approx(-crushed / law[:, STIFF_N], abs=1e-15)
    slid = np.where(heap.branch == OPEN, 0.0, np.hypot(*beyond[:, 1:].T) / law[:, STIFF_T])
    assert history[:, SLID] == pytest.approx(slid, abs=1e-14)
    assert history[:, SHEAR : SHEAR + 2] == pytest.approx(heap.reaction[:, 1:], abs=0.0)


@pytest.mark.parametrize("seed", range(2))
def test_the_stiffness_of_joints_that_yield_is_the_derivative_of_the_forces(seed):
    heap = Heap(seed)
    yielding(heap)
    heap.move(0.05 * heap.rng.normal(size=(N, 6)))
    assert len(set(heap.branch)) > 2
    assert heap.stiffness() == pytest.approx(heap.differences(), abs=1e-8)
