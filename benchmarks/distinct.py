"""Cycles of the distinct element engine: nanoseconds per contact, and what a curve costs.

    python benchmarks/distinct.py [--wall N ...] [--repeats N]

One core, compiled code warm, median of several runs.  Writes ``results/distinct.json`` and ``.md``.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import harness  # first: it holds the libraries' threads to one

import drystone as ds
from drystone.dynamics.distinct.cycles import run
from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.workspace import Workspace
from drystone.engines.base import Demand, Problem

CYCLES = 20_000


@dataclass(frozen=True, kw_only=True)
class CycleTiming:
    """Cycles of a wall near its peak."""

    model: str
    n_contacts: int  # watched, open ones included
    n_closed: int
    microseconds_per_cycle: float
    nanoseconds_per_contact: float  # watched, and cycle


def time_cycles(name: str, model: ds.Model, repeats: int) -> CycleTiming:
    """Time cycles that hold a wall 5 mm on its way."""
    engine = DistinctEngine()
    problem = Problem(assembly=model.assembly, load=model.load, control_point=model.control_point)
    state, _ = engine.start(problem)
    for increment in 5 * [1e-4] + 5 * [9e-4]:
        state, _ = engine.step(state, Demand(increment=increment))
    work = Workspace(engine.settings, state, real_masses=False)
    seconds = harness.median_seconds(lambda: run(work, CYCLES, guided=True), repeats)
    return CycleTiming(
        model=name,
        n_contacts=work.n_contacts,
        n_closed=int((work.contacts.reaction[:, 0] > 0.0).sum()),
        microseconds_per_cycle=1e6 * seconds / CYCLES,
        nanoseconds_per_contact=1e9 * seconds / CYCLES / work.n_contacts,
    )


def cycle_row(timing: CycleTiming) -> dict[str, str]:
    return {
        "wall": timing.model,
        "contacts": str(timing.n_contacts),
        "closed": str(timing.n_closed),
        "us per cycle": f"{timing.microseconds_per_cycle:.2f}",
        "ns per contact and cycle": f"{timing.nanoseconds_per_contact:.1f}",
    }


def curve_row(strategy: str, timing: harness.CurveTiming) -> dict[str, str]:
    end = timing.ultimate_displacement
    return {
        "wall": timing.model,
        "strategy": strategy,
        "seconds": f"{timing.seconds:.1f}",
        "points": str(timing.n_points),
        "cycles": f"{timing.n_iterations / 1e6:.2f} M",
        "peak multiplier": f"{timing.peak_multiplier:.4f}",
        "end [m]": "-" if end is None else f"{end:.3f}",
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wall", action="append", type=int, help="may be repeated; default: all")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    walls = {str(n): ds.published_wall(n) for n in arguments.wall or (1, 2, 3)}

    cycles = [time_cycles(name, model, arguments.repeats) for name, model in walls.items()]
    rows = []
    curves = []
    for strategy, options in (("displacement", {}), ("published", {"overshoot": 1.01})):
        for name, model in walls.items():
            timing = harness.time_curve(
                name, model, "distinct", repeats=arguments.repeats, strategy=strategy, **options
            )
            curves.append(timing)
            rows.append(curve_row(strategy, timing))
    notes = (
        f"Median of {arguments.repeats} runs with the compiled code warm; cycles of the points "
        "that were kept.\nThe published strategy with an overshoot of 1.01. End: control "
        "displacement at the multiplier 0.01."
    )
    text = harness.table([cycle_row(t) for t in cycles]) + "\n\n" + harness.table(rows)
    harness.write(
        "distinct",
        "Cycles of the distinct element engine",
        notes,
        {"cycles": cycles, "curves": curves},
        text,
    )


if __name__ == "__main__":
    main()
