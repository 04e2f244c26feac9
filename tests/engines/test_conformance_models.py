"""Every engine that is installed over every kind of model, each point judged from outside.

What is judged is what an engine gives out of a point: its residual against the limit that it
states, and its contact forces against the loads, in sums that share nothing with the library.
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_parts import halved

from builders import (
    BONDED_JOINT,
    PUBLISHED_JOINT,
    rectangle,
    small_wall,
    stack,
    with_corner,
    with_joint,
)
from drystone.analysis.driver import pushover
from drystone.engines import engine_names, make_engine
from drystone.engines.base import Engine, EngineError
from drystone.engines.framed import framed
from drystone.geometry.space import solid
from drystone.model.assembly import Block, Corner
from drystone.model.builders import extruded, make_model
from drystone.model.loading import MassPattern, acting
from drystone.model.model import Model
from drystone.results.curve import STATIC, CapacityCurve, CurvePoint
from lmgc90_here import needs_lmgc90
from solids import turned

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "own_engine.py"

ENGINES = [
    pytest.param(name, marks=needs_lmgc90) if name == "lmgc90" else name for name in engine_names()
]

#: Joints by what they have beyond a dry one.
JOINTS = {
    "dry": PUBLISHED_JOINT,
    "cohesive": BONDED_JOINT,
    "dilatant": replace(PUBLISHED_JOINT, shear_stiffness=1e8, dilatancy_angle=10.0),
}
CORNERS = {
    "sharp": Corner(),
    "rounded": Corner(radius=0.02),
    "chamfered": Corner(chamfer=0.02),
}
#: Formulations by impulses, and what they say of joints that are more than dry.
STEPS_IN_TIME = ("nscd", "lmgc90")
REFUSED = r"^the {} engine has no dilatancy, cohesion or tensile strength: set them to zero"

#: What contacts given out by steps in time may miss of a force, over the heaviest weight.  Coming
#: to rest ends with steps of 0.05 s that move blocks by 1e-3 of what joints have closed by, 1e-4 m
#: here: an inertia of 4e-6.  Of LMGC90 there is what was carried as well, 2e-5 at most, by contacts
#: that are none any more where the blocks have come to.
MISSED = {"nscd": 1e-5, "lmgc90": 1e-4}


@dataclass(frozen=True, kw_only=True)
class Point:
    """A point of a curve as it is given out, and what can be summed from that alone."""

    model: Model
    pose: np.ndarray  # (n, n_pose) m, rad
    moved: np.ndarray  # (n, n_dof) m, rad, since the point before
    time_step: float  # s; zero of a step without inertia
    multiplier: float  # applied
    held: float  # N, of all blocks by inertia, where no time step says how
    contacts: object

    @property
    def dim(self) -> int:
        """2 or 3."""
        return self.model.assembly.dimension

    def reactions(self) -> np.ndarray:
        """On blocks b, (n_contacts, dim) [N]."""
        c = self.contacts
        if self.dim == 2:
            clockwise = np.stack((c.normal[:, 1], -c.normal[:, 0]), axis=1)
            return c.normal_reaction[:, None] * c.normal + c.tangential_reaction * clockwise
        frame = np.stack((c.normal, c.tangent, np.cross(c.normal, c.tangent)), axis=1)
        given = np.column_stack((c.normal_reaction, c.tangential_reaction))
        return np.einsum("ki,kij->kj", given, frame)

    def places(self) -> np.ndarray:
        """Of the centroids, (n, dim) [m]."""
        return self.model.assembly.centroid + self.pose[:, : self.dim]

    def forces(self) -> np.ndarray:
        """Of all contacts on each block, with moments about its centroid, (n, n_dof) [N, N m]."""
        c, a = self.contacts, self.model.assembly
        total, place = np.zeros((a.n_bodies, a.n_dof)), self.places()
        for k, on_b in enumerate(self.reactions()):
            for body, force in ((c.block_a[k], -on_b), (c.block_b[k], on_b)):
                arm = c.position[k] - place[body]
                total[body] += np.append(force, moment_of(arm, force))
        return total

    def loads(self) -> np.ndarray:
        """Weights and what is applied in proportion to them, (n, dim) [N]."""
        weight, down = self.model.assembly.weight[:, None], -self.model.assembly.up
        return weight * (self.multiplier * np.asarray(self.model.load.direction) + down)

    def inertia(self) -> np.ndarray:
        """M a of a step from rest that ends at the speed it moves by, (n, n_dof) [N, N m].

        In space it is of rotations about principal axes; given back about those of the world.
        """
        if not self.time_step:
            return np.zeros_like(self.moved)
        found = self.model.assembly.mass * self.moved / self.time_step**2
        if self.dim == 3:
            turn = Rotation.from_quat(self.pose[:, 3:], scalar_first=True)
            axes = turn.as_matrix() @ self.model.assembly.axes
            found[:, 3:] = np.einsum("nij,nj->ni", axes, found[:, 3:])
        return found

    def left(self) -> np.ndarray:
        """What is left of Newton's second law on movable blocks, (n, n_dof) [N, N m]."""
        left = self.forces() - self.inertia()
        left[:, : self.dim] += self.loads()
        return left[~self.model.assembly.fixed]

    def left_of_whole(self) -> np.ndarray:
        """The same of the structure, by the supports' reactions, moments about the origin."""
        a, c = self.model.assembly, self.contacts
        total = np.zeros(a.n_dof)
        for reaction, place, i, j in zip(
            self.reactions(), c.position, c.block_a, c.block_b, strict=True
        ):
            handed = float(a.fixed[i]) - float(a.fixed[j])  # from a support, or to one
            total += handed * np.append(reaction, moment_of(place, reaction))
        inertia, loads, centre = self.inertia(), self.loads(), self.places()
        for i in np.flatnonzero(~a.fixed):
            force = loads[i] - inertia[i, : self.dim]
            total += np.append(force, moment_of(centre[i], force) - inertia[i, self.dim :])
        return total

    def carried(self) -> float:
        """What the supports carry along the load beyond the weight, over the load's total."""
        a, direction = self.model.assembly, np.asarray(self.model.load.direction)
        handed = self.forces()[a.fixed, : self.dim].sum(axis=0)
        weight = a.weight[~a.fixed].sum()
        return float((handed + weight * a.up) @ direction / weight)


