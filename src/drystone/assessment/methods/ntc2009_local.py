"""Local mechanisms by the rules of 2009: Circolare 617/2009 to NTC 2008, C8A.4.

Written from second hand: the numbers of the equations are not certain.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from drystone.assessment.capacity import Capacity
from drystone.assessment.methods import common, local
from drystone.assessment.methods.base import Assessment, LimitState, Settings, Spectra, spectra_of
from drystone.assessment.methods.ground import bearable, of_the_ground
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum
from drystone.assessment.spectra.floor import FloorSpectrum
from drystone.common.keys import Key
from drystone.common.language import say

NAME = "ntc2009-local"
STATES = ("SLD", "SLV")
MORE_STATES: tuple[str, ...] = ()
READINGS = ("base_shear",)
REFERENCE = "SLV"
KEYS: tuple[Key, ...] = ()

#: d_u* = 0.4 d0*, d_s* = 0.4 d_u*: C8A.4.2.3.
ULTIMATE_SHARE, SECANT_SHARE = 0.4, 0.4

#: q of the linear check of the SLV, C8A.4.2.3.
BEHAVIOUR_FACTOR = 2.0

UNCERTAIN = say("ntc2009_local.text")


def secant_period(displacement: float, acceleration: float) -> float:
    """T_s = 2 pi sqrt(d_s*/a_s*) [s], C8A.4.2.3."""
    return 2.0 * math.pi * math.sqrt(displacement / acceleration)


def displacement_demand(spectrum: Spectrum, period: float) -> float:
    """Demand [m] at T_s [s], C8A.4.2.3, damping 5 per cent.

    S_De(T_s) at the ground; at a height
    S_De(T_1) psi gamma (T_s/T_1)^2/sqrt((1 - T_s/T_1)^2 + 0.02 T_s/T_1).
    """
    if not isinstance(spectrum, FloorSpectrum):
        return float(spectrum.sd(period, REFERENCE_DAMPING))
    mode = spectrum.modes[0]
    ratio = period / mode.period
    amplified = ratio**2 / math.sqrt((1.0 - ratio) ** 2 + 0.02 * ratio)
    base = float(spectrum.ground.sd(mode.period, REFERENCE_DAMPING))
    return base * abs(mode.shape * mode.participation) * amplified


def acceleration_demand(spectrum: Spectrum) -> float:
    """a_g S, at a height also S_e(T_1) psi gamma where that is more [m/s2], C8A.4.2.3."""
    if not isinstance(spectrum, FloorSpectrum):
        return float(spectrum.sa(0.0, REFERENCE_DAMPING))
    mode, ground = spectrum.modes[0], spectrum.ground
    floor = float(ground.sa(mode.period, REFERENCE_DAMPING)) * abs(mode.shape * mode.participation)
    return max(floor, float(ground.sa(0.0, REFERENCE_DAMPING)))


def _by_acceleration(
    name: str, capacity: Capacity, spectrum: Spectrum, settings: Settings, verified: bool
) -> LimitState:
    """SLD, or the linear SLV where what is asked for is divided by q = 2, C8A.4.2.3."""
    q = BEHAVIOUR_FACTOR if name == "SLV" else 1.0
    a0 = q * capacity.activation_acceleration / local.confidence_factor(settings)
    demand = acceleration_demand(spectrum)
    borne = bearable(spectrum, acceleration_demand, a0)
    return LimitState(
        name=name,
        limit_acceleration=a0,
        damping=REFERENCE_DAMPING,
        acceleration_demand=demand,
        **of_the_ground(spectrum, borne),
        satisfied=a0 >= demand,
        verified=verified,
        governed_by=say("governs.activation" if name == "SLD" else "governs.activation_q"),
        clause="Circ. 617/2009 C8A.4.2.3",
    )


def _by_displacement(
    capacity: Capacity, spectrum: Spectrum, settings: Settings, verified: bool
) -> LimitState:
    """SLV: d_u* against the demand at the secant period of d_s* = 0.4 d_u*, C8A.4.2.3."""
    own = ULTIMATE_SHARE * local.collapse(capacity, settings)
    d, why = common.limit(capacity, settings, "SLV", own)
    at = SECANT_SHARE * d
    straight = local.is_straight(capacity, settings, own=True)
    factor = local.confidence_factor(settings)
    a = local.acceleration(capacity, at, straight) / factor
    period = secant_period(at, a)
    demand = displacement_demand(spectrum, period)
    borne = bearable(spectrum, lambda s: displacement_demand(s, period), d)
    return LimitState(
        name="SLV",
        limit_displacement=d,
        limit_control_displacement=capacity.control_at(d),
        limit_acceleration=local.acceleration(capacity, d, straight) / factor,
        limit_period=period,
        damping=REFERENCE_DAMPING,
        displacement_demand=demand,
        control_displacement_demand=capacity.control_at(demand),
        **of_the_ground(spectrum, borne),
        satisfied=demand <= d,
        verified=verified,
        governed_by=why or say("governs.share", share=ULTIMATE_SHARE),
        clause="Circ. 617/2009 C8A.4.2.3",
        details={"secant_displacement": at, "secant_acceleration": a},
    )


def assess(capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
    """Local mechanism by Circ. 617/2009 C8A.4, linear or non-linear kinematic analysis.

    The capacity is the straight line a0* (1 - d*/d0*), as for constant forces, unless
    `Settings.straight_capacity` is False.  Where a tie yields or breaks, or a part falls, it is the
    curve: C8A.4.2.2 asks for it in pieces between such displacements.  A `FloorSpectrum` gives T_1,
    psi and gamma of mechanisms at a height.

    Raises
    ------
    AssessmentError
        Without a confidence factor, or, in the non-linear analysis, without a collapse.
    """
    linear = local.is_linear(settings)
    c = capacity.read_as(settings.reading)
    factor = local.confidence_factor(settings)
    given, verified, notes = spectra_of(spectra, STATES, REFERENCE, settings)
    found = []
    for name, spectrum in given.items():
        if linear or name == "SLD":
            found.append(_by_acceleration(name, c, spectrum, settings, name in verified))
        else:
            found.append(_by_displacement(c, spectrum, settings, name in verified))
    used = tuple(given.values())
    return Assessment(
        method=NAME,
        capacity=c,
        settings=settings,
        limit_states=tuple(found),
        activation_acceleration=c.activation_acceleration / factor,
        confidence_factor=factor,
        spectra=given,
        assumptions=common.assumptions(c, used) + notes + _said(c, settings, given, linear),
        uncertain=common.uncertain(c, used, found, UNCERTAIN),
        weighs_most=common.weight(c, say("ntc2009_local.weight_linear") if linear else ""),
        caution=local.caution_of_linear(c) if linear else local.caution(c),
    )


def _said(
    capacity: Capacity, settings: Settings, given: Mapping[str, Spectrum], linear: bool
) -> tuple[str, ...]:
    said: list[str] = []
    changed = capacity.first_change
    if not linear:
        said.append(local.collapse_assumption())
        if local.is_straight(capacity, settings, own=True):
            said.append(say("ntc2009_local.straight"))
        elif settings.straight_capacity is None and changed is not None:
            said.append(say("ntc2009_local.curve", what=changed.what))
    if any(isinstance(s, FloorSpectrum) and len(s.modes) > 1 for s in given.values()):
        said.append(say("ntc2009_local.first_mode"))
    if any(s.site_specific for s in given.values()):
        said.append(say("ntc2009_local.site"))
    return tuple(said)
