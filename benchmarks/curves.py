"""Seconds per curve of the published walls, and what a Gauss-Seidel sweep costs.

    python benchmarks/curves.py [--engine NAME ...] [--wall N ...] [--repeats N]

One core, compiled code warm, median of several runs.  Writes ``results/curves.json`` and ``.md``.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from inspect import signature
from typing import Any

import harness  # first: it holds the libraries' threads to one
import numpy as np

import drystone as ds
from drystone.contact.rows import IN_PLANE
from drystone.dynamics import nlgs
from drystone.dynamics import sweeps as kernels
from drystone.dynamics.nscd import NscdEngine
from drystone.dynamics.plane.sweeps import sweep
from drystone.engines import engine_names
from drystone.engines.base import EngineError

SWEEPS = 2000


@dataclass(frozen=True, kw_only=True)
class SweepTiming:
    """The Gauss-Seidel kernel on a wall at its peak."""

    model: str
    n_contacts: int
    nanoseconds_per_contact: float  # and sweep


def time_sweep(name: str, model: ds.Model) -> SweepTiming:
    """Time ``dynamics.sweeps.sweep`` on the contacts of the step in which the peak is found."""
    caught: list[dict[str, Any]] = []
    original = nlgs.solve
    named = signature(original)

    def spy(*args: Any, **given: Any) -> Any:
        caught.append(named.bind(*args, **given).arguments)
        return original(*args, **given)

    nlgs.solve = spy
    try:
        engine = NscdEngine()
        ds.pushover(model, engine=engine, max_displacement=0.01, progress=False)
    finally:
        nlgs.solve = original
    last = caught[-1]
    problem, h = last["problem"], last["h"]
    blocks = np.zeros((len(problem.gap), 2, 2))
    kernels.delassus_blocks(IN_PLANE, problem, blocks)
    order = np.arange(len(problem.gap))

    def sweeps() -> None:
        p, v = last["impulse"].copy(), last["free_velocity"].copy()
        kernels.apply_impulses(IN_PLANE, problem, p, v)
        sweep(IN_PLANE, problem, blocks, h, order, SWEEPS, p, v)

    seconds = harness.median_seconds(sweeps)
    n = len(problem.gap)
    return SweepTiming(
        model=name, n_contacts=n, nanoseconds_per_contact=1e9 * seconds / (SWEEPS * n)
    )


def curve_row(timing: harness.CurveTiming) -> dict[str, str]:
    end = timing.ultimate_displacement
    return {
        "wall": timing.model,
        "engine": timing.engine,
        "seconds": f"{timing.seconds:.2f}",
        "points": str(timing.n_points),
        "iterations per point": f"{timing.iterations_per_point:.1f}",
        "peak multiplier": f"{timing.peak_multiplier:.4f}",
        "end [m]": "-" if end is None else f"{end:.3f}",
        "largest residual": f"{timing.max_residual:.1e}",
        "dynamic points": str(timing.n_dynamic),
        "status": timing.status,
    }


def sweep_row(timing: SweepTiming) -> dict[str, str]:
    return {
        "wall": timing.model,
        "contacts": str(timing.n_contacts),
        "ns per contact and sweep": f"{timing.nanoseconds_per_contact:.1f}",
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engine", action="append", help="may be repeated; default: all")
    parser.add_argument("--wall", action="append", type=int, help="may be repeated; default: all")
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    walls = {str(n): ds.published_wall(n) for n in arguments.wall or (1, 2, 3)}
    engines = arguments.engine or [name for name in engine_names() if name != "lmgc90"]

    curves = []
    for engine in engines:
        for name, model in walls.items():
            try:
                timing = harness.time_curve(name, model, engine, repeats=arguments.repeats)
            except EngineError as error:
                print(f"wall {name}, {engine}: {error}")
                continue
            curves.append(timing)
    sweeps = [time_sweep(name, model) for name, model in walls.items()]
    text = "\n\n".join(
        [
            harness.table([curve_row(t) for t in curves]),
            harness.table([sweep_row(t) for t in sweeps]),
        ]
    )
    notes = (
        f"Median of {arguments.repeats} runs with the compiled code warm. An iteration is a Newton "
        "iteration,\nfor nscd a Gauss-Seidel sweep or a linear solution of its accelerator. End: "
        "control displacement\nat the multiplier 0.01. Residual: of static points, over the "
        "heaviest block's weight."
    )
    harness.write(
        "curves",
        "Seconds per curve of the published walls",
        notes,
        {"curves": curves, "sweeps": sweeps},
        text,
    )


if __name__ == "__main__":
    main()
