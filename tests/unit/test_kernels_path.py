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
from drystone.assembly import Block, Corner, JointLaw
from drystone.builders import make_model
from drystone.engines.base import Demand
from drystone.engines.equilibrium import EquilibriumEngine, EquilibriumState
from drystone.kernels import joint, path
from drystone.kernels.narrow import VERTEX_B, VERTICES
from drystone.model import Model
from drystone.solvers import piecewise
from drystone.solvers.piecewise import PathSettings, StepSolution
from drystone.solvers.static_step import PointPace, StaticStep

TIME_STEP = 30.0  # s


class Recorded(StaticStep):
    """Notes how each part of the path ended."""

    def begin(self, *args, **kwargs):
        self.ends = []
        super().begin(*args, **kwargs)

    def advance(self, *args, **kwargs):
        result = super().advance(*args, **kwargs)
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


def settled(model):
    """An engine, and the state in which it holds the model under its own weight."""
    engine = EquilibriumEngine()
    state, _ = engine.start(problem_of(model))
    return engine, state


def take(engine, state, increment, *, guess=None, whole=True, **options):
    """One step by a displacement increment [m]; without a guess with the gradients at its start."""
    model, assembly = engine.problem, engine.problem.assembly
    state = engine._refresh(state)
    guess = np.zeros_like(state.pose) if guess is None else guess
    tolerance = 1e-9 * assembly.heaviest_weight
    control = model.control_point
    angle = state.pose[control.block, 2]
    c, s = np.cos(angle), np.sin(angle)
    pace = PointPace(
        body=control.block,
        arm=np.array([[c, -s], [s, c]]) @ (control.point - assembly.centroid[control.block]),
        axis=control.direction,
        increment=increment,
    )
    step = Recorded(engine.constants, state.pairs)
    step.begin(state.pose, state.slots, state.history, TIME_STEP, guess)
    settings = PathSettings(
        tolerance=tolerance, depth=1e-12, farthest=0.3 * engine.detector.reach, **options
    )
    solved = piecewise.solve(
        step, pace, guess, state.multiplier, state.branch, state.reaction, settings, whole=whole
    )
    return Taken(model, state, increment, guess, step, solved, tolerance)