def moment_of(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """(1,) in the plane, (3,) in space [N m]."""
    if len(arm) == 3:
        return np.cross(arm, force)
    return np.array([arm[0] * force[1] - arm[1] * force[0]])


def points_of(model: Model, curve: CapacityCurve) -> list[Point]:
    """The static points of a curve that has kept its poses and contacts."""
    before = [curve.poses[0], *curve.poses[:-1]]
    return [
        Point(
            model=model,
            pose=pose,
            moved=model.assembly.difference(pose, last),
            time_step=point.time_step if curve.engine in STEPS_IN_TIME else 0.0,
            multiplier=point.applied_multiplier,
            held=held_by_inertia(model, point) if curve.engine == "equilibrium" else 0.0,
            contacts=contacts,
        )
        for point, pose, last, contacts in zip(
            curve.points, curve.poses, before, curve.contacts, strict=True
        )
        if point.status == STATIC
    ]


def held_by_inertia(model: Model, point: CurvePoint) -> float:
    """Sum of the sizes of the inertia forces that a point reports [N]: of `equilibrium`, those that
    keep loose blocks where they are, from nothing up to 1e-3 of the load."""
    a = model.assembly
    load = max(abs(point.applied_multiplier), 1e-3) * a.weight[~a.fixed].sum()
    return point.inertia_ratio * float(load)


def traced(model: Model, name: str | Engine) -> tuple[Engine, CapacityCurve]:
    """Over the peak where the joints are dry, or so far as to slide and to break bonds."""
    solver = make_engine(name) if isinstance(name, str) else name
    curve = pushover(
        model,
        engine=solver,
        strategy="displacement",
        max_displacement=5e-3,
        max_steps=100,
        keep_poses=True,
        keep_contacts=True,
    )
    assert len(curve.points) > 5
    return solver, curve


def check_residual(solver: Engine, curve: CapacityCurve) -> None:
    """Every point, in motion too, against the limit that the engine states."""
    assert solver.capabilities.residual_limit is not None
    for column in ("residual", "friction_violation"):
        found = curve.column(column)
        assert np.all(found >= 0.0)  # so that what is not a number fails
        assert found.max() <= solver.capabilities.residual_limit


def came(point: Point) -> tuple[float, float]:
    """How far a contact's two blocks can have moved on each other in the step, and turned.

    By so much the contacts of its end, which are given out, differ from those of its beginning.
    """
    turn = np.linalg.norm(point.moved[:, point.dim :], axis=1).max()
    way = np.linalg.norm(point.moved[:, : point.dim], axis=1).max()
    way += turn * largest_extent(point.model)
    return 2.0 * float(way), 2.0 * float(turn)


def largest_extent(model: Model) -> float:
    """Of a movable block [m]."""
    movable = (block for block in model.assembly.blocks if not block.support)
    return max(float(np.ptp(block.vertices, axis=0).max()) for block in movable)


def check_balance(solver: Engine, point: Point) -> None:
    """Newton's laws of a point, of every block and of the whole.

    Steps in time take arms from their beginning; LMGC90's normals are those of another place as
    well.  Slip of rounded corners is measured on their discs, its reaction acts where they overlap:
    a share of closing over the diameter of the shear is the difference.
    """
    a, c, dim = point.model.assembly, point.contacts, point.dim
    limit = solver.capabilities.residual_limit * a.heaviest_weight + point.held
    way = turn = 0.0
    if solver.name in STEPS_IN_TIME:
        way, turn = came(point)
        turn = turn if solver.name == "lmgc90" else 0.0
        limit += MISSED[solver.name] * a.heaviest_weight
    shear = np.linalg.norm(c.tangential_reaction, axis=1)
    size = np.hypot(c.normal_reaction, shear)
    disc = np.maximum(-c.gap, 0.0) / (2.0 * a.corner.radius) if a.corner.radius else 0.0 * size
    force, moment = np.zeros((2, a.n_bodies))
    extent = largest_extent(point.model)
    for body in (c.block_a, c.block_b):
        np.add.at(force, body, size * turn + shear * disc)
        np.add.at(moment, body, size * way + shear * disc * extent)
    free = ~a.fixed
    force, moment = force[free] + limit, moment[free] + limit * extent
    left = np.abs(point.left())
    assert np.all(left[:, :dim] <= force[:, None])
    assert np.all(left[:, dim:] <= moment[:, None])
    # What is left of every block adds up, with arms from the origin.
    far = float(np.abs(point.places())[free].max())
    whole = np.abs(point.left_of_whole())
    assert whole[:dim].max() <= force.sum()
    assert whole[dim:].max() <= 2.0 * far * force.sum() + moment.sum()


def check_law(solver: Engine, point: Point) -> None:
    """Compression, what closes the joint, and Coulomb's cone; one law for all joints here.

    Areas, of which strength and stiffness follow, are those of the beginning of the step.
    """
    a, c = point.model.assembly, point.contacts
    law, tolerance = a.joint, solver.capabilities.residual_limit * a.heaviest_weight
    way, turn = came(point)
    normal, shear = c.normal_reaction, np.linalg.norm(c.tangential_reaction, axis=1)
    assert normal.min() >= -tolerance  # none of these joints has tensile strength
    area = c.area + a.thickness * way
    # Of two rounded corners that press each other, see `ContactForces`.
    radii = 2.0 * (a.corner.radius or 0.0)
    closer = radii / (radii + np.minimum(c.gap, 0.0)) if radii > 0.0 else 1.0
    bears = law.friction_coefficient * normal + law.cohesion * area
    assert np.all(shear <= closer * bears + tolerance)
    if law.dilatancy_angle == 0.0 and solver.name != "lmgc90":  # which gives gaps of the beginning
        closing = np.maximum(-c.gap, 0.0)
        straight = way * turn if solver.name in STEPS_IN_TIME else 0.0  # of a gap that is linear
        off = (area - c.area) * closing + area * straight
        closed = law.normal_stiffness * closing * c.area
        assert np.all(np.abs(normal - closed) <= tolerance + law.normal_stiffness * off)


def check(model: Model, name: str | Engine) -> CapacityCurve:
    """Everything that is known of a curve without knowing the engine."""
    solver, curve = traced(model, name)
    check_residual(solver, curve)
    given = [point for point in curve.points if point.status == STATIC]
    points = points_of(model, curve)
    assert len(points) > 5
    for point, told in zip(points, given, strict=True):
        check_balance(solver, point)
        check_law(solver, point)
        # The engine's own sum, of the forces of its solver; LMGC90's come in single steps of time.
        assert point.carried() == pytest.approx(told.carried_multiplier, abs=1e-6)
    return curve


def check_or_refuse(model: Model, name: str, joints: str) -> CapacityCurve | None:
    """`check`; of what a formulation does not have, that it is said before anything is solved."""
    if joints != "dry" and name in STEPS_IN_TIME:
        with pytest.raises(EngineError, match=REFUSED.format(name)):
            pushover(model, engine=name)
        return None
    return check(model, name)


def random_wall(seed: int, joints: str) -> Model:
    """Three courses of unequal pieces between slanting head joints, of unequal weight.

    Every piece has its centroid well above the course below, so that all stand; friction, corners
    and the direction of the load are drawn as well.
    """
    random = np.random.default_rng(seed)
    blocks = [
        Block(id="base", vertices=rectangle(-0.5, -0.3, 2.5, 0.3), unit_weight=20e3, support=True)
    ]
    low, width = 0.0, 1.2
    for course in range(3):
        high = low + random.uniform(0.15, 0.3)
        n = int(random.integers(2, 4))
        shares = random.uniform(1.0, 1.6, n)
        cuts = width * np.append(0.0, np.cumsum(shares) / shares.sum())
        slant = np.append(0.0, random.uniform(-0.02, 0.02, n))
        slant[-1] = 0.0
        for i in range(n):
            vertices = [
                [cuts[i] - slant[i], low],
                [cuts[i + 1] - slant[i + 1], low],
                [cuts[i + 1] + slant[i + 1], high],
                [cuts[i] + slant[i], high],
            ]
            weight = 10.0 ** random.uniform(4.0, 4.6)
            blocks.append(
                Block(id=f"c{course}p{i}", vertices=np.array(vertices), unit_weight=weight)
            )
        low = high
    law = replace(JOINTS[joints], friction_coefficient=random.uniform(0.4, 0.8))
    return make_model(
        blocks,
        joint=law,
        corner=(Corner(), Corner(radius=0.015), Corner(chamfer=0.015))[random.integers(3)],
        thickness=random.uniform(0.3, 1.0),
        load_direction=(random.choice((-1.0, 1.0)), random.uniform(-0.1, 0.1)),
    )


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("joints", JOINTS)
@pytest.mark.parametrize("corner", CORNERS)
def test_a_small_wall(engine, joints, corner):
    """Slides, rocks and, where it is bonded, breaks."""
    model = with_corner(with_joint(small_wall(), JOINTS[joints]), CORNERS[corner])
    check_or_refuse(model, engine, joints)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("joints", "corner", "push"),
    [
        pytest.param("dry", "sharp", (1.0, 0.0), id="dry"),
        pytest.param("dry", "rounded", (0.6, 0.8), id="rounded, oblique"),
        pytest.param("dry", "chamfered", (0.0, 1.0), marks=pytest.mark.slow, id="across"),
        pytest.param("cohesive", "sharp", (0.8, 0.6), id="cohesive, oblique"),
        pytest.param("dilatant", "sharp", (1.0, 0.0), marks=pytest.mark.slow, id="dilatant"),
    ],
)
def test_a_small_wall_of_solids(engine, joints, corner, push):
    """The same wall in space, pushed along it, across, and between."""
    flat = with_corner(with_joint(small_wall(), JOINTS[joints]), CORNERS[corner])
    check_or_refuse(pushed(extruded(flat), push), engine, joints)


