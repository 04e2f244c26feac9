"""The coefficient method of ASCE 41-17 7.4.3.3, as a check: it was not made for rocking."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drystone.assessment.bilinear import Bilinear, bilinear, drop_point
from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.methods import common
from drystone.assessment.methods.base import Assessment, LimitState, Settings, Spectra, spectra_of
from drystone.assessment.methods.ground import bearable
from drystone.assessment.methods.in_plane import placed
from drystone.assessment.methods.inelastic import check_on_the_ground
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum
from drystone.common.keys import Choice, Flag, Key, Number
from drystone.common.language import say
from drystone.common.ranges import POSITIVE
from drystone.model.assembly import GRAVITY

NAME = "asce41"
STATES = ("IO", "LS", "CP")
MORE_STATES: tuple[str, ...] = ()
READINGS = ("base_shear",)
REFERENCE = "CP"
KEYS: tuple[Key, ...] = (
    Key(name="site_class", type=Choice(("A", "B", "C", "D", "E", "F")), default=None),
    Key(name="effective_mass_factor", type=Number(POSITIVE), default=None),  # C_m
    # Has no effect: alpha_P = alpha_2 in (7-33), as the whole descent is taken as P-Delta.
    Key(name="near_fault", type=Flag(), default=None),
)

#: a of C_1 by site class, (7-29).
SITE_FACTORS = {"A": 130.0, "B": 130.0, "C": 90.0, "D": 60.0, "E": 60.0, "F": 60.0}

#: C_0 by storeys, Table 7-5, any load pattern.
SHAPE_FACTORS = {1: 1.0, 2: 1.2, 3: 1.3, 5: 1.4, 10: 1.5}

#: Shortest period in C_1; above the others C_1 and C_2 are 1 [s].
SHORTEST, LONGEST_C1, LONGEST_C2 = 0.2, 1.0, 0.7

#: Share of the yield strength through which the effective stiffness passes, 7.4.3.2.4.
SECANT_SHARE = 0.6

UNCERTAIN = (say("asce41.text"),)


def storeys_shape_factor(storeys: float) -> float:
    """C_0 of Table 7-5 by storeys, straight between them, in place of Gamma."""
    n = positive(storeys, "the number of storeys")
    return float(np.interp(n, list(SHAPE_FACTORS), list(SHAPE_FACTORS.values())))


def strength_ratio(acceleration: float, yield_ratio: float, mass_factor: float) -> float:
    """mu_strength = S_a C_m/(V_y/W), (7-31); S_a in g, or in the unit of V_y/W."""
    return acceleration * mass_factor / yield_ratio


def ductility_coefficient(ratio: float, period: float, site_class: str) -> float:
    """C_1 = 1 + (mu - 1)/(a T_e^2), (7-29): T_e >= 0.2 s in it, 1 above 1.0 s."""
    if site_class not in SITE_FACTORS:
        raise AssessmentError(f'there is no site class "{site_class}": {", ".join(SITE_FACTORS)}')
    if period > LONGEST_C1 or ratio <= 1.0:
        return 1.0
    return 1.0 + (ratio - 1.0) / (SITE_FACTORS[site_class] * max(period, SHORTEST) ** 2)


def degradation_coefficient(ratio: float, period: float) -> float:
    """C_2 = 1 + ((mu - 1)/T_e)^2/800, (7-30): 1 above 0.7 s."""
    if period > LONGEST_C2 or ratio <= 1.0:
        return 1.0
    return 1.0 + ((ratio - 1.0) / period) ** 2 / 800.0


def target_displacement(
    *,
    acceleration: float,
    period: float,
    yield_ratio: float,
    shape_factor: float,
    mass_factor: float,
    site_class: str,
) -> float:
    """delta_t = C_0 C_1 C_2 S_a g T_e^2/4 pi^2 [m], (7-28).

    Parameters
    ----------
    acceleration, yield_ratio
        S_a and V_y/W, both in g.
    period
        T_e [s].
    shape_factor, mass_factor
        C_0 and C_m.
    """
    ratio = strength_ratio(acceleration, yield_ratio, mass_factor)
    moved = ductility_coefficient(ratio, period, site_class) * degradation_coefficient(
        ratio, period
    )
    elastic = acceleration * GRAVITY * period**2 / (4.0 * math.pi**2)
    return shape_factor * moved * elastic


def largest_strength_ratio(
    displacement: float, yield_displacement: float, slope: float, period: float
) -> float:
    """mu_max = Delta_d/Delta_y + |alpha_e|^-h/4 with h = 1 + 0.15 ln T_e, (7-32).

    Parameters
    ----------
    displacement
        Delta_d [m], the lesser of target displacement and displacement at the highest base shear.
    slope
        alpha_e, slope after the peak over the elastic one, below zero; no limit where it is zero.
    """
    if slope == 0.0:
        return math.inf
    power = 1.0 + 0.15 * math.log(period)
    return displacement / yield_displacement + abs(slope) ** -power / 4.0


def idealised(capacity: Capacity) -> Bilinear:
    """Yield point by equal areas up to the peak, first branch through 0.6 V_y, 7.4.3.2.4.

    A curve that is level before its peak has its peak as V_y.
    """
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    top = capacity.peak_index
    end = float(d[top])
    share = SECANT_SHARE
    if top == 0 or end <= 0.0:
        raise AssessmentError(say("refused.begins_at_peak", method=NAME))
    for _ in range(50):
        found = bilinear(d, a, "ntc2018", ultimate=end, secant_share=share)
        new = SECANT_SHARE * min(found.yield_acceleration / float(a[top]), 1.0)
        if abs(new - share) < 1e-12:
            break
        share = new
    return found


def _descent(capacity: Capacity, curve: Bilinear) -> float:
    """alpha_2: slope from the peak to 0.6 V_y on the way down, over the elastic one; 7.4.3.2.4."""
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    top = capacity.peak_index
    share = SECANT_SHARE * curve.yield_acceleration / float(a[top])
    end = drop_point(d, a, share)
    fall = (share - 1.0) * float(a[top]) / (end - float(d[top]))
    return fall * curve.yield_displacement / curve.yield_acceleration


class _Oscillator(NamedTuple):
    """What the formulas take of a curve and of the settings."""

    period: float  # s, T_e
    yield_ratio: float  # V_y/W
    yield_displacement: float  # m
    peak_displacement: float  # m, at the highest base shear
    slope: float  # alpha_e, which is alpha_2 where the whole descent is P-Delta, (7-33)
    mass_factor: float  # C_m
    site_class: str

    def level(self, spectrum: Spectrum) -> float:
        """S_a(T_e) in g."""
        return float(spectrum.sa(self.period, REFERENCE_DAMPING)) / GRAVITY

    def target(self, spectrum: Spectrum) -> float:
        """delta_t/C_0 [m], the displacement d*."""
        return target_displacement(
            acceleration=self.level(spectrum),
            period=self.period,
            yield_ratio=self.yield_ratio,
            shape_factor=1.0,
            mass_factor=self.mass_factor,
            site_class=self.site_class,
        )

    def ratio(self, spectrum: Spectrum) -> float:
        """mu_strength."""
        return strength_ratio(self.level(spectrum), self.yield_ratio, self.mass_factor)

    def most(self, spectrum: Spectrum) -> float:
        """mu_max."""
        moved = min(self.target(spectrum), self.peak_displacement)
        return largest_strength_ratio(moved, self.yield_displacement, self.slope, self.period)


def _oscillator(capacity: Capacity, curve: Bilinear, settings: Settings) -> _Oscillator:
    """The oscillator of a bilinear; `AssessmentError` names what the settings leave out."""
    site = settings.need("site_class", '"A" to "F", as C_1 depends on it, (7-29)')
    mass = settings.need("effective_mass_factor", "C_m of Table 7-4; 1 is on the safe side")
    return _Oscillator(
        period=curve.period,
        # The base shear over the whole weight: a* is F_b/(e* M).
        yield_ratio=curve.yield_acceleration / GRAVITY * capacity.participating_mass_ratio,
        yield_displacement=curve.yield_displacement,
        peak_displacement=float(capacity.spectral_displacement[capacity.peak_index]),
        slope=_descent(capacity, curve),
        mass_factor=positive(mass, "C_m"),
        site_class=site,
    )


def _state(
    name: str,
    capacity: Capacity,
    spectrum: Spectrum,
    oscillator: _Oscillator,
    settings: Settings,
    verified: bool,
) -> LimitState:
    """The target displacement against the user's acceptance displacement, where (7-32) holds."""
    ratio, most = oscillator.ratio(spectrum), oscillator.most(spectrum)
    if ratio > most and verified:
        raise AssessmentError(say("refused.asce41", method=NAME, ratio=ratio, most=most))
    limit, why = settings.displacement_limits.get(name), say("governs.given")
    lost = capacity.first_loss
    if limit is not None and lost is not None and lost.place < limit:
        limit, why = lost.place, say("governs.lost", what=lost.what)  # the strength is that before
    own = None if limit is None else capacity.spectral_at(limit)
    asked, borne = oscillator.target(spectrum), None
    if own is not None:
        borne = bearable(spectrum, oscillator.target, own)
        valid = bearable(spectrum, lambda s: oscillator.ratio(s) / oscillator.most(s), 1.0)
        if valid is not None and (borne is None or valid < borne):
            borne, why = valid, say("governs.largest_ratio")
    return LimitState(
        name=name,
        limit_displacement=own,
        limit_control_displacement=limit,
        limit_period=oscillator.period,
        damping=REFERENCE_DAMPING,
        displacement_demand=asked,
        control_displacement_demand=capacity.control_at(asked),
        ground_acceleration_capacity=borne,
        ground_acceleration_demand=spectrum.ground_acceleration,
        return_period_demand=spectrum.return_period,
        satisfied=None if own is None else asked <= own and ratio <= most,
        verified=verified,
        governed_by="" if own is None else why,
        clause=say("clause.asce"),
        details={"strength_ratio": ratio, "largest_strength_ratio": most},
    )


