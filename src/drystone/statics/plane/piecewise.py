"""A static step: its linear pieces followed from the last equilibrium to the next.

The joint law is piecewise linear and, with friction, has no energy to descend on: full Newton steps
over many contacts that open, slide and stick at once lose their way.  So the pieces are followed
one by one (`statics.plane.path`), with the gradients of gaps and slips held fast where the blocks
are guessed to end.  Where many contacts are about to change, their branches are found all at once
(`statics.plane.interior`), and the path is followed from there.  Then the gradients are renewed
and what is left, of second order in the guess's error, is corrected in the same way.

A path that turns back says that no equilibrium lies ahead: the structure snaps.  The step then ends
in an equilibrium beyond, where the interior point finds one; whether to take it is for the control
to say.  Equilibria that the structure would not keep are never taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.contact.contacts import EDGE_A
from drystone.contact.plane import narrow
from drystone.statics.linear_step import Pace
from drystone.statics.plane import path
from drystone.statics.plane.interior import InteriorPoint
from drystone.statics.plane.static_step import StaticStep

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ENDS = {
    path.TURNED: "the path of equilibria turns back",
    path.LOST: "too many contacts change",
    path.SINGULAR: "a part of the structure is free to move",
}


#: Why no equilibrium can be told from others near it.
TOO_STIFF = (
    "the joints are too stiff for the blocks' weight: the rounding of a displacement, times their "
    "stiffness, exceeds the unbalanced force that may be left; lower the joint's stiffness"
)


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """What a step is solved to, on the scales of a model."""

    tolerance: float  # N, largest unbalanced force
    rounding: float  # N/m, of a reaction, by metre of its blocks' motion: normal to the joint
    sliding_rounding: float  # N/m, and along it, where only the motion within the step counts
    coarsest: float  # N, largest unbalanced force that may be left to rounding
    lag: float = 1e-12  # m, what may be missing of the increment
    depth: float  # m, penetration too small to tell two contacts apart
    slight: float  # m, by which a gap may change with other features, of many blocks
    farthest: float  # m, motion of a block over which the step has failed


@dataclass(frozen=True, kw_only=True)
class PathSettings:
    """Numbers of the method: how long a path is followed, and what is done about many changes."""

    #: Renewals of the gradients before a step counts as failed; most take two.
    max_iterations: int = 12
    #: Contacts about to change above which the interior point is as cheap as following them.
    worth: int = 60
    #: Blocks from which on it is used: of fewer every change is followed, for failing is cheap and
    #: the path tells best where a structure snaps.
    many_blocks: int = 300
    #: Steps of Newton's method from where the interior point has led.
    max_leaps: int = 12
    #: The same from where the interior is left early: most take two to four, and the interior
    #: goes on after those that fail.
    early_leaps: int = 4
    #: Renewals up to which it is left early: what has not settled by then may go to and fro between
    #: equilibria that friction leaves open, of which the interior always takes the same.
    early_renewals: int = 3
    #: Contacts about to change that are followed instead of such a step.
    last_changes: int = 16
    #: Changes of contacts, one by one, on the path of the implicit law.
    max_changes: int = 80
    #: Changes times blocks on a path of equilibria, or while settling: some seconds of work.
    change_effort: int = 1_500_000
    #: Times that other features of contacts are found where a step ends, and it is solved again.
    max_rounds: int = 3
    #: Steps for which a pair keeps features that take turns with others, and blocks from which on
    #: it does.
    keep_steps: int = 8
    keep_blocks: int = 300


@dataclass(frozen=True, kw_only=True)
class StepSolution:
    """Where the path led; with a `reason` where that is not an equilibrium."""

    increment: Array  # (n, n_dof)
    multiplier: float
    n_iterations: int
    #: Share of the step, and multiplier there, where the path of equilibria first turned back.
    turn: tuple[float, float] | None = None
    #: By how much the multiplier exceeds both its ends within the step, and how far it bends from
    #: its chord, each with the share of the step where it does so most.
    excess: tuple[float, float] | None = None
    bend: tuple[float, float] | None = None
    #: How far from the tangent at its start a step has taken the block that it took farthest, over
    #: the farthest motion of all; in space.
    swerve: float | None = None
    slope: float = np.nan  # 1/m, of the curve at the end; in space
    tangent: Array | None = None  # (n, n_dof) per m of the pacing displacement, in space
    unstable: bool = False  # whether the structure would not keep it, and none was found beside it
    softened: bool = False  # whether joints soften where it is, and the slope is with that
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class _Shape:
    """See `StepSolution`."""

    excess: tuple[float, float] = (0.0, 0.0)
    bend: tuple[float, float] = (0.0, 0.0)


def solve(
    step: StaticStep,
    interior: InteriorPoint,
    pace: Pace | None,
    guess: Array,
    multiplier: float,
    branch: IntArray,
    reaction: Array,
    accuracy: Accuracy,
    settings: PathSettings,
    *,
    whole: bool,
) -> StepSolution:
    """Solve a step that has begun; its equations are left evaluated at the solution.

    Parameters
    ----------
    step, interior
        The equations, and what finds many branches at once for them.
    pace
        What paces the step, the multiplier being an unknown; None where it is given.
    guess
        Increments (n, n_dof) near which the step will end.
    multiplier
        Where the step starts; without a pace, the one that is asked for.
    branch, reaction
        Of all contacts where the step starts, (n_slots,) and (n_slots, dim) [N].
    whole
        Take the implicit law, whose sliding counts over the whole step, from the start.
    """
    step.branch[:] = branch
    step.evaluate(guess, multiplier)
    if pace is None and step.residual <= _enough(step, 0.0, accuracy):
        x = step.given.copy() if not step.given.any() else guess.copy()
        step.find(x)
        return StepSolution(increment=x, multiplier=multiplier, n_iterations=0)
    step.branch[:], step.reaction[:] = branch, reaction
    step.frame.turn[:] = np.nan
    return _correct(step, interior, pace, guess, multiplier, accuracy, settings, whole=whole)


def stands(
    step: StaticStep, pace: Pace | None, x: Array, multiplier: float, accuracy: Accuracy
) -> bool:
    """Whether a step that has begun is solved at the increments ``x`` (n, n_dof), with the contacts
    that are found there; its equations are left evaluated."""
    step.evaluate(x, multiplier)
    moved = step.constants.detector.farthest(x)
    enough, short = _enough(step, moved, accuracy), abs(pace.missing(x)) if pace else 0.0
    if not (step.residual <= enough and short <= accuracy.lag and moved <= accuracy.farthest):
        return False
    step.find(x)
    return not narrow.changed_contacts(step.slots, step.found, accuracy.depth)


def _correct(
    step: StaticStep,
    interior: InteriorPoint,
    pace: Pace | None,
    geometry: Array,
    multiplier: float,
    accuracy: Accuracy,
    settings: PathSettings,
    *,
    whole: bool,
) -> StepSolution:
    """Follow the pieces with gradients of the ``geometry`` (n, n_dof), renew these, and again."""
    x, start = step.given.copy(), multiplier
    follows = pace is not None or bool(step.given.any())
    features = _Features(step, accuracy, settings)
    reason, count = "", 0
    shape: _Shape | None = _Shape()
    for count in range(1, settings.max_iterations + 1):
        walk = _Walk(step, interior, pace, geometry, accuracy, settings, count, whole=whole)
        end, x, multiplier = walk.go(x, multiplier)
        if end == path.DONE and follows and not step.stable:
            end = path.TURNED
        if end != path.DONE:
            reason = _ENDS[end]
            break
        step.remember()
        geometry = x
        moved = step.constants.detector.farthest(x)
        if not moved <= accuracy.farthest:  # also where it is not a number
            reason = "a block moves too far in one step"
            break
        step.evaluate(x, multiplier)
        if count == 1 and pace:
            # Within a leap there are no places on a path.
            shape = None if walk.leapt else _shape(step.bends(walk.changes), start, multiplier)
        short = abs(pace.missing(x)) if pace else 0.0
        enough = _enough(step, moved, accuracy)
        if enough > accuracy.coarsest:
            reason = TOO_STIFF
            break
        if step.residual > enough or short > accuracy.lag:
            continue
        step.find(x)
        if not features.change():
            break
        step.follow(step.found)
        step.evaluate(x, multiplier)
    else:
        reason = f"no equilibrium within {settings.max_iterations} iterations"
    share, there = step.frame.turn.tolist()
    return StepSolution(
        increment=x,
        multiplier=multiplier,
        n_iterations=count,
        turn=(share, there) if np.isfinite(share) else None,
        excess=shape.excess if shape and not reason else None,
        bend=shape.bend if shape and not reason else None,
        reason=reason,
    )


class _Features:
    """Of the contacts that press: whether those found where a step ends are those it followed.

    With either of two sets blocks may end where they have the other: two corners that hardly pass
    each other have one contact or two.  Of many blocks, the features of a pair therefore change
    once in a step, and back once, and then stay for some steps: to try the others again costs a
    solution each time, and moves blocks to and fro that would come to rest.  Features that hardly
    change a gap stay as well.
    """

    def __init__(self, step: StaticStep, accuracy: Accuracy, settings: PathSettings) -> None:
        self.step, self.depth, self.slight = step, accuracy.depth, accuracy.slight
        self.rounds, self.settings = 0, settings
        self.many = len(step.pose) >= settings.keep_blocks
        if self.many:
            self.before = step.kept.copy()
            #: Times that the features of a pair have changed, (n_pairs,).
            self.changes = np.where(step.kept > 0, 2, 0)

    def change(self) -> bool:
        """Whether the step is to be solved again, with the features found."""
        was, now = self.step.slots, self.step.found
        if not narrow.changed_contacts(was, now, self.depth):
            self.step.kept[:] = 0
            return False
        if self.many:
            return self._change_some()
        self.rounds += 1
        return self.rounds <= self.settings.max_rounds

    def _change_some(self) -> bool:
        """Likewise; contacts found of pairs whose features stay are made those followed."""
        step = self.step
        of_slot, was, now = step.pairs.of_slot, step.slots, step.found
        apart = np.abs(np.minimum(was.gap, 0.0) - np.minimum(now.gap, 0.0))
        others = (was.which[:, :EDGE_A] != now.which[:, :EDGE_A]).any(axis=1)
        others &= np.minimum(was.gap, now.gap) <= -self.depth
        stay, change = np.zeros((2, len(step.kept)), np.bool_)
        stay[of_slot[others]] = True
        change[of_slot[others & (apart > self.slight)]] = True
        keep = change & (self.changes >= 2)
        steps = np.where(self.before > 0, self.before - 1, self.settings.keep_steps)
        step.kept[:] = np.where(keep, steps, 0)
        rows = (keep | (stay & ~change))[of_slot]
        for mine, theirs in zip(now, was, strict=True):
            mine[rows] = theirs[rows]
        change &= ~keep
        self.changes[change] += 1
        self.rounds += 1
        return bool(change.any()) and self.rounds <= self.settings.max_rounds


def _enough(step: StaticStep, moved: float, accuracy: Accuracy) -> float:
    """Unbalanced force [N] that may be left: the tolerance, or what is rounding where blocks have
    ``moved`` [m] at most in the step.

    Gaps are as precise as displacements from the design, slips as those within the step.
    """
    if step.residual <= accuracy.tolerance:
        return accuracy.tolerance
    far = step.constants.detector.farthest(step.pose) + moved
    rounding = max(accuracy.rounding * far, accuracy.sliding_rounding * moved)
    return max(accuracy.tolerance, rounding)


class _Walk:
    """A way to the solution of one linear step, the contacts having been evaluated."""

    def __init__(
        self,
        step: StaticStep,
        interior: InteriorPoint,
        pace: Pace | None,
        geometry: Array,
        accuracy: Accuracy,
        settings: PathSettings,
        count: int,
        *,
        whole: bool,
    ) -> None:
        self.step, self.interior, self.pace = step, interior, pace
        self.geometry, self.accuracy, self.settings = geometry, accuracy, settings
        self.whole = whole = whole or count > 1
        self.early = pace is not None and count <= settings.early_renewals
        self.lag = pace.missing(geometry) if pace else 0.0
        self.gradient = pace.gradient(geometry) if pace else step.force
        n = len(geometry)
        #: Of few blocks, every change is followed: that tells best where a structure snaps, and
        #: failing there is cheap.
        self.few = pace is not None and n < settings.many_blocks
        self.worth = 2 * step.count if self.few else settings.worth
        self.most = settings.max_changes
        if len(step.start.held):
            # Points of a joint that softens change together.
            self.most = max(self.most, min(2 * step.count, settings.change_effort // n))
        self.patience = self.most
        if not whole or pace is None:
            most = min(2 * step.count, settings.change_effort // n)
            self.patience = max(2 * self.patience, most)
        self.leapt = False
        self._set_out()

    def _set_out(self) -> None:
        self.left, self.changes = 1.0, 0
        self.step.frame.sense[0] = 1.0

    def go(self, x: Array, multiplier: float) -> tuple[int, Array, float]:
        """How it ends, and where: followed, but from the interior where many contacts change."""
        step = self.step
        begun = None if self.few else (step.branch.copy(), step.reaction.copy())
        step.move_trial(x - self.geometry)
        trial = x.copy()
        end, at = self._follow(trial, multiplier, self.worth)
        if end == path.DONE or begun is None:
            return end, trial, at
        if end != path.MANY:
            step.evaluate(self.geometry, multiplier)
            step.move_trial(x - self.geometry)
            step.branch[:], step.reaction[:] = begun
            trial = x.copy()
        beyond, at = self._leap(trial, multiplier)
        lost = beyond != path.DONE and end == path.TURNED
        return (end if lost else beyond), trial, at

    def _leap(self, x: Array, multiplier: float) -> tuple[int, float]:
        """All changes at once: their branches from the interior, then Newton's method."""
        step = self.step
        self._set_out()
        self.leapt = self.whole = True
        self.patience = self.most
        start, branch = x.copy(), step.branch.copy()
        descent = self.interior.descent(x, multiplier, self.geometry, self.pace, self.gradient)
        if self.early and descent.run(self.accuracy.tolerance, early=True):
            table = step.contacts.table[: step.count]
            before = x.copy(), table.copy()
            end, at = self._land(x, descent.multiplier, self.settings.early_leaps)
            if end == path.DONE and step.stable:
                return end, at
            self._set_out()
            (x[:], table[:]), step.branch[:] = before, branch
        if descent.run(self.accuracy.tolerance):
            return self._land(x, descent.multiplier, self.settings.max_leaps)
        # Blocks that hardly touch, and fall, or jam where the barrier is yet high: Newton's method
        # does without the interior.
        step.move_trial(start - x)
        x[:], step.branch[:] = start, branch
        return self._land(x, multiplier, self.settings.max_leaps)

    def _land(self, x: Array, multiplier: float, leaps: int) -> tuple[int, float]:
        """Newton's method from branches that are nearly all known."""
        for _ in range(leaps):
            end, multiplier = self._follow(x, multiplier, self.settings.last_changes)
            if end != path.MANY:
                return end, multiplier
        return path.LOST, multiplier

    def _follow(self, x: Array, multiplier: float, worth: int) -> tuple[int, float]:
        """Follow every change, in the implicit law from where the path first turns back."""
        end = path.RENEW
        while end == path.RENEW:
            if not self.whole and np.isfinite(self.step.frame.turn[0]):
                self.whole = True
                self.patience = min(self.patience, self.changes + self.most)
            end, multiplier = self._advance(x, multiplier, worth)
            worth = self.step.count
        return end, multiplier

    def _advance(self, x: Array, multiplier: float, worth: int) -> tuple[int, float]:
        """Go on from ``x``, changed in place, with a matrix of its own."""
        away = x - self.geometry
        if not self.step.linearise(x, multiplier, away, self.pace, self.gradient):
            return path.SINGULAR, multiplier
        missing = self.lag - float(np.vdot(self.gradient, away)) if self.pace else 0.0
        enough = self.accuracy
        if self.leapt and self.step.residual <= enough.tolerance and abs(missing) <= enough.lag:
            # Only contacts that carry next to nothing may still change to and fro.
            return path.DONE, multiplier
        way = path.Way(multiplier, self.left, self.changes)
        rules = path.Rules(self.pace is not None, self.whole, self.patience, worth, self.leapt)
        end, (multiplier, self.left, self.changes) = self.step.advance(x, missing, way, rules)
        return end, multiplier


def _shape(bends: Array, start: float, end: float) -> _Shape:
    """Excess and bend of a path from the multipliers at its changes, (n, 2)."""
    if len(bends) == 0:
        return _Shape()
    share, multiplier = bends.T.tolist()  # Python's numbers: there are few
    top = max(range(len(share)), key=multiplier.__getitem__)
    off = [abs(m - start - t * (end - start)) for t, m in zip(share, multiplier, strict=True)]
    far = max(range(len(share)), key=off.__getitem__)
    return _Shape(
        excess=(multiplier[top] - max(start, end), share[top]),
        bend=(off[far], share[far]),
    )
