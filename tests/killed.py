"""Runs that are killed at random moments and go on: what is left opens, and the curve is whole.

python tests/killed.py --kills 100 --seed 1 examples/wall1.toml:nscd:max_steps=300 ...

A run is a model, an engine, and keys of [analysis]; ``history=0.002,-0.002,0`` makes it cyclic, and
``directions=2`` pushes in both senses, each in a process.
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
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from threading import Thread
from typing import Any

import drystone as ds
from drystone.model.history import History

#: Share of the kills while a run begins.
AT_FIRST = 0.1
#: Longest time of a run after its first point that goes by before it is killed, over the time of
#: the whole run: so that a run is killed some three times before it ends.
SHARE = 0.35


def killed_at_random(
    model: Path,
    engine: str,
    options: Mapping[str, Any],
    folder: Path,
    *,
    kills: int,
    seed: int,
    seconds: float = float("inf"),
) -> dict[str, Any]:
    """Kill so many runs of a model, one after the other; how often what was wrong.

    After so many ``seconds`` no more are killed; the last one goes on to its end.
    """
    choice, whole, until = random.Random(seed), folder / "whole", time.monotonic() + seconds

    def begun(where: Path, *, on: bool) -> subprocess.Popen[str]:
        told = json.dumps([str(model), engine, dict(options), str(where), on])
        return subprocess.Popen(
            [sys.executable, __file__, "--child", told], stdout=subprocess.PIPE, text=True
        )

    child = begun(whole, on=False)
    assert child.stdout is not None
    child.stdout.readline()
    start = time.monotonic()
    usual = child.wait()
    took, wanted = time.monotonic() - start, digest(whole)
    found = {
        "kills": 0,
        "unread": 0,
        "ended": 0,
        "different": 0,
        "journals": 0,
        "failed": 0,
    }
    out, on = folder / "out", False
    while (going := found["kills"] < kills and time.monotonic() < until) or on:
        child = begun(out, on=on)
        if going:
            if choice.random() < AT_FIRST:
                time.sleep(choice.uniform(0.0, 2.0))
            else:
                assert child.stdout is not None
                child.stdout.readline()
                time.sleep(choice.uniform(0.0, SHARE * took))
            found["kills"] += child.poll() is None
            child.kill()
        status = child.wait()
        if status == usual:
            found["ended"] += 1
            found["different"] += digest(out) != wanted
            shutil.rmtree(out)
        found["failed"] += status not in (usual, -9)
        results = list(out.rglob("results.h5"))
        on = bool(results) or (out / "directions.npz").exists()
        found["journals"] += bool(list(out.rglob(".results.h5.journal")))
        found["unread"] += sum(not readable(file.parent) for file in results)
    return {"model": model.stem, "engine": engine, **options, "seconds": round(took, 1), **found}


def child(path: str, engine: str, options: dict[str, Any], folder: str, on: bool) -> int:
    """A run, or one that goes on, which keeps a state before every step and says when it has its
    first point; the exit status.

    One in several directions keeps states as rarely as others do.
    """
    from drystone.cli import directions
    from drystone.io.results import hdf5
    from drystone.report.folder import directory

    for module in (directory, hdf5):
        module.SECONDS = module.TIMES = 0.0
    told = []

    def seen(point: object) -> None:
        if not told:
            told.append(point)
            print("up", flush=True)

    number = int(options.pop("directions", 0))
    if number:
        Thread(target=told_when_written, args=(Path(folder),), daemon=True).start()
    if on and number:
        return directions.resume_directions(
            Path(folder), {}, processes=number, as_json=True, quiet=True
        )
    if on:
        ds.resume(folder, progress=seen)
        return 0
    targets = options.pop("history", None)
    model = ds.read_model(path).with_analysis(**options)
    if targets is not None:
        model = replace(model, history=History(targets=tuple(targets)))
    if number:
        asked = directions.Asked(engine, None, None)
        return directions.run_directions(
            model, number, Path(folder), asked, processes=number, as_json=True, quiet=True
        )
    ds.pushover(model, engine=engine, recorder=ds.ResultsDirectory(folder), progress=seen)
    return 0


def told_when_written(folder: Path) -> None:
    """Say when a direction has written its first point, or another state."""

    def written() -> dict[Path, float]:
        names = ("results.h5", "checkpoint.npz")
        found = [path for name in names for path in folder.glob(f"*/{name}")]
        with suppress(FileNotFoundError):  # another has taken its place
            return {path: path.stat().st_mtime for path in found}
        return {}

    before = written()
    while written() in (before, {}):
        time.sleep(0.05)
    print("up", flush=True)


def digest(folder: Path) -> list[tuple[Any, ...]]:
    """All that the curves of a folder are."""
    files = sorted(folder.rglob("results.h5"))
    return [(str(file.relative_to(folder)), *_digest(file.parent)) for file in files]


def _digest(folder: Path) -> tuple[Any, ...]:
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


def main() -> int:
    """See the module's text."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100, help="of each run")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="of kills, each run")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    parser.add_argument("run", nargs="*", help="MODEL:ENGINE[:KEY=VALUE ...]")
    asked = parser.parse_args()
    if asked.child:
        return child(*json.loads(asked.child))
    for run in asked.run:
        model, engine, *options = run.split(":")
        values = {}
        for key, _, text in (option.partition("=") for option in options):
            values[key] = _numbers(text) if key == "history" else float(text)
        with tempfile.TemporaryDirectory() as folder:
            found = killed_at_random(
                Path(model), engine, values, Path(folder), kills=asked.kills, seed=asked.seed,
                seconds=asked.seconds,
            )  # fmt: skip
        print(json.dumps(found), flush=True)
    return 0


def _numbers(text: str) -> list[float]:
    return [float(part) for part in text.split(",")]


if __name__ == "__main__":
    sys.exit(main())
