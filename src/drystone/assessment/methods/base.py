"""What goes into a method of assessment and what comes out of it, frozen."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Protocol

from drystone.assessment.bilinear import Bilinear
from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError, MissingError
from drystone.assessment.spectra.base import Spectrum
from drystone.common.keys import Key
from drystone.common.language import Saying, say
from drystone.model.assembly import GRAVITY

__all__ = [
    "Assessment",
    "AssessmentError",
    "LimitState",
    "Method",
    "MethodFile",
    "Settings",
    "Spectra",
    "spectra_of",
]

#: One spectrum that serves for every limit state, or one for each by its name, "" for all others.
Spectra = Spectrum | Mapping[str, Spectrum]


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What the engineer decides.  None means not said: a method that needs it asks for it.

    Damping is a ratio everywhere.
    """

    method: str
    reading: str = "base_shear"  # see `drystone.assessment.capacity.READINGS`
    confidence_factor: float | None = None  # FC
    kinematics: str = "nonlinear"  # or "linear": local mechanisms of which lambda_0 alone counts
    #: States that the verdict rests on; all that have a spectrum of their own where None.
    limit_states: tuple[str, ...] | None = None
    #: Control displacements [m] by limit state beyond which something local fails: a tie breaks
    #: that costs half the strength, a beam slips off, a drift limit is met.
    displacement_limits: Mapping[str, float] = field(default_factory=dict)
    elastic_period: float | None = None  # s, T_0; 0 where the mechanism is rigid until it rocks
    straight_capacity: bool | None = None  # a0 (1 - d/d0) instead of the curve; None: the code's
    # ground motions, for `rocking`
    records: tuple[Any, ...] = ()  # `drystone.assessment.rocking.record.Record`
    pulses: tuple[Any, ...] = ()  # `drystone.assessment.rocking.pulse.Pulse`
    #: Keys that the method declares itself, as far as they are given.
    own: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, **values: Any) -> Settings:
        """Settings of keys by their names, those that methods declare among them."""
        known = {field.name for field in fields(cls)}
        own = {key: value for key, value in values.items() if key not in known}
        return cls(**{key: values[key] for key in values if key in known}, own=own)

    def get(self, key: str) -> Any:
        """The value of a key; None where it was not said."""
        return self.own[key] if key in self.own else getattr(self, key, None)

    def need(self, key: str, why: str) -> Any:
        """The value of a key; `AssessmentError` says why it is needed where there is none."""
        value = self.get(key)
        if value is None or (isinstance(value, Mapping | tuple) and not value):
            raise MissingError(f'method "{self.method}" needs "{key}": {why}')
        return value


