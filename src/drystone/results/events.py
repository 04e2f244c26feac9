"""Events along a capacity curve: what a structure lost, and when.

A curve alone does not tell that a stone fell while the other blocks still carried.  An event tells
its kind, the last state at rest before it, the blocks that moved and how far.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from drystone.common.language import Saying, say

#: Names of blocks or ties that a sentence lists.
FEW = 4

#: Decimals of a control displacement in metres that sentences show at most.
PRINTED = 7


class EventKind(StrEnum):
    """What happened."""

    LOSS_OF_EQUILIBRIUM = "loss_of_equilibrium"  # the structure moves by itself: the first jump
    BLOCK_FALLEN = "block_fallen"
    BLOCK_DISPLACED = "block_displaced"  # moved by itself to rest elsewhere
    TIE_YIELDED = "tie_yielded"
    TIE_BROKEN = "tie_broken"
    SUPPORT_LOST = "support_lost"  # a support that bore the structure bears nothing any more


class Outcome(StrEnum):
    """Where the blocks of an event are after it."""

    AT_REST = "at_rest"
    HANGING = "hanging"  # on ties, without a contact
    LEFT = "left"  # no part of the structure any more
    IN_MOTION = "in_motion"  # the curve ends before they rest


#: Events in which a part of the structure collapses: they limit its capacity.
COLLAPSES = (EventKind.BLOCK_FALLEN, EventKind.BLOCK_DISPLACED)

#: Events after which other forces or other blocks make the curve.
CHANGES = (*COLLAPSES, EventKind.TIE_YIELDED, EventKind.TIE_BROKEN)


@dataclass(frozen=True, kw_only=True)
class Event:
    """One event.  Of blocks that move, the place is the last point at rest before they do."""

    kind: EventKind
    step: int  # of the point at that place
    control_displacement: float  # m
    load_multiplier: float
    blocks: tuple[str, ...] = ()  # ids: of those that moved, or that ties join, or of supports
    motion: float = 0.0  # m, farthest motion of a centroid among them; 0 of ties and supports
    ties: tuple[str, ...] = ()  # names
    outcome: Outcome | None = None  # of blocks that moved
    # "m" or "rad" where supports move in place of a load: unit of their motion
    support_unit: str = ""

    @property
    def is_collapse(self) -> bool:
        """Whether blocks fall or move by themselves by more than the share asked."""
        return self.kind in COLLAPSES

    @property
    def changes(self) -> bool:
        """Whether other forces act afterwards, or other blocks bear: a tie yields or breaks, a part
        collapses."""
        return self.kind in CHANGES

    def limits(self, may_fall: Collection[str] = ()) -> bool:
        """Whether the event ends the capacity of a structure that may lose the blocks named."""
        return self.is_collapse and not set(self.blocks) <= set(may_fall)

    @property
    def place(self) -> str:
        """Multiplier and control displacement for people, or by how far supports have moved."""
        if self.support_unit == "rad":
            return f"at {math.degrees(self.control_displacement):.4g}° of the supports"
        if self.support_unit:
            return f"at {self.control_displacement:.4g} m of the supports"
        displacement = round(self.control_displacement, PRINTED) + 0.0
        return f"at {displacement:.4g} m, multiplier {self.load_multiplier:.4f}"

    @property
    def what(self) -> Saying:
        """What happened, as a clause."""
        several = len(self.blocks) != 1
        match self.kind:
            case EventKind.LOSS_OF_EQUILIBRIUM:
                return say("event.loss_several" if several else "event.loss", motion=self.motion)
            case EventKind.BLOCK_FALLEN:
                key = "event.fall" if several else "event.falls"
                blocks = named(self.blocks, "block")
                return say(key, blocks=blocks, motion=self.motion, after=self._after)
            case EventKind.BLOCK_DISPLACED:
                key = "event.move" if several else "event.moves"
                return say(key, blocks=named(self.blocks, "block"), motion=self.motion)
            case EventKind.TIE_YIELDED:
                key = "event.yields" if len(self.ties) == 1 else "event.yield"
                return say(key, ties=named(self.ties, "tie"))
            case EventKind.TIE_BROKEN:
                key = "event.breaks" if len(self.ties) == 1 else "event.break"
                return say(key, ties=named(self.ties, "tie"))
            case EventKind.SUPPORT_LOST:
                return say("event.support", blocks=named(self.blocks, "support"))

    @property
    def _after(self) -> Saying:
        several = len(self.blocks) != 1
        match self.outcome:
            case Outcome.HANGING:
                return say("event.hang" if several else "event.hangs")
            case Outcome.LEFT:
                return say("event.leave" if several else "event.leaves")
            case _:
                return say("event.after_nothing")

    @property
    def said(self) -> Saying:
        """Where it happened, and what."""
        place = round(self.control_displacement, PRINTED) + 0.0
        if self.support_unit == "rad":
            return say("event.at_turned", place=math.degrees(place), what=self.what)
        if self.support_unit:
            return say("event.at_supports", place=place, what=self.what)
        return say("event.at", place=place, multiplier=self.load_multiplier, what=self.what)

    def __str__(self) -> str:
        return str(self.said)

    def as_dict(self) -> dict[str, Any]:
        """For files: plain values, kinds by their names."""
        found = asdict(self)
        del found["support_unit"]
        return {**found, "kind": str(self.kind), "outcome": self.outcome and str(self.outcome)}


def named(names: Sequence[str], noun: str) -> Saying:
    """One name, or a number and some of the names: 'the block "a"', '3 blocks ("a", "b", ...)'.

    The noun is "block", "tie" or "support".
    """
    quoted = [f'"{name}"' for name in names[:FEW]]
    if len(names) == 1:
        return say(f"named.{noun}", names=quoted)
    more = ["..."] if len(names) > FEW else []
    return say(f"named.{noun}s", n=len(names), names=quoted + more)


def first_collapse(events: Iterable[Event], may_fall: Collection[str] = ()) -> Event | None:
    """The first event that ends the capacity of the structure, see `Event.limits`."""
    limiting = (event for event in events if event.limits(may_fall))
    return min(limiting, key=lambda event: event.step, default=None)


def falls_with(events: Iterable[Event], first: Event) -> set[str]:
    """Ids of all blocks that collapse where an event begins: some fall, some come to rest."""
    return {
        block
        for event in (first, *events)
        if event.is_collapse and event.step == first.step
        for block in event.blocks
    }
