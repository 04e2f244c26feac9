"""Methods of assessment by name, one file each; `drystone.model.site.METHODS` lists them."""

from __future__ import annotations

from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods.base import Assessment, LimitState, Method, Settings, Spectra
from drystone.common.keys import ByState
from drystone.common.registry import RegistryError
from drystone.model.site import METHODS, known_states

__all__ = [
    "METHODS",
    "Assessment",
    "LimitState",
    "Method",
    "Settings",
    "assess",
]


def assess(capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
    """The answer of the method that the settings name.

    Parameters
    ----------
    spectra
        One for every limit state by its name, or one that serves for all of them.

    Raises
    ------
    AssessmentError
        Where the method is not known, does not apply, or needs something that was not said.
    """
    try:
        method = METHODS[settings.method]
    except RegistryError as error:
        raise AssessmentError(str(error)) from None
    known = known_states()
    by_state = {"displacement_limits": settings.displacement_limits} | {
        key.name: settings.get(key.name) or {}
        for key in method.KEYS
        if isinstance(key.type, ByState)
    }
    for key, values in by_state.items():
        for name in values:
            if name not in known:
                raise AssessmentError(
                    f'"{key}" names "{name}", which is no limit state; method "{settings.method}" '
                    f"has {', '.join(method.STATES)}"
                )
    return method.assess(capacity, spectra, settings)
