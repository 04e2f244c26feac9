"""Many curves of wall 1, friction and unit sizes drawn: how long they take, and how each ends.

    python benchmarks/many.py --out out/many --curves 10000 [--workers 2] [--resume]
                              [--figure docs/images/wall1_study.png]

The study is that of examples/wall1_study.toml with more samples.  After an
interruption `--resume` goes on; minutes are then those of the last run, for as many curves as it
computed.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import tomllib
from pathlib import Path

from harness import machine

STUDY = Path(__file__).parents[1] / "examples" / "wall1_study.toml"


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--curves", type=int, default=10_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--figure", type=Path)
    asked = parser.parse_args()

    from drystone.studies.conduct import conclude, conduct
    from drystone.studies.read import read_study
    from drystone.studies.tables import read_samples

    study = tomllib.loads(STUDY.read_text(encoding="utf-8"))
    study["samples"] = asked.curves
    study["model"] = tomllib.loads((STUDY.parent / study["model"]).read_text(encoding="utf-8"))
    told = read_study(study)
    before = os.getloadavg()[0]
    progress = conduct(told, asked.out, workers=asked.workers, resume=asked.resume)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = conclude(told, asked.out)
    computed = progress.done - progress.before

    for name, value in machine().items():
        print(f"{name}: {value}")
    print(f"load before and after: {before:.2f}, {os.getloadavg()[0]:.2f}")
    print("| what | found |\n|---|---|")
    print(f"| curves computed, by {asked.workers} processes | {computed} |")
    if computed:
        each = (used.ru_utime + used.ru_stime) / computed
        print(f"| minutes | {progress.seconds / 60.0:.2f} |")
        print(f"| curves a second | {progress.rate:.2f} |")
        print(f"| processor time of a curve [s], start-up included | {each:.3f} |")
        print(f"| minutes for 10,000 at this processor time | "
              f"{1e4 * each / (60.0 * asked.workers):.1f} |")  # fmt: skip
    print(f"| curves that are complete and certified | {found['n_certified']} of {told.count} |")
    frame = read_samples(asked.out)
    print(f"| largest residual of a point | {frame['max_residual'].max():.2g} |")
    for reason, number in frame["reason"].value_counts().items():
        print(f"| ends: {reason} | {number} |")
    for name in ("peak_multiplier", "ultimate_displacement"):
        own = found["columns"][name]
        print(f"| {name}: median, 5 % to 95 % | {own['median']:.4g}, {own['p05']:.4g} to "
              f"{own['p95']:.4g} |")  # fmt: skip
    wrong = frame[frame["certified"] != True]  # noqa: E712  # of a column
    for row in wrong.itertuples():
        print(f"| sample {row.sample}: {row.status} | {row.reason}, residual {row.max_residual} |")
    if asked.figure is not None:
        shutil.copy(asked.out / "bands.png", asked.figure)


if __name__ == "__main__":
    main()
