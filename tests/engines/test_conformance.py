"""What every engine must do, whatever its formulation: one suite, run over all of them."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

from builders import (
    BONDED_JOINT,
    PUBLISHED_JOINT,
    UNIT_WEIGHT,
    problem_of,
    rectangle,
    small_wall,
    stack,
    turned,
    with_corner,
    with_joint,
)
from drystone.analysis.driver import pushover
from drystone.engines import make_engine
from drystone.engines.base import Demand, EngineError, UnstableError
from drystone.law import certificate
from drystone.model.assembly import Block, Corner
from drystone.model.builders import make_model, published_wall
from drystone.model.joint_law import JointLaw
from drystone.results.curve import COLUMNS, CapacityCurve
from lmgc90_here import needs_lmgc90

TESTS = Path(__file__).resolve().parents[1]


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """How well an engine keeps what it promises, and why no better."""

    balance: float  # of forces on a block, over the heaviest block's weight
    closing: float  # of a joint's closing at rest, relative
    carried: float  # of multipliers applied and carried at rest


TOLERANCES = {
    # Its residual is 5e-7 of the heaviest weight (NscdSettings.tolerance).  It steps on until a
    # step from rest moves the blocks by 1e-3 of the penetration; at 0.05 s a step leaves about 1 /
    # (1 + h^2 k / m) = 1e-3 of what is missing, so that much less than 1e-4 is left.  A step under
    # a load closes the joints by what it has time for.
    "nscd": Tolerances(balance=1e-6, closing=1e-4, carried=1e-3),
    # Newton's method to 1e-9 of the heaviest weight; the rest is the inertia that steps of 30 s
    # leave, 1e-3 of a force at most (EquilibriumSettings.inertia_limit).
    "equilibrium": Tolerances(balance=1e-6, closing=1e-4, carried=1e-3),
}
ENGINES = ["nscd", "equilibrium"]

STRATEGIES = ("displacement", "published")


@pytest.fixture(params=ENGINES)
def engine(request):
    """A name from `ENGINES`."""
    return request.param


@pytest.fixture
def tolerance(engine):
    """The engine's line of the table."""
    return TOLERANCES[engine]


def started(model, name):
    engine = make_engine(name)
    state, report = engine.start(problem_of(model))
    return engine, state, report


def resultants(model, state, contacts, multiplier):
    """Force and moment about its centroid that is left on each block, from the results alone."""
    a = model.assembly
    f = contacts.vectors()
    place = a.centroid + state.pose[:, :2]
    left = np.zeros((a.n_bodies, 3))
    for body, sign in ((contacts.block_a, -1.0), (contacts.block_b, 1.0)):
        arm = contacts.position - place[body]
        moment = arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]
        np.add.at(left, body, sign * np.column_stack((f, moment)))
    load = np.outer(a.weight, (0.0, -1.0)) + multiplier * np.outer(a.weight, model.load.direction)
    return left + np.column_stack((load, np.zeros(a.n_bodies)))