@dataclass(frozen=True, kw_only=True)
class LimitState:
    """One limit state: what the mechanism bears and what the ground asks of it."""

    name: str
    limit_displacement: float | None = None  # m, d*
    limit_control_displacement: float | None = None  # m
    limit_acceleration: float | None = None  # m/s2, a* with the confidence factor
    limit_period: float | None = None  # s
    damping: float | None = None  # ratio
    displacement_demand: float | None = None  # m, d* under the ground acceleration of the site
    control_displacement_demand: float | None = None  # m
    acceleration_demand: float | None = None  # m/s2, where accelerations are compared
    ground_acceleration_capacity: float | None = None  # m/s2
    ground_acceleration_demand: float | None = None  # m/s2
    return_period_demand: float | None = None  # years
    return_period_capacity: float | None = None  # years
    satisfied: bool | None = None
    verified: bool = True  # whether the verdict rests on it
    governed_by: str = ""  # what sets the capacity, a few words
    clause: str = ""
    details: Mapping[str, Any] = field(default_factory=dict)  # intermediate numbers by name

    @property
    def safety_index(self) -> float | None:
        """Ground acceleration that is borne over that of the site; or of displacements."""
        capacity, demand = self.ground_acceleration_capacity, self.ground_acceleration_demand
        if capacity is None or not demand:
            capacity, demand = self.limit_displacement, self.displacement_demand
        if capacity is None or not demand:
            return None
        return capacity / demand

    def as_dict(self) -> dict[str, Any]:
        """Numbers and words for a file; None where there is no such number."""
        return {
            "limit_displacement": _number(self.limit_displacement),
            "limit_control_displacement": _number(self.limit_control_displacement),
            "limit_acceleration": _number(self.limit_acceleration),
            "limit_period": _number(self.limit_period),
            "equivalent_damping": _number(self.damping),
            "displacement_demand": _number(self.displacement_demand),
            "target_displacement": _number(self.control_displacement_demand),
            "acceleration_demand": _number(self.acceleration_demand),
            "ground_acceleration_capacity": _number(self.ground_acceleration_capacity),
            "ground_acceleration_demand": _number(self.ground_acceleration_demand),
            "return_period_demand": _number(self.return_period_demand),
            "return_period_capacity": _number(self.return_period_capacity),
            "safety_index": _number(self.safety_index),
            "satisfied": self.satisfied,
            "verified": self.verified,
            "governed_by": self.governed_by,
            "clause": self.clause,
            "details": {key: _plain(value) for key, value in self.details.items()},
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Assessment:
    """The answer of a method.

    `uncertain` are sentences on clauses whose text was not at hand or which the sources tell
    differently.
    """

    method: str
    capacity: Capacity
    settings: Settings
    limit_states: tuple[LimitState, ...]
    activation_acceleration: float  # m/s2, a0* with the confidence factor
    confidence_factor: float | None  # as applied to the curve
    spectra: Mapping[str, Spectrum] = field(default_factory=dict)
    bilinear: Bilinear | None = None  # in d*, a*
    quantities: Mapping[str, Any] = field(default_factory=dict)  # further numbers by name
    assumptions: tuple[str, ...] = ()
    uncertain: tuple[str, ...] = ()
    weighs_most: str = ""  # the assumption of most weight, the end of a sentence
    caution: str = ""  # why the method is not meant for this mechanism; goes with any verdict

    def state(self, name: str) -> LimitState:
        """A limit state by its name."""
        for state in self.limit_states:
            if state.name == name:
                return state
        names = ", ".join(state.name for state in self.limit_states)
        raise AssessmentError(f'method "{self.method}" has no limit state "{name}", but {names}')

    @property
    def verified(self) -> tuple[LimitState, ...]:
        """The states that the verdict rests on."""
        return tuple(s for s in self.limit_states if s.verified and s.satisfied is not None)

    @property
    def satisfied(self) -> bool | None:
        """Whether every verified state is satisfied; None where none is verified."""
        states = self.verified
        return all(s.satisfied for s in states) if states else None

    @property
    def governing(self) -> LimitState | None:
        """The verified state of least safety index; one that fails goes before those that hold."""
        states = self.verified
        if not states:
            return None
        return min(states, key=lambda s: (bool(s.satisfied), _or_infinite(s.safety_index)))

    @property
    def safety_index(self) -> float | None:
        """zeta_E of the state that governs, so that it says no other than the verdict."""
        governing = self.governing
        return None if governing is None else governing.safety_index

    @property
    def sentence(self) -> Saying:
        """The verdict with the governing state and the assumption that weighs most."""
        state = self.governing
        if state is None:
            return say("verdict.none", method=self.method)
        nothing = say("verdict.nothing")
        return say(
            "verdict.sentence",
            method=self.method,
            answer=say("verdict.satisfied" if self.satisfied else "verdict.failed"),
            but=say("verdict.but", caution=self.caution) if self.caution else nothing,
            state=state.name,
            compared=_compared(state),
            weight=say("verdict.weight", what=self.weighs_most) if self.weighs_most else nothing,
        )

    def as_dict(self) -> dict[str, Any]:
        """What assessment.json holds, SI units; None where the method has no such number."""
        c, b = self.capacity, self.bilinear
        governing = self.governing
        return {
            "method": self.method,
            "reading": c.reading,
            "activation_multiplier": _number(c.activation_multiplier),
            "participating_mass_ratio": _number(c.participating_mass_ratio),
            "participating_mass": _number(c.participating_mass),
            "participation_factor": _number(c.participation_factor),
            "kinetic_mass_ratio": _number(c.kinetic_mass_ratio),
            "mechanism_mass": _number(c.mechanism_mass),
            "equivalent_mass": _number(c.equivalent_mass),
            "confidence_factor": _number(self.confidence_factor),
            "activation_acceleration": _number(self.activation_acceleration),
            "collapse_displacement": _number(c.spectral_collapse_displacement),
            "control_collapse_displacement": _number(c.collapse_displacement),
            "collapse_extrapolated": c.collapse_extrapolated,
            "yield_displacement": _number(b.yield_displacement if b else None),
            "yield_acceleration": _number(b.yield_acceleration if b else None),
            **{key: _plain(value) for key, value in self.quantities.items()},
            "safety_index": _number(self.safety_index),
            "satisfied": self.satisfied,
            "caution": self.caution,
            "governing_limit_state": governing.name if governing else None,
            "sentence": self.sentence,
            "limit_states": {state.name: state.as_dict() for state in self.limit_states},
            "assumptions": list(self.assumptions),
            "uncertain": list(self.uncertain),
        }


#: A method: capacity, spectra and settings in, the answer out; refuses with `AssessmentError`.
Method = Callable[[Capacity, Spectra, Settings], Assessment]


class MethodFile(Protocol):
    """What the file of a method has.  Its line stands in `drystone.model.site.METHODS`."""

    NAME: str  # as in [assessment] method
    STATES: tuple[str, ...]  # limit states that are compared with spectra, the mildest first
    #: Further ones, which have no ground motion of their own.
    MORE_STATES: tuple[str, ...]
    READINGS: tuple[str, ...]  # of `capacity.READINGS`, those of the method's own code
    KEYS: tuple[Key, ...]  # of [assessment]; numbers in percent become ratios

    def assess(self, capacity: Capacity, spectra: Spectra, settings: Settings) -> Assessment:
        """See `Method`."""
        ...


def spectra_of(
    given: Spectra, states: tuple[str, ...], reference: str, settings: Settings
) -> tuple[dict[str, Spectrum], tuple[str, ...], tuple[str, ...]]:
    """The spectrum of each state, the states that are verified, and what was assumed.

    One spectrum for all states is meant for the reference state alone: ground motions of other
    states have other return periods.  The others are computed with it but not verified, unless
    `Settings.limit_states` names them.
    """
    if isinstance(given, Mapping):
        found = {name: given.get(name, given.get("")) for name in states}
        spectra = {name: own for name, own in found.items() if own is not None}
    else:
        spectra = dict.fromkeys(states, given)
    if not spectra:
        mend = "say what the ground does in [site]"
        if isinstance(given, Mapping) and given:
            mend = (
                f"[site] has those of {', '.join(given)}: without such tables its spectrum is for "
                "all limit states"
            )
        raise MissingError(
            f'method "{settings.method}" verifies {", ".join(states)}, and none of them has a '
            f"spectrum: {mend}"
        )
    shared = len(spectra) > 1 and len({id(s) for s in spectra.values()}) == 1
    if settings.limit_states is not None:
        wrong = [name for name in settings.limit_states if name not in spectra]
        if wrong:
            raise MissingError(
                f'"{wrong[0]}" is to be verified, but method "{settings.method}" has no such limit '
                f"state with a spectrum: {', '.join(spectra)}"
            )
        verified = settings.limit_states
    elif shared:
        verified = (reference,)
    else:
        verified = tuple(spectra)
    notes: tuple[str, ...] = ()
    if shared:
        label = next(iter(spectra.values())).label
        names = {"states": list(spectra), "verified": list(verified)}
        notes = (say("common.one_motion", label=label, **names),)
    return spectra, verified, notes


def _compared(state: LimitState) -> Saying:
    """The governing numbers of a state in words."""
    capacity, demand = state.ground_acceleration_capacity, state.ground_acceleration_demand
    index = state.safety_index
    more = say("verdict.nothing")
    if index is None and state.limit_displacement is not None:
        more = say("verdict.beyond")
    elif capacity is not None and demand is not None:
        more = say("verdict.by_ground", borne=capacity / GRAVITY, asked=demand / GRAVITY)
    elif state.limit_displacement is not None and state.displacement_demand is not None:
        more = say(
            "verdict.by_displacement",
            borne=state.limit_displacement,
            asked=state.displacement_demand,
        )
    if index is None:
        return say("verdict.no_index", more=more)
    return say("verdict.index", index=index, more=more)


def _or_infinite(value: float | None) -> float:
    return math.inf if value is None else value


def _number(value: float | None) -> float | None:
    """A float that a JSON file can hold."""
    if value is None or not math.isfinite(value):
        return None
    return float(value)


def _plain(value: Any) -> Any:
    """A number, a word, or a container of such, for a JSON file."""
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return _number(float(value))
