"""Finds the events along a curve from its points, poses, ties and contacts.

A structure *moves by itself* where it jumps.  There are three signs of a jump: dynamic points lie
between two neighbouring static points; the second is marked as reached in a jump; or a block has
moved so far in one step that it would have collapsed (steps are a fifth of the smallest block at
most).  An engine may also follow a part that falls through equilibria, while the control
displacement goes back.  Where these need a load against the load, the structure has moved by itself
since the control displacement turned back.  The structure first *loses its equilibrium* in the
first jump in which a block moves by more than `SNAP` of its smallest extent, or collapses.

A block has collapsed if it moves by itself by more than `Analysis.event_share` of its smallest
extent, even if it moves back within the jump.  It has *fallen* if it then lies lower by as much,
hangs on ties alone or has left the structure; else it is *displaced*.  The share is a half by
default: a block on the middle of another of its size has then its centroid above the edge of that
block, and rests on it no longer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.contact.forces import ContactForces
from drystone.geometry.motion import translations
from drystone.model.assembly import Assembly
from drystone.model.model import Model
from drystone.model.ties import BROKEN, YIELDING, Tie, TieState, names_of
from drystone.results.curve import STATIC, BlockLeft, CurvePoint, falls
from drystone.results.events import Event, EventKind, Outcome
from drystone.results.forces import TieRecord

#: Share of a block's smallest extent up to which a jump is no event.  The steps of
#: `equilibrium` are as long or longer, so that a curve does not tell such a jump from a step.
SNAP = 0.02

Contacts = Callable[[], ContactForces]


class EventLog:
    """Takes the points of a curve one by one, and keeps the events that it sees."""

    def __init__(self, model: Model) -> None:
        self._assembly = assembly = model.assembly
        self._ties = model.ties
        self._support_unit = model.settlement.unit if model.settlement else ""
        self._limit = model.analysis.event_share * assembly.extents  # m
        self._snap = np.minimum(SNAP * assembly.extents, self._limit)  # m
        self._up = assembly.up
        self._events: list[Event] = []
        self._last: tuple[CurvePoint, Array] | None = None  # where it last rested, and the pose
        self._monotone = model.history is None  # the control displacement that is asked for
        self._turned: tuple[CurvePoint, Array] | None = None  # rest at the farthest since a jump
        self._rests = False  # whether the last point is at rest, and not on the way down
        self._resting: CurvePoint | None = None  # the last one that is
        self._pose: Array | None = None  # of the last point
        self._moving = False  # whether the structure has moved by itself since
        self._through_motion = False  # whether there was a dynamic point since
        self._far = np.zeros(assembly.n_bodies)  # m, by which it did, at most
        self._departed = np.zeros(assembly.n_bodies, np.bool_)  # left since
        self._collapsed = np.zeros(assembly.n_bodies, np.bool_)  # in the jump that is under way
        self._lost_equilibrium = False
        self._branch: IntArray | None = None
        self._yielded = np.zeros(len(model.ties), np.bool_)
        self._bearing: set[int] | None = None  # supports that bore the structure at first
        self._watch_supports = int(assembly.fixed.sum()) > 1

    @property
    def events(self) -> tuple[Event, ...]:
        """Those found so far, in the order of the curve."""
        return tuple(sorted(self._events, key=lambda event: event.step))

    def add(
        self,
        point: CurvePoint,
        pose: Array,
        contacts: Contacts,
        *,
        ties: TieState | None = None,
        left: Sequence[int] = (),
    ) -> list[int]:
        """Take the next point.

        Parameters
        ----------
        pose
            (n, n_pose) m, as in `motion`.
        contacts
            Gives the contact forces of the point; asked where an event needs them.
        ties
            What the ties carry at the point.
        left
            Rows of blocks that have left the structure since the point before.

        Returns
        -------
        Rows of the blocks that have collapsed since the point before.
        """
        if ties is not None:
            self._see_ties(point, ties, self._resting or point)
        at_rest = point.status == STATIC
        self._rests = rests = at_rest and not (self._monotone and falls(point, self._farthest))
        if at_rest and not rests:
            self._last = self._turned
        collapsed: list[int] = []
        self._departed[list(left)] = True
        if self._last is not None:
            self._moving |= not rests or point.jumped or len(left) > 0
            if not self._moving:
                self._moving = bool((self._way(pose) > self._limit).any())
            self._through_motion |= not at_rest
            if self._moving:
                collapsed = self._move(pose)
        self._pose = pose
        if at_rest:
            self._resting = point
        if rests:
            jumped = self._moving
            if jumped:
                self._come_to_rest(contacts)
            self._last = (point, np.array(pose))
            if jumped or point.control_displacement >= self._farthest:
                self._turned = self._last
        if at_rest and self._watch_supports:
            self._see_supports(point, contacts())
        return collapsed

    @property
    def _farthest(self) -> float:
        """Of the control displacement at rest since a jump [m]."""
        return -np.inf if self._turned is None else self._turned[0].control_displacement

    def end(self) -> tuple[Event, ...]:
        """The curve is over: all its events.  What still moves then is in motion."""
        if self._moving:
            self._come_to_rest(None)
        return self.events

    def _way(self, pose: Array) -> Array:
        """By how far centroids are from where they last rested, (n,) [m]."""
        assert self._last is not None
        moved = translations(pose) - translations(self._last[1])
        return np.sqrt(np.einsum("ij,ij->i", moved, moved))

    def _move(self, pose: Array) -> list[int]:
        assert self._last is not None
        self._far = np.maximum(self._far, self._way(pose))
        new = ((self._far > self._limit) | self._departed) & ~self._collapsed
        self._collapsed |= new
        return [int(i) for i in np.flatnonzero(new)]

    def _come_to_rest(self, contacts: Contacts | None) -> None:
        """A jump is over: what it moved.  Without ``contacts`` it is not, but the curve is."""
        assert self._last is not None and self._pose is not None
        before, start = self._last
        place = {
            "step": before.step,
            "control_displacement": before.control_displacement,
            "load_multiplier": before.load_multiplier,
        }
        snapped = self._through_motion and bool((self._far > self._snap).any())
        if not self._lost_equilibrium and (snapped or self._collapsed.any()):
            self._lost_equilibrium = True
            movers = self._collapsed if self._collapsed.any() else self._far >= self._far.max()
            self._log(EventKind.LOSS_OF_EQUILIBRIUM, movers, None, **place)
        if self._collapsed.any():
            hanging = self._hanging(contacts)
            drop = (translations(start) - translations(self._pose)) @ self._up
            fallen = self._collapsed & ((drop > self._limit) | self._departed | hanging)
            displaced = self._collapsed & ~fallen
            rest = Outcome.AT_REST if self._rests else Outcome.IN_MOTION
            for kind, rows, outcome in (
                (EventKind.BLOCK_FALLEN, fallen & self._departed, Outcome.LEFT),
                (EventKind.BLOCK_FALLEN, fallen & ~self._departed & hanging, Outcome.HANGING),
                (EventKind.BLOCK_FALLEN, fallen & ~self._departed & ~hanging, rest),
                (EventKind.BLOCK_DISPLACED, displaced, rest),
            ):
                if rows.any():
                    self._log(kind, rows, outcome, **place)
        self._moving = self._through_motion = False
        for array in (self._far, self._departed, self._collapsed):
            array[:] = 0

    def _log(
        self, kind: EventKind, rows: BoolArray, outcome: Outcome | None, **place: float
    ) -> None:
        self._events.append(
            Event(
                kind=kind,
                step=int(place["step"]),
                control_displacement=place["control_displacement"],
                load_multiplier=place["load_multiplier"],
                blocks=self._ids(np.flatnonzero(rows)),
                motion=float(self._far[rows].max(initial=0.0)),
                outcome=outcome,
                support_unit=self._support_unit,
            )
        )

    def _ids(self, rows: Sequence[int] | IntArray) -> tuple[str, ...]:
        return tuple(self._assembly.ids[int(i)] for i in rows)

    def _hanging(self, contacts: Contacts | None) -> BoolArray:
        """Blocks that have collapsed, are tied and touch nothing, (n,)."""
        tied = np.zeros(self._assembly.n_bodies, np.bool_)
        if contacts is None or self._branch is None:
            return tied
        for tie, branch in zip(self._ties, self._branch, strict=True):
            if branch != BROKEN:
                tied[_rows(tie, self._assembly)] = True
        tied &= self._collapsed
        if tied.any():
            found = contacts()
            closed = found.normal_reaction > 0.0
            tied[found.block_a[closed]] = False
            tied[found.block_b[closed]] = False
        return tied

    def _see_ties(self, point: CurvePoint, ties: TieState, before_it: CurvePoint) -> None:
        """Ties that yield at a point, and those that break after the rest ``before_it``; so do
        those that yield in motion, or they would yield after they have broken."""
        now, before = ties.branch, self._branch
        self._branch = np.array(now)
        yields = (now == YIELDING) & ~self._yielded
        self._yielded |= yields
        breaks = now == BROKEN if before is None else (now == BROKEN) & (before != BROKEN)
        for kind, rows, place in (
            (EventKind.TIE_YIELDED, yields, point if point.status == STATIC else before_it),
            (EventKind.TIE_BROKEN, breaks, before_it),
        ):
            if rows.any():
                tied = [self._ties[k] for k in np.flatnonzero(rows)]
                joined = {row for tie in tied for row in _rows(tie, self._assembly)}
                self._events.append(
                    Event(
                        kind=kind,
                        step=place.step,
                        control_displacement=place.control_displacement,
                        load_multiplier=place.load_multiplier,
                        blocks=self._ids(sorted(joined)),
                        ties=tuple(np.array(names_of(self._ties))[rows].tolist()),
                        support_unit=self._support_unit,
                    )
                )

    def _see_supports(self, point: CurvePoint, contacts: ContactForces) -> None:
        """Supports that bear nothing any more, each once."""
        closed = contacts.normal_reaction > 0.0
        touched = {*contacts.block_a[closed].tolist(), *contacts.block_b[closed].tolist()}
        bearing = {row for row in touched if self._assembly.fixed[row]}
        if self._bearing is None:
            self._bearing = bearing
        lost = sorted(self._bearing - bearing)
        self._bearing -= set(lost)
        if lost:
            self._events.append(
                Event(
                    kind=EventKind.SUPPORT_LOST,
                    step=point.step,
                    control_displacement=point.control_displacement,
                    load_multiplier=point.load_multiplier,
                    blocks=self._ids(lost),
                    support_unit=self._support_unit,
                )
            )


def events_of(
    model: Model,
    points: Sequence[CurvePoint],
    poses: Array,
    contacts: Sequence[ContactForces],
    *,
    ties: TieRecord | None = None,
    left: Sequence[BlockLeft] = (),
) -> tuple[Event, ...]:
    """The events of a curve that was kept, as of a file of results.

    Parameters
    ----------
    poses
        (n_points, n, n_pose).
    contacts
        One entry a point.
    """
    log = EventLog(model)
    for k, point in enumerate(points):
        rows = [model.assembly.index(block.block) for block in left if block.step == point.step]
        log.add(
            point,
            poses[k],
            lambda k=k: contacts[k],  # type: ignore[misc]
            ties=None if ties is None else ties.at(k),
            left=rows,
        )
    return log.end()


def _rows(tie: Tie, assembly: Assembly) -> list[int]:
    """Rows of the blocks that a tie joins."""
    return [end.row(assembly) for end in (tie.start, tie.end) if end.block is not None]
