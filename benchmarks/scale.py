"""Time and memory of whole curves of coursed walls with openings, from 50 to 10,000 blocks.

    python benchmarks/scale.py [--blocks N ...] [--first-steps N] [--seconds S] [--engine NAME]
                               [--stiffness FACTOR]

Each wall is traced in a process of its own, after a small one that warms the compiled code up.
Writes ``results/scale.json`` and ``.md``.
"""

from __future__ import annotations

import argparse
import math
import resource
import signal
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import harness  # first: it holds the libraries' threads to one
import numpy as np
from walls import facade, facade_of

import drystone as ds
from drystone.engines.base import EngineError
from drystone.results.curve import DYNAMIC, CurvePoint

BLOCKS = (50, 500, 5000, 10_000)
#: Walls of fewer blocks than this tell of the cost of a step, not of how it grows.
LEAST_FITTED = 400


@dataclass(frozen=True, kw_only=True)
class Trace:
    """One wall's curve, or the part of it that was traced."""

    n_blocks: int
    bays: int
    storeys: int
    model_seconds: float
    dead_load_seconds: float  # up to the first point
    seconds: float  # of the curve, the dead load included; all times are those of the processor
    n_points: int
    n_dynamic: int
    n_iterations: int  # of points that were kept
    peak_multiplier: float | None
    end_displacement: float | None  # m, of the last point
    last_multiplier: float | None
    max_residual: float | None  # of the heaviest block's weight, static points
    status: str
    reason: str
    peak_memory: float  # MiB, of the whole process

    @property
    def seconds_per_point(self) -> float:
        """Without the dead load; not a number where there was nothing but it."""
        steps = self.n_points - 1
        return (self.seconds - self.dead_load_seconds) / steps if steps > 0 else math.nan

    @property
    def iterations_per_point(self) -> float:
        """Likewise."""
        return self.n_iterations / (self.n_points - 1) if self.n_points > 1 else math.nan


def trace(
    n_blocks: int, stiffness: float, engine: str, first_steps: int | None, limit: float
) -> Trace:
    """Trace a wall's curve in this process, at most its first steps, for ``limit`` seconds."""
    ds.pushover(facade(50, stiffness), engine=engine, max_steps=10)
    options = {} if first_steps is None else {"max_steps": first_steps}
    points: list[CurvePoint] = []
    times: list[float] = []

    def progress(point: CurvePoint) -> None:
        points.append(point)
        times.append(time.process_time())

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    shape = facade_of(n_blocks)
    begun = time.process_time()
    model = facade(n_blocks, stiffness)
    made = time.process_time()
    # A timer, not the progress: the dead load and long steps must end in time, too.
    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, limit)
    status, reason = "interrupted", "dead load"
    try:
        curve = ds.pushover(model, engine=engine, progress=progress, **options)
        status, reason = curve.status, curve.reason
    except EngineError as error:
        status, reason = "failed", str(error)
    except KeyboardInterrupt:
        pass
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    ended = time.process_time()
    static = [p for p in points if p.status != DYNAMIC]
    return Trace(
        n_blocks=model.assembly.n_blocks,
        bays=shape.bays,
        storeys=shape.storeys,
        model_seconds=made - begun,
        dead_load_seconds=(times[0] if times else ended) - made,
        seconds=ended - made,
        n_points=len(points),
        n_dynamic=len(points) - len(static),
        n_iterations=sum(p.n_iterations for p in points[1:]),
        peak_multiplier=max((p.load_multiplier for p in static), default=None),
        end_displacement=points[-1].control_displacement if points else None,
        last_multiplier=points[-1].load_multiplier if points else None,
        max_residual=max((p.residual for p in static), default=None),
        status=status,
        reason=reason,
        peak_memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    )


def fitted_walls(traces: list[Trace]) -> list[Trace]:
    """Those that tell how the time per point grows."""
    return [t for t in traces if t.n_blocks >= LEAST_FITTED and t.n_points > 1]


def exponent(fitted: list[Trace]) -> float:
    """Of the number of blocks in the time per point, by least squares; NaN with fewer than two."""
    if len(fitted) < 2:
        return math.nan
    blocks, seconds = np.log([(t.n_blocks, t.seconds_per_point) for t in fitted]).T
    return float(np.polyfit(blocks, seconds, 1)[0])


def row(t: Trace) -> dict[str, str]:
    def text(value: float | None, form: str) -> str:
        return "-" if value is None or math.isnan(value) else format(value, form)

    return {
        "blocks": str(t.n_blocks),
        "bays x storeys": f"{t.bays} x {t.storeys}",
        "model [s]": f"{t.model_seconds:.2f}",
        "dead load [s]": f"{t.dead_load_seconds:.2f}",
        "curve [s]": f"{t.seconds:.1f}",
        "points": str(t.n_points),
        "dynamic": str(t.n_dynamic),
        "ms per point": text(1e3 * t.seconds_per_point, ".2f"),
        "iterations per point": text(t.iterations_per_point, ".1f"),
        "peak multiplier": text(t.peak_multiplier, ".4f"),
        "end [m]": text(t.end_displacement, ".3f"),
        "multiplier there": text(t.last_multiplier, ".4f"),
        "largest residual": text(t.max_residual, ".1e"),
        "memory [MiB]": f"{t.peak_memory:.0f}",
        "status": t.status,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--blocks", nargs="+", type=int, default=BLOCKS, metavar="N")
    parser.add_argument("--first-steps", type=int, metavar="N", help="instead of the whole curve")
    parser.add_argument(
        "--seconds", type=float, default=600.0, help="after which a curve is broken off"
    )
    parser.add_argument("--engine", default="equilibrium")
    parser.add_argument(
        "--stiffness", type=float, default=1.0, metavar="FACTOR", help="of the published joints"
    )
    arguments = parser.parse_args()

    traces = []
    for n_blocks in arguments.blocks:
        with ProcessPoolExecutor(max_workers=1, mp_context=get_context("spawn")) as process:
            found = process.submit(
                trace,
                n_blocks,
                arguments.stiffness,
                arguments.engine,
                arguments.first_steps,
                arguments.seconds,
            ).result()
        print(f"{found.n_blocks} blocks: {found.status}, {found.reason}", flush=True)
        traces.append(found)
    steps = "whole curves" if arguments.first_steps is None else f"{arguments.first_steps} steps"
    notes = (
        f"Engine {arguments.engine}, {steps}, broken off after {arguments.seconds:g} s. Seconds "
        "are those of the processor, the\ncompiled code being warm; a point's are without "
        "the dead load. An opening in every bay of every storey, with\na lintel over it; corners "
        f"of the published walls, joints {arguments.stiffness:g} times as stiff. Memory: the "
        "largest the process ever had."
    )
    fitted = fitted_walls(traces)
    grows = exponent(fitted)
    text = harness.table([row(t) for t in traces])
    if not math.isnan(grows):
        text += f"\n\nTime per point grows as blocks^{grows:.2f} from {LEAST_FITTED} blocks on."
        if any(t.status != "finished" for t in fitted):
            text += (
                " Not all curves are whole: points\nbefore and after the peak, static and dynamic, "
                "differ in cost, and their shares differ from wall to wall."
            )
    harness.write(
        "scale",
        "Time and memory by number of blocks",
        notes,
        {"walls": traces, "fit": [{"exponent": None if math.isnan(grows) else grows}]},
        text,
    )


if __name__ == "__main__":
    main()
