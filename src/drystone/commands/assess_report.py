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
    ("zeta_E", 8),
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
        lines += [_row("senses", f"one, {governing.name}: the other was not traced")]
    lines += [_row(name, printable(value)) for name, value in _facts(verdict)]
    lines += ["", "  " + "".join(f"{name:>{width}}" for name, width in COLUMNS)]
    lines += ["  " + _state(state) for state in verdict.limit_states]
    if not all(state.verified for state in verdict.limit_states):
        lines += ["  * computed, but no part of the verdict"]
    lines += _hazard(verdict)
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
        text += f", zeta_E = {index:.3f}"
    if sense.verdict.assessment.caution:
        text += f", but {sense.verdict.assessment.caution}"
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
        ("zeta_E by reading", _readings(verdict)),
    ]


def _readings(verdict: Verdict) -> str:
    """The index in all readings; those that are not the code's are marked as such."""
    answers = {verdict.capacity.reading: verdict.assessment, **verdict.others}
    found = {
        name: f"{name} {'none' if isinstance(other, str) else _index(other.safety_index)}"
        for name, other in answers.items()
    }
    own = [text for name, text in found.items() if verdict.is_of_the_code(name)]
    beside = [text for name, text in found.items() if not verdict.is_of_the_code(name)]
    said = ", ".join(own)
    return f"{said}; beside, no readings of the code: {', '.join(beside)}" if beside else said


def _hazard(verdict: Verdict) -> list[str]:
    """What the code asks of the site for each limit state."""
    from drystone.assembly import GRAVITY

    if not verdict.hazard:
        return []
    lives = dict.fromkeys(motion.reference_life for motion in verdict.hazard)
    said = ", ".join(f"V_R = {life:g} years" for life in lives)
    lines = ["", f"  ground motion asked for, NTC 2018 with {said}:"]
    for motion in verdict.hazard:
        ground = motion.ground_acceleration
        given = (
            f"not given: [site.{motion.state}]" if ground is None else f"{ground / GRAVITY:.4g} g"
        )
        lines.append(
            f"    {motion.state}  P_VR = {100.0 * motion.probability:2.0f} %  "
            f"T_R = {motion.return_period:6.1f} years  a_g = {given}"
        )
    return lines


def _state(state: LimitState) -> str:
    """A row of the table; dashes where the method has no such number."""
    from drystone.assembly import GRAVITY

    def number(value: float | None, share: float = 1.0) -> str:
        return "-" if value is None else f"{value / share:.4g}"

    answer = {True: " yes", False: " NO", None: ""}[state.satisfied] if state.verified else " *"
    cells = (
        state.name + answer,
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