class TestAtRest:
    def test_two_blocks_come_to_rest(self, engine, tolerance):
        """Joints close by the weight above over stiffness and area, straight down."""
        model = stack((0.4, 0.2), (0.4, 0.2), corner=Corner(radius=0.02))
        _, state, report = started(model, engine)
        weight = 0.4 * 0.2 * UNIT_WEIGHT
        lower = 2.0 * weight / (1e8 * 0.4)
        upper = lower + weight / (1e8 * 0.4)
        assert state.pose[1:, 1] == pytest.approx([-lower, -upper], rel=tolerance.closing)
        assert state.pose[:, [0, 2]] == pytest.approx(0.0, abs=1e-4 * upper)
        assert np.all(state.pose[0] == 0.0)
        assert report.converged and report.residual <= 1e-6
        assert report.penetration == pytest.approx(lower, rel=tolerance.closing)
        assert report.control_displacement == pytest.approx(0.0, abs=1e-4 * upper)

    @pytest.mark.parametrize(
        "make", [small_wall, lambda: published_wall(3)], ids=["small", "wall 3"]
    )
    def test_supports_carry_the_weight_and_nothing_sideways(self, engine, tolerance, make):
        model = make()
        solver, state, report = started(model, engine)
        contacts = solver.contacts(state)
        on_base = contacts.block_a == model.assembly.index("base")
        weight = model.assembly.weight[~model.assembly.fixed].sum()
        scale = tolerance.balance * model.assembly.heaviest_weight * model.assembly.n_blocks
        carried = contacts.vectors()[on_base].sum(axis=0)
        assert carried == pytest.approx([0.0, weight], abs=max(scale, 1e-3 * weight))
        assert report.carried_multiplier == pytest.approx(0.0, abs=tolerance.carried)

    @pytest.mark.parametrize("multiplier", [0.0, 0.2])
    def test_forces_balance_on_every_block(self, engine, tolerance, multiplier):
        """By the contact forces and places that are given out, not by the engine's own sums."""
        model = small_wall()
        solver, state, report = started(model, engine)
        # Up in steps, and then left to come to rest.
        for share in (*np.linspace(0.1, 1.0, 10), *[1.0] * 10):
            demand = Demand(multiplier=multiplier * share, time_step=0.1)
            state, report = solver.step(state, demand)
            assert report.converged
        a = model.assembly
        left = resultants(model, state, solver.contacts(state), multiplier)[~a.fixed]
        assert np.abs(left).max() <= tolerance.balance * a.heaviest_weight
        assert report.applied_multiplier == multiplier
        assert report.carried_multiplier == pytest.approx(multiplier, abs=tolerance.carried)

    @pytest.mark.parametrize(
        "corner", [Corner(), Corner(radius=0.02), Corner(chamfer=0.02)], ids=repr
    )
    @pytest.mark.parametrize("pieces", [1, 2, 5])
    def test_the_joint_is_as_stiff_whatever_the_number_of_points(
        self, engine, tolerance, corner, pieces
    ):
        """A block upon one, two or five supports in a row: 2 to 10 contact points, one joint."""
        width = 0.5 / pieces
        blocks = [
            Block(
                id=f"s{i}",
                vertices=rectangle(i * width, -0.2, width, 0.2),
                unit_weight=UNIT_WEIGHT,
                support=True,
            )
            for i in range(pieces)
        ]
        upper = Block(id="b", vertices=rectangle(0.0, 0.0, 0.5, 0.2), unit_weight=UNIT_WEIGHT)
        model = make_model(
            [*blocks, upper],
            joint=PUBLISHED_JOINT,
            corner=corner,
            thickness=1.0,
            load_direction=(1.0, 0.0),
        )
        solver, state, _ = started(model, engine)
        closing = 0.5 * 0.2 * UNIT_WEIGHT / (1e8 * 0.5)
        assert state.pose[-1, 1] == pytest.approx(-closing, rel=tolerance.closing)
        contacts = solver.contacts(state)
        pressed = contacts.normal_reaction > 0.0
        assert np.count_nonzero(pressed) == 2 * pieces
        # Less what the block may have slipped under the dead load, far less than it has closed by.
        assert contacts.area[pressed].sum() == pytest.approx(0.5, abs=1e-3 * closing)

    def test_two_columns_do_not_feel_each_other(self, engine, tolerance):
        """One block beside another, 0.2 m away: each closes its joint as if it were alone."""
        blocks = [
            Block(
                id="base",
                vertices=rectangle(-1.0, -0.2, 2.0, 0.2),
                unit_weight=UNIT_WEIGHT,
                support=True,
            ),
            Block(id="low", vertices=rectangle(-0.5, 0.0, 0.4, 0.2), unit_weight=UNIT_WEIGHT),
            Block(id="high", vertices=rectangle(0.1, 0.0, 0.4, 0.6), unit_weight=UNIT_WEIGHT),
        ]
        model = make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))
        _, state, _ = started(model, engine)
        low, high = 0.2 * UNIT_WEIGHT / 1e8, 0.6 * UNIT_WEIGHT / 1e8
        assert state.pose[1:, 1] == pytest.approx([-low, -high], rel=tolerance.closing)


