"""The interior of the cones of friction: its products, its scaling, and where it leads."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.common.tolerances import LEAST_REDUCTION, MOST_REDUCTION
from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    CRUSH,
    FRICTION,
    INTERCEPT,
    LIFT,
    N_TABLE,
    SLOT,
    STIFF_N,
    STIFF_T,
    Contacts,
)
from drystone.dynamics import nlgs
from drystone.dynamics.sweeps import ContactProblem
from drystone.law import central_path, cones
from drystone.law.cones import CAP, ETA, P1, P2, PN, V0, V1, V2, Z1, Z2, ZETA, V, W
from drystone.linear.block_system import BlockSystem

pytestmark = pytest.mark.kernels

H, STIFFNESS, PENALTY = 0.1, 1e6, 3e5  # s, N/m, kg


def joints_of(n, friction, raised=0.0):
    """Impulses for forces: see the module's text."""
    joint = np.zeros((n, N_TABLE))
    joint[:, STIFF_N], joint[:, STIFF_T] = H * H * STIFFNESS, PENALTY
    joint[:, FRICTION], joint[:, LIFT] = friction, raised * PENALTY
    return joint


def product(a, b):
    """(a, b) o (c, d) = (a c + b.d, a d + c b)."""
    return np.array([a @ b, *(a[0] * b[1:] + b[0] * a[1:])])


@pytest.mark.parametrize("raised", [0.0, 0.2, 0.6])
@pytest.mark.parametrize("energy", [1e-6, 1e-2, 10.0])
def test_central_variables_have_the_products_of_their_barrier(energy, raised):
    rng = np.random.default_rng(7)
    n, joint = 40, joints_of(40, 0.6, raised)
    trial, inner = (
        rng.normal(size=(n, 3)) * 10.0 ** rng.uniform(-1, 3, (n, 1)),
        np.zeros((n, cones.N_INNER)),
    )
    cones.centre_contacts(joint, energy, True, trial, inner)
    for v, t in zip(inner, trial, strict=True):
        lifted = raised * v[ZETA]  # may be much larger than the trial reaction
        assert v[PN] - v[W] - lifted == pytest.approx(t[0], rel=1e-9, abs=1e-12 * lifted)
        assert v[PN] * v[W] == pytest.approx(H * H * STIFFNESS * energy, rel=1e-9)
        assert v[[P1, P2]] + v[[Z1, Z2]] == pytest.approx(t[1:], rel=1e-9, abs=1e-12 * v[PN])
        pair, slack = np.array([0.6 * v[PN], v[P1], v[P2]]), np.array([v[ZETA], -v[Z1], -v[Z2]])
        # Differences of what is much larger where the barrier is low.
        scale = 1e-11 * np.abs(pair).max() * np.abs(slack).max()
        least = 2.0 * cones.LEAST_DISTANCE * pair[0] * np.hypot(t[1], t[2])
        expected = (2.0 * PENALTY * energy + least, 0.0, 0.0)
        assert product(pair, slack) == pytest.approx(expected, abs=scale, rel=1e-6)
        assert np.hypot(v[P1], v[P2]) < pair[0]
        assert np.hypot(v[Z1], v[Z2]) < slack[0]


