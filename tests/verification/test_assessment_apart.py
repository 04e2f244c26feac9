"""Random sites and mechanisms against formulas written a second time, without the package's parts.

Tolerances are roundings: 1e-9 of values that go through a bisection.
"""

import math
import random

import pytest

from drystone.assessment.capacity import Capacity, participation
from drystone.assessment.methods import Settings, assess
from drystone.assessment.spectra import FloorSpectrum, Mode, NtcSpectrum

G = 9.81
S_S = {
    "A": lambda x: 1.0,
    "B": lambda x: min(max(1.4 - 0.4 * x, 1.0), 1.2),
    "C": lambda x: min(max(1.7 - 0.6 * x, 1.0), 1.5),
    "D": lambda x: min(max(2.4 - 1.5 * x, 0.9), 1.8),
    "E": lambda x: min(max(2.0 - 1.1 * x, 1.0), 1.6),
}
C_C = {
    "A": lambda t: 1.0,
    "B": lambda t: 1.1 * t**-0.2,
    "C": lambda t: 1.05 * t**-0.33,
    "D": lambda t: 1.25 * t**-0.5,
    "E": lambda t: 1.15 * t**-0.4,
}
S_T = {"T1": 1.0, "T2": 1.2, "T3": 1.2, "T4": 1.4}
T_E = {"A": 4.5, "B": 5.0, "C": 6.0, "D": 6.0, "E": 6.0}


class Apart:
    """A site, drawn at random, with NTC 2018 3.2.3.2 written out; a_g in g, damping in per cent."""

    def __init__(self, draw):
        self.soil, self.top = draw.choice("ABCDE"), draw.choice(sorted(S_T))
        self.f0, self.tc = draw.uniform(2.2, 2.9), draw.uniform(0.2, 0.5)
        self.ag = draw.uniform(0.05, 0.35)
        self.t1, self.gp = draw.uniform(0.15, 0.8), draw.uniform(0.3, 1.3)
        self.xi1 = draw.uniform(3.0, 20.0)

    def spectrum(self):
        return NtcSpectrum(
            ground_acceleration=self.ag * G, amplification=self.f0, reference_corner=self.tc,
            soil=self.soil, topography=self.top,
        )  # fmt: skip

    def floor(self):
        mode = Mode(period=self.t1, participation=self.gp, shape=1.0, damping=self.xi1 / 100.0)
        return FloorSpectrum(ground=self.spectrum(), modes=(mode,))

    def sd(self, t, xi, ag):
        s = S_S[self.soil](self.f0 * ag) * S_T[self.top]
        tc = C_C[self.soil](self.tc) * self.tc
        td, a = 4.0 * ag + 1.6, ag * G * s
        eta = max(math.sqrt(10.0 / (5.0 + xi)), 0.55)
        f, te = self.f0 * eta, T_E[self.soil]
        if t > te:
            ground = 0.025 * a * tc * td
            return ground if t >= 10 else ground * (f + (1 - f) * (t - te) / (10 - te))
        if t < tc / 3:
            se = a * f * (3 * t / tc + (1 - 3 * t / tc) / f)
        elif t < tc:
            se = a * f
        elif t < td:
            se = a * f * tc / t
        else:
            se = a * f * tc * td / t**2
        return se * (t / 2 / math.pi) ** 2

    def sa(self, t, xi, ag):
        if t == 0.0:
            return ag * G * S_S[self.soil](self.f0 * ag) * S_T[self.top]
        return self.sd(t, xi, ag) * (2 * math.pi / t) ** 2

    def sz(self, t, xi, ag):
        az = self.sa(self.t1, self.xi1, ag) * self.gp * math.sqrt(1 + 0.0004 * self.xi1**2)
        amp = 1.1 / math.sqrt(self.xi1 / 100) * max(math.sqrt(10 / (5 + xi)), 0.55)
        if t < 0.8 * self.t1:
            value = amp * az / (1 + (amp - 1) * (1 - t / (0.8 * self.t1)) ** 1.6)
        elif t < 1.1 * self.t1:
            value = amp * az
        else:
            value = amp * az / (1 + (amp - 1) * (t / (1.1 * self.t1) - 1) ** 1.2)
        return max(value, self.sa(t, xi, ag)) if t > self.t1 else value

    def dz(self, t, xi, ag):
        value = self.sz(t, xi, ag) * t**2
        if t > 1.1 * self.t1:
            value = max(value, self.sz(self.t1, xi, ag) * (1.1 * self.t1) ** 2)
        return value / (4 * math.pi**2)


