"""What methods for local mechanisms have in common."""

from __future__ import annotations

from drystone.assessment.capacity import Capacity, slides
from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.methods.base import Settings
from drystone.common.language import say


def is_linear(settings: Settings) -> bool:
    """Whether the activation multiplier alone counts; `AssessmentError` for other kinematics."""
    if settings.kinematics not in ("linear", "nonlinear"):
        raise AssessmentError(
            f'kinematics "{settings.kinematics}" is not known: "linear" or "nonlinear"'
        )
    return settings.kinematics == "linear"


def confidence_factor(settings: Settings) -> float:
    """FC, which divides accelerations."""
    why = (
        "1.35 for blocks that are not crushed whatever the knowledge level, Circ. 7/2019 "
        "C8.7.1.2.1.3; 1.35, 1.20 or 1.00 of LC1 to LC3 otherwise"
    )
    factor = positive(settings.need("confidence_factor", why), "the confidence factor")
    if factor < 1.0:
        raise AssessmentError(f"a confidence factor is 1 or more, not {factor:g}")
    return factor


def collapse(capacity: Capacity, settings: Settings) -> float:
    """d0* [m]; `AssessmentError` where the curve has no collapse."""
    end = capacity.spectral_collapse_displacement
    if end is None:
        raise AssessmentError(say("refused.no_collapse", method=settings.method))
    return end


def is_straight(capacity: Capacity, settings: Settings, own: bool = False) -> bool:
    """Whether the line a0 (1 - d/d0) replaces the curve: as asked, or as the method has it (own).

    The line is that of forces that stay constant, from the activation to the collapse.  Where a tie
    yields or breaks, or a part falls, it is that of no structure: it would join the strength before
    with the collapse after.

    Raises
    ------
    AssessmentError
        The line is asked for, and is none.
    """
    asked = settings.straight_capacity
    changed = capacity.first_change
    if asked and changed is not None:
        raise AssessmentError(say("refused.no_line", what=changed.what))
    return bool(own if asked is None else asked) and changed is None


def acceleration(capacity: Capacity, displacement: float, straight: bool) -> float:
    """a* [m/s2] at d* [m], of the curve or of the straight line a0 (1 - d/d0)."""
    if straight:
        end = capacity.spectral_collapse_displacement
        assert end is not None
        value = capacity.activation_acceleration * (1.0 - displacement / end)
    else:
        value = capacity.acceleration_at(displacement)
    if value <= 0.0:
        raise AssessmentError(say("refused.nothing_carried", place=displacement))
    return value


def collapse_assumption() -> str:
    """What d0 stands on."""
    return say("common.collapse")


def caution_of_linear(capacity: Capacity) -> str:
    """What goes with a verdict by the activation times q: q stands for the displacements that a
    mechanism is capable of, and where a tie breaks on the way these are not those of the strength
    that is multiplied."""
    lost = capacity.first_loss
    return "" if lost is None else say("local.brittle", what=lost.what)


def caution(capacity: Capacity) -> str:
    """What goes with the verdict on a mechanism that slides: blocks that slide lose no strength
    until they fall off what bears them, however far that is."""
    share = capacity.friction
    if share is None or not slides(share):
        return ""
    return say("local.slides", percent=100.0 * share)
