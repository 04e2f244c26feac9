"""What all methods have in common: displacement limits, and sentences on what was assumed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from drystone.assessment.capacity import READINGS, Capacity
from drystone.assessment.errors import positive
from drystone.assessment.methods.base import LimitState, Settings
from drystone.assessment.methods.ground import RETURN_PERIOD_UNCERTAIN
from drystone.assessment.spectra.base import Spectrum
from drystone.common.language import say

#: What governs a state that ends where something local fails.
LOCAL = say("governs.local")


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
        say("reading.said", name=capacity.reading, what=READINGS[capacity.reading]),
    ]
    if capacity.reading == "energy" and capacity.kinetic_factor is None:
        said.append(say("reading.kinetic"))
    told = any(getattr(note, "key", "") == "mechanism.extrapolated" for note in capacity.notes)
    if capacity.collapse_extrapolated and not told:
        said.append(say("capacity.extrapolated"))
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
        said.append(say("reading.control_point"))
    said += [note for spectrum in spectra for note in spectrum.uncertain]
    return tuple(dict.fromkeys(said))


def weight(capacity: Capacity, *first: str) -> str:
    """The assumption of most weight, the end of a sentence."""
    for words in first:
        if words:
            return words
    if capacity.collapse_extrapolated:
        return say("capacity.weight_extrapolated")
    if capacity.reading == "base_shear" and capacity.participating_mass_ratio < 0.95:
        return say("capacity.weight_bodies", ratio=capacity.participating_mass_ratio)
    return say("capacity.weight_actions")
