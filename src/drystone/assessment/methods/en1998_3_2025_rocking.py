"""Rocking mechanisms by EN 1998-3:2025, 11.3.3.3, 11.4.2(5) and 11.5.2.2, as far as known.

The standard's text was not at hand.  What is unknown, the damping of each limit state and gamma_Sd,
is asked for.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError, MissingError, not_negative, positive
from drystone.assessment.methods import common, local
from drystone.assessment.methods.base import Assessment, LimitState, Settings, Spectra, spectra_of
from drystone.assessment.methods.ground import bearable, of_the_ground
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum, damping_factor
from drystone.assessment.spectra.floor import FloorSpectrum
from drystone.common.keys import ByState, Choice, Flag, Key, Number
from drystone.common.language import Saying, say
from drystone.common.ranges import POSITIVE, Range

NAME = "en1998-3-2025-rocking"
STATES = ("DL", "SD", "NC")
MORE_STATES: tuple[str, ...] = ()
READINGS = ("base_shear",)
REFERENCE = "SD"
KEYS: tuple[Key, ...] = (
    # xi by limit state.
    Key(
        name="damping",
        type=ByState(Number(Range(least=0.0, most=99.9, unit="percent"))),
        default=None,
    ),
    Key(name="demand_factor", type=Number(POSITIVE), default=None),  # gamma_Sd
    Key(name="knowledge_level", type=Choice((1, 2, 3)), default=None),
    Key(name="infinitely_strong_blocks", type=Flag(), default=None),
)

#: d_LS over the collapse displacement d0*, 11.5.2.2.
SHARES = {"SD": 0.4, "NC": 0.6}

#: T_LS = 1.6 pi sqrt(d_LS/a*(d_LS)), (11.40), (11.41).
PERIOD_FACTOR = 1.6

#: gamma_Rd by knowledge level, and what it is multiplied by with infinitely strong blocks.
RESISTANCE_FACTORS = {1: 1.55, 2: 1.40, 3: 1.30}
STRONG_BLOCKS = 1.2

UNCERTAIN = (
    say("en1998_3_2025.text"),
    say("en1998_3_2025.values"),
)


def limit_period(displacement: float, acceleration: float) -> float:
    """T_LS = 1.6 pi sqrt(d_LS/a*(d_LS)) [s], EN 1998-3:2025 (11.40), (11.41)."""
    return PERIOD_FACTOR * math.pi * math.sqrt(displacement / acceleration)


def resistance_factor(knowledge_level: int, infinitely_strong_blocks: bool) -> float:
    """gamma_Rd, 11.5.2.2: 1.55, 1.40, 1.30 for KL1 to KL3, times 1.2 with strong blocks."""
    if knowledge_level not in RESISTANCE_FACTORS:
        raise AssessmentError(f"there is no knowledge level {knowledge_level!r}: 1, 2 or 3")
    factor = RESISTANCE_FACTORS[knowledge_level]
    return factor * STRONG_BLOCKS if infinitely_strong_blocks else factor


class _Factors(NamedTuple):
    demand: float  # gamma_Sd
    resistance: float  # gamma_Rd


def displacement_demand(spectrum: Spectrum, period: float, damping: float) -> float:
    """eta(xi) S_De(T_LS) [m], (11.42), (11.43); the spectrum of the floor, (11.44), (11.45).

    Floor spectra know their damping: eta is not applied to them again.
    """
    if isinstance(spectrum, FloorSpectrum):
        return float(spectrum.sd(period, damping))
    return damping_factor(damping) * float(spectrum.sd(period, REFERENCE_DAMPING))


def _factors(settings: Settings) -> _Factors:
    unknown = "its value in the standard is not known here; give the one that you answer for"
    demand = positive(settings.need("demand_factor", f"gamma_Sd, {unknown}"), "gamma_Sd")
    level = settings.need("knowledge_level", "gamma_Rd is 1.55, 1.40 or 1.30 of KL1 to KL3")
    strong = settings.need(
        "infinitely_strong_blocks",
        "gamma_Rd is 1.2 times as large where blocks are not crushed (true for rigid blocks)",
    )
    return _Factors(demand, resistance_factor(level, bool(strong)))


def _activation(
    capacity: Capacity, spectrum: Spectrum, settings: Settings, factors: _Factors, verified: bool
) -> LimitState:
    """DL: gamma_Sd S_e(T_0) <= a_y*/gamma_Rd, 11.5.2.2."""
    t0 = not_negative(
        settings.need("elastic_period", "DL compares S_e(T_0); 0 where rigid until it rocks"),
        "elastic_period",
    )

    def demand(s: Spectrum) -> float:
        return factors.demand * float(s.sa(t0, REFERENCE_DAMPING))

    limit = capacity.activation_acceleration / factors.resistance
    borne = bearable(spectrum, demand, limit)
    return LimitState(
        name="DL",
        limit_acceleration=limit,
        limit_period=t0,
        damping=REFERENCE_DAMPING,
        acceleration_demand=demand(spectrum),
        **of_the_ground(spectrum, borne),
        satisfied=demand(spectrum) <= limit,
        verified=verified,
        governed_by=say("governs.activation"),
        clause="EN 1998-3:2025 11.5.2.2",
    )


def _ultimate(
    name: str,
    capacity: Capacity,
    spectrum: Spectrum,
    settings: Settings,
    factors: _Factors,
    verified: bool,
) -> LimitState:
    """SD, NC: gamma_Sd eta S_De(T_LS) <= d_LS/gamma_Rd, (11.42) to (11.45).

    The demand of the result holds gamma_Sd, the limit d_LS is as it is; d_LS/gamma_Rd is beside it.
    """
    own = SHARES[name] * local.collapse(capacity, settings)
    d, why = common.limit(capacity, settings, name, own)
    a = local.acceleration(capacity, d, local.is_straight(capacity, settings))
    period, damping = limit_period(d, a), settings.need("damping", "xi of the limit state")[name]

    def demand(s: Spectrum) -> float:
        return factors.demand * displacement_demand(s, period, damping)

    borne = bearable(spectrum, demand, d / factors.resistance)
    asked = demand(spectrum)
    return LimitState(
        name=name,
        limit_displacement=d,
        limit_control_displacement=capacity.control_at(d),
        limit_acceleration=a,
        limit_period=period,
        damping=damping,
        displacement_demand=asked,
        control_displacement_demand=capacity.control_at(asked),
        **of_the_ground(spectrum, borne),
        satisfied=asked <= d / factors.resistance,
        verified=verified,
        governed_by=why or say("governs.share", share=SHARES[name]),
        clause=say("clause.rocking_2025"),
        details={"factored_limit_displacement": d / factors.resistance},
    )


def assess(capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
    """Rocking mechanism by EN 1998-3:2025 11.5.2.2: limit states DL, SD and NC.

    A state whose damping (SD, NC) or elastic period (DL) is not given is left out, and that is
    said, unless `Settings.limit_states` names it or it is the reference state.

    Raises
    ------
    AssessmentError
        Without gamma_Sd, knowledge level, the strength of blocks, damping, or a collapse.
    """
    c = capacity.read_as(settings.reading)
    factors = _factors(settings)
    given, verified, notes = spectra_of(spectra, STATES, REFERENCE, settings)
    owed = settings.limit_states or ((REFERENCE,) if REFERENCE in given else verified)
    found, left_out = [], []
    for name, spectrum in given.items():
        is_verified = name in verified
        if name == "DL":
            if settings.elastic_period is None and name not in owed:
                left_out.append(say("en1998_3_2025.no_period"))
                continue
            found.append(_activation(c, spectrum, settings, factors, is_verified))
        elif name in (settings.get("damping") or {}):
            found.append(_ultimate(name, c, spectrum, settings, factors, is_verified))
        elif name in owed:
            raise MissingError(
                f'method "{NAME}" needs "damping" of {name}: the standard\'s value is not known '
                "here; give the ratio that you answer for"
            )
        else:
            left_out.append(say("en1998_3_2025.no_damping", state=name))
    used = tuple(given[state.name] for state in found)
    return Assessment(
        method=NAME,
        capacity=c,
        settings=settings,
        limit_states=tuple(found),
        activation_acceleration=c.activation_acceleration,
        confidence_factor=None,
        spectra=given,
        quantities={"resistance_factor": factors.resistance, "demand_factor": factors.demand},
        assumptions=common.assumptions(c, used) + notes + _said(left_out, settings),
        uncertain=common.uncertain(c, used, found, *_uncertain(used)),
        weighs_most=common.weight(c, say("en1998_3_2025.weight")),
        caution=local.caution(c),
    )


def _said(left_out: list[Saying], settings: Settings) -> tuple[str, ...]:
    """What was assumed by the method."""
    said = [local.collapse_assumption()]
    if left_out:
        said.append(say("en1998_3_2025.left_out", states=left_out))
    if settings.confidence_factor is not None:
        said.append(say("en1998_3_2025.resistance"))
    return tuple(said)


def _uncertain(used: tuple[Spectrum, ...]) -> tuple[str, ...]:
    said = list(UNCERTAIN)
    if any(isinstance(s, FloorSpectrum) for s in used):
        said.append(say("en1998_3_2025.floor"))
    return tuple(said)