class TestStanding:
    """mu = 0.65: the angle of friction is 33.02 degrees."""

    @pytest.mark.parametrize("sign", [-1.0, 1.0])
    @pytest.mark.parametrize("degrees", [10.0, 25.0, 32.0])
    def test_a_block_on_a_plane_below_the_angle_of_friction(self, engine, degrees, sign):
        model = stack((1.0, 0.2), tilt=sign * np.radians(degrees))
        solver, state, _ = started(model, engine)
        contacts = solver.contacts(state)
        weight = 1.0 * 0.2 * UNIT_WEIGHT
        angle = np.radians(degrees)
        assert contacts.normal_reaction.sum() == pytest.approx(weight * np.cos(angle), rel=1e-3)
        shear = abs(contacts.tangential_reaction.sum())
        assert shear == pytest.approx(weight * np.sin(angle), rel=1e-3)
        # It does not creep: joints close by W / k A = 2e-5 m.
        assert np.abs(state.pose[1, :2]).max() < 1e-4

    @pytest.mark.parametrize("sign", [-1.0, 1.0])
    @pytest.mark.parametrize("degrees", [34.0, 45.0])
    def test_a_block_on_a_plane_above_it(self, engine, degrees, sign):
        model = stack((1.0, 0.2), tilt=sign * np.radians(degrees))
        with pytest.raises(UnstableError, match='"b1"'):
            started(model, engine)

    def test_what_falls_is_named_and_what_stands_is_not(self, engine):
        """A block whose centroid lies beyond the edge that it stands on tips over."""
        blocks = [
            Block(
                id="base",
                vertices=rectangle(-1.0, -0.2, 1.0, 0.2),
                unit_weight=UNIT_WEIGHT,
                support=True,
            ),
            Block(id="steady", vertices=rectangle(-0.9, 0.0, 0.4, 0.2), unit_weight=UNIT_WEIGHT),
            Block(id="tips", vertices=rectangle(-0.1, 0.0, 0.4, 0.2), unit_weight=UNIT_WEIGHT),
        ]
        model = make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))
        with pytest.raises(UnstableError) as error:
            started(model, engine)
        assert '"tips"' in str(error.value)
        assert '"steady"' not in str(error.value)

    @pytest.mark.parametrize("solver", [*ENGINES, "distinct"])
    def test_a_block_with_next_to_no_support_falls_in_the_same_words(self, solver):
        """0.1 m of its 2.1 m rest on the base."""
        blocks = [
            Block(
                id="base",
                vertices=rectangle(-1.0, -1.0, 2.0, 1.0),
                unit_weight=UNIT_WEIGHT,
                support=True,
            ),
            Block(id="tips", vertices=rectangle(0.9, 0.0, 2.1, 0.5), unit_weight=UNIT_WEIGHT),
        ]
        model = make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))
        said = (
            r"^the structure does not stand under its own weight: "
            r"\"tips\" \(\d+ mm\) keeps moving$"
        )
        with pytest.raises(UnstableError, match=said):
            started(model, solver)

    def test_a_stack_that_leans_too_far(self, engine):
        """Three bricks, each 0.12 m further out, the lowest past the end of the base at 0.3 m.

        Their centroids lie at 0.20, 0.32 and 0.44 m.  Two stand, with their common one at 0.26 m;
        the third brings it to 0.32 m and all three down.
        """
        brick = rectangle(0.0, 0.0, 0.4, 0.1)
        base = Block(
            id="base",
            vertices=rectangle(-1.0, -0.2, 1.3, 0.2),
            unit_weight=UNIT_WEIGHT,
            support=True,
        )
        bricks = [
            Block(id=f"b{i + 1}", vertices=brick + (0.12 * i, 0.1 * i), unit_weight=UNIT_WEIGHT)
            for i in range(3)
        ]
        two, three = (
            make_model(
                [base, *bricks[:n]], joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0)
            )
            for n in (2, 3)
        )
        started(two, engine)
        with pytest.raises(UnstableError, match=r'"b3".* keeps? moving'):
            started(three, engine)


def arrays(value):
    """All arrays and numbers in a state, however nested, copied."""
    if isinstance(value, np.ndarray):
        return [value.copy()]
    if is_dataclass(value):
        return [a for f in fields(value) for a in arrays(getattr(value, f.name))]
    if isinstance(value, tuple | list):
        return [a for item in value for a in arrays(item)]
    if isinstance(value, int | float):
        return [np.array(value)]
    return []


def digest(curve: CapacityCurve) -> str:
    """Of every number of every point, bit by bit."""
    sha = hashlib.sha256()
    for name in COLUMNS:
        column = curve.column(name)
        sha.update(column.tobytes() if column.dtype.kind in "fib" else "".join(column).encode())
    return sha.hexdigest()


def short_curve(engine, strategy):
    """Over the peak of a small wall and a little further."""
    return pushover(small_wall(), engine=engine, strategy=strategy, max_displacement=0.02)


