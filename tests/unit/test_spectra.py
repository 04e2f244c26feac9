"""Elastic spectra: corners, soil factors that move with a_g, tables, floors."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drystone.assessment.errors import AssessmentError
from drystone.assessment.site import missing_motions, motions_asked, spectra_of_site
from drystone.assessment.spectra import (
    Ec8Spectrum,
    FloorSpectrum,
    Mode,
    NtcSpectrum,
    Spectrum,
    TableSpectrum,
    damping_factor,
    first_mode,
    read_spectrum,
)
from drystone.assessment.spectra.base import largest_displacement
from drystone.assessment.spectra.ec8 import acceleration_of_return_period
from drystone.assessment.spectra.ntc2018 import reference_life, return_period
from drystone.model.assembly import GRAVITY
from drystone.model.site import Site

#: A corner is looked at from both sides, this share away from it.
BESIDE = 1e-9

dampings = st.floats(0.02, 0.28)
ec8 = st.builds(
    Ec8Spectrum,
    ground_acceleration=st.floats(0.1, 6.0),
    spectrum_type=st.sampled_from([1, 2]),
    ground=st.sampled_from("ABCDE"),
)
ntc = st.builds(
    NtcSpectrum,
    ground_acceleration=st.floats(0.1, 6.0),  # T_D stays below T_E up to 0.72 g
    amplification=st.floats(2.2, 3.0),
    reference_corner=st.floats(0.15, 0.55),
    soil=st.sampled_from("ABCDE"),
    topography=st.sampled_from(["T1", "T2", "T3", "T4"]),
)


def ntc_of(soil, acceleration, amplification=2.5, corner=0.3):
    return NtcSpectrum(
        ground_acceleration=acceleration * GRAVITY,
        amplification=amplification,
        reference_corner=corner,
        soil=soil,
        topography="T1",
    )


def table(**changes):
    values = {
        "table_period": np.array([0.0, 0.2, 0.6, 2.0]),
        "table_acceleration": np.array([2.0, 5.0, 5.0, 1.5]),
        "table_damping": 0.05,
    }
    return TableSpectrum(**{**values, **changes})


@given(ec8 | ntc, dampings)
def test_spectra_are_continuous_but_for_the_step_of_the_codes(spectrum, damping):
    corners = spectrum.shape
    for corner in (
        corners.rise,
        corners.corner,
        corners.displacement_corner,
        corners.ground_period,
    ):
        before, after = spectrum.sd([corner * (1 - BESIDE), corner * (1 + BESIDE)], damping)
        assert after == pytest.approx(before, rel=1e-7)
    before, after = spectrum.sd(
        [corners.long_period * (1 - BESIDE), corners.long_period * (1 + BESIDE)], damping
    )
    # 0.025 in place of 1/4 pi^2
    assert after / before == pytest.approx(0.025 * 4 * math.pi**2, rel=1e-7)
    assert after / before - 1 == pytest.approx(-0.013, abs=5e-4)


@given(ec8 | ntc, dampings, st.floats(0.01, 12.0))
def test_displacement_and_acceleration_are_of_one_oscillator(spectrum, damping, period):
    acceleration = float(spectrum.sa(period, damping))
    assert float(spectrum.sd(period, damping)) == pytest.approx(
        acceleration * (period / (2 * math.pi)) ** 2, rel=1e-12
    )


@given(ec8 | ntc, dampings)
def test_values_that_every_spectrum_has(spectrum, damping):
    level = spectrum.ground_acceleration * spectrum.soil_factor
    assert float(spectrum.sa(0.0, damping)) == pytest.approx(level, rel=1e-14)
    plateau = level * spectrum.shape.amplification * damping_factor(damping)
    assert float(spectrum.sa(spectrum.corner_period, damping)) == pytest.approx(plateau, rel=1e-14)
    ground = 0.025 * level * spectrum.corner_period * spectrum.shape.displacement_corner
    assert float(spectrum.sd(10.0, damping)) == pytest.approx(ground, rel=1e-14)
    assert isinstance(spectrum, Spectrum)


@given(ec8 | ntc, st.floats(0.1, 6.0))
def test_a_scaled_spectrum_is_that_of_its_ground_acceleration(spectrum, acceleration):
    there = spectrum.scaled(acceleration)
    back = there.scaled(spectrum.ground_acceleration)
    assert there.ground_acceleration == acceleration
    periods = np.linspace(0.0, 11.0, 23)
    assert np.array_equal(back.sa(periods, 0.05), spectrum.sa(periods, 0.05))


def test_values_written_out():
    # EN 1998-1 type 1, ground B, 0.25 g: S 1.2, T_B 0.15, T_C 0.5, T_D 2.0
    spectrum = Ec8Spectrum(ground_acceleration=2.4525, spectrum_type=1, ground="b")
    assert float(spectrum.sa(0.075, 0.05)) == pytest.approx(2.4525 * 1.2 * 1.75)
    assert float(spectrum.sa(1.0, 0.05)) == pytest.approx(2.4525 * 1.2 * 2.5 * 0.5)
    assert float(spectrum.sa(3.0, 0.05)) == pytest.approx(2.4525 * 1.2 * 2.5 * 0.5 * 2.0 / 9.0)
    # half way from T_E = 5 to T_F = 10: the mean of 2.5 and 1
    assert float(spectrum.sd(7.5, 0.05)) == pytest.approx(0.025 * 2.4525 * 1.2 * 0.5 * 2.0 * 1.75)


@pytest.mark.parametrize(("percent", "eta"), [(5, 1.0), (8, 0.877), (10, 0.816), (28.1, 0.55)])
def test_damping_factor(percent, eta):
    assert damping_factor(percent / 100) == pytest.approx(eta, abs=5e-4)


@pytest.mark.parametrize(
    ("soil", "ratio", "factor"),
    # of F_0 a_g/g: Table 3.2.IV, on both clips and between them
    [
        ("A", 1.0, 1.0),
        ("B", 0.4, 1.2), ("B", 0.8, 1.08), ("B", 1.2, 1.0),
        ("C", 0.2, 1.5), ("C", 0.8, 1.22), ("C", 1.3, 1.0),
        ("D", 0.3, 1.8), ("D", 0.8, 1.2), ("D", 1.1, 0.9),
        ("E", 0.3, 1.6), ("E", 0.6, 1.34), ("E", 1.0, 1.0),
    ],
)  # fmt: skip
def test_soil_factor_moves_with_the_ground_acceleration(soil, ratio, factor):
    assert ntc_of(soil, ratio / 2.5).soil_factor == pytest.approx(factor, rel=1e-12)


def test_corner_factors_and_topography():
    # C_C at T_C* = 0.3 s, by hand
    for soil, value in (("A", 1.0), ("B", 1.3995), ("C", 1.5622), ("D", 2.2822), ("E", 1.8614)):
        assert ntc_of(soil, 0.2).corner_factor == pytest.approx(value, abs=5e-5)
    steep = NtcSpectrum(
        ground_acceleration=1.0, amplification=2.5, reference_corner=0.3, soil="A", topography="T4"
    )
    assert steep.soil_factor == 1.4 and "top" in steep.notes[0]


def test_return_periods():
    # V_R = 75 years, 10 per cent: 712 years
    assert return_period(reference_life(50.0, "III"), "SLV") == pytest.approx(711.84, abs=0.01)
    assert return_period(50.0, 0.10) == pytest.approx(474.56, abs=0.01)
    # (2475/475)^(1/3)
    assert acceleration_of_return_period(1.0, 2475.0) == pytest.approx(1.7337, abs=1e-4)
    important = Ec8Spectrum.of_reference(
        2.0, importance="III", spectrum_type=1, ground="A", return_period=2475.0
    )
    assert important.ground_acceleration == pytest.approx(2.0 * 1.2 * 1.7337, abs=5e-4)
    assert "475" in important.notes[0] and important.return_period == 2475.0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ntc_of("F", 0.1), "no ground"),
        (lambda: ntc_of("A", 0.0), "ground acceleration"),
        (lambda: ntc_of("A", float("nan")), "ground acceleration"),
        (lambda: ntc_of("A", 0.1, amplification=-1.0), "F0"),
        (lambda: Ec8Spectrum(ground_acceleration=1.0, spectrum_type=3, ground="A"), "type"),
        (
            lambda: Ec8Spectrum.of_reference(1.0, importance="V", spectrum_type=1, ground="A"),
            "importance class",
        ),
        (lambda: ntc_of("A", 0.1).sa(-1.0, 0.05), "period"),
        (lambda: ntc_of("A", 0.1).sa(1.0, 5.0), "ratio"),
        (lambda: return_period(50.0, "SLX"), "limit state"),
        (lambda: table(table_period=[0.0, 0.6, 0.2, 2.0]), "sort"),
        (lambda: table(table_period=[0.1, 0.2, 0.6, 2.0]), "T = 0"),
        (lambda: table(table_acceleration=[2.0, -5.0, 5.0, 1.5]), "at 0.2 s"),
        (lambda: table(table_acceleration=[0.0, 5.0, 5.0, 1.5]), "at 0 s"),
        (lambda: table(table_acceleration=[2.0, math.nan, 5.0, 1.5]), "point 2"),
        (lambda: table(soil_factor=0.0), "soil factor"),
    ],
)  # fmt: skip
def test_bad_spectra_are_refused(make, words):
    with pytest.raises(AssessmentError, match=words):
        make()


def test_table():
    spectrum = table(soil_factor=1.25)
    assert spectrum.ground_acceleration == pytest.approx(1.6)
    assert float(spectrum.sa(0.1, 0.05)) == pytest.approx(3.5)  # straight between points
    # a_g S (1 + (eta F - 1) T/T_B) with F = 5/2 and T_B = 0.2 s; the ground has no damping
    eta = math.sqrt(10 / 15)
    assert float(spectrum.sa(0.1, 0.10)) == pytest.approx(2.0 * (1.0 + (2.5 * eta - 1.0) / 2.0))
    assert float(spectrum.sa(0.0, 0.10)) == 2.0
    assert float(spectrum.sa(0.2, 0.10)) == pytest.approx(5.0 * eta)
    # beyond the last point the displacement stays
    assert spectrum.sd([3.0, 7.0], 0.05) == pytest.approx(float(spectrum.sd(2.0, 0.05)))
    # largest S_e T is 3.0 at 0.6 s and at 2 s, over 5.0
    assert spectrum.corner_period == pytest.approx(0.6)
    assert table(corner=0.45).corner_period == 0.45
    twice = spectrum.scaled(3.2)
    assert twice.sa([0.0, 1.0], 0.05) == pytest.approx(2 * spectrum.sa([0.0, 1.0], 0.05))
    assert twice.soil_factor == 1.25 and twice.ground_acceleration == pytest.approx(3.2)


@given(st.floats(0.0, 1.0), st.floats(1.0, 4.0))
def test_largest_displacement_between_two_periods(first, last):
    # a narrow peak at 1.2 s, which the displacement at the last period does not show
    spectrum = table(
        table_period=[0.0, 1.0, 1.2, 1.4, 4.0], table_acceleration=[2.0, 3.0, 9.0, 1.0, 0.1]
    )
    fine = np.append(np.linspace(first, last, 20001), 1.2 if last > 1.2 else last)
    found = largest_displacement(spectrum, first, last, 0.05)
    # the grid of 512 periods misses the summit by less than the square of its step
    assert found == pytest.approx(float(np.max(spectrum.sd(fine, 0.05))), rel=2e-4)


FILE = "T,Se\n0,0.2\n\n# plateau\n0.1, 0.5\n0.5,0.5\n2,0.1\n"


def test_table_of_a_file(tmp_path):
    path = tmp_path / "site.csv"
    path.write_text(FILE)
    spectrum = read_spectrum(path, unit="g", damping=0.05)
    assert spectrum.ground_acceleration == pytest.approx(0.2 * GRAVITY)
    assert read_spectrum(path, unit="m/s2", damping=0.05).ground_acceleration == 0.2
    assert "site.csv" in spectrum.label and any("2 s" in note for note in spectrum.notes)


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        (FILE, "cm/s2", 'say "g"'),
        (FILE.replace("T,Se", "period;acc"), "g", "header"),
        ("", "g", "header"),
        (FILE.replace("0.5,0.5", "0.5,x"), "g", "line 6"),
        (FILE.replace("0.5,0.5", "0.5;0.5"), "g", "line 6"),
        ("T,Se\n0,1\n", "g", "two or more"),
        (FILE.replace("0.1, 0.5", "0.7,0.5"), "g", "sort"),
        (FILE.replace("0.1, 0.5", "0.1,nan"), "g", "finite"),
    ],
)
def test_bad_files_are_refused(tmp_path, text, unit, words):
    path = tmp_path / "site.csv"
    path.write_text(text)
    with pytest.raises(AssessmentError, match=words):
        read_spectrum(path, unit=unit, damping=0.05)
    with pytest.raises(AssessmentError, match="cannot be read"):
        read_spectrum(tmp_path / "none.csv", unit="g", damping=0.05)


@pytest.mark.parametrize("text", ["root:secret", "T,Se\n0,secret\n", "T,Se\n0,1,secret\n"])
def test_what_another_file_holds_is_not_shown(tmp_path, text):
    """A model may come from somebody else, and name any file of whoever runs it."""
    path = tmp_path / "shadow"
    path.write_text(text)
    with pytest.raises(AssessmentError, match=r"line [12]") as caught:
        read_spectrum(path, unit="g", damping=0.05)
    assert "secret" not in str(caught.value)


modes = st.builds(
    Mode,
    period=st.floats(0.1, 1.0),
    participation=st.floats(0.2, 1.5),
    shape=st.floats(-1.0, 1.0).filter(lambda x: abs(x) > 0.05),
    damping=st.floats(0.02, 0.2),
)


@given(ntc, st.lists(modes, min_size=1, max_size=3), dampings)
def test_floor_spectra(ground, those, damping):
    spectrum = FloorSpectrum(ground=ground, modes=tuple(those))
    # (C7.2.6) at T = 0 gives a_Z, (C7.2.8)
    assert float(spectrum.sa(0.0, damping)) == pytest.approx(spectrum.acceleration, rel=1e-12)
    single = [FloorSpectrum(ground=ground, modes=(mode,)) for mode in those]
    short = 0.9 * those[0].period
    assert float(spectrum.sa(short, damping)) == pytest.approx(
        math.sqrt(sum(float(one._of_mode(np.array(short), damping, one.modes[0])) ** 2
                      for one in single)), rel=1e-12,
    )  # fmt: skip
    beyond = np.linspace(those[0].period * 1.001, 8.0, 40)
    assert (spectrum.sa(beyond, damping) >= ground.sa(beyond, damping) * (1 - 1e-12)).all()
    # (C8.7.1.12): above b T_1 not less than at b T_1 with the acceleration of T_1
    least = (
        float(spectrum.sa(those[0].period, damping)) * (1.1 * those[0].period / 2 / math.pi) ** 2
    )
    far = beyond[beyond > 1.1 * those[0].period]
    assert (spectrum.sd(far, damping) >= least * (1 - 1e-12)).all()


def test_plateau_of_a_floor():
    mode = Mode(period=0.4, participation=1.2, shape=0.5, damping=0.05)
    ground = ntc_of("B", 0.2)
    spectrum = FloorSpectrum(ground=ground, modes=(mode,))
    floor = float(ground.sa(0.4, 0.05)) * 0.6 * math.sqrt(1 + 0.0004 * 25)
    plateau = 1.1 * 0.05**-0.5 * floor
    assert spectrum.sa([0.321, 0.4, 0.439], 0.05) == pytest.approx(plateau, rel=1e-12)
    # T = 2 b T_1: 1 + (A - 1) 1 = A
    assert float(spectrum.sa(0.88, 0.05)) == pytest.approx(
        max(floor, float(ground.sa(0.88, 0.05))), rel=1e-12
    )


def test_what_a_floor_needs():
    with pytest.raises(AssessmentError, match="storeys"):
        first_mode(height=3.0, building_height=9.0, damping=0.05)
    with pytest.raises(AssessmentError, match="above the building"):
        first_mode(height=10.0, building_height=9.0, damping=0.05, storeys=3)
    mode, said = first_mode(
        height=3.0, building_height=9.0, damping=0.05, participation=1.3, shape=0.4, period=0.3
    )
    assert mode == Mode(period=0.3, participation=1.3, shape=0.4, damping=0.05) and said == ()


def test_a_motion_of_its_own_has_no_return_period_of_another():
    """That of [site] was taken for the SLD, whose motion was then said to be missing."""
    keys = {"ag": 0.172, "F0": 2.458, "TC_star": 0.285, "soil": "B", "topography": "T1"}
    site = Site(
        code="ntc2018",
        values={**keys, "nominal_life": 50.0, "use": "II", "return_period": 475.0},
        states={"SLD": {"ag": 0.062, "F0": 2.52, "TC_star": 0.27}},
    )
    spectra = spectra_of_site(site)
    assert spectra["SLV"].return_period == 475.0
    assert spectra["SLD"].return_period == pytest.approx(return_period(50.0, "SLD"))
    assert missing_motions(motions_asked(site, ("SLD", "SLV"))) == ()
