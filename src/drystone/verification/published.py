"""The published walls, beside what other programs and limit analysis gave."""

from __future__ import annotations

from functools import cache, partial

from drystone.analysis.driver import pushover
from drystone.limit import collapse_load
from drystone.model.builders.published import PUBLISHED_WALLS, published_wall
from drystone.verification.case import ENGINES, PROGRAM, Case

SECTION = "The published walls"

SECTIONS = {
    SECTION: "The peaks are those of Table 1 of Bouckaert, Godio and de Almeida (2022), by LMGC90 "
    "and UDEC. Their multipliers are applied ones, and those of drystone are static (strategy "
    "`displacement`). The models are the same. Limit analysis takes rigid blocks with sharp "
    "corners. The ends of the curves are not compared, because the published strategy is [biased "
    "after the peak](../explanation/theory.md).",
}


@cache
def peak(number: int, engine: str) -> float:
    """Of a published wall by an engine; two programs are set beside it."""
    return float(pushover(published_wall(number), engine=engine).peak.load_multiplier)


def collapse(number: int, flow: str) -> float:
    """Collapse multiplier of a published wall with sharp corners."""
    return collapse_load(published_wall(number).with_corner(), flow=flow).load_multiplier


def cases() -> list[Case]:
    """Of this part."""
    found = []
    for number, wall in PUBLISHED_WALLS.items():
        found += [
            Case(
                name=f"wall {number}: collapse multiplier, associative",
                section=SECTION,
                kind=PROGRAM,
                source="Ferris and Tin-Loi (2001)",
                expected=wall.associative_multiplier,
                compute=partial(collapse, number, "associative"),
                bound=0.5e-5 / wall.associative_multiplier,
                reason="half of the last printed digit",
            ),
        ]
        apart = abs(wall.peak_lmgc90 - wall.peak_udec)
        for program, expected in (("LMGC90", wall.peak_lmgc90), ("UDEC", wall.peak_udec)):
            for engine in ENGINES:
                found.append(
                    Case(
                        name=f"wall {number}: peak multiplier, {engine}",
                        section=SECTION,
                        kind=PROGRAM,
                        source=f"{program}, Table 1",
                        expected=expected,
                        compute=partial(peak, number, engine),
                        bound=(apart + 0.5e-3) / expected,
                        reason="the difference of both programs, and half of the last digit",
                        quick=number == 1 and engine == "equilibrium",
                    )
                )
    return found
