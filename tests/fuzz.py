"""Changes sound files of every kind at random, and looks at what becomes of them.

    python tests/fuzz.py --seconds 600 [--seed N] [--reader NAME ...] [--count N] [--finds DIR]

Each file ends in a clear error, or in a model, of which small ones are run for a few points; see
``tests/fuzzing/judging.py``.  Whatever else becomes of one is a find: its files are kept in a
folder of their own, with the reader, the seed and the number by which it is made again:

    python tests/fuzz.py --again model 1 4711
"""

from __future__ import annotations

import argparse
import collections
import random
import sys
import tempfile
import time
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from fuzzing import judging, readers, sound, workers
from fuzzing.readers import READERS, Case, cases


def main() -> int:
    """Status 1 where there were finds."""
    asked = _arguments()
    warm()
    if asked.again:
        reader, seed, number = asked.again
        return again(Case(reader, int(seed), int(number)))
    names = asked.reader or readers.available()
    missing = sorted(set(READERS) - set(readers.available()))
    if missing and not asked.reader:
        print(f"left out, as their libraries are not installed: {', '.join(missing)}")
    count = asked.count or 10**9
    until = time.monotonic() + (asked.seconds or float("inf"))
    finds: list[workers.Ended] = []
    table: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    slowest = 0.0, ""
    begun = time.monotonic()
    for ended in workers.judged(
        cases(names, asked.seed, count), processes=asked.processes, until=until
    ):
        table[ended.case.reader][ended.kind] += 1
        slowest = max(slowest, (ended.seconds, f"{ended.case.reader} {ended.case.number}"))
        if ended.kind not in judging.GOOD:
            finds.append(ended)
            keep(ended, asked.finds)
            print(f"{ended.case.reader} {ended.case.seed} {ended.case.number}: "
                  f"{ended.kind}: {ended.what}", flush=True)  # fmt: skip
    print(summary(table))
    print(f"{time.monotonic() - begun:.0f} s, seed {asked.seed}, "
          f"the slowest {slowest[0]:.1f} s ({slowest[1]})")  # fmt: skip
    if finds:
        print(f"{len(finds)} finds, kept in {asked.finds}")
    return 1 if finds else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seconds", type=float, help="stop after as many")
    parser.add_argument("--count", type=int, help="stop after as many files")
    parser.add_argument("--seed", type=int, help="by default another one every time")
    parser.add_argument("--reader", action="append", choices=list(READERS), help="these alone")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--finds", type=Path, default=Path("fuzz-finds"), help="folder of finds")
    parser.add_argument("--again", nargs=3, metavar=("READER", "SEED", "NUMBER"))
    asked = parser.parse_args()
    if asked.seconds is None and asked.count is None:
        asked.seconds = 60.0
    if asked.seed is None:
        asked.seed = random.SystemRandom().randrange(10**6)
    return asked


def warm() -> None:
    """Compile and import what all workers share before they are forked."""
    from drystone.io.modelfile.read import model_from_text

    for name in ("plane", "space"):
        model = model_from_text(sound.MODELS[name], source=None, sha256="")
        for engine in judging.ENGINES:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    judging._run(model, engine)
                except Exception as error:
                    print(f"{name} by {engine}: {error}", file=sys.stderr)


def again(case: Case) -> int:
    """One case in this process, with its traceback."""
    with tempfile.TemporaryDirectory() as folder:
        path = case.written(Path(folder))
        print(path.read_bytes()[:4000].decode("utf-8", "replace"))
        print(case.looked_at(path))
        draw = random.Random(f"look {case.reader} {case.seed} {case.number}")
        warnings.simplefilter("error")
        print(READERS[case.reader].look(path, draw))
    return 0


def keep(ended: workers.Ended, finds: Path) -> None:
    """The files of a find in a folder of their own, with what became of them."""
    case = ended.case
    folder = finds / f"{case.reader}-{case.seed}-{case.number}"
    folder.mkdir(parents=True, exist_ok=True)
    case.written(folder)
    (folder / "find.txt").write_text(f"{ended.kind}: {ended.what}\n", encoding="utf-8")


def summary(table: dict[str, collections.Counter[str]]) -> str:
    """Files by reader and by what became of them."""
    kinds = [
        *judging.GOOD,
        *sorted({kind for row in table.values() for kind in row} - {*judging.GOOD}),
    ]
    rows = [("reader", "files", *kinds)]
    for name, row in table.items():
        rows.append((name, str(row.total()), *(str(row[kind]) for kind in kinds)))
    total = sum(table.values(), collections.Counter())
    rows.append(("all", str(total.total()), *(str(total[kind]) for kind in kinds)))
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join(
        "  ".join(
            cell.rjust(w) if k else cell.ljust(w)
            for k, (cell, w) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    )


if __name__ == "__main__":
    sys.exit(main())
