"""Cycles in space on contacts made by hand: free rotation, forces, the friction's direction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drystone.contact.contacts import (
    BALL_3,
    FEATURE_A,
    GAP,
    KIND,
    PLACE_3,
    PLANE_NORMAL_3,
    PLANE_TANGENT_3,
    POINT_3,
    SIZE,
    VERTEX_A,
    VERTEX_B,
    Pairs,
    Slots,
)
from drystone.contact.rows import IN_SPACE
from drystone.contact.space import points
from drystone.dynamics import explicit
from drystone.dynamics.explicit import Drive, FrozenContacts, Loads, Motion
from drystone.dynamics.space import explicit as space
from drystone.geometry import motion as poses
from drystone.law.columns import (
    BROKEN,
    BY_SLIP,
    COHESIVE,
    CRUSHES,
    DILATION,
    KN,
    KS,
    LEAST_MU,
    MU,
    N_HISTORY,
    N_LAW,
    SHEAR,
    SLID,
    SOFTENED,
    YIELDS,
)
from drystone.law.status import SLIDING
from drystone.model.tie_kernels import Ties

pytestmark = pytest.mark.kernels

MOMENTS = np.array([1.0, 2.0, 3.5])  # kg m2


class Balls(NamedTuple):
    """What cycles ask of contact shapes."""

    centroid: np.ndarray
    radius: np.ndarray


class Bench:
    """Bodies without shapes, and contacts between them as given."""

    def __init__(self, centroid, mass, *, axes=None, seed=0, fixed=()):
        n = len(centroid)
        self.centroid = np.array(centroid, float)
        if axes is None:
            axes = Rotation.random(n, random_state=seed).as_matrix()
        self.mass = np.array(mass, float)
        inverse = 1.0 / self.mass
        inverse[list(fixed)] = 0.0
        self.motion = Motion.of(
            poses.design_pose(n, 3), np.zeros((n, 6)), space.Rotations.of(np.array(axes))
        )
        self.loads = Loads(
            centroid=self.centroid,
            dead=np.zeros((n, 6)),
            pattern=np.zeros((n, 6)),
            inverse_mass=inverse,
            extent=np.ones(n),
            weight=np.ones(n),
        )
        self.meter = np.zeros(explicit.N_METER)
        self.touch([])

    def touch(self, contacts, *, kn=1e6, ks=1e6, mu=0.5, radius=0.0):
        """Contacts between the bodies 0 and 1: whose point it is, point, place, normal, tangent."""
        n = len(contacts)
        self.slots = Slots.empty(n, 3)
        for k, (kind, point, place, normal, tangent) in enumerate(contacts):
            self.slots.which[k, KIND], self.slots.which[k, FEATURE_A] = kind, k
            row = self.slots.value[k]
            row[SIZE], row[BALL_3] = 1.0, radius
            row[POINT_3 : POINT_3 + 3], row[PLACE_3 : PLACE_3 + 3] = point, place
            row[PLANE_NORMAL_3 : PLANE_NORMAL_3 + 3] = normal
            row[PLANE_TANGENT_3 : PLANE_TANGENT_3 + 3] = tangent
        columns = [np.array([v]) for v in (0, 1, 0, 1, 0)]
        self.pairs = Pairs.of(columns, np.array([n]), self.motion.pose)
        self.laws = np.zeros((1, N_LAW))
        self.laws[0, [KN, KS, MU]] = kn, ks, mu
        self.history = np.zeros((n, N_HISTORY + 1))
        self.history[:, BROKEN] = 1.0
        self.reaction, self.status = np.zeros((n, 3)), np.zeros(n, np.int64)
        self.bodies = Balls(self.centroid, np.full(2, 0.5 * radius))
        self.pack()

    def pack(self):
        self.contacts = FrozenContacts.empty(len(self.history), 3, space.N_SHAPE)
        self.n_contacts = explicit.pack(
            space,
            self.slots,
            self.bodies,
            self.pairs,
            self.laws,
            1.0,
            self.history,
            self.contacts,
        )
        space.place(self.motion)

    def cycle(self, n, dt, **drive):
        settings = {
            "dt": dt,
            "multiplier": 0.0,
            "keep_bonds": False,
            "guided": False,
            "rate": 0.0,
            "combined": False,
            "local_damping": 0.0,
            "viscous_damping": 0.0,
            "tolerance": -1.0,
            "reach": np.inf,
            "gyroscopic": True,
        }
        explicit.cycle(
            IN_SPACE, self.contacts, self.n_contacts, self.motion, self.loads,
            self.motion.pose.copy(), Drive(**(settings | drive)), n, self.meter, Ties.none(),
        )  # fmt: skip

    def unpack(self):
        """As in a step, but that the bodies have no shapes."""
        points.evaluate_all(
            self.centroid, self.bodies.radius.sum(), self.motion.rotation.added, self.motion.pose,
            *self.slots, 0, len(self.slots.kind), 0, 1,
        )  # fmt: skip
        explicit.unpack(self.contacts, self.n_contacts, self.history, self.reaction, self.status)


def rotation(bench, i=0) -> Rotation:
    return Rotation.from_quat(bench.motion.pose[i, 3:], scalar_first=True)


class TestFreeRotation:
    """A body with three different moments about axes that are not those of the world."""

    start = np.array([0.02, 3.0, 0.01])  # rad/s, about the middle axis: it tumbles

    def thrown(self) -> Bench:
        bench = Bench([[0.0, 0.0, 0.0]], [[1.0, 1.0, 1.0, *MOMENTS]])
        bench.motion.velocity[0, 3:] = self.start
        return bench

    def momentum(self, bench):
        """Along the axes of the world."""
        axes = rotation(bench).as_matrix() @ bench.motion.rotation.designed[0]
        return axes @ (MOMENTS * bench.motion.velocity[0, 3:])

    def test_angular_momentum_is_kept_to_rounding(self):
        bench, dt = self.thrown(), 0.05
        first = self.momentum(bench)
        for _ in range(20):
            bench.cycle(20, dt)
            assert self.momentum(bench) == pytest.approx(first, abs=1e-13 * 400)
        assert abs(np.linalg.norm(bench.motion.pose[0, 3:]) - 1.0) < 1e-14
        assert rotation(bench).magnitude() > 0.1  # it has moved

    def test_energy_does_not_drift_and_the_order_is_two(self):
        largest = []
        for dt in (0.04, 0.02):
            bench = self.thrown()
            energy = []
            for _ in range(round(16.0 / dt)):
                bench.cycle(1, dt)
                energy.append(0.5 * np.sum(MOMENTS * bench.motion.velocity[0, 3:] ** 2))
            energy = np.array(energy)
            largest.append(np.abs(energy / energy[0] - 1.0).max())
            # It tumbles twice, and comes back to where it began.
            assert abs(energy[-1] / energy[0] - 1.0) <= largest[-1]
        assert largest[0] < 1e-2
        assert largest[0] / largest[1] == pytest.approx(4.0, rel=0.1)

    def test_against_an_independent_integration(self):
        """Euler's equations and the quaternion's, by a method of eighth order."""
        from scipy.integrate import solve_ivp

        def rate(_, y):
            w, q = y[:3], y[3:]
            v = q[1:]
            dq = 0.5 * np.concatenate(([-v @ w], q[0] * w + np.cross(v, w)))
            return np.concatenate((np.cross(MOMENTS * w, w) / MOMENTS, dq))

        time, errors = 4.0, []
        axes = np.eye(3)[None]
        exact = solve_ivp(
            rate, (0.0, time), [*self.start, 1.0, 0.0, 0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-12
        ).y[3:, -1]
        for n in (200, 400):
            dt = time / n
            bench = Bench([[0.0, 0.0, 0.0]], [[1.0, 1.0, 1.0, *MOMENTS]], axes=axes)
            bench.motion.velocity[0, 3:] = self.start
            bench.cycle(n, dt)
            turned = rotation(bench) * Rotation.from_quat(exact, scalar_first=True).inv()
            errors.append(turned.magnitude())
        assert errors[1] < 1e-3
        assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)

    def test_without_moments_of_its_own_it_spins_on(self):
        bench = self.thrown()
        bench.cycle(100, 0.01, gyroscopic=False)
        assert bench.motion.velocity[0, 3:] == pytest.approx(self.start, abs=0.0)


def random_contact(rng, kind):
    """A point of one body near a plane of the other, both somewhere about their centroids."""
    frame = Rotation.random(random_state=rng).as_matrix()
    return kind, rng.uniform(-0.5, 0.5, 3), rng.uniform(-0.5, 0.5, 3), frame[0], frame[1]


def random_bench(seed, kind, radius=0.0):
    """Two bodies, turned and moved, a contact between them that is closed by a little."""
    rng = np.random.default_rng(seed)
    bench = Bench(rng.uniform(-1.0, 1.0, (2, 3)), np.ones((2, 6)), seed=seed)
    bench.motion.pose[:, :3] = rng.uniform(-0.3, 0.3, (2, 3))
    bench.motion.pose[:, 3:] = Rotation.random(2, random_state=rng).as_quat(scalar_first=True)
    contact = random_contact(rng, kind)
    bench.touch([contact], radius=radius)
    # Moved along the normal to where it is closed by 1 mm.
    bench.unpack()
    other = 1 if kind == VERTEX_B else 0
    sign = 1.0 if kind == VERTEX_B else -1.0
    bench.motion.pose[other, :3] -= sign * bench.slots.normal[0] * (bench.slots.gap[0] + 1e-3)
    bench.pack()
    bench.unpack()
    return bench, rng


KINDS = pytest.mark.parametrize("kind", [VERTEX_B, VERTEX_A], ids=["vertex b", "vertex a"])


class TestForces:
    @KINDS
    @pytest.mark.parametrize("seed", range(4))
    @pytest.mark.parametrize("radius", [0.0, 0.05])
    def test_gap_and_arms(self, seed, kind, radius):
        """Against coordinates of the point and the plane in their places."""
        bench, _ = random_bench(seed, kind, radius)
        row = bench.slots.value[0]
        o, e = (1, 0) if kind == VERTEX_B else (0, 1)
        place = [bench.centroid[i] + bench.motion.pose[i, :3] for i in range(2)]
        turn = [rotation(bench, i) for i in range(2)]
        point = place[o] + turn[o].apply(row[POINT_3 : POINT_3 + 3])
        origin = place[e] + turn[e].apply(row[PLACE_3 : PLACE_3 + 3])
        normal = turn[e].apply(row[PLANE_NORMAL_3 : PLANE_NORMAL_3 + 3])
        assert row[GAP] == pytest.approx(normal @ (point - origin) - radius, abs=1e-14)
        assert row[GAP] == pytest.approx(-1e-3, abs=1e-14)
        sign = 1.0 if kind == VERTEX_B else -1.0
        np.testing.assert_allclose(bench.slots.normal[0], sign * normal, atol=1e-14)
        touches = point - radius * normal
        for i, arm in enumerate((bench.slots.arm_a[0], bench.slots.arm_b[0])):
            np.testing.assert_allclose(place[i] + arm, touches, atol=1e-14)

    @KINDS
    @pytest.mark.parametrize("seed", range(4))
    def test_they_balance(self, seed, kind):
        bench, rng = random_bench(seed, kind)
        bench.motion.velocity[:] = rng.normal(size=(2, 6))
        bench.cycle(1, 1e-4, gyroscopic=False)
        force = bench.motion.force
        size = np.abs(force).max()
        assert size > 100.0
        np.testing.assert_allclose(force[0, :3], -force[1, :3], atol=1e-13 * size)
        # The poses have moved on by a millionth since: moments about the places before.
        place = bench.centroid + bench.motion.pose[:, :3] - 1e-4 * bench.motion.velocity[:, :3]
        moment = bench.motion.rotation.moment.sum(axis=0)
        moment += np.cross(place, force[:, :3]).sum(axis=0)
        np.testing.assert_allclose(moment, 0.0, atol=1e-12 * size)

    @KINDS
    @pytest.mark.parametrize("seed", range(4))
    def test_the_normal_one_is_the_gap_s_gradient(self, seed, kind):
        """Work on any small motion is k_n g times what the gap closes by."""
        bench, rng = random_bench(seed, kind)
        bench.laws[0, MU] = 0.0
        bench.pack()
        bench.cycle(1, 1e-15, gyroscopic=False)
        force, small = bench.motion.force.copy(), 1e-5
        move = rng.normal(size=(2, 6))
        gaps = []
        start = bench.motion.pose.copy()
        for sign in (-1.0, 1.0):
            moved = poses.moved(start, sign * small * move, bench.motion.rotation.designed)
            bench.motion.pose[:] = moved
            space.place(bench.motion)
            bench.unpack()
            gaps.append(bench.slots.gap[0])
        expected = 1e6 * 1e-3 * (gaps[1] - gaps[0]) / (2.0 * small)
        assert np.sum(force * move) == pytest.approx(expected, rel=1e-7)

    @KINDS
    @pytest.mark.parametrize("seed", range(4))
    def test_the_shear_is_that_of_the_slots(self, seed, kind):
        """On b along the slot's tangents, against what b slides over a."""
        bench, rng = random_bench(seed, kind)
        bench.laws[0, MU] = 1e6
        bench.pack()
        velocity = rng.normal(size=(2, 6))
        bench.motion.velocity[:] = velocity
        bench.loads = bench.loads._replace(inverse_mass=np.full((2, 6), 1e-30))
        normal, tangents = bench.slots.normal[0], bench.slots.tangents[0]
        arms = bench.slots.arm_a[0], bench.slots.arm_b[0]
        dt = 1e-9
        bench.cycle(1, dt, gyroscopic=False)
        at = [
            v[:3] + np.cross(axes @ v[3:], arm)
            for v, arm, axes in zip(velocity, arms, bench.motion.rotation.axes, strict=True)
        ]
        slip = tangents @ (at[1] - at[0])
        reaction = bench.contacts.reaction[0]
        np.testing.assert_allclose(reaction[1:], -1e6 * dt * slip, rtol=1e-6)
        expected = reaction[0] * normal + reaction[1:] @ tangents
        np.testing.assert_allclose(bench.motion.force[1, :3], expected, rtol=1e-6)

    @KINDS
    def test_the_shear_turns_with_the_plane(self, kind):
        """Both bodies turned together about any axis: forces as before, seen from the bodies."""
        bench, rng = random_bench(3, kind)
        bench.history[0, SHEAR:] = 300.0, -200.0
        bench.laws[0, KS] = 1.0  # what it slips in the secants of the circle is of no account
        bench.pack()
        bench.loads = bench.loads._replace(inverse_mass=np.full((2, 6), 1e-30))
        bench.cycle(1, 1e-15, gyroscopic=False)
        before = rotation(bench).inv().apply(bench.motion.force[1, :3])
        axis, n, angle = rng.normal(size=3), 400, 2.0
        axis /= np.linalg.norm(axis)
        place = bench.centroid + bench.motion.pose[:, :3]
        for _ in range(n):
            # The velocity that takes both along their circles about the origin.
            step = Rotation.from_rotvec(angle / n * axis)
            after = step.apply(place)
            bench.motion.velocity[:, :3] = after - place
            for i in range(2):
                turned = bench.motion.rotation.axes[i].T @ (angle / n * axis)
                bench.motion.velocity[i, 3:] = turned
            place = after
            bench.cycle(1, 1.0, gyroscopic=False)
        bench.motion.velocity[:] = 0.0
        bench.cycle(1, 1e-15, gyroscopic=False)
        after = rotation(bench).inv().apply(bench.motion.force[1, :3])
        # At 1 N/m; the normal force follows the gap, which is exact but for the rounding of 1 m.
        assert rotation(bench).magnitude() > 0.5
        np.testing.assert_allclose(after, before, atol=0.01)


