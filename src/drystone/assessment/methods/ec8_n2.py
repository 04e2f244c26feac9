"""The N2 method of EN 1998-1:2004 Annex B with the limit states of EN 1998-3:2004 Annex C."""

from __future__ import annotations

from drystone.assessment.bilinear import Bilinear, bilinear, drop_point
from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import local
from drystone.assessment.methods.base import (
    Assessment,
    LimitState,
    Settings,
    Spectra,
    spectra_of,
)
from drystone.assessment.methods.ground import (
    RETURN_PERIOD_UNCERTAIN,
    bearable,
    return_period_borne,
)
from drystone.assessment.methods.inelastic import (
    EC8_MOST,
    Target,
    check_on_the_ground,
    target,
)
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum

NAME = "ec8-n2"
STATES = ("DL", "SD", "NC")
REFERENCE = "SD"

#: NC where this share of the peak is left, SD at three quarters of NC: EN 1998-3:2004 C.3.3.
RESIDUAL, SIGNIFICANT_SHARE = 0.8, 0.75

#: The curve is to reach this many target displacements, EN 1998-1:2004 4.3.3.4.2.3(1).
REACH = 1.5

UNCERTAIN = (
    "EN 1998-1:2004 Annex B and EN 1998-3:2004 Annex C: from memory and second hand, not checked "
    "against the standards' text."
)


def near_collapse(capacity: Capacity, settings: Settings) -> tuple[float, str]:
    """d_NC [m], d*: where the strength is down to 80 per cent of the peak, C.3.3; what sets it.

    A displacement limit of NC that is met before stands in its place.
    """
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    given = settings.displacement_limits.get("NC")
    try:
        own = drop_point(d, a, RESIDUAL)
    except AssessmentError:
        if given is None or capacity.spectral_at(given) > d[-1]:
            raise
        return capacity.spectral_at(given), "displacement limit"
    limit, why = local.limit(capacity, settings, "NC", own)
    return limit, "displacement limit" if why else "80 per cent of the peak"


def limit_displacements(
    curve: Bilinear, ultimate: float, capacity: Capacity, settings: Settings
) -> dict[str, float]:
    """d_DL = d*_y, d_SD = 3/4 d_NC, d_NC [m], EN 1998-3:2004 C.3.3, or what fails before."""
    own = {
        "DL": curve.yield_displacement,
        "SD": SIGNIFICANT_SHARE * ultimate,
        "NC": ultimate,
    }
    return {name: local.limit(capacity, settings, name, d)[0] for name, d in own.items()}


def target_displacement(
    capacity: Capacity, spectrum: Spectrum, *, ultimate: float, iterate: bool = False
) -> tuple[Target, Bilinear]:
    """d*_t of the bilinear up to d*_m, EN 1998-1:2004 (B.6) to (B.12), and that bilinear.

    Parameters
    ----------
    ultimate
        The first d*_m [m].
    iterate
        Whether d*_m := d*_t is repeated until both agree, B.4(3); d*_m never exceeds ``ultimate``.
    """
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    curve = bilinear(d, a, "ec8", ultimate=ultimate)
    found = target(spectrum, curve, EC8_MOST)
    for _ in range(100 if iterate else 0):
        end = min(found.displacement, ultimate)
        if abs(end - curve.ultimate_displacement) <= 1e-10 * ultimate:
            break
        curve = bilinear(d, a, "ec8", ultimate=end)
        found = target(spectrum, curve, EC8_MOST)
    return found, curve


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
        ground_acceleration_capacity=borne,
        ground_acceleration_demand=spectrum.ground_acceleration,
        return_period_demand=spectrum.return_period,
        return_period_capacity=return_period_borne(spectrum, borne),
        satisfied=found.displacement <= limit,
        verified=verified,
        governed_by="displacement",
        clause="EN 1998-1:2004 (B.8) to (B.13), EN 1998-3:2004 C.3.3",
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
    c = local.read(capacity, settings)
    given, verified, notes = spectra_of(spectra, STATES, REFERENCE, settings)
    check_on_the_ground(given.values(), NAME)
    ultimate, why = near_collapse(c, settings)
    d, a = c.spectral_displacement, c.spectral_acceleration
    curve = bilinear(d, a, "ec8", ultimate=ultimate)
    limits = limit_displacements(curve, ultimate, c, settings)
    found = [
        _state(name, limits[name], c, curve, spectrum, name in verified)
        for name, spectrum in given.items()
    ]
    used = tuple(given.values())
    reference = next((s for s in found if s.name == REFERENCE), found[0])
    own = [UNCERTAIN]
    if any(state.return_period_capacity is not None for state in found):
        own.append(RETURN_PERIOD_UNCERTAIN)
    return Assessment(
        method=NAME,
        capacity=c,
        settings=settings,
        limit_states=tuple(found),
        reference_state=REFERENCE,
        activation_acceleration=c.activation_acceleration,
        confidence_factor=None,
        spectra=given,
        bilinear=curve,
        quantities={
            "elastic_period": curve.period,
            "strength_ratio": reference.details["strength_ratio"],
            "ductility_demand": reference.details["ductility_demand"],
        },
        assumptions=local.assumptions(c, used) + notes + _said(c, found, why, settings),
        uncertain=local.uncertain(c, used, *own),
        weighs_most=local.weight(
            c,
            f"the bilinear, which yields at {curve.yield_displacement:.4g} m (other rules give "
            "other periods T*)",
        ),
    )


def _said(
    capacity: Capacity, found: list[LimitState], why: str, settings: Settings
) -> tuple[str, ...]:
    """What was assumed by the method."""
    last = float(capacity.spectral_displacement[-1])
    said = [f"NC: {why}; the bilinear ends there (EN 1998-1:2004 B.3)."]
    said += [
        f"The curve ends at {last:.4g} m, short of 1.5 times the target displacement of "
        f"{state.name} (EN 1998-1:2004 4.3.3.4.2.3(1))."
        for state in found
        if state.displacement_demand is not None and last < REACH * state.displacement_demand
    ]
    if settings.confidence_factor is not None:
        said.append(
            "The confidence factor divides strengths of materials in the model, not the curve: it "
            "is not applied here."
        )
    return tuple(said)
