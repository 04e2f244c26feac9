"""What states cost that a run keeps to go on from: processor time, place, work that a kill loses.

    python benchmarks/keeping.py [--model wall1] [--model facade] [--model house] [--engine NAME]

Each model is traced into a folder of results, as ``drystone run`` does, after small ones that warm
the compiled code up.  Packing a state and writing it is timed.  Points are brought to the disk
before it, as they are without states about once a second: ``--repeats N`` traces each model N
times with states and twice N times without, in turn, and compares the medians.  Runs without
states are told in two halves: what these differ by is the noise of the machine.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import harness  # first: it holds the libraries' threads to one

import drystone as ds
from drystone.io.results.checkpoint import CHECKPOINT
from drystone.io.results.names import RESULTS
from drystone.io.results.results_writer import ResultsWriter
from drystone.model.model import Model
from drystone.results.checkpoint import Checkpoint
from drystone.results.curve import CapacityCurve

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))
EXAMPLES = ROOT / "examples"


class Watched(ds.ResultsDirectory):
    """Results whose states are timed."""

    def __init__(self, path: Path, *, keeps: bool = True) -> None:
        super().__init__(path)
        self.keeps = keeps
        self.seconds = 0.0  # of the processor, of all states
        self.kept_at = [(time.monotonic(), time.process_time())]  # s, of states on the disk
        self.largest = 0  # bytes, of a state
        self.ended_at = 0.0  # s, of the processor, before pictures and tables

    def keep(self, make: Callable[[], Checkpoint], *, last: bool = False) -> None:
        """See `ResultsDirectory`."""

        def timed() -> Checkpoint:
            begun = time.process_time()
            made = make()
            self.seconds += time.process_time() - begun
            return made

        if self.keeps:
            super().keep(timed, last=last)

    def _close_whole(self, writer: ResultsWriter, curve: CapacityCurve) -> OSError | None:
        failure = super()._close_whole(writer, curve)
        self.ended_at = time.process_time()
        return failure

    def _note(self) -> None:
        self.kept_at.append((time.monotonic(), time.process_time()))

    def _put(self, writer: ResultsWriter, checkpoint: Checkpoint) -> None:
        begun = time.process_time()
        super()._put(writer, checkpoint)
        self.seconds += time.process_time() - begun
        self._note()
        self.largest = max(self.largest, (self.path / CHECKPOINT).stat().st_size)


def model_of(name: str) -> Model:
    """One of the three."""
    if name == "house":
        import buildings

        return buildings.house()
    return ds.read_model(EXAMPLES / f"{name}.toml")


def traced(model: Model, engine: str, folder: str, *, keeps: bool = True) -> tuple[Watched, float]:
    """The results of a run, and its seconds of the processor up to the last point."""
    begun = time.process_time()
    watched = Watched(Path(folder) / "out", keeps=keeps)
    ds.pushover(model, engine=engine, recorder=watched)
    return watched, watched.ended_at - begun


def told(name: str, model: Model, engine: str) -> None:
    """One model, traced once."""
    with tempfile.TemporaryDirectory() as folder:
        watched, seconds = traced(model, engine, folder)
        size = (watched.path / RESULTS).stat().st_size
        curve = ds.load_results(watched.path).curve
    own = watched.seconds
    wall, own_time = (max(b[k] - a[k] for a, b in pairwise(watched.kept_at)) for k in (0, 1))
    n = len(curve.points)
    print(
        f"{name}: {model.assembly.n_blocks} blocks, {n} points, {curve.status}; "
        f"{seconds:.1f} s of the processor, of which {len(watched.kept_at) - 1} states "
        f"{own:.3f} s, {100.0 * own / seconds:.2f} %; a state {watched.largest / 1e6:.2f} MB, "
        f"{RESULTS} {size / 1e6:.2f} MB, {size / n / 1e3:.0f} kB a point; longest between two "
        f"states {wall:.1f} s, {own_time:.1f} s of the processor",
        flush=True,
    )


def compared(name: str, model: Model, engine: str, repeats: int) -> None:
    """One model, traced with states and without, and without once more."""
    seconds: dict[str, list[float]] = {"with states": [], "without": [], "without, again": []}
    for turn in range(repeats):
        ways = list(seconds)
        for way in ways[turn % 3 :] + ways[: turn % 3]:  # no order is favoured
            with tempfile.TemporaryDirectory() as folder:
                keeps = way == "with states"
                seconds[way].append(traced(model, engine, folder, keeps=keeps)[1])
    without = statistics.median(seconds["without"] + seconds["without, again"])
    medians = {way: statistics.median(values) for way, values in seconds.items()}
    print(
        f"{name}: {without:.3f} s of the processor without states, medians of {repeats}: "
        + ", ".join(f"{way} {100.0 * (s / without - 1.0):+.2f} %" for way, s in medians.items()),
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--model", action="append", choices=("wall1", "facade", "house"))
    parser.add_argument("--engine", default="equilibrium")
    parser.add_argument("--repeats", type=int, default=0, help="runs with states and without")
    chosen = parser.parse_args()
    print(harness.machine())
    for name in ("two_blocks", "solids"):
        ds.pushover(ds.read_model(EXAMPLES / f"{name}.toml"), engine=chosen.engine)
    for name in chosen.model or ("wall1", "facade", "house"):
        model = model_of(name)
        told(name, model, chosen.engine)
        if chosen.repeats:
            compared(name, model, chosen.engine, chosen.repeats)


if __name__ == "__main__":
    main()
