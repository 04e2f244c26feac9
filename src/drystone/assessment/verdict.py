"""The verdict on a curve: the method's answer, with the mechanism and other readings beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError, MissingError, UnfinishedError
from drystone.assessment.mechanism import Reduction, reduced
from drystone.assessment.methods import METHODS, Assessment, LimitState, assess
from drystone.assessment.methods.base import Settings, Spectra
from drystone.assessment.request import Request, check_load, request_of, settings_of
from drystone.assessment.site import MotionAsked, missing_motions, spectra_of_site
from drystone.common.language import Saying, said_end, said_status, say
from drystone.model.model import Model
from drystone.model.site import AssessmentInput, Site
from drystone.results.curve import FINISHED, STATIC, CapacityCurve
from drystone.results.events import falls_with, first_collapse


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Verdict:
    """What an assessment of a curve found."""

    assessment: Assessment  # in the reading that was asked for
    reduction: Reduction
    others: Mapping[str, Assessment | str]  # in the other readings, or why there is none
    hazard: tuple[MotionAsked, ...] = ()  # what the code asks of the site for each limit state

    @property
    def satisfied(self) -> bool | None:
        """Whether every limit state that is verified holds."""
        return self.assessment.satisfied

    @property
    def safety_index(self) -> float | None:
        """zeta_E, ground acceleration borne over that of the site."""
        return self.assessment.safety_index

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        return self.assessment.sentence

    @property
    def limit_states(self) -> tuple[LimitState, ...]:
        """Limit states of the method."""
        return self.assessment.limit_states

    @property
    def capacity(self) -> Capacity:
        """The curve as an oscillator, in the reading that was asked for."""
        return self.assessment.capacity

    @property
    def method(self) -> str:
        """Name of the method."""
        return self.assessment.method

    def is_of_the_code(self, reading: str) -> bool:
        """Whether a reading is that of the method's own code, or one beside it."""
        return reading in METHODS[self.method].READINGS

    def state(self, name: str) -> LimitState:
        """A limit state by its name."""
        return self.assessment.state(name)

    def as_dict(self) -> dict[str, Any]:
        """What ``assessment.json`` holds, SI units."""
        found = self.assessment.as_dict()
        readings = {self.assessment.settings.reading: _brief(self.assessment)}
        for name, other in self.others.items():
            readings[name] = {"reason": other} if isinstance(other, str) else _brief(other)
        for name, reading in readings.items():
            reading["of_the_code"] = self.is_of_the_code(name)
        capacity = self.capacity
        return found | {
            "readings": readings,
            "hazard": [motion.as_dict() for motion in self.hazard],
            "spectral_displacement": capacity.spectral_displacement.tolist(),
            "spectral_acceleration": capacity.spectral_acceleration.tolist(),
            "mechanism": self.reduction.as_dict(),
        }

    def __repr__(self) -> str:
        return f"<Verdict {self.sentence}>"


def assessed(
    curve: CapacityCurve,
    model: Model,
    *,
    site: Site | None = None,
    settings: Settings | None = None,
    spectra: Spectra | None = None,
    **options: Any,
) -> Verdict:
    """Assess a traced curve by what its model says, and what is said here over it.

    A curve is of one sense of the load: the verdict says so.

    Parameters
    ----------
    site
        In place of the model's.
    settings
        In place of the model's [assessment]; damping is a ratio.
    spectra
        In place of those of the site: one, or one for each limit state.
    options
        Keys of [assessment] by name, in the units of files, over those of the model.

    Raises
    ------
    AssessmentError
        See `verdict_on`.
    """
    check_load(model)
    asked = model.assessment or AssessmentInput()
    asked = replace(asked, values={**asked.values, **options})
    if settings is not None and options:
        raise AssessmentError("give settings, or keys of [assessment] by name, not both")
    if spectra is None and settings is None:
        return of_one_sense(verdict_on(curve, model, request_of(site or model.site, asked)))
    grouping = asked.values.get("grouping", "macro_blocks")
    if settings is None:
        settings = settings_of(asked)
    if spectra is None:
        given = site or model.site
        spectra = {} if given is None else spectra_of_site(given)
    request = Request(settings=settings, spectra=spectra, grouping=grouping)
    return of_one_sense(verdict_on(curve, model, request))


def verdict_on(
    curve: CapacityCurve,
    model: Model,
    request: Request | None = None,
    *,
    against: bool = False,
) -> Verdict:
    """Assess a traced curve; of one that goes to and fro its envelope in one sense.

    Parameters
    ----------
    curve
        With poses.
    model
        What was traced; its ``site`` and ``assessment`` say what is asked, unless a request does.
    against
        Of a curve that goes to and fro: its envelope against the load, not along it.

    Raises
    ------
    UnfinishedError
        The curve does not go far enough.
    AssessmentError
        Something else is missing, or the method does not apply.
    """
    asked = request_of(model.site, model.assessment) if request is None else request
    curve = of_the_whole(curve, model)
    cyclic = curve.is_cyclic
    curve, model = in_one_sense(curve, model, against=against)
    found = reduced(curve, model, grouping=asked.grouping)
    settings = asked.settings
    if settings.reading not in found.capacities:
        raise AssessmentError(
            f'there is no reading "{settings.reading}": take one of {", ".join(found.capacities)}'
        )
    own = found.capacities[settings.reading]
    try:
        answer = assess(own, asked.spectra, settings)
    except MissingError:
        raise  # no other curve would mend it
    except AssessmentError as error:
        if own.collapse_displacement is not None:
            raise
        why = _why_unfinished(error, curve, cyclic, settings.method)
        raise UnfinishedError(why) from None
    others: dict[str, Assessment | str] = {}
    for name, capacity in found.capacities.items():
        if name != settings.reading:
            try:
                others[name] = assess(capacity, asked.spectra, replace(settings, reading=name))
            except AssessmentError as error:
                others[name] = error.said
    which = say("verdict.of_cycles_against") if against else say("verdict.of_cycles_along")
    of_cycles = [which] if cyclic else []
    first = (*of_cycles, *_left_behind(curve, model), *_beyond_events(answer))
    missing = missing_motions(asked.hazard)
    answer = replace(answer, assumptions=(*first, *answer.assumptions, *missing))
    return Verdict(assessment=answer, reduction=found, others=others, hazard=asked.hazard)


