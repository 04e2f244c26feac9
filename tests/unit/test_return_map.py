"""The map of the joint law, and the forms that solvers have of it, on random trial reactions."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.contact.contacts import (
    CRUSH,
    FRICTION,
    INTACT,
    INTERCEPT,
    LIFT,
    N_TABLE,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
)
from drystone.law import cones, cycles, impulse, softening
from drystone.law import plane as plane_law
from drystone.law import space as space_law
from drystone.law.branches import (
    BACKWARD,
    BONDED,
    CRUSHED,
    FORWARD,
    OPEN,
    STICKING,
    TORN,
    WITHIN,
    along_joint,
    both,
)
from drystone.law.columns import (
    BROKEN,
    BY_CRUSHING,
    BY_OPENING,
    BY_SLIP,
    COHESIVE,
    CRUSHES,
    DILATANCY_END,
    KN,
    KS,
    LEAST_MU,
    MU,
    N_HISTORY,
    N_LAW,
    OPENED,
    PER_SLIP,
    PULLS,
    SLID,
    SOFTENED,
    SOFTENS,
    TAN_PSI,
    YIELDS,
)
from drystone.law.return_map import branch_for, derivatives_in, reactions_in
from drystone.law.status import SLIDING

pytestmark = pytest.mark.kernels

#: Kinds of joints: lift over k_s, cohesion intercept, crushing reaction.
KINDS = {
    "dry": (0.0, 0.0, np.inf),
    "dilating": (0.3, 0.0, np.inf),
    "bonded": (0.0, 0.4, np.inf),
    "crushed": (0.0, 0.0, 1.0),
    "both": (0.0, 0.4, 1.0),
}


def draws(kind, n=400, seed=1):
    """Rows of r_n, T, k_s, mu, lift, k, C."""
    rng = np.random.default_rng(seed)
    lift, intercept, crush = KINDS[kind]
    for _ in range(n):
        ks = rng.uniform(0.5, 2.0)
        rn, shear = rng.normal(0.3, 1.0), abs(rng.normal(0.0, 1.0))
        yield rn, shear, ks, rng.uniform(0.2, 0.9), lift * ks, intercept, crush


@pytest.mark.parametrize("kind", KINDS)
def test_reactions_are_admissible_and_slip_opposes_shear(kind):
    seen = set()
    for rn, shear, *joint in draws(kind):
        ks, mu, lift, intercept, crush = joint
        now = branch_for(rn, shear, *joint, OPEN, FORWARD)
        seen.add(now)
        normal, tangential, slid = reactions_in(now, rn, shear, *joint)
        assert -1e-12 <= normal <= crush * (1.0 + 1e-12)
        assert 0.0 <= tangential <= mu * normal + intercept + 1e-12
        assert slid >= 0.0
        # What the joint slid and lifted by makes up for what the trial reactions had too much.
        if now not in (OPEN, BONDED):
            assert tangential == pytest.approx(shear - ks * slid, abs=1e-12)
        if now == FORWARD:
            assert normal == pytest.approx(rn + lift * slid, abs=1e-12)
    shear_branches = {STICKING, FORWARD}
    expected = {
        "dry": {OPEN} | shear_branches,
        "dilating": {OPEN} | shear_branches,
        "bonded": shear_branches | {both(TORN, b) for b in shear_branches},
        "crushed": {OPEN} | shear_branches | {both(CRUSHED, b) for b in shear_branches},
        "both": {both(s, b) for s in (WITHIN, TORN, CRUSHED) for b in shear_branches},
    }
    assert seen == expected[kind]


@pytest.mark.parametrize("kind", KINDS)
def test_derivatives(kind):
    """In its branch the map is linear: differences are exact but for rounding."""
    h = 1e-3
    for rn, shear, *joint in draws(kind):
        now = branch_for(rn, shear, *joint, OPEN, FORWARD)
        nn, nt, tn, tt = derivatives_in(now, *joint[:3])
        by_n = np.subtract(
            reactions_in(now, rn + h, shear, *joint), reactions_in(now, rn - h, shear, *joint)
        )
        by_t = np.subtract(
            reactions_in(now, rn, shear + h, *joint), reactions_in(now, rn, shear - h, *joint)
        )
        assert by_n[:2] / (2.0 * h) == pytest.approx([nn, tn], abs=1e-11)
        assert by_t[:2] / (2.0 * h) == pytest.approx([nt, tt], abs=1e-11)


def packed(rn, rt, ks, mu, lift, intercept, crush):
    """A row of the table of contacts; k_n is one."""
    table = np.zeros((1, N_TABLE))
    table[0, [TRIAL_N, TRIAL_T, STIFF_N, STIFF_T, FRICTION, LIFT, INTERCEPT]] = (
        rn, rt, 1.0, ks, mu, lift, intercept,
    )  # fmt: skip
    table[0, CRUSH] = crush if np.isfinite(crush) else 0.0
    return table


@pytest.mark.parametrize("kind", KINDS)
def test_the_form_of_the_plane_is_the_map_with_a_sign(kind):
    for sign, (rn, shear, *joint) in zip(np.resize([1.0, -1.0], 400), draws(kind), strict=True):
        table = packed(rn, sign * shear, *joint)
        now = branch_for(rn, shear, *joint, OPEN, FORWARD if sign > 0.0 else BACKWARD)
        assert plane_law.branch_of(table, 0, OPEN) == now
        normal, tangential, slid = reactions_in(now, rn, shear, *joint)
        assert plane_law.reactions(table, 0, now) == pytest.approx(
            (normal, sign * tangential, slid)
        )
        reaction, response = np.zeros((1, 3)), np.zeros((1, 3, 3))
        plane_law.respond(table, 0, 1, np.array([now]), reaction, response)
        assert reaction[0] == pytest.approx([normal, sign * tangential, 0.0])
        nn, nt, tn, tt = derivatives_in(now, *joint[:3])
        assert response[0, :2, :2].ravel() == pytest.approx([nn, sign * nt, sign * tn, tt])


@pytest.mark.parametrize("kind", KINDS)
def test_the_form_of_space_is_the_map_along_the_shear(kind):
    rng = np.random.default_rng(2)
    for rn, shear, *joint in draws(kind):
        table, angle = packed(rn, 0.0, *joint), rng.uniform(0.0, 2.0 * np.pi)
        along = np.array([np.cos(angle), np.sin(angle)])
        trial = np.array([[rn, *(shear * along)]])
        branch, reaction, response = np.zeros(1, np.int64), np.zeros((1, 3)), np.zeros((1, 3, 3))
        space_law.respond(table, trial, 0, 1, branch, reaction, response)
        normal, tangential, _ = reactions_in(branch[0], rn, shear, *joint)
        assert branch[0] == branch_for(rn, shear, *joint, OPEN, FORWARD)
        assert reaction[0] == pytest.approx([normal, *(tangential * along)], abs=1e-12)
        nn, nt, tn, tt = derivatives_in(branch[0], *joint[:3])
        inward = np.array([along @ response[0, 1:, 0], along @ response[0, 1:, 1:] @ along])
        assert inward == pytest.approx([tn, tt], abs=1e-12)
        assert response[0, 0] == pytest.approx([nn, *(nt * along)], abs=1e-12)


def test_a_bond_that_holds_answers_with_its_trial_reactions():
    table = packed(-0.4, 0.0, 1.0, 0.5, 0.0, 0.0, np.inf)
    table[0, INTACT] = 1.0
    trial, reaction = np.array([[-0.4, 2.0, -1.0]]), np.zeros((1, 3))
    branch = np.zeros(1, np.int64)
    space_law.respond(table, trial, 0, 1, branch, reaction, np.zeros((1, 3, 3)))
    assert branch[0] == BONDED and np.array_equal(reaction, trial)


@pytest.mark.parametrize("kind", ["dry", "dilating"])
def test_the_form_of_cycles_is_the_map(kind):
    """Of contacts that press: those that do not are open in a cycle whatever they slide."""
    for rn, shear, *joint in draws(kind):
        if rn <= 0.0:
            continue
        ks, mu, lift = joint[:3]
        laws, history = np.zeros((1, N_LAW)), np.zeros((1, N_HISTORY))
        laws[0, [KN, KS, MU, TAN_PSI]] = 1.0, ks, mu, lift
        laws[0, DILATANCY_END], history[0, BROKEN] = np.inf, 1.0
        normal, tangential, now, _ = cycles.react_in_cycle(laws, history, 0, rn, -rn, shear, False)
        branch = branch_for(rn, shear, *joint, OPEN, FORWARD)
        expected = reactions_in(branch, rn, shear, *joint)
        assert (normal, tangential) == pytest.approx(expected[:2], rel=2e-9)
        slides = now == SLIDING
        assert slides == (along_joint(branch) == FORWARD)
        assert history[0, SLID] == pytest.approx(expected[2], abs=1e-9)


def test_the_form_of_impulses_is_the_map():
    """Sticking as a stiff hold of one kilogram, without dilation."""
    for rn, shear, _, mu, *_ in draws("dry"):
        joint = 1.0, mu, 0.0, 0.0, np.inf
        pn, pt, _ = impulse.projected_impulse(rn, shear, mu, False)
        branch = branch_for(rn, shear, *joint, OPEN, FORWARD)
        assert (pn, pt) == pytest.approx(reactions_in(branch, rn, shear, *joint)[:2], rel=2e-9)
        p = impulse.projected_impulse_in_space(rn, 0.6 * shear, -0.8 * shear, mu, False)
        assert p[:3] == pytest.approx((pn, 0.6 * pt, -0.8 * pt), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("kind", ["dry", "bonded", "crushed", "both"])
def test_the_interior_ends_on_the_map(kind):
    """Of a barrier of nearly nothing, in the plane and in space; dilation is left to iterations."""
    energy = 1e-16
    for rn, shear, *joint in draws(kind):
        expected = reactions_in(branch_for(rn, shear, *joint, OPEN, FORWARD), rn, shear, *joint)
        table = packed(rn, -shear, *joint)
        for along in ((0.6, -0.8), (-1.0, 0.0)):  # in space, and in the plane
            inner = np.zeros((1, cones.N_INNER))
            trial = np.array([[rn, along[0] * shear, along[1] * shear]])
            cones.centre_contacts(table, energy, True, trial, inner)
            sheared = [share * expected[1] for share in along]
            assert inner[0, :3] == pytest.approx([expected[0], *sheared], abs=1e-7)


#: Of joints that soften: strengths c and f_t, how they fall by slip and opening, what friction
#: falls to, and crushing strength.
YIELDING = {
    "bond": (0.5, 0.3, 0.2, 0.3, 0.4, 0.0),
    "bond, crushed": (0.5, 0.3, 0.2, 0.3, 0.4, 1.0),
    "friction": (0.0, 0.0, 0.0, 0.0, 0.2, 0.0),
}


def yielding_draws(kind, rng):
    """Rows of law and history of joints that yield, whole or broken, gap and shear; k_n is one."""
    cohesion, tension, by_slip, by_opening, least, crush = YIELDING[kind]
    for _ in range(400):
        law, history = np.zeros((1, N_LAW)), np.zeros((1, N_HISTORY))
        law[0, [KN, KS, MU, YIELDS, COHESIVE, PULLS]] = (
            1.0,
            rng.uniform(0.5, 2.0),
            0.6,
            1.0,
            cohesion,
            tension,
        )
        law[0, [BY_SLIP, BY_OPENING, LEAST_MU]] = by_slip, by_opening, least
        law[0, [CRUSHES, BY_CRUSHING]] = crush or np.inf, 0.3 if crush else 0.0
        law[0, [SOFTENS, PER_SLIP]] = (1.0, 0.0) if cohesion else (0.0, 0.5)
        history[0, BROKEN] = float(rng.uniform() < 0.3 or not cohesion)
        history[0, [SOFTENED, SLID, OPENED]] = rng.uniform(0.0, 1.0, 3) * [1.0, 1.0, 0.2]
        yield law, history, rng.normal(-0.3, 1.0), abs(rng.normal(0.0, 1.0))


def held_where(law, history, gap, softened, slid, crushed):
    """Trial normal reaction from the tension on, mu, tension, cohesion intercept and crushing
    reaction of a joint that has come so far."""
    whole = history[0, BROKEN] == 0.0
    left = np.exp(-softened) if whole else 0.0
    opened = history[0, OPENED] if whole else 0.0
    fallen = left if law[0, SOFTENS] else np.exp(-law[0, PER_SLIP] * slid)
    mu = law[0, LEAST_MU] + (law[0, MU] - law[0, LEAST_MU]) * fallen
    pulls = whole and (opened == 0.0 or gap > opened)
    pull = law[0, PULLS] * left if pulls else 0.0
    trial = -law[0, KN] * (gap - opened if pulls and gap > 0.0 else gap) + pull
    crush = law[0, CRUSHES] * np.exp(-law[0, BY_CRUSHING] * crushed) + pull
    return trial, mu, pull, max(law[0, COHESIVE] * left - mu * pull, 0.0), crush


@pytest.mark.parametrize("kind", YIELDING)
def test_joints_that_soften_have_the_map_of_their_strengths_where_a_step_ends(kind):
    seen = set()
    for law, history, gap, shear in yielding_draws(kind, np.random.default_rng(3)):
        contact, point = np.zeros((1, softening.N_CONTACT)), np.zeros((1, softening.N_POINT))
        contact[0, softening.C_WHOLE] = history[0, BROKEN] == 0.0
        contact[0, [softening.C_SOFTENED, softening.C_OPENED, softening.C_SLID]] = history[
            0, [SOFTENED, OPENED, SLID]
        ]
        contact[0, [softening.C_GAP, softening.C_SHEAR]] = gap, shear
        softening.points(law, np.zeros(1, np.int64), contact, point)
        at = point[0]
        trial, mu, pull, intercept, crush = held_where(
            law, history, gap, at[softening.P_SOFTENED], at[softening.P_SLID],
            at[softening.P_CRUSHED],
        )  # fmt: skip
        joint = law[0, KS], mu, 0.0, intercept, crush
        now = branch_for(trial, shear, *joint, OPEN, FORWARD)
        normal, tangential, slid = reactions_in(now, trial, shear, *joint)
        seen.add(now)
        found = at[[softening.P_NORMAL, softening.P_SHEAR]]
        assert found == pytest.approx([normal - pull, tangential], abs=1e-9)
        if now != OPEN:
            assert at[softening.P_SLID] - history[0, SLID] == pytest.approx(slid, abs=1e-9)
    assert {STICKING, FORWARD} < seen


@pytest.mark.parametrize("whole", [True, False])
@pytest.mark.parametrize("share", [1.0, 1.5, 1e3])
def test_joints_whose_friction_falls_faster_than_their_shear_snap_back(whole, share):
    """Pressed so that friction falls by ``share`` of what the slip releases, and sheared beyond
    friction: they slide as far as their residual friction lets them."""
    law, pressure, rate = np.zeros((1, N_LAW)), 10.0, 0.1
    law[0, [KN, KS, MU, LEAST_MU, CRUSHES, YIELDS]] = 1.0, 1.0, 0.6, 0.4, np.inf, 1.0
    rate = share / ((law[0, MU] - law[0, LEAST_MU]) * pressure)
    if whole:  # its cohesion counts for next to nothing
        law[0, [COHESIVE, BY_SLIP, SOFTENS]] = 1e-9, rate, 1.0
    else:
        law[0, PER_SLIP] = rate
    contact, point = np.zeros((1, softening.N_CONTACT)), np.zeros((1, softening.N_POINT))
    contact[0, [softening.C_WHOLE, softening.C_GAP, softening.C_SHEAR]] = whole, -pressure, 6.5
    softening.points(law, np.zeros(1, np.int64), contact, point)
    at = point[0]
    assert np.isfinite(at).all()
    slid = at[softening.P_SOFTENED] / rate if whole else at[softening.P_SLID]
    mu = 0.4 + 0.2 * np.exp(-rate * slid)
    assert at[softening.P_SHEAR] == pytest.approx(mu * pressure, rel=1e-6)
    assert at[softening.P_SHEAR] == pytest.approx(6.5 - slid, rel=1e-6)


@pytest.mark.parametrize("kind", YIELDING)
def test_joints_that_yield_have_the_map_of_the_last_cycles_strengths(kind):
    for law, history, gap, shear in yielding_draws(kind, np.random.default_rng(4)):
        law[0, [BY_SLIP, BY_OPENING]] = 0.0  # what softens in the cycle itself is for the next
        before = history.copy()
        trial, mu, pull, intercept, crush = held_where(
            law, before, gap, before[0, SOFTENED], before[0, SLID], 0.0
        )
        joint = law[0, KS], mu, 0.0, intercept, crush
        now = branch_for(trial, shear, *joint, OPEN, FORWARD)
        normal, tangential, _ = reactions_in(now, trial, shear, *joint)
        found = cycles.react_in_cycle(law, history, 0, -gap, gap, shear, False)
        assert found[:2] == pytest.approx((normal - pull, tangential), abs=1e-9)
