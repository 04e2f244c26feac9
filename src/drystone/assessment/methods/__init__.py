"""Methods of assessment by name, one file each."""

from __future__ import annotations

from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods import (
    asce41,
    ec8_n2,
    en1998_3_2025_rocking,
    ntc2009_local,
    ntc2018_global,
    ntc2018_local,
    rocking,
)
from drystone.assessment.methods.base import Assessment, LimitState, Method, Settings, Spectra

_MODULES = (
    ntc2018_local,
    ntc2009_local,
    ntc2018_global,
    ec8_n2,
    en1998_3_2025_rocking,
    asce41,
    rocking,
)

#: Methods by the name that a model file gives them.
METHODS: dict[str, Method] = {module.NAME: module.assess for module in _MODULES}

#: Limit states by method, the mildest first.
STATES: dict[str, tuple[str, ...]] = {module.NAME: module.STATES for module in _MODULES}

#: Readings of `drystone.assessment.capacity.READINGS` that are those of the method's own code.
CODE_READINGS: dict[str, tuple[str, ...]] = {
    **{module.NAME: ("base_shear",) for module in _MODULES},
    ec8_n2.NAME: ("base_shear", "literal_ec8"),
    rocking.NAME: ("energy",),
}

__all__ = [
    "CODE_READINGS",
    "METHODS",
    "STATES",
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
    if settings.method not in METHODS:
        raise AssessmentError(
            f'there is no method "{settings.method}": choose one of {", ".join(METHODS)}'
        )
    known = {name for states in STATES.values() for name in states}
    for key in ("displacement_limits", "damping"):
        for name in getattr(settings, key):
            if name not in known:
                raise AssessmentError(
                    f'"{key}" names "{name}", which is no limit state; method "{settings.method}" '
                    f"has {', '.join(STATES[settings.method])}"
                )
    return METHODS[settings.method](capacity, spectra, settings)