def contact(assembly, pose, a, b, kind, feature):
    """Gap [m] of a contact, and by how much each motion of a and b changes gap and slip (2, 6).

    Slip is what the surface of b passes over that of a, to the right of the normal from a to b.
    """
    core_a, core_b = (core_of(assembly, i, pose) for i in (a, b))
    first_a, first_b = (int(f - assembly.shapes.offset[i]) for f, i in zip(feature, (a, b)))
    radius_a, radius_b = assembly.shapes.radius[a], assembly.shapes.radius[b]
    centre_a, centre_b = (assembly.centroid[i] + pose[i, :2] for i in (a, b))
    share = 1.0
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
    reaction, history, sliding = np.zeros((n, 2)), step.memory.copy(), np.zeros(n)
    for k in np.flatnonzero(step.known.kind):
        pair = k // 2
        ends = [int(state.pairs.a[pair]), int(state.pairs.b[pair])]
        law = assembly.laws[state.pairs.law[pair]]
        area = state.slots.length[k] * assembly.thickness
        kn, ks = law.normal_stiffness * area, law.shear_stiffness * area
        features = int(step.known.kind[k]), step.known.feature[k]
        _, (_, by_slip) = contact(assembly, state.pose + 0.5 * taken.guess, *ends, *features)
        gap, directions = contact(assembly, state.pose + x, *ends, *features)
        slip = by_slip @ x[ends].ravel()
        shear, dilation, slid, broken = history[k]
        normal, tangential = kn * (dilation - gap), shear - ks * slip
        limit = law.friction_coefficient * normal
        bonded = law.cohesion + law.tensile_strength > 0.0 and not broken
        holds = abs(tangential) <= limit + law.cohesion * area
        if not (bonded and holds and normal >= -law.tensile_strength * area):
            broken = 1.0 if bonded else broken
            if normal <= 0.0:
                normal = tangential = 0.0
            elif abs(tangential) > limit:
                lift = np.tan(np.radians(law.dilatancy_angle)) * (slid < law.dilatancy_end)
                more = (abs(tangential) - limit) / (ks + law.friction_coefficient * kn * lift)
                normal += kn * lift * more
                dilation, slid = dilation + lift * more, slid + more
                tangential = np.sign(tangential) * law.friction_coefficient * normal
        sliding[k] = slip - (shear - tangential) / ks
        reaction[k] = normal, tangential
        history[k] = tangential, dilation, slid, broken
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
    laws = [assembly.laws[i] for i in state.pairs.law.repeat(2)]
    accuracy = 0.1 * taken.tolerance
    assert step.reaction == pytest.approx(reaction, abs=accuracy)
    assert step.state[touching, 0] == pytest.approx(history[touching, 0], abs=accuracy)
    assert step.state[touching, 1:] == pytest.approx(history[touching, 1:], abs=1e-14)

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
    stiffness = np.array([law.shear_stiffness for law in laws]) * state.slots.length
    bonded = step.branch == joint.BONDED
    loose = ~bonded
    assert normal[loose].min(initial=0.0) >= 0.0
    assert (np.abs(tangential) - friction * normal)[loose].max(initial=0.0) <= accuracy
    on_cone = np.abs(tangential) > (1.0 - 1e-9) * friction * normal
    slides = loose & (normal > 0.0) & (np.abs(sliding) * stiffness > accuracy)
    assert np.all(on_cone[slides])
    assert np.all(sliding[slides] * tangential[slides] <= 0.0)
    assert not (sliding[bonded] * stiffness[bonded] > accuracy).any()

    # What contacts bring along: nothing is changed by the implicit law; on a path, sliding that
    # has ended is added, and shear only falls by it.
    brought, now = state.history[touching], step.memory[touching]
    assert np.all(now[:, joint.BROKEN] >= brought[:, joint.BROKEN])
    if whole:
        assert np.array_equal(now[:, : joint.BROKEN], brought[:, : joint.BROKEN])
    slid = now[:, joint.SLID] - brought[:, joint.SLID]
    assert slid.min(initial=0.0) >= -2.0 * path.SLOW * np.abs(x[:, :2]).max() - 1e-14
    lift = np.array([np.tan(np.radians(law.dilatancy_angle)) for law in laws])[touching]
    raised = now[:, joint.DILATION] - brought[:, joint.DILATION]
    assert raised == pytest.approx(lift * slid, abs=1e-14)
    return Counter(step.branch[touching].tolist())


FRICTIONS = (0.2, 0.5, 0.8, 1.5)


