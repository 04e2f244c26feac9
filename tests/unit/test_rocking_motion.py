"""Rocking as motion: closed forms of free rocking and overturning against the integration."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drystone.assessment.capacity import Capacity, Change, participation
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import Settings, assess
from drystone.assessment.methods.rocking import pulse_facts
from drystone.assessment.rocking.block import RockingBlock, equivalent_block
from drystone.assessment.rocking.motion import MechanismRocker, bearable_scale, respond
from drystone.assessment.rocking.pulse import (
    Pulse,
    half_sine_excess,
    least_amplitude,
)
from drystone.assessment.rocking.record import Record, read_record
from drystone.model.assembly import GRAVITY

STILL = Record(time=[0.0, 0.01], acceleration=[0.0, 0.0])


class BlockRocker:
    """theta'' = -p^2 (sin(alpha - theta) + u_g/g cos(alpha - theta)), Housner 1963, in radians.

    Overturned where it lies on its side.
    """

    def __init__(self, block):
        self._p2, self._alpha = block.frequency**2, block.slenderness
        self.limit = 0.5 * math.pi
        self.uplift = block.uplift_acceleration
        self.speed = block.frequency * block.slenderness

    def acceleration(self, x, ground):
        tilt = self._alpha - x
        return -self._p2 * (math.sin(tilt) + ground / GRAVITY * math.cos(tilt))


def block_of(width, height):
    """Of full width and height [m]: p = sqrt(3 g/4 R), alpha = atan(b/h); Housner 1963."""
    return RockingBlock(
        frequency=math.sqrt(0.75 * GRAVITY / math.hypot(0.5 * width, 0.5 * height)),
        slenderness=math.atan(width / height),
    )


def overturning_integral(time, acceleration, frequency):
    """p int exp(-p s) u_g(s) ds of a history from uplift, straight between points, exact."""
    s = frequency * (time - time[0])
    decay, slope = np.exp(-s), np.diff(acceleration) / np.diff(s)
    ends = acceleration[:-1] * decay[:-1] - acceleration[1:] * decay[1:]
    return float(np.sum(ends + slope * -np.diff(decay)))


def straight(multiplier=0.125, collapse=0.25):
    """One degree of freedom with lambda_0 (1 - d/d0)."""
    return Capacity.straight(multiplier, collapse, participation([1000.0], [1.0]), reading="energy")


def shaken(seed, strength=2.0, duration=6.0):
    """Filtered noise that swells and fades [m/s2]."""
    time = np.arange(0.0, duration, 0.02)
    noise = np.random.default_rng(seed).normal(size=len(time))
    smooth = np.convolve(noise, np.ones(8) / 8, "same")
    swell = np.exp(-(((time - 0.4 * duration) / (0.25 * duration)) ** 2))
    shape = smooth * swell
    return Record(time=time, acceleration=strength * shape / np.abs(shape).max())


def as_record(pulse, n=400):
    """A pulse in points, fine enough that its integral is right to 1e-5."""
    time = np.linspace(0.0, pulse.duration, n + 1)
    rest = pulse.duration * (1 + 1e-9)
    return Record(time=np.append(time, rest), acceleration=np.append(pulse.acceleration(time), 0.0))


# Closed forms ----------------------------------------------------------------------------------


def test_housners_block():
    block = block_of(0.5, 4.0)
    # R = 2.0156 m
    assert block.frequency == pytest.approx(math.sqrt(0.75 * GRAVITY / 2.01556), rel=1e-5)
    assert block.slenderness == pytest.approx(math.atan(0.125))
    assert block.uplift_acceleration == pytest.approx(GRAVITY / 8)
    assert block.restitution == pytest.approx(1 - 1.5 / 65)
    assert block.free_period(0.5) == pytest.approx(2.757, abs=5e-4)
    with pytest.raises(AssessmentError, match="between 0 and alpha"):
        block.free_period(1.0)


def test_free_period_of_housners_block():
    # the exact equation of finite rotations gives 2.758 s where the slender one gives 2.757 s
    block = block_of(0.5, 4.0)
    found = respond(
        BlockRocker(block), STILL, restitution=1.0, sides="two",
        displacement=0.5 * block.slenderness, duration=3.0,
    )  # fmt: skip
    crossings = found.time[1:][(found.displacement[1:] == 0.0) & (found.displacement[:-1] != 0.0)]
    assert found.n_impacts == 2
    # from a quarter to three quarters of a period
    assert 2 * np.ptp(np.unique(crossings)) == pytest.approx(2.758, abs=1e-3)


@settings(max_examples=10)
@given(st.floats(0.05, 0.4), st.floats(0.05, 0.6), st.floats(0.1, 0.9))
def test_free_period_in_closed_form(multiplier, collapse, share):
    # x'' = -p^2 (x0 - x): T = 4/p acosh(1/(1 - share)) holds exactly for the straight line
    capacity = straight(multiplier, collapse)
    block = equivalent_block(capacity)
    assert block.frequency == pytest.approx(math.sqrt(GRAVITY * multiplier / collapse), rel=1e-9)
    period = block.free_period(share)
    found = respond(
        MechanismRocker(capacity), STILL, restitution=1.0, sides="two",
        displacement=share * collapse, duration=period,
    )  # fmt: skip
    assert found.n_impacts == 2
    # back where it was, at rest: tolerances of the integration
    assert found.displacement[-1] == pytest.approx(share * collapse, rel=1e-6)
    assert abs(found.velocity[-1]) < 1e-4 * block.frequency * collapse


@settings(max_examples=10)
@given(st.lists(st.floats(0.2, 1.0), min_size=2, max_size=5), st.floats(0.2, 0.8))
def test_energy_is_kept_without_a_loss_and_lost_as_squares(levels, share):
    d = np.append(np.linspace(0.0, 0.2, len(levels)), 0.3)
    part = participation([1000.0], [1.0])
    capacity = Capacity.of(d, [*(0.2 * x for x in levels), 0.0], part, reading="energy")
    rocker = MechanismRocker(capacity)
    start = share * 0.3
    energy = rocker.energy(start)
    found = respond(rocker, STILL, restitution=1.0, sides="two", displacement=start, duration=6.0)
    held = [0.5 * v**2 + rocker.energy(abs(x)) for x, v in zip(
        found.displacement, found.velocity, strict=True)]  # fmt: skip
    assert found.n_impacts > 1
    # an integration of 1e-8 a step over a few hundred steps
    assert held == pytest.approx([energy] * len(held), rel=1e-5)
    lost = respond(rocker, STILL, restitution=0.9, sides="two", displacement=start, duration=6.0)
    last = 0.5 * lost.velocity[-1] ** 2 + rocker.energy(abs(lost.displacement[-1]))
    # impacts too small to tell bring it to rest
    assert last == pytest.approx(energy * 0.9 ** (2 * lost.n_impacts), rel=1e-4, abs=1e-8 * energy)


@pytest.mark.parametrize(
    ("ratio", "amplitude"), [(0.5, 1.109), (1.0, 1.322), (2.0, 1.801), (4.0, 2.791)]
)
def test_half_sine(ratio, amplitude):
    found = least_amplitude("half_sine", math.pi / ratio, 1.0)
    assert found == pytest.approx(amplitude, abs=5e-4)
    assert half_sine_excess(found, ratio) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("ratio", "percent"), [(0.5, 0.8), (1.0, 7), (2.0, 24), (4.0, 48)])
def test_housners_formula_is_unsafe(ratio, percent):
    least = least_amplitude("half_sine", math.pi / ratio, 1.0)
    # sqrt(1 + r^2), Housner 1963
    assert 100 * (math.hypot(1.0, ratio) / least - 1) == pytest.approx(percent, abs=0.5)


@given(st.floats(0.05, 4.0), st.floats(0.5, 4.0))
def test_rectangular_pulse(duration, frequency):
    a = least_amplitude("rectangular", duration, frequency)
    # cosh p t = 1 + 1/(2 a (a - 1)); a - 1 is a difference of near numbers for long pulses
    assert math.cosh(frequency * duration) == pytest.approx(1 + 0.5 / (a * (a - 1)), rel=1e-6)


@given(st.sampled_from(["half_sine", "rectangular"]), st.floats(0.1, 2.0), st.floats(0.5, 4.0))
def test_pulses_meet_the_condition_of_overturning(kind, duration, frequency):
    a = least_amplitude(kind, duration, frequency)
    pulse = Pulse(kind=kind, amplitude=a, duration=duration)
    # from uplift, where the pulse first reaches 1
    start = 0.0 if kind == "rectangular" else math.asin(1 / a) * duration / math.pi
    time = np.linspace(start, duration, 4001)
    history = pulse.acceleration(time)
    assert overturning_integral(time, history, frequency) == pytest.approx(1.0, abs=1e-6)


@settings(max_examples=6)
@given(st.sampled_from(["half_sine", "rectangular"]), st.floats(0.3, 1.5), st.floats(0.1, 0.3))
def test_pulses_overturn_in_time_what_they_overturn_in_closed_form(kind, duration, multiplier):
    capacity = straight(multiplier, 0.3)
    block, level = equivalent_block(capacity), GRAVITY * multiplier
    p = block.frequency
    least = least_amplitude(kind, duration, p) * level
    # one per mille beside the limit it takes about ln(1000)/p more to fall; a hard wall behind it
    for factor in (0.998, 1.002):
        pulse = Pulse(kind=kind, amplitude=factor * least, duration=duration)
        assert pulse_facts(pulse, block, level)["overturns"] == (factor > 1)
        found = respond(
            MechanismRocker(capacity), as_record(pulse).scaled(-1.0), restitution=0.0,
            sides="one", duration=duration + 12.0 / p,
        )  # fmt: skip
        assert found.overturned == (factor > 1)


def test_pulse_too_weak_to_lift():
    pulse = Pulse(kind="half_sine", amplitude=0.99 * GRAVITY * 0.1, duration=50.0)
    block = RockingBlock(frequency=2.0, slenderness=0.1)
    assert not pulse_facts(pulse, block, 0.1 * GRAVITY)["overturns"]
    found = respond(MechanismRocker(straight(0.1)), as_record(pulse), restitution=0.9, sides="two")
    assert found.largest == 0.0 and not found.overturned


# Records ------------------------------------------------------------------------------------------


def test_both_senses_are_alike_where_it_rocks_both_ways():
    rocker, record = MechanismRocker(straight()), shaken(3)
    one = respond(rocker, record, restitution=0.9, sides="two")
    other = respond(rocker, record.scaled(-1.0), restitution=0.9, sides="two")
    assert one.largest > 0.0
    assert np.array_equal(one.displacement, -other.displacement)
    against = respond(rocker, record, restitution=0.9, sides="one")
    assert against.displacement.min() >= -1e-12


def test_motion_meets_its_equation():
    """An integration apart from this one: steps of a ten-thousandth second, no events."""
    capacity, record = straight(0.125, 0.25), shaken(5, strength=1.9, duration=3.0)
    found = respond(MechanismRocker(capacity), record, restitution=0.8, sides="two")
    x = v = 0.0
    h, largest = 1e-4, 0.0
    for t in np.arange(0.0, record.time[-1], h):
        ground = float(np.interp(t, record.time, record.acceleration))
        if x == 0.0 and v == 0.0:
            if abs(ground) <= 0.125 * GRAVITY:
                continue
            side = -math.copysign(1.0, ground)
        else:
            side = math.copysign(1.0, x if x != 0.0 else v)
        v += h * (-side * 0.125 * GRAVITY * (1 - abs(x) / 0.25) - ground)
        new = x + h * v
        if x * new < 0.0:
            v, new = 0.8 * v, 0.0
            if abs(v) < 1e-3:
                v = 0.0
        x = new
        largest = max(largest, abs(x))
    # first order in the step
    assert found.largest == pytest.approx(largest, rel=2e-2) and largest > 1e-3


def test_scale_that_is_borne():
    rocker, record = MechanismRocker(straight()), shaken(7, duration=2.0)
    limit = 0.02
    scale = bearable_scale(rocker, record, limit, restitution=0.8, sides="two", n_points=4)
    over = respond(rocker, record.scaled(scale * (1 + 1e-6)), restitution=0.8, sides="two")
    under = respond(rocker, record.scaled(scale * (1 - 1e-4)), restitution=0.8, sides="two")
    assert over.largest > limit >= under.largest


def test_record_of_a_file(tmp_path):
    path = tmp_path / "quake.csv"
    path.write_text("t,a\n0,0\n0.01,0.1\n0.02,-0.2\n")
    record = read_record(path, unit="g")
    assert record.peak_acceleration == pytest.approx(0.2 * GRAVITY)
    # trapezes: 0.0005 g s, then -0.0005 g s
    assert record.peak_velocity == pytest.approx(0.0005 * GRAVITY)
    for text, words in (
        ("time,acc\n0,0\n1,1\n", "header"),
        ("t,a\n0,0\n0,1\n", "sort"),
        ("t,a\n0,0\n1,inf\n", "finite"),
        ("t,a\n0,0\n1,0\n", "largest acceleration"),
    ):
        path.write_text(text)
        with pytest.raises(AssessmentError, match=words):
            read_record(path, unit="g")
    with pytest.raises(AssessmentError, match="unit"):
        read_record(path, unit="gal")


# The method ---------------------------------------------------------------------------------------


def test_method_under_records_and_pulses():
    records = (shaken(1, 1.5), shaken(2, 1.5))
    pulses = (Pulse(kind="half_sine", amplitude=3.0, duration=0.4),)
    chosen = Settings.of(
        method="rocking", records=records, pulses=pulses, restitution=0.9, sides="two"
    )
    capacity = straight()
    found = assess(capacity, {}, chosen)
    json.dumps(found.as_dict(), allow_nan=False)
    largest = [
        respond(MechanismRocker(capacity), r, restitution=0.9, sides="two").largest for r in records
    ]
    state = found.state("SLV")
    assert state.displacement_demand == pytest.approx(np.mean(largest))
    assert state.limit_displacement == pytest.approx(0.1)
    assert found.state("overturning").verified
    borne = found.quantities["pulses"][0]["overturning_amplitude"] > 3.0
    assert found.satisfied == (np.mean(largest) <= 0.1 and borne)
    shown = assess(capacity, {}, replace(chosen, limit_states=("SLV",)))
    assert not shown.state("overturning").verified
    assert shown.satisfied == (np.mean(largest) <= 0.1)
    facts = found.quantities["pulses"][0]
    p = math.sqrt(GRAVITY * 0.125 / 0.25)
    assert facts["overturning_amplitude"] == pytest.approx(
        GRAVITY * 0.125 * least_amplitude("half_sine", 0.4, p)
    )
    alone = assess(capacity, {}, replace(chosen, records=(), own={"sides": "two"}))
    assert alone.satisfied is (facts["overturning_amplitude"] > 3.0)
    assert "overturning governs" in alone.sentence


def test_method_counts_a_fall_as_failure():
    chosen = Settings.of(method="rocking", records=(shaken(1, 40.0),), restitution=0.9, sides="two")
    found = assess(straight(0.1, 0.02), {}, chosen)
    assert found.satisfied is False and found.state("SLV").displacement_demand is None
    assert "beyond the collapse" in found.sentence
    assert found.quantities["records"][0]["overturned"] is True


def test_no_motion_to_and_fro_over_a_tie_that_breaks():
    """A record that moves the mechanism less far counts; one that goes farther is refused, unless
    it overturns what is held better than the structure is."""
    chosen = Settings.of(method="rocking", records=(shaken(1, 1.5),), restitution=0.9, sides="two")
    free = assess(straight(), {}, chosen)
    went = free.state("SLV").control_displacement_demand
    what = 'at 0.1 m: the tie "rod" breaks'

    def tied(place, capacity=None):
        changes = (Change(place, what, True),)
        return replace(straight() if capacity is None else capacity, changes=changes)

    assert assess(tied(1.1 * went), {}, chosen).safety_index == free.safety_index
    with pytest.raises(AssessmentError, match=r"the way back is on another curve.*breaks"):
        assess(tied(0.9 * went), {}, chosen)
    with pytest.raises(AssessmentError, match=r"pulses.*forces that stay constant.*breaks"):
        pulses = (Pulse(kind="half_sine", amplitude=3.0, duration=0.4),)
        assess(tied(0.1), {}, replace(chosen, pulses=pulses))
    falls = replace(chosen, records=(shaken(1, 40.0),))
    assert assess(tied(0.001, straight(0.1, 0.02)), {}, falls).satisfied is False


def test_what_the_method_needs():
    with pytest.raises(AssessmentError, match='needs "records" or "pulses"'):
        assess(straight(), {}, Settings.of(method="rocking"))
    for key, values in (("restitution", {"sides": "two"}), ("sides", {"restitution": 0.9})):
        with pytest.raises(AssessmentError, match=f'needs "{key}"'):
            assess(straight(), {}, Settings.of(method="rocking", records=(STILL,), **values))
    for values, words in (({"restitution": 1.2}, "restitution"), ({"sides": "three"}, "sides")):
        full = {"restitution": 0.9, "sides": "two", **values}
        with pytest.raises(AssessmentError, match=words):
            respond(MechanismRocker(straight()), STILL, **full)
    open_end = Capacity.of([0.0, 0.1], [0.0, 0.1], participation([1.0], [1.0]), reading="energy")
    with pytest.raises(AssessmentError, match="does not come down"):
        MechanismRocker(open_end)


def test_equivalent_block_of_a_curved_branch():
    # finite rotations of a block: lambda = tan(alpha - theta), turned about its toe
    b, h = 0.25, 2.0
    alpha, size = math.atan(b / h), math.hypot(b, h)
    angle = np.linspace(0.0, alpha, 60)
    across = 2 * h * np.sin(angle)  # the toe's upper neighbour, straight above it
    part = participation([1000.0], [0.5], 1000.0 * 4 / 3 * size**2 / (2 * h) ** 2)
    capacity = Capacity.of(across, np.tan(alpha - angle), part, reading="base_shear")
    block = equivalent_block(capacity)
    p = math.sqrt(0.75 * GRAVITY / size)
    assert block.slenderness == pytest.approx(alpha, rel=1e-12)
    # d lambda/d theta = 1/cos^2 alpha at the start: p/sqrt(cos alpha) here, within half a per cent
    assert block.frequency == pytest.approx(p, rel=5e-3)
    assert block.frequency == pytest.approx(p / math.sqrt(math.cos(alpha)), rel=1e-3)
