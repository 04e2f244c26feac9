"""The published walls, analysed by our engines and set beside the published values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

from drystone.engines.base import EngineError
from drystone.limit import Beside, limits_beside
from drystone.model.builders.published import PUBLISHED_WALLS, PublishedWall, published_wall
from drystone.model.model import Model
from drystone.results.curve import CapacityCurve, CurvePoint

#: Shows the points of one analysis while it runs.
Progress = AbstractContextManager[Callable[[CurvePoint], None] | None]


@dataclass(frozen=True, kw_only=True)
class BenchmarkRun:
    """One wall analysed by one engine; without a curve where the engine could not do it."""

    wall: int
    engine: str
    model: Model
    curve: CapacityCurve | None  # with poses
    reason: str
    beside: Beside  # limit analysis of the same model


@dataclass(frozen=True, kw_only=True)
class BenchmarkRow:
    """One line of the table: a wall, an engine and the published values."""

    wall: int
    n_blocks: int
    peak_gilbert: float
    peak_lmgc90: float
    peak_udec: float
    published_error: float  # %, (LMGC90 - UDEC) / LMGC90, which gives the paper's column
    ultimate_displacement_lmgc90: float  # m
    engine: str
    status: str  # of the curve, or "failed"
    reason: str
    associative_multiplier: float | None  # our limit analysis, with the corners of the curve
    non_associative_multiplier: float | None
    collapse_range: tuple[float, float] | None  # non-associative: lowest and highest found
    warning: str | None  # where the peak exceeds the associative multiplier
    peak_multiplier: float | None
    peak_displacement: float | None  # m
    ultimate_displacement: float | None  # m
    spread: float | None  # %, between the peaks of our engines on this wall; None for one engine
    n_points: int
    max_residual: float | None
    wall_time: float | None  # s


@dataclass(frozen=True, kw_only=True)
class Benchmark:
    """All analyses, in the order of walls, then engines."""

    runs: tuple[BenchmarkRun, ...]

    def of_wall(self, wall: int) -> list[BenchmarkRun]:
        """The analyses of one wall."""
        return [run for run in self.runs if run.wall == wall]

    @property
    def walls(self) -> list[int]:
        """Numbers of the walls that were analysed."""
        return list(dict.fromkeys(run.wall for run in self.runs))

    @property
    def rows(self) -> list[BenchmarkRow]:
        """The table."""
        return [_row(run, self.spread(run.wall)) for run in self.runs]

    @property
    def interrupted(self) -> bool:
        """Whether the user stopped it."""
        return any(run.curve is not None and run.curve.status == "interrupted" for run in self.runs)

    def spread(self, wall: int) -> float | None:
        """Highest less lowest peak of our engines over their mean [%]; None for a single engine."""
        curves = [run.curve for run in self.of_wall(wall) if run.curve and run.curve.points]
        peaks = [curve.peak.load_multiplier for curve in curves]
        if len(peaks) < 2:
            return None
        return 100.0 * (max(peaks) - min(peaks)) * len(peaks) / sum(peaks)


def benchmark(
    *,
    walls: Sequence[int] = tuple(PUBLISHED_WALLS),
    engines: Sequence[str] = (),
    strategy: str = "displacement",
    progress: Callable[[str, Model], Progress] = lambda title, model: nullcontext(),
) -> Benchmark:
    """Analyse walls by engines.

    Parameters
    ----------
    walls
        Numbers of the published walls.
    engines
        Names; none for the default engine.
    strategy
        How the load is applied.
    progress
        Makes, for the title and model of each analysis, what is told of its points.

    An engine that cannot do a wall leaves a run without a curve, with the reason.
    """
    runs: list[BenchmarkRun] = []
    for wall in walls:
        model = published_wall(wall)
        beside = limits_beside(model)
        for engine in engines or (model.analysis.engine,):
            run = _analyse(wall, model, beside, engine, strategy, progress)
            runs.append(run)
            if run.curve is not None and run.curve.status == "interrupted":
                return Benchmark(runs=tuple(runs))
    return Benchmark(runs=tuple(runs))


def _analyse(
    wall: int,
    model: Model,
    beside: Beside,
    engine: str,
    strategy: str,
    progress: Callable[[str, Model], Progress],
) -> BenchmarkRun:
    from drystone.analysis.driver import pushover

    curve, reason = None, ""
    try:
        with progress(f"wall {wall}, {engine}", model) as tell:
            curve = pushover(
                model,
                engine=engine,
                strategy=strategy,
                progress=tell,
                keep_poses=True,
                keep_contacts=True,
            )
        reason = curve.reason
    except EngineError as error:
        reason = str(error)
    return BenchmarkRun(
        wall=wall, engine=engine, model=model, curve=curve, reason=reason, beside=beside
    )


def _row(run: BenchmarkRun, spread: float | None) -> BenchmarkRow:
    published: PublishedWall = PUBLISHED_WALLS[run.wall]
    curve = run.curve if run.curve and run.curve.points else None
    return BenchmarkRow(
        wall=run.wall,
        n_blocks=run.model.assembly.n_blocks,
        peak_gilbert=published.peak_gilbert,
        peak_lmgc90=published.peak_lmgc90,
        peak_udec=published.peak_udec,
        published_error=100.0
        * (published.peak_lmgc90 - published.peak_udec)
        / published.peak_lmgc90,
        ultimate_displacement_lmgc90=published.ultimate_displacement_lmgc90,
        engine=run.engine,
        status=run.curve.status if run.curve else "failed",
        reason=run.reason,
        associative_multiplier=run.beside.associative,
        non_associative_multiplier=run.beside.non_associative,
        collapse_range=run.beside.collapse_range,
        warning=run.beside.warning(curve, run.model) if curve else None,
        peak_multiplier=curve.peak.load_multiplier if curve else None,
        peak_displacement=curve.peak.control_displacement if curve else None,
        ultimate_displacement=curve.ultimate_displacement if curve else None,
        spread=spread,
        n_points=len(curve.points) if curve else 0,
        max_residual=float(curve.residual.max()) if curve else None,
        wall_time=curve.wall_time if curve else None,
    )