def random_model(seed, n=None, **law):
    """Two to six blocks of unequal sizes in a stack or in courses, some with rounded corners."""
    random = np.random.default_rng(seed)
    n = n or int(random.integers(2, 7))
    blocks = [
        Block(
            id="base", vertices=rectangle(-4.0, -0.5, 8.0, 0.5), unit_weight=UNIT_WEIGHT, support=True
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
    engine, state = settled(model)
    size = model.assembly.smallest_extent
    for _ in range(n):
        guess = None if random.random() < 0.5 else state.last_increment * random.uniform(0.5, 1.5)
        yield engine, state, size * 10.0 ** random.uniform(-4.5, -1.5), guess
        for _ in range(2):
            demand = Demand(increment=size * 10.0 ** random.uniform(-4.0, -1.7), over_fold=True)
            state, _ = engine.step(state, demand)


def same_contacts(taken):
    """Whether the contacts that a step began with are those that it ended with."""
    return np.array_equal(taken.step.known.feature, taken.state.slots.feature)


class TestRandomAssemblies:
    @pytest.mark.parametrize("whole", [True, False], ids=["implicit law", "path"])
    @pytest.mark.parametrize("law", LAWS)
    def test_a_step_is_in_equilibrium_by_the_law(self, law, whole):
        seen, solved, tried, bent = Counter(), 0, 0, 0
        for seed in range(16):
            model = random_model(seed, **LAWS[law])
            for engine, state, increment, guess in states_of(model, seed):
                taken = take(engine, state, increment, guess=guess, whole=whole)
                tried += 1
                if taken.solved.reason:
                    continue
                solved += 1
                if same_contacts(taken):
                    seen += check(taken, whole=whole)
                    bent += taken.solved.bend[0] > 0.0
        print(law, whole, solved, tried, bent, dict(seen))

    def test_no_equilibrium_is_found_beyond_where_the_path_turns_back(self):
        """Just short of there it is, at the multiplier that was said."""
        turned = 0
        for seed in range(16):
            for engine, state, increment, _ in states_of(random_model(seed), seed):
                solved = take(engine, state, increment, whole=False).solved
                if not solved.reason or solved.turn is None:
                    continue
                turned += 1
                share, multiplier = solved.turn
                rise = multiplier - state.multiplier
                for part in (0.5, 0.99, 1.01):
                    there = take(engine, state, part * share * increment, whole=False).solved
                    assert (there.reason == "") == (part < 1.0)
                    if part == 0.99:
                        assert there.turn is None
                        missing = multiplier - there.multiplier
                        assert 0.0 < missing < 0.1 * rise, (missing, rise)
        print("turned", turned)

    def test_excess_and_bend_are_found_by_stepping_to_them(self):
        n = 0
        for seed in range(16):
            for engine, state, increment, _ in states_of(random_model(seed), seed):
                first = take(engine, state, increment, whole=False).solved
                if first.reason or first.turn:
                    continue
                solved = take(engine, state, increment, guess=first.increment, whole=False).solved
                for (size, share), shape in ((solved.excess, "excess"), (solved.bend, "bend")):
                    if size < 1e-3: continue
                    there = take(
                        engine, state, share * increment, guess=share * first.increment, whole=False
                    ).solved
                    ends = state.multiplier, solved.multiplier
                    if shape == "excess":
                        found = there.multiplier - max(ends)
                    else:
                        found = abs(there.multiplier - ends[0] - share * (ends[1] - ends[0]))
                    print(shape, seed, "%.1e"%increment, share, size, found, there.reason)
                    n += 1
        print(n)

    @pytest.mark.parametrize("whole", [True, False], ids=["implicit law", "path"])
    def test_so_does_one_in_which_many_contacts_change_together(self, whole):
        leaps = solved = 0
        for seed in range(6):
            model = random_model(seed, n=36)
            for engine, state, increment, guess in states_of(model, seed, n=3):
                taken = take(engine, state, increment, guess=guess, whole=whole, together_effort=0)
                if taken.solved.reason: print(taken.solved.reason)
                if taken.solved.reason == "" and same_contacts(taken):
                    check(taken, whole=whole)
                    solved += 1
                    leaps += path.TOGETHER in taken.step.ends
        print(whole, solved, leaps)


def block_on(base_law, *, width, height, **options):
    """A block upon a base, pushed to the right, with its weight [N]."""
    model = stack((width, height), joint=base_law, **options)
    return model, UNIT_WEIGHT * width * height


class TestPeakWithinAStep:
    """A block turns about its toe once its heel has come off: the multiplier falls from there on.

    With k = k_n B/2 at either corner the toe closes by W / k, and the heel comes off at the rotation
    sin(theta_0) = W / (k B).  Moments about the toe give the multiplier from there on.
    """

    width, height, stiffness, increment = 0.4, 1.0, 1.25e7, 0.008

    def multiplier(self, theta, pull=0.0):
        """With what the heel pulls [N]."""
        c, s, b, h = np.cos(theta), np.sin(theta), self.width / 2, self.height / 2
        weight = UNIT_WEIGHT * self.width * self.height
        return (b * c - h * s + pull / weight * 2.0 * b * c) / (b * s + h * c)

    def taken(self, **law):
        joints = JointLaw(
            friction_coefficient=2.0,
            normal_stiffness=self.stiffness,
            shear_stiffness=1e4 * self.stiffness,
            **law,
        )
        engine, state = settled(stack((self.width, self.height), joint=joints))
        first = take(engine, state, self.increment, whole=False)
        taken = take(engine, state, self.increment, guess=first.solved.increment, whole=False)
        check(taken, whole=False)
        return taken

    def test_excess_and_bend(self):
        weight = UNIT_WEIGHT * self.width * self.height
        lifted = np.arcsin(weight / (self.stiffness * self.width / 2) / self.width)
        share = self.height * np.sin(lifted) / self.increment
        end = self.multiplier(np.arcsin(self.increment / self.height))
        peak = self.multiplier(lifted)
        solved = self.taken().solved
        assert 0.2 < share < 0.8
        print(solved.multiplier - end, solved.excess, (peak - end, share), solved.bend, peak - share * end)

    def test_a_bond_that_breaks(self):
        """The heel pulls until its bond breaks; the multiplier then drops at once."""
        weight, strength = UNIT_WEIGHT * self.width * self.height, 2e3
        pull = strength * self.width / 2
        lifted = np.arcsin((weight + 2.0 * pull) / (self.stiffness * self.width / 2) / self.width)
        taken = self.taken(tensile_strength=strength, cohesion=1e5)
        share = self.height * np.sin(lifted) / self.increment
        peak = self.multiplier(lifted, pull)
        end = self.multiplier(np.arcsin(self.increment / self.height))
        solved = taken.solved
        print(solved.multiplier - end, solved.excess, (peak - end, share), solved.bend, peak - share * end)
        print(taken.step.branch, taken.step.ends)


class TestSnap:
    def model(self, stop=None):
        width, height = 0.2, 0.8
        soft = JointLaw(friction_coefficient=2.0, normal_stiffness=1e10, shear_stiffness=1e6)
        hard = JointLaw(friction_coefficient=2.0, normal_stiffness=1e10, shear_stiffness=1e10)
        outlines = {
            "base": rectangle(-1.0, -0.5, 2.0, 0.5),
            "b1": rectangle(-0.5, 0.0, 1.0, 0.3),
            "b2": rectangle(-0.1, 0.3, width, height),
        }
        if stop is not None:
            outlines["stop"] = rectangle(0.1 + stop, 0.8, 0.5, 0.2)
        blocks = [
            Block(id=name, vertices=v, unit_weight=UNIT_WEIGHT, support=name in ("base", "stop"))
            for name, v in outlines.items()
        ]
        return make_model(
            blocks,
            joint=hard,
            joint_between={frozenset(("base", "b1")): soft},
            thickness=1.0,
            load_direction=(1.0, 0.0),
            control_block="b1",
            control_point="centre",
        )

    def test_turn(self):
        engine, state = settled(self.model())
        peak = 0.25
        weight = UNIT_WEIGHT * (0.3 + 0.16)
        farthest = peak * weight / 1e6
        for whole in (True, False):
            t = take(engine, state, 1.5 * farthest, whole=whole)
            print(t.solved.reason, t.solved.turn, t.solved.multiplier)
        for part in (0.99, 1.01):
            t = take(engine, state, part * farthest, whole=whole)
            print(part, t.solved.reason, t.solved.turn, t.solved.multiplier)

    def test_stop(self):
        engine, state = settled(self.model(stop=0.002))
        peak = 0.25
        weight = UNIT_WEIGHT * (0.3 + 0.16)
        farthest = peak * weight / 1e6
        upper=UNIT_WEIGHT*0.16; h=1.0-0.3
        d=1.5*farthest
        lam=(1e6*d - upper*0.1/h)/(weight-upper*0.4/h)
        for whole in (True, False):
            t = take(engine, state, d, whole=whole)
            print(t.solved.reason, t.solved.turn, t.solved.multiplier, lam, same_contacts(t), t.solved.excess)
            check(t, whole=whole)


class TestDilatancy:
    def test_a_sliding_block_rises(self):
        law = JointLaw(friction_coefficient=0.5, normal_stiffness=1e9, shear_stiffness=1e9, dilatancy_angle=10.0, dilatancy_end=4e-3)
        engine, state = settled(stack((1.0, 0.2), joint=law))
        start = state.pose[1,1]
        for i in range(8):
            t = take(engine, state, 1e-3, whole=bool(i % 2))
            check(t, whole=bool(i%2))
            state, rep = engine.step(state, Demand(increment=1e-3))
            print(rep.static_multiplier, state.pose[1,1]-start, state.history[0], t.solved.multiplier)
