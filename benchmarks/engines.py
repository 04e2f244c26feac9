"""The published walls over all engines that are installed: one process order, one core each.

    python benchmarks/engines.py [--engine NAME ...] [--wall N ...] [--repeats N]
    python benchmarks/engines.py --model FILE [--max-displacement M] ...

Every engine traces a wall's curve before the next one begins; LMGC90, which takes its time, does so
once.  Writes ``results/engines.json`` and ``.md``; of a model file, such as one of solids, under
its name.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import harness  # first: it holds the libraries' threads to one
import numpy as np

import drystone as ds
from drystone.analysis.driver import pushover
from drystone.engines import engine_names, make_engine
from drystone.engines.base import EngineError
from drystone.model.model import Model
from drystone.results.curve import DYNAMIC, CapacityCurve

#: Engines that are timed in a single run: they need no warming up, and are slow.
ONCE = ("lmgc90", "distinct")


@dataclass(frozen=True, kw_only=True)
class EngineTiming:
    """One wall, or model, on one engine."""

    wall: str
    engine: str
    seconds: float  # median of warm runs, or of the one run
    n_points: int
    n_dynamic: int
    n_iterations: int
    median_residual: float  # of the heaviest block's weight, static points
    max_residual: float
    peak_multiplier: float
    ultimate_displacement: float | None  # m
    status: str


def timing(
    wall: str, model: Model, engine: str, repeats: int, limit: dict[str, float]
) -> EngineTiming:
    """Trace one model's curve, up to a ``max_displacement`` [m] if given; raises `EngineError`."""
    curves: list[CapacityCurve] = []
    if engine in ONCE:
        curves.append(pushover(model, engine=engine, progress=False, **limit))
        seconds = curves[0].wall_time
    else:
        seconds = harness.median_seconds(
            lambda: curves.append(pushover(model, engine=engine, progress=False, **limit)),
            repeats,
        )
    curve = curves[-1]
    static = np.array([p.residual for p in curve.points if p.status != DYNAMIC])
    return EngineTiming(
        wall=wall,
        engine=engine,
        seconds=seconds,
        n_points=len(curve.points),
        n_dynamic=len(curve.points) - len(static),
        n_iterations=sum(p.n_iterations for p in curve.points),
        median_residual=float(np.median(static)),
        max_residual=float(static.max()),
        peak_multiplier=curve.peak.load_multiplier,
        ultimate_displacement=curve.ultimate_displacement,
        status=curve.status,
    )


def versions() -> dict[str, str]:
    """Programs other than ours that engines stand on."""
    found = {}
    for package in ("compas-lmgc90", "pylmgc90"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def rows(timings: list[EngineTiming]) -> list[dict[str, str]]:
    """The table."""
    return [
        {
            "wall": t.wall,
            "engine": t.engine,
            "s": f"{t.seconds:.2f}",
            "points": str(t.n_points),
            "dynamic": str(t.n_dynamic),
            "residual, median": f"{t.median_residual:.1e}",
            "largest": f"{t.max_residual:.1e}",
            "peak": f"{t.peak_multiplier:.4f}",
            "end, m": "-" if t.ultimate_displacement is None else f"{t.ultimate_displacement:.3f}",
            "status": t.status,
        }
        for t in timings
    ]


def ratios(timings: list[EngineTiming]) -> list[str]:
    """How many times as long LMGC90 takes as our equilibrium engine, wall by wall."""
    by = {(t.wall, t.engine): t for t in timings}
    lines = []
    for wall in dict.fromkeys(t.wall for t in timings):
        ours, theirs = by.get((wall, "equilibrium")), by.get((wall, "lmgc90"))
        if ours and theirs:
            better = "at a smaller" if ours.max_residual <= theirs.max_residual else "at a LARGER"
            lines.append(
                f"{wall}: LMGC90 takes {theirs.seconds / ours.seconds:.0f} times as long as "
                f"the equilibrium engine, which is {better} residual "
                f"({ours.max_residual:.0e} against {theirs.max_residual:.0e})."
            )
    return lines


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engine", action="append", help="may be repeated; all by default")
    parser.add_argument("--wall", action="append", type=int, choices=(1, 2, 3))
    parser.add_argument("--model", type=Path, help="a model file instead of the walls")
    parser.add_argument("--max-displacement", type=float, help="m; whole curves by default")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    timings: list[EngineTiming] = []
    left_out: list[str] = []
    if options.model:
        models = {options.model.stem: ds.read_model(options.model)}
    else:
        models = {f"wall {k}": ds.published_wall(k) for k in options.wall or (1, 2, 3)}
    limit: dict[str, float] = {}
    if options.max_displacement is not None:
        limit["max_displacement"] = options.max_displacement
    for wall, model in models.items():
        for engine in options.engine or engine_names():
            try:
                make_engine(engine)
                timings.append(timing(wall, model, engine, options.repeats, limit))
            except EngineError as error:
                left_out.append(f"{engine}, {wall}: {error}")
                continue
            print(harness.table(rows(timings[-1:])).splitlines()[-1], flush=True)
    programs = ", ".join(f"{name} {number}" for name, number in versions().items())
    notes = (
        f"{programs or 'LMGC90 is not installed'}. Seconds of one curve: the median of warm runs, "
        f"a single run of\n{' and '.join(ONCE)}. Residuals are those of static points, over the "
        "heaviest block's weight.\nEnd: control displacement at the multiplier 0.01."
    )
    text = "\n".join(
        [
            harness.table(rows(timings)),
            "",
            *ratios(timings),
            *(f"Left out: {line}." for line in left_out),
        ]
    )
    harness.write(
        f"engines_{options.model.stem}" if options.model else "engines",
        f"{options.model.stem if options.model else 'The published walls'} over all engines",
        notes,
        {
            "programs": [versions()],
            "timings": timings,
            "left_out": [{"reason": line} for line in left_out],
        },
        text,
    )


if __name__ == "__main__":
    main()
