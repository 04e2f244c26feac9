"""What a structure bears at rest, by control displacement: the static lower envelope of a curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.assessment.errors import UnfinishedError
from drystone.common.arrays import Array
from drystone.common.language import say
from drystone.common.tolerances import ROUNDING, STOP_SHARE
from drystone.results.curve import STATIC, CapacityCurve, CurvePoint
from drystone.results.events import EventKind, first_collapse

#: Share of the last displacement over which the slope of that branch is taken.
TAIL = 0.02


@dataclass(frozen=True, kw_only=True, eq=False)
class Envelope:
    """A curve that grows in displacement, and where it ends."""

    control_displacement: Array  # (n,) m, growing
    load_multiplier: Array  # (n,)
    collapse_displacement: float | None  # m, where the multiplier is zero; None: not reached
    collapse_extrapolated: bool  # whether that lies beyond the last point at rest
    notes: tuple[str, ...]  # what was left out or added, a sentence each
    collapse_note: str = ""  # how the collapse displacement was found, where there is more to say


def static_envelope(curve: CapacityCurve) -> Envelope:
    """The least that is borne at rest at each displacement.

    Points on the way of a jump are dropped; the points at rest before and after it are joined by a
    straight line.  Points at rest with a negative multiplier are dropped, too, if the structure
    carries load again after them: it moves over them by itself, as where a tie breaks and a wall
    leans on the next one.  Where the control point turns back, the lower of its branches
    counts.  Where it stands still while strength is lost, as where a tie breaks, the curve drops
    there: what is borne just before is part of it.

    Raises
    ------
    UnfinishedError
        Fewer than two points at rest, or none that bears any load.
    """
    static = _at_rest(curve)
    d = np.array([p.control_displacement for p in static])
    x = np.array([p.load_multiplier for p in static])
    if len(static) < 2 or not x.max() > 0.0:
        raise UnfinishedError(say("refused.few_points", n=len(static)))
    notes = []
    dropped = len(curve.points) - len(static)
    if dropped > (curve.ended_by is not None):
        notes.append(say("mechanism.dropped", n=dropped))
    grown, least, back = _lower(_apart(d, x), x)
    if back:
        notes.append(say("mechanism.turns_back"))
    end, extrapolated, note = _collapse(curve, d, x)
    return Envelope(
        control_displacement=grown,
        load_multiplier=least,
        collapse_displacement=end,
        collapse_extrapolated=extrapolated,
        notes=tuple(notes),
        collapse_note=note,
    )


def _at_rest(curve: CapacityCurve) -> list[CurvePoint]:
    """The points at rest at which nothing holds the structure back, and those at the end, by which
    it has collapsed."""
    static = [p for p in curve.points if p.status == STATIC]
    carries = [k for k, p in enumerate(static) if p.load_multiplier > 0.0]
    last = carries[-1] if carries else 0
    return [p for k, p in enumerate(static) if k > last or not p.load_multiplier < 0.0]


def _apart(d: Array, x: Array) -> Array:
    """The displacements of a path; where strength is lost at one displacement, the point before is
    nearer by rounding, so that the drop has an upper and a lower end."""
    least = ROUNDING * float(np.abs(d).max())
    drops = 1 + np.flatnonzero((np.abs(np.diff(d)) < least) & (np.diff(x) < 0.0))
    drops = drops[drops >= 2]
    drops = drops[d[drops - 1] - d[drops - 2] > 2.0 * least]
    apart = d.copy()
    apart[drops - 1] -= least
    return apart


def _lower(d: Array, x: Array) -> tuple[Array, Array, bool]:
    """The lower envelope of a path, and whether that turns back beyond what is rounding."""
    step = np.diff(d)
    back = bool((step < -1e-6 * np.abs(d).max()).any())
    if (step > 0.0).all() and d[0] >= 0.0:
        return d, x, back
    grown = np.unique(np.maximum(d, 0.0))
    least = np.full(len(grown), np.inf)
    turns = np.flatnonzero(np.diff(np.sign(step)) != 0) + 1
    for run in np.split(np.arange(len(d)), turns):
        run = np.append(run, run[-1] + 1) if run[-1] + 1 < len(d) else run
        places, values = d[run], x[run]
        if places[0] > places[-1]:
            places, values = places[::-1], values[::-1]
        alone, first = np.unique(places, return_index=True)
        lowest = np.minimum.reduceat(values, first)
        least = np.minimum(least, np.interp(grown, alone, lowest, left=np.inf, right=np.inf))
    known = np.isfinite(least)
    return grown[known], least[known], back


def _collapse(curve: CapacityCurve, d: Array, x: Array) -> tuple[float | None, bool, str]:
    """Control displacement where nothing is borne any more [m], and how it was found."""
    top = int(np.argmax(x))
    down = np.flatnonzero(x[top:] <= 0.0)
    if len(down):
        i = top + int(down[0])
        share = x[i - 1] / (x[i - 1] - x[i])
        return float(d[i - 1] + share * (d[i] - d[i - 1])), False, ""
    if curve.ends_in_motion or curve.ended_by is not None:
        event = curve.ended_by or first_collapse(curve.events)
        there = {"place": float(d[-1]), "multiplier": float(x[-1])}
        if event is None:
            return float(d[-1]), False, say("mechanism.falls", **there)
        return float(d[-1]), False, say("mechanism.falls_where", what=event.what, **there)
    if top == len(x) - 1 or x[-1] > STOP_SHARE * x[top]:
        return None, False, ""
    top = max(top, _last_change(curve))
    if top >= len(x) - 1:
        return None, False, ""
    before = top + int(np.argmax(d[top:] >= (1.0 - TAIL) * d[-1]))
    before = min(before, len(d) - 2)
    slope = (x[-1] - x[before]) / (d[-1] - d[before]) if d[-1] > d[before] else 0.0
    if slope >= 0.0:
        before, slope = top, (x[-1] - x[top]) / (d[-1] - d[top]) if d[-1] > d[top] else 0.0
    if slope >= 0.0:
        return None, False, ""
    end = float(d[-1] - x[-1] / slope)
    known = {"multiplier": float(x[-1]), "place": float(d[-1])}
    return end, True, say("mechanism.extrapolated", end=end, **known)


def _last_change(curve: CapacityCurve) -> int:
    """The first of the points at rest from which on the same forces act and the same blocks bear:
    no line goes on over what changes them.  A tie yields from a point on, other events come after
    one."""
    steps = [p.step for p in _at_rest(curve)]
    changes = [event for event in curve.events if event.changes]
    last = max((event.step for event in changes), default=-1)
    after = any(e.step == last and e.kind is not EventKind.TIE_YIELDED for e in changes)
    return int(np.searchsorted(steps, last, side="right" if after else "left"))