class TestStates:
    def test_a_step_leaves_the_state_it_starts_from_alone(self, engine):
        model = small_wall()
        solver, state, _ = started(model, engine)
        for multiplier in (0.1, 0.2, 0.3):
            state, report = solver.step(state, Demand(multiplier=multiplier, time_step=0.1))
            assert report.converged
        before = arrays(state)
        demand = Demand(multiplier=0.35, time_step=0.1)
        one, first = solver.step(state, demand)
        # Elsewhere, and back.
        away = state
        for multiplier in (0.5, 0.1):
            away, _ = solver.step(away, Demand(multiplier=multiplier, time_step=0.1))
        two, second = solver.step(state, demand)
        assert first == second
        for found in (two, state):
            expected = arrays(one) if found is two else before
            for x, y in zip(arrays(found), expected, strict=True):
                assert np.array_equal(x, y, equal_nan=True)

    def test_a_step_that_fails_returns_the_state_it_started_from(self, engine):
        model = stack((0.4, 0.9))
        solver, state, _ = started(model, engine)
        # One second under ten times the weight throws the block by metres.
        new, report = solver.step(state, Demand(multiplier=10.0, time_step=1.0))
        assert not report.converged
        assert report.reason
        assert new is state

    def test_two_analyses_do_not_mix(self, engine):
        """A solver used for another model, and then again for the first, gives the same curve."""
        solver = make_engine(engine)
        first = pushover(small_wall(), engine=solver, strategy="displacement", max_steps=20)
        pushover(stack((0.4, 0.9)), engine=solver, strategy="displacement", max_steps=5)
        again = pushover(small_wall(), engine=solver, strategy="displacement", max_steps=20)
        assert digest(first) == digest(again)


EVERY_ENGINE = [
    *ENGINES,
    "distinct",
    pytest.param("lmgc90", marks=needs_lmgc90),
]


class TestOneResidual:
    """Balance, normal law and friction law, judged alike whoever found the step."""

    @staticmethod
    def traced(model, engine):
        solver = make_engine(engine)
        curve = pushover(
            model, engine=solver, strategy="displacement", max_displacement=5e-3, max_steps=60
        )
        assert len(curve.points) > 3
        return solver, curve

    @staticmethod
    def keeps(solver, curve):
        """What the engine promises, of every point, by figures that it did not choose itself."""
        assert curve.residual.max() <= solver.capabilities.residual_limit
        violation = curve.column("friction_violation")
        assert np.all(violation >= 0.0)
        assert violation.max() <= solver.capabilities.residual_limit

    @pytest.mark.parametrize("name", EVERY_ENGINE)
    def test_every_point_keeps_what_the_engine_promises(self, name):
        solver, curve = self.traced(stack((0.4, 0.3), (0.3, 0.6)), name)
        self.keeps(solver, curve)

    @pytest.mark.parametrize("name", ["equilibrium", "distinct"])
    def test_cohesion_is_no_violation(self, name):
        """Bonds carry more than friction does, by up to c A, which is several blocks' weights."""
        solver, curve = self.traced(with_joint(small_wall(), BONDED_JOINT), name)
        self.keeps(solver, curve)

    @pytest.mark.parametrize("name", [*ENGINES, "distinct"])
    def test_a_wrong_law_is_told(self, name, monkeypatch):
        """Reactions a thousandth too small everywhere: 1e-3 of a weight, above every limit."""
        real = certificate.joint_law_violation

        def with_less(table, gap, slip, reaction, *rest):
            return real(table, gap, slip, reaction * (1.0 - 1e-3), *rest)

        monkeypatch.setattr(certificate, "joint_law_violation", with_less)
        with pytest.raises(EngineError, match="at rest under its own weight, the step leaves"):
            pushover(stack((0.4, 0.3), (0.3, 0.6)), engine=name)


