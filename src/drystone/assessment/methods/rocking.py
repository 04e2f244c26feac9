"""Rocking as motion: equivalent block, pulses, and records, Circ. 7/2019 C8.7.1.2.1.9."""

from __future__ import annotations

import math
from typing import Any

from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError, MissingError
from drystone.assessment.methods import common, local
from drystone.assessment.methods.base import Assessment, LimitState, Settings, Spectra
from drystone.assessment.rocking.block import RockingBlock, equivalent_block
from drystone.assessment.rocking.motion import MechanismRocker, respond
from drystone.assessment.rocking.pulse import Pulse, least_amplitude
from drystone.assessment.rocking.record import Record
from drystone.common.keys import Choice, Key, Number
from drystone.common.language import say
from drystone.common.ranges import Range
from drystone.model.assembly import GRAVITY

NAME = "rocking"
STATES = ("SLV", "SLC")
MORE_STATES: tuple[str, ...] = ("overturning",)
READINGS = ("energy",)
REFERENCE = "SLV"
KEYS: tuple[Key, ...] = (
    # Velocity after an impact over velocity before it.
    Key(name="restitution", type=Number(Range(least=0.0, most=1.0)), default=None),
    # "two" where it rocks both ways alike, "one" against a wall behind it.
    Key(name="sides", type=Choice(("one", "two")), default=None),
)

#: Limits of the mean of the largest displacements over d0*, C8.7.1.2.1.8 and C8.7.1.2.1.9.
SHARES = {"SLV": 0.4, "SLC": 0.6}

UNCERTAIN = (say("rocking.text"),)


def pulse_facts(pulse: Pulse, block: RockingBlock, level: float) -> dict[str, Any]:
    """Whether a pulse overturns, and from which amplitude on [m/s2]; without impact.

    Parameters
    ----------
    level
        g lambda_0 [m/s2], with the confidence factor.
    """
    least = level * least_amplitude(pulse.kind, pulse.duration, block.frequency)
    return {
        "kind": pulse.kind,
        "amplitude": pulse.amplitude,
        "duration": pulse.duration,
        "overturning_amplitude": least,
        "overturns": pulse.amplitude >= least and pulse.amplitude > level,
    }


def _of_pulses(
    capacity: Capacity, block: RockingBlock, level: float, settings: Settings
) -> list[dict[str, Any]]:
    """Facts of every pulse; refused where the forces do not stay constant."""
    if settings.pulses and (changed := capacity.first_change) is not None:
        raise AssessmentError(say("refused.pulses", what=changed.what))
    return [pulse_facts(pulse, block, level) for pulse in settings.pulses]


def record_facts(
    record: Record, rocker: MechanismRocker, block: RockingBlock, settings: Settings
) -> dict[str, Any]:
    """Largest displacement [m] under a record, in the worse sense where it rocks to one side."""
    sides, restitution = settings.get("sides") or "", settings.get("restitution") or 0.0
    senses = (1.0, -1.0) if sides == "one" else (1.0,)
    found = [
        respond(rocker, record.scaled(s), restitution=restitution, sides=sides) for s in senses
    ]
    return {
        "name": record.name,
        "peak_acceleration": record.peak_acceleration,
        "peak_velocity": record.peak_velocity,
        "acceleration_ratio": record.peak_acceleration / block.uplift_acceleration,
        "velocity_ratio": block.frequency * record.peak_velocity / block.uplift_acceleration,
        "largest_displacement": max(response.largest for response in found),
        "n_impacts": max(response.n_impacts for response in found),
        "overturned": any(response.overturned for response in found),
    }


def _of_records(
    capacity: Capacity, factor: float, block: RockingBlock, settings: Settings
) -> list[dict[str, Any]]:
    """Facts of every record."""
    settings.need("restitution", "velocity after an impact over that before it, 0 to 1")
    settings.need("sides", '"two" where it rocks both ways alike, "one" where it cannot')
    rocker = MechanismRocker(capacity, factor)
    facts = [record_facts(r, rocker, block, settings) for r in settings.records]
    _check_way_back(capacity, facts)
    return facts


def _check_way_back(capacity: Capacity, facts: list[dict[str, Any]]) -> None:
    """Refuse motions that go beyond where a tie yields or breaks, or a part falls: the way back is
    then on another curve, below that of the way there.  What overturns on the higher one fails."""
    changed = capacity.first_change
    if changed is None or any(fact["overturned"] for fact in facts):
        return
    for fact in facts:
        if capacity.control_at(fact["largest_displacement"]) > changed.place:
            raise AssessmentError(say("refused.way_back", record=fact["name"], what=changed.what))


