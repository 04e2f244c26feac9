"""Runs that are killed at random moments and go on: what is left opens, and the curve is whole.

python tests/killed.py --kills 100 --seed 1 examples/wall1.toml:nscd:max_steps=300 ...

A run is a model, an engine, and keys of [analysis]; ``history=0.002,-0.002,0`` makes it cyclic, and
``directions=2`` pushes in both senses, each in a process.

A run is a process that is forked from one with everything imported, as most of its time would
else be that of starting.  Its pictures are left out, as most kills would else come among them;
``pictures=1`` draws them.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import sys
import tempfile
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Thread
from typing import Any

import drystone as ds
from drystone.model.history import History

#: How runs begin; no threads run in the process that they are forked from.
FORKING = get_context("forkserver")
FORKING.set_forkserver_preload(["killed_imports"])
#: Share of the kills before a run has come to its first point.
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
    choice, whole = random.Random(seed), folder / "whole"

    def begun(where: Path, *, on: bool) -> tuple[BaseProcess, Connection]:
        heard, says = FORKING.Pipe(duplex=False)
        arguments = (str(model), engine, dict(options), str(where), on, says)
        process = FORKING.Process(target=child, args=arguments)
        process.start()
        says.close()
        return process, heard

    _ready()
    start = time.monotonic()
    process, heard = begun(whole, on=False)
    heard.poll(None)
    first = time.monotonic()
    process.join()
    before, took = first - start, time.monotonic() - first
    until = time.monotonic() + seconds
    usual, wanted = process.exitcode, digest(whole)
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
        process, heard = begun(out, on=on)
        if going:
            if choice.random() < AT_FIRST:
                time.sleep(choice.uniform(0.0, before))
            else:
                heard.poll(None)
                time.sleep(choice.uniform(0.0, SHARE * took))
            found["kills"] += process.is_alive()
            process.kill()
        process.join()
        status = process.exitcode
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


def _ready() -> None:
    """Start the process that others are forked from, which looks here for what it imports."""
    before = os.environ.get("PYTHONPATH")
    here = str(Path(__file__).parent)
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (here, before)))
    try:
        nothing = FORKING.Process(target=int)
        nothing.start()
        nothing.join()
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before


def child(
    path: str, engine: str, options: dict[str, Any], folder: str, on: bool, says: Connection
) -> None:
    """A run, or one that goes on, which keeps a state before every step and says when it has its
    first point; ends the process.

    One in several directions keeps states as rarely as others do.
    """
    sys.exit(_run(path, engine, options, Path(folder), on=on, says=says))


def _run(
    path: str, engine: str, options: dict[str, Any], folder: Path, *, on: bool, says: Connection
) -> int:
    from drystone.cli import directions
    from drystone.io.results import results_writer
    from drystone.report.folder import directory

    for module in (directory, results_writer):
        module.SECONDS = module.TIMES = 0.0
    if not options.pop("pictures", 0):
        directory.write_long = lambda done, aside: None
    told = []

    def seen(point: object) -> None:
        if not told:
            told.append(point)
            says.send("up")

    number = int(options.pop("directions", 0))
    if number:
        Thread(target=told_when_written, args=(folder, says), daemon=True).start()
    if on and number:
        return directions.resume_directions(folder, {}, processes=number, as_json=True, quiet=True)
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
            model, number, folder, asked, processes=number, as_json=True, quiet=True
        )
    ds.pushover(model, engine=engine, recorder=ds.ResultsDirectory(folder), progress=seen)
    return 0


def told_when_written(folder: Path, says: Connection) -> None:
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
    says.send("up")


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
    parser.add_argument("run", nargs="*", help="MODEL:ENGINE[:KEY=VALUE ...]")
    asked = parser.parse_args()
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
