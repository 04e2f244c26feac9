"""Global in-plane analysis by NTC 2018: Circolare 7/2019, C7.3.4.2 and C8.7.1.3.1."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from drystone.assessment.bilinear import SECANT_SHARE, Bilinear, bilinear
from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import common, in_plane
from drystone.assessment.methods.base import Assessment, LimitState, Settings, Spectra, spectra_of
from drystone.assessment.methods.ground import bearable, of_the_ground, summit
from drystone.assessment.methods.inelastic import check_on_the_ground, target
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum
from drystone.common.keys import Choice, Key, Number
from drystone.common.language import say
from drystone.common.ranges import Range

NAME = "ntc2018-global"
STATES = ("SLO", "SLD", "SLV", "SLC")
MORE_STATES: tuple[str, ...] = ()
READINGS = ("base_shear",)
REFERENCE = "SLV"
KEYS: tuple[Key, ...] = (
    Key(name="procedure", type=Choice(("A", "B")), default=None),
    # Of procedure B.
    Key(name="dissipation", type=Choice(("high", "moderate", "low")), default=None),
    # Of the peak; 0.6 in NTC 2018.
    Key(name="secant_share", type=Number(Range(least=1e-6, most=0.999)), default=None),
)

#: SLV at this share of the displacement of the SLC, SLO of that of the SLD: C8.7.1.3.1.
LIFE_SHARE, OPERATION_SHARE = 0.75, 2.0 / 3.0

#: Largest q* up to which the analysis is valid, C8.7.1.3.1.
MOST_STRENGTH_RATIO = {"SLV": 3.0, "SLC": 4.0}

#: k of (C7.3.10) by capacity of dissipation.
DISSIPATION = {"high": 1.0, "moderate": 0.66, "low": 0.33}

UNCERTAIN = (say("ntc2018_global.groups"),)

#: Displacements at which procedure B looks for its intersection.
N_POINTS = 32

#: Ground accelerations that one such displacement is searched among.
N_COARSE = 24


class Equivalent(NamedTuple):
    """The linear oscillator of procedure B at a displacement."""

    period: float  # s, on the secant
    damping: float  # ratio


def equivalent_damping(
    yield_acceleration: float,
    yield_displacement: float,
    acceleration: float,
    displacement: float,
    dissipation: float,
) -> float:
    """xi_eq, a ratio: 5 + 63.7 k (F_y d_max - F_max d_y)/(F_max d_max) per cent, (C7.3.10)."""
    loop = yield_acceleration * displacement - acceleration * yield_displacement
    share = loop / (acceleration * displacement)
    return 0.05 + 0.637 * dissipation * max(share, 0.0)


def yield_at(capacity: Capacity, stiffness: float, displacement: float) -> tuple[float, float]:
    """d*_y, F*_y/m* of the bilinear through the curve's point at d* [m] with the curve's area.

    Its first branch has the stiffness given; the second one ends on the curve.
    """
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    if d[0] > 0.0:
        d, a = np.append(0.0, d), np.append(0.0, a)
    end = capacity.acceleration_at(displacement)
    before = d < displacement
    x, y = np.append(d[before], displacement), np.append(a[before], end)
    area = float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))
    if stiffness * displacement <= end * (1.0 + 1e-12):
        return displacement, end
    first = (2.0 * area - end * displacement) / (stiffness * displacement - end)
    first = min(max(first, 0.0), displacement)
    return first, stiffness * first


def equivalent(
    capacity: Capacity, stiffness: float, displacement: float, dissipation: float
) -> Equivalent:
    """Secant period and damping of procedure B at d* [m], C7.3.4.2."""
    a = capacity.acceleration_at(displacement)
    if a <= 0.0:
        raise AssessmentError(f"nothing is carried at d* = {displacement:.4g} m")
    first, level = yield_at(capacity, stiffness, displacement)
    damping = equivalent_damping(level, first, a, displacement, dissipation)
    return Equivalent(2.0 * math.pi * math.sqrt(displacement / a), damping)


class _Procedure(NamedTuple):
    """What a displacement demand and a bearable acceleration are of."""

    demand: Callable[[Spectrum], float | None]
    borne: Callable[[Spectrum, float], float | None]
    damping: Callable[[float], float]


def _procedure_a(curve: Bilinear) -> _Procedure:
    """(C7.3.7), (C7.3.8): without the limit to three times the elastic displacement."""
    return _Procedure(
        demand=lambda s: target(s, curve).displacement,
        borne=lambda s, limit: bearable(s, lambda x: target(x, curve).displacement, limit),
        damping=lambda _: REFERENCE_DAMPING,
    )


def _procedure_b(
    capacity: Capacity, stiffness: float, dissipation: float, end: float
) -> _Procedure:
    """Intersection of the curve up to d* = end [m] with the spectrum reduced for xi_eq, (C7.3.10).

    There is no demand where they do not meet.
    """

    def at(d: float) -> Equivalent:
        return equivalent(capacity, stiffness, d, dissipation)

    def excess(spectrum: Spectrum, d: float) -> float:
        period, damping = at(d)
        return float(spectrum.sd(period, damping)) - d

    def demand(spectrum: Spectrum) -> float | None:
        grid = np.linspace(0.0, end, 8 * N_POINTS + 1)[1:]
        last = 0.0
        for d in grid.tolist():
            if excess(spectrum, d) <= 0.0:
                return _falling_zero(lambda x: excess(spectrum, x), last, d)
            last = d
        return None

    def acceleration(spectrum: Spectrum, d: float) -> float:
        period, damping = at(d)
        value = bearable(spectrum, lambda s: float(s.sd(period, damping)), d, N_COARSE)
        return math.inf if value is None else value

    def borne(spectrum: Spectrum, limit: float) -> float | None:
        grid = np.linspace(0.0, limit, N_POINTS + 1)[1:]
        values = [acceleration(spectrum, d) for d in grid.tolist()]
        best = int(np.argmax(values))
        if best == len(values) - 1 or best == 0:
            top = values[best]
        else:
            where = summit(
                lambda d: acceleration(spectrum, d), float(grid[best - 1]), float(grid[best + 1])
            )
            top = acceleration(spectrum, where)
        return None if math.isinf(top) else top

    return _Procedure(demand=demand, borne=borne, damping=lambda d: at(d).damping)


def _falling_zero(value: Callable[[float], float], low: float, high: float) -> float:
    """Where a function above zero at ``low`` (not called there) falls to zero."""
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high
        if value(middle) <= 0.0:
            high = middle
        else:
            low = middle


def limit_displacements(
    curve: Bilinear, ultimate: float, capacity: Capacity, settings: Settings
) -> dict[str, float]:
    """d of SLO, SLD, SLV, SLC [m]: 2/3 SLD, d*_y, 3/4 SLC, SLC, C8.7.1.3.1; or what fails before.

    The SLD of a building with several piers may be less: the displacement at which all of them have
    met their strength is the user's limit.
    """
    damage, _ = common.limit(capacity, settings, "SLD", curve.yield_displacement)
    own = {
        "SLO": OPERATION_SHARE * damage,
        "SLD": damage,
        "SLV": LIFE_SHARE * ultimate,
        "SLC": ultimate,
    }
    return in_plane.limits(capacity, settings, own)


def _state(
    name: str,
    limit: float,
    capacity: Capacity,
    curve: Bilinear,
    procedure: _Procedure,
    spectrum: Spectrum,
    verified: bool,
) -> LimitState:
    """d*_max against the limit, and q* against its own, C7.3.4.2 and C8.7.1.3.1."""
    found = target(spectrum, curve)
    demand = procedure.demand(spectrum)
    by_displacement = procedure.borne(spectrum, limit)
    borne, why = by_displacement, say("governs.displacement")
    most = MOST_STRENGTH_RATIO.get(name)
    by_ratio = None
    if most is not None:
        by_ratio = bearable(spectrum, lambda s: target(s, curve).strength_ratio, most)
        if by_ratio is not None and (borne is None or by_ratio < borne):
            borne, why = by_ratio, say("governs.strength_ratio", most=most)
    return LimitState(
        name=name,
        limit_displacement=limit,
        limit_control_displacement=capacity.control_at(limit),
        limit_acceleration=float(curve.at(limit)),
        limit_period=curve.period,
        damping=procedure.damping(limit),
        displacement_demand=demand,
        control_displacement_demand=None if demand is None else capacity.control_at(demand),
        **of_the_ground(spectrum, borne),
        satisfied=(
            demand is not None
            and demand <= limit
            and (most is None or found.strength_ratio <= most)
        ),
        verified=verified,
        governed_by=why,
        clause=say("clause.global"),
        details={
            "elastic_displacement_demand": found.elastic_displacement,
            "strength_ratio": found.strength_ratio,
            "largest_strength_ratio": most,
            "ductility_demand": None if demand is None else demand / curve.yield_displacement,
            "ground_acceleration_of_displacement": by_displacement,
            "ground_acceleration_of_strength_ratio": by_ratio,
        },
    )


def _procedure(capacity: Capacity, curve: Bilinear, settings: Settings) -> tuple[_Procedure, str]:
    """Procedure A or B of the settings, both with the bilinear's first branch, and what was
    assumed."""
    name = settings.get("procedure") or "A"
    if name == "A":
        return _procedure_a(curve), say("ntc2018_global.procedure_a")
    if name != "B":
        raise AssessmentError(f'procedure "{name}" is not known: "A" or "B" of C7.3.4.2')
    kind = settings.need(
        "dissipation", 'k of (C7.3.10) is that of "high", "moderate" or "low"; rocking is low'
    )
    if kind not in DISSIPATION:
        raise AssessmentError(f'dissipation "{kind}" is not known: {", ".join(DISSIPATION)}')
    stiffness = curve.yield_acceleration / curve.yield_displacement
    ultimate = curve.ultimate_displacement
    factor = DISSIPATION[kind]
    said = say("ntc2018_global.procedure_b", kind=say(f"ntc2018_global.{kind}"), factor=factor)
    return _procedure_b(capacity, stiffness, factor, ultimate), said


def assess(capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
    """In-plane pushover of a wall or building: limit states SLO, SLD, SLV and SLC.

    The confidence factor divides strengths of materials before the curve is traced, not the curve.

    Raises
    ------
    AssessmentError
        Where the curve is not past 80 per cent of its peak and no drift limit is given, or has no
        elastic branch.
    """
    c = capacity.read_as(settings.reading)
    given, verified, notes = spectra_of(spectra, STATES, REFERENCE, settings)
    check_on_the_ground(given.values(), NAME)
    ultimate, why = in_plane.ultimate(c, settings, "SLC", say("in_plane.drift"))
    share = settings.get("secant_share") or SECANT_SHARE
    curve = bilinear(
        c.spectral_displacement,
        c.spectral_acceleration,
        "eighty_percent",
        ultimate=ultimate,
        secant_share=share,
    )
    procedure, said = _procedure(c, curve, settings)
    limits = limit_displacements(curve, ultimate, c, settings)
    found = [
        _state(name, limits[name], c, curve, procedure, spectrum, name in verified)
        for name, spectrum in given.items()
    ]
    top = c.spectral_acceleration.max()
    return in_plane.answer(
        c,
        settings,
        given,
        found,
        curve,
        method=NAME,
        reference=REFERENCE,
        residual=c.acceleration_at(ultimate) / top,
        said=(*notes, said, *_said(settings, why, share)),
        uncertain=UNCERTAIN,
    )


def _said(settings: Settings, why: str, share: float) -> tuple[str, ...]:
    said = [
        say("ntc2018_global.collapse", why=why, share=share),
        say("ntc2018_global.distribution"),
    ]
    if "SLC" not in settings.displacement_limits:
        said.append(say("ntc2018_global.no_drift"))
    return tuple(said)
