"""The benchmark's folder: the table as json and csv, a page per wall, the curves."""

from __future__ import annotations

import csv
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np

from drystone.analysis.benchmark import Benchmark, BenchmarkRow, BenchmarkRun
from drystone.common.version import package_version
from drystone.io.results.csv import write_curve
from drystone.io.results.folder import locked, whole_file
from drystone.io.results.summary import write_summary
from drystone.report import draw_benchmark_wall
from drystone.report.curve_figure import Reference
from drystone.report.folder.pictures import MECHANISM_DISPLACEMENT, mechanism_row, mechanism_title
from drystone.report.mechanism import Mechanism
from drystone.results.curve import CapacityCurve


def write_benchmark(result: Benchmark, folder: Path, *, reference: Path | None = None) -> None:
    """Write everything into ``folder``, which is made where it is missing.

    Parameters
    ----------
    reference
        Folder with recorded curves ``wallN_*.csv``, drawn beside ours.

    Raises
    ------
    OutputError
        It cannot be written, or another run is writing there.
    """
    with locked(folder):
        _write(result, folder, reference)


def _write(result: Benchmark, folder: Path, reference: Path | None) -> None:
    rows = result.rows
    write_summary(
        {"version": package_version(), "rows": [asdict(row) for row in rows]},
        folder / "benchmark.json",
    )
    with (
        whole_file(folder / "benchmark.csv") as draft,
        draft.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.DictWriter(file, [f.name for f in fields(BenchmarkRow)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(row) for row in rows)
    for wall in result.walls:
        curves = [
            (run, run.curve) for run in result.of_wall(wall) if run.curve and run.curve.points
        ]
        for run, curve in curves:
            own = folder / f"wall{wall}-{run.engine}"
            own.mkdir(exist_ok=True)
            write_curve(curve, own / "curve.csv")
        if curves:
            _draw(wall, curves, folder, recorded_curves(reference, wall) if reference else [])


def recorded_curves(folder: Path, wall: int) -> list[Reference]:
    """Recorded curves of one wall; of their multipliers the carried one, where they have it.

    Raises
    ------
    OSError
        A file cannot be read or is not such a curve.
    """
    curves = []
    for path in sorted(folder.glob(f"wall{wall}_*.csv")):
        try:
            with path.open(newline="", encoding="utf-8") as file:
                lines = list(csv.DictReader(file))
            kind = "carried" if "carried_multiplier" in lines[0] else "applied"
            x = np.array([float(line["control_displacement_m"]) for line in lines])
            y = np.array([float(line[f"{kind}_multiplier"]) for line in lines])
        except (IndexError, KeyError, TypeError, ValueError):
            raise OSError(
                f"{path} is not a recorded curve: it needs the columns control_displacement_m and "
                "applied_multiplier or carried_multiplier, in numbers"
            ) from None
        name = path.stem.split("_", 1)[1].replace("_", " ").upper()
        curves.append((f"{name}, recorded ({kind})", x, y))
    return curves


def _draw(
    wall: int,
    curves: list[tuple[BenchmarkRun, CapacityCurve]],
    folder: Path,
    reference: list[Reference],
) -> None:
    mechanisms = []
    for run, curve in curves:
        row = mechanism_row(curve, MECHANISM_DISPLACEMENT)
        if curve.poses is not None:
            mechanism = Mechanism(
                assembly=run.model.assembly,
                pose=curve.poses[row],
                initial=curve.poses[0],
                load_direction=run.model.load_along,
                control_point=run.model.control_point,
            )
            mechanisms.append((mechanism_title(run.engine, curve, curve.points[row]), mechanism))
    draw_benchmark_wall(
        [(run.engine, curve) for run, curve in curves],
        mechanisms,
        folder / f"wall{wall}.png",
        title=curves[0][0].model.title,
        reference=reference,
    )
