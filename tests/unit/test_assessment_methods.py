"""Methods of assessment: capacities are inverses of demands, and what does not apply is refused."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from drystone.assessment.bilinear import Bilinear
from drystone.assessment.capacity import Capacity, Change, participation
from drystone.assessment.checks import atc40, fema440
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import (
    METHODS,
    Settings,
    asce41,
    assess,
    en1998_3_2025_rocking,
    ntc2009_local,
    ntc2018_global,
    ntc2018_local,
)
from drystone.assessment.methods.ground import bearable
from drystone.assessment.methods.inelastic import EC8_MOST, inelastic_displacement, target
from drystone.assessment.spectra import Ec8Spectrum, FloorSpectrum, Mode, NtcSpectrum, TableSpectrum
from drystone.model.assembly import GRAVITY

MODE = Mode(period=0.35, participation=1.2, shape=0.6, damping=0.08)

ntc = st.builds(
    NtcSpectrum,
    ground_acceleration=st.floats(0.1, 5.0),
    amplification=st.floats(2.2, 3.0),
    reference_corner=st.floats(0.2, 0.5),
    soil=st.sampled_from("ABCDE"),
    topography=st.sampled_from(["T1", "T2", "T3", "T4"]),
)
ec8 = st.builds(
    Ec8Spectrum,
    ground_acceleration=st.floats(0.1, 5.0),
    spectrum_type=st.sampled_from([1, 2]),
    ground=st.sampled_from("ABCDE"),
)
grounds = ntc | ec8
places = grounds | st.builds(FloorSpectrum, ground=grounds, modes=st.just((MODE,)))


def site(acceleration=0.2, soil="B"):
    return NtcSpectrum(
        ground_acceleration=acceleration * GRAVITY,
        amplification=2.5,
        reference_corner=0.3,
        soil=soil,
        topography="T1",
    )


def rocking_wall(multiplier=0.1, collapse=0.4, ratio=0.9):
    """Rigid until it rocks; one body where the ratio is 1."""
    mass = 1000.0
    shape = [0.5, 0.5 * (1 - math.sqrt(1 / ratio - 1))] if ratio < 1 else [0.5, 0.5]
    part = participation([mass, mass], shape)
    return Capacity.straight(multiplier, collapse, part, reading="base_shear")


def pier(top=0.4, peak=0.004, end=0.12):
    """An elastic branch, a level one, and a straight way down to nothing."""
    part = participation([4000.0, 4000.0, 4000.0], [1 / 3, 2 / 3, 1.0])
    return Capacity.of(
        [0.0, peak, 0.25 * end, end], [0.0, top, top, 0.0], part, reading="base_shear"
    )


def local(**values):
    return Settings.of(**{"method": "ntc2018-local", "confidence_factor": 1.35, **values})


FULL = {
    "ntc2018-local": {"confidence_factor": 1.35},
    "ntc2009-local": {"confidence_factor": 1.35},
    "ntc2018-global": {},
    "ec8-n2": {},
    "en1998-3-2025-rocking": {
        "damping": {"SD": 0.05, "NC": 0.05},
        "demand_factor": 1.15,
        "knowledge_level": 2,
        "infinitely_strong_blocks": True,
        "elastic_period": 0.0,
    },
    "asce41": {"site_class": "C", "effective_mass_factor": 1.0, "near_fault": False,
               "displacement_limits": {"CP": 0.05}},
}  # fmt: skip

KEYS = {
    "method", "reading", "activation_multiplier", "participating_mass_ratio", "participating_mass",
    "participation_factor", "activation_acceleration", "collapse_displacement", "safety_index",
    "satisfied", "limit_states",
}  # fmt: skip
STATE_KEYS = {
    "limit_displacement", "limit_acceleration", "limit_period", "displacement_demand",
    "ground_acceleration_capacity", "ground_acceleration_demand", "satisfied",
}  # fmt: skip


# The ground acceleration that is borne ---------------------------------------------------------


@settings(max_examples=40)
@given(places, st.floats(0.0, 6.0), st.floats(0.02, 0.2), st.floats(1e-4, 1.0))
def test_what_is_borne_is_the_first_inverse_of_the_demand(spectrum, period, damping, limit):
    def demand(s):
        return float(s.sd(period, damping)) + 0.01 * float(s.sa(0.0, damping))

    found = bearable(spectrum, demand, limit)
    # S falls between its clips and T_D > T_E may jump: nothing below reaches the limit
    assert demand(spectrum.scaled(found)) >= limit * (1 - 1e-9)
    below = np.linspace(0.0, found, 60)[1:-1]
    assert max(demand(spectrum.scaled(a)) for a in below) < limit * (1 + 1e-9)
    if isinstance(spectrum, Ec8Spectrum):
        # nothing moves with a_g: in proportion
        assert found == pytest.approx(
            spectrum.ground_acceleration * limit / demand(spectrum), rel=1e-9
        )


@pytest.mark.parametrize(
    ("limit", "root"),
    # soil D: x S_S(x) with x = F_0 a_g/g is 2.4 x - 1.5 x^2 between its clips, 0.96 at x = 0.8 and
    # 0.9 at x = 1, and 0.9 x beyond: the first of three crossings, and the summit itself
    [(0.93, (2.4 - math.sqrt(5.76 - 5.58)) / 3.0), (0.9599999, 0.79974), (0.97, 0.97 / 0.9)],
)
def test_first_of_several_crossings(limit, root):
    spectrum = site(0.1, soil="D")
    level = limit * GRAVITY / 2.5
    found = bearable(spectrum, lambda s: float(s.sa(0.0, 0.05)), level)
    assert found * 2.5 / GRAVITY == pytest.approx(root, abs=1e-5)


def test_a_demand_that_never_comes_is_none():
    assert bearable(site(), lambda s: 1.0, 2.0) is None
    assert bearable(site(), lambda s: 1.0, 0.0) == 0.0


# Local mechanisms -------------------------------------------------------------------------------


@settings(max_examples=12)
@given(places, st.floats(0.03, 0.3), st.floats(0.1, 2.0), st.floats(0.6, 1.0), st.floats(1.0, 1.5))
def test_local_capacities_meet_their_demands(spectrum, multiplier, collapse, ratio, factor):
    capacity = rocking_wall(multiplier, collapse, ratio)
    for method in ("ntc2018-local", "ntc2009-local"):
        found = assess(capacity, spectrum, local(method=method, confidence_factor=factor))
        for state in found.limit_states:
            borne = state.details.get(
                "ground_acceleration_of_displacement", state.ground_acceleration_capacity
            )
            there = assess(
                capacity, spectrum.scaled(borne), local(method=method, confidence_factor=factor)
            ).state(state.name)
            if state.limit_displacement is None:
                assert there.acceleration_demand == pytest.approx(
                    state.limit_acceleration, rel=1e-8
                )
            else:
                assert there.displacement_demand >= state.limit_displacement * (1 - 1e-8)
            # margins are told alike by accelerations and by displacements where nothing moves
            if isinstance(spectrum, Ec8Spectrum):
                activated = state.governed_by == "activation" and state.limit_displacement
                holds = state.safety_index >= 1.0
                assert activated or state.satisfied == holds or abs(state.safety_index - 1) < 1e-9


@settings(max_examples=10)
@given(st.floats(0.05, 0.3), st.floats(0.2, 2.0))
def test_periods_of_the_codes_are_shares_of_the_secant_period(multiplier, collapse):
    capacity = rocking_wall(multiplier, collapse, 1.0)
    found = assess(capacity, site(), local(confidence_factor=1.0))
    for name, share, of_end in (("SLV", 0.84, 0.4), ("SLC", 0.78, 0.6)):
        state = found.state(name)
        d = of_end * capacity.spectral_collapse_displacement
        assert state.limit_period == pytest.approx(share * capacity.secant_period(d), rel=1e-12)


def test_one_body_cut_in_courses():
    """A body that is one and the same in any number of courses is judged alike, cut it is not."""
    verdicts = []
    for n in (1, 2, 5, 20):
        mass, shape = np.full(n, 3600.0 / n), (np.arange(n) + 0.5) / n
        together = participation([mass.sum()], [mass @ shape / mass.sum()])
        capacity = Capacity.straight(0.125, 0.5, together, reading="base_shear")
        verdicts.append(assess(capacity, site(0.15), local()).safety_index)
    assert verdicts == pytest.approx([verdicts[0]] * 4, rel=1e-12)
    # T is the same and d0 a0 grow by 1/e* = 99/75 each: so does a_g
    apart = participation(np.full(5, 720.0), (np.arange(5) + 0.5) / 5)
    cut = Capacity.straight(0.125, 0.5, apart, reading="base_shear")
    spectrum = Ec8Spectrum(ground_acceleration=1.5, spectrum_type=1, ground="B")
    one = Capacity.straight(0.125, 0.5, participation([3600.0], [0.5]), reading="base_shear")
    ratio = (
        assess(cut, spectrum, local()).safety_index / assess(one, spectrum, local()).safety_index
    )
    assert ratio == pytest.approx(99 / 75, rel=1e-9)


def test_what_breaks_first_limits():
    capacity = rocking_wall(ratio=1.0)  # Gamma = 2, d0* = 0.2
    free = assess(capacity, site(), local())
    held = assess(capacity, site(), local(displacement_limits={"SLV": 0.06}))
    assert free.state("SLV").limit_displacement == pytest.approx(0.08)
    assert held.state("SLV").limit_displacement == pytest.approx(0.03)
    assert held.state("SLV").limit_control_displacement == pytest.approx(0.06)
    assert held.state("SLV").governed_by == "local displacement limit"
    assert "displacement limit" in held.sentence


def test_a_tie_that_breaks_ends_the_slv():
    part = participation([1000.0], [1.0])

    def tied(after, width=0.001, losses=None):
        return Capacity.of(
            [0.0, 0.0195, 0.02, 0.02 + width, 0.3],
            [0.3, 0.28, 0.28, after, 0.0],
            part,
            reading="base_shear",
            losses=losses,
        )

    broken = assess(tied(0.12), site(), local()).state("SLV")
    assert broken.limit_displacement == pytest.approx(0.02)
    assert broken.limit_acceleration == pytest.approx(0.28 * GRAVITY / 1.35)
    assert "sudden loss" in broken.details["limit_set_by"]
    # However far the next point at rest is, where the tie is known to break before it.
    jumped = tied(0.12, width=0.01, losses=[(0.02, 'the tie "rod" breaks')])
    assert assess(jumped, site(), local()).state("SLV").limit_displacement == pytest.approx(0.02)
    # less than half of 0.3, and as much in ten times the way
    for other in (tied(0.14), tied(0.12, width=0.01)):
        assert assess(other, site(), local()).state("SLV").limit_displacement == pytest.approx(0.12)


def tied(place=0.02, lost=True, **values):
    """A wall of 0.1 (1 - d/0.4) with a tie that adds 0.2 until it breaks, or from where it yields
    on."""
    what = f'at {place:g} m: the tie "rod" ' + ("breaks" if lost else "yields")
    d = np.array([0.0, place, place * (1 + 1e-9), 0.4])
    x = 0.1 * (1 - d / 0.4) + ([0.2, 0.2, 0.0, 0.0] if lost else [0.0, 0.2, 0.2, 0.2])
    part = participation([4000.0], [0.5])
    given = {"collapse_displacement": 0.4, "changes": [Change(place, what, lost)], **values}
    return Capacity.of(d, x, part, reading="base_shear", **given)


@pytest.mark.parametrize("method", ["ntc2009-local", "ntc2018-local", "en1998-3-2025-rocking"])
def test_no_line_goes_over_a_tie_that_breaks(method):
    """Beyond it the curve is that of the wall without the tie; the line from the strength with it
    to that wall's collapse is of no structure."""
    state = {"ntc2009-local": "SLV", "ntc2018-local": "SLC"}.get(method, "NC")
    free = rocking_wall(ratio=1.0)

    def found(capacity, **more):
        settings = Settings.of(**{"method": method, **FULL[method], **more})
        return assess(capacity, site(), settings).state(state)

    alone = found(free, straight_capacity=False)
    assert found(tied(lost=True)).limit_period == pytest.approx(alone.limit_period, rel=1e-6)
    for lost, what in ((True, "breaks"), (False, "yields")):
        with pytest.raises(AssessmentError, match=f"forces that stay constant.*{what}.*leave out"):
            found(tied(lost=lost), straight_capacity=True)
    assert found(free, straight_capacity=True).limit_period > 0.0  # where nothing changes it is one
    beyond = tied(collapse_displacement=0.019)  # nor does what happens after the collapse count
    assert found(beyond, straight_capacity=True).limit_period > 0.0


