"""What all methods have in common: displacement limits, and sentences on what was assumed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from drystone.assessment.capacity import READINGS, Capacity
from drystone.assessment.errors import positive
from drystone.assessment.methods.base import LimitState, Settings
from drystone.assessment.methods.ground import RETURN_PERIOD_UNCERTAIN
from drystone.assessment.spectra.base import Spectrum

#: What governs a state that ends where something local fails.
LOCAL = "local displacement limit"


def limit(capacity: Capacity, settings: Settings, state: str, own: float) -> tuple[float, str]:
    """d_LS [m] as the lesser of the code's own and of what fails locally; and which it was."""
    given = settings.displacement_limits.get(state)
    if given is None:
        return own, ""
    met = capacity.spectral_at(positive(given, f"the displacement limit of {state}"))
    return (met, LOCAL) if met < own else (own, "")


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


def uncertain(
    capacity: Capacity, spectra: Sequence[Spectrum], states: Iterable[LimitState], *own: str
) -> tuple[str, ...]:
    """Sentences on what is uncertain of a method, its states, capacity and spectra, each once."""
    said = list(own)
    if any(state.return_period_capacity is not None for state in states):
        said.append(RETURN_PERIOD_UNCERTAIN)
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
