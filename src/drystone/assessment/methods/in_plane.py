"""What methods for walls in their plane have in common: a bilinear stands for their curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from drystone.assessment.bilinear import RESIDUAL, Bilinear, drop_point
from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import common
from drystone.assessment.methods.base import Assessment, LimitState, Settings
from drystone.assessment.spectra.base import Spectrum
from drystone.common.language import say

#: Share of the momentum of a mechanism above which it is one out of plane.
OUT_OF_PLANE = 0.5


def ultimate(
    capacity: Capacity, settings: Settings, state: str, limit_name: str
) -> tuple[float, str]:
    """d* [m] where 80 per cent of the peak is left, and what sets it.

    A displacement limit of the ``state`` that is met before stands in its place; ``limit_name`` is
    what the method calls it.

    Raises
    ------
    AssessmentError
        The curve is not past 80 per cent of its peak, and no limit is met on it.
    """
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    given = settings.displacement_limits.get(state)
    try:
        own = drop_point(d, a, RESIDUAL["eighty_percent"])
    except AssessmentError:
        if given is None or capacity.spectral_at(given) > d[-1]:
            raise
        return capacity.spectral_at(given), limit_name
    limit, why = common.limit(capacity, settings, state, own)
    return limit, limit_name if why else say("in_plane.eighty")


def limits(capacity: Capacity, settings: Settings, own: Mapping[str, float]) -> dict[str, float]:
    """d* [m] of each state: the code's own, or of what fails before."""
    return {name: common.limit(capacity, settings, name, d)[0] for name, d in own.items()}


def answer(
    capacity: Capacity,
    settings: Settings,
    given: Mapping[str, Spectrum],
    found: Sequence[LimitState],
    curve: Bilinear,
    *,
    method: str,
    reference: str,
    residual: float | None = None,
    said: tuple[str, ...],
    uncertain: tuple[str, ...],
) -> Assessment:
    """The result of states on a bilinear.

    Parameters
    ----------
    residual
        Share of the peak that is left at the end of the bilinear, where the method tells it.
    said, uncertain
        What the method itself assumed, and what of it is uncertain.
    """
    used = tuple(given.values())
    caution, where = placed(capacity, method)
    first = next((s for s in found if s.name == reference), found[0])
    quantities = {
        "elastic_period": curve.period,
        "strength_ratio": first.details["strength_ratio"],
        "ductility_demand": first.details["ductility_demand"],
    }
    if residual is not None:
        quantities["residual_strength_ratio"] = residual
    if settings.confidence_factor is not None:
        said += (say("in_plane.confidence"),)
    return Assessment(
        method=method,
        capacity=capacity,
        settings=settings,
        limit_states=tuple(found),
        activation_acceleration=capacity.activation_acceleration,
        confidence_factor=None,
        spectra=given,
        bilinear=curve,
        quantities=quantities,
        assumptions=where + common.assumptions(capacity, used) + said,
        uncertain=common.uncertain(capacity, used, found, *uncertain),
        weighs_most=common.weight(
            capacity,
            say("in_plane.weight", place=curve.yield_displacement),
        ),
        caution=caution,
    )


def placed(capacity: Capacity, method: str) -> tuple[str, tuple[str, ...]]:
    """What goes with the verdict on a mechanism out of plane, and what the method is meant for."""
    share = capacity.out_of_plane
    caution: str = ""
    if share is None:
        how = say("in_plane.unknown")
    elif share > OUT_OF_PLANE:
        caution = say("in_plane.caution")
        how = say("in_plane.out", percent=100.0 * share)
    else:
        how = say("in_plane.by_sizes")
    return caution, (say("in_plane.placed", method=method, how=how),)
