"""The result of a pushover analysis: the capacity curve, point by point, frozen."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, BoolArray
from drystone.common.language import say
from drystone.common.tolerances import MISSING, ROUNDING
from drystone.contact.forces import ContactForces
from drystone.model.monitor import ControlPoint
from drystone.results.cycles import Cycle, cycles_of, envelope
from drystone.results.events import PRINTED, Event, first_collapse
from drystone.results.forces import TieRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from drystone.assessment.verdict import Verdict
    from drystone.model.model import Model
    from drystone.model.site import Site


#: Status of a point: at rest, or in motion, as a block falls or a wall jumps.
STATIC, DYNAMIC = "static", "dynamic"

#: Share of the highest multiplier below which a curve has passed its peak; local drops, where a
#: block comes loose, are smaller as a rule.
PASSED = 0.99

#: Strategy of curves in which supports move, in place of a load.
SETTLEMENT = "settlement"

#: Strategy of curves whose control point goes to and fro, see `CapacityCurve.cycles`.
CYCLIC = "cyclic"

#: Strategy of curves whose control point goes one way.
DISPLACEMENT = "displacement"

#: Status of a curve that is complete, and of one that ends before.
FINISHED, STOPPED = "finished", "stopped"


class RecorderError(Exception):
    """Points of a curve cannot be kept as they come; the message is for the user."""


#: Fields of points, events and blocks that left: their sign is that along the load.
COUNTED_ALONG = (
    "control_displacement",
    "load_multiplier",
    "applied_multiplier",
    "carried_multiplier",
)


@dataclass(frozen=True, kw_only=True)
class CurvePoint:
    """One point of the curve with its certificate.

    ``residual`` is the largest unbalanced force on a block, or violation of the joint law, over
    the weight of the heaviest block.
    """

    step: int
    control_displacement: float  # m
    load_multiplier: float  # static: the assembly would rest under it in its present shape
    applied_multiplier: float
    carried_multiplier: float  # support reaction over the sum of the load pattern
    residual: float  # -
    penetration: float  # m, deepest overlap of two blocks' contact shapes
    friction_violation: float  # -, largest excess over the friction cone, over heaviest weight
    energy_ratio: float  # -, kinetic over potential energy released since the last point
    inertia_ratio: float  # -, inertia force over applied force
    n_open: int
    n_sticking: int
    n_sliding: int
    motion: float  # m, of the fastest block in this step
    time_step: float  # s
    n_iterations: int
    status: str = STATIC
    jumped: bool = False  # reached in a jump: none at rest lies between it and the point before
    lost_shear: float = 0.0  # -, of contacts that were taken away in the step, over heaviest weight
    unstable: bool = False  # an unstable equilibrium, and no stable one was found nearby
    # N or N m, of supports that move; control displacements are then their motion
    reaction: float = 0.0


@dataclass(frozen=True, kw_only=True)
class BlockLeft:
    """A block that has left the structure, and when: the last point that it was part of."""

    block: str
    step: int
    control_displacement: float  # m

    @classmethod
    def at(cls, point: CurvePoint, block: str) -> BlockLeft:
        """A block that left at a point."""
        return cls(block=block, step=point.step, control_displacement=point.control_displacement)

    @property
    def displacement_text(self) -> str:
        """The control displacement for people, without what is a rounding of zero."""
        return f"{round(self.control_displacement, PRINTED) + 0.0:.4g} m"

    def __str__(self) -> str:
        place = self.displacement_text.removesuffix(" m")
        return str(say("end.block_left", block=self.block, place=place, step=self.step))


#: What `CapacityCurve.outward` counts along a sense.
Counted = TypeVar("Counted", CurvePoint, BlockLeft, Event)


COLUMNS: tuple[str, ...] = tuple(f.name for f in fields(CurvePoint))


def _stays(before: CurvePoint, point: CurvePoint) -> bool:
    """Whether the control point stays between two points at rest, as where a bond breaks."""
    if {before.status, point.status} != {STATIC}:
        return False
    rounding = max(ROUNDING * abs(before.control_displacement), MISSING)
    return abs(point.control_displacement - before.control_displacement) <= rounding


def falls(point: CurvePoint, farthest: float) -> bool:
    """Whether a point at rest is one of a part that falls: a load against the load holds it, and
    the control point has turned back from its ``farthest`` displacement [m]."""
    behind = point.control_displacement < farthest
    return behind and point.status == STATIC and point.load_multiplier < 0.0


#: Unstable points in a row from which on they are told of.  Convention: after 1, 2, 4, ... of them
#: a stable equilibrium was looked for.
SERIES = 10

#: What of a model makes its curve, beside how it is traced.
TRACED = ("assembly", "load", "dead_loads", "ties", "settlement", "history")


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CapacityCurve:
    """Load multiplier against control displacement, over the peak and down.

    The control displacement is zero at the start of the load. Poses are counted from the designed
    places, `settlement` included. Every array has one entry per point. `reason` says in a sentence
    why the curve ends.
    """

    engine: str
    strategy: str
    points: tuple[CurvePoint, ...]
    status: str  # "finished", "stopped" or "interrupted"; "running" of results that grow still
    reason: str
    stop_multiplier: float
    wall_time: float  # s, without `compile_time`
    blocks_left: tuple[BlockLeft, ...] = ()  # in the order in which they went
    events: tuple[Event, ...] = ()  # in the order of the curve
    settlement: float = 0.0  # m, of the control point under the structure's own weight alone
    compile_time: float = 0.0  # s, of kernels that were needed for the first time on this machine
    poses: Array | None = None  # (n_points, n, n_pose), as in `motion`; None where not kept
    contacts: Sequence[ContactForces] | None = None  # likewise
    ties: TieRecord | None = None  # None where there are none
    ended_by: Event | None = None  # of a curve that was cut off there, see `until`
    motion_unit: str = "m"  # of control displacements; "rad" where they are a rotation of supports
    load_force: float = math.nan  # N, of the load pattern at multiplier one
    load_turns: bool = False  # whether it turns gravity, and so shrinks as the angle grows
    targets: tuple[float, ...] = ()  # m, that a cyclic analysis was to reach one after another
    model: Model | None = None  # what was traced; None of curves that were read

    @property
    def control_point(self) -> ControlPoint | None:
        """That of the model that was traced; None of curves that were read."""
        return None if self.model is None else self.model.control_point

    def traced_of(self, model: Model) -> Model:
        """The model with the control point that the curve was traced with."""
        if self.control_point is None or model.control_point is self.control_point:
            return model
        return replace(model, control_point=self.control_point)

    def is_of(self, model: Model) -> bool:
        """Whether this structure under these loads was traced, as far as the curve knows; its
        control point, analysis and assessment may be others."""
        if self.model is None:
            return True
        own = {name: getattr(self.model, name) for name in TRACED}
        if all(value is getattr(model, name) for name, value in own.items()):
            return True
        if self.model.assembly.ids != model.assembly.ids:
            return False
        from drystone.model.construction.describe import digest

        return digest(replace(model, **own)) == digest(model)

    def column(self, name: str) -> NDArray[Any]:
        """One quantity over all points, (n_points,); the names are the fields of `CurvePoint`."""
        return np.array([getattr(point, name) for point in self.points])

    def to_frame(self) -> DataFrame:
        """All columns as a frame of pandas, one row per point; needs pandas."""
        try:
            from pandas import DataFrame
        except ImportError:
            raise ImportError(
                "pandas is not installed: install it, or take curve.column(name) for arrays"
            ) from None
        return DataFrame({name: self.column(name) for name in COLUMNS})

    def plot(
        self,
        ax: Axes | None = None,
        *,
        label: str = "",
        limits: Mapping[str, float] | None = None,
    ) -> Axes:
        """Draw the curve on axes, those of a new figure by default: see `report.plot_curve`."""
        from drystone.report.plots import plot_curve

        return plot_curve(self, ax, label=label, limits=limits)

    def assess(self, model: Model, *, site: Site | None = None, **options: Any) -> Verdict:
        """Limit states and verdict, as ``drystone assess`` gives them.

        Parameters
        ----------
        model
            What was traced, wherever its control point; its ``site`` and ``assessment`` say what
            is asked.
        site
            In place of the model's own.
        options
            Keys of [assessment] by name and in the units of files, over those of the model; or
            ``settings`` and ``spectra``, see `drystone.assessment.verdict.assessed`.

        Raises
        ------
        AssessmentError
            Something is missing, or the method does not apply; `UnfinishedError` where the curve
            does not go far enough.
        """
        from drystone.assessment.verdict import assessed

        return assessed(self, self.traced_of(model), site=site, **options)

    @property
    def control_displacement(self) -> Array:
        """(n_points,) [m]."""
        return self.column("control_displacement")

    @property
    def load_multiplier(self) -> Array:
        """(n_points,) static multiplier: the curve."""
        return self.column("load_multiplier")

    @property
    def applied_multiplier(self) -> Array:
        """(n_points,) multiplier that was applied in the step."""
        return self.column("applied_multiplier")

    @property
    def carried_multiplier(self) -> Array:
        """(n_points,) support reaction over the sum of the load pattern."""
        return self.column("carried_multiplier")

    @property
    def residual(self) -> Array:
        """(n_points,) certificate of equilibrium, see `CurvePoint`."""
        return self.column("residual")

    @property
    def moves_supports(self) -> bool:
        """Whether supports move, in place of a load.

        Control displacements are then their motion [m, rad], and multipliers are their reaction
        over the blocks' weight (times an arm, where they rotate).
        """
        return self.strategy == SETTLEMENT

    @property
    def is_cyclic(self) -> bool:
        """Whether its control point goes to and fro."""
        return self.strategy == CYCLIC

    @property
    def cycles(self) -> tuple[Cycle, ...]:
        """Of a cyclic curve; energies are areas of the load, as one force, against the control
        displacement: the work of the load where all of it moves as the control point does."""
        if not self.is_cyclic:
            return ()
        multiplier = self.load_multiplier
        load = self.load_force * multiplier
        if self.load_turns:
            load = load / np.sqrt(1.0 + multiplier**2)  # see `TiltPattern`
        # On the way to a target the structure may fall, which throws the control point back: what
        # is shorter than half of the shortest way to a target is no way to another one.
        ways = np.abs(np.diff((0.0, *self.targets)))
        least_way = 0.5 * float(ways.min()) if len(ways) else 0.0
        return cycles_of(self.control_displacement, load, least_way=least_way)

    def envelope(self, sense: float = 1.0) -> tuple[Array, Array]:
        """Control displacements [m] and multipliers of points farther out in a sense, 1 or -1, than
        any before."""
        return envelope(self.control_displacement, self.load_multiplier, sense)

    @property
    def lowest(self) -> CurvePoint:
        """The static point of lowest load multiplier: the peak of the other sense of a cyclic
        curve."""
        return min(self.at_rest, key=lambda p: p.load_multiplier)

    @property
    def _ultimate_of_cycles(self) -> float | None:
        """Where a cyclic curve ends in a collapse: farther out than ever before, with less than the
        stop value."""
        last = self.points[-1]
        out = max(abs(p.control_displacement) for p in self.points[:-1] or self.points)
        over = abs(last.load_multiplier) <= self.stop_multiplier
        farthest = abs(last.control_displacement) >= out
        return last.control_displacement if over and farthest else None

    @property
    def at_rest(self) -> list[CurvePoint]:
        """The points that are not passed in motion; all where there are none."""
        return [p for p in self.points if p.status == STATIC] or list(self.points)

    @property
    def marked_reactions(self) -> dict[str, CurvePoint]:
        """The points at rest of first, least, greatest and last reaction, by these words."""
        rest = self.at_rest
        return {
            "first": rest[0],
            "least": min(rest, key=lambda point: point.reaction),
            "greatest": max(rest, key=lambda point: point.reaction),
            "last": rest[-1],
        }

    @property
    def reaction(self) -> Array:
        """(n_points,) of supports that move, along their motion [N], or about its axis [N m]."""
        return self.column("reaction")

    @property
    def n_steps(self) -> int:
        """Points after the first, which is the structure at rest under its own weight."""
        return max(len(self.points) - 1, 0)

    @property
    def peak(self) -> CurvePoint:
        """The static point of highest load multiplier."""
        return max(self.at_rest, key=lambda p: p.load_multiplier)

    @property
    def peak_passed(self) -> bool:
        """Whether the curve comes down from its `peak`, or the structure collapses from there: else
        that is the highest point so far."""
        if self.ends_in_motion:
            return True
        top = self.peak
        after = (p for p in self.points if p.step > top.step and p.status == STATIC)
        return any(p.load_multiplier < PASSED * top.load_multiplier for p in after)

    @property
    def ends_in_motion(self) -> bool:
        """Whether the structure collapses from the last point at rest."""
        ended = self.status == FINISHED and self.ended_by is None
        return ended and self.points[-1].status == DYNAMIC

    @property
    def ultimate_displacement(self) -> float | None:
        """Control displacement [m] where the multiplier falls below the stop value, or None.

        Static points count, and the collapse that ends the curve.  Points of a jump that the
        structure survives do not: inertia carries there what the joints cannot.  If a jump moves
        the control point back, and the multiplier below the stop value, the displacement is that
        where the jump begins.  If it moves the control point forward, the structure may have
        carried within the jump.  Of a collapse in a jump the displacement is where the jump begins.
        A drop where a bond breaks, while the control point stays, or where the control point has
        moved back behind the peak, as a part comes loose elsewhere, does not count if the structure
        carries more than the stop value once more.
        """
        if self.moves_supports:
            return None
        if self.is_cyclic:
            return self._ultimate_of_cycles
        top, peak_at = self.peak.step, self.peak.control_displacement
        rest = max((p.step for p in self.points if p.status == STATIC), default=0)
        collapse = self.status == FINISHED
        after = [
            p
            for p in self.points
            if p.step >= top
            and (p.status == STATIC or (p.step > rest and collapse and not p.jumped))
        ]
        rested = (p for p in after if p.status == STATIC)
        carries = max(
            (p.step for p in rested if p.load_multiplier > self.stop_multiplier), default=0
        )
        for before, point in pairwise(after):
            if point.load_multiplier <= self.stop_multiplier < before.load_multiplier:
                behind = point.control_displacement < peak_at
                if (behind or _stays(before, point)) and carries > point.step:
                    continue
                if point.jumped and point.control_displacement < before.control_displacement:
                    return before.control_displacement
                drop = before.load_multiplier - point.load_multiplier
                share = (before.load_multiplier - self.stop_multiplier) / drop
                return before.control_displacement + share * (
                    point.control_displacement - before.control_displacement
                )
        if collapse and self.points[-1].status == DYNAMIC and after:
            return self.points[rest].control_displacement
        return None

    @property
    def first_collapse(self) -> Event | None:
        """The first event in which a part of the structure collapses; None where none does."""
        return first_collapse(self.events)

    @property
    def capacity(self) -> CurvePoint:
        """The static point of highest load multiplier before a part of the structure collapses.

        It is the `peak` where no part does, or where the peak comes before.
        """
        first = self.first_collapse
        return self.peak if first is None else self.until(first).peak

    @property
    def rises_after_collapse(self) -> bool:
        """Whether what is left after a part has collapsed bears more than the whole did before."""
        return self.peak.load_multiplier > self.capacity.load_multiplier

    @property
    def unstable_branch(self) -> tuple[float, float] | None:
        """Control displacements [m] between which the curve is longest an unstable branch; None
        where nowhere as many as `SERIES` points in a row are unstable.  A single one says little.
        """
        series, longest = 0, 0
        end = -1
        for k, point in enumerate(self.points):
            series = series + 1 if point.unstable else 0
            if series > longest:
                longest, end = series, k
        if longest < SERIES:
            return None
        x = [self.points[k].control_displacement for k in (end - longest + 1, end)]
        return min(x), max(x)

    @property
    def name_of_peak(self) -> str:
        """What the point of highest multiplier is: no peak before the curve comes down from it, and
        none of the structure where a part of that has collapsed before."""
        if self.rises_after_collapse:
            return say("mark.left")
        return say("mark.peak" if self.peak_passed else "mark.highest")

    def until(self, event: Event) -> CapacityCurve:
        """The curve up to the last point at rest before an event, as one that ends there.

        What shows how the structure moves from there on is kept: the first point in motion, or the
        equilibria by which an engine follows a part that falls, until it would stand no more.
        """
        n = self._fallen(event)
        n += n < len(self.points) and self.points[n].status == DYNAMIC
        return replace(
            self.first(n),
            blocks_left=tuple(b for b in self.blocks_left if b.step <= event.step),
            events=tuple(e for e in self.events if e.step < event.step),
            status=FINISHED,
            reason=str(event),
            ended_by=event,
        )

    def _fallen(self, event: Event) -> int:
        """How many points there are up to an event; where it is of a part that is followed through
        equilibria, up to the first that needs a load against the load."""
        for n, point in enumerate(self.points[event.step + 1 :], event.step + 1):
            behind = point.control_displacement < event.control_displacement
            if not behind or point.status != STATIC or point.jumped:
                break
            if falls(point, event.control_displacement):
                return n + 1
        return event.step + 1

    def first(self, n: int) -> CapacityCurve:
        """The curve of its first ``n`` points, with what happened up to the last of them."""
        return replace(
            self,
            points=self.points[:n],
            poses=None if self.poses is None else self.poses[:n],
            contacts=None if self.contacts is None else self.contacts[:n],
            ties=None if self.ties is None else self.ties.until(n),
            blocks_left=tuple(b for b in self.blocks_left if b.step < n),
            events=tuple(e for e in self.events if e.step < n),
        )

    def outward(self, sense: float = 1.0) -> CapacityCurve:
        """Of a cyclic curve its envelope in the sense of the load, or in the other (-1), as a curve
        of one sense: points farther out than any before, with what had happened up to each.

        In the other sense displacements and multipliers are counted along that.  It is complete
        where the cyclic one ends in a collapse in the sense.  What happened on the way in the other
        sense, or nearer than the points before, counts from the farthest of these on; what happened
        after the last of the points kept does not count.
        """
        x = sense * self.control_displacement + 0.0  # -0 becomes 0
        farthest = np.maximum.accumulate(np.concatenate(([0.0], x[:-1])))
        rows = np.concatenate(([0], 1 + np.flatnonzero(x[1:] > farthest[1:])))

        def at(step: int) -> int:
            """The last point kept that is not behind a step."""
            return int(np.searchsorted(rows, step, side="right")) - 1

        def along(record: Counted, step: int) -> Counted:
            """A record at a step of the envelope, counted along the sense."""
            counted = {
                name: 0.0 - getattr(record, name)
                for name in COUNTED_ALONG
                if sense < 0.0 and hasattr(record, name)
            }
            return replace(record, step=step, **counted)

        def happened(event: Event) -> Event:
            """An event where the envelope had come when it happened, at least."""
            found = along(event, i := at(event.step))
            place = max(found.control_displacement, float(x[rows[i]]))
            return replace(found, control_displacement=place)

        last = self.ended_by
        if last is not None and sense * last.control_displacement < 0.0:
            last = None
        end = sense * (self._ultimate_of_cycles or 0.0)
        complete = self.status == FINISHED
        collapsed = complete and (end > 0.0 or last is not None)
        # The history may well be done with: what is missing is a collapse in this sense.
        short = say("end.not_in_this_sense", most=float(x[rows[-1]]))
        return replace(
            self,
            strategy=DISPLACEMENT,
            points=tuple(along(self.points[k], i) for i, k in enumerate(rows)),
            poses=None if self.poses is None else self.poses[rows],
            contacts=None if self.contacts is None else tuple(self.contacts[k] for k in rows),
            ties=None if self.ties is None else self.ties.at_rows(rows),
            blocks_left=tuple(along(b, at(b.step)) for b in self.blocks_left if b.step <= rows[-1]),
            events=tuple(happened(e) for e in self.events if e.step <= rows[-1]),
            ended_by=last and happened(last),
            status=FINISHED if collapsed else STOPPED,
            reason=f"{short}; {self.reason}" if complete and not collapsed else self.reason,
        )

    def departed(self, ids: Sequence[str], step: int) -> BoolArray:
        """Which of the blocks named have left after a step, (n,)."""
        left = {block.block for block in self.blocks_left if block.step <= step}
        return np.array([name in left for name in ids], dtype=np.bool_)

    def nearest(self, control_displacement: float) -> int:
        """Index of the point nearest to a control displacement [m]."""
        return int(np.argmin(np.abs(self.control_displacement - control_displacement)))

    @property
    def _facts(self) -> dict[str, str]:
        """What a person wants to know first, in words."""
        facts = {"engine": self.engine, "points": str(len(self.points))}
        if self.points and self.moves_supports:
            start, end, unit = self.points[0], self.points[-1], self.motion_unit
            force = "N m" if unit == "rad" else "N"
            facts["reaction"] = f"{start.reaction:.4g} to {end.reaction:.4g} {force}"
            facts["end"] = f"{end.control_displacement:.4g} {unit}"
        elif self.points:
            peak, ultimate = self.peak, self.ultimate_displacement
            last = self.points[-1].control_displacement
            if self.rises_after_collapse:
                whole = self.capacity
                facts["capacity"] = (
                    f"{whole.load_multiplier:.4f} at {whole.control_displacement:.4g} m"
                )
            facts[self.name_of_peak] = (
                f"{peak.load_multiplier:.4f} at {peak.control_displacement:.4g} m"
            )
            facts["end"] = f"{last if ultimate is None else ultimate:.4g} m"
        return {**facts, "status": self.status, "reason": self.reason}

    def __repr__(self) -> str:
        facts = self._facts
        del facts["reason"]
        engine = facts.pop("engine")
        return f"<CapacityCurve {engine}: {', '.join(f'{k} {v}' for k, v in facts.items())}>"

    def _repr_html_(self) -> str:
        """A small table and the curve, for notebooks."""
        from drystone.report.notebook import curve_picture, table

        return table(self._facts) + (curve_picture(self) if self.points else "")
