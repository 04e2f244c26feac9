"""Local mechanisms by NTC 2018: Circolare 7/2019, C8.7.1.2.1.

Linear kinematic (C8.7.1.2.1.7) and non-linear kinematic analysis (C8.7.1.2.1.8) on the curve as
traced.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import MissingError, not_negative
from drystone.assessment.methods import common, local
from drystone.assessment.methods.base import Assessment, LimitState, Settings, Spectra, spectra_of
from drystone.assessment.methods.ground import bearable, of_the_ground
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum, largest_displacement
from drystone.assessment.spectra.floor import FloorSpectrum
from drystone.common.keys import Key
from drystone.common.language import say

NAME = "ntc2018-local"
STATES = ("SLD", "SLV", "SLC")
MORE_STATES: tuple[str, ...] = ()
READINGS = ("base_shear",)
REFERENCE = "SLV"
KEYS: tuple[Key, ...] = ()


class Rule(NamedTuple):
    """An ultimate limit state: C8.7.1.2.1.8."""

    share: float  # of d0
    period: float  # T_LS = period pi sqrt(d_LS/a(d_LS))
    damping: float  # ratio
    clause: str


RULES = {
    "SLV": Rule(0.4, 1.68, 0.08, "Circ. 7/2019 C8.7.1.2.1.8, (C8.7.1.10)"),
    "SLC": Rule(0.6, 1.56, 0.10, "Circ. 7/2019 C8.7.1.2.1.8, (C8.7.1.11)"),
}

#: Share of the largest acceleration whose loss ends the SLV, and of d0 within which it is sudden.
LOST, SUDDEN = 0.5, 0.01

#: q of the simplified check of the SLV, C8.7.1.2.1.7.
BEHAVIOUR_FACTOR = 2.0


def limit_period(displacement: float, acceleration: float, state: str) -> float:
    """T_SLV = 1.68 pi sqrt(d/a), T_SLC = 1.56 pi sqrt(d/a) [s]: (C8.7.1.10), (C8.7.1.11)."""
    return RULES[state].period * math.pi * math.sqrt(displacement / acceleration)


def displacement_demand(
    spectrum: Spectrum, period: float, damping: float, elastic_period: float | None
) -> float:
    """Demand [m] on a mechanism at the ground, S_De(T_LS), or at a height, (C8.7.1.12).

    Of a spectrum of the site, the largest one between T_0 and T_LS.
    """
    if not spectrum.site_specific:
        return float(spectrum.sd(period, damping))
    if elastic_period is None:
        raise MissingError(
            f'method "{NAME}" needs "elastic_period": with the spectrum of a site the demand is '
            "the largest S_De between T_0 and T_LS (Circ. 7/2019 C8.7.1.2.1.8); T_0 is 0 where "
            "the mechanism is rigid until it rocks"
        )
    return largest_displacement(spectrum, min(elastic_period, period), period, damping)


def activation_demand(spectrum: Spectrum, elastic_period: float | None) -> float:
    """Acceleration [m/s2] at the mechanism while it does not move, (C8.7.1.8), (C8.7.1.9).

    a_g S at the ground and a_Z, (C7.2.8), at a height; S_e(T_0, 5 %) of a free element.
    """
    return float(spectrum.sa(elastic_period or 0.0, REFERENCE_DAMPING))


def sudden_loss(capacity: Capacity) -> float | None:
    """d* [m] of the last point before more than half of the largest acceleration is lost at once,
    or None.  The largest is that so far, or that of the activation where it comes later.

    As where a tie or a connection breaks: it ends the SLV, C8.7.1.2.1.8.  At once is within a
    hundredth of the collapse displacement, or from one point to the next where an event lies
    between them: how far a jump leads says nothing of how sudden it is.
    """
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    end = capacity.spectral_collapse_displacement
    if end is None:
        return None
    events = [capacity.spectral_at(place) for place, _ in capacity.losses or ()]
    found, least = None, capacity.activation_acceleration
    for i in range(min(int(np.searchsorted(d, end)), len(d) - 1)):
        jump = any(d[i] <= place < d[i + 1] for place in events)
        after = max(int(np.searchsorted(d, d[i] + SUDDEN * end, side="right")), i + 1 + jump)
        if a[i] - a[i:after].min() > LOST * max(a[: i + 1].max(), least):
            found = float(d[i])
        elif found is not None:
            break
    return found


def activation_state(
    capacity: Capacity, spectrum: Spectrum, settings: Settings, verified: bool
) -> LimitState:
    """SLD: a0 = alpha_0 g/(e* FC) against `activation_demand`, (C8.7.1.8) and (C8.7.1.9)."""
    a0 = capacity.activation_acceleration / local.confidence_factor(settings)
    t0 = settings.elastic_period
    demand = activation_demand(spectrum, t0)
    borne = bearable(spectrum, lambda s: activation_demand(s, t0), a0)
    free = bool(t0)
    return LimitState(
        name="SLD",
        limit_acceleration=a0,
        limit_period=t0,
        damping=REFERENCE_DAMPING,
        acceleration_demand=demand,
        **of_the_ground(spectrum, borne),
        satisfied=a0 >= demand,
        verified=verified,
        governed_by=say("governs.activation"),
        clause="Circ. 7/2019 (C8.7.1.9)" if free else "Circ. 7/2019 (C8.7.1.8)",
    )


def _ultimate_state(
    name: str,
    capacity: Capacity,
    spectrum: Spectrum,
    settings: Settings,
    activation: float | None,
    verified: bool,
) -> LimitState:
    """SLV or SLC by the non-linear kinematic analysis, C8.7.1.2.1.8."""
    rule, factor = RULES[name], local.confidence_factor(settings)
    own = rule.share * local.collapse(capacity, settings)
    d, why = common.limit(capacity, settings, name, own)
    straight = local.is_straight(capacity, settings)
    lost = sudden_loss(capacity) if name == "SLV" and not straight else None
    if lost is not None and lost < d:
        d, why = lost, say("governs.sudden")
    a = local.acceleration(capacity, d, straight) / factor
    period = limit_period(d, a, name)
    t0 = settings.elastic_period
    demand = displacement_demand(spectrum, period, rule.damping, t0)
    by_displacement = bearable(
        spectrum, lambda s: displacement_demand(s, period, rule.damping, t0), d
    )
    why = why or say("governs.share", share=rule.share)
    borne, governed = by_displacement, why
    if borne is not None and activation is not None and activation > borne:
        borne, governed = activation, say("governs.activation")
    return LimitState(
        name=name,
        limit_displacement=d,
        limit_control_displacement=capacity.control_at(d),
        limit_acceleration=a,
        limit_period=period,
        damping=rule.damping,
        displacement_demand=demand,
        control_displacement_demand=capacity.control_at(demand),
        **of_the_ground(spectrum, borne),
        satisfied=borne is None or borne >= spectrum.ground_acceleration,
        verified=verified,
        governed_by=governed,
        clause=rule.clause,
        details={
            "limit_set_by": why,
            "ground_acceleration_of_displacement": by_displacement,
            "secant_period": 2.0 * math.pi * math.sqrt(d / a),
            "secant_stiffness": capacity.oscillator_mass * a / d,
            "displacement_satisfied": demand <= d,
        },
    )


def _linear_state(
    capacity: Capacity,
    spectrum: Spectrum,
    settings: Settings,
    activation: float | None,
    verified: bool,
) -> LimitState:
    """SLV by the activation alone: a_g,SLV = q a_g,SLD with q = 2, C8.7.1.2.1.7."""
    a0 = capacity.activation_acceleration / local.confidence_factor(settings)
    borne = None if activation is None else BEHAVIOUR_FACTOR * activation
    return LimitState(
        name="SLV",
        limit_acceleration=BEHAVIOUR_FACTOR * a0,
        limit_period=settings.elastic_period,
        damping=REFERENCE_DAMPING,
        acceleration_demand=activation_demand(spectrum, settings.elastic_period),
        **of_the_ground(spectrum, borne),
        satisfied=borne is None or borne >= spectrum.ground_acceleration,
        verified=verified,
        governed_by=say("governs.activation_q"),
        clause="Circ. 7/2019 C8.7.1.2.1.7",
    )


def assess(capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
    """Local mechanism by Circ. 7/2019 C8.7.1.2.1.

    Limit states SLD, SLV and, of the non-linear analysis, SLC.  A `FloorSpectrum` is for mechanisms
    at a height.

    Raises
    ------
    AssessmentError
        Without a confidence factor, or, in the non-linear analysis, without a collapse.
    """
    linear = local.is_linear(settings)
    if settings.elastic_period is not None:
        not_negative(settings.elastic_period, "elastic_period")
    c = capacity.read_as(settings.reading)
    factor = local.confidence_factor(settings)
    states = STATES[:2] if linear else STATES
    given, verified, notes = spectra_of(spectra, states, REFERENCE, settings)
    first = given.get("SLD") or next(iter(given.values()))
    active = activation_state(c, first, settings, "SLD" in verified)
    activation = active.ground_acceleration_capacity
    found = [active] if "SLD" in given else []
    for name in states[1:]:
        if name in given and linear:
            found.append(_linear_state(c, given[name], settings, activation, name in verified))
        elif name in given:
            found.append(
                _ultimate_state(name, c, given[name], settings, activation, name in verified)
            )
    used = tuple(given.values())
    return Assessment(
        method=NAME,
        capacity=c,
        settings=settings,
        limit_states=tuple(found),
        activation_acceleration=c.activation_acceleration / factor,
        confidence_factor=factor,
        spectra=given,
        quantities={
            "activation_ground_acceleration": activation,
            "linear_ground_acceleration": activation and BEHAVIOUR_FACTOR * activation,
            "elastic_period": settings.elastic_period,
        },
        assumptions=common.assumptions(c, used) + notes + _said(c, settings, given, linear),
        uncertain=common.uncertain(c, used, found, *_uncertain(c)),
        weighs_most=common.weight(c, _weight(found, linear)),
        caution=local.caution_of_linear(c) if linear else local.caution(c),
    )


def _said(
    capacity: Capacity, settings: Settings, given: Mapping[str, Spectrum], linear: bool
) -> tuple[str, ...]:
    """What was assumed by the method."""
    said: list[str] = []
    if settings.elastic_period is None:
        said.append(say("ntc2018_local.rigid"))
    if linear:
        return (*said, say("ntc2018_local.linear"))
    said.append(local.collapse_assumption())
    if settings.straight_capacity:
        said.append(say("ntc2018_local.straight"))
    if not settings.displacement_limits:
        said.append(_connections(capacity))
    for spectrum in given.values():
        if isinstance(spectrum, FloorSpectrum) and spectrum.acceleration < (
            spectrum.ground_acceleration * spectrum.soil_factor
        ):
            said.append(say("ntc2018_local.low_floor"))
            break
    top = capacity.spectral_displacement[capacity.peak_index]
    end = capacity.spectral_collapse_displacement
    if end is not None and top > RULES["SLV"].share * end:
        said.append(say("ntc2018_local.late_peak"))
    return tuple(said)


def _connections(capacity: Capacity) -> str:
    """What the curve knows of connections and supports up to the limit of the SLC."""
    end = capacity.collapse_displacement
    if capacity.losses is None or end is None:
        return say("ntc2018_local.not_looked")
    if capacity.losses_before(RULES["SLC"].share * end):
        return say("ntc2018_local.lost")
    return say("ntc2018_local.nothing_lost")


def _uncertain(capacity: Capacity) -> tuple[str, ...]:
    if capacity.reading == "base_shear":
        return ()
    return (say("ntc2018_local.reading", reading=capacity.reading),)


def _weight(found: list[LimitState], linear: bool) -> str:
    if linear:
        return say("ntc2018_local.weight_linear")
    for state in found:
        if state.governed_by == common.LOCAL and state.verified:
            return say("ntc2018_local.weight_limit", state=state.name)
    return ""