def _states(
    capacity: Capacity, facts: list[dict[str, Any]], settings: Settings
) -> tuple[LimitState, ...]:
    """Mean of the largest displacements against 0.4 and 0.6 d0*; none of them passes d0*."""
    end = local.collapse(capacity, settings)
    verified = settings.limit_states or (REFERENCE,)
    unknown = [name for name in verified if name not in (*STATES, *MORE_STATES)]
    if unknown:
        raise AssessmentError(
            f'method "{NAME}" has no limit state "{unknown[0]}": {", ".join(STATES)}'
        )
    fallen = any(fact["overturned"] for fact in facts)
    mean = sum(fact["largest_displacement"] for fact in facts) / len(facts)
    peak = sum(fact["peak_acceleration"] for fact in facts) / len(facts)
    states = []
    for name in STATES:
        d, why = common.limit(capacity, settings, name, SHARES[name] * end)
        states.append(
            LimitState(
                name=name,
                limit_displacement=d,
                limit_control_displacement=capacity.control_at(d),
                displacement_demand=None if fallen else mean,
                control_displacement_demand=None if fallen else capacity.control_at(mean),
                satisfied=not fallen and mean <= d,
                verified=name in verified,
                governed_by=why or say("governs.share", share=SHARES[name]),
                clause="Circ. 7/2019 C8.7.1.2.1.9",
                details={"mean_peak_acceleration": peak, "overturned": fallen},
            )
        )
    return tuple(states)


def _overturning(pulses: list[dict[str, Any]], verified: bool) -> LimitState:
    """The pulse that is nearest to overturning, or overturns most."""
    worst = min(pulses, key=lambda fact: fact["overturning_amplitude"] / fact["amplitude"])
    return LimitState(
        name="overturning",
        ground_acceleration_capacity=worst["overturning_amplitude"],
        ground_acceleration_demand=worst["amplitude"],
        satisfied=not any(fact["overturns"] for fact in pulses),
        verified=verified,
        governed_by=say(
            "governs.pulse", kind=say(f"rocking.{worst['kind']}"), duration=worst["duration"]
        ),
        clause=say("clause.dynamics"),
    )


def assess(capacity: Capacity, spectra: Spectra | None, settings: Settings) -> Assessment:
    """Rocking of the mechanism under pulses and records, in the reading of the energy.

    Spectra are not used.  Limit states SLV and SLC are of records, "overturning" is of pulses: it
    counts unless the settings name others alone.

    Raises
    ------
    AssessmentError
        Without records and pulses, without restitution and sides where there are records, or where
        the curve has no collapse.  Where a tie yields or breaks or a part falls: pulses, and
        records that move the mechanism so far.
    """
    if not settings.records and not settings.pulses:
        raise MissingError(
            f'method "{NAME}" needs "records" or "pulses": motions of the ground, since spectra do '
            "not tell how a body rocks"
        )
    c = capacity.read_as("energy")
    factor = 1.0 if settings.confidence_factor is None else local.confidence_factor(settings)
    block = equivalent_block(c)
    if factor != 1.0:
        block = RockingBlock(
            frequency=block.frequency / math.sqrt(factor),
            slenderness=math.atan(c.activation_multiplier / factor),
        )
    level = GRAVITY * c.activation_multiplier / factor
    pulses = _of_pulses(c, block, level, settings)
    states: tuple[LimitState, ...] = ()
    records: list[dict[str, Any]] = []
    if settings.records:
        records = _of_records(c, factor, block, settings)
        states += _states(c, records, settings)
    if pulses:
        asked = settings.limit_states or MORE_STATES
        states += (_overturning(pulses, "overturning" in asked),)
    return Assessment(
        method=NAME,
        capacity=c,
        settings=settings,
        limit_states=states,
        activation_acceleration=level,
        confidence_factor=settings.confidence_factor,
        quantities={
            "frequency_parameter": block.frequency,
            "slenderness": block.slenderness,
            "uplift_acceleration": level,
            "free_period_half": block.free_period(0.5),
            "restitution": settings.get("restitution"),
            "pulses": pulses,
            "records": records,
        },
        assumptions=common.assumptions(c, ()) + _said(settings, c),
        uncertain=common.uncertain(c, (), states, *UNCERTAIN),
        weighs_most=_weight(settings),
        caution=local.caution(c),
    )


def _said(settings: Settings, capacity: Capacity) -> tuple[str, ...]:
    said = []
    if settings.reading != "energy":
        said.append(say("rocking.reading"))
    if settings.confidence_factor is None:
        said.append(say("rocking.no_factor"))
    if settings.records:
        known = {"n": len(settings.records), "restitution": settings.get("restitution")}
        said.append(say("rocking.records", **known))
        if capacity.load_multiplier[0] < 0.5 * capacity.activation_multiplier:
            said.append(say("rocking.soft"))
        if settings.get("sides") == "two":
            said.append(say("rocking.two_sides"))
    if settings.pulses:
        said.append(say("rocking.pulses"))
    return tuple(said)


def _weight(settings: Settings) -> str:
    if settings.records:
        return say("rocking.weight_records", restitution=settings.get("restitution"))
    return say("rocking.weight_pulses")
