"""Neither the place nor the unit of a drawing matters, nor does the unit of weight.

Coordinates are typed: decimal numbers, of which the nearest double is what a model file gives.
Lengths times s, with unit weight and joint stiffness [Pa/m] kept, are the same problem, and so are
weights and stiffnesses times c.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drystone.analysis.driver import pushover
from drystone.engines import make_engine
from drystone.engines.base import Problem, UnstableError
from drystone.engines.frame import Frame
from drystone.limit import collapse_load
from drystone.model.assembly import Block, Corner
from drystone.model.builders import circular_arch, make_model
from drystone.model.joint_law import JointLaw
from drystone.statics.equilibrium import EquilibriumEngine

#: What own coordinates leave of a difference is none, and so are its effects; the loop outside
#: works in the drawing's units, whose rounding of 1e-16 is cut off again.
NOTHING = 1e-12


def typed(value, scale, shift=Decimal(0)):
    """The nearest double of a decimal number, scaled and shifted as decimals are."""
    return float(Decimal(value) * scale + shift)


def wall(courses, *, radius="0", at=("0", "0"), scale="1", weight=1.0, stiffness=1e9):
    """Courses of units of a length and height, a number of them, each course amid the one below."""
    x0, y0, s = Decimal(at[0]), Decimal(at[1]), Decimal(scale)
    names, boxes = ["base"], [("-1", "-0.5", "2.2", "0")]
    bottom = Decimal(0)
    for row, (length, height, count) in enumerate(courses):
        left = Decimal(length) / 2 * (courses[0][2] - count)
        top = bottom + Decimal(height)
        for i in range(count):
            names.append(f"b{row}.{i}")
            boxes.append((left, bottom, left + Decimal(length), top))
            left += Decimal(length)
        bottom = top
    blocks = []
    for name, (left, low, right, high) in zip(names, boxes, strict=True):
        x = [typed(v, s, x0) for v in (left, right)]
        y = [typed(v, s, y0) for v in (low, high)]
        vertices = np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
        blocks.append(
            Block(id=name, vertices=vertices, unit_weight=20e3 * weight, support=name == "base")
        )
    return make_model(
        blocks,
        joint=JointLaw(
            friction_coefficient=0.6,
            normal_stiffness=stiffness * weight,
            shear_stiffness=10.0 * stiffness * weight,
        ),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        corner=Corner(radius=typed(radius, s) or None),
    )


SMALL_WALL = (("0.4", "0.2", 3), ("0.4", "0.2", 2), ("0.4", "0.2", 1))

#: National grids go to 1e7 m, where a double holds eight decimals; and a drawing in millimetres.
PLACES = [
    {"at": ("70", "70")},
    {"at": ("0", "300")},
    {"at": ("1234567.891", "-9876543.21")},
    {"scale": "1000"},
    {"scale": "0.001"},
    {"at": ("-1e7", "1e7"), "scale": "7.3"},
    {"weight": 1e-6},
    {"weight": 1e3, "scale": "12.5"},
]


def same(model, reference, scale, **options):
    """Asserts that two models have the same curve; returns those."""
    first = pushover(reference, **options)
    if "max_displacement" in options:
        options["max_displacement"] *= scale
    other = pushover(model, **options)
    assert other.status == first.status
    assert len(other.points) == len(first.points)
    np.testing.assert_allclose(other.load_multiplier, first.load_multiplier, rtol=0.0, atol=NOTHING)
    np.testing.assert_allclose(
        other.control_displacement, scale * first.control_displacement, rtol=0.0,
        atol=NOTHING * scale,
    )  # fmt: skip
    return first, other


@pytest.mark.parametrize("moved", PLACES, ids=str)
@pytest.mark.parametrize("engine", ["equilibrium", "nscd"])
def test_a_wall_has_the_same_curve_in_any_place_and_unit(engine, moved):
    scale = float(moved.get("scale", "1"))
    model = wall(SMALL_WALL, radius="0.02", **moved)
    reference = wall(SMALL_WALL, radius="0.02")
    same(model, reference, scale, engine=engine, max_displacement=0.02)


def test_the_distinct_engine_has_the_same_curve_in_any_place_and_unit():
    moved = {"at": ("1234567.891", "-9876543.21"), "scale": "0.001", "weight": 1e3}
    model = wall(SMALL_WALL, radius="0.02", **moved)
    reference = wall(SMALL_WALL, radius="0.02")
    same(model, reference, 1e-3, engine="distinct", max_displacement=0.002)


@pytest.mark.parametrize("moved", PLACES, ids=str)
def test_limit_analysis_is_the_same_in_any_place_and_unit(moved):
    there = collapse_load(wall(SMALL_WALL, **moved))
    here = collapse_load(wall(SMALL_WALL))
    assert there.load_multiplier == pytest.approx(here.load_multiplier, rel=1e-9)


millimetres = st.integers(80, 400).map(lambda mm: str(Decimal(mm) / 1000))
offsets = st.decimals(-(10**7), 10**7, places=3, allow_nan=False).map(str)
scales = st.decimals("0.001", "1000", places=3, allow_nan=False).map(str)


@st.composite
def courses(draw):
    """A stack of courses, each as long as the one under it or shorter."""
    length, count = draw(millimetres), draw(st.integers(1, 3))
    rows = []
    for _ in range(draw(st.integers(1, 4))):
        rows.append((length, draw(millimetres), count))
        count = max(count - draw(st.integers(0, 1)), 1)
    return tuple(rows) if len({n for _, _, n in rows}) > 1 else rows[:1]


@given(courses(), offsets, offsets, scales, st.booleans(), st.floats(8.0, 11.0))
@settings(max_examples=20, deadline=None, derandomize=True)
def test_random_assemblies_have_the_same_curve_in_any_place_and_unit(
    rows, x, y, scale, rounded, power
):
    options = {"radius": "0.01" if rounded else "0", "stiffness": 10.0**power}
    reference = wall(rows, **options)
    try:
        first = pushover(reference, max_displacement=0.01)
    except UnstableError:
        return
    model = wall(rows, at=(x, y), scale=scale, **options)
    other = pushover(model, max_displacement=0.01 * float(scale))
    # The eight decimals that a double holds at 1e7 m are too few where a millimetre is scaled by
    # a thousandth; a coordinate is then wrong by its rounding, and with it the ratio of a block.
    size = float(scale) * reference.assembly.smallest_extent
    rounding = 4.0 * np.spacing(max(abs(float(x)), abs(float(y)), 1.0)) / size
    exact = all(
        np.array_equal(mine.vertices, theirs.vertices)
        for mine, theirs in zip(own(model).blocks, own(reference).blocks, strict=True)
    )
    tolerance = NOTHING if exact else max(1e-9, 100.0 * rounding)
    assert other.peak.load_multiplier == pytest.approx(first.peak.load_multiplier, rel=tolerance)


def own(model):
    """The assembly as engines see it."""
    return Frame.of(model.assembly).assembly(model.assembly)


def test_an_arch_stands_in_a_national_grid():
    """Its coordinates are no decimals: what 1e7 m leave of them, 1e-9 m, is 1e-8 of its thickness,
    and its line of thrust goes with that."""

    def arch(centre):
        blocks = circular_arch(
            radius=2.0, thickness=0.5, embrace=160.0, n_voussoirs=9, unit_weight=20e3,
            centre=centre,
        )  # fmt: skip
        return make_model(
            blocks,
            joint=JointLaw(friction_coefficient=0.7, normal_stiffness=1e10, shear_stiffness=1e10),
            thickness=1.0,
            load_direction=(1.0, 0.0),
        )

    here, there = (pushover(arch(c), max_displacement=2e-3) for c in ((0, 0), (3e6, 1e7)))
    assert there.peak.load_multiplier == pytest.approx(here.peak.load_multiplier, rel=1e-6)


def test_places_of_results_are_those_of_the_drawing():
    at = ("1234567.891", "-9876543.21")
    model, reference = wall(SMALL_WALL, at=at, scale="2"), wall(SMALL_WALL)
    found = []
    for one in (model, reference):
        engine = make_engine("equilibrium")
        problem = Problem(assembly=one.assembly, load=one.load, control_point=one.control_point)
        state, _ = engine.start(problem)
        found.append((state.pose, engine.contacts(state)))
    (pose, contacts), (before, expected) = found
    place = np.array([float(v) for v in at])
    np.testing.assert_allclose(pose[:, :2], 2.0 * before[:, :2], rtol=1e-12)
    np.testing.assert_allclose(
        contacts.position, place + 2.0 * expected.position, rtol=0.0,
        atol=2.0 * np.spacing(1e7),
    )  # fmt: skip
    # Forces go with the section, of thickness one: with the square of lengths.
    np.testing.assert_allclose(
        contacts.normal_reaction, 4.0 * expected.normal_reaction, rtol=1e-9, atol=1e-6
    )


@pytest.mark.parametrize("engine", ["equilibrium", "nscd"])
def test_what_keeps_moving_is_told_in_the_drawings_millimetres(engine):
    """A column that leans falls by as many of its own sizes, whatever its size."""
    said = []
    for scale in (1.0, 100.0):
        lean = scale * np.array([[0.0, 0.0], [0.2, 0.0], [1.2, 1.0], [1.0, 1.0]])
        base = scale * np.array([[-1.0, -0.5], [2.0, -0.5], [2.0, 0.0], [-1.0, 0.0]])
        model = make_model(
            [
                Block(id="base", vertices=base, unit_weight=20e3, support=True),
                Block(id="column", vertices=lean, unit_weight=20e3),
            ],
            joint=JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9),
            thickness=1.0,
            load_direction=(1.0, 0.0),
        )
        problem = Problem(
            assembly=model.assembly, load=model.load, control_point=model.control_point
        )
        with pytest.raises(UnstableError) as told:
            make_engine(engine).start(problem)
        said.append(int(str(told.value).split('"column" (')[1].split(" mm")[0]))
    assert said[1] == pytest.approx(100 * said[0], abs=60)  # half a millimetre, times 100


def test_the_engine_itself_needs_no_frame():
    """Gaps are made of differences, so that a place of some kilometres does no harm even so."""
    model = wall(SMALL_WALL, at=("3000", "5000"))
    problem = Problem(assembly=model.assembly, load=model.load, control_point=model.control_point)
    _, report = EquilibriumEngine().start(problem)
    assert report.converged
