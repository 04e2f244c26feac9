"""What ``drystone assess`` tells people: the mechanism, limit states in a table, the verdict."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drystone.commands.senses import Sense

if TYPE_CHECKING:
    from drystone.assessment.methods.base import LimitState
    from drystone.assessment.verdict import Verdict

#: Columns of the table of limit states: heading, how wide.
COLUMNS = (
    ("state", 12),
    ("limit d* [m]", 13),
    ("a* [m/s2]", 10),
    ("T [s]", 11),
    ("demand [m]", 11),
    ("ag borne [g]", 13),
    ("ag site [g]", 12),
    ("index", 7),
)


def report(senses: Sequence[Sense], governing: Sense, folder: Path, pictures: Sequence[str]) -> str:
    """The assessment on a screen: the sense that governs in full, the others in a line."""
    from drystone.builders.words import printable

    verdict = governing.verdict
    assert verdict is not None
    lines = [printable(senses[0].model.title)]
    if len(senses) > 1:
        lines += [_row(sense.name, _brief(sense, governing)) for sense in senses]
    else:
        lines += [_row("senses", f"one, {senses[0].name}: the other was not traced")]
    lines += [_row(name, printable(value)) for name, value in _facts(verdict)]
    lines += ["", "  " + "".join(f"{name:>{width}}" for name, width in COLUMNS)]
    lines += ["  " + _state(state) for state in verdict.limit_states]
    if not all(state.verified for state in verdict.limit_states):
        lines += ["  * computed, but no part of the verdict"]
    lines += ["", *(f"  note: {printable(note)}" for note in verdict.assessment.assumptions)]
    lines += [f"  uncertain: {printable(note)}" for note in verdict.assessment.uncertain]
    lines += [
        _row("results", f"{folder}/{', '.join(('assessment.json', *pictures))}"),
        "",
        printable(verdict.sentence),
    ]
    return "\n".join(lines)


def _row(name: str, value: str) -> str:
    return f"  {name:<18} {value}"


def _brief(sense: Sense, governing: Sense) -> str:
    if sense.verdict is None:
        return "no verdict"
    index = sense.verdict.safety_index
    words = {True: "satisfied", False: "not satisfied", None: "not verified"}
    text = words[sense.verdict.satisfied]
    if index is not None:
        text += f", safety index {index:.3f}"
    return text + (" (governs)" if sense is governing else "")


def _facts(verdict: Verdict) -> list[tuple[str, str]]:
    """What was made of the curve."""
    capacity, shape = verdict.capacity, verdict.reduction.shape
    end = capacity.spectral_collapse_displacement
    extrapolated = ", extrapolated" if capacity.collapse_extrapolated else ""
    collapse = (
        "not reached"
        if end is None
        else f"d0* = {end:.4g} m, {capacity.collapse_displacement:.4g} m at the control point"
        + extrapolated
    )
    readings = [f"{capacity.reading} {_index(verdict.safety_index)}"]
    for name, other in verdict.others.items():
        readings.append(
            f"{name} {'none' if isinstance(other, str) else _index(other.safety_index)}"
        )
    factor = verdict.assessment.confidence_factor
    over = f" over FC = {factor:g}" if factor else ""
    return [
        ("method", f"{verdict.method}, reading {capacity.reading}"),
        (
            "mechanism",
            f"{shape.n_bodies} rigid {'body' if shape.n_bodies == 1 else 'bodies'} of "
            f"{shape.n_moving} blocks, "
            f"{capacity.mechanism_mass:.4g} kg",
        ),
        (
            "participation",
            f"e* = {capacity.participating_mass_ratio:.3f}, "
            f"Gamma = {capacity.participation_factor:.3f}, "
            f"M* = {capacity.participating_mass:.4g} kg",
        ),
        (
            "activation",
            f"lambda_0 = {capacity.activation_multiplier:.4f}, "
            f"a0* = {verdict.assessment.activation_acceleration:.4g} m/s2{over}",
        ),
        ("collapse", collapse),
        ("index by reading", ", ".join(readings)),
    ]


def _state(state: LimitState) -> str:
    """A row of the table; dashes where the method has no such number."""
    from drystone.assembly import GRAVITY

    def number(value: float | None, share: float = 1.0) -> str:
        return "-" if value is None else f"{value / share:.4g}"

    name = state.name + ("" if state.satisfied is None else " yes" if state.satisfied else " NO")
    cells = (
        name + ("" if state.verified else " *"),
        number(state.limit_displacement),
        number(state.limit_acceleration),
        number(state.limit_period),
        number(state.displacement_demand),
        number(state.ground_acceleration_capacity, GRAVITY),
        number(state.ground_acceleration_demand, GRAVITY),
        _index(state.safety_index),
    )
    return "".join(f"{cell:>{width}}" for cell, (_, width) in zip(cells, COLUMNS, strict=True))


def _index(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"