def pushed(model: Model, push: tuple[float, float]) -> Model:
    """A model of space whose load and control displacement go along ``push``."""
    along = np.array([*push, 0.0])
    control = replace(model.control_point, direction=along)
    return replace(model, load=MassPattern(direction=along), control_point=control)


#: Those that take blocks of several parts, and contacts that come and go.
OWN = ["equilibrium", "distinct", "nscd"]


@pytest.mark.parametrize("engine", OWN)
def test_a_small_wall_of_solids_that_is_turned(engine):
    """Gravity, load and control with it, anyhow."""
    model = pushed(extruded(with_corner(small_wall(), Corner())), (0.8, 0.6))
    check(turned(model, Rotation.from_rotvec((0.4, -0.9, 1.3)), (3.0, -2.0, 5.0)), engine)


@pytest.mark.parametrize("engine", OWN)
@pytest.mark.parametrize(
    "push",
    [
        pytest.param((1.0, 0.0), marks=pytest.mark.slow),
        (0.8, 0.6),
        pytest.param((0.0, 1.0), marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_solids_of_two_parts(engine, push):
    """Every unit is two boxes side by side: on units that slide they meet other boxes."""
    model = pushed(extruded(with_corner(small_wall(), Corner())), push)
    blocks = []
    for block in model.assembly.blocks:
        low, high = block.vertices.min(axis=0), block.vertices.max(axis=0)
        middle = 0.5 * (low[0] + high[0])
        halves = tuple(
            solid.Part(*solid.box([(a, *low[1:]), (b, *high[1:])]))
            for a, b in ((low[0], middle), (middle, high[0]))
        )
        vertices = np.vstack([half.vertices for half in halves])
        blocks.append(replace(block, vertices=vertices, faces=(), parts=halves))
    curve = check(replace(model, assembly=replace(model.assembly, blocks=tuple(blocks))), engine)
    # It slides and rocks on its joints' ends, as in one piece; with points in their middles as well
    # these are half as stiff against turning.
    whole = traced(model, engine)[1]
    assert curve.peak.load_multiplier == pytest.approx(whole.peak.load_multiplier, rel=5e-3)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("joints", JOINTS)
def test_blocks_of_two_parts(engine, joints):
    model = with_joint(small_wall(), JOINTS[joints])
    model = with_corner(model, Corner())
    cut = replace(model, assembly=halved(model.assembly))
    if engine == "lmgc90" and joints == "dry":
        with pytest.raises(EngineError, match="is of several convex parts"):
            pushover(cut, engine=engine)
        return
    curve = check_or_refuse(cut, engine, joints)
    if curve is not None:
        whole = traced(model, engine)[1]
        assert curve.peak.load_multiplier == pytest.approx(whole.peak.load_multiplier, rel=2e-3)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(3))
def test_random_walls_of_dry_joints(engine, seed):
    check(random_wall(seed, "dry"), engine)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("joints", ["cohesive", "dilatant"])
@pytest.mark.parametrize("seed", [10, 11])
def test_random_walls_of_other_joints(engine, joints, seed):
    check_or_refuse(random_wall(seed, joints), engine, joints)


# What the suite would find


def test_loads_that_an_engine_mistakes_are_found(monkeypatch):
    """Its own residual is none, as it takes the same weights: a hundredth too much."""
    real = acting.weight_forces
    monkeypatch.setattr(acting, "weight_forces", lambda assembly: 1.01 * real(assembly))
    model = with_corner(small_wall(), Corner())
    solver, curve = traced(model, "distinct")
    check_residual(solver, curve)
    for point in points_of(model, curve):
        with pytest.raises(AssertionError):
            check_balance(solver, point)


@pytest.mark.parametrize(
    ("what", "by"), [("normal_reaction", 0.99), ("position", 1.01), ("gap", 0.9)]
)
def test_contacts_that_are_given_out_wrong_are_found(what, by):
    model = with_corner(small_wall(), Corner())
    solver, curve = traced(model, "equilibrium")
    right = points_of(model, curve)[-1]
    wrong = replace(
        right, contacts=replace(right.contacts, **{what: by * getattr(right.contacts, what)})
    )
    check_balance(solver, right)
    check_law(solver, right)
    with pytest.raises(AssertionError):
        check_balance(solver, wrong)
        check_law(solver, wrong)


def test_a_residual_that_is_not_kept_is_found():
    """Of a point that the loop let pass, and of one that is no number."""
    solver, curve = traced(stack((0.4, 0.3), (0.3, 0.6)), "equilibrium")
    check_residual(solver, curve)
    for residual in (2.0 * solver.capabilities.residual_limit, np.nan):
        last = replace(curve.points[-1], residual=residual)
        with pytest.raises(AssertionError):
            check_residual(solver, replace(curve, points=(*curve.points[:-1], last)))


@pytest.fixture
def rocking():
    """The engine of the examples, which knows one block and a hinge."""
    spec = importlib.util.spec_from_file_location("own_engine", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return framed(module.RockingEngine())


class TestAnEngineOfOthers:
    """It states no limit: its curve is judged by the supports' reactions alone."""

    @staticmethod
    def whole(rocking, model):
        """Largest force that is left of the static points' balance, over the weight."""
        _, curve = traced(model, rocking)
        assert rocking.capabilities.residual_limit is None and np.isnan(curve.residual).all()
        assert "the toe is a hinge" in curve.reason  # what it leaves out is told
        weight = model.assembly.weight[~model.assembly.fixed].sum()
        # Its inertia does not reach the support: what it carries is less than what is applied.
        points = points_of(model, curve)
        told = [p.carried_multiplier for p in curve.points if p.status == STATIC]
        return max(
            np.abs(replace(point, multiplier=carried).left_of_whole()[:2]).max() / weight
            for point, carried in zip(points, told, strict=True)
        )

    def test_what_it_knows_is_in_balance(self, rocking):
        assert self.whole(rocking, stack((0.4, 1.2))) <= 1e-9

    def test_what_it_does_not_know_is_found(self, rocking):
        """A block below its own, whose weight it leaves out: a half of all."""
        assert self.whole(rocking, stack((0.4, 1.2), (0.4, 1.2))) >= 0.4
