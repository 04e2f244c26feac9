"""What every benchmark shares: one core, the machine's description, warm medians, tables.

Import this module before numpy: it holds the libraries' threads to one.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import platform
import resource
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import drystone as ds
from drystone.results.curve import DYNAMIC

RESULTS = Path(__file__).parent / "results"
LIBRARIES = ("numpy", "scipy", "numba")


def machine() -> dict[str, str]:
    """Processor, system and versions that the figures were measured with."""
    return {
        "processor": _processor(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        **{name: version(name) for name in LIBRARIES},
        "drystone": ds.__version__,
        "threads": "1",
    }


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"


def median_seconds(action: Callable[[], Any], repeats: int = 5) -> float:
    """Median time [s] of several runs after one that is not counted."""
    action()
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        action()
        times.append(time.perf_counter() - begun)
    return statistics.median(times)


@dataclass(frozen=True, kw_only=True)
class CurveTiming:
    """One curve, timed."""

    model: str
    engine: str
    n_blocks: int
    seconds: float  # median of warm runs
    n_points: int
    n_iterations: int  # all steps together, those of points that were kept
    peak_multiplier: float
    ultimate_displacement: float | None  # m
    max_residual: float  # of the heaviest block's weight, over all static points
    n_dynamic: int
    status: str
    peak_memory: float  # MiB, of the whole process so far

    @property
    def iterations_per_point(self) -> float:
        """Solver iterations a point."""
        return self.n_iterations / max(self.n_points - 1, 1)


def time_curve(
    name: str, model: ds.Model, engine: str, *, repeats: int = 5, **options: float
) -> CurveTiming:
    """Trace a model's curve several times."""
    curves = []
    seconds = median_seconds(
        lambda: curves.append(ds.pushover(model, engine=engine, progress=False, **options)), repeats
    )
    curve = curves[-1]
    static = [p.residual for p in curve.points if p.status != DYNAMIC]
    return CurveTiming(
        model=name,
        engine=engine,
        n_blocks=model.assembly.n_blocks,
        seconds=seconds,
        n_points=len(curve.points),
        n_iterations=sum(p.n_iterations for p in curve.points),
        peak_multiplier=curve.peak.load_multiplier,
        ultimate_displacement=curve.ultimate_displacement,
        max_residual=max(static),
        n_dynamic=len(curve.points) - len(static),
        status=curve.status,
        peak_memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    )


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Rows as a Markdown table; the keys of the first are its heads."""
    heads = list(rows[0])
    lines = [heads, *([str(row[head]) for head in heads] for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(heads))]

    def text(line: Sequence[str]) -> str:
        cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        return "| " + " | ".join(cells) + " |"

    rule = "|" + "|".join("-" * (width + 2) for width in widths) + "|"
    return "\n".join([text(lines[0]), rule, *map(text, lines[1:])])


def machine_line() -> str:
    """The machine in one line."""
    m = machine()
    libraries = ", ".join(f"{name} {m[name]}" for name in LIBRARIES)
    return f"{m['processor']}, one core; {m['system']}, Python {m['python']}, {libraries}"


def write(name: str, title: str, notes: str, parts: Mapping[str, Sequence[Any]], text: str) -> None:
    """Write ``results/NAME.json`` and ``results/NAME.md`` and print the latter.

    Parameters
    ----------
    parts
        Records (dataclasses or mappings) by the name of their table.
    text
        The tables in Markdown.
    """
    RESULTS.mkdir(exist_ok=True)
    records = {
        key: [asdict(row) if not isinstance(row, Mapping) else dict(row) for row in rows]
        for key, rows in parts.items()
    }
    (RESULTS / f"{name}.json").write_text(
        json.dumps({"machine": machine(), **records}, indent=2) + "\n", encoding="utf-8"
    )
    page = f"# {title}\n\n{machine_line()}.\n{notes}\n\n{text}\n"
    (RESULTS / f"{name}.md").write_text(page, encoding="utf-8")
    print(page)
