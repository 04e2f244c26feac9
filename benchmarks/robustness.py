"""Random structures of every kind by `equilibrium`: what ends, what does not, and what it costs.

    python benchmarks/robustness.py --kinds solids,corner --seeds 0:40
    python benchmarks/robustness.py --seeds 0:40:2 --set max_motion=0.1 --against stored.json
    python benchmarks/robustness.py --engine distinct --kinds plane --set tolerances.NOISE=10

For each structure one line, for each kind a sum: curves that end, whose control point leaves with
its block, that stop, or that say they are finished where they are not ("false ends"); points that
are not balanced, or no better than rounding lets them be (`true_ends.balance_of`); points called
unstable, steps tried and failed, iterations of all of them, seconds of the processor (the first one
compiles), and the longest step.  The kinds are those of `tests/random_kinds.py`.
``--set NAME=VALUE`` changes a setting of the engine, ``record.NAME=VALUE`` one of a record within,
``tolerances.NAME=VALUE`` a number of the register with all that follows from it,
so that an ablation is one run more; ``--against`` compares with a stored run, curve by curve.
Choose on even seeds, report odd ones.
"""

from __future__ import annotations

import registered  # first: it changes numbers before anything takes them

# isort: split
import harness  # it holds the libraries' threads to one

# isort: split
import argparse
import json
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

import drystone as ds
from drystone.dynamics.distinct.engine import DistinctEngine, DistinctSettings
from drystone.dynamics.nscd import NscdEngine, NscdSettings
from drystone.engines.base import UnstableError
from drystone.limit import on_what_moves
from drystone.results.curve import FINISHED
from drystone.statics.equilibrium import EquilibriumEngine, EquilibriumSettings
from random_kinds import KINDS
from true_ends import LEFT, at_rest, balance_of, unbalanced, why_no_end

#: How curves end, as the summary has them; errors and what takes too long are "else".
ENDS = ("ended", "left", "stopped", "false end", "does not stand")


class _Counts:
    """Counts steps tried and failed, and iterations of all, of the engine that comes after it."""

    tried = failed = iterations = 0
    longest = 0.0  # s, of one step

    def step(self, state: Any, demand: Any) -> Any:
        """See `Engine.step`."""
        begun = time.process_time()
        self.tried += 1
        try:
            new, report = super().step(state, demand)  # type: ignore[misc]
        finally:
            self.longest = max(self.longest, time.process_time() - begun)
        self.failed += not report.converged
        self.iterations += report.n_iterations
        return new, report


class _Equilibrium(_Counts, EquilibriumEngine):
    pass


class _Distinct(_Counts, DistinctEngine):
    pass


class _Nscd(_Counts, NscdEngine):
    pass


#: Engines, each with its settings and with the residual that a point at rest may leave whatever the
#: joints.
ENGINES: dict[str, tuple[Any, Any, float]] = {
    "equilibrium": (_Equilibrium, EquilibriumSettings, 0.0),
    "distinct": (_Distinct, DistinctSettings, DistinctEngine.capabilities.residual_limit),
    "nscd": (_Nscd, NscdSettings, NscdEngine.capabilities.residual_limit),
}


@dataclass(frozen=True, kw_only=True)
class Run:
    """One curve."""

    kind: str
    seed: int
    n_blocks: int
    #: "ended", "left" (the control point with its block), "stopped", "false end", "does not stand",
    #: "too long", or the name of an error.
    end: str
    reason: str = ""
    peak: float = 0.0
    peak_at: float = 0.0  # m
    last_at: float = 0.0  # m
    n_points: int = 0
    n_dynamic: int = 0
    n_unstable: int = 0
    unbalanced: int = 0  # points at rest, beyond what rounding leaves
    rounded: int = 0  # points at rest that leave more than 1e-8, as rounding lets them
    tried: int = 0
    failed: int = 0
    iterations: int = 0
    seconds: float = 0.0
    longest: float = 0.0  # s, of one step
    last_at_rest: float = 0.0  # multiplier of the last point at rest

    def __str__(self) -> str:
        why = f", at rest under {self.last_at_rest:.4g}: {self.reason}"
        return (
            f"{self.kind} {self.seed}: {self.end}, {self.n_blocks} blocks, peak {self.peak:.6g} at "
            f"{self.peak_at:.4g} m, last {self.last_at:.4g} m, {self.n_points} points "
            f"({self.n_dynamic} in motion, {self.n_unstable} unstable, {self.unbalanced} "
            f"unbalanced, {self.rounded} rounded), {self.tried} steps, {self.failed} failed, "
            f"{self.iterations} iterations, {self.seconds:.2f} s, longest {self.longest:.2f} s"
            f"{'' if self.end == 'ended' else why}"
        )


class TooLongError(KeyboardInterrupt):
    """A curve took more than it was given; `drystone.pushover` ends it there, interrupted."""


