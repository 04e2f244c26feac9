"""What a study costs beside its curves: start-up, two processes over one, memory, chunks.

    python benchmarks/studies.py [--curves 300] [--samples 100000]

Others may work on the same machine: beside rates by the clock stands the share of the time in which
processes computed curves, which the load of others does not change.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from harness import machine

WALL = Path(__file__).parents[1] / "examples" / "wall1.toml"
STUB = "def stub(x):\n    return {'peak_multiplier': 2.0 * x['a']}\n"

STUDY = """
model = "wall1.toml"
design = "random"
samples = {n}
[[parameter]]
path = "joint.friction_coefficient"
distribution = "norm"
mean = 0.65
std = 0.08
"""
STUB_STUDY = """
function = "stub_of_benchmark:stub"
design = "random"
samples = {n}
[[parameter]]
path = "a"
range = [0.0, 1.0]
"""


def run(text: str, folder: Path, workers: int) -> dict[str, float]:
    """A study in a process of its own: seconds in all, start-up, rate, busy share, memory."""
    folder.mkdir()
    (folder / "stub_of_benchmark.py").write_text(STUB)
    shutil.copy(WALL, folder)
    file = folder / "study.toml"
    file.write_text(text)
    done = subprocess.run(
        [sys.executable, __file__, "--inner", str(file), str(workers)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    names = ("whole", "first", "seconds", "rate", "busy", "each", "memory")
    return dict(zip(names, map(float, done.stdout.split()[-7:]), strict=True))


def inner(file: str, workers: int) -> None:
    """Run the study of a file and print figures."""
    begun = time.perf_counter()
    from drystone.studies.conduct import conduct
    from drystone.studies.read import read_study
    from drystone.studies.tables import read_samples

    first: list[float] = []
    starts: list[float] = []

    def told(progress: object) -> None:
        if not first and getattr(progress, "done", 0):
            first.append(getattr(progress, "seconds", 0.0))
            starts.append(time.perf_counter() - begun)

    folder = Path(file).parent / "out"
    progress = conduct(read_study(file), folder, workers=workers, told=told)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    whole = time.perf_counter() - begun
    seconds = read_samples(folder, ["seconds"])["seconds"]
    start = starts[0] - seconds.iloc[0]  # the first sample comes alone
    steady = progress.seconds - first[0]
    busy = seconds.iloc[1:].sum() / (workers * steady)
    print(whole, start, progress.seconds, (len(seconds) - 1) / steady, busy, seconds.mean(), memory)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--curves", type=int, default=300)
    parser.add_argument("--samples", type=int, default=100_000)
    asked = parser.parse_args()
    for name, value in machine().items():
        print(f"{name}: {value}")
    print(f"load before: {os.getloadavg()[0]:.2f}")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        text = STUDY.format(n=asked.curves)
        print("| processes | curves | start-up [s] | curves/s | busy | s/curve | driver [MiB] |")
        print("|---|---|---|---|---|---|---|")
        rates = []
        for workers in (1, 2):
            found = run(text, folder / f"wall{workers}", workers)
            rates.append(found["rate"])
            print(
                f"| {workers} | {asked.curves} | {found['first']:.2f} | {found['rate']:.3f} | "
                f"{found['busy']:.3f} | {found['each']:.3f} | {found['memory']:.0f} |"
            )
        print(f"rate of two over one: {rates[1] / rates[0]:.3f}")
        found = run(STUB_STUDY.format(n=asked.samples), folder / "stub", 1)
        print(
            f"stub: {asked.samples} samples in {found['whole']:.1f} s, driver "
            f"{found['memory']:.0f} MiB, {1e6 * found['seconds'] / asked.samples:.0f} "
            "microseconds a sample"
        )
    print(f"load after: {os.getloadavg()[0]:.2f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--inner"]:
        inner(sys.argv[2], int(sys.argv[3]))
    else:
        main()