class TestCurves:
    @pytest.fixture(params=STRATEGIES)
    def strategy(self, request):
        return request.param

    def test_every_point_is_certified(self, engine, strategy):
        curve = short_curve(engine, strategy)
        assert curve.status == "finished", curve.reason
        assert curve.n_steps > 10
        # The project's own promise for every point of every curve.
        assert curve.residual.max() <= 1e-6
        assert curve.column("friction_violation").max() <= 1e-6
        # k_n = 1e8 Pa/m: a few blocks' weight on a corner's share of a joint closes it by less
        # than a tenth of a millimetre times the number of courses.
        assert 0.0 < curve.column("penetration").max() < 1e-3
        for name in COLUMNS:
            column = curve.column(name)
            if column.dtype.kind == "f":
                assert np.all(np.isfinite(column)), name
        assert curve.column("step").tolist() == list(range(len(curve.points)))
        first = curve.points[0]
        assert first.load_multiplier == first.applied_multiplier == 0.0
        assert curve.engine == engine and curve.strategy == strategy

    def test_the_same_run_twice(self, engine, strategy):
        assert digest(short_curve(engine, strategy)) == digest(short_curve(engine, strategy))

    def test_in_two_processes(self, engine, strategy):
        """Without a common hash seed, and without what this process has been through."""
        code = (
            "from test_conformance import digest, short_curve\n"
            f"print(digest(short_curve({engine!r}, {strategy!r})))"
        )
        path = os.pathsep.join([*map(str, (TESTS, TESTS / "engines")), *filter(None, sys.path)])
        seed = "1" if os.environ.get("PYTHONHASHSEED", "random") != "1" else "2"
        other = subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "PYTHONPATH": path, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        )
        assert other.stdout.strip() == digest(short_curve(engine, strategy))

    def test_poses_and_contacts_on_request(self, engine):
        model = small_wall()
        curve = pushover(
            model, engine=engine, strategy="displacement", max_steps=15,
            keep_poses=True, keep_contacts=True,
        )  # fmt: skip
        assert curve.poses.shape == (16, model.assembly.n_bodies, 3)
        point = model.control_point
        # Both are the same number of the engine's own frame, scaled by lengths before and after
        # sums of terms of the size of the poses: a few roundings of the largest.
        rounding = 8.0 * np.spacing(np.abs(curve.poses).max())
        for pose, moved, contacts in zip(
            curve.poses, curve.control_displacement, curve.contacts, strict=True
        ):
            shown = curve.settlement + moved  # poses are those from the designed places
            assert point.displacement(model.assembly, pose) == pytest.approx(shown, abs=rounding)
            assert np.all(pose[0] == 0.0)
            assert contacts.normal_reaction.min() >= 0.0
            # Of two rounded corners that press each other, see `ContactForces`.
            radii = 2.0 * model.assembly.corner.radius
            closer = radii / (radii + np.minimum(contacts.gap, 0.0))
            limit = 0.65 * contacts.normal_reaction * closer
            excess = np.abs(contacts.tangential_reaction[:, 0]) - limit
            assert excess.max() <= 1e-6 * model.assembly.heaviest_weight

    @pytest.mark.parametrize("corner", [Corner(), Corner(radius=0.02)], ids=["sharp", "rounded"])
    def test_pushed_the_other_way(self, engine, corner):
        """A mirrored model has the same peak; only roundings tell its steps apart."""
        peaks = []
        for sign in (1.0, -1.0):
            model = with_corner(
                stack((0.4, 0.3), (0.3, 0.6), direction=(sign, 0.0), joint=PUBLISHED_JOINT), corner
            )
            curve = pushover(model, engine=engine, strategy="displacement", max_displacement=0.02)
            peaks.append(curve.peak.load_multiplier)
        assert peaks[0] == pytest.approx(peaks[1], rel=1e-3)

    def test_a_vertical_part_of_the_load_is_not_taken_for_weight(self, engine):
        """The carried multiplier counts what the load pattern adds to the dead load alone."""
        law = JointLaw(friction_coefficient=0.65, normal_stiffness=1e8, shear_stiffness=1e11)
        model = stack((0.8, 0.4), joint=law, direction=(np.cos(0.2), -np.sin(0.2)))
        solver, state, report = started(model, engine)
        assert report.carried_multiplier == pytest.approx(0.0, abs=1e-3)
        for _ in range(5):
            state, report = solver.step(state, Demand(multiplier=0.1, time_step=0.1))
        assert report.carried_multiplier == pytest.approx(0.1, abs=1e-3)


def test_turned_and_moved_models_rest_alike(engine):
    """A stack on a plane tilted by nothing but the axes: gravity is what fixes them."""
    level = stack((1.0, 0.2))
    tilted = stack((1.0, 0.2), tilt=np.radians(10.0))
    _, a, _ = started(level, engine)
    _, b, _ = started(tilted, engine)
    # The plane's normal direction carries cos(10 degrees) of the weight.
    normal = turned(np.array([[0.0, 1.0]]), np.radians(10.0))[0]
    assert normal @ b.pose[1, :2] == pytest.approx(
        np.cos(np.radians(10.0)) * a.pose[1, 1], rel=1e-3
    )