def test_2009_says_that_the_curve_takes_the_place_of_its_line():
    asked = local(method="ntc2009-local")
    told = [note for note in assess(tied(), site(), asked).assumptions if "takes the place" in note]
    assert len(told) == 1
    assert 'the tie "rod" breaks' in told[0]
    assert 'il tirante "rod"' not in told[0].in_language("it")  # the event is as it was given
    assert "prende il posto" in told[0].in_language("it")


@pytest.mark.parametrize("method", ["ntc2009-local", "ntc2018-local"])
def test_q_does_not_stand_for_displacements_without_the_tie(method):
    asked = local(method=method, kinematics="linear")
    assert "q = 2 stands for displacements" in assess(tied(), site(), asked).sentence
    for kept in (tied(lost=False), rocking_wall()):
        assert assess(kept, site(), asked).caution == ""


def test_acceptance_displacements_of_asce41_end_where_a_tie_breaks():
    d, x = [0.0, 0.01, 0.03, 0.0300001, 0.4], [0.0, 0.4, 0.39, 0.1, 0.0]
    asked = {**FULL["asce41"], "displacement_limits": {"LS": 0.02, "CP": 0.05}}
    broken = Capacity.of(
        d,
        x,
        participation([1000.0], [1.0]),
        reading="base_shear",
        changes=[Change(0.03, 'the tie "rod" breaks', True)],
    )
    found = assess(broken, site(0.05), Settings.of(method="asce41", **asked))
    assert found.state("LS").limit_control_displacement == pytest.approx(0.02)
    assert found.state("CP").limit_control_displacement == pytest.approx(0.03)
    assert any("of CP" in note and 'the tie "rod" breaks' in note for note in found.assumptions)


