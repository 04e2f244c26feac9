"""Random structures by `equilibrium` and by other engines, and beside limit analysis.

    python benchmarks/agreement.py --kinds plane,solids --seeds 1:20:2
    python benchmarks/agreement.py --engines distinct --blocks 12 --seeds 1:12:2

Curves are compared as far as no part of the structure has collapsed.  What a heap carries depends
on how its stones came to lie, and engines damp this motion differently.  Curves are compared up to
1.2 times the displacement of the peak, and at three points after: a tenth, a quarter and half of
the way from there to the last point at rest.  What is told is how far a static point of one lies
from the other curve, multipliers over the peak and displacements over that of the last point at
rest, up to the peak the median and the largest of all points; and by how much the peaks differ,
over the peak.  Where one of them but the largest, which a jump makes that comes a step sooner or
later, is above 1 %, the structure is listed with all figures, and so is every capacity above the
associative multiplier, with its cause (`drystone.limit.excess`).

A difference is explained where both rest.  Of the static points of the other curve that lie apart,
above the stop value, three are taken, at a quarter, half and three quarters of how far they reach.
Their states are handed over to `equilibrium`, which looks for an equilibrium next to each.  What
counts is one that no block moves to by more than a hundredth of the smallest block, with the
multiplier of the other engine within 1 % of the peak: then there are two equilibria at this
displacement, and each engine has found one of them.  Where none is found, the residual of the
other's certificate is told.

Engines are given the same problem.  The joints of `nscd` do not shear before they slide.  So beside
it `equilibrium` has joints that hardly do, `RIGID` times as stiff along as across.

The kinds are those of `tests/random_kinds.py`; structures of more than ``--blocks`` are left out.
"""

from __future__ import annotations

import robustness  # first: it holds the libraries' threads to one

# isort: split
import argparse
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

import harness
import numpy as np

import drystone as ds
from drystone.limit import limits_beside
from drystone.results.curve import STATIC
from handover import KEPT, KeptStates, rest_near
from random_kinds import KINDS
from static_branches import apart, static_branch

T = TypeVar("T")

#: What is compared of the rise, over the displacement of the peak, and of the way from the peak to
#: the last point at rest.
RISE, AFTER = 1.2, (0.1, 0.25, 0.5)
#: Differences, over the peak, up to which engines agree.
AGREED = 0.01
#: Places that are looked at where curves differ, of how far the points reach that lie apart.
BETWEEN = (0.25, 0.5, 0.75)
#: Motion of a block to an equilibrium, over the smallest block, up to which it is the same state.
SAME_STATE = 0.01
#: Largest increment of the control displacement with which it is looked for, over that block.
NEXT = 5e-5
#: Engines whose joints do not shear, and the shear stiffness over the normal one of joints that
#: hardly do.  With 100 the peak of an arch of 1.2e8 Pa/m lies 4e-4 below that of `nscd`; with 10,
#: 4.5e-3.
WITHOUT_SHEAR, RIGID = ("nscd",), 100.0


@dataclass(frozen=True, kw_only=True)
class TwoAtRest:
    """Two engines at one displacement, and what `equilibrium` finds next to the state of the
    other."""

    displacement: float  # m
    ours: float  # multiplier by `equilibrium`
    theirs: float
    residual: float  # of the other's point by its certificate, over the heaviest weight
    found: float = np.nan  # by `equilibrium`, next to the state of the other
    motion: float = np.nan  # over the smallest block, of the block that moves farthest to there
    shown: bool = False  # whether that is an equilibrium in the same state

    def __str__(self) -> str:
        at = f"at {self.displacement:.4g} m {self.ours:.4f} and {self.theirs:.4f}"
        if np.isnan(self.found):
            return f"{at} (in balance to {self.residual:.0e}), where equilibrium finds no rest"
        return f"{at}, where equilibrium finds {self.found:.4f} in {self.motion:.1e} of a block"


