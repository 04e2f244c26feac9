"""What a report says of supports that move, in place of what it says of a load that grows."""

from __future__ import annotations

from collections.abc import Mapping

from drystone.common.language import said_end, spoken
from drystone.model.model import Model
from drystone.report.document.facts import Row, number, status_words
from drystone.report.quantities import Quantities
from drystone.results.curve import FINISHED, CapacityCurve

Words = Mapping[str, str]

#: Relative size under which a motion has come as far as was asked.
REACHED = 1e-9


def of_analysis(curve: CapacityCurve, model: Model | None, words: Words) -> list[Row]:
    """How supports moved, and how their reaction went."""
    rows = [(words["engine"], curve.engine)]
    if model is not None and model.settlement is not None:
        rows.append((words["support_motion"], spoken(model.settlement.words)))
    rows += [
        (words["status"], status_words(curve.status)),
        (words["reason"], spoken(said_end(curve.reason))),
    ]
    if not curve.points:
        return rows
    shown = Quantities.of(curve)
    for name, point in curve.marked_reactions.items():
        at = shown.motion_text(point.control_displacement)
        text = f"{number(float(point.reaction), shown.force_unit, 5)} {words['at']} {at}"
        rows.append((words[f"reaction_{name}"], text))
    if curve.events:
        rows.append((words["events"], "; ".join(spoken(event.said) for event in curve.events)))
    return rows


def outcome(curve: CapacityCurve, model: Model | None, text: Words) -> str:
    """Whether the structure stands on supports that have moved, in a sentence."""
    if not curve.points:
        return text["supports_only"]
    shown, last = Quantities.of(curve), curve.points[-1].control_displacement
    motion = shown.motion_text(last)
    settlement = None if model is None else model.settlement
    if settlement is not None and last >= settlement.largest * (1.0 - REACHED):
        key = "supports_stands_less" if curve.first_collapse is not None else "supports_stands"
    else:
        key = "supports_falls" if curve.status == FINISHED else "supports_unfinished"
    event = "" if curve.first_collapse is None else spoken(curve.first_collapse.said)
    return f"{text[key].format(motion=motion, event=event)} {text['supports_only']}"