def test_activation_holds_a_mechanism_that_displacements_would_not():
    # stocky and small: it starts late and falls at once
    found = assess(rocking_wall(0.5, 0.02, 1.0), site(), local())
    state = found.state("SLV")
    assert state.details["ground_acceleration_of_displacement"] < state.ground_acceleration_capacity
    assert state.ground_acceleration_capacity == found.state("SLD").ground_acceleration_capacity
    assert state.governed_by == "activation" and state.satisfied


def test_free_elements_have_a_period():
    tied = assess(rocking_wall(), site(), local()).state("SLD")
    free = assess(rocking_wall(), site(), local(elastic_period=0.2)).state("SLD")
    assert tied.acceleration_demand == pytest.approx(0.2 * GRAVITY * 1.2)
    assert free.acceleration_demand == pytest.approx(float(site().sa(0.2, 0.05)))
    zero = assess(rocking_wall(), site(), local(elastic_period=0.0)).state("SLD")
    assert zero.acceleration_demand == tied.acceleration_demand


def test_spectra_of_sites_are_looked_at_from_the_elastic_period_on():
    # a peak of displacement at 0.8 s, long before T_SLV
    spectrum = TableSpectrum(
        table_period=[0.0, 0.5, 0.8, 0.9, 4.0],
        table_acceleration=[1.0, 2.0, 9.0, 1.0, 0.05],
        table_damping=0.05,
    )
    with pytest.raises(AssessmentError, match="elastic_period"):
        assess(rocking_wall(), spectrum, local())
    found = assess(rocking_wall(), spectrum, local(elastic_period=0.0)).state("SLV")
    assert found.limit_period > 1.5
    assert found.displacement_demand == pytest.approx(float(spectrum.sd(0.8, 0.08)), rel=1e-4)
    code = assess(rocking_wall(), replace(spectrum, site_specific=False), local()).state("SLV")
    assert code.displacement_demand == pytest.approx(float(spectrum.sd(code.limit_period, 0.08)))