def assess(capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
    """Target displacement by ASCE 41-17 7.4.3.3 against the user's acceptance displacements.

    Limit states IO, LS and CP are those of `Settings.displacement_limits`, at the control point;
    ASCE 41 has none for walls of blocks.  Where a tie breaks or a part falls before, they end
    there: the target displacement is that of the strength before.

    Raises
    ------
    AssessmentError
        Where mu_strength exceeds mu_max (7-32): the strength falls too fast for the method.
    """
    c = capacity.read_as(settings.reading)
    given, verified, notes = spectra_of(spectra, STATES, REFERENCE, settings)
    check_on_the_ground(given.values(), NAME)
    curve = idealised(c)
    oscillator = _oscillator(c, curve, settings)
    found = tuple(
        _state(name, c, spectrum, oscillator, settings, name in verified)
        for name, spectrum in given.items()
    )
    return _answer(c, settings, curve, found, given, notes)


def _answer(
    capacity: Capacity,
    settings: Settings,
    curve: Bilinear,
    found: tuple[LimitState, ...],
    given: dict[str, Spectrum],
    notes: tuple[str, ...],
) -> Assessment:
    """The result with what was assumed."""
    said = [say("asce41.shape")]
    without = [state.name for state in found if state.satisfied is None]
    if without:
        said.append(say("asce41.without", states=without))
    lost, asked = capacity.first_loss, settings.displacement_limits
    cut = [] if lost is None else [name for name in given if asked.get(name, 0.0) > lost.place]
    if lost is not None and cut:
        said.append(say("asce41.lost", states=cut, what=lost.what))
    used = tuple(given.values())
    caution, where = placed(capacity, NAME)
    return Assessment(
        method=NAME,
        capacity=capacity,
        settings=settings,
        limit_states=found,
        activation_acceleration=capacity.activation_acceleration,
        confidence_factor=None,
        spectra=given,
        bilinear=curve,
        quantities={
            "elastic_period": curve.period,
            "strength_ratio": found[0].details["strength_ratio"],
        },
        assumptions=where + common.assumptions(capacity, used) + notes + tuple(said),
        uncertain=common.uncertain(capacity, used, found, *UNCERTAIN),
        weighs_most=say("asce41.weight"),
        caution=caution,
    )


__all__ = [
    "KEYS",
    "MORE_STATES",
    "NAME",
    "READINGS",
    "STATES",
    "assess",
    "degradation_coefficient",
    "ductility_coefficient",
    "idealised",
    "largest_strength_ratio",
    "storeys_shape_factor",
    "strength_ratio",
    "target_displacement",
]