class TestSliding:
    @pytest.mark.parametrize("angle", [0.0, 30.0, 77.0, 200.0])
    def test_straight_in_any_direction(self, angle):
        """A block of 100 N on four points, pushed by 60 N where friction holds 50."""
        rng = np.random.default_rng(int(angle))
        mass = [10.0, 10.0, 10.0, 1e12, 1e12, 1e12]  # so heavy to turn that nothing tips
        bench = Bench([[0.0, 0.0, -1.0], [0.0, 0.0, 0.5]], [mass, mass], fixed=(0,))
        push = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
        tangent = np.array([*rng.normal(size=2), 0.0])
        tangent /= np.linalg.norm(tangent)
        corners = [(x, y, -0.5) for x in (-0.2, 0.2) for y in (-0.3, 0.3)]
        up = (0.0, 0.0, 1.0)
        bench.touch([(VERTEX_B, p, (0.0, 0.0, 1.0), up, tangent) for p in corners])
        for row in (bench.loads.dead, bench.loads.pattern):
            row[1, :3] = (0.0, 0.0, -100.0) if row is bench.loads.dead else 100.0 * push
        bench.motion.pose[1, 2] = -25.0 / 1e6
        dt = 1e-4
        bench.cycle(400, dt, multiplier=0.6)
        first = bench.motion.velocity[1, :3].copy()
        bench.cycle(400, dt, multiplier=0.6)
        assert (bench.contacts.status[:4] == SLIDING).all()
        bench.unpack()
        shear = np.hypot(bench.reaction[:, 1], bench.reaction[:, 2])
        np.testing.assert_allclose(shear, 0.5 * bench.reaction[:, 0], rtol=1e-12)
        path = bench.motion.pose[1, :3]
        along = path @ push
        # (60 - 50) N on 10 kg; the shear springs had their swing before.
        gained = (bench.motion.velocity[1, :3] - first) @ push
        assert gained == pytest.approx(1.0 * 400 * dt, rel=1e-9)
        assert np.linalg.norm(path[:2] - along * push[:2]) < 1e-12 * along