def test_linear_needs_no_collapse_and_nonlinear_does():
    part = participation([1000.0], [0.5])
    capacity = Capacity.of([0.0, 0.1], [0.0, 0.1], part, reading="base_shear")
    found = assess(capacity, site(), local(kinematics="linear"))
    assert found.state("SLV").ground_acceleration_capacity == pytest.approx(
        2 * found.state("SLD").ground_acceleration_capacity
    )
    for name in ("ntc2018-local", "ntc2009-local", "en1998-3-2025-rocking"):
        with pytest.raises(AssessmentError, match="does not come down"):
            assess(capacity, site(), Settings.of(method=name, **FULL[name]))


def test_2009_at_a_height_by_hand():
    spectrum = FloorSpectrum(ground=site(), modes=(MODE,))
    capacity = rocking_wall(ratio=1.0)
    found = assess(capacity, spectrum, local(method="ntc2009-local"))
    life = found.state("SLV")
    # d_s = 0.16 d0, a_s = 0.84 a0
    assert life.limit_period == pytest.approx(
        2 * math.pi * math.sqrt(0.16 * 0.2 / (0.84 * 0.1 * GRAVITY / 1.35)), rel=1e-12
    )
    ratio = life.limit_period / 0.35
    elastic = float(site().sa(0.35, 0.05)) * (0.35 / 2 / math.pi) ** 2
    assert life.displacement_demand == pytest.approx(
        elastic * 0.72 * ratio**2 / math.sqrt((1 - ratio) ** 2 + 0.02 * ratio), rel=1e-12
    )
    assert found.state("SLD").acceleration_demand == pytest.approx(
        max(float(site().sa(0.35, 0.05)) * 0.72, 0.2 * GRAVITY * 1.2)
    )


def test_2025_by_hand():
    capacity = rocking_wall(ratio=1.0)
    options = {**FULL["en1998-3-2025-rocking"], "damping": {"SD": 0.08, "NC": 0.10}}
    found = assess(capacity, site(), Settings.of(method="en1998-3-2025-rocking", **options))
    state = found.state("SD")
    period = 1.6 * math.pi * math.sqrt(0.08 / (0.6 * 0.1 * GRAVITY))
    assert state.limit_period == pytest.approx(period)
    eta = math.sqrt(10 / 13)
    assert state.displacement_demand == pytest.approx(1.15 * eta * float(site().sd(period, 0.05)))
    # KL2, strong blocks
    assert state.details["factored_limit_displacement"] == pytest.approx(0.08 / (1.4 * 1.2))
    assert state.satisfied == (state.displacement_demand <= 0.08 / 1.68)
    assert found.state("DL").limit_acceleration == pytest.approx(0.1 * GRAVITY / 1.68)
    missing = {**options, "damping": {"SD": 0.08}, "elastic_period": None}
    left = assess(capacity, site(), Settings.of(method="en1998-3-2025-rocking", **missing))
    assert [s.name for s in left.limit_states] == ["SD"]
    assert any("Left out: DL" in text for text in left.assumptions)
    assert any("not known" in text for text in left.uncertain)


