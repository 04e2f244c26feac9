"""[site] and [assessment] of model files, and the spectra made of a site."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from test_modelfile import GOOD

from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import METHODS
from drystone.assessment.methods.base import Settings
from drystone.assessment.site import spectra_of_site
from drystone.assessment.spectra.ec8 import Ec8Spectrum
from drystone.assessment.spectra.floor import FloorSpectrum
from drystone.assessment.spectra.ntc2018 import NtcSpectrum
from drystone.io.modelfile import ModelError, read_model, write_model
from drystone.io.modelfile.assessing import AssessmentSection
from drystone.model.assembly import GRAVITY
from drystone.model.site import AssessmentInput, Site
from sites import SITE

OF_SLD = """
[site.SLD]
ag = 0.07
F0 = 2.5
TC_star = 0.27
"""
ASSESSMENT = """
[assessment]
method = "ntc2018-local"
confidence_factor = 1.35
damping = { SD = 5.0 }

[[assessment.record]]
file = "motion.csv"
unit = "g"
"""


def read(tmp_path: Path, text: str, name: str = "model.toml"):
    path = tmp_path / name
    path.write_text(GOOD + text)
    return read_model(path)


def test_what_a_file_says_is_kept_as_it_says_it(tmp_path):
    model = read(tmp_path, SITE + OF_SLD + ASSESSMENT)
    assert model.site.code == "ntc2018" and model.site.values["ag"] == 0.172
    assert model.site.states == {"SLD": {"ag": 0.07, "F0": 2.5, "TC_star": 0.27}}
    assert model.site.folder == str(tmp_path)
    assert model.assessment.values["damping"] == {"SD": 5.0}
    assert "reading" not in model.assessment.values  # nothing is filled in
    assert read(tmp_path, "").site is None and read(tmp_path, "").assessment is None


def test_they_are_written_back_and_the_files_they_name_are_found_from_elsewhere(tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "motion.csv").write_text("t,a\n0.0,0.1\n0.1,0.2\n")
    model = read(tmp_path, SITE + OF_SLD + ASSESSMENT)
    for name in ("again.toml", "again.json"):
        path = tmp_path / "other" / name
        write_model(model, path)
        again = read_model(path)
        assert (again.site.values, again.site.states) == (model.site.values, model.site.states)
        (record,) = again.assessment.values["record"]
        assert record["file"] == "motion.csv"  # a copy, as a model names files of its folder alone
        copy = tmp_path / "other" / "motion.csv"
        assert copy.read_bytes() == (tmp_path / "motion.csv").read_bytes()


def test_a_copy_takes_no_other_files_place(tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "motion.csv").write_text("t,a\n0.0,0.1\n0.1,0.2\n")
    (tmp_path / "other" / "motion.csv").write_text("somebody else's")
    write_model(read(tmp_path, SITE + ASSESSMENT), tmp_path / "other" / "again.toml")
    (record,) = read_model(tmp_path / "other" / "again.toml").assessment.values["record"]
    assert record["file"] == "motion-2.csv"
    assert (tmp_path / "other" / "motion.csv").read_text() == "somebody else's"


def test_a_varied_model_keeps_them_and_no_curve_depends_on_them(tmp_path):
    model = read(tmp_path, SITE)
    varied = model.with_joint(friction_coefficient=0.5)
    assert varied.site == model.site
    moved = replace(varied, site=None)
    assert moved.sha256 == varied.sha256  # the digest is that of what curves depend on
    assert replace(model, site=None).source is None  # but it is not what the file holds


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[site]\ncode = "ntc2018"\nagg = 0.1\n', 'site: unknown key "agg": did you mean "ag"?'),
        ('[site]\ncode = "ntc2018"\nground = "A"\n', 'ground is no key of code = "ntc2018"'),
        ('[site]\ncode = "ec8"\n[site.SD]\nsoil = "A"\n', 'SD.soil is no key of code = "ec8"'),
        ('[site]\ncode = "ec8"\nag = -0.1\n', "site.ag: must be greater than 0"),
        ('[site]\ncode = "ec8"\nag = 98.1\n', "site.ag: must be at most 10"),  # m/s2 for g
        ('[site]\ncode = "ec8"\nimportance = "V"\n', 'must be a class "I" to "IV"'),
        ("[site]\nag = 0.1\n", "site: code is missing"),
        ('[site]\ncode = "csv"\nunit = "gal"\n', "site.unit: must not be"),
        ('[assessment]\nmetod = "x"\n', 'unknown key "metod": did you mean "method"?'),
        ("[assessment]\nconfidence_factor = 0.9\n", "must be at least 1"),
        ("[assessment]\ndamping = { SLX = 5.0 }\n", "SLX"),
        ("[[assessment.record]]\nunit = 'g'\n", "file is missing"),
    ],
)
def test_wrong_keys_are_told_with_their_place_and_mend(tmp_path, text, said):
    with pytest.raises(ModelError) as caught:
        read(tmp_path, text)
    assert said in str(caught.value)


class TestSpectra:
    def test_one_motion_serves_for_every_state(self, tmp_path):
        spectrum = spectra_of_site(read(tmp_path, SITE).site)
        expected = NtcSpectrum(
            ground_acceleration=0.172 * GRAVITY,
            amplification=2.458,
            reference_corner=0.285,
            soil="B",
            topography="T1",
        )
        assert spectrum == expected

    def test_states_take_from_the_site_what_they_leave_out(self, tmp_path):
        spectra = spectra_of_site(read(tmp_path, SITE + OF_SLD).site)
        assert sorted(spectra) == ["SD", "SLD", "SLV"]  # the site's own is that of 475 years
        assert spectra["SLD"].ground_acceleration == pytest.approx(0.07 * GRAVITY)
        assert spectra["SLD"].soil == "B" and spectra["SLV"].ground_acceleration > 1.6

    def test_states_alone_are_the_only_ones(self):
        values = {"F0": 2.5, "TC_star": 0.3, "soil": "A", "topography": "T1"}
        site = Site(code="ntc2018", values=values, states={"SLV": {"ag": 0.2}})
        assert list(spectra_of_site(site)) == ["SLV"]

    def test_return_periods_follow_from_the_life(self):
        values = {"ag": 0.1, "F0": 2.5, "TC_star": 0.3, "soil": "A", "topography": "T1"}
        site = Site(code="ntc2018", values={**values, "nominal_life": 50.0, "use": "III"})
        # V_R = 50 x 1.5 = 75 years, 10 %: 712 years.
        assert spectra_of_site(site).return_period == pytest.approx(712, abs=0.5)

    def test_eurocode_carries_the_motion_to_other_return_periods(self):
        values = {"ag": 0.1, "type": 1, "ground": "B", "importance": "II"}
        states = {"NC": {"return_period": 2475.0}, "DL": {"ag": 0.06}}
        spectra = spectra_of_site(Site(code="ec8", values=values, states=states))
        assert isinstance(spectra["SD"], Ec8Spectrum)
        # a_g goes with the cube root of the return period, EN 1998-1:2004 2.1(4).
        assert spectra["NC"].ground_acceleration == pytest.approx(
            0.1 * GRAVITY * (2475 / 475) ** (1 / 3)
        )
        assert spectra["DL"].ground_acceleration == pytest.approx(0.06 * GRAVITY)

    def test_states_of_eurocode_have_their_return_periods(self):
        values = {"ag": 0.1, "type": 1, "ground": "B", "importance": "III"}
        spectra = spectra_of_site(Site(code="ec8", values=values))
        # EN 1998-3:2004 2.1(3)P, 225, 475 and 2475 years; gamma_I = 1.2 of class III.
        assert sorted(spectra) == ["", "DL", "NC", "SD", "SLV"]
        for name, years in (("DL", 225.0), ("SD", 475.0), ("NC", 2475.0)):
            own = Ec8Spectrum.of_reference(
                0.1 * GRAVITY, importance="III", spectrum_type=1, ground="B", return_period=years
            )
            assert spectra[name].return_period == years
            assert spectra[name].sa(0.7, 0.05) == own.sa(0.7, 0.05)
        found = {name: s.ground_acceleration / (0.12 * GRAVITY) for name, s in spectra.items()}
        assert found["DL"] == pytest.approx((225 / 475) ** (1 / 3))
        assert found["SD"] == found["SLV"] == found[""] == pytest.approx(1.0)
        assert found["NC"] == pytest.approx((2475 / 475) ** (1 / 3))
        assert "DL is judged under the ground motion of 225 years" in spectra["DL"].notes[0]

    def test_tables_and_return_periods_go_before_those_of_eurocode(self):
        values = {"ag": 0.1, "type": 1, "ground": "B", "importance": "II"}
        one = spectra_of_site(Site(code="ec8", values={**values, "return_period": 475.0}))
        assert isinstance(one, Ec8Spectrum) and one.return_period == 475.0
        states = {"NC": {"ag": 0.15}, "DL": {"ag": 0.06, "return_period": 95.0}}
        spectra = spectra_of_site(Site(code="ec8", values=values, states=states))
        assert spectra["NC"].ground_acceleration == pytest.approx(0.15 * GRAVITY)
        assert spectra["NC"].return_period is None  # not said of which
        assert spectra["DL"].ground_acceleration == pytest.approx(0.06 * GRAVITY)
        assert spectra["DL"].return_period == 95.0
        alone = Site(code="ec8", values={**values}, states={"SLV": {"ag": 0.2}})
        assert sorted(spectra_of_site(alone)) == ["DL", "NC", "SD", "SLV"]

    def test_a_table_lies_beside_the_model_file(self, tmp_path):
        (tmp_path / "spectrum.csv").write_text("T,Se\n0,0.2\n0.2,0.5\n2.0,0.1\n")
        site = '[site]\ncode = "csv"\nfile = "spectrum.csv"\nunit = "g"\ndamping = 5.0\n'
        spectrum = spectra_of_site(read(tmp_path, site).site)
        assert float(spectrum.sa(0.1, 0.05)) == pytest.approx(0.35 * GRAVITY)
        with pytest.raises(AssessmentError, match="nothing\\.csv"):
            broken = site.replace("spectrum.csv", "nothing.csv")
            spectra_of_site(read(tmp_path, broken).site)

    def test_a_height_lifts_it(self, tmp_path):
        floor = "[site.floor]\nheight = 6.0\nbuilding_height = 9.0\nstoreys = 3\ndamping = 5.0\n"
        spectrum = spectra_of_site(read(tmp_path, SITE + floor).site)
        assert isinstance(spectrum, FloorSpectrum)
        # T_1 = 0.05 9^0.75 = 0.2598 s, gamma_1 = 9/7, psi_1 = 2/3.
        mode = spectrum.modes[0]
        assert (mode.period, mode.participation, mode.shape) == pytest.approx(
            (0.25981, 9 / 7, 2 / 3), rel=1e-4
        )

    @pytest.mark.parametrize("key", ["ag", "F0", "TC_star", "soil", "topography"])
    def test_what_is_missing_is_named(self, key):
        values = {"ag": 0.1, "F0": 2.5, "TC_star": 0.3, "soil": "A", "topography": "T1"}
        del values[key]
        with pytest.raises(AssessmentError, match=f"site: {key} is missing: give"):
            spectra_of_site(Site(code="ntc2018", values=values))


def test_every_setting_of_methods_is_a_key_of_the_file():
    keys = set(AssessmentSection.model_fields)
    given = {field.name for field in fields(Settings)} - {"records", "pulses", "own"}
    assert given <= keys
    own = {"grouping", "language", "opposite", "parts_that_may_fall", "record", "pulse"}
    assert keys - given == own


def test_a_key_of_several_methods_is_the_same_in_all():
    declared = {}
    for name, method in METHODS.own():
        assert name == method.NAME
        for key in method.KEYS:
            assert declared.setdefault(key.name, key) == key


def test_records_are_equal_by_what_they_say():
    assert AssessmentInput(values={"method": "asce41"}) == AssessmentInput(
        values={"method": "asce41"}
    )
    assert np.all(Site(code="ec8").as_dict() == {"code": "ec8"})


@pytest.mark.parametrize(
    "name", ["../motion.csv", "/etc/passwd", "a/../../b.csv", "link.csv", "a\\u0000"]
)
@pytest.mark.parametrize("place", ["site", "site.SLD", "assessment.record[1]", "import[1]"])
def test_files_outside_of_the_folder_are_not_named(tmp_path, name, place):
    """A model of somebody else names no file of whoever runs it."""
    (tmp_path / "model").mkdir()
    (tmp_path / "motion.csv").write_text("T,Se\n0.0,0.1\n1.0,0.2\n")
    (tmp_path / "model" / "link.csv").symlink_to(tmp_path / "motion.csv")
    unit = 'unit = "g"\n'
    table = {
        "site": f'[site]\ncode = "csv"\nfile = "{name}"\n{unit}damping = 5.0\n',
        "site.SLD": f'[site]\ncode = "csv"\n[site.SLD]\nfile = "{name}"\n',
        "assessment.record[1]": f'[[assessment.record]]\nfile = "{name}"\n{unit}',
        "import[1]": f'[[import]]\nfile = "{name}"\nformat = "obj"\nunit = "m"\n',
    }[place]
    with pytest.raises(
        ModelError, match=r"lies outside of the model file's folder|is not the path of a file"
    ) as told:
        read(tmp_path / "model", table)
    assert place in str(told.value)
