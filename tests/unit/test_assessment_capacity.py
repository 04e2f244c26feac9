"""Oscillators of capacity curves: participation, readings, bilinear curves."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from drystone.assessment.bilinear import bilinear, drop_point
from drystone.assessment.capacity import READINGS, Capacity, participation
from drystone.assessment.errors import AssessmentError
from drystone.model.assembly import GRAVITY

numbers = st.floats(0.1, 10.0)
PART = participation([1000.0, 500.0], [0.5, 1.0])


def straight(reading="base_shear", part=PART):
    return Capacity.straight(0.2, 0.5, part, reading=reading)


@pytest.mark.parametrize("n", [1, 2, 5, 20])
def test_courses_of_one_wall(n):
    # a rigid wall cut in n equal courses: e* = 3 n^2/(4 n^2 - 1)
    part = participation(np.full(n, 7.0), (np.arange(n) + 0.5) / n)
    assert part.mass_ratio == pytest.approx(3 * n**2 / (4 * n**2 - 1), rel=1e-13)
    # Gamma: sum phi/sum phi^2 = (n/2)/(n/3 - 1/12 n)
    assert part.factor == pytest.approx(6 * n**2 / (4 * n**2 - 1), rel=1e-13)


@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=6), numbers)
def test_another_control_point_changes_nothing_but_the_literal_reading(bodies, scale):
    mass, shape = np.array(bodies).T
    one = participation(mass, shape)
    other = participation(mass, scale * shape)
    assert other.mass_ratio == pytest.approx(one.mass_ratio, rel=1e-12)
    assert other.mass == pytest.approx(one.mass, rel=1e-12)
    for reading in READINGS:
        first = Capacity.straight(0.2, 0.5, one, reading=reading)
        second = Capacity.straight(0.2, 0.5 / scale, other, reading=reading)
        same = second.spectral_collapse_displacement == pytest.approx(
            first.spectral_collapse_displacement, rel=1e-12
        )
        assert same or reading == "literal_ec8"
        assert second.activation_acceleration == pytest.approx(
            first.activation_acceleration, rel=1e-12
        )
        assert second.oscillator_mass == pytest.approx(first.oscillator_mass, rel=1e-12)


@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=6))
def test_participation_is_bounded(bodies):
    mass, shape = np.array(bodies).T
    part = participation(mass, shape)
    # Cauchy and Schwarz
    assert 0.0 < part.mass_ratio <= 1.0 + 1e-12
    assert part.mass == pytest.approx(part.factor * part.equivalent_mass, rel=1e-12)


def test_readings():
    # Gamma = 1000/750, e* = 1000^2/(1500 750)
    base, energy, literal = (straight(reading) for reading in READINGS)
    assert base.activation_acceleration == pytest.approx(0.2 * GRAVITY * 1.5 * 0.75)
    assert energy.activation_acceleration == literal.activation_acceleration == 0.2 * GRAVITY
    assert base.spectral_collapse_displacement == pytest.approx(0.375)
    assert energy.spectral_collapse_displacement == pytest.approx(0.375)
    assert literal.spectral_collapse_displacement == 0.5
    assert base.oscillator_mass == pytest.approx(1500 * 8 / 9)
    assert literal.oscillator_mass == 1500
    # stiffness F/d of the oscillator: M* a/d
    assert base.secant_stiffness(0.1875) == pytest.approx(
        base.oscillator_mass * base.activation_acceleration / 0.375
    )


def test_whole_kinetic_energy_of_a_block():
    # width 0.5, height 4.0 (2 b, 2 h): d0* = lambda_0 4 R^2/3 h and p_eff = p sqrt(cos alpha)
    b, h, mass = 0.25, 2.0, 5000.0
    square = b**2 + h**2
    kinetic = mass * 4 / 3 * square / (2 * h) ** 2  # turning about the toe, top of height 2 h
    part = participation([mass], [0.5], kinetic)
    capacity = Capacity.straight(b / h, 2 * b, part, reading="energy")
    assert capacity.spectral_collapse_displacement == pytest.approx(b / h * 4 * square / (3 * h))
    p = math.sqrt(0.75 * GRAVITY / math.sqrt(square))
    found = math.sqrt(capacity.activation_acceleration / capacity.spectral_collapse_displacement)
    assert found == pytest.approx(p * math.sqrt(h / math.sqrt(square)), rel=1e-12)
    assert found == pytest.approx(p, rel=4e-3)
    assert capacity.kinetic_mass_ratio == pytest.approx(0.75 * h**2 / square)
    assert capacity.oscillator_mass == pytest.approx(capacity.kinetic_mass_ratio * mass)


def test_reading_off_the_curve():
    curve = Capacity.of(
        [0.0, 0.1, 0.2], [0.0, 0.3, 0.2], PART, reading="energy", collapse_displacement=0.4,
        collapse_extrapolated=True,
    )  # fmt: skip
    at = curve.spectral_at
    assert curve.acceleration_at(at(0.05)) == pytest.approx(0.15 * GRAVITY)
    assert curve.acceleration_at(at(0.3)) == pytest.approx(0.1 * GRAVITY)  # towards the collapse
    assert curve.acceleration_at(at(0.5)) == 0.0
    assert curve.activation_multiplier == 0.3
    open_end = Capacity.of([0.0, 0.1], [0.0, 0.3], PART, reading="energy")
    assert open_end.collapse_displacement is None
    with pytest.raises(AssessmentError, match="trace it further"):
        open_end.acceleration_at(0.2)


def test_collapse_is_read_from_a_curve_that_falls_to_zero():
    curve = Capacity.of([0.0, 0.1, 0.3], [0.0, 0.3, -0.1], PART, reading="energy")
    assert curve.collapse_displacement == pytest.approx(0.25)
    assert curve.acceleration_at(curve.spectral_at(0.25)) == 0.0
    assert curve.acceleration_at(curve.spectral_at(0.29)) == 0.0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: straight("newton"), "reading"),
        (lambda: Capacity.of([0.0], [1.0], PART, reading="energy"), "two points"),
        (lambda: Capacity.of([0.0, 0.0], [1.0, 0.0], PART, reading="energy"), "forward"),
        (lambda: Capacity.of([0.0, math.inf], [1.0, 0.0], PART, reading="energy"), "finite"),
        (lambda: participation([1.0], [0.5, 0.5]), "equal lists"),
        (lambda: participation([1.0, -1.0], [0.5, 0.5]), "above zero"),
        (lambda: participation([1.0, 1.0], [-0.5, 0.2]), "does not move along the load"),
    ],
)
def test_what_is_no_capacity_is_refused(make, words):
    with pytest.raises(AssessmentError, match=words):
        make()


@given(st.floats(0.001, 0.1), st.floats(0.5, 8.0), st.floats(1.2, 30.0))
def test_bilinear_of_an_elastic_plastic_curve_is_that_curve(start, level, ductility):
    end = start * ductility
    for rule in ("ec8", "ntc2018", "eighty_percent"):
        found = bilinear([0.0, start, end], [0.0, level, level], rule, ultimate=end)
        # d_y comes from a difference of areas: rounding grows with ductility
        assert found.yield_displacement == pytest.approx(start, rel=1e-10)
        assert found.yield_acceleration == pytest.approx(level, rel=1e-10)


@given(
    st.lists(st.floats(0.01, 1.0), min_size=2, max_size=6),
    st.lists(st.floats(0.3, 1.0), min_size=2, max_size=6),
    st.floats(0.5, 0.9),
)
def test_bilinear_has_the_area_of_its_curve(steps, levels, share):
    n = min(len(steps), len(levels))
    d, f = np.append(0.0, np.cumsum(steps[:n])), np.append(0.0, levels[:n])
    area = np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(d))
    for rule in ("ec8", "ntc2018"):
        try:
            found = bilinear(d, f, rule, ultimate=d[-1], secant_share=share)
        except AssessmentError:
            continue
        own = found.yield_acceleration * (d[-1] - 0.5 * found.yield_displacement)
        assert own == pytest.approx(area, rel=1e-9)
        stiffness = found.yield_acceleration / found.yield_displacement
        if rule == "ntc2018":
            # the first branch meets the curve where the share of the peak is first reached
            level = share * f.max()
            assert np.interp(level / stiffness, d, f) == pytest.approx(level, rel=1e-9)


@given(st.floats(0.1, 1.0), st.floats(0.05, 0.95))
def test_drop_point_of_a_straight_branch(end, share):
    assert drop_point([0.0, end], [2.0, 0.0], share) == pytest.approx(end * (1 - share), rel=1e-12)


def test_bilinears_that_make_no_sense_are_refused():
    rigid = [0.0, 0.5], [2.0, 0.0]
    # on a rocking triangle (B.6) yields at its end
    with pytest.raises(AssessmentError, match="softened too far"):
        bilinear(*rigid, "ec8", ultimate=0.5)
    assert bilinear(*rigid, "ec8", ultimate=0.1).yield_displacement == pytest.approx(0.02)
    with pytest.raises(AssessmentError, match="rigid"):
        bilinear(*rigid, "ntc2018")
    with pytest.raises(AssessmentError, match="not past 85%"):
        bilinear([0.0, 0.1, 0.2], [0.0, 1.0, 0.9], "ntc2018")
    with pytest.raises(AssessmentError, match="trace it further"):
        bilinear([0.0, 0.1, 0.2], [0.0, 1.0, 0.9], "ec8", ultimate=0.3)
    with pytest.raises(AssessmentError, match="level from its beginning"):
        bilinear([0.0, 0.1], [1.0, 1.0], "ec8", ultimate=0.1)
    with pytest.raises(AssessmentError, match="needs the displacement"):
        bilinear([0.0, 0.1], [0.0, 1.0], "ec8")
    with pytest.raises(AssessmentError, match="no rule"):
        bilinear([0.0, 0.1], [0.0, 1.0], "fema")


@given(st.floats(0.3, 1.0), st.floats(0.05, 0.4))
def test_rules_end_where_they_say(rise, fall):
    assume(fall > 0.01)
    d, f = [0.0, 0.01 * rise, 0.01 * rise + fall], [0.0, 1.0, 0.0]
    ends = {
        rule: bilinear(d, f, rule).ultimate_displacement for rule in ("ntc2018", "eighty_percent")
    }
    assert ends["ntc2018"] == pytest.approx(d[1] + 0.15 * fall, rel=1e-12)
    assert ends["eighty_percent"] == pytest.approx(d[1] + 0.20 * fall, rel=1e-12)
