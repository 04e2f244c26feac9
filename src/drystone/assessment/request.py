"""From [assessment] and [site], with what is said over them, to what a method takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from drystone.assessment.capacity import Capacity, participation
from drystone.assessment.errors import AssessmentError, MissingError
from drystone.assessment.methods import METHODS, assess
from drystone.assessment.methods.base import Settings, Spectra
from drystone.assessment.rocking.pulse import Pulse
from drystone.assessment.rocking.record import Record, read_record
from drystone.assessment.site import MotionAsked, motions_asked, spectra_of_site
from drystone.common.keys import ByState, Key, Number
from drystone.common.registry import RegistryError
from drystone.model.assembly import GRAVITY
from drystone.model.model import Model
from drystone.model.site import AssessmentInput, Site

#: Keys of [assessment] that are not for methods.
OWN = ("grouping", "language", "opposite", "parts_that_may_fall", "record", "pulse")


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is asked of a curve."""

    settings: Settings
    spectra: Spectra
    grouping: str = "macro_blocks"
    hazard: tuple[MotionAsked, ...] = ()


def request_of(site: Site | None, assessment: AssessmentInput | None) -> Request:
    """What a model's [site] and [assessment] ask for.

    Raises
    ------
    AssessmentError
        Something is missing, unknown or cannot be read; the message names the key.
    """
    values = {} if assessment is None else dict(assessment.values)
    settings = settings_of(assessment or AssessmentInput())
    if site is None and not (settings.records or settings.pulses):
        raise AssessmentError(
            "site is missing: say what the ground does in a table [site] of the model file, by "
            "--model FILE with such a table, or by --code, --ag and so on"
        )
    return Request(
        settings=settings,
        spectra={} if site is None else spectra_of_site(site),
        grouping=values.get("grouping", "macro_blocks"),
        hazard=() if site is None else motions_asked(site, METHODS[settings.method].STATES),
    )


def check_load(model: Model) -> None:
    """Raise that a model has no load to assess: `AssessmentError`."""
    if model.settlement is not None:
        raise AssessmentError("the curve is one of supports that move: give a [load] to assess")


def check_request(request: Request) -> None:
    """Raise what a method would miss, before a curve is traced for it: `MissingError`.

    It is asked about a made-up curve; what it has against that one is not told.
    """
    made_up = Capacity.of(
        [0.0, 0.01, 0.2],
        [0.0, 0.1, 0.0],
        participation([1000.0], [0.5], 300.0),
        reading=request.settings.reading,
    )
    try:
        assess(made_up, request.spectra, request.settings)
    except MissingError:
        raise
    except AssessmentError:
        pass


def settings_of(assessment: AssessmentInput) -> Settings:
    """Settings of the keys of [assessment], which are in units of files."""
    values = assessment.values
    if "method" not in values:
        raise AssessmentError(
            "assessment.method is missing: choose one of "
            f"{', '.join(METHODS.names())}, in [assessment] or by --method"
        )
    try:
        method = METHODS[values["method"]]
    except RegistryError as error:
        raise AssessmentError(str(error)) from None
    own = {key.name: key for key in method.KEYS}
    general = {field.name for field in fields(Settings)} - {"records", "pulses", "own"}
    known = {*general, *OWN, *own}
    for name in [name for name in values if name not in known]:
        if not any(key.name == name for _, other in METHODS.loaded() for key in other.KEYS):
            raise AssessmentError(f'assessment: there is no key "{name}"')
    given = {key: value for key, value in values.items() if key in general}
    if "limit_states" in given:
        given["limit_states"] = tuple(given["limit_states"])
    return Settings(
        **given,
        own={key: _as_ratio(own[key], value) for key, value in values.items() if key in own},
        records=tuple(_record(table, assessment) for table in values.get("record", ())),
        pulses=tuple(_pulse(table) for table in values.get("pulse", ())),
    )


def _as_ratio(key: Key, value: Any) -> Any:
    """A value of a file; what is in percent becomes a ratio."""
    number = key.type.of if isinstance(key.type, ByState) else key.type
    if not isinstance(number, Number) or number.range.unit != "percent":
        return value
    if isinstance(value, Mapping):
        return {state: x / 100.0 for state, x in value.items()}
    return value / 100.0


def _record(table: Mapping[str, Any], assessment: AssessmentInput) -> Record:
    record = read_record(assessment.file(table["file"]), unit=table["unit"])
    return record.scaled(table["scale"]) if "scale" in table else record


def _pulse(table: Mapping[str, Any]) -> Pulse:
    return Pulse(
        kind=table["kind"],
        amplitude=table["amplitude"] * GRAVITY,
        duration=table["duration"],
    )