def first_crossing(demand, limit, step=5e-4):
    """Walk up until the limit is met, then bisect."""
    low = 1e-9
    while demand(low + step) < limit:
        low += step
    high = low + step
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if demand(middle) < limit else (low, middle)
    return high


def mechanism(draw):
    """alpha_0, d_C0, FC and the oscillator of three bodies."""
    top, end = draw.uniform(0.03, 0.4), draw.uniform(0.1, 2.0)
    mass = [draw.uniform(500.0, 5000.0) for _ in range(3)]
    shape = [draw.uniform(0.2, 1.0) for _ in range(3)]
    first = sum(m * p for m, p in zip(mass, shape, strict=True))
    second = sum(m * p * p for m, p in zip(mass, shape, strict=True))
    capacity = Capacity.straight(top, end, participation(mass, shape), reading="base_shear")
    factor = draw.choice([1.0, 1.2, 1.35])
    a0 = top * G * sum(mass) * second / first**2 / factor
    return capacity, a0, end * second / first, factor


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("high", [False, True], ids=["ground", "height"])
def test_ntc2018_local(seed, high):
    draw = random.Random(seed)
    apart = Apart(draw)
    capacity, a0, d0, factor = mechanism(draw)
    spectrum = apart.floor() if high else apart.spectrum()
    found = assess(
        capacity, spectrum, Settings.of(method="ntc2018-local", confidence_factor=factor)
    )
    demand = apart.dz if high else apart.sd

    def floor(ag):
        return apart.sz(0.0, 5.0, ag) if high else apart.sa(0.0, 5.0, ag)

    activation = first_crossing(floor, a0)
    assert found.state("SLD").ground_acceleration_capacity == pytest.approx(
        activation * G, rel=1e-9
    )
    for name, share, number, xi in (("SLV", 0.4, 1.68, 8.0), ("SLC", 0.6, 1.56, 10.0)):
        state, d = found.state(name), share * d0
        period = number * math.pi * math.sqrt(d / (a0 * (1 - share)))
        assert state.limit_period == pytest.approx(period, rel=1e-12)
        asked = demand(period, xi, apart.ag)
        assert state.displacement_demand == pytest.approx(asked, rel=1e-10)
        borne = first_crossing(lambda ag, p=period, x=xi: demand(p, x, ag), d)
        assert state.ground_acceleration_capacity == pytest.approx(
            max(borne, activation) * G, rel=1e-9
        )


@pytest.mark.parametrize("seed", range(12, 20))
@pytest.mark.parametrize("high", [False, True], ids=["ground", "height"])
def test_ntc2009_local(seed, high):
    draw = random.Random(seed)
    apart = Apart(draw)
    capacity, a0, d0, factor = mechanism(draw)
    spectrum = apart.floor() if high else apart.spectrum()
    found = assess(
        capacity, spectrum, Settings.of(method="ntc2009-local", confidence_factor=factor)
    )
    period = 2 * math.pi * math.sqrt(0.16 * d0 / (0.84 * a0))

    def demand(ag):
        if not high:
            return apart.sd(period, 5.0, ag)
        r = period / apart.t1
        amplified = r**2 / math.sqrt((1 - r) ** 2 + 0.02 * r)
        return apart.sd(apart.t1, 5.0, ag) * apart.gp * amplified

    state = found.state("SLV")
    assert state.limit_period == pytest.approx(period, rel=1e-12)
    assert state.displacement_demand == pytest.approx(demand(apart.ag), rel=1e-10)
    assert state.ground_acceleration_capacity == pytest.approx(
        first_crossing(demand, 0.4 * d0) * G, rel=1e-9
    )