def yielding_joints(n):
    """Joints that may be crushed and have a cohesion intercept; the last third only the latter."""
    joint = joints_of(n, 0.6)
    joint[:, INTERCEPT], joint[:, CRUSH] = 40.0, np.where(np.arange(n) < 2 * n // 3, 150.0, 0.0)
    joint[::4, FRICTION] = 0.0
    return joint


@pytest.mark.parametrize("energy", [1e-6, 1e-2, 10.0])
def test_central_variables_of_joints_that_yield(energy):
    rng = np.random.default_rng(17)
    n, joint = 60, yielding_joints(60)
    trial = rng.normal(size=(n, 3)) * 10.0 ** rng.uniform(-1, 3, (n, 1))
    inner, wanted = np.zeros((n, cones.N_INNER)), H * H * STIFFNESS * energy
    cones.centre_contacts(joint, energy, True, trial, inner)
    scaling = np.zeros((n, cones.N_SCALING))
    assert cones.scale(joint, inner, scaling) == pytest.approx(energy, rel=1e-5)
    for v, t, law in zip(inner, trial, joint, strict=True):
        assert v[PN] - v[W] + v[V] == pytest.approx(t[0], rel=1e-9, abs=1e-9)
        assert v[PN] * v[W] == pytest.approx(wanted, rel=1e-9)
        if law[CRUSH] > 0.0:
            assert v[CAP] * v[V] == pytest.approx(wanted, rel=1e-9)
            # Where it is crushed, what is left is below the rounding of the reaction.
            assert v[CAP] + v[PN] == pytest.approx(law[CRUSH], rel=1e-9)
        most = law[FRICTION] * v[PN] + law[INTERCEPT]
        pair, slack = np.array([most, v[P1], v[P2]]), np.array([v[ZETA], -v[Z1], -v[Z2]])
        scale = 1e-11 * np.abs(pair).max() * np.abs(slack).max()
        least = 2.0 * cones.LEAST_DISTANCE * most * np.hypot(t[1], t[2])
        assert product(pair, slack) == pytest.approx(
            (2.0 * PENALTY * energy + least, 0.0, 0.0), abs=scale, rel=1e-6
        )
        # The distance to the friction cone is found to 1e-14 of itself, high barriers make it
        # large.
        assert v[[P1, P2]] + v[[Z1, Z2]] == pytest.approx(t[1:], rel=1e-9, abs=1e-10 * most)


@pytest.mark.parametrize("second", [False, True])
def test_changes_solve_the_equations_of_joints_that_yield_linearised(second):
    """A full step leaves of each product what is of second order, less what was known of it."""
    rng = np.random.default_rng(18)
    n, joint, energy = 60, yielding_joints(60), 1e-3
    trial, inner = 300.0 * rng.normal(size=(n, 3)), np.zeros((n, cones.N_INNER))
    cones.centre_contacts(joint, 1e-2, True, trial, inner)
    trial += rng.normal(size=(n, 3))  # moved on since
    scaling, reaction = np.zeros((n, cones.N_SCALING)), np.zeros((n, 3))
    before, relative = cones.scale(joint, inner, scaling), 1e-5 * rng.normal(size=(n, 3))
    change, first = np.zeros_like(inner), np.zeros_like(inner)
    for again in (False, True)[: 1 + second]:
        first[:] = change
        cones.aim(joint, energy, again, trial, inner, change, scaling, reaction)
        cones.changes(joint, energy, again, relative, inner, scaling, change)
    capped = joint[:, CRUSH] > 0.0
    there = trial - relative * joint[:, [STIFF_N, STIFF_T, STIFF_T]]
    moved = inner + change
    assert moved[:, PN] - moved[:, W] + moved[:, V] == pytest.approx(there[:, 0], abs=1e-8)
    assert moved[:, [P1, P2]] + moved[:, [Z1, Z2]] == pytest.approx(there[:, 1:], abs=1e-7)
    assert change[capped, CAP] == pytest.approx(-change[capped, PN], rel=1e-12)
    for one, other, of in ((PN, W, slice(None)), (CAP, V, capped)):
        v, d, e = inner[of], change[of], first[of]
        left = v[:, one] * v[:, other] + d[:, one] * v[:, other] + v[:, one] * d[:, other]
        left += e[:, one] * e[:, other] * second
        assert left == pytest.approx(joint[of, STIFF_N] * energy, rel=1e-6)
    # How far the nearest factor allows, and the energy where nothing has moved.
    far, _ = cones.length(joint, inner, change, 0.0)
    ratio = (1.0 - cones.KEPT) * inner[:, [PN, W]] / -change[:, [PN, W]]
    crushing = (1.0 - cones.KEPT) * (inner[capped] / -change[capped])[:, [V, CAP]]
    ends = np.append(ratio.ravel(), crushing.ravel())
    assert far == pytest.approx(min(1.0, ends[ends > 0.0].min()), rel=1e-12)
    assert cones.energy_at(joint, 0.0, inner, change) == pytest.approx(before, rel=1e-9)


def test_normal_reactions_leave_their_cones_within_the_radius_and_are_put_back():
    joint, energy = joints_of(2, np.full(2, 0.5)), 1e-3
    trial = np.array([[5.0, 0.0, 0.0], [-5.0, 0.0, 0.0]])
    inner, change = np.zeros((2, cones.N_INNER)), np.zeros((2, cones.N_INNER))
    cones.centre_contacts(joint, energy, True, trial, inner)
    beyond = np.sqrt(joint[:, STIFF_N] * energy)
    for c, of in ((0, PN), (1, W)):
        change[:] = 0.0
        change[c, of] = -4.0 * (inner[c, of] + beyond[c])
        far, _ = cones.length(joint, inner, change, energy)
        least = cones.KEPT * inner[c, of] - beyond[c]
        assert far == pytest.approx((least - inner[c, of]) / change[c, of], rel=1e-12)
        moved = inner + far * change
        assert moved[c, of] < 0.0
        cones.centre_contacts(joint, energy, False, trial, moved)
        assert moved[:, [PN, W]] == pytest.approx(inner[:, [PN, W]], rel=1e-9)


def test_a_joint_that_dilates_is_put_back_with_its_slip():
    """It slides at its friction, r = T + c (|T_t| - mu r); T is 4e4 times larger than r."""
    joint, energy, raised = joints_of(1, 0.5, 0.5), 1e-8, 0.5
    trial = np.array([[-4e5, 8e5, 0.0]]) + [[12.0, 0.0, 0.0]]
    inner = np.zeros((1, cones.N_INNER))
    cones.centre_contacts(joint, energy, True, trial, inner)
    moved = inner.copy()
    moved[0, PN] *= -0.1
    cones.centre_contacts(joint, energy, False, trial, moved)
    assert moved == pytest.approx(inner, rel=1e-9)
    reaction, slack, zeta = moved[0, [PN, W, ZETA]]
    assert reaction - slack - raised * zeta == pytest.approx(trial[0, 0], rel=1e-9)
    assert reaction == pytest.approx(12.0 / (1.0 + 0.5 * raised), rel=1e-3)


@pytest.mark.parametrize(
    ("falls", "expected"), [(0.5, 0.125), (0.0, MOST_REDUCTION), (1.0, LEAST_REDUCTION)]
)
def test_the_barrier_aimed_at_is_the_cube_of_what_a_predictor_leaves(falls, expected):
    """The slacks of contacts without friction fall by a share, and their energy as well."""
    joint, (inner, change) = joints_of(5, 0.0), np.zeros((2, 5, cones.N_INNER))
    inner[:, [PN, W]], change[:, W] = (3.0, 2.0), -2.0 * falls
    energy = cones.scale(joint, inner, np.zeros((5, cones.N_SCALING)))
    found = central_path.reduction(joint, inner, change, 1.0, energy)
    assert found == pytest.approx(expected, rel=1e-12)
    assert central_path.reduction(joint, inner, change, 1.0, 0.0) == 0.0  # no barrier is left


def test_the_scaling_takes_slacks_to_impulses():
    """W D = W^-1 P, so that W^2 D = P, with W from its formula."""
    rng = np.random.default_rng(3)
    n, mu = 20, 0.7
    inner, scaling = np.zeros((n, cones.N_INNER)), np.zeros((n, cones.N_SCALING))
    inner[:, PN], inner[:, W] = rng.uniform(0.1, 9.0, (2, n))
    for first, size in (((P1, P2), mu * inner[:, PN]), ((Z1, Z2), None)):
        angle, share = rng.uniform(0, 2 * np.pi, n), rng.uniform(0.0, 0.999, n)
        if size is None:
            size = inner[:, ZETA] = rng.uniform(0.1, 9.0, n)
        inner[:, first[0]], inner[:, first[1]] = share * size * (np.cos(angle), np.sin(angle))
    cones.scale(joints_of(n, mu), inner, scaling)
    for v, s in zip(inner, scaling, strict=True):
        w0, w = s[V0], s[[V1, V2]]
        matrix = np.eye(3)
        matrix[0, 0], matrix[0, 1:], matrix[1:, 0] = w0, w, w
        matrix[1:, 1:] += np.outer(w, w) / (1.0 + w0)
        matrix *= s[ETA]
        pair = np.array([mu * v[PN], v[P1], v[P2]])
        assert matrix @ matrix @ (v[ZETA], -v[Z1], -v[Z2]) == pytest.approx(pair, rel=1e-9)


class Slab:
    """A slab of 1000 kg, 1 x 0.8 x 0.2 m, on four points of a support."""

    def __init__(self, push, twist, friction=0.5):
        contacts = Contacts.empty(4, 3, 6)
        contacts.which[:, SLOT], contacts.which[:, BODY_A] = np.arange(4), 0
        contacts.which[:, BODY_B] = 1
        contacts.table[:, STIFF_N], contacts.table[:, FRICTION] = STIFFNESS, friction
        for c, (x, y) in enumerate(((-0.5, -0.4), (0.5, -0.4), (0.5, 0.4), (-0.5, 0.4))):
            for i, axis in enumerate(np.eye(3)[[2, 0, 1]]):
                contacts.rows[c, i, 6:9] = axis
                contacts.rows[c, i, 9:] = np.cross((x, y, -0.1), axis)
        mass = np.zeros((2, 6))
        mass[1] = 1e3 * np.array([1, 1, 1, 0.68 / 12, 1.04 / 12, 1.64 / 12])
        inverse = np.zeros_like(mass)
        inverse[1] = 1.0 / mass[1]
        self.problem = ContactProblem(contacts, np.zeros(4), inverse)
        fixed = np.array([True, False])
        self.system = BlockSystem(
            np.array([0]), np.array([1]), mass, fixed, np.array([[0.0, 0, -1], [0, 0, 0]])
        )
        force = np.array([*push, -9810.0, 0.0, 0.0, twist])
        self.free = np.zeros((2, 6))
        self.free[1] = H * force * inverse[1]
        self.mass, self.force = mass, force

    def solve(self, way=None):
        settings = nlgs.NlgsSettings(tolerance=1e-3, max_sweeps=2000)
        impulse, velocity = np.zeros((4, 3)), np.zeros((2, 6))
        extent = np.ones(2)
        if way is None:
            return nlgs.solve(
                self.problem, self.system, extent, self.free, impulse, velocity, H, settings
            )
        nlgs.natural_map(self.problem, 3, H)
        accelerator = nlgs._Accelerator(self.problem, self.system, self.free, H, settings, None)
        step = nlgs._Step(self.problem, self.system, extent, self.free, H, None)
        impulse[:, 0] = 9810.0 * H / 4
        known = impulse, velocity, np.inf
        return step.best([lambda p: accelerator.from_within(impulse, velocity, p)], known, 1e-3)


@pytest.mark.parametrize("push", [(3000.0, 2000.0), (6000.0, 0.0), (0.0, -9000.0)])
@pytest.mark.parametrize("twist", [0.0, 500.0, -4000.0])
def test_from_within_a_slab_is_solved_as_by_sweeps(push, twist):
    """Sticking, sliding and turning under 4905 N of friction; overturning in part at -9000 N."""
    slab = Slab(push, twist)
    _, velocity, residual = slab.solve(way="within")
    assert residual <= 1e-3  # N
    swept = slab.solve()
    assert swept.residual <= 1e-3
    # Held forces may differ where four points share them; motions are one.  1e-3 N move 1000 kg by
    # 1e-7 m/s in a step; moments of inertia are a tenth to a twentieth of that.
    assert velocity == pytest.approx(swept.velocity, abs=1e-5)


def test_sliding_takes_all_friction_against_the_motion():
    slab = Slab((6000.0, 3000.0), 0.0)
    result = slab.solve()
    along = np.array([6000.0, 3000.0]) / np.hypot(6000.0, 3000.0)
    # The joints press in as the step begins: m / (m + 4 k h^2) of the weight is not carried yet.
    normal = result.impulse[:, 0].sum() / H
    assert normal == pytest.approx(9810.0 * 40.0 / 41.0, rel=1e-6)
    # The push less mu N, over mass, for a step.
    speed = (np.hypot(6000.0, 3000.0) - 0.5 * normal) / 1e3 * H
    turning = np.abs(np.cross(result.velocity[1, 3:], (0, 0, -0.1))[:2]).max()
    assert result.velocity[1, :2] == pytest.approx(speed * along, abs=turning + 1e-6)
