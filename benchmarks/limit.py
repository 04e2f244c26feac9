"""Limit analysis of the published walls and of large ones: multipliers and seconds on one core.

    python benchmarks/limit.py [--repeats N] [--most-blocks N]

Writes ``results/limit.json`` and ``results/limit.md``.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from importlib.metadata import version

import harness  # first: it holds the libraries' threads to one
import numpy as np
from walls import running_bond

import drystone as ds
from drystone.limit import collapse_load, collapse_loads, least_standing
from drystone.model.assembly import Corner
from drystone.model.builders import PUBLISHED_WALLS, circular_arch, make_model
from drystone.model.builders.published import CORNER_RADIUS, JOINT, UNIT_WEIGHT

#: Units a course and courses of the large walls.
LARGE = ((16, 20), (31, 32), (20, 50), (50, 50), (100, 100))


@dataclass(frozen=True, kw_only=True)
class WallLimits:
    """One published wall."""

    wall: int
    corners: str
    associative: float
    non_associative: float
    lowest: float
    highest: float
    duality_gap: float  # largest of both flows
    seconds: float  # both flows, median of warm runs


@dataclass(frozen=True, kw_only=True)
class LargeLimits:
    """One wall by associative limit analysis."""

    units: int
    courses: int
    n_blocks: int
    n_contacts: int
    multiplier: float
    duality_gap: float
    residual: float
    model_seconds: float
    seconds: float  # dead load and collapse, one run


def published(wall: int, radius: float | None, repeats: int) -> WallLimits:
    """Both flows of a published wall."""
    model = ds.published_wall(wall)
    a = model.assembly
    model = make_model(
        a.blocks,
        joint=a.joint,
        corner=Corner(radius=radius),
        thickness=a.thickness,
        load_direction=model.load_along,
    )
    results = collapse_loads(model)
    low, high = results[1].collapse_range
    return WallLimits(
        wall=wall,
        corners=f"radius {radius:g} m" if radius else "sharp",
        associative=results[0].load_multiplier,
        non_associative=results[1].load_multiplier,
        lowest=low,
        highest=high,
        duality_gap=max(result.duality_gap for result in results),
        seconds=harness.median_seconds(lambda: collapse_loads(model), repeats),
    )


def large(units: int, courses: int) -> LargeLimits:
    """Associative flow of a running bond with sharp corners."""
    begun = time.perf_counter()
    model = running_bond(units, courses)
    made = time.perf_counter()
    found = collapse_load(model, flow="associative")
    seconds = time.perf_counter() - made
    assert found.contacts is not None
    return LargeLimits(
        units=units,
        courses=courses,
        n_blocks=model.assembly.n_blocks,
        n_contacts=found.contacts.n_contacts,
        multiplier=found.load_multiplier,
        duality_gap=found.duality_gap,
        residual=found.residual,
        model_seconds=made - begun,
        seconds=seconds,
    )


def arches() -> list[dict[str, float]]:
    """Least thickness over radius of semicircular arches, Milankovitch's 0.1075 in the limit."""

    def arch(ratio: float, n: int) -> ds.Model:
        blocks = circular_arch(
            radius=1.0, thickness=ratio, embrace=180.0, n_voussoirs=n, unit_weight=UNIT_WEIGHT
        )
        return make_model(blocks, joint=JOINT, thickness=1.0, load_direction=(1.0, 0.0))

    rows = []
    for n in (7, 27, 100, 200, 400):
        begun = time.perf_counter()
        ratio = least_standing(lambda x, n=n: arch(x, n), 0.05, 0.2, tolerance=1e-7)
        seconds = time.perf_counter() - begun
        rows.append({"voussoirs": n, "thickness over radius": ratio, "seconds": seconds})
    return rows


def main() -> None:
    """Run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--most-blocks", type=int, default=20_000)
    arguments = parser.parse_args()
    walls = [
        published(wall, radius, arguments.repeats)
        for radius in (None, CORNER_RADIUS)
        for wall in PUBLISHED_WALLS
    ]
    sizes = [size for size in LARGE if np.prod(size) <= arguments.most_blocks]
    walls_of_many = [large(*size) for size in sizes]
    semicircles = arches()
    text = "\n\n".join(
        (
            "## Published walls, both flows",
            harness.table(
                [
                    {
                        "wall": row.wall,
                        "corners": row.corners,
                        "associative": f"{row.associative:.5f}",
                        "non-associative": f"{row.non_associative:.5f}",
                        "range": f"{row.lowest:.5f} to {row.highest:.5f}",
                        "duality gap": f"{row.duality_gap:.0e}",
                        "s": f"{row.seconds:.2f}",
                    }
                    for row in walls
                ]
            ),
            "## Large walls, associative",
            harness.table(
                [
                    {
                        "blocks": row.n_blocks,
                        "contacts": row.n_contacts,
                        "multiplier": f"{row.multiplier:.6f}",
                        "duality gap": f"{row.duality_gap:.0e}",
                        "residual": f"{row.residual:.0e}",
                        "model, s": f"{row.model_seconds:.2f}",
                        "s": f"{row.seconds:.2f}",
                    }
                    for row in walls_of_many
                ]
            ),
            "## Least thickness of a semicircular arch",
            harness.table(
                [
                    {
                        "voussoirs": row["voussoirs"],
                        "thickness over radius": f"{row['thickness over radius']:.6f}",
                        "s": f"{row['seconds']:.2f}",
                    }
                    for row in semicircles
                ]
            ),
        )
    )
    notes = (
        f"HiGHS {version('highspy')} below 600 contact points, "
        "the interior-point method from there on."
    )
    parts = {"published": walls, "large": walls_of_many, "arches": semicircles}
    harness.write("limit", "Limit analysis", notes, parts, text)


if __name__ == "__main__":
    main()