@pytest.mark.parametrize(
    "key", ["demand_factor", "knowledge_level", "infinitely_strong_blocks", "damping"]
)
def test_2025_has_no_defaults(key):
    options = {**FULL["en1998-3-2025-rocking"]}
    del options[key]
    with pytest.raises(AssessmentError, match=f'needs "{key}"'):
        assess(rocking_wall(), site(), Settings.of(method="en1998-3-2025-rocking", **options))


def test_readings_side_by_side():
    capacity, spectrum = rocking_wall(ratio=0.8), Ec8Spectrum(
        ground_acceleration=1.0, spectrum_type=1, ground="A"
    )  # fmt: skip
    found = {
        reading: assess(capacity, spectrum, local(reading=reading))
        for reading in ("base_shear", "energy", "literal_ec8")
    }
    assert found["energy"].activation_acceleration == pytest.approx(
        capacity.participating_mass_ratio * found["base_shear"].activation_acceleration
    )
    assert found["energy"].capacity.reading == "energy"
    assert any("C8.7.1.3" in text for text in found["energy"].uncertain)
    assert any("control point" in text for text in found["literal_ec8"].uncertain)


# In-plane walls -----------------------------------------------------------------------------------


@settings(max_examples=40)
@given(grounds, st.floats(0.01, 0.1), st.floats(0.5, 8.0), st.floats(0.3, 8.0))
def test_n2_inverse_in_closed_form(spectrum, start, level, ductility):
    curve = Bilinear(
        yield_displacement=start, yield_acceleration=level, ultimate_displacement=start * ductility
    )
    spectrum = spectrum.scaled(0.5)
    for most in (EC8_MOST, None):

        def moved(s, most=most):
            return target(s, curve, most).displacement

        found = bearable(spectrum, moved, start * ductility)
        there = target(spectrum.scaled(found), curve, most)
        assert there.displacement == pytest.approx(start * ductility, rel=1e-9)
        assume(isinstance(spectrum, Ec8Spectrum) and curve.period < spectrum.shape.long_period)
        ratio = curve.period / spectrum.corner_period
        if ratio >= 1 or ductility <= 1:
            q = ductility
        else:
            q = 1 + (ductility - 1) * ratio
            if most:
                q = max(q, ductility / most)
        borne = spectrum.ground_acceleration * q * level / float(spectrum.sa(curve.period, 0.05))
        assert found == pytest.approx(borne, rel=1e-9)


@pytest.mark.parametrize(
    ("ratio", "period", "most", "expected"),
    [
        (0.8, 0.2, None, 1.0),  # elastic
        (4.0, 0.6, None, 1.0),  # beyond T_C
        (3.0, 0.2, None, 2.0),
        (3.0, 0.05, 3.0, 3.0),  # (1 + 2 x 10)/3 = 7
        (3.0, 0.05, None, 7.0),
    ],
)
def test_inelastic_displacements(ratio, period, most, expected):
    assert inelastic_displacement(1.0, ratio, period, 0.5, most) == pytest.approx(expected)


def test_limit_states_of_walls():
    capacity = pier()
    # 80 per cent of the peak: 0.03 + 0.2 x 0.09 m at the control point
    end = capacity.spectral_at(0.048)
    n2 = assess(capacity, site(), Settings.of(method="ec8-n2"))
    assert n2.state("NC").limit_displacement == pytest.approx(end)
    assert n2.state("SD").limit_displacement == pytest.approx(0.75 * end)
    assert n2.state("DL").limit_displacement == pytest.approx(n2.bilinear.yield_displacement)
    whole = assess(capacity, site(), Settings.of(method="ntc2018-global"))
    assert whole.state("SLC").limit_displacement == pytest.approx(end)
    assert whole.state("SLV").limit_displacement == pytest.approx(0.75 * end)
    assert whole.state("SLD").limit_displacement == pytest.approx(whole.bilinear.yield_displacement)
    assert whole.state("SLO").limit_displacement == pytest.approx(
        2 / 3 * whole.bilinear.yield_displacement
    )
    drift = Settings.of(method="ntc2018-global", displacement_limits={"SLC": 0.02})
    assert assess(capacity, site(), drift).state("SLV").limit_control_displacement == pytest.approx(
        0.015
    )


def test_strength_ratio_limits_the_ground_acceleration():
    stiff = pier(top=0.1, peak=0.0005, end=1.0)
    found = assess(stiff, site(), Settings.of(method="ntc2018-global")).state("SLV")
    assert found.governed_by == "q* = 3"
    assert found.ground_acceleration_capacity < found.details["ground_acceleration_of_displacement"]
    there = site().scaled(found.ground_acceleration_capacity)
    curve = assess(stiff, site(), Settings.of(method="ntc2018-global")).bilinear
    assert target(there, curve).strength_ratio == pytest.approx(3.0, rel=1e-9)
    assert found.satisfied == (found.details["strength_ratio"] <= 3.0 and found.safety_index >= 1)


