"""A whole static step judged by the equations and the joint law, written anew in plain numpy.

Of the library the reference takes which vertex meets which edge, no more: distances, slips,
reactions and forces are its own.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
import pytest

from builders import UNIT_WEIGHT, core_of, problem_of, rectangle, stack
from drystone.contact.contacts import VERTEX_B, VERTICES
from drystone.engines.base import Demand
from drystone.law.branches import BACKWARD, BONDED, FORWARD, OPEN, STICKING
from drystone.law.columns import BROKEN, DILATION, SHEAR, SLID
from drystone.model.assembly import Block, Corner
from drystone.model.builders import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model
from drystone.statics import solution
from drystone.statics.equations import Accuracy, PointDisplacement
from drystone.statics.equilibrium import EquilibriumEngine, EquilibriumState
from drystone.statics.plane import path
from drystone.statics.plane.piecewise import PathSettings
from drystone.statics.plane.plane_step import PlaneStep
from drystone.statics.solution import SolutionSettings, StepSolution, StepStart
from interpreted import fewer

pytestmark = pytest.mark.kernels

TIME_STEP = 30.0  # s


class Recorded(PlaneStep):
    """Notes how each part of the path ended."""

    def __init__(self, *args):
        super().__init__(*args)
        self.ends = []

    def walk(self, *args, **kwargs):
        result = super().walk(*args, **kwargs)
        self.ends.append(result[0])
        return result


@dataclass
class Taken:
    """A step that was tried from a state."""

    model: Model
    state: EquilibriumState
    increment: float  # m
    guess: np.ndarray
    step: Recorded
    solved: StepSolution
    tolerance: float

    @property
    def reaction(self):
        """By slot, (n_slots, 2) [N]."""
        return self.step.by_slot(self.step.reaction)[:, :2]

    @property
    def branch(self):
        """By slot, (n_slots,)."""
        return self.step.by_slot(self.step.branch)

    @property
    def history(self):
        """By slot, where the step ends."""
        return self.step.finish()


def begun(model):
    """An engine, and the state in which it holds the model under its own weight."""
    engine = EquilibriumEngine()
    state, _ = engine.start(problem_of(model))
    return engine, state


def take(engine, state, increment, *, guess=None, whole=True, **options):
    """One step by a displacement increment [m]; without a guess with the gradients at its start."""
    model, assembly = state.prepared.problem, state.prepared.assembly
    state = engine._refresh(state)
    guess = np.zeros_like(state.pose) if guess is None else guess
    tolerance = 1e-9 * assembly.heaviest_weight
    control = model.control_point
    angle = state.pose[control.block, 2]
    c, s = np.cos(angle), np.sin(angle)
    prescribed = PointDisplacement(
        body=control.block,
        arm=np.array([[c, -s], [s, c]]) @ (control.point - assembly.centroid[control.block]),
        axis=control.direction,
        axes=assembly.axes[control.block],
        increment=increment,
    )
    step = Recorded(engine.equations_of(state).loaded, state.pairs)
    step.begin(
        state.pose, state.slots, state.history, state.branch, TIME_STEP, prescribed, guess
    )  # fmt: skip
    step.accuracy = Accuracy(
        tolerance=tolerance,
        rounding=0.0,
        sliding_rounding=0.0,
        coarsest=tolerance,
        depth=1e-12,
        pressed=0.0,
        farthest=0.3 * state.prepared.detector.reach,
    )
    solved = solution.solve(
        step,
        StepStart(guesses=[guess], multiplier=state.multiplier, reaction=state.reaction),
        SolutionSettings(path=PathSettings(**options)),
        beyond=whole,
    )
    return Taken(model, state, increment, guess, step, solved, tolerance)


def contact(assembly, pose, a, b, kind, feature):
    """Gap [m] of a contact, and by how much each motion of a and b changes gap and slip (2, 6).

    Slip is what the surface of b passes over that of a, to the right of the normal from a to b.
    """
    core_a, core_b = (core_of(assembly, i, pose) for i in (a, b))
    first_a, first_b = (
        int(f - assembly.shapes.offset[i]) for f, i in zip(feature, (a, b), strict=True)
    )
    radius_a, radius_b = assembly.shapes.radius[a], assembly.shapes.radius[b]
    centre_a, centre_b = (assembly.centroid[i] + pose[i, :2] for i in (a, b))
    if kind == VERTICES:
        apart = core_b[first_b] - core_a[first_a]
        distance = np.hypot(*apart)
        normal, gap = apart / distance, distance - radius_a - radius_b
        on_a, on_b = core_a[first_a] + radius_a * normal, core_b[first_b] - radius_b * normal
    else:
        owner, first = (core_a, first_a) if kind == VERTEX_B else (core_b, first_b)
        edge = np.roll(owner, -1, axis=0)[first] - owner[first]
        outward = np.array([edge[1], -edge[0]]) / np.hypot(*edge)
        vertex = core_b[first_b] if kind == VERTEX_B else core_a[first_a]
        gap = outward @ (vertex - owner[first]) - radius_a - radius_b
        normal = outward if kind == VERTEX_B else -outward
        rolling = -radius_b if kind == VERTEX_B else radius_a
        on_a = on_b = vertex + rolling * normal

    def relative(direction, at_a, at_b):
        """Motion of a point of b less that of a point of a, along a direction."""
        arm_a, arm_b = at_a - centre_a, at_b - centre_b
        turn_a = arm_a[0] * direction[1] - arm_a[1] * direction[0]
        turn_b = arm_b[0] * direction[1] - arm_b[1] * direction[0]
        return np.array([*-direction, -turn_a, *direction, turn_b])

    tangent = np.array([normal[1], -normal[0]])
    slip = relative(tangent, on_a, on_b)
    if kind == VERTICES:
        # The line of centres, as long as it is, turns by the motion of the centres across it.
        across = relative(tangent, core_a[first_a], core_b[first_b])
        slip += ((radius_a + radius_b) / distance - 1.0) * across
    return gap, np.array([relative(normal, on_a, on_b), slip])


def reference(taken):
    """What the law makes of the motion: forces (n, 3), and by slot reactions, history, sliding.

    The sliding is what friction must oppose: slip that the shear spring has not taken.
    """
    assembly, state, step = taken.model.assembly, taken.state, taken.step
    x = taken.solved.increment
    n = len(step.known.kind)
    force = np.zeros_like(x)
    reaction, history, sliding = np.zeros((n, 2)), step.history_before.copy(), np.zeros(n)
    for k in np.flatnonzero(step.known.kind):
        pair = state.pairs.of_slot[k]
        ends = [int(state.pairs.a[pair]), int(state.pairs.b[pair])]
        law = assembly.laws[state.pairs.law_of_slot[k]]
        area = state.slots.size[k] * assembly.thickness
        kn, ks = law.normal_stiffness * area, law.shear_stiffness * area
        features = int(step.known.kind[k]), step.known.feature[k]
        _, (_, by_slip) = contact(assembly, state.pose + 0.5 * taken.guess, *ends, *features)
        gap, directions = contact(assembly, state.pose + x, *ends, *features)
        slip = by_slip @ x[ends].ravel()
        dilation, slid, broken, _, _, shear = history[k]
        normal, tangential = kn * (dilation - gap), shear - ks * slip
        limit = law.friction_coefficient * normal
        bonded = law.cohesion + law.tensile_strength > 0.0 and not broken
        if not bonded:  # within a step a bond holds whatever it carries
            dilates = slid < law.dilatancy_end and state.branch[k] != OPEN
            lift = np.tan(np.radians(law.dilatancy_angle)) * dilates
            if normal + kn / ks * lift * abs(tangential) <= 0.0:  # what it slides does not close it
                normal = tangential = 0.0
            elif abs(tangential) > limit:
                more = (abs(tangential) - limit) / (ks + law.friction_coefficient * kn * lift)
                normal += kn * lift * more
                dilation, slid = dilation + lift * more, slid + more
                tangential = np.sign(tangential) * law.friction_coefficient * normal
        sliding[k] = slip - (shear - tangential) / ks
        reaction[k] = normal, tangential
        history[k] = dilation, slid, broken, 0.0, 0.0, tangential
        for end, body in enumerate(ends):
            force[body] += reaction[k] @ directions[:, 3 * end : 3 * end + 3]
    return force, reaction, history, sliding


def check(taken, *, whole):
    """All that a step promises; returns how many of its contacts stick, slide and so on."""
    state, step, solved = taken.state, taken.step, taken.solved
    assembly, control, x = taken.model.assembly, taken.model.control_point, solved.increment
    assert solved.reason == ""
    force, reaction, history, sliding = reference(taken)
    touching = np.flatnonzero(step.known.kind)
    laws = [assembly.laws[i] for i in state.pairs.law_of_slot]
    accuracy = 0.1 * taken.tolerance
    assert taken.reaction == pytest.approx(reaction, abs=accuracy)
    shear, rest = SHEAR, slice(SHEAR)
    assert taken.history[touching, shear] == pytest.approx(history[touching, shear], abs=accuracy)
    assert taken.history[touching, rest] == pytest.approx(history[touching, rest], abs=1e-14)

    # Equilibrium, with the inertia of so long a step, and the increment that was asked for.
    down = np.column_stack((0.0 * assembly.weight, -assembly.weight, 0.0 * assembly.weight))
    load = solved.multiplier * assembly.weight[:, None] * (*taken.model.load.direction, 0.0)
    unbalanced = force + down + load - assembly.mass * x / TIME_STEP**2
    unbalanced[assembly.fixed] = 0.0
    largest = max(np.hypot(*core_of(assembly, i, 0.0 * x).T).max() for i in range(len(x)))
    assert np.abs(unbalanced[:, :2]).max() <= 2.0 * taken.tolerance
    assert np.abs(unbalanced[:, 2]).max() <= 2.0 * taken.tolerance * largest
    assert not x[assembly.fixed].any()
    before, after = (control.displacement(assembly, p) for p in (state.pose, state.pose + x))
    assert after - before == pytest.approx(taken.increment, abs=1e-11)

    # The law as inequalities: no tension, the cone, and friction that opposes what has slid.
    normal, tangential = reaction.T
    friction = np.array([law.friction_coefficient for law in laws])
    stiffness = np.array([law.shear_stiffness for law in laws]) * state.slots.size
    bonded = taken.branch == BONDED
    loose = ~bonded
    assert normal[loose].min(initial=0.0) >= 0.0
    assert (np.abs(tangential) - friction * normal)[loose].max(initial=0.0) <= accuracy
    on_cone = np.abs(tangential) > (1.0 - 1e-9) * friction * normal
    slides = loose & (normal > 0.0) & (np.abs(sliding) * stiffness > accuracy)
    assert np.all(on_cone[slides])
    assert np.all(sliding[slides] * tangential[slides] <= 0.0)
    assert np.all(np.abs(sliding * stiffness)[bonded] <= accuracy)

    # What contacts bring along: the implicit law changes nothing.  On a path, sliding that has
    # ended is added; it goes back by what the gradients change over the step, no more.
    brought, now = state.history[touching], step.history_before[touching]
    assert np.all(now[:, BROKEN] >= brought[:, BROKEN])
    if whole:
        others = [SHEAR, DILATION, SLID]
        assert np.array_equal(now[:, others], brought[:, others])
    slid = now[:, SLID] - brought[:, SLID]
    motion = np.abs(x[:, :2]).max()
    back = 2.0 * path.SLOW * motion + motion**2 / assembly.smallest_extent
    assert slid.min(initial=0.0) >= -back
    angle = np.array([law.dilatancy_angle for law in laws])[touching]
    ended = [law.dilatancy_end for law in laws] <= state.history[:, SLID]
    lift = np.where(ended[touching], 0.0, np.tan(np.radians(angle)))
    raised = now[:, DILATION] - brought[:, DILATION]
    assert raised == pytest.approx(lift * slid, abs=1e-14)
    return Counter(taken.branch[touching].tolist())


FRICTIONS = (0.2, 0.5, 0.8, 1.5)


def random_model(seed, n=None, **law):
    """Two to six blocks of unequal sizes in a stack or in courses, some with rounded corners."""
    random = np.random.default_rng(seed)
    n = n or int(random.integers(2, 7))
    blocks = [
        Block(
            id="base",
            vertices=rectangle(-4.0, -0.5, 8.0, 0.5),
            unit_weight=UNIT_WEIGHT,
            support=True,
        )
    ]
    per_course = int(random.integers(1, 3)) if n < 8 else int(np.sqrt(n))
    width, height = random.uniform(0.3, 0.6), random.uniform(0.15, 0.4)
    for i in range(n):
        row, column = divmod(i, per_course)
        own = width * (1.0 if per_course > 1 else random.uniform(0.8, 1.2))
        x = random.uniform(-0.02, 0.02) if per_course == 1 else (column + 0.4 * (row % 2)) * width
        outline = rectangle(x - 0.5 * own, row * height, own - 0.02 * random.random(), height)
        weight = UNIT_WEIGHT * 10.0 ** random.uniform(-0.5, 0.5)
        blocks.append(Block(id=f"b{i}", vertices=outline, unit_weight=weight))
    stiffness = 10.0 ** random.uniform(7.0, 9.0)
    return make_model(
        blocks,
        joint=JointLaw(
            friction_coefficient=random.choice(FRICTIONS),
            normal_stiffness=stiffness,
            shear_stiffness=stiffness * 10.0 ** random.uniform(-0.5, 3.0),
            **law,
        ),
        corner=Corner(radius=random.choice((None, 0.01))),
        thickness=1.0,
        load_direction=(random.choice((-1.0, 1.0)), random.uniform(-0.2, 0.2)),
    )


LAWS = {
    "dry": {},
    "dilatant": {"dilatancy_angle": 8.0},
    "exhausted": {"dilatancy_angle": 8.0, "dilatancy_end": 1e-5},
    "bonded": {"cohesion": 5e3, "tensile_strength": 2e3},
    "glued": {"cohesion": 2e4, "tensile_strength": 1e4, "dilatancy_angle": 5.0},
}


def states_of(model, seed, n=4):
    """States before, about and past the peak, with increments [m] and guesses to go on by."""
    random = np.random.default_rng(1000 + seed)
    engine, state = begun(model)
    size, last = model.assembly.smallest_extent, np.inf
    for _ in range(n):
        increment = size * 10.0 ** random.uniform(-4.5, -1.5)
        share = random.choice((0.0, random.uniform(0.5, 1.5))) * increment / last
        yield engine, state, increment, share * state.last_increment
        for _ in range(2):
            last = size * 10.0 ** random.uniform(-4.0, -1.7)
            state, _ = engine.step(state, Demand(increment=last, over_fold=True))


def same_contacts(taken):
    """Whether the contacts that a step began with are those that it ended with."""
    return np.array_equal(taken.step.known.feature, taken.state.slots.feature)


#: Random structures of each law.
SEEDS = fewer(12, 4)


class TestRandomAssemblies:
    @pytest.mark.parametrize("whole", [True, False], ids=["implicit law", "path"])
    @pytest.mark.parametrize("law", LAWS)
    def test_a_step_is_in_equilibrium_by_the_law(self, law, whole):
        seen, solved, tried, bent = Counter(), 0, 0, 0
        for seed in range(SEEDS):
            model = random_model(seed, **LAWS[law])
            for engine, state, increment, guess in states_of(model, seed):
                taken = take(engine, state, increment, guess=guess, whole=whole)
                tried += 1
                if taken.solved.reason == "":
                    solved += 1
                    bent += taken.solved.bend is not None and taken.solved.bend[0] > 0.0
                    if same_contacts(taken):
                        seen += check(taken, whole=whole)
        # The others meet a place where the path turns back.
        assert solved >= 0.6 * tried
        # Where all is glued no contact changes: bonds hold while a step is solved.
        few, many = 0 if law == "glued" else SEEDS // 4, 100 * SEEDS // 12
        assert bent >= few
        assert seen[OPEN] >= many
        assert seen[FORWARD] + seen[BACKWARD] >= few
        assert seen[BONDED if "cohesion" in LAWS[law] else STICKING] >= many

    @pytest.mark.compiled
    @pytest.mark.parametrize("whole", [True, False], ids=["implicit law", "path"])
    def test_so_is_one_in_which_many_contacts_change_together(self, whole):
        together = 0
        for seed in range(6):
            model = random_model(seed, n=36)
            for engine, state, increment, guess in states_of(model, seed, n=3):
                taken = take(engine, state, increment, guess=guess, whole=whole, changes=0.0)
                if taken.solved.reason == "" and same_contacts(taken):
                    check(taken, whole=whole)
                    together += path.EXHAUSTED in taken.step.ends
        assert together >= 3

    def test_an_equilibrium_is_found_short_of_where_the_path_turns_back(self):
        turned = 0
        for seed in range(SEEDS):
            for engine, state, increment, _ in states_of(random_model(seed), seed):
                solved = take(engine, state, increment, whole=False).solved
                for _ in range(3):  # where gradients change over the step, so does the place
                    if solved.fold is not None:
                        increment *= 1.1 * solved.fold[0]
                        solved = take(engine, state, increment, whole=False).solved
                if solved.fold is None:
                    continue
                turned += 1
                share, multiplier, _ = solved.fold
                for part in (0.5, 0.99, 1.01):
                    there = take(engine, state, part * share * increment, whole=False).solved
                    if part < 1.0:
                        assert (there.reason, there.fold) == ("", None)
                        missing = (multiplier - there.multiplier) / (multiplier - state.multiplier)
                        assert 0.5 * (1.0 - part) < missing < 1.1 * (1.0 - part)
                    else:
                        assert there.fold[:2] == pytest.approx((1.0 / part, multiplier), rel=1e-3)
        assert turned >= 5 * SEEDS // 12


def solve_for(function, value, low, high):
    """Where a function that grows has a value, by a table of intervals of 1e-5 of the whole."""
    x = np.linspace(low, high, 100_001)
    return float(np.interp(value, function(x), x))


class TestPeakWithinAStep:
    """A block turns about its toe once its heel has come off: the multiplier falls from there on.

    Of width B, height H and weight W, it stands on springs of k_n B/2 and k_s B/2 at either end.
    With what the heel pulls P the toe closes by (W + P) / k and the heel opens by P / k, which
    together are B sin(theta); moments about the toe give the multiplier, and the upper corner moves
    with the rotation and with the shear of the ends that carry it.
    """

    width, height, normal, shear, friction = 0.4, 1.0, 1.25e7, 1.25e8, 2.0

    @property
    def weight(self):
        return UNIT_WEIGHT * self.width * self.height

    def multiplier(self, theta, pull=0.0):
        c, s, b, h = np.cos(theta), np.sin(theta), self.width / 2, self.height / 2
        return (b * c - h * s + 2.0 * b * c * pull / self.weight) / (b * s + h * c)

    def displacement(self, theta, pull=0.0, ends=1):
        slip = self.multiplier(theta, pull) * self.weight / (ends * self.shear * self.width / 2)
        return self.height * np.sin(theta) + slip

    def rotation(self, pull):
        """At which the heel pulls so much."""
        stiffness = self.normal * self.width / 2
        return float(np.arcsin((self.weight + 2.0 * pull) / (stiffness * self.width)))

    def before_the_peak(self, pull=0.0, ends=1, **law):
        """Engine and state at 0.9 times the displacement at the peak, and that displacement."""
        joints = JointLaw(
            friction_coefficient=self.friction,
            normal_stiffness=self.normal,
            shear_stiffness=self.shear,
            **law,
        )
        engine, state = begun(stack((self.width, self.height), joint=joints))
        at_peak = self.displacement(self.rotation(pull), pull, ends)
        for _ in range(18):
            state, report = engine.step(state, Demand(increment=0.05 * at_peak))
            assert report.converged and report.reached == 1.0
        return engine, state, at_peak

    def test_where_the_heel_comes_off(self):
        """A step from 0.9 to 1.3 times the displacement at the peak, and what it should find."""
        engine, state, at_peak = self.before_the_peak()
        theta = self.rotation(0.0)
        peak = self.multiplier(theta)
        rest = solve_for(self.displacement, 1.3 * at_peak, theta, 3.0 * theta)
        taken = take(engine, state, 0.4 * at_peak, whole=False)
        check(taken, whole=False)
        assert taken.solved.fold is None
        end = self.multiplier(rest)
        assert taken.solved.multiplier == pytest.approx(end, rel=1e-4)
        excess, share = taken.solved.excess
        assert share == pytest.approx(0.25, rel=0.03)
        assert excess == pytest.approx(peak - max(end, state.multiplier), rel=0.1)
        bend, share = taken.solved.bend
        assert share == pytest.approx(0.25, rel=0.03)
        chord = state.multiplier + 0.25 * (end - state.multiplier)
        assert bend == pytest.approx(peak - chord, rel=0.1)

    def test_where_the_bond_of_the_heel_breaks(self):
        """The step ends there; the next goes no further, and the multiplier drops at once."""
        strength = 2e3
        pull = strength * self.width / 2
        engine, state, at_peak = self.before_the_peak(
            pull, 2, tensile_strength=strength, cohesion=1e5
        )
        demand = Demand(increment=0.4 * at_peak)
        tip, report = engine.step(state, demand)
        assert report.reached == pytest.approx(0.25, rel=0.03)
        # The lifted heel has half of the shear, B sin(theta) = 1.9 mm above the toe, whose moment
        # the formula leaves out: 2e-3 of that of the load at H/2.
        assert report.static_multiplier == pytest.approx(
            self.multiplier(self.rotation(pull), pull), rel=3e-3
        )
        assert sorted(tip.branch) == [BONDED, BONDED] and len(tip.due) == 1
        broken, report = engine.step(tip, demand)
        assert report.reached == 0.0
        assert report.control_displacement == pytest.approx(at_peak, rel=1e-3)
        theta = solve_for(self.displacement, at_peak, 0.0, 3.0 * self.rotation(pull))
        assert report.static_multiplier == pytest.approx(self.multiplier(theta), rel=1e-3)
        assert sorted(broken.branch) == [OPEN, BONDED]

    def test_none_before_it(self):
        joints = JointLaw(
            friction_coefficient=self.friction,
            normal_stiffness=self.normal,
            shear_stiffness=self.shear,
        )
        engine, state = begun(stack((self.width, self.height), joint=joints))
        increment = 0.3 * self.displacement(self.rotation(0.0))
        solved = take(engine, state, increment, whole=False).solved
        assert solved.excess == solved.bend == (0.0, 0.0)


class TestSnap:
    """A slender block rocks on a wide one, which stands on a base that is soft in shear.

    The wide block is where the displacement is read.  Its joint slips by the sum of the load over
    its stiffness: once the slender block's multiplier falls, the displacement goes back.
    """

    soft, lower, upper, width, height = 1e6, 0.3, 0.16, 0.2, 0.8
    #: Of the slender block when it starts to rock, its joint being hard.
    peak = width / height

    def at_rest(self, stop=None):
        hard = JointLaw(friction_coefficient=2.0, normal_stiffness=1e10, shear_stiffness=1e10)
        outlines = {
            "base": rectangle(-1.0, -0.5, 2.0, 0.5),
            "wide": rectangle(-0.5, 0.0, 1.0, 0.3),
            "slender": rectangle(-0.1, 0.3, self.width, self.height),
        }
        if stop is not None:
            outlines["stop"] = rectangle(0.1 + stop, 0.8, 0.5, 0.2)
        model = make_model(
            [
                Block(
                    id=name, vertices=v, unit_weight=UNIT_WEIGHT, support=name in ("base", "stop")
                )
                for name, v in outlines.items()
            ],
            joint=hard,
            joint_between={frozenset(("base", "wide")): replace(hard, shear_stiffness=self.soft)},
            thickness=1.0,
            load_direction=(1.0, 0.0),
            control_block="wide",
            control_point="centre",
        )
        return begun(model)

    @property
    def farthest(self):
        """Displacement at the peak [m]."""
        return self.peak * UNIT_WEIGHT * (self.lower + self.upper) / self.soft

    def test_the_path_turns_back_at_the_peak(self):
        engine, state = self.at_rest()
        for size in (1.01, 1.5, 4.0):
            solved = take(engine, state, size * self.farthest, whole=False).solved
            assert solved.reason == "the path of equilibria turns back"
            assert solved.fold[:2] == pytest.approx((1.0 / size, self.peak), rel=1e-3)
            assert np.isnan(solved.fold.drop)
            # The implicit law knows of no turn: only that nothing is there.
            solved = take(engine, state, size * self.farthest, whole=True).solved
            assert (solved.reason, solved.fold) == ("the path of equilibria turns back", None)
        taken = take(engine, state, 0.99 * self.farthest, whole=False)
        check(taken, whole=False)
        assert taken.solved.fold is None
        assert taken.solved.multiplier == pytest.approx(0.99 * self.peak, rel=1e-3)

    @pytest.mark.parametrize("whole", [True, False], ids=["implicit law", "path"])
    def test_beyond_it_the_equilibrium_against_a_stop_is_found(self, whole):
        """The slender block leans on a stop: from there on the multiplier rises again."""
        engine, state = self.at_rest(stop=0.002)
        displacement = 1.5 * self.farthest
        taken = take(engine, state, displacement, whole=whole)
        check(taken, whole=whole)
        # Moments about the toe, 0.7 m below the stop's edge: l W h/2 = W b/2 + 0.7 S; and what the
        # base feels is the load without the stop's force S.
        weight = UNIT_WEIGHT * self.upper
        equations = np.array(
            [
                [weight * self.height / 2, -0.7],
                [UNIT_WEIGHT * (self.lower + self.upper), -1.0],
            ]
        )
        right = np.array([weight * self.width / 2, self.soft * displacement])
        multiplier, _ = np.linalg.solve(equations, right)
        assert taken.solved.multiplier == pytest.approx(multiplier, rel=1e-3)
        if whole:
            assert taken.solved.fold is None
        else:
            assert taken.solved.fold[:2] == pytest.approx((1.0 / 1.5, self.peak), rel=1e-3)
            # At the displacement of the fold it has turned by what was left of the gap, over 0.7 m.
            # Its weight has moved towards the toe, to first order.  The stop carries that, and as
            # the base feels no more, the load has grown by what the stop takes.
            turned = (0.002 - self.farthest) / 0.7
            more, _ = np.linalg.solve(equations, [-weight * turned * self.height / 2, 0.0])
            assert more > 0.0
            assert taken.solved.fold.drop == pytest.approx(-more, rel=0.02)


class TestSliding:
    law = JointLaw(
        friction_coefficient=0.5,
        normal_stiffness=1e9,
        shear_stiffness=1e9,
        dilatancy_angle=10.0,
        dilatancy_end=4e-3,
    )

    @pytest.mark.parametrize("whole", [True, False], ids=["implicit law", "path"])
    def test_friction_opposes_it_both_ways(self, whole):
        law = replace(self.law, dilatancy_angle=0.0)
        engine, state = begun(stack((1.0, 0.2), joint=law))
        state, _ = engine.step(state, Demand(increment=1e-3))
        for increment, branch, sense in (
            (1e-3, BACKWARD, 1.0),
            (-1e-3, FORWARD, -1.0),
        ):
            taken = take(engine, state, increment, whole=whole)
            check(taken, whole=whole)
            assert taken.solved.multiplier == pytest.approx(sense * 0.5, rel=1e-5)
            assert taken.branch.tolist() == [branch, branch]
            slid = taken.history[:, SLID] - taken.state.history[:, SLID]
            # Turning round, the springs first give back what they had taken.
            elastic = 2e3 * 0.5 / 1e9 * (1.0 - sense)
            assert slid == pytest.approx(1e-3 - elastic, abs=3e-7)  # and the block its tilt

    @pytest.mark.parametrize("whole", [True, False], ids=["implicit law", "path"])
    def test_a_dilatant_joint_opens_by_what_it_slides(self, whole):
        engine, state = begun(stack((1.0, 0.2), joint=self.law))
        rest = state.pose[1, 1]
        for n in range(1, 7):
            taken = take(engine, state, 1e-3, whole=whole)
            check(taken, whole=whole)
            assert taken.solved.multiplier == pytest.approx(0.5, rel=1e-5)
            # Until the slid distance has reached 4 mm where a step begins; the engine, which leads
            # from each to the next, cuts the fifth short.
            rise = np.tan(np.radians(10.0)) * (n if n <= 5 else 4) * 1e-3
            risen = (state.pose + taken.solved.increment)[1, 1] - rest
            assert risen == pytest.approx(rise, abs=2e-6)
            state, report = engine.step(state, Demand(increment=1e-3))
            assert report.converged
