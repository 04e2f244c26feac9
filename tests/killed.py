"""Runs that are killed at random moments and go on: what is left opens, and the curve is whole.

python tests/killed.py --kills 100 --seed 1 examples/wall1.toml:nscd:max_steps=300 ...
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import drystone as ds

#: A run, or one that goes on, which keeps a state before every step; says when it has its first
#: point.
CHILD = """
import sys
import drystone as ds
from drystone.io.results import hdf5
from drystone.report.folder import directory

for module in (directory, hdf5):
    module.SECONDS = module.TIMES = 0.0
path, folder, engine, options = sys.argv[1:]
told = []

def seen(point):
    if not told:
        told.append(point)
        print("up", flush=True)

if options == "on":
    ds.resume(folder, progress=seen)
else:
    import json
    model = ds.read_model(path).with_analysis(**json.loads(options))
    ds.pushover(model, engine=engine, recorder=ds.ResultsDirectory(folder), progress=seen)
"""

#: Share of the kills while a run begins.
AT_FIRST = 0.1


def digest(folder: Path) -> tuple[Any, ...]:
    """All that a curve is, from its folder."""
    stored = ds.load_results(folder)
    curve = stored.curve
    forces = [stored.contacts[k] for k in range(0, len(curve.points), 7)]
    return (
        repr(curve.points),
        stored.poses.tobytes(),
        curve.events,
        curve.blocks_left,
        curve.status,
        curve.reason,
        b"".join(force.normal_reaction.tobytes() + force.gap.tobytes() for force in forces),
    )


def killed_at_random(
    model: Path, engine: str, options: Mapping[str, float], folder: Path, *, kills: int, seed: int
) -> dict[str, Any]:
    """Kill so many runs of a model, one after the other; how often what was wrong."""
    choice, whole = random.Random(seed), folder / "whole"

    def begun(where: Path, *, on: bool) -> subprocess.Popen[str]:
        told = "on" if on else json.dumps(dict(options))
        return subprocess.Popen(
            [sys.executable, "-c", CHILD, str(model), str(where), engine, told],
            stdout=subprocess.PIPE,
            text=True,
        )

    child = begun(whole, on=False)
    assert child.stdout is not None
    child.stdout.readline()
    start = time.monotonic()
    assert child.wait() == 0
    seconds, wanted = time.monotonic() - start, digest(whole)
    found = {"kills": 0, "unread": 0, "ended": 0, "different": 0, "journals": 0, "failed": 0}
    out, on = folder / "out", False
    while found["kills"] < kills or on:
        child = begun(out, on=on)
        if found["kills"] < kills:
            if choice.random() < AT_FIRST:
                time.sleep(choice.uniform(0.0, 2.0))
            else:
                child.stdout.readline()
                time.sleep(choice.uniform(0.0, 0.35 * seconds))
            found["kills"] += child.poll() is None
            child.kill()
        status = child.wait()
        if status == 0:
            found["ended"] += 1
            found["different"] += digest(out) != wanted
            shutil.rmtree(out)
        found["failed"] += status not in (0, -9)
        on = (out / "results.h5").exists()
        found["journals"] += (out / ".results.h5.journal").exists()
        found["unread"] += on and not readable(out)
    return {"model": model.stem, "engine": engine, "seconds": round(seconds, 1), **found}


def readable(folder: Path) -> bool:
    """Whether all points of a folder can be read."""
    try:
        stored = ds.load_results(folder)
        for contacts in stored.contacts:
            assert contacts.n_contacts >= 0
    except Exception as error:
        print(f"unread: {error!r}", file=sys.stderr)
        return False
    return True


def main() -> None:
    """See the module's text."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("run", nargs="+", help="MODEL:ENGINE[:KEY=VALUE ...]")
    asked = parser.parse_args()
    for run in asked.run:
        model, engine, *options = run.split(":")
        values = {key: float(value) for key, value in (text.split("=") for text in options)}
        with tempfile.TemporaryDirectory() as folder:
            found = killed_at_random(
                Path(model), engine, values, Path(folder), kills=asked.kills, seed=asked.seed
            )
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