@settings(max_examples=6)
@given(st.floats(0.05, 0.5), st.sampled_from(["high", "moderate", "low"]))
def test_procedure_b_meets_the_reduced_spectrum(acceleration, kind):
    capacity, spectrum = pier(top=0.25), site(acceleration)
    chosen = Settings.of(method="ntc2018-global", procedure="B", dissipation=kind)
    found = assess(capacity, spectrum, chosen)
    state = found.state("SLV")
    factor = ntc2018_global.DISSIPATION[kind]
    stiffness = 0.25 * capacity.acceleration_factor / capacity.spectral_at(0.004)

    def asked(s, d):
        # (C7.3.10) by hand on the elastic-plastic part, where the bilinear is the curve
        level = 0.25 * capacity.acceleration_factor
        start = level / stiffness
        damping = 0.05 + 0.637 * factor * max(1 - start / d, 0.0)
        value = min(stiffness * d, level)
        return float(s.sd(2 * math.pi * math.sqrt(d / value), damping))

    plastic = capacity.spectral_at(0.03)
    if state.displacement_demand is not None and state.displacement_demand < plastic:
        assert asked(spectrum, state.displacement_demand) == pytest.approx(
            state.displacement_demand, rel=1e-6
        )
    damage = found.state("SLD")
    if damage.limit_displacement < plastic:
        there = spectrum.scaled(damage.ground_acceleration_capacity)
        assert asked(there, damage.limit_displacement) == pytest.approx(
            damage.limit_displacement, rel=1e-6
        )


def test_what_does_not_apply_to_walls_is_refused():
    part = participation([4000.0], [0.5])
    short = Capacity.of([0.0, 0.004, 0.02], [0.0, 0.4, 0.35], part, reading="base_shear")
    for name in ("ec8-n2", "ntc2018-global"):
        with pytest.raises(AssessmentError, match="not past 80%"):
            assess(short, site(), Settings.of(method=name))
    for name, state in (("ec8-n2", "NC"), ("ntc2018-global", "SLC")):
        found = assess(short, site(), Settings.of(method=name, displacement_limits={state: 0.015}))
        assert found.limit_states[-1].limit_control_displacement == pytest.approx(0.015)
    with pytest.raises(AssessmentError, match="rigid"):
        assess(rocking_wall(), site(), Settings.of(method="ntc2018-global"))
    with pytest.raises(AssessmentError, match="begins at its peak"):
        assess(rocking_wall(), site(), Settings.of(method="asce41", **FULL["asce41"]))
    with pytest.raises(AssessmentError, match="dissipation"):
        assess(pier(), site(), Settings.of(method="ntc2018-global", procedure="B"))


# ASCE 41, FEMA 440, ATC-40 ------------------------------------------------------------------------


def test_asce41_refuses_where_strength_falls_too_fast():
    weak = pier(top=0.05, peak=0.004, end=0.02)
    with pytest.raises(AssessmentError, match="mu_strength"):
        assess(weak, site(0.6), Settings.of(method="asce41", **FULL["asce41"]))
    far = Settings.of(method="asce41", **{**FULL["asce41"], "displacement_limits": {"CP": 5.0}})
    found = assess(pier(), site(0.05), far)
    state = found.state("CP")
    assert state.satisfied is True and found.state("IO").satisfied is None
    # what is borne is where the method ends, before the displacement is met
    assert state.governed_by == "mu_max of (7-32)"
    there = site().scaled(0.999 * state.ground_acceleration_capacity)
    near = assess(pier(), there, far).state("CP")
    ratio = near.details["strength_ratio"] / near.details["largest_strength_ratio"]
    assert ratio == pytest.approx(1.0, abs=0.01)


def test_both_procedures_of_the_ntc_stand_on_one_first_branch(monkeypatch):
    """A drift limit before the peak: B took the branch of the whole curve, 911 against 558 1/s2."""
    capacity = Capacity.of(
        [0.0, 0.001, 0.002, 0.004, 0.008, 0.016, 0.03, 0.06, 0.1],
        [0.0, 0.10, 0.15, 0.2, 0.26, 0.32, 0.36, 0.30, 0.1],
        participation([1000.0, 1000.0], [1.0, 0.5]),
        reading="base_shear",
        collapse_displacement=0.12,
    )
    taken, made = [], ntc2018_global._procedure_b

    def seen(capacity, stiffness, *others):
        taken.append(stiffness)
        return made(capacity, stiffness, *others)

    monkeypatch.setattr(ntc2018_global, "_procedure_b", seen)
    own = {"procedure": "B", "dissipation": "low"}
    settings = Settings.of(method="ntc2018-global", displacement_limits={"SLC": 0.008}, **own)
    found = assess(capacity, site().scaled(0.05 * GRAVITY), settings).bilinear
    assert found is not None
    first = found.yield_acceleration / found.yield_displacement
    assert taken == [pytest.approx(first, rel=1e-12)]
    assert first == pytest.approx((2.0 * math.pi / found.period) ** 2, rel=1e-9)


