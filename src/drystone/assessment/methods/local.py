"""What methods for local mechanisms have in common."""

from __future__ import annotations

from collections.abc import Sequence

from drystone.assessment.capacity import READINGS, Capacity
from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.methods.base import Settings
from drystone.assessment.spectra.base import Spectrum


def read(capacity: Capacity, settings: Settings) -> Capacity:
    """The capacity in the reading of the settings."""
    return capacity.read_as(settings.reading)


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
        raise AssessmentError(
            f'method "{settings.method}" needs the displacement at which nothing is carried any '
            "more, and the curve does not come down to it: trace it further, to a smaller "
            "stop_multiplier and a larger max_displacement (ntc2018-local and ntc2009-local do "
            'with kinematics = "linear", for which the activation multiplier is enough)'
        )
    return end


def limit(capacity: Capacity, settings: Settings, state: str, own: float) -> tuple[float, str]:
    """d_LS [m] as the lesser of the code's own and of what fails locally; and which it was."""
    given = settings.displacement_limits.get(state)
    if given is None:
        return own, ""
    local = capacity.spectral_at(positive(given, f"the displacement limit of {state}"))
    return (local, "local displacement limit") if local < own else (own, "")


def acceleration(capacity: Capacity, displacement: float, straight: bool) -> float:
    """a* [m/s2] at d* [m], of the curve or of the straight line a0 (1 - d/d0)."""
    if straight:
        end = capacity.spectral_collapse_displacement
        assert end is not None
        value = capacity.activation_acceleration * (1.0 - displacement / end)
    else:
        value = capacity.acceleration_at(displacement)
    if value <= 0.0:
        raise AssessmentError(
            f"nothing is carried at d* = {displacement:.4g} m, where a limit state lies: the curve "
            "ends before; check its collapse displacement"
        )
    return value


def assumptions(capacity: Capacity, spectra: Sequence[Spectrum]) -> tuple[str, ...]:
    """Sentences of capacity and spectra, each once."""
    said = [
        *capacity.notes,
        f"Reading {capacity.reading}: {READINGS[capacity.reading]}.",
    ]
    if capacity.reading == "energy" and capacity.kinetic_factor is None:
        said.append(
            "The kinetic energy is that of the bodies' centroids along the load alone: what they "
            "turn and rise is left out, so that one body alone counts as a third too stiff."
        )
    if capacity.collapse_extrapolated:
        said.append(
            "The collapse displacement lies beyond the last point of the curve: it is "
            "extrapolated along a straight line."
        )
    said += [note for spectrum in spectra for note in spectrum.notes]
    return tuple(dict.fromkeys(said))


def collapse_assumption() -> str:
    """What d0 stands on."""
    return (
        "The collapse displacement is that of the curve given: only actions that last to the "
        "collapse may be in it, no ties, neighbours' friction or arches that are lost before "
        "(Circ. 7/2019 C8.7.1.2.1.6)."
    )


def uncertain(capacity: Capacity, spectra: Sequence[Spectrum], *own: str) -> tuple[str, ...]:
    """Sentences on what is uncertain, each once."""
    said = list(own)
    if capacity.reading == "literal_ec8":
        said.append(
            "Reading literal_ec8: displacements and verdict depend on where the control point is."
        )
    said += [note for spectrum in spectra for note in spectrum.uncertain]
    return tuple(dict.fromkeys(said))


def weight(capacity: Capacity, *first: str) -> str:
    """The assumption of most weight, the end of a sentence."""
    for words in first:
        if words:
            return words
    if capacity.collapse_extrapolated:
        return "the collapse displacement is extrapolated beyond the traced curve"
    if capacity.reading == "base_shear" and capacity.participating_mass_ratio < 0.95:
        return (
            f"which blocks count as one body (e* = {capacity.participating_mass_ratio:.3f}; "
            "accelerations go with 1/e*)"
        )
    return "only actions that last to the collapse are in the curve"