@contextmanager
def at_most(seconds: int) -> Iterator[None]:
    """Raise `TooLongError` in what takes longer [s of the processor], between two kernels."""

    def ring(*_: object) -> None:
        raise TooLongError

    signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def run(kind: str, seed: int, by: str, settings: Any, limit: int) -> Run:
    """Trace the curve of one structure by an engine."""
    model = on_what_moves(KINDS[kind](seed))  # as `drystone run` does
    make, _, leaves = ENGINES[by]
    what = {"kind": kind, "seed": seed, "n_blocks": model.assembly.n_blocks}
    engine, begun = make(settings), time.process_time()

    def told(end: str, **more: Any) -> Run:
        seconds = round(time.process_time() - begun, 3)
        counts = {"tried": engine.tried, "failed": engine.failed, "iterations": engine.iterations}
        longest = round(engine.longest, 3)
        return Run(**what, end=end, seconds=seconds, longest=longest, **counts, **more)

    try:
        with at_most(limit):
            curve = ds.pushover(model, engine=engine, progress=False)
    except UnstableError as error:
        return told("does not stand", reason=str(error)[:200])
    except TooLongError:
        return told("too long")
    except Exception as error:  # any other is a fault to be listed, not to end the run
        return told(type(error).__name__, reason=str(error)[:200])
    still, why = at_rest(curve), why_no_end(curve)
    return told(
        _end_of(curve, why),
        reason=(why or curve.reason)[:200],
        peak=curve.peak.load_multiplier,
        peak_at=curve.peak.control_displacement,
        last_at=curve.points[-1].control_displacement,
        n_points=len(curve.points),
        n_dynamic=len(curve.points) - len(still),
        n_unstable=sum(point.unstable for point in still),
        unbalanced=(beyond := len(unbalanced(curve, max(leaves, balance_of(model))))),
        rounded=len(unbalanced(curve)) - beyond,
        last_at_rest=still[-1].load_multiplier if still else 0.0,
    )


def _end_of(curve: ds.CapacityCurve, why: str) -> str:
    if curve.status == "interrupted":
        return "too long"
    if why:
        return "false end" if curve.status == FINISHED else "stopped"
    return "left" if LEFT in curve.reason else "ended"


def with_settings(changes: Sequence[str], by: str = "equilibrium") -> Any:
    """The engine's settings with some of them changed, each as "name.of.it=value"."""
    settings = ENGINES[by][1]()
    for change in changes:
        if change.startswith(registered.PREFIX):
            continue
        name, value = change.split("=")
        settings = _changed(settings, name.split("."), value)
    return settings


def _changed(record: Any, path: Sequence[str], value: str) -> Any:
    names = [field.name for field in fields(record)]
    if path[0] not in names:
        raise SystemExit(f"there is no setting {path[0]}; there are: {', '.join(names)}")
    old = getattr(record, path[0])
    if is_dataclass(old):
        return replace(record, **{path[0]: _changed(old, path[1:], value)})
    return replace(record, **{path[0]: type(old)(float(value)) if old is not None else value})


def summary(runs: Sequence[Run]) -> str:
    """Sums by kind, as a table."""
    rows = []
    kinds = [*dict.fromkeys(run.kind for run in runs)]
    for name, part in [(k, [r for r in runs if r.kind == k]) for k in kinds] + [("all", runs)]:
        rows.append({
            "kind": name,
            "curves": len(part),
            **{end: sum(r.end == end for r in part) for end in ENDS},
            "else": sum(r.end not in ENDS for r in part),
            "points": sum(r.n_points for r in part),
            "in motion": sum(r.n_dynamic for r in part),
            "unstable": sum(r.n_unstable for r in part),
            "unbalanced": sum(r.unbalanced for r in part),
            "rounded": sum(r.rounded for r in part),
            "tried": sum(r.tried for r in part),
            "failed": sum(r.failed for r in part),
            "iterations": sum(r.iterations for r in part),
            "seconds": f"{sum(r.seconds for r in part):.1f}",
            "longest step": f"{max((r.longest for r in part), default=0.0):.2f}",
        })  # fmt: skip
    return harness.table(rows)


def compared(runs: Sequence[Run], stored: Sequence[Run]) -> str:
    """Curves that differ from a stored run: in their ends, peaks by 1e-4, last points by 1e-2."""
    before = {(r.kind, r.seed): r for r in stored}
    lines = []
    for now in runs:
        then = before.get((now.kind, now.seed))
        if then is None:
            continue
        said = []
        if now.end != then.end:
            said.append(f"{then.end} -> {now.end}: {now.reason}")
        if abs(now.peak - then.peak) > 1e-4 * max(abs(then.peak), 1e-3):
            said.append(f"peak {then.peak:.6g} -> {now.peak:.6g}")
        if abs(now.last_at - then.last_at) > 1e-2 * max(abs(then.last_at), 1e-3):
            said.append(f"last {then.last_at:.4g} -> {now.last_at:.4g} m")
        if said:
            lines.append(f"{now.kind} {now.seed}: {'; '.join(said)}")
    return "\n".join(lines) or "no curve differs"


def seeds_in(text: str) -> range:
    """Of "first:end" or "first:end:step"."""
    return range(*(int(part) for part in text.split(":")))


def main() -> None:
    """See the module's text."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--kinds", default="all", help=f"all, or of {', '.join(KINDS)}")
    parser.add_argument("--seeds", default="0:20:2", help="first:end or first:end:step")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument("--engine", default="equilibrium", help=f"of {', '.join(ENGINES)}")
    parser.add_argument("--limit", type=int, default=120, help="process time of a curve [s]")
    parser.add_argument("--out", type=Path, help="where the run is stored, as JSON")
    parser.add_argument("--against", type=Path, help="a stored run to compare with")
    given = parser.parse_args()
    settings, runs = with_settings(given.changes, given.engine), []
    for kind in KINDS if given.kinds == "all" else given.kinds.split(","):
        for seed in seeds_in(given.seeds):
            runs.append(one := run(kind, seed, given.engine, settings, given.limit))
            print(one, flush=True)
    print(summary(runs))
    if given.out:
        given.out.write_text(json.dumps([asdict(one) for one in runs], indent=1))
    if given.against:
        stored = [Run(**entry) for entry in json.loads(given.against.read_text())]
        print(compared(runs, stored))


if __name__ == "__main__":
    main()
