"""What ``drystone assess`` tells people: the mechanism, limit states in a table, the verdict."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drystone.cli.senses import Sense
from drystone.common.language import number, say, spoken

if TYPE_CHECKING:
    from drystone.assessment.methods.base import LimitState
    from drystone.assessment.verdict import Verdict

#: Columns of the table of limit states: heading, how wide.
COLUMNS = (
    ("state", 12),
    ("limit", 13),
    ("a", 10),
    ("T", 11),
    ("demand", 11),
    ("borne", 13),
    ("site", 12),
    ("zeta", 8),
)


def report(senses: Sequence[Sense], governing: Sense, folder: Path, pictures: Sequence[str]) -> str:
    """The assessment on a screen: the sense that governs in full, the others in a line.

    In the language that is spoken.
    """
    from drystone.assessment.verdict import sense_words
    from drystone.model.construction.words import printable

    verdict = governing.verdict
    assert verdict is not None
    if len(senses) > 1:
        rows = [(spoken(sense_words(sense.name)), _brief(sense, governing)) for sense in senses]
    else:
        rows = [(_word("senses"), _word("one_sense", sense=sense_words(governing.name)))]
    rows += _facts(verdict)
    wide = max(18, *(len(name) for name, _ in rows))
    lines = [printable(senses[0].model.title)]
    lines += [f"  {name:<{wide}} {printable(value)}" for name, value in rows]
    lines += ["", "  " + "".join(f"{_word(name):>{width}}" for name, width in COLUMNS)]
    lines += ["  " + _state(state) for state in verdict.limit_states]
    lines += [
        f"  {_word('governed', state=state.name, by=state.governed_by)}"
        for state in verdict.limit_states
        if _fails_within_its_limit(state)
    ]
    if not all(state.verified for state in verdict.limit_states):
        lines += [f"  {_word('computed')}"]
    lines += _hazard(verdict)
    answer = verdict.assessment
    for key, sentences in (("note", answer.assumptions), ("uncertain", answer.uncertain)):
        lines += [""] if key == "note" else []
        lines += [f"  {_word(key, sentence=printable(spoken(said)))}" for said in sentences]
    lines += [
        f"  {_word('results'):<{wide}} {folder}/{', '.join(('assessment.json', *pictures))}",
        "",
        printable(spoken(verdict.sentence)),
    ]
    return "\n".join(lines)


def _fails_within_its_limit(state: LimitState) -> bool:
    """Whether a state that the verdict rests on fails though its displacement is not reached."""
    limit, demand = state.limit_displacement, state.displacement_demand
    known = limit is not None and demand is not None and demand <= limit
    return known and state.verified and state.satisfied is False and bool(state.governed_by)


def _word(key: str, **fields: Any) -> str:
    """A word or sentence of the screen, in the language that is spoken."""
    return say(f"screen.{key}", **fields).spoken


def _brief(sense: Sense, governing: Sense) -> str:
    if sense.verdict is None:
        return _word("no_verdict")
    nothing = say("verdict.nothing")
    index, caution = sense.verdict.safety_index, sense.verdict.assessment.caution
    keys = {True: "verdict.satisfied", False: "verdict.failed", None: "verdict.unverified"}
    return _word(
        "brief",
        answer=say(keys[sense.verdict.satisfied]),
        index=nothing if index is None else say("screen.index", index=index),
        but=say("verdict.but", caution=caution) if caution else nothing,
        governs=say("screen.governs") if sense is governing else nothing,
    )


def _facts(verdict: Verdict) -> list[tuple[str, str]]:
    """What was made of the curve."""
    capacity, shape = verdict.capacity, verdict.reduction.shape
    end = capacity.spectral_collapse_displacement
    nothing = say("verdict.nothing")
    extrapolated = say("screen.extrapolated") if capacity.collapse_extrapolated else nothing
    factor = verdict.assessment.confidence_factor
    return [
        (_word("method"), _word("reading", method=verdict.method, reading=capacity.reading)),
        (
            _word("mechanism"),
            _word(
                "body" if shape.n_bodies == 1 else "bodies",
                n=shape.n_bodies,
                blocks=shape.n_moving,
                mass=capacity.mechanism_mass,
            ),
        ),
        (
            _word("participation"),
            _word(
                "shares",
                ratio=capacity.participating_mass_ratio,
                factor=capacity.participation_factor,
                mass=capacity.participating_mass,
            ),
        ),
        (
            _word("activation"),
            _word(
                "acceleration",
                multiplier=capacity.activation_multiplier,
                acceleration=verdict.assessment.activation_acceleration,
                over=say("screen.over_factor", factor=factor) if factor else nothing,
            ),
        ),
        (
            _word("collapse"),
            _word("not_reached")
            if end is None
            else _word(
                "displacement",
                end=end,
                control=capacity.collapse_displacement,
                extrapolated=extrapolated,
            ),
        ),
        (_word("by_reading"), _readings(verdict)),
    ]


def _readings(verdict: Verdict) -> str:
    """The index in all readings; those that are not the code's are marked as such."""
    answers = {verdict.capacity.reading: verdict.assessment, **verdict.others}
    found = {
        name: f"{name} ({_word('none') if isinstance(other, str) else _index(other.safety_index)})"
        for name, other in answers.items()
    }
    own = [text for name, text in found.items() if verdict.is_of_the_code(name)]
    others = [text for name, text in found.items() if not verdict.is_of_the_code(name)]
    if not others:
        return ", ".join(own)
    return _word("beside", own=own, others=others) if own else _word("only_beside", others=others)


def _hazard(verdict: Verdict) -> list[str]:
    """What the code asks of the site for each limit state."""
    from drystone.model.assembly import GRAVITY

    if not verdict.hazard:
        return []
    lives = dict.fromkeys(motion.reference_life for motion in verdict.hazard)
    asked = [say("screen.life", years=life) for life in lives]
    lines = ["", f"  {_word('asked', lives=asked)}"]
    for motion in verdict.hazard:
        ground = motion.ground_acceleration
        given = (
            say("screen.not_given", state=motion.state)
            if ground is None
            else say("screen.given", ag=ground / GRAVITY)
        )
        line = _word(
            "motion",
            state=motion.state,
            percent=100.0 * motion.probability,
            years=motion.return_period,
            given=given,
        )
        lines.append(f"    {line}")
    return lines


def _state(state: LimitState) -> str:
    """A row of the table; dashes where the method has no such number."""
    from drystone.model.assembly import GRAVITY

    def shown(value: float | None, share: float = 1.0) -> str:
        return "-" if value is None else number(value / share)

    answers = {True: f" {_word('yes')}", False: f" {_word('no')}", None: ""}
    cells = (
        state.name + (answers[state.satisfied] if state.verified else " *"),
        shown(state.limit_displacement),
        shown(state.limit_acceleration),
        shown(state.limit_period),
        shown(state.displacement_demand),
        shown(state.ground_acceleration_capacity, GRAVITY),
        shown(state.ground_acceleration_demand, GRAVITY),
        _index(state.safety_index),
    )
    return "".join(f"{cell:>{width}}" for cell, (_, width) in zip(cells, COLUMNS, strict=True))


def _index(value: float | None) -> str:
    return "-" if value is None else number(value, ".3f")
