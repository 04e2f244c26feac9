"""What methods for walls in their plane have in common: a bilinear stands for their curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from drystone.assessment.bilinear import RESIDUAL, Bilinear, drop_point
from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import common
from drystone.assessment.methods.base import Assessment, LimitState, Settings
from drystone.assessment.spectra.base import Spectrum

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
    return limit, limit_name if why else "80 per cent of the peak"


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
    caution, placed = _placed(capacity, method)
    first = next((s for s in found if s.name == reference), found[0])
    quantities = {
        "elastic_period": curve.period,
        "strength_ratio": first.details["strength_ratio"],
        "ductility_demand": first.details["ductility_demand"],
    }
    if residual is not None:
        quantities["residual_strength_ratio"] = residual
    if settings.confidence_factor is not None:
        said += (
            "The confidence factor divides strengths of materials in the model, not the curve: it "
            "is not applied here.",
        )
    return Assessment(
        method=method,
        capacity=capacity,
        settings=settings,
        limit_states=tuple(found),
        reference_state=reference,
        activation_acceleration=capacity.activation_acceleration,
        confidence_factor=None,
        spectra=given,
        bilinear=curve,
        quantities=quantities,
        assumptions=placed + common.assumptions(capacity, used) + said,
        uncertain=common.uncertain(capacity, used, found, *uncertain),
        weighs_most=common.weight(
            capacity,
            f"the bilinear, which yields at {curve.yield_displacement:.4g} m (other rules give "
            "other periods T*)",
        ),
        caution=caution,
    )


def _placed(capacity: Capacity, method: str) -> tuple[str, tuple[str, ...]]:
    """What goes with the verdict on a mechanism out of plane, and what the method is meant for."""
    share = capacity.out_of_plane
    if share is None:
        said = "whether the mechanism is one was not looked at"
    elif share > OUT_OF_PLANE:
        caution = (
            "the mechanism is out of plane, for which this method is not meant: take one for local "
            "mechanisms"
        )
        said = (
            f"by the sizes of what moves {100.0 * share:.0f} per cent of the momentum is of walls "
            "no thicker along the motion than across it, out of their plane; methods for local "
            "mechanisms are meant for that (Circ. 7/2019 C8.7.1.2)"
        )
        return caution, (f"{method} is for walls that move in their plane: {said}.",)
    else:
        said = "that the model shows one, and no section through a wall, is taken from its sizes"
    return "", (f"{method} is for walls that move in their plane: {said}.",)