@pytest.mark.parametrize("mass_factor", [1.0, 0.8])
def test_asce41_takes_the_base_shear_over_the_weight(mass_factor):
    """mu = S_a C_m / lambda_y, (7-31); a* = lambda g / e* counted e* once more."""
    part = participation([1000.0, 1000.0, 1000.0], [1.0, 0.6, 0.2])
    capacity = Capacity.of(
        [0.0, 0.002, 0.03, 0.06, 0.1, 0.3],
        [0.0, 0.25, 0.252, 0.22, 0.15, 0.0],
        part,
        reading="base_shear",
    )
    own = {"site_class": "C", "effective_mass_factor": mass_factor}
    settings = Settings.of(method="asce41", limit_states=("CP",), **own)
    found = assess(capacity, site(), settings)
    assert found.bilinear is not None
    multiplier = found.bilinear.yield_acceleration / capacity.acceleration_factor
    level = site().sa(found.bilinear.period, 0.05) / GRAVITY
    ratio = found.state("CP").details["strength_ratio"]
    assert ratio == pytest.approx(level * mass_factor / multiplier, rel=1e-9)


def test_asce41_by_hand():
    # h = 1 + 0.15 ln 0.3 = 0.8194, |-0.05|^-h/4 = 2.910
    assert asce41.largest_strength_ratio(0.03, 0.01, -0.05, 0.3) == pytest.approx(5.910, abs=1e-3)
    # T_e below 0.2 s counts as 0.2 s in C_1: 1 + 2/(130 0.04)
    assert asce41.ductility_coefficient(3.0, 0.1, "B") == pytest.approx(1 + 2 / 5.2)
    assert asce41.ductility_coefficient(3.0, 1.1, "B") == 1.0
    assert asce41.degradation_coefficient(3.0, 0.71) == 1.0
    factors = [asce41.storeys_shape_factor(n) for n in (1, 2, 4, 10, 20)]
    assert factors == pytest.approx([1.0, 1.2, 1.35, 1.5, 1.5])


def test_fema440_by_hand():
    # mu = 2: 4.9 - 1.1 + 5 per cent, 1 + 0.2 - 0.038
    found = fema440.effective(2.0)
    assert found.damping == pytest.approx(0.088)
    assert found.period_ratio == pytest.approx(1.162)
    assert found.reduction == pytest.approx(4 / (5.6 - math.log(8.8)))
    assert fema440.madrs_factor(2.0) == pytest.approx(1.162**2 / 2)
    with pytest.raises(AssessmentError, match="from 1 to 4"):
        fema440.effective(4.5)


@settings(max_examples=20)
@given(grounds, st.floats(0.005, 0.05), st.floats(0.5, 4.0))
def test_fema440_finds_its_own_ductility(spectrum, start, level):
    curve = Bilinear(yield_displacement=start, yield_acceleration=level, ultimate_displacement=1.0)
    try:
        d = fema440.performance_point(spectrum, curve)
    except AssessmentError:
        return
    if d > start:
        found = fema440.effective(d / start)
        period = curve.period * found.period_ratio
        assert float(spectrum.sd(period, 0.05)) / found.reduction <= d * (1 + 1e-6)


def test_atc40_reductions():
    assert atc40.reductions(0.05) == pytest.approx((0.998, 1.0), abs=2e-3)
    assert atc40.reductions(0.60) == (0.56, 0.67)
    with pytest.raises(AssessmentError, match="trace the curve further"):
        atc40.performance_point([0.01, 0.02], [0.5, 0.5], ca=0.4, cv=0.4)


# Answers ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [n for n in METHODS.ours if n != "rocking"])
def test_answers_hold_the_keys_of_the_file(name):
    capacity = pier()
    found = assess(capacity, site(0.05), Settings.of(method=name, **FULL[name]))
    held = json.loads(json.dumps(found.as_dict(), allow_nan=False))
    assert set(held) >= KEYS and held["method"] == name
    assert held["limit_states"] and set(held["limit_states"]) <= set(METHODS[name].STATES)
    for state in held["limit_states"].values():
        assert set(state) >= STATE_KEYS
    assert found.satisfied == all(s.satisfied for s in found.verified)
    assert found.governing.name in found.sentence and name in found.sentence
    assert found.safety_index == found.governing.safety_index
    assert found.uncertain and found.assumptions