@dataclass(frozen=True, kw_only=True)
class Compared:
    """One structure by one engine; differences are as the module's text says."""

    kind: str
    seed: int
    n_blocks: int
    engine: str
    note: str = ""  # why there is nothing to compare
    peak: float = 0.0  # by `equilibrium`
    other_peak: float = 0.0
    rise: float = 0.0  # the median
    largest: float = 0.0
    after: tuple[float, ...] = ()
    other_reason: str = ""
    both: tuple[TwoAtRest, ...] = ()  # where they differ
    seconds: float = 0.0  # of the other engine

    @property
    def peaks(self) -> float:
        """By how much the peaks differ."""
        return abs(self.other_peak - self.peak) / self.peak if self.peak else 0.0

    @property
    def agrees(self) -> bool:
        """Whether nothing differs by more than `AGREED`."""
        return max(self.peaks, self.rise, *self.after, 0.0) <= AGREED

    @property
    def explained(self) -> bool:
        """Whether there are two equilibria wherever they differ."""
        return bool(self.both) and all(one.shown for one in self.both)

    def __str__(self) -> str:
        if self.note:
            return f"{self.kind} {self.seed} {self.engine}: {self.note}"
        after = ", ".join(f"{100.0 * one:.2f}" for one in self.after)
        return (
            f"{self.kind} {self.seed} {self.engine}: {self.n_blocks} blocks, peak {self.peak:.5g} "
            f"and {self.other_peak:.5g} ({100.0 * self.peaks:.2f} %), up to "
            f"{RISE} of it {100.0 * self.rise:.2f} % (largest {100.0 * self.largest:.2f} %), "
            f"after {after} %, {self.seconds:.1f} s"
            + ("" if self.agrees else f": {self._difference()}")
        )

    def _difference(self) -> str:
        both = "; ".join(str(one) for one in self.both)
        if self.explained:
            return f"two equilibria: {both}"
        return f"DIFFERS; {both}; {self.other_reason[:150]}"


def compared(
    kind: str, seed: int, model: ds.Model, ours: ds.CapacityCurve, engine: str, limit: int
) -> Compared:
    """The same structure by another engine."""
    what = {"kind": kind, "seed": seed, "n_blocks": model.assembly.n_blocks, "engine": engine}
    ours = as_a_whole(ours)
    line = static_branch(ours)
    top, end = ours.peak.control_displacement, float(line[:, 0].max())
    far = top + np.array(AFTER) * (end - top)
    begun = time.process_time()
    try:
        with robustness.at_most(limit):
            # One step more than is read.
            most = 1.05 * max(RISE * top, float(far[-1])) + 1e-6
            by = KEPT[engine]() if engine in KEPT else engine
            same = replace(model, control_point=ours.control_point)
            other = ds.pushover(same, engine=by, progress=False, max_displacement=most)
        if other.status == "interrupted":
            return Compared(**what, note=f"more than {limit} s")
    except robustness.TooLongError:
        return Compared(**what, note=f"more than {limit} s at its start")
    except Exception as error:  # listed, not to end the run
        return Compared(**what, note=f"{type(error).__name__}: {str(error)[:150]}")
    seconds = round(time.process_time() - begun, 2)
    other = as_a_whole(other)
    scale = np.array([end, ours.peak.load_multiplier])
    theirs, mine = static_branch(other) / scale, line / scale
    rise = [
        apart(one[one[:, 0] <= RISE * top / end], two)
        for one, two in ((theirs, mine), (mine, theirs))
    ]
    result = Compared(
        **what,
        peak=ours.peak.load_multiplier,
        other_peak=other.peak.load_multiplier,
        rise=float(max(np.median(one) for one in rise)),
        largest=float(max(one.max() for one in rise)),
        after=tuple(float(apart(_near(mine, x / end), theirs)[0]) for x in far),
        other_reason=other.reason,
        seconds=seconds,
    )
    if result.agrees or engine not in KEPT:
        return result
    at_rest = other.column("status") == STATIC
    points = np.column_stack((static_branch(other), other.column("residual")[at_rest]))
    away = points[(apart(theirs, mine) > AGREED) & (points[:, 1] > ours.stop_multiplier)]
    if len(away):
        low, high = away[:, 0].min(), away[:, 0].max()
        chosen = [_near(away, low + share * (high - low))[0] for share in BETWEEN]
    else:  # only ours has points apart
        chosen = [
            _near(points, x)[0] for x, one in zip(far, result.after, strict=True) if one > AGREED
        ]
    both = [two_at_rest(ours, by, *point) for point in dict.fromkeys(map(tuple, chosen))]
    return replace(result, both=tuple(both))


def two_at_rest(
    ours: ds.CapacityCurve, kept: KeptStates, place: float, theirs: float, residual: float
) -> TwoAtRest:
    """Both engines at a static point of the other: a displacement [m], a multiplier, a residual.

    `equilibrium` begins again from the state of the other there.
    """
    problem = kept.kept[0].prepared.problem
    size = problem.assembly.smallest_extent
    state = kept.nearest(place)
    two = TwoAtRest(
        displacement=place, ours=_multiplier_at(ours, place), theirs=theirs, residual=residual
    )
    most = AGREED * ours.peak.load_multiplier
    found = rest_near(kept, state, theirs, NEXT * size, most)
    if found is None:
        return two
    motion = found.motion / (problem.length * size)
    near = abs(found.multiplier - theirs) <= most
    return replace(
        two, found=found.multiplier, motion=motion, shown=bool(motion <= SAME_STATE and near)
    )