def _why_unfinished(
    error: AssessmentError, curve: CapacityCurve, cyclic: bool, method: str
) -> Saying:
    """Why a curve does not go far enough, and where it ends."""
    known = {"status": said_status(curve.status), "reason": said_end(curve.reason)}
    if not cyclic:
        return say("verdict.curve_is", why=error.said, **known)
    if getattr(error.said, "key", "") == "refused.no_collapse":
        said = say("refused.no_collapse_to_and_fro", method=method)
        return say("verdict.curve_is", why=said, **known)
    return say("verdict.curve_to_and_fro", why=error.said, **known)


def of_one_sense(verdict: Verdict, sense: str = "", why: str = "") -> Verdict:
    """The same verdict; that it is on one sense of the load is said before all else.

    Parameters
    ----------
    sense
        The name of the one that was traced.
    why
        There is no verdict on the other, where it was asked for.
    """
    said = say("verdict.one_sense")
    if why:
        said = say("verdict.one_verdict", sense=sense_words(sense), why=why)
    elif sense:
        said = say("verdict.one_sense_named", sense=sense_words(sense))
    answer = verdict.assessment
    answer = replace(answer, assumptions=(said, *answer.assumptions))
    return replace(verdict, assessment=answer)


def severity(verdict: Verdict) -> tuple[bool, float]:
    """What senses of a load are put in order by, the one that governs first: one that fails comes
    before those that hold, then by the safety index."""
    index = verdict.safety_index
    return verdict.satisfied is not False, float("inf") if index is None else index


def sense_words(name: str) -> str:
    """The name of a sense of the load, as files have it, for people."""
    keys = {"along the load": "sense.along", "against the load": "sense.against"}
    return say(keys[name]) if name in keys else name


def in_one_sense(
    curve: CapacityCurve, model: Model, *, against: bool = False
) -> tuple[CapacityCurve, Model]:
    """Of a cyclic curve its envelope along or ``against`` the load, with the model under the load
    in that sense; any other curve as it is."""
    if not curve.is_cyclic:
        return curve, model
    return (curve.outward(-1.0), turned(model)) if against else (curve.outward(), model)


def turned(model: Model) -> Model:
    """The model under the load turned round, with the same control point, which is followed the
    other way; `ValueError` or `ModelError` of a pattern that has one sense."""
    from drystone.model.construction.vary import control_beside_default, remade

    control = replace(model.control_point, direction=-model.control_point.direction)
    named = control_beside_default(model)
    if named["control_direction"] is not None:
        named["control_direction"] = control.direction
    other = remade(model, load_direction=(-model.load_along).tolist(), **named)
    return replace(other, control_point=control)


def of_the_whole(curve: CapacityCurve, model: Model) -> CapacityCurve:
    """The curve up to the first collapse of a part that may not fall, see [assessment].

    What lies beyond is that of another structure.  A curve that ends with the collapse stays.
    """
    event = first_collapse(curve.events, model.parts_that_may_fall)
    if event is None:
        return curve
    after = any(p.status == STATIC and p.step > event.step for p in curve.points)
    return curve.until(event) if after or curve.status != FINISHED else curve


def _left_behind(curve: CapacityCurve, model: Model) -> list[Saying]:
    """A sentence where the control point is not on what collapses first."""
    event = curve.ended_by or first_collapse(curve.events, model.parts_that_may_fall)
    control = model.assembly.ids[model.control_point.block]
    if event is None or control in falls_with(curve.events, event):
        return []
    return [say("verdict.left_behind", block=control, what=event.what)]


def _beyond_events(answer: Assessment) -> list[Saying]:
    """Of every limit state that lies beyond an event, a sentence that says so."""
    said = []
    for state in answer.limit_states:
        place = state.limit_control_displacement
        lost = () if place is None else answer.capacity.losses_before(place)
        if lost:
            on_the_way = {"state": state.name, "place": place, "first": lost[0]}
            if len(lost) > 1:
                said.append(say("verdict.beyond_events", more=len(lost) - 1, **on_the_way))
            else:
                said.append(say("verdict.beyond_event", **on_the_way))
    return said


def _brief(answer: Assessment) -> dict[str, Any]:
    """A reading beside others."""
    whole = answer.as_dict()
    keys = ("activation_acceleration", "collapse_displacement", "safety_index", "satisfied")
    states = {
        name: {
            key: state[key]
            for key in (
                "limit_displacement",
                "displacement_demand",
                "ground_acceleration_capacity",
                "satisfied",
            )
        }
        for name, state in whole["limit_states"].items()
    }
    return {**{key: whole[key] for key in keys}, "limit_states": states}