def test_one_ground_motion_for_all_states_is_that_of_the_reference_state():
    one = assess(rocking_wall(), site(), local())
    assert [s.name for s in one.verified] == ["SLV"]
    assert any("serves for SLD, SLV, SLC" in text for text in one.assumptions)
    several = {"SLD": site(0.05), "SLV": site(0.2), "SLC": site(0.3)}
    own = assess(rocking_wall(), several, local())
    assert [s.name for s in own.verified] == ["SLD", "SLV", "SLC"]
    assert own.state("SLD").ground_acceleration_demand == pytest.approx(0.05 * GRAVITY)
    assert own.safety_index == min(s.safety_index for s in own.verified)
    chosen = assess(rocking_wall(), several, local(limit_states=("SLD",)))
    assert chosen.safety_index == own.state("SLD").safety_index
    with pytest.raises(AssessmentError, match='"SLO" is to be verified'):
        assess(rocking_wall(), several, local(limit_states=("SLO",)))
    with pytest.raises(AssessmentError, match="none of them has a spectrum"):
        assess(rocking_wall(), {}, local())


@pytest.mark.parametrize("severe", [0.02, 0.05, 0.1, 0.2, 0.4])
def test_the_index_says_no_other_than_the_verdict(severe):
    """It was that of SLV, and above one, where another verified state failed."""
    several = {"SLD": site(severe), "SLV": site(0.05), "SLC": site(0.05)}
    found = assess(rocking_wall(), several, local())
    assert found.satisfied == (found.safety_index >= 1.0)
    assert found.as_dict()["safety_index"] == found.governing.safety_index


@pytest.mark.parametrize("name", ["ntc2018-local", "ntc2009-local", "en1998-3-2025-rocking"])
@pytest.mark.parametrize(("share", "slides"), [(None, False), (0.3, False), (0.9, True)])
def test_a_mechanism_that_slides_goes_with_the_verdict(name, share, slides):
    """Blocks that slide lose no strength: how far they go says what lies below them."""
    capacity = replace(rocking_wall(ratio=1.0), friction=share)
    found = assess(capacity, site(0.05), Settings.of(method=name, **FULL[name]))
    assert ("the mechanism slides" in found.sentence) == slides == bool(found.caution)
    if name.startswith("ntc"):
        linear = {**FULL[name], "kinematics": "linear"}
        assert not assess(capacity, site(0.05), Settings.of(method=name, **linear)).caution


def test_what_is_missing_or_unknown_is_named():
    with pytest.raises(AssessmentError, match='"displacement_limits" names "ULS"'):
        assess(rocking_wall(), site(), local(displacement_limits={"ULS": 0.1}))
    high = FloorSpectrum(ground=site(), modes=(MODE,))
    for name in ("ec8-n2", "ntc2018-global", "asce41"):
        with pytest.raises(AssessmentError, match="stand on the ground"):
            assess(pier(), high, Settings.of(method=name, **FULL[name]))
    with pytest.raises(AssessmentError, match='no method "eurocode"'):
        assess(rocking_wall(), site(), Settings.of(method="eurocode"))
    for name in ("ntc2018-local", "ntc2009-local"):
        with pytest.raises(AssessmentError, match=r'"confidence_factor": 1\.35'):
            assess(rocking_wall(), site(), Settings.of(method=name))
    with pytest.raises(AssessmentError, match="1 or more"):
        assess(rocking_wall(), site(), local(confidence_factor=0.9))
    with pytest.raises(AssessmentError, match="kinematics"):
        assess(rocking_wall(), site(), local(kinematics="dynamic"))
    with pytest.raises(AssessmentError, match="reading"):
        assess(rocking_wall(), site(), local(reading="force"))
    for key in ("site_class", "effective_mass_factor"):
        options = {**FULL["asce41"]}
        del options[key]
        with pytest.raises(AssessmentError, match=f'needs "{key}"'):
            assess(pier(), site(), Settings.of(method="asce41", **options))


def test_return_periods_that_are_borne():
    spectrum = replace(site(), return_period=475.0)
    state = assess(rocking_wall(), spectrum, local()).state("SLV")
    assert state.return_period_capacity == pytest.approx(475 * state.safety_index ** (1 / 0.41))
    euro = Ec8Spectrum(ground_acceleration=1.0, spectrum_type=1, ground="A", return_period=475.0)
    state = assess(rocking_wall(), euro, local()).state("SLV")
    assert state.return_period_capacity == pytest.approx(475 * state.safety_index**3)
    assert any("Return periods" in t for t in assess(rocking_wall(), euro, local()).uncertain)


def test_constants_of_the_codes():
    assert ntc2018_local.RULES["SLV"][:3] == (0.4, 1.68, 0.08)
    assert ntc2018_local.RULES["SLC"][:3] == (0.6, 1.56, 0.10)
    assert ntc2009_local.secant_period(1.0, 4 * math.pi**2) == pytest.approx(1.0)
    assert en1998_3_2025_rocking.resistance_factor(1, False) == 1.55
    with pytest.raises(AssessmentError, match="knowledge level"):
        en1998_3_2025_rocking.resistance_factor(4, False)