class TestYielding:
    @pytest.mark.parametrize("angle", [0.0, 55.0, 250.0])
    def test_a_bond_softens_by_the_length_of_the_slip(self, angle):
        """Drawn along its plane at a constant rate: |t| = mu n + c exp(-c k / G), against it."""
        bench = Bench([[0.0, 0.0, -1.0], [0.0, 0.0, 0.5]], np.ones((2, 6)), fixed=(0, 1))
        bench.touch([(VERTEX_B, (0.0, 0.0, -0.5), (0.0, 0.0, 1.0), (0, 0, 1.0), (1.0, 0, 0))])
        cohesion, energy, normal = 50.0, 1e-2, 20.0
        bench.laws[0, [YIELDS, COHESIVE, LEAST_MU, CRUSHES]] = 1.0, cohesion, 0.5, np.inf
        bench.laws[0, BY_SLIP] = cohesion / energy
        bench.history[:, BROKEN] = 0.0
        bench.pack()
        bench.motion.pose[1, 2] = -normal / 1e6
        way = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        bench.motion.velocity[1, :2] = way
        dt, n = 1e-6, 300
        bench.cycle(n, dt)
        bench.unpack()
        slid = bench.history[0, SLID]
        most = 0.5 * normal + cohesion * np.exp(-cohesion * slid / energy)
        shear = np.array([bench.reaction[0, 1], bench.reaction[0, 2]])
        assert bench.status[0] == SLIDING
        # A cycle softens by what it slips under the strength that the last one left.
        assert np.linalg.norm(shear) == pytest.approx(most, rel=1e-2)
        assert shear == pytest.approx(-np.linalg.norm(shear) * way, rel=1e-9)
        assert slid + np.linalg.norm(shear) / 1e6 == pytest.approx(n * dt, rel=1e-9)
        assert bench.history[0, SOFTENED] == pytest.approx(cohesion / energy * slid)

    def test_a_joint_that_is_crushed_stays_closed(self):
        bench = Bench([[0.0, 0.0, -1.0], [0.0, 0.0, 0.5]], np.ones((2, 6)), fixed=(0, 1))
        bench.touch([(VERTEX_B, (0.0, 0.0, -0.5), (0.0, 0.0, 1.0), (0, 0, 1.0), (1.0, 0, 0))])
        bench.laws[0, [YIELDS, LEAST_MU, CRUSHES]] = 1.0, 0.5, 30.0
        bench.pack()
        bench.motion.pose[1, 2] = -50.0 / 1e6
        bench.cycle(1, 1e-6)
        bench.unpack()
        assert bench.reaction[0, 0] == pytest.approx(30.0)
        assert bench.history[0, DILATION] == pytest.approx(-20.0 / 1e6)
        bench.motion.pose[1, 2] = -20.0 / 1e6
        bench.cycle(1, 1e-6)
        bench.unpack()
        assert bench.reaction[0, 0] == pytest.approx(0.0, abs=1e-9)
