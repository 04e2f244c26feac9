"""Words of a study in the language that is spoken, and the language that its model asks for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from drystone.common.language import LANGUAGES, said_end, said_status, say, spoken
from drystone.report import canvas

#: Columns by their words and units, see ``study_column`` of the languages.
COLUMNS = (
    "peak_multiplier", "peak_multiplier_against", "capacity_multiplier_against",
    "ultimate_displacement", "capacity_multiplier", "limit_associative", "limit_non_associative",
    "safety_index", "safety_index_against", "governing_safety_index", "least_reaction",
    "greatest_reaction", "largest_motion",
)  # fmt: skip
#: What columns begin with, that end with a limit state where there is one; likewise.
OF_STATES = {
    "ground_acceleration_capacity": "of_state_ground_acceleration_capacity",
    "activation_acceleration": "of_state_activation_acceleration",
    "displacement_demand": "of_state_displacement_demand",
    "limit_displacement": "of_state_limit_displacement",
    "safety_index": "of_state_safety_index",
}
#: Ends of a search without a value.
SEARCHED = ("finished", "none", "jump")


def word(key: str, **fields: Any) -> str:
    """A word or sentence of the report and the terminal."""
    return say(f"study.{key}", **fields).spoken


def in_figure(key: str, **fields: Any) -> str:
    """A word or sentence of figures and their captions."""
    return say(f"study_figure.{key}", **fields).spoken


def of_column(column: str) -> str:
    """What a column is, with its unit, for figures; the name of one that others have named."""
    if column in COLUMNS:
        return canvas.literal(say(f"study_column.{column}").spoken)
    for name, key in OF_STATES.items():
        if column.startswith(name):
            state = column.removeprefix(name).replace("_", " ").strip()
            shown = say(f"study_column.{key}", state=f", {state}" if state else "")
            return canvas.literal(shown.spoken)
    return canvas.literal(column)


def of_status(status: str) -> str:
    """The status of a sample or of a study; as it is, where it is another's."""
    if status == "computed":
        return word("computed")
    try:
        return said_status(status).spoken
    except KeyError:
        return status


def of_reason(reason: str) -> str:
    """Why a sample is not finished."""
    return spoken(said_end(reason))


def why_not_fitted(one: Mapping[str, Any]) -> str:
    """Why there is no curve of fragility, of its record."""
    return spoken(one["reason"], {one["reason"]: one.get("said")})


def of_sentence(found: Mapping[str, Any]) -> str | None:
    """What a search says, of its record; None where it says nothing."""
    sentence = found.get("sentence")
    return None if sentence is None else spoken(sentence, {sentence: found.get("said")})


def language_of(model: Mapping[str, Any] | None) -> str:
    """The language that the keys of a model ask for in [assessment]; English else."""
    section = (model or {}).get("assessment")
    asked = section.get("language") if isinstance(section, Mapping) else None
    return asked if asked in LANGUAGES else "en"
