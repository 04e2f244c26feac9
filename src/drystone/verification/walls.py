"""Laboratory tests: peaks of measured walls."""

from __future__ import annotations

from functools import cache, partial

from drystone.laboratory.comparison import REPORTED, Computed, computed
from drystone.laboratory.figures import figures_of
from drystone.laboratory.walls import Wall, alike, known_miss, measured, walls
from drystone.results.cycles import envelope
from drystone.verification.case import LABORATORY, Case

SECTION = "Laboratory tests"

SECTIONS = {
    SECTION: "The numbers are peak forces in kN of dry-joint walls that were pushed sideways "
    "under a vertical load. They belong to the [tests and models](laboratory.md) of `drystone "
    "benchmark laboratory`. The models use the data of the reports, and no value is fitted. A "
    "model cannot be nearer to two equal walls than these are to each other. The bound is "
    "therefore the largest difference between the peaks of equal walls, and between the two "
    "senses of a wall.",
}


def scatter() -> float:
    """The largest difference of measured peaks of equal walls, of both senses, over their mean."""
    most = 0.0
    for wall in walls():
        peaks = [p for other in walls() if alike(wall, other) for p in _peaks(other)]
        most = max(most, (max(peaks) - min(peaks)) / (sum(peaks) / len(peaks)))
    return most


def senses(wall: Wall) -> tuple[float, ...]:
    """Those in which a wall was pushed."""
    return (1.0, -1.0) if wall.cyclic else (1.0,)


def _peaks(wall: Wall) -> list[float]:
    """Measured, in each sense [kN]."""
    return [1e-3 * figures_of(wall, *measured(wall), sense).peak for sense in senses(wall)]


@cache
def _curve(name: str) -> Computed:
    return computed(name, REPORTED)


def _ours(name: str, sense: float) -> float:
    """Computed by what the reports say [kN]."""
    curve = _curve(name)
    _, force = envelope(curve.displacement, curve.force, sense)
    return 1e-3 * float((sense * force).max())


def cases() -> list[Case]:
    """Of this part."""
    bound = scatter()
    found = []
    for wall in walls():
        like = next(other for other in walls() if alike(other, wall))  # computed once
        for sense, expected in zip(senses(wall), _peaks(wall), strict=True):
            which = "" if not wall.cyclic else ", to the right" if sense > 0.0 else ", to the left"
            found.append(
                Case(
                    name=f"{wall.name}: peak force [kN]{which}",
                    section=SECTION,
                    kind=LABORATORY,
                    source=wall.reference,
                    expected=expected,
                    compute=partial(_ours, like.name, sense),
                    bound=bound,
                    reason="the largest difference of the peaks of equal walls, and of both senses",
                    known=known_miss(wall),
                    quick=not wall.cyclic,
                )
            )
    return found