def _multiplier_at(curve: ds.CapacityCurve, place: float) -> float:
    """Of the static point that is nearest to a displacement [m]."""
    return float(_near(static_branch(curve), place)[0, 1])


def _near(branch: np.ndarray, place: float) -> np.ndarray:
    """The point (1, 2) of a branch (n, 2) that is nearest to a displacement."""
    return branch[[int(np.argmin(np.abs(branch[:, 0] - place)))]]


def rigid_along(model: ds.Model) -> ds.Model:
    """The same with joints that hardly shear."""
    return model.with_joint(shear_stiffness=RIGID * model.assembly.joint.normal_stiffness)


def traced(model: ds.Model) -> ds.CapacityCurve:
    """By `equilibrium`, with all that another engine's curve is compared by."""
    return ds.pushover(model, progress=False, keep_poses=True, keep_contacts=True)


def as_a_whole(curve: ds.CapacityCurve) -> ds.CapacityCurve:
    """The curve up to where a part of the structure collapses."""
    return curve if curve.first_collapse is None else curve.until(curve.first_collapse)


def above_bound(model: ds.Model, curve: ds.CapacityCurve) -> str:
    """What is told where the capacity lies above the associative multiplier; else nothing."""
    return limits_beside(model).warning(curve, model) or ""


def within(limit: int, name: str, work: Callable[[], T]) -> T | None:
    """What work gives within ``limit`` seconds.

    None where it gives nothing, with a line that says why; `robustness` lists these.
    """
    try:
        with robustness.at_most(limit):
            return work()
    except (Exception, robustness.TooLongError) as error:
        print(f"{name}: {type(error).__name__}", flush=True)
        return None


def summary(runs: Sequence[Compared]) -> str:
    """Shares that agree, by engine and kind."""
    rows = []
    for engine in dict.fromkeys(run.engine for run in runs):
        own = [run for run in runs if run.engine == engine]
        parts = {kind: [r for r in own if r.kind == kind] for kind in {r.kind: 0 for r in own}}
        for kind, part in [*parts.items(), ("all", own)]:
            both = [run for run in part if not run.note]
            agree = sum(run.agrees for run in both)
            explained = sum(run.explained for run in both if not run.agrees)
            rows.append({
                "engine": engine,
                "kind": kind,
                "structures": len(part),
                "compared": len(both),
                "within 1 %": agree,
                "share": f"{100.0 * agree / max(len(both), 1):.0f} %",
                "two equilibria": explained,
                "unexplained": len(both) - agree - explained,
                "seconds": f"{sum(run.seconds for run in both):.0f}",
            })  # fmt: skip
    return harness.table(rows) if rows else "nothing was compared"


def main() -> None:
    """See the module's text."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--kinds", default="all", help=f"all, or of {', '.join(KINDS)}")
    parser.add_argument("--seeds", default="0:8:2", help="first:end or first:end:step")
    parser.add_argument("--engines", default="distinct,nscd", help="others than equilibrium")
    parser.add_argument("--blocks", type=int, default=20, help="most of a structure")
    parser.add_argument("--limit", type=int, default=60, help="process time of a curve [s]")
    parser.add_argument("--out", type=Path, help="where the run is stored, as JSON")
    given = parser.parse_args()
    runs: list[Compared] = []
    above: list[str] = []
    engines = [*filter(None, given.engines.split(","))]
    for kind in KINDS if given.kinds == "all" else given.kinds.split(","):
        for seed in robustness.seeds_in(given.seeds):
            model = KINDS[kind](seed).with_analysis(engine="equilibrium")
            if model.assembly.n_blocks > given.blocks:
                continue
            name = f"{kind} {seed}"
            ours = within(given.limit, name, partial(traced, model))
            if ours is None:
                continue
            told = within(given.limit, f"{name}, bound", partial(above_bound, model, ours))
            if told:
                above.append(f"{name}: {told}")
                print(above[-1], flush=True)
            for engine in engines:
                same, beside = model, ours
                if engine in WITHOUT_SHEAR:
                    same = rigid_along(model)
                    beside = within(given.limit, f"{name}, rigid along", partial(traced, same))
                if beside is not None:
                    runs.append(compared(kind, seed, same, beside, engine, given.limit))
                    print(runs[-1], flush=True)
    print(summary(runs))
    print("\nDiffer, or could not be compared:")
    print("\n".join(str(run) for run in runs if run.note or not run.agrees) or "none")
    print("\nCapacities above the associative multiplier:")
    print("\n".join(above) or "none")
    if given.out:
        stored = {"compared": [asdict(one) for one in runs], "above": above}
        given.out.write_text(json.dumps(stored, indent=1))


if __name__ == "__main__":
    main()
