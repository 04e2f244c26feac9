"""The N2 method of EN 1998-1:2004 Annex B with the limit states of EN 1998-3:2004 Annex C."""

from __future__ import annotations

from drystone.assessment.bilinear import Bilinear, bilinear
from drystone.assessment.capacity import Capacity
from drystone.assessment.methods import in_plane
from drystone.assessment.methods.base import Assessment, LimitState, Settings, Spectra, spectra_of
from drystone.assessment.methods.ground import bearable, of_the_ground
from drystone.assessment.methods.inelastic import EC8_MOST, check_on_the_ground, target
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum
from drystone.common.keys import Key
from drystone.common.language import say

NAME = "ec8-n2"
STATES = ("DL", "SD", "NC")
MORE_STATES: tuple[str, ...] = ()
READINGS = ("base_shear", "literal_ec8")
REFERENCE = "SD"
KEYS: tuple[Key, ...] = ()

#: SD at three quarters of NC, where 80 per cent of the peak is left: EN 1998-3:2004 C.3.3.
SIGNIFICANT_SHARE = 0.75

#: The curve is to reach this many target displacements, EN 1998-1:2004 4.3.3.4.2.3(1).
REACH = 1.5

UNCERTAIN = say("ec8_n2.text")


def _state(
    name: str,
    limit: float,
    capacity: Capacity,
    curve: Bilinear,
    spectrum: Spectrum,
    verified: bool,
) -> LimitState:
    """d*_t against the limit, (B.8) to (B.13)."""
    found = target(spectrum, curve, EC8_MOST)
    borne = bearable(spectrum, lambda s: target(s, curve, EC8_MOST).displacement, limit)
    return LimitState(
        name=name,
        limit_displacement=limit,
        limit_control_displacement=capacity.control_at(limit),
        limit_acceleration=float(curve.at(limit)),
        limit_period=curve.period,
        damping=REFERENCE_DAMPING,
        displacement_demand=found.displacement,
        control_displacement_demand=capacity.control_at(found.displacement),
        **of_the_ground(spectrum, borne),
        satisfied=found.displacement <= limit,
        verified=verified,
        governed_by=say("governs.displacement"),
        clause=say("clause.ec8"),
        details={
            "elastic_displacement_demand": found.elastic_displacement,
            "strength_ratio": found.strength_ratio,
            "ductility_demand": found.ductility,
        },
    )


def assess(capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
    """In-plane pushover by EN 1998-1:2004 Annex B: limit states DL, SD and NC.

    The confidence factor divides strengths of materials before the curve is traced, not the curve.

    Raises
    ------
    AssessmentError
        Where the curve is not past 80 per cent of its peak and no limit of NC is given, or has no
        elastic branch.
    """
    c = capacity.read_as(settings.reading)
    given, verified, notes = spectra_of(spectra, STATES, REFERENCE, settings)
    check_on_the_ground(given.values(), NAME)
    ultimate, why = in_plane.ultimate(c, settings, "NC", say("in_plane.limit"))
    d, a = c.spectral_displacement, c.spectral_acceleration
    curve = bilinear(d, a, "ec8", ultimate=ultimate)
    own = {
        "DL": curve.yield_displacement,
        "SD": SIGNIFICANT_SHARE * ultimate,
        "NC": ultimate,
    }
    limits = in_plane.limits(c, settings, own)
    found = [
        _state(name, limits[name], c, curve, spectrum, name in verified)
        for name, spectrum in given.items()
    ]
    return in_plane.answer(
        c,
        settings,
        given,
        found,
        curve,
        method=NAME,
        reference=REFERENCE,
        said=notes + _said(c, found, why),
        uncertain=(UNCERTAIN,),
    )


def _said(capacity: Capacity, found: list[LimitState], why: str) -> tuple[str, ...]:
    """What was assumed by the method."""
    last = float(capacity.spectral_displacement[-1])
    short = [
        say("ec8_n2.short", last=last, state=state.name)
        for state in found
        if state.displacement_demand is not None and last < REACH * state.displacement_demand
    ]
    return (say("ec8_n2.near_collapse", why=why), *short)
